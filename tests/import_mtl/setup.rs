//! Files that are loaded, and what is looked at of them.

use bspray::scene::{Material, Scene};

pub(crate) use super::obj_files::*;

pub(crate) fn load_with_mtl(obj: &str, mtl: &str) -> Scene {
    load_files(&[("model.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]).unwrap()
}

/// A triangle, with a material of the MTL given.
pub(crate) fn material(mtl: &str) -> (Scene, Material) {
    let scene = load_with_mtl(&format!("mtllib a.mtl\n{V}usemtl m\nf 1 2 3\n"), mtl);
    let material = scene.materials[0].clone();
    (scene, material)
}

pub(crate) fn png(rgba: [u8; 4]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_pixel(2, 3, image::Rgba(rgba));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
