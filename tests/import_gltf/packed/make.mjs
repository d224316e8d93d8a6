// Makes the files of this folder: one model of ours, plain and as optimisers pack it. Not run by the tests.
//   npm install gltfpack @gltf-transform/core @gltf-transform/extensions draco3dgltf ktx2-encoder
//   node make.mjs
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { Document, NodeIO } from "@gltf-transform/core";
import { KHRDracoMeshCompression } from "@gltf-transform/extensions";
import draco3d from "draco3dgltf";
import { encodeToKTX2 } from "ktx2-encoder";

// An ellipsoid with half-axes 1, 2 and 3, of 10 x 6 quads, without its poles, so that no triangle is degenerate.
const position = [], normal = [], uv = [], index = [];
const columns = 10, rows = 6;
for (let row = 0; row <= rows; row++) {
  for (let column = 0; column <= columns; column++) {
    const polar = Math.PI * (0.1 + (0.7 * row) / rows), around = (2 * Math.PI * column) / columns;
    const unit = [Math.sin(polar) * Math.cos(around), Math.cos(polar), Math.sin(polar) * Math.sin(around)];
    const n = unit.map((v, k) => v / (k + 1)), length = Math.hypot(...n);
    position.push(...unit.map((v, k) => v * (k + 1)));
    normal.push(...n.map((v) => v / length));
    uv.push(column / columns, row / rows);
    if (row < rows && column < columns) {
      const a = row * (columns + 1) + column, b = a + columns + 1;
      index.push(a, a + 1, b, b, a + 1, b + 1);
    }
  }
}

const document = new Document();
const buffer = document.createBuffer();
const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
const primitive = document.createPrimitive()
  .setIndices(accessor("SCALAR", new Uint16Array(index)))
  .setAttribute("POSITION", accessor("VEC3", new Float32Array(position)))
  .setAttribute("NORMAL", accessor("VEC3", new Float32Array(normal)))
  .setAttribute("TEXCOORD_0", accessor("VEC2", new Float32Array(uv)))
  .setMaterial(document.createMaterial("stone"));
const mesh = document.createMesh("pebble").addPrimitive(primitive);
const scene = document.createScene();
[[5, 0, 0], [0, 7, 1], [2, 1, 11]].forEach((translation, i) => {
  const node = document.createNode(`pebble ${i}`).setMesh(mesh).setTranslation(translation);
  scene.addChild(node.setRotation([0, Math.sin(i / 3), 0, Math.cos(i / 3)]).setScale([1, 1 + i / 4, 1]));
});

const io = new NodeIO().registerExtensions([KHRDracoMeshCompression]).registerDependencies({
  "draco3d.encoder": await draco3d.createEncoderModule(),
});
await io.write("plain.glb", document);
const packer = createRequire(import.meta.url).resolve("gltfpack/cli.js");
const pack = (name, options) =>
  execFileSync(process.execPath, [packer, "-i", "plain.glb", "-o", name, ...options.split(" ").filter((o) => o)]);
pack("quantised.glb", "");
pack("meshopt-c.glb", "-c");
pack("meshopt-cc-floats.glb", "-cc -noq");
pack("meshopt-cf.glb", "-cf");
pack("meshopt-cz-khr.glb", "-cz -ce khr -vi");
pack("meshopt-mi.glb", "-cc -mi -vpn -vn 12");
const method = KHRDracoMeshCompression.EncoderMethod ?? { EDGEBREAKER: 1, SEQUENTIAL: 0 };
const draco = document.createExtension(KHRDracoMeshCompression).setRequired(true);
draco.setEncoderOptions({ method: method.EDGEBREAKER });
await io.write("draco-edgebreaker.glb", document);
draco.setEncoderOptions({ method: method.SEQUENTIAL, quantizationBits: { POSITION: 16, NORMAL: 14, TEX_COORD: 14 } });
await io.write("draco-sequential.glb", document);

// 8 x 4 pixels. UASTC: red grows to the right, green downwards, blue is 51. ETC1S, which has one colour and four shades of it
// for 4 x 4 pixels: two squares.
const [width, height] = [8, 4];
const slopes = (x, y) => [30 * x, 60 * y, 51, 255], squares = (x) => (x < 4 ? [200, 100, 50, 255] : [10, 20, 220, 255]);
for (const [name, isUASTC, color] of [["etc1s.ktx2", false, squares], ["uastc.ktx2", true, slopes]]) {
  const pixels = new Uint8Array(4 * width * height);
  for (let i = 0; i < width * height; i++) pixels.set(color(i % width, Math.floor(i / width)), 4 * i);
  const imageDecoder = async () => ({ width, height, data: pixels });
  const options = { isUASTC, generateMipmap: false, isSetKTX2SRGBTransferFunc: true, qualityLevel: 255, imageDecoder };
  writeFileSync(name, await encodeToKTX2(pixels, options));
}
