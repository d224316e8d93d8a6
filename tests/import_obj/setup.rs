//! Files that are loaded, and what is looked at of them.

use std::path::Path;

use bspray::import::{self, ImportError};
use bspray::scene::{Scene, TriangleMesh};

pub(crate) use super::obj_files::*;

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

/// A model of this project.
pub(crate) fn load_model(name: &str) -> Result<Scene, ImportError> {
    import::load(&[Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("models")
        .join(name)])
}
