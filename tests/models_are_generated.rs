//! The models that are checked in are what the generator makes of its source, byte for byte.

#[path = "../models/generator/mod.rs"]
mod generator;

use std::fs;
use std::path::Path;

use bspray::import;
use bspray::scene::LightKind;

#[test]
fn models_are_what_the_generator_makes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    for file in generator::files().unwrap() {
        let path = folder.join(file.name);
        let found = fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        // Not `assert_eq`, which would print both.
        assert!(
            found == file.contents,
            "{} is not what the generator makes; run `cargo run --example generate-models`",
            path.display()
        );
    }
}

#[test]
fn every_malformed_file_is_generated() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/malformed");
    let files = generator::files().unwrap();
    for entry in fs::read_dir(folder).unwrap() {
        let name = format!("malformed/{}", entry.unwrap().file_name().to_str().unwrap());
        assert!(
            files.iter().any(|f| f.name == name),
            "{name} is not in the table"
        );
    }
}

#[test]
fn a_terrain_has_as_many_triangles_as_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("terrain.glb");
    for triangles in [1, 2, 3, 1001, 20_000] {
        assert!(triangles <= generator::MOST_TRIANGLES);
        fs::write(&path, generator::terrain(triangles)).unwrap();
        let scene = import::load(std::slice::from_ref(&path)).unwrap();
        assert_eq!(scene.placed_triangles(), u64::from(triangles));
        assert!(scene.notes.is_empty() && scene.defects.is_empty());
        let mesh = &scene.meshes[0];
        // All face up: a landscape without overhangs.
        for t in 0..triangles {
            let [a, b, c] = *mesh.triangle(t).corners();
            assert!((b - a).cross(c - a).y > 0.0, "{t}");
        }
    }
    let mesh = &import::load(&[path]).unwrap().meshes[0];
    let highest = mesh.positions.iter().map(|p| p.y).fold(0.0, f32::max);
    assert!((1.0..50.0).contains(&highest), "{highest}");
}

#[test]
fn the_courtyard_loads_whole_and_is_as_large_as_it_says() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/courtyard.glb");
    assert!(fs::metadata(&file).unwrap().len() < 2_500_000);
    let scene = import::load(&[file]).unwrap();
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    assert!(scene.defects.is_empty(), "{:?}", scene.defects);
    let placed: usize = scene
        .instances
        .iter()
        .map(|i| scene.meshes[i.mesh as usize].triangles.len())
        .sum();
    assert!((30_000..=100_000).contains(&placed), "{placed}");
    assert_eq!(scene.cameras.len(), 2);
    let suns = scene.lights.iter();
    let suns = suns.filter(|l| l.kind == LightKind::Directional).count();
    assert_eq!((suns, scene.lights.len()), (1, 6));
    for mesh in &scene.meshes {
        let vertices = mesh.positions.len();
        assert_eq!(mesh.normals.len(), vertices, "{}", mesh.name);
        assert_eq!(mesh.uv_sets[0].len(), vertices, "{}", mesh.name);
        assert!(!mesh.name.is_empty());
    }
    let has = |name: &str| scene.materials.iter().find(|m| m.name == name).unwrap();
    assert!(has("glass").transmission.is_some());
    assert!(has("bronze").metallic > 0.99);
    assert!(has("lamp glass").emissive.x > 1.0);
    assert!(scene.images.iter().all(|i| i.pixels.is_some()));
}

#[test]
fn closed_parts_of_the_courtyard_face_outwards() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/courtyard.glb");
    let scene = import::load(&[file]).unwrap();
    // The divergence theorem: of a closed mesh whose faces look outwards, the volume is positive.
    for name in [
        "column",
        "arcade wall",
        "fountain basin",
        "bronze bowl",
        "glass orb",
        "step",
        "cornice",
        "pot",
    ] {
        let mesh = scene.meshes.iter().find(|m| m.name == name).unwrap();
        let corner = |v: u32| mesh.positions[v as usize].as_dvec3();
        let volume: f64 = mesh
            .triangles
            .iter()
            .map(|t| t.map(corner))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum();
        assert!(volume > 1e-4, "{name}: {volume}");
    }
}

#[test]
fn normals_of_the_courtyard_look_where_its_faces_look() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/courtyard.glb");
    let scene = import::load(&[file]).unwrap();
    for mesh in &scene.meshes {
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            let face = (b - a).cross(c - a).normalize_or_zero();
            for v in triangle {
                let cosine = mesh.normals[*v as usize].dot(face);
                assert!(cosine > 0.3, "{}: {triangle:?} {cosine}", mesh.name);
            }
        }
    }
}
