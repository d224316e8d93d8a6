//! The folder from which the targets load, one for the whole run, and the options with which they do.

use std::path::PathBuf;
use std::sync::OnceLock;

use bspray::import::{ImportOptions, Moment};
use tempfile::TempDir;

/// Memory that a file may ask for. The fuzzer's own limit (`-rss_limit_mb`) is above it: a claim that is not charged ends the run.
const MEMORY: u64 = 256 << 20;

/// Writes a file and gives its path. Files of earlier inputs with other names stay.
pub(crate) fn write(name: &str, bytes: &[u8]) -> PathBuf {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| tempfile::tempdir().expect("a folder"));
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("written");
    path
}

/// Options that depend on the input's length only, so that an input has its own always.
pub(crate) fn options(bytes: &[u8]) -> ImportOptions {
    let has_animations = bytes.windows(12).any(|w| w == b"\"animations\"");
    let moment = Moment {
        animation: 0,
        seconds: 0.5,
    };
    ImportOptions {
        crease_angle: (bytes.len() % 4 == 1).then_some(40.0),
        moment: (has_animations && bytes.len() % 4 != 2).then_some(moment),
        memory_limit: Some(MEMORY),
        ..ImportOptions::default()
    }
}

/// Takes away libFuzzer's hook, which ends the process at every panic: the importers catch those of foreign decoders. A panic that
/// leaves the target ends it still.
pub(crate) fn init() {
    let _ = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
}
