//! Files with one defect each. Each says in its text what is wrong with it, where the format has room for that.

use super::GeneratedFile;

/// A file that is text: its name and what it holds.
const TEXTS: &[(&str, &str)] = &[
    (
        "malformed/nan-vertex.obj",
        "# One of two triangles has a corner that is not a number.\n\
         v 0 0 0\n\
         v 1 0 0\n\
         v 0 1 0\n\
         v nan 1 0\n\
         f 1 2 3\n\
         f 2 4 3\n",
    ),
    (
        "malformed/index-out-of-range.obj",
        "# The second face names a fifth vertex of four.\n\
         v 0 0 0\n\
         v 1 0 0\n\
         v 0 1 0\n\
         v 1 1 0\n\
         f 1 2 3\n\
         f 2 5 3\n",
    ),
];

/// Every malformed file.
pub(super) fn files() -> Vec<GeneratedFile> {
    let mut files: Vec<GeneratedFile> = TEXTS
        .iter()
        .map(|&(name, text)| GeneratedFile::new(name, text))
        .collect();
    files.push(GeneratedFile::new(
        "malformed/truncated.glb",
        truncated_glb(),
    ));
    files
}

/// A triangle whose file ends in the middle of its vertices, as after a download that broke off.
fn truncated_glb() -> Vec<u8> {
    let json = r#"{"asset":{"version":"2.0","generator":"bspray models/generate.rs"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]}"#;
    // A chunk's length is a multiple of four; spaces fill up JSON.
    let padded = json.len().next_multiple_of(4);
    let vertices: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut glb = Vec::new();
    glb.extend(b"glTF");
    glb.extend(2_u32.to_le_bytes());
    glb.extend(((12 + 8 + padded + 8 + 36) as u32).to_le_bytes());
    glb.extend((padded as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(format!("{json:padded$}").bytes());
    glb.extend(36_u32.to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(vertices.iter().flat_map(|v| v.to_le_bytes()));
    glb.truncate(glb.len() - 16);
    glb
}
