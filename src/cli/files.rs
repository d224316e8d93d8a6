//! Which files a command writes, known to be possible before any work is done.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use bspray::picture::ldr;
use bspray::scene::Scene;

use super::UsageError;

/// What a picture's file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OutputKind {
    /// All layers.
    Exr,
    /// Colours, as people see them.
    Display,
}

/// The pictures of a render and what they are: those that were asked for, or one that is named after the first model.
pub(super) fn outputs(
    wanted: &[PathBuf],
    models: &[PathBuf],
    is_report: bool,
) -> anyhow::Result<Vec<(PathBuf, OutputKind)>> {
    if is_report {
        if wanted.is_empty() {
            return Ok(Vec::new());
        }
        bail!(UsageError(
            "--pixel prints a report and writes no picture: leave --output out".to_owned()
        ));
    }
    let paths = if wanted.is_empty() {
        vec![default_output(models, ".png")]
    } else {
        wanted.to_vec()
    };
    let mut outputs: Vec<(PathBuf, OutputKind)> = Vec::new();
    for path in paths {
        let is_exr = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("exr"));
        if !is_exr {
            ldr::LdrFormat::of_path(&path).map_err(|e| UsageError(e.to_string()))?;
        }
        check_writable(&path, outputs.iter().map(|(other, _)| other.as_path()))?;
        outputs.push((
            path,
            if is_exr {
                OutputKind::Exr
            } else {
                OutputKind::Display
            },
        ));
    }
    Ok(outputs)
}

/// The name of the first model, with another ending.
pub(super) fn default_output(models: &[PathBuf], ending: &str) -> PathBuf {
    // Not `with_extension`, which would take "v2" from "scan.v2".
    let name = models.first().and_then(|m| m.file_stem());
    let mut name = name.unwrap_or("picture".as_ref()).to_owned();
    name.push(ending);
    PathBuf::from(name)
}

/// Where the path leads, whether there is a file or not.
fn place(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
        Some(folder.join(path.file_name()?))
    })
}

/// Finds out before long work what would keep its result from being written; `others` are the outputs that were named before.
pub(super) fn check_writable<'a>(
    path: &Path,
    mut others: impl Iterator<Item = &'a Path>,
) -> anyhow::Result<()> {
    let is_file = !path.exists() || path.is_file();
    if others.any(|other| other == path || (is_file && place(other) == place(path))) {
        let cause = format!("{}: is named twice as an output", path.display());
        bail!(UsageError(cause));
    }
    if path.is_dir() {
        bail!("{}: is a directory", path.display());
    }
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    if !folder.is_dir() {
        bail!(
            "{}: there is no folder {}",
            path.display(),
            folder.display()
        );
    }
    // Devices and pipes get the finished content copied; only files need a place beside them.
    if !path.exists() || path.is_file() {
        tempfile::tempfile_in(folder).with_context(|| {
            format!("{}: cannot write into {}", path.display(), folder.display())
        })?;
    }
    Ok(())
}

/// Finds out before long work what would keep a report from being written into a folder, which may be new in one that is there.
pub(super) fn check_folder(folder: &Path) -> anyhow::Result<()> {
    if folder.is_dir() {
        return check_writable(&folder.join("report.html"), std::iter::empty());
    }
    if folder.exists() {
        bail!("{}: is no folder", folder.display());
    }
    check_writable(folder, std::iter::empty())
}

/// Refuses outputs that would replace a file that the scene was read from, such as a texture beside its model.
pub(super) fn spare_inputs<'a>(
    outputs: impl Iterator<Item = &'a Path>,
    scene: &Scene,
) -> anyhow::Result<()> {
    for path in outputs {
        spare(path, scene.files.iter().map(PathBuf::as_path))?;
    }
    Ok(())
}

/// Refuses an output that would replace one of these files.
pub(super) fn spare<'a>(
    path: &Path,
    mut inputs: impl Iterator<Item = &'a Path>,
) -> anyhow::Result<()> {
    let Ok(output) = path.canonicalize() else {
        return Ok(());
    };
    if let Some(input) = inputs.find(|f| f.canonicalize().is_ok_and(|f| f == output)) {
        let cause = format!(
            "{}: would replace an input, {}: choose another name for the output",
            path.display(),
            input.display()
        );
        bail!(UsageError(cause));
    }
    Ok(())
}
