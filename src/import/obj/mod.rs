//! OBJ with MTL, through the crate `tobj`.

use std::path::Path;

use super::ImportError;
use crate::scene::Scene;

pub(super) fn load(file: &Path, _bytes: &[u8]) -> Result<Scene, ImportError> {
    Err(ImportError::unsupported(file, "file", "OBJ"))
}
