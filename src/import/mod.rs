//! From model files to a [`Scene`]: OBJ with MTL, glTF and GLB.
//!
//! An importer gives every element of a file a place in the scene, or a note or defect that says why not. It fails only when
//! the file cannot be read as what it claims to be, needs an extension that is not supported, or holds nothing that can be
//! rendered.

mod budget;
mod clean;
mod gltf;
mod images;
mod line;
mod obj;
mod same;
mod smooth;
mod weld;

use std::path::{Path, PathBuf};

use self::budget::{Budget, Refusal};
use self::line::one_line;
use crate::scene::{Scene, ShownDetail};

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
    /// Reading the file would take more memory than [`ImportOptions::memory_limit`].
    #[error("{}: {element}: {cause}", file.display())]
    Memory {
        /// The file.
        file: PathBuf,
        /// The first element for which there is none left.
        element: String,
        /// What it would take, of what, and what to do about it.
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
            element: one_line(element),
            cause: one_line(cause),
        }
    }

    pub(crate) fn invalid(
        file: &Path,
        element: impl Into<String>,
        cause: impl Into<String>,
    ) -> Self {
        Self::Invalid {
            file: file.to_owned(),
            element: one_line(element),
            cause: one_line(cause),
        }
    }
}

/// What to show of files that offer a choice. The default is what the file shows by itself, at rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// The name of the variant (glTF, KHR_materials_variants) of which the materials are shown.
    pub variant: Option<String>,
    /// Shade faces that meet at this angle or less (degrees, between their normals) as one smooth surface where the file gives no normals.
    pub crease_angle: Option<f32>,
    /// The moment of an animation that poses nodes, skins and morph targets (glTF).
    pub moment: Option<Moment>,
    /// Most memory that reading all the files may take, in bytes, estimated from what they claim before it is allocated. `None`: three
    /// quarters of the machine's memory, or no limit where that is not known.
    pub memory_limit: Option<u64>,
    /// Read only where things are: all materials are plain ones without textures, faces of glTF files are not smoothed, and no broken triangle of theirs is dropped, so that
    /// two moments of an animation have the same triangles.
    pub geometry_only: bool,
    /// Keep meshes and vertices that a file holds several times as they are, instead of one mesh that is placed several times, and one vertex of several triangles.
    pub keeps_copies: bool,
    /// The images of which textures are read. The others are only looked for, and white where they are looked up.
    pub textures: TextureNeeds,
}

/// What textures must be there for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum TextureNeeds {
    /// For what has holes.
    Alpha,
    /// Also for the directions of normals.
    Normals,
    /// For all that light does.
    #[default]
    All,
}

/// Says of a scene whose images are not there yet what of each is shown; `None` for those that are to be whole, and nothing at all if all are.
pub type ShownImages<'a> = dyn Fn(&Scene) -> Vec<Option<ShownDetail>> + Sync + 'a;

/// A moment of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Index of the animation in its file.
    pub animation: usize,
    /// Seconds from the animation's zero. Before its first keyframes these are shown, after its last those.
    pub seconds: f64,
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
    load_with(files, &ImportOptions::default())
}

/// Reads several files into one scene, as [`load`] does, and shows of them what `options` ask for.
///
/// Files without animations, or without variants, stay as they are.
///
/// # Errors
/// As [`load`], and where a file has animations, but not this one, or none of the files has any; so for variants.
///
/// # Example
/// ```
/// use bspray::import::{ImportOptions, load_with};
///
/// let options = ImportOptions { variant: Some("red".to_owned()), ..ImportOptions::default() };
/// let error = load_with(&["models/lecture-objects.gltf".into()], &options);
/// assert!(error.unwrap_err().to_string().ends_with("variant \"red\": is not there: the file has none"));
/// ```
pub fn load_with(files: &[PathBuf], options: &ImportOptions) -> Result<Scene, ImportError> {
    load_all(files, options, None, &mut 0)
}

/// Reads several files into one scene, as [`load_with`] does, and keeps of every image the levels of detail that are shown.
///
/// `shown` is asked before the images of a single glTF file are read, each of which is made coarser before the next one is read; in other cases afterwards.
///
/// # Errors
/// As [`load_with`].
pub fn load_shown(
    files: &[PathBuf],
    options: &ImportOptions,
    shown: &ShownImages,
) -> Result<Scene, ImportError> {
    load_all(files, options, Some(shown), &mut 0)
}

/// Reads several files into one scene at a moment of an animation, as [`load_with`] does, and their geometry (see [`ImportOptions::geometry_only`]) at the moments `step` seconds before
/// and after it. All three share one memory limit.
///
/// # Errors
/// As [`load_with`], also for the moments beside.
pub fn load_with_neighbors(
    files: &[PathBuf],
    options: &ImportOptions,
    moment: Moment,
    step: f64,
) -> Result<(Scene, [Scene; 2]), ImportError> {
    let mut used = 0;
    let now = ImportOptions {
        moment: Some(moment),
        ..options.clone()
    };
    let scene = load_all(files, &now, None, &mut used)?;
    let mut beside = |step: f64| {
        let moment = Moment {
            seconds: moment.seconds + step,
            ..moment
        };
        let options = ImportOptions {
            moment: Some(moment),
            geometry_only: true,
            ..options.clone()
        };
        load_all(files, &options, None, &mut used)
    };
    let neighbors = [beside(-step)?, beside(step)?];
    Ok((scene, neighbors))
}

/// Reads several files, of whose memory `used` bytes are gone, and then more.
fn load_all(
    files: &[PathBuf],
    options: &ImportOptions,
    shown: Option<&ShownImages>,
    used: &mut u64,
) -> Result<Scene, ImportError> {
    let mut scene = Scene::default();
    // A camera may look at all of the files.
    let shown_at_once = shown.filter(|_| files.len() == 1);
    let (mut has_animations, mut has_variants) = (false, false);
    let limit = options.memory_limit.unwrap_or_else(budget::default_limit);
    for file in files {
        let (read, used_with_it) = load_file(file, options, shown_at_once, (limit, *used))?;
        *used = used_with_it;
        // A file may bring light or a view to the models of the others.
        let brings_more = !read.scene.lights.is_empty() || !read.scene.cameras.is_empty();
        if files.len() == 1 || !brings_more || !read.scene.defects.is_empty() {
            check_not_empty(file, &read.scene)?;
        }
        has_animations |= read.has_animations;
        has_variants |= read.has_variants;
        scene.append(read.scene);
    }
    if let Some(file) = files.first() {
        check_not_empty(file, &scene)?;
    }
    let moment = options.moment.filter(|_| !has_animations);
    let animation = moment.map(|m| format!("animation {}", m.animation));
    let variant = options.variant.as_ref().filter(|_| !has_variants);
    let missing = animation.or(variant.map(|v| format!("variant {v:?}")));
    match (missing, files.first()) {
        (Some(missing), Some(file)) => {
            let cause = "is not there: the file has none";
            Err(ImportError::invalid(file, missing, cause))
        }
        _ => {
            if let Some(shown) = shown.filter(|_| shown_at_once.is_none()) {
                let shown = shown(&scene);
                scene.keep_shown(&shown);
            }
            Ok(scene)
        }
    }
}

/// A scene, with what its file offers to choose from.
struct FileRead {
    scene: Scene,
    has_animations: bool,
    has_variants: bool,
}

impl From<Scene> for FileRead {
    fn from(scene: Scene) -> Self {
        Self {
            scene,
            has_animations: false,
            has_variants: false,
        }
    }
}

/// Reads a file within a memory of `limit` bytes, of which `used` are gone. Also gives how many are gone with it.
fn load_file(
    file: &Path,
    options: &ImportOptions,
    shown: Option<&ShownImages>,
    (limit, used): (u64, u64),
) -> Result<(FileRead, u64), ImportError> {
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
    let budget = Budget::new(limit, used);
    let out_of_memory = |Refusal { element, cause }| ImportError::Memory {
        file: file.to_owned(),
        element: one_line(element),
        cause,
    };
    let _ = budget.charge(metadata.len(), || "file".to_owned());
    if let Some(refusal) = budget.refusal() {
        return Err(out_of_memory(refusal));
    }
    let bytes = std::fs::read(file).map_err(|e| ImportError::io(file, e))?;
    let used = budget.used();
    let read = load_bytes(file, &bytes, options, shown, &budget);
    if let Some(mut refusal) = budget.refusal() {
        drop(read);
        // Threads ask for memory in no order; one alone meets the same element always.
        let alone = Budget::new(limit, used);
        if let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() {
            drop(pool.install(|| load_bytes(file, &bytes, options, shown, &alone)));
            refusal = alone.refusal().unwrap_or(refusal);
        }
        return Err(out_of_memory(refusal));
    }
    Ok((read?, budget.used()))
}

fn load_bytes(
    file: &Path,
    bytes: &[u8],
    options: &ImportOptions,
    shown: Option<&ShownImages>,
    budget: &Budget,
) -> Result<FileRead, ImportError> {
    let mut read = match format_of(file, bytes) {
        Some(Format::Obj) => {
            let mut scene = obj::load(file, bytes, options, budget)?;
            if let Some(shown) = shown {
                let shown = shown(&scene);
                scene.keep_shown(&shown);
            }
            scene.into()
        }
        Some(Format::Gltf) => gltf::load(file, bytes, options, shown, budget)?,
        None => {
            let cause = "is no model that bspray reads (OBJ, glTF, GLB)";
            return Err(ImportError::unsupported(file, "file", cause));
        }
    };
    read.scene.files.insert(0, file.to_owned());
    if !options.keeps_copies && !options.geometry_only {
        weld::join_vertices(&mut read.scene, file);
        same::share_meshes(&mut read.scene, file);
    }
    Ok(read)
}

fn check_not_empty(file: &Path, scene: &Scene) -> Result<(), ImportError> {
    if scene.placed_triangles() == 0 {
        let dropped: u64 = scene.defects.iter().map(|d| d.count).sum();
        let cause = match scene.defects.first() {
            Some(first) => format!(
                "nothing left to render: {dropped} broken faces dropped, the first: {}",
                first.cause
            ),
            None => match scene.notes.first() {
                Some(note) => format!(
                    "nothing to render: no triangles ({}: {})",
                    note.element, note.text
                ),
                None => "nothing to render: no triangles".to_owned(),
            },
        };
        return Err(ImportError::invalid(file, "scene", cause));
    }
    Ok(())
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
