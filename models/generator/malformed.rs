//! Files with one defect each. Each says in its text what is wrong with it, where the format has room for that.

use super::{GeneratedFile, gltf};

/// OBJ and MTL files: their names and what they hold.
const TEXTS: &[(&str, &str)] = &[
    (
        "malformed/degenerate-triangle.obj",
        "# Wrong: the second triangle has its corners on one line. Expected: it is dropped as a defect, the first is kept.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         v 4 0 0\n\
         f 1 2 3\n\
         f 1 2 4\n",
    ),
    ("malformed/empty.obj", ""),
    (
        "malformed/huge-coordinate.obj",
        "# Wrong: vertex 4 lies beyond 1e18. Expected: the second triangle is dropped as a defect, the first is kept.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         v 1e30 1 0\n\
         f 1 2 3\n\
         f 1 3 4\n",
    ),
    (
        "malformed/index-out-of-range.obj",
        "# Wrong: the face on line 6 names vertex 9 of 4. Expected: an error that names line 6.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         v 0 1 0\n\
         f 1 2 9\n\
         f 1 3 4\n",
    ),
    (
        "malformed/malformed-number.obj",
        "# Wrong: a coordinate of vertex 4 is \"3.1+e2\". Expected: a note that names line 5; its triangle is dropped as a defect.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         v 3.1+e2 1 0\n\
         f 1 2 3\n\
         f 1 3 4\n",
    ),
    (
        "malformed/missing-mtl.obj",
        "# Wrong: the MTL file is not there. Expected: a note that names it; the default material is used.\n\
         mtllib not-there.mtl\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         usemtl red\n\
         f 1 2 3\n",
    ),
    (
        "malformed/missing-texture.mtl",
        "newmtl red\n\
         Kd 0.8 0.1 0.1\n\
         map_Kd not-there.png\n",
    ),
    (
        "malformed/missing-texture.obj",
        "# Wrong: the MTL names an image that is not there. Expected: a note that names it; a magenta checker stands in for it.\n\
         mtllib missing-texture.mtl\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         vt 0 0\n\
         vt 1 0\n\
         vt 1 1\n\
         usemtl red\n\
         f 1/1 2/2 3/3\n",
    ),
    (
        "malformed/nan-vertex.obj",
        "# Wrong: vertex 4 is NaN. Expected: the second triangle is dropped as a defect, the first is kept.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         v nan 1 0\n\
         f 1 2 3\n\
         f 1 3 4\n",
    ),
    (
        "malformed/no-faces.obj",
        "# Wrong: vertices, but no face. Expected: an error that says so.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n",
    ),
    (
        "malformed/no-such-normal.obj",
        "# Wrong: the face names normals that are not there. Expected: a note that names line 5; flat shading.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         f 1//1 2//2 3//3\n",
    ),
    (
        "malformed/repeated-corner.obj",
        "# Wrong: the second face names vertex 1 twice. Expected: it is dropped as a defect, the first is kept.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         f 1 2 3\n\
         f 1 1 3\n",
    ),
    (
        "malformed/zero-index.obj",
        "# Wrong: the face on line 6 names vertex 0; OBJ counts from 1. Expected: an error that names line 6.\n\
         v 0 0 0\n\
         v 2 0 0\n\
         v 2 1 0\n\
         v 0 1 0\n\
         f 0 1 2\n\
         f 1 3 4\n",
    ),
];

/// A sound glTF file: a quad of two triangles under one node, its buffer in the file.
const QUAD: &str = concat!(
    r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"quad","mesh":0}],"#,
    r#""meshes":[{"name":"quad","primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"#,
    r#""accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[2,1,0]},"#,
    r#"{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}],"#,
    r#""bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":6}],"#,
    r#""buffers":[{"byteLength":54,"uri":"data:application/octet-stream;base64,"#,
    r#"AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAQAAAgD8AAAAAAAAAAAAAgD8AAAAAAAECAAID"}]}"#,
);

/// The URI of the buffer of [`QUAD`], which a GLB does without.
const URI: &str = concat!(
    r#","uri":"data:application/octet-stream;base64,"#,
    r#"AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAQAAAgD8AAAAAAAAAAAAAgD8AAAAAAAECAAID""#
);

/// glTF files: their names, a piece of [`QUAD`], and the broken piece in its place.
const EDITS: &[(&str, &str, &str)] = &[
    (
        "malformed/cyclic-nodes.gltf",
        r#"[{"nodes":[0]}],"nodes":[{"name":"quad","mesh":0}]"#,
        concat!(
            r#"[{"nodes":[0,1]}],"nodes":[{"name":"quad","mesh":0},"#,
            r#"{"name":"arm","children":[2]},{"name":"hand","children":[1]}]"#
        ),
    ),
    (
        "malformed/empty-mesh.gltf",
        r#"[{"attributes":{"POSITION":0},"indices":1}]"#,
        "[]",
    ),
    // The fifth index becomes 9; there are four vertices.
    ("malformed/index-out-of-range.gltf", "AAECAAID", "AAECAAkD"),
    (
        "malformed/missing-buffer.gltf",
        URI,
        r#","uri":"missing.bin""#,
    ),
    (
        "malformed/required-extension.gltf",
        "}]}",
        concat!(
            r#"}],"extensionsUsed":["KHR_gaussian_splatting"],"#,
            r#""extensionsRequired":["KHR_gaussian_splatting"]}"#
        ),
    ),
];

/// Every malformed file.
pub(super) fn files() -> Vec<GeneratedFile> {
    let texts = TEXTS
        .iter()
        .map(|&(name, text)| GeneratedFile::new(name, text));
    let edits = EDITS.iter().map(|&(name, sound, broken)| {
        // The last occurrence: the end of the file closes as its parts do.
        let at = QUAD.rfind(sound).expect("the piece is in the file");
        GeneratedFile::new(
            name,
            [&QUAD[..at], broken, &QUAD[at + sound.len()..]].concat(),
        )
    });
    let mut truncated = glb();
    truncated.truncate(300);
    let mut huge = glb();
    huge[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    let binaries = [
        // Ends in the middle of its JSON, as after a download that broke off.
        GeneratedFile::new("malformed/truncated.glb", truncated),
        // Claims to be 4 GiB long.
        GeneratedFile::new("malformed/huge-claim.glb", huge),
    ];
    texts.chain(edits).chain(binaries).collect()
}

/// [`QUAD`] as a GLB.
fn glb() -> Vec<u8> {
    let positions: [f32; 12] = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let mut data: Vec<u8> = positions.iter().flat_map(|v| v.to_le_bytes()).collect();
    data.extend([0, 1, 2, 0, 2, 3]);
    gltf::glb(&QUAD.replace(URI, ""), data)
}
