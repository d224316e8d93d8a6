//! Small glTF files, made in code: a good triangle, and the means to change it.

use std::path::{Path, PathBuf};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use bspray::import::{ImportOptions, load_with};
use bspray::scene::Scene;
use serde_json::{Value, json};

pub(crate) const BYTE: u32 = 5120;
pub(crate) const UNSIGNED_BYTE: u32 = 5121;
pub(crate) const SHORT: u32 = 5122;
pub(crate) const UNSIGNED_SHORT: u32 = 5123;
pub(crate) const UNSIGNED_INT: u32 = 5125;
pub(crate) const FLOAT: u32 = 5126;

/// One pixel, red 255, green 128, blue 0, as PNG.
pub(crate) const PNG: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP438AAAAQBAYDFKhhdAAAAAElFTkSuQmCC";

/// Two pixels, (10, 20, 30) and (200, 100, 50), as lossless WebP.
pub(crate) const WEBP: &str = "UklGRiIAAABXRUJQVlA4TBYAAAAvAQAAAA9wCqgr+J7CY/6DBxWI6H8A";

/// A triangle of 1 x 2 units at z = 3, without indices.
pub(crate) fn triangle() -> Value {
    let mut model = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {}}]}],
    });
    let positions = floats(&[0.0, 0.0, 3.0, 1.0, 0.0, 3.0, 0.0, 2.0, 3.0]);
    set_attribute(&mut model, "POSITION", &positions, FLOAT, 3, "VEC3");
    model
}

pub(crate) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

pub(crate) fn shorts(values: &[i16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Adds `item` to the array `key` and gives its index.
pub(crate) fn push(model: &mut Value, key: &str, item: Value) -> usize {
    if model[key].is_null() {
        model[key] = json!([]);
    }
    let items = model[key].as_array_mut().expect("an array");
    items.push(item);
    items.len() - 1
}

/// Adds a buffer with one view of it.
pub(crate) fn add_view(model: &mut Value, bytes: &[u8]) -> usize {
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        BASE64_STANDARD.encode(bytes)
    );
    let buffer = push(
        model,
        "buffers",
        json!({"byteLength": bytes.len(), "uri": uri}),
    );
    push(
        model,
        "bufferViews",
        json!({"buffer": buffer, "byteLength": bytes.len()}),
    )
}

pub(crate) fn add_accessor(
    model: &mut Value,
    bytes: &[u8],
    component: u32,
    count: u64,
    kind: &str,
) -> usize {
    let view = add_view(model, bytes);
    let accessor =
        json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
    push(model, "accessors", accessor)
}

pub(crate) fn set_attribute(
    model: &mut Value,
    name: &str,
    bytes: &[u8],
    component: u32,
    count: u64,
    kind: &str,
) -> usize {
    let accessor = add_accessor(model, bytes, component, count, kind);
    model["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
    accessor
}

pub(crate) fn set_indices(model: &mut Value, indices: &[u8]) {
    let count = indices.len() as u64;
    let accessor = add_accessor(model, indices, UNSIGNED_BYTE, count, "SCALAR");
    model["meshes"][0]["primitives"][0]["indices"] = json!(accessor);
}

pub(crate) fn load_bytes(name: &str, bytes: &[u8]) -> Result<Scene, String> {
    let directory = tempfile::tempdir().expect("a temporary directory");
    load_in(directory.path(), name, bytes)
}

pub(crate) fn load_in(directory: &Path, name: &str, bytes: &[u8]) -> Result<Scene, String> {
    load_in_with(directory, name, bytes, &ImportOptions::default())
}

fn load_in_with(
    directory: &Path,
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<Scene, String> {
    let file: PathBuf = directory.join(name);
    std::fs::write(&file, bytes).expect("written");
    let scene = load_with(std::slice::from_ref(&file), options).map_err(|e| e.to_string())?;
    for mesh in &scene.meshes {
        assert_eq!(mesh.validate(), Ok(()));
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
    }
    for instance in &scene.instances {
        assert!((instance.mesh as usize) < scene.meshes.len());
    }
    for part in scene.meshes.iter().flat_map(|m| &m.parts) {
        assert!((part.material as usize) < scene.materials.len());
    }
    for texture in scene.materials.iter().flat_map(|m| m.texture_refs()) {
        assert!((texture.texture as usize) < scene.textures.len());
    }
    Ok(scene)
}

pub(crate) fn load_model(model: &Value) -> Result<Scene, String> {
    load_bytes("model.gltf", model.to_string().as_bytes())
}

pub(crate) fn load_model_with(model: &Value, options: &ImportOptions) -> Result<Scene, String> {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let bytes = model.to_string();
    load_in_with(directory.path(), "model.gltf", bytes.as_bytes(), options)
}

/// The changed triangle, which must load.
pub(crate) fn good(change: impl FnOnce(&mut Value)) -> Scene {
    let mut model = triangle();
    change(&mut model);
    load_model(&model).expect("loads")
}

/// Why the changed triangle does not load. The message must be one line, name the file and hold all of `words`.
pub(crate) fn refused(words: &[&str], change: impl FnOnce(&mut Value)) {
    let mut model = triangle();
    change(&mut model);
    expect_words(&load_model(&model).expect_err("broken"), words);
}

pub(crate) fn expect_words(error: &str, words: &[&str]) {
    assert!(!error.contains('\n'), "{error}");
    for word in words.iter().chain(&["model.gl"]) {
        assert!(error.contains(word), "no {word:?} in: {error}");
    }
}

pub(crate) fn has_note(scene: &Scene, words: &str) -> bool {
    scene.notes.iter().any(|n| n.to_string().contains(words))
}

pub(crate) fn glb(model: &Value, binary: &[u8]) -> Vec<u8> {
    let mut json = model.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, data) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(data);
    }
    bytes
}

/// The triangle as a GLB.
pub(crate) fn triangle_glb() -> Vec<u8> {
    let mut model = triangle();
    let binary = floats(&[0.0, 0.0, 3.0, 1.0, 0.0, 3.0, 0.0, 2.0, 3.0]);
    model["buffers"] = json!([{"byteLength": binary.len()}]);
    glb(&model, &binary)
}
