//! Files that are loaded, and what is looked at of them.

use bspray::import::{self, ImportError};
use bspray::scene::{Material, Scene};

/// Three vertices of a right triangle with legs 2 and 1, and a fourth that makes a rectangle.
pub(crate) const V: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";

/// Loads the first of some files; they lie in one folder.
pub(crate) fn load_files(files: &[(&str, &[u8])]) -> Result<Scene, ImportError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let scene = import::load(&[folder.path().join(files[0].0)])?;
    for mesh in &scene.meshes {
        assert_eq!(mesh.validate(), Ok(()));
    }
    Ok(scene)
}

pub(crate) fn load_with_mtl(obj: &str, mtl: &str) -> Scene {
    load_files(&[("model.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]).unwrap()
}

/// A triangle, with a material of the MTL given.
pub(crate) fn material(mtl: &str) -> (Scene, Material) {
    let scene = load_with_mtl(&format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n"), mtl);
    let material = scene.materials[0].clone();
    (scene, material)
}

pub(crate) fn notes(scene: &Scene) -> Vec<String> {
    scene
        .notes
        .iter()
        .map(|n| format!("{}: {}", n.element, n.text))
        .collect()
}

pub(crate) fn png(rgba: [u8; 4]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_pixel(2, 3, image::Rgba(rgba));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
