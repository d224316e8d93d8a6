//! Words to standard output and standard error, neither of which fails when nobody reads them.

use std::io::{ErrorKind, Write};

use bspray::scene::Scene;
use serde_json::Value;

/// Writes a result to standard output.
///
/// # Errors
/// A closed pipe, which [`is_broken_pipe`] recognises, and other errors of the system.
pub(super) fn result(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    if !text.ends_with('\n') {
        out.write_all(b"\n")?;
    }
    Ok(out.flush()?)
}

/// Writes a report to standard output: as one JSON object, or in words.
///
/// # Errors
/// As [`result`].
pub(super) fn report(
    report: &Value,
    as_json: bool,
    words: impl FnOnce(&Value) -> String,
) -> anyhow::Result<()> {
    result(&if as_json {
        format!("{report:#}")
    } else {
        words(report)
    })
}

/// Whether the error says that the reader of standard output has gone (`| head`), which is no failure.
pub(super) fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let io = error.downcast_ref::<std::io::Error>();
    io.is_some_and(|e| e.kind() == ErrorKind::BrokenPipe)
}

/// Writes a line to standard error. If nobody reads it there is nobody to tell.
pub(super) fn message(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Notes or defects that are told one by one; `inspect` lists all.
const TOLD: usize = 12;

/// Tells what was noticed while the scene was read, and what of it was dropped.
pub(super) fn tell_of(scene: &Scene) {
    tell("note", &scene.notes);
    tell("dropped", &scene.defects);
}

/// Tells notes or defects, a line each, as many as a reader wants.
fn tell(kind: &str, messages: &[impl std::fmt::Display]) {
    messages
        .iter()
        .take(TOLD)
        .for_each(|m| message(&format!("{kind}: {m}")));
    if messages.len() > TOLD {
        message(&format!(
            "{kind}: {} more, which `bspray inspect` lists",
            messages.len() - TOLD
        ));
    }
}

/// Writes an error with its causes as one line to standard error. A cause that the words before it end with already is not
/// said again: errors of files cite the system's.
pub(super) fn error(error: &anyhow::Error) {
    let mut line = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !line.ends_with(&cause) {
            line = format!("{line}: {cause}");
        }
    }
    message(&format!("error: {line}"));
}
