"""Reads glTF 2.0 (.gltf, .glb) and OBJ files into world-space primitives, on purpose without any of bspray's code.

A model is a pair (primitives, materials). Arrays of a primitive have one row a vertex; normals and tangents are world space, of unit length; texture
coordinates have v = 0 at the image's top row, as glTF has it. Poses are those at rest. Not read: sparse accessors, morph targets, Draco, meshopt,
EXT_mesh_gpu_instancing, textures of OBJ files. What a file needs and is not read stops the script.
"""
import base64
import json
import struct
import urllib.parse
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

READ = {
    "KHR_materials_clearcoat", "KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_transmission", "KHR_materials_volume",
    "KHR_materials_unlit", "KHR_lights_punctual", "KHR_texture_transform", "KHR_mesh_quantization", "KHR_xmp",
}


@dataclass
class Primitive:
    positions: np.ndarray
    triangles: np.ndarray
    material: int
    normals: np.ndarray | None = None
    uvs: list = field(default_factory=list)
    tangents: np.ndarray | None = None
    colors: np.ndarray | None = None


@dataclass
class Slot:
    """A use of a texture: linear values, rows by columns by channels, and the affine map of its coordinates."""
    image: np.ndarray
    uv_set: int = 0
    matrix: np.ndarray = field(default_factory=lambda: np.eye(3)[:2])
    wrap: str = "repeat"
    nearest: bool = False


@dataclass
class Material:
    name: str = ""
    base_color: tuple = (1.0, 1.0, 1.0, 1.0)
    metallic: float = 0.0
    roughness: float = 1.0
    emissive: tuple = (0.0, 0.0, 0.0)
    normal_scale: float = 1.0
    alpha_mode: str = "OPAQUE"
    cutoff: float = 0.5
    unlit: bool = False
    double_sided: bool = True
    ior: float = 1.5
    transmission: float = 0.0
    is_solid: bool = False
    f0_factor: float = 1.0
    coat: float = 0.0
    coat_roughness: float = 0.0
    slots: dict = field(default_factory=dict)


def read(path):
    path = Path(path)
    if path.suffix == ".obj":
        return read_obj(path)
    return Gltf(path).model()


def linear_of_srgb(x):
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


class Gltf:
    def __init__(self, path):
        self.folder = path.parent
        data = path.read_bytes()
        self.binary = None
        if data[:4] == b"glTF":
            size = struct.unpack("<I", data[12:16])[0]
            self.json = json.loads(data[20:20 + size])
            self.binary = data[28 + size:]
        else:
            self.json = json.loads(data)
        unread = set(self.json.get("extensionsUsed", [])) - READ
        if unread:
            raise SystemExit(f"{path}: {', '.join(sorted(unread))} is not read")
        self.buffers = [self.resource(b.get("uri")) for b in self.json.get("buffers", [])]
        self.images = {}

    def resource(self, uri):
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.folder / urllib.parse.unquote(uri)).read_bytes()

    def view(self, index):
        v = self.json["bufferViews"][index]
        start = v.get("byteOffset", 0)
        return self.buffers[v["buffer"]][start:start + v["byteLength"]], v.get("byteStride")

    def accessor(self, index):
        a = self.json["accessors"][index]
        assert "sparse" not in a, "sparse accessors are not read"
        kind = np.dtype({5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}[a["componentType"]])
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[a["type"]]
        data, stride = self.view(a["bufferView"])
        stride = stride or kind.itemsize * width
        rows = np.ndarray((a["count"], width), kind, data, a.get("byteOffset", 0), (stride, kind.itemsize))
        if a.get("normalized"):
            return np.maximum(rows / np.iinfo(kind).max, -1.0)
        return rows.copy()

    def image(self, index, is_color):
        key = index, is_color
        if key not in self.images:
            i = self.json["images"][index]
            data = self.view(i["bufferView"])[0] if "bufferView" in i else self.resource(i["uri"])
            pixels = np.asarray(Image.open(BytesIO(data)).convert("RGBA"), np.float32) / 255
            if is_color:
                pixels[..., :3] = linear_of_srgb(pixels[..., :3])
            self.images[key] = pixels
        return self.images[key]

    def slot(self, info, is_color):
        texture = self.json["textures"][info["index"]]
        sampler = self.json["samplers"][texture["sampler"]] if "sampler" in texture else {}
        slot = Slot(self.image(texture["source"], is_color), info.get("texCoord", 0))
        wraps = {sampler.get("wrapS", 10497), sampler.get("wrapT", 10497)}
        slot.wrap = {33071: "clamp", 33648: "mirror", 10497: "repeat"}[wraps.pop()]
        slot.nearest = sampler.get("magFilter") == 9728
        move = info.get("extensions", {}).get("KHR_texture_transform")
        if move:
            slot.uv_set = move.get("texCoord", slot.uv_set)
            (x, y), r, (s, t) = move.get("offset", (0, 0)), move.get("rotation", 0), move.get("scale", (1, 1))
            c, d = np.cos(r), np.sin(r)
            slot.matrix = np.array([[c * s, d * t, x], [-d * s, c * t, y]])
        return slot

    def material(self, m):
        pbr, extensions = m.get("pbrMetallicRoughness", {}), m.get("extensions", {})
        factor = lambda name, key, default: extensions.get(name, {}).get(key, default)
        strength = factor("KHR_materials_emissive_strength", "emissiveStrength", 1.0)
        made = Material(
            name=m.get("name", ""),
            base_color=tuple(pbr.get("baseColorFactor", (1, 1, 1, 1))),
            metallic=pbr.get("metallicFactor", 1.0),
            roughness=pbr.get("roughnessFactor", 1.0),
            emissive=tuple(strength * x for x in m.get("emissiveFactor", (0, 0, 0))),
            normal_scale=m.get("normalTexture", {}).get("scale", 1.0),
            alpha_mode=m.get("alphaMode", "OPAQUE"),
            cutoff=m.get("alphaCutoff", 0.5),
            double_sided=m.get("doubleSided", False),
            unlit="KHR_materials_unlit" in extensions,
            ior=factor("KHR_materials_ior", "ior", 1.5),
            transmission=factor("KHR_materials_transmission", "transmissionFactor", 0.0),
            is_solid=factor("KHR_materials_volume", "thicknessFactor", 0.0) > 0,
            coat=factor("KHR_materials_clearcoat", "clearcoatFactor", 0.0),
            coat_roughness=factor("KHR_materials_clearcoat", "clearcoatRoughnessFactor", 0.0),
        )
        used = {
            "base_color": (pbr, "baseColorTexture", True),
            "metallic_roughness": (pbr, "metallicRoughnessTexture", False),
            "normal": (m, "normalTexture", False),
            "emissive": (m, "emissiveTexture", True),
            "transmission": (extensions.get("KHR_materials_transmission", {}), "transmissionTexture", False),
        }
        made.slots = {name: self.slot(at[key], is_color) for name, (at, key, is_color) in used.items() if key in at}
        return made

    def model(self):
        nodes = self.json.get("nodes", [])
        world = [None] * len(nodes)

        def place(index, above):
            node = nodes[index]
            world[index] = above @ local_matrix(node)
            for child in node.get("children", []):
                place(child, world[index])

        shown = self.json["scenes"][self.json.get("scene", 0)]["nodes"] if "scenes" in self.json else range(len(nodes))
        for root in shown:
            place(root, np.eye(4))
        materials = [self.material(m) for m in self.json.get("materials", [])] + [Material(metallic=1.0)]
        found = []
        for node, matrix in zip(nodes, world):
            if matrix is None or "mesh" not in node:
                continue
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                if primitive.get("mode", 4) == 4:
                    found.append(self.primitive(primitive, matrix, node, world))
        return found, materials

    def primitive(self, p, matrix, node, world):
        get = lambda name: self.accessor(p["attributes"][name]).astype(np.float64) if name in p["attributes"] else None
        positions = get("POSITION")
        count = len(positions)
        indices = self.accessor(p["indices"]) if "indices" in p else np.arange(count)
        triangles = indices.reshape(-1, 3).astype(np.uint32)
        matrices = np.broadcast_to(matrix, (count, 4, 4))
        if "skin" in node:
            skin = self.json["skins"][node["skin"]]
            inverse = self.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
            joints = np.array([world[j] for j in skin["joints"]]) @ inverse
            chosen, weights = get("JOINTS_0").astype(int), get("WEIGHTS_0")
            matrices = np.einsum("vj,vjab->vab", weights, joints[chosen])
        linear = matrices[:, :3, :3]
        made = Primitive(np.einsum("vab,vb->va", linear, positions) + matrices[:, :3, 3], triangles, p.get("material", -1))
        is_mirrored = np.linalg.det(linear[0]) < 0
        if is_mirrored:
            made.triangles = triangles[:, [0, 2, 1]]
        normals = get("NORMAL")
        if normals is not None:
            made.normals = unit(np.einsum("vba,vb->va", np.linalg.inv(linear), normals))
        for set_ in range(2):
            uv = get(f"TEXCOORD_{set_}")
            if uv is not None:
                made.uvs.append(uv)
        tangents = get("TANGENT")
        if tangents is not None:
            along = unit(np.einsum("vab,vb->va", linear, tangents[:, :3]))
            made.tangents = np.concatenate([along, tangents[:, 3:] * (-1 if is_mirrored else 1)], 1)
        made.colors = get("COLOR_0")
        return made


def local_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])
    m = np.eye(4)
    m[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)))
    m[:3, 3] = node.get("translation", (0, 0, 0))
    return m


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)


def made_tangents(p, uv):
    """Tangents by vertex where a file has none: the triangles' own, weighted by their angles and projected on the vertex normals. As MikkTSpace has
    it, but for vertices that triangles of both handednesses share, which files split."""
    a, b, c = (p.positions[p.triangles[:, i]] for i in range(3))
    s, t, u = (uv[p.triangles[:, i]] for i in range(3))
    e, f, g, h = b - a, c - a, t - s, u - s
    area = g[:, 0] * h[:, 1] - g[:, 1] * h[:, 0]
    along = (e * h[:, 1:] - f * g[:, 1:]) * np.sign(area)[:, None]
    normals = p.normals if p.normals is not None else np.zeros_like(p.positions)
    total, side = np.zeros_like(p.positions), np.zeros(len(p.positions))
    corners = [(a, b, c), (b, c, a), (c, a, b)]
    for i, (o, q, r) in enumerate(corners):
        angle = np.arccos(np.clip(np.sum(unit(q - o) * unit(r - o), 1), -1, 1))
        n = normals[p.triangles[:, i]]
        t = unit(along - n * np.sum(n * along, 1, keepdims=True))
        np.add.at(total, p.triangles[:, i], t * angle[:, None])
        np.add.at(side, p.triangles[:, i], np.sign(area))
    # v grows downwards in the image and the bitangent points up in it: glTF's sign is the opposite of the area's in (u, 1 - v).
    return np.concatenate([unit(total), np.where(side < 0, 1.0, -1.0)[:, None]], 1)


def read_obj(path):
    """Polygons as fans; Kd, Ks of zero, Ke, and Ka above 1 as a light, as bspray has it (src/import/obj/materials.rs)."""
    materials, names = [Material(base_color=(0.65, 0.65, 0.65, 1.0))], {}
    points, normals, parts = [], [], {}
    current = 0
    for line in path.read_text(errors="replace").splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append([float(x) for x in rest[:3]])
        elif word == "vn":
            normals.append([float(x) for x in rest[:3]])
        elif word == "mtllib":
            for name, m in read_mtl(path.parent / rest[0]).items():
                names[name] = len(materials)
                materials.append(m)
        elif word == "usemtl":
            current = names.get(rest[0], 0)
        elif word == "f":
            corners = []
            for corner in rest:
                numbers = corner.split("/")
                position = int(numbers[0])
                normal = int(numbers[2]) if len(numbers) > 2 and numbers[2] else 0
                corners.append((position - 1 if position > 0 else len(points) + position, normal - 1 if normal > 0 else len(normals) + normal if normal else -1))
            part = parts.setdefault(current, [])
            part.extend((corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1))
    points, normals = np.array(points), np.array(normals)
    found = []
    for material, triangles in parts.items():
        flat = np.array(triangles).reshape(-1, 2)
        p = Primitive(points[flat[:, 0]], np.arange(len(flat), dtype=np.uint32).reshape(-1, 3), material)
        if (flat[:, 1] >= 0).all():
            p.normals = unit(normals[flat[:, 1]])
        found.append(p)
    return found, materials


def read_mtl(path):
    made = {}
    for line in path.read_text(errors="replace").splitlines():
        word, *rest = line.split() or [""]
        if word == "newmtl":
            now = made[rest[0]] = Material(name=rest[0], f0_factor=0.0)
        elif word == "Kd":
            now.base_color = (*map(float, rest[:3]), 1.0)
        elif word == "Ke" or word == "Ka" and max(map(float, rest)) > 1 and not any(now.emissive):
            now.emissive = tuple(map(float, rest[:3]))
    return made
