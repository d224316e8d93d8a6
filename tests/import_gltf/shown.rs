//! Images that are kept as finely as pictures show them.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use bspray::import::{ImportOptions, load_shown};
use bspray::scene::{ColorSpace, Scene, ShownDetail};
use serde_json::json;

use crate::model::*;

/// A file with a material a texture, whose images are of 64 by 32 pixels: `a.png`, `b.png`, and one that is broken, with `a.png` as its fallback.
fn write(folder: &Path, is_broken_shown: bool) -> PathBuf {
    for name in ["a.png", "b.png"] {
        let image = image::RgbImage::from_fn(64, 32, |x, y| image::Rgb([x as u8, y as u8, 9]));
        image.save(folder.join(name)).expect("written");
    }
    let mut model = triangle();
    model["images"] = json!([{"uri": "a.png"}, {"uri": "b.png"}, {"uri": "data:image/webp;base64,UklGRgAAAABXRUJQ"}]);
    let webp = json!({"EXT_texture_webp": {"source": 2}});
    model["textures"] = json!([{"source": 0}, {"source": 1}, {"source": 0, "extensions": webp}]);
    let count = if is_broken_shown { 3 } else { 2 };
    model["materials"] = (0..count)
        .map(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}))
        .collect();
    let primitives = (0..count).map(|i| json!({"attributes": {"POSITION": 0}, "material": i}));
    model["meshes"][0]["primitives"] = primitives.collect();
    let file = folder.join("model.gltf");
    std::fs::write(&file, model.to_string()).expect("written");
    file
}

/// Says that the first image is shown by a fifth of its sides' geometric mean, the second and third whole; keeps what it was told of.
fn loaded(files: &[PathBuf], told: &Mutex<Vec<Scene>>) -> Scene {
    let shown = |scene: &Scene| {
        told.lock().expect("whole").push(scene.clone());
        let detail = ShownDetail {
            width: 0.2,
            space: ColorSpace::Srgb,
        };
        let mut all = vec![None; scene.images.len()];
        all[0] = Some(detail);
        all
    };
    load_shown(files, &ImportOptions::default(), &shown).expect("loads")
}

fn sizes(scene: &Scene) -> Vec<(u32, (u32, u32), usize)> {
    let images = scene.images.iter().filter(|image| image.pixels.is_some());
    images
        .map(|image| {
            assert_eq!((image.width, image.height), (64, 32));
            let bytes = image.bytes() as usize;
            (image.finest, image.size(), bytes)
        })
        .collect()
}

const WHOLE: (u32, (u32, u32), usize) = (0, (64, 32), 64 * 32 * 4);

/// 0.2 of 64 x 32 is 9 texels, between 8 and 16.
const KEPT: (u32, (u32, u32), usize) = (3, (8, 4), 8 * 4 * 4);

#[test]
fn of_one_file_they_are_asked_for_before_they_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = write(folder.path(), false);
    let told = Mutex::default();
    let scene = loaded(&[file], &told);
    assert_eq!(sizes(&scene), [KEPT, WHOLE]);
    let told = told.into_inner().expect("whole");
    let [told] = &told[..] else {
        panic!("asked {} times", told.len())
    };
    assert!(told.images.iter().all(|image| image.pixels.is_none()));
    // Else it is all there.
    assert_eq!(told.materials, scene.materials);
    assert_eq!(told.bounds(), scene.bounds());
    let images = |scene: &Scene| scene.textures.iter().map(|t| t.image).collect::<Vec<_>>();
    assert_eq!(images(told), images(&scene));
}

#[test]
fn of_several_files_they_are_asked_for_when_all_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = write(folder.path(), false);
    let told = Mutex::default();
    let scene = loaded(&[file.clone(), file], &told);
    assert_eq!(sizes(&scene), [KEPT, WHOLE, WHOLE, WHOLE]);
    assert_eq!(told.into_inner().expect("whole").len(), 1);
}

#[test]
fn where_a_fallback_stands_in_all_are_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = write(folder.path(), true);
    let scene = loaded(&[file], &Mutex::default());
    assert_eq!(sizes(&scene), [WHOLE, WHOLE]);
    let image = |i: usize| {
        let texture = scene.materials[i]
            .base_color_texture
            .expect("there")
            .texture;
        scene.textures[texture as usize].image
    };
    assert_eq!([0, 1, 2].map(image), [0, 1, 0]);
    for words in [
        "image 2: left out of its materials",
        "image 0, its fallback, is shown",
    ] {
        assert!(has_note(&scene, words), "{words}: {:#?}", scene.notes);
    }
}

#[test]
fn those_of_an_obj_file_are_made_coarser_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let _ = write(folder.path(), false);
    let file = folder.path().join("model.obj");
    let text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
    std::fs::write(&file, text).expect("written");
    std::fs::write(folder.path().join("m.mtl"), "newmtl m\nmap_Kd a.png\n").expect("written");
    let told = Mutex::default();
    let scene = loaded(&[file], &told);
    assert_eq!(sizes(&scene), [KEPT]);
    assert_eq!(told.into_inner().expect("whole").len(), 1);
}
