//! Why Embree cannot be had, or cannot build a scene: each in one line.

use std::path::PathBuf;

/// What went wrong with the foreign library.
#[derive(Debug, thiserror::Error)]
pub enum EmbreeError {
    /// There is no such file, or it cannot be read.
    #[error("{}: {source}", path.display())]
    Missing {
        /// As it was given.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The system does not load it.
    #[error("{} is not a library that can be loaded: {reason}", path.display())]
    NotALibrary {
        /// As it was given.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// A library, but another one.
    #[error("{} is not Embree 4: it has no function {function}", path.display())]
    NotEmbree {
        /// As it was given.
        path: PathBuf,
        /// What it lacks.
        function: &'static str,
    },
    /// Embree, but not version 4.
    #[error("{} is Embree {version}; version 4 is needed", path.display())]
    OtherVersion {
        /// As it was given.
        path: PathBuf,
        /// Major, minor and patch.
        version: String,
    },
    /// Embree 4, compiled so that it passes over triangles seen from the back.
    #[error("{} was compiled to see front faces only; both sides count here", path.display())]
    CullsBackFaces {
        /// As it was given.
        path: PathBuf,
    },
    /// The library itself reports an error.
    #[error("Embree {doing}: {reason}")]
    Device {
        /// What it did not do.
        doing: &'static str,
        /// Its error in words.
        reason: &'static str,
    },
}
