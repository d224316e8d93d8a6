//! glTF 2.0 and GLB, through the crate `gltf`.

use std::path::Path;

use super::ImportError;
use crate::scene::Scene;

pub(super) fn load(file: &Path, _bytes: Vec<u8>) -> Result<Scene, ImportError> {
    Err(ImportError::unsupported(file, "file", "glTF"))
}
