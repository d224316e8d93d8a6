//! Loading under a memory limit, and a good triangle to be made bad.

use std::path::Path;
use std::time::{Duration, Instant};

use bspray::import::{ImportOptions, Moment};
use bspray::scene::Scene;
use serde_json::{Value, json};

use crate::import_contract::load_checked;

/// The memory that cases may ask for.
pub(crate) const MEMORY: u64 = 64 << 20;

/// Beyond this, a case counts as a hang. All take a second at most; the rest is for slow and busy machines.
const PATIENCE: Duration = Duration::from_secs(60);

/// Options with a limit, and with a moment if the file can have one.
pub(crate) fn options(memory: u64, is_animated: bool) -> ImportOptions {
    ImportOptions {
        memory_limit: Some(memory),
        moment: is_animated.then_some(Moment {
            animation: 0,
            seconds: 0.5,
        }),
        ..ImportOptions::default()
    }
}

/// Loads bytes as a file `name` of a folder of its own.
pub(crate) fn load(name: &str, bytes: &[u8]) -> Result<Scene, String> {
    load_within(name, bytes, &options(MEMORY, false))
}

pub(crate) fn load_within(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<Scene, String> {
    let folder = tempfile::tempdir().expect("a folder");
    load_in(folder.path(), name, bytes, options)
}

pub(crate) fn load_in(
    folder: &Path,
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<Scene, String> {
    let file = folder.join(name);
    std::fs::write(&file, bytes).expect("written");
    let start = Instant::now();
    let loaded = load_checked(&file, options);
    assert!(start.elapsed() < PATIENCE, "{name}: {:?}", start.elapsed());
    loaded
}

/// Why a glTF file does not load; the error must hold all `words`.
pub(crate) fn refused(model: &Value, words: &[&str]) {
    expect(
        &load("model.gltf", model.to_string().as_bytes()).expect_err("refused"),
        words,
    );
}

pub(crate) fn expect(error: &str, words: &[&str]) {
    for word in words {
        assert!(error.contains(word), "no {word:?} in: {error}");
    }
}

/// A triangle without indices: buffer view and accessor 0 hold its positions.
pub(crate) fn triangle() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        // (0, 0, 0), (1, 0, 0), (0, 1, 0).
        "buffers": [{"byteLength": 36, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    })
}

/// Adds an item to an array of the file.
pub(crate) fn add(model: &mut Value, key: &str, item: Value) {
    let items = model[key].as_array_mut().expect("an array");
    items.push(item);
}
