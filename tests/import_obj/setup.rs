//! Files that are loaded, and what is looked at of them.

use std::path::Path;

use bspray::import::{self, ImportError};
use bspray::scene::{Scene, TriangleMesh};

/// Three vertices of a right triangle with legs 2 and 1, and a fourth that makes a rectangle.
pub(crate) const V: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";

/// Loads the first of some files; they lie in one folder.
pub(crate) fn load_files(files: &[(&str, &[u8])]) -> Result<Scene, ImportError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let scene = import::load(&[folder.path().join(files[0].0)])?;
    for mesh in &scene.meshes {
        assert_eq!(mesh.validate(), Ok(()));
    }
    Ok(scene)
}

pub(crate) fn load(text: impl AsRef<[u8]>) -> Result<Scene, ImportError> {
    load_files(&[("model.obj", text.as_ref())])
}

pub(crate) fn area(mesh: &TriangleMesh) -> f32 {
    (0..mesh.triangles.len() as u32)
        .map(|t| {
            let [a, b, c] = *mesh.triangle(t).corners();
            (b - a).cross(c - a).length() / 2.0
        })
        .sum()
}

pub(crate) fn notes(scene: &Scene) -> Vec<String> {
    scene
        .notes
        .iter()
        .map(|n| format!("{}: {}", n.element, n.text))
        .collect()
}

/// A model of this project.
pub(crate) fn load_model(name: &str) -> Result<Scene, ImportError> {
    import::load(&[Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("models")
        .join(name)])
}
