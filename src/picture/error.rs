//! Why a picture could not be read or written.

use std::any::Any;
use std::path::{Path, PathBuf};

/// Why a picture could not be read or written. Each names the file and the cause in one line.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file may be right, but uses something that is not supported.
    #[error("{}: {cause}", path.display())]
    Unsupported {
        /// The file, or the name that was given for the bytes.
        path: PathBuf,
        /// What is not supported, and what is.
        cause: String,
    },
    /// The file, or the picture to be written, contradicts itself.
    #[error("{}: {cause}", path.display())]
    Invalid {
        /// The file, or the name that was given for the bytes.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
    /// The system would not read or write the file.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

impl PictureError {
    /// An error of the system about `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    pub(super) fn unsupported(path: &Path, cause: impl Into<String>) -> Self {
        Self::Unsupported {
            path: path.to_owned(),
            cause: one_line(cause.into()),
        }
    }

    pub(super) fn invalid(path: &Path, cause: impl Into<String>) -> Self {
        Self::Invalid {
            path: path.to_owned(),
            cause: one_line(cause.into()),
        }
    }
}

/// What a panic said, for decoders that are known to panic on broken files.
pub(super) fn panic_message(panic: &(dyn Any + Send)) -> String {
    let words = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!(
        "the decoder gave up: {}",
        words.unwrap_or("no reason given")
    )
}

/// Foreign messages, and texts from files that they cite, may hold line breaks.
fn one_line(text: String) -> String {
    text.split(char::is_control).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_one_line_and_name_the_file() {
        let error = PictureError::invalid(Path::new("a/b.exr"), "channel \"x\ny\"\r twice");
        assert_eq!(error.to_string(), "a/b.exr: channel \"x y\"  twice");
    }

    #[test]
    fn a_panic_keeps_its_words() {
        let panic = std::panic::catch_unwind(|| std::panic::panic_any("no such tile"))
            .expect_err("it panics");
        assert_eq!(
            panic_message(panic.as_ref()),
            "the decoder gave up: no such tile"
        );
    }
}
