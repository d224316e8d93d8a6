//! OBJ files that are written, loaded and asked for their notes.

use bspray::import::{self, ImportError, ImportOptions};
use bspray::scene::Scene;

/// Three vertices of a right triangle with legs 2 and 1, and a fourth that makes a rectangle.
pub(crate) const V: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";

/// Loads the first of some files; they lie in one folder.
pub(crate) fn load_files(files: &[(&str, &[u8])]) -> Result<Scene, ImportError> {
    load_files_with(files, &ImportOptions::default())
}

/// The same, for what the options ask for.
pub(crate) fn load_files_with(
    files: &[(&str, &[u8])],
    options: &ImportOptions,
) -> Result<Scene, ImportError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let scene = import::load_with(&[folder.path().join(files[0].0)], options)?;
    for mesh in &scene.meshes {
        assert_eq!(mesh.validate(), Ok(()));
    }
    Ok(scene)
}

/// What a scene says of its files.
pub(crate) fn notes(scene: &Scene) -> Vec<String> {
    scene
        .notes
        .iter()
        .map(|n| format!("{}: {}", n.element, n.text))
        .collect()
}
