//! An image of any kind as the texture of a triangle: the scene loads whatever it is, unless memory ends.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "folder.rs"]
mod folder;
#[path = "../../support/import_contract.rs"]
mod import_contract;

/// Bytes of the triangle's positions.
const POSITIONS: usize = 36;

fuzz_target!(init: folder::init(), |bytes: &[u8]| {
    let image = bytes.len();
    let length = POSITIONS + image;
    // The name helps with TGA, which has no mark of its own.
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
        "textures":[{{"source":0}}],"images":[{{"name":"a.tga","bufferView":1,"mimeType":"image/png"}}],
        "buffers":[{{"byteLength":{length}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{POSITIONS}}},{{"buffer":0,"byteOffset":{POSITIONS},"byteLength":{image}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}]}}"#
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let positions = [0.0_f32, 0.0, 3.0, 1.0, 0.0, 3.0, 0.0, 2.0, 3.0].map(f32::to_le_bytes);
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((28 + json.len() as u32 + length as u32).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend((length as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(positions.as_flattened());
    glb.extend(bytes);
    let file = folder::write("model.glb", &glb);
    let loaded = import_contract::load_checked(&file, &folder::options(&[]));
    if let Err(error) = loaded {
        assert!(error.contains("--memory-limit"), "{error}");
    }
});
