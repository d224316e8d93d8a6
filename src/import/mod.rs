//! From model files to a [`Scene`]: OBJ with MTL, glTF and GLB.
//!
//! An importer gives every element of a file a place in the scene, or a note or defect that says why not. It fails only when
//! the file cannot be read as what it claims to be, needs an extension that is not supported, or holds nothing that can be
//! rendered.

mod clean;
mod gltf;
mod images;
mod obj;

use std::path::{Path, PathBuf};

use crate::scene::Scene;

/// Why a file gave no scene. Each names the file, the element and the cause in one line.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file, or one that it needs, could not be read.
    #[error("{}: cannot read: {source}", file.display())]
    Io {
        /// The file that could not be read.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is well formed, but uses something that is not supported.
    #[error("{}: {element}: {cause}", file.display())]
    Unsupported {
        /// The file.
        file: PathBuf,
        /// The element, with its line or index.
        element: String,
        /// What is not supported, and what to do about it.
        cause: String,
    },
    /// The file is broken, or holds nothing that can be rendered.
    #[error("{}: {element}: {cause}", file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// The element, with its line or index.
        element: String,
        /// What is wrong.
        cause: String,
    },
}

impl ImportError {
    pub(crate) fn io(file: &Path, source: std::io::Error) -> Self {
        Self::Io {
            file: file.to_owned(),
            source,
        }
    }

    pub(crate) fn unsupported(
        file: &Path,
        element: impl Into<String>,
        cause: impl Into<String>,
    ) -> Self {
        Self::Unsupported {
            file: file.to_owned(),
            element: element.into(),
            cause: cause.into(),
        }
    }

    pub(crate) fn invalid(
        file: &Path,
        element: impl Into<String>,
        cause: impl Into<String>,
    ) -> Self {
        Self::Invalid {
            file: file.to_owned(),
            element: element.into(),
            cause: cause.into(),
        }
    }
}

/// The formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    Gltf,
}

/// Reads several files into one scene, in the order given.
///
/// The format is told by the extension (`.obj`, `.gltf`, `.glb`, in any case), and by the first bytes of a file
/// with another one.
///
/// # Errors
/// The first file that gives no scene ends the import with an [`ImportError`].
pub fn load(files: &[PathBuf]) -> Result<Scene, ImportError> {
    let mut scene = Scene::default();
    for file in files {
        scene.append(load_file(file)?);
    }
    Ok(scene)
}

fn load_file(file: &Path) -> Result<Scene, ImportError> {
    let metadata = std::fs::metadata(file).map_err(|e| ImportError::io(file, e))?;
    if metadata.is_dir() {
        return Err(ImportError::invalid(
            file,
            "file",
            "is a directory, not a model",
        ));
    }
    if !metadata.is_file() {
        // A device may have no end, and a pipe no writer.
        let cause = "is not a regular file: copy what it gives to one";
        return Err(ImportError::invalid(file, "file", cause));
    }
    let bytes = std::fs::read(file).map_err(|e| ImportError::io(file, e))?;
    let mut scene = match format_of(file, &bytes) {
        Some(Format::Obj) => obj::load(file, &bytes)?,
        Some(Format::Gltf) => gltf::load(file, bytes)?,
        None => {
            let cause = "is no model that bspray reads (OBJ, glTF, GLB)";
            return Err(ImportError::unsupported(file, "file", cause));
        }
    };
    if scene.placed_triangles() == 0 {
        let dropped: u64 = scene.defects.iter().map(|d| d.count).sum();
        let cause = match scene.defects.first() {
            Some(first) => format!(
                "nothing left to render: {dropped} broken faces dropped, the first: {}",
                first.cause
            ),
            None => "nothing to render: no triangles".to_owned(),
        };
        return Err(ImportError::invalid(file, "scene", cause));
    }
    scene.files.insert(0, file.to_owned());
    Ok(scene)
}

fn format_of(file: &Path, bytes: &[u8]) -> Option<Format> {
    let extension = file
        .extension()
        .and_then(|e| e.to_str())
        .map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("obj") => Some(Format::Obj),
        Some("gltf" | "glb") => Some(Format::Gltf),
        _ if bytes.starts_with(b"glTF") => Some(Format::Gltf),
        _ if bytes.trim_ascii_start().starts_with(b"{") => Some(Format::Gltf),
        _ => None,
    }
}
