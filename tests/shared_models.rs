//! Real models that nobody on this project made: each loads, has the triangles that its list says, and renders; or says in one
//! line why not.
//!
//! The models lie in `../shared/models` beside this repository, with the list in their README.md. Where they are not there, nothing
//! is tested.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use bspray::accel::extents::{ExtentSet, ExtentsLoop, View};
use bspray::accel::{Accelerator, AcceleratorKind, BuildOptions};
use bspray::import::{self, ImportOptions};
use bspray::render::{
    CameraWishes, Integrator, LightSearch, PixelFilter, PixelRect, RenderOptions, SkyMode, Stage,
    frame_scene, render,
};
use bspray::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;

/// What the list says of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Listed {
    /// Triangles of its meshes.
    triangles: u64,
    /// Triangles as placed.
    placed: u64,
}

/// Files that give no scene, a word of the reason that they must tell, and why that is right.
const REFUSED: &[(&str, &str, &str)] = &[
    (
        "obj/awkward/issue-140-zero-face-idx.obj",
        "vertex 0",
        "faces count from 1",
    ),
    (
        "obj/awkward/number_formats.obj",
        "without area",
        "its one triangle has its corners on a line",
    ),
    (
        "obj/awkward/zero_area_face.obj",
        "without area",
        "its one triangle has no area",
    ),
    (
        "obj/awkward/inf_nan.obj",
        "not a finite number",
        "its one triangle has infinite and undefined corners",
    ),
];

/// Files of which fewer triangles are kept and dropped than the list counts by fanning each polygon: how many fewer, and why.
const MERGED: &[(&str, u64, &str)] = &[
    (
        "obj/ficus/ficus.obj",
        6406,
        "so many quads have two neighbouring corners at one place, and are triangles",
    ),
    (
        "obj/peterbilt/peterbilt.obj",
        4,
        "so many polygons name one corner twice in a row",
    ),
];

fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    if folder.join("README.md").is_file() {
        return Some(folder);
    }
    eprintln!("skipped: there are no models in {}", folder.display());
    None
}

/// The tables of the list: rows of file, size, vertices and triangles (`18 (24 placed)`).
fn listed(readme: &str) -> BTreeMap<String, Listed> {
    let number = |text: &str| text.replace(',', "").parse::<u64>().ok();
    let row = |line: &str| {
        let mut cells = line.strip_prefix("| `")?.split(" | ");
        let file = cells.next()?.strip_suffix('`')?;
        let count = cells.nth(2)?;
        let (triangles, placed) = match count.split_once(" (") {
            Some((all, placed)) => (number(all)?, number(placed.strip_suffix(" placed)")?)?),
            None => (number(count)?, number(count)?),
        };
        Some((file.to_owned(), Listed { triangles, placed }))
    };
    readme.lines().filter_map(row).collect()
}

/// Model files below a folder, as paths relative to `root` with slashes.
fn models_below(root: &Path, folder: &Path, found: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            models_below(root, &path, found);
        } else if path
            .extension()
            .is_some_and(|e| ["obj", "gltf", "glb"].iter().any(|x| e == *x))
        {
            let relative = path.strip_prefix(root).expect("below the root");
            found.insert(relative.to_string_lossy().replace('\\', "/"));
        }
    }
}

fn exception<T: Copy>(table: &[(&str, T, &str)], file: &str) -> Option<T> {
    table.iter().find(|row| row.0 == file).map(|row| row.1)
}

#[test]
fn the_list_and_the_exceptions_are_of_the_files_that_are_there() {
    let Some(folder) = folder() else { return };
    let list = listed(&std::fs::read_to_string(folder.join("README.md")).unwrap());
    let mut found = BTreeSet::new();
    models_below(&folder, &folder, &mut found);
    assert_eq!(list.keys().cloned().collect::<BTreeSet<_>>(), found);
    assert!(found.len() >= 74, "{}", found.len());
    let excepted = REFUSED.iter().map(|row| row.0);
    let excepted = excepted.chain(MERGED.iter().map(|row| row.0));
    for file in excepted {
        assert!(found.contains(file), "{file} is no model");
    }
}

#[test]
fn every_model_has_its_triangles_and_renders_or_says_why_not() {
    let Some(folder) = folder() else { return };
    let list = listed(&std::fs::read_to_string(folder.join("README.md")).unwrap());
    let complaints: Vec<String> = list
        .par_iter()
        .flat_map_iter(|(file, listed)| {
            let path = folder.join(file);
            let files = std::slice::from_ref(&path);
            // Copies of meshes are in the list as the file has them.
            let whole = ImportOptions {
                keeps_copies: true,
                ..ImportOptions::default()
            };
            let found = match import::load(files) {
                Ok(scene) => {
                    let whole = import::load_with(files, &whole).expect("it loads");
                    check_scene(file, &scene, &whole, *listed)
                }
                Err(error) => check_error(file, &path, &error.to_string()),
            };
            found
                .into_iter()
                .map(move |words| format!("{file}: {words}"))
        })
        .collect();
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

fn check_error(file: &str, path: &Path, error: &str) -> Vec<String> {
    let mut complaints = Vec::new();
    match exception(REFUSED, file) {
        None => complaints.push(format!("does not load: {error}")),
        Some(word) if !error.contains(word) => {
            complaints.push(format!("does not say {word:?}: {error}"));
        }
        Some(_) => {}
    }
    let start = format!("{}: ", path.display());
    // Behind the file come element and cause.
    if error.lines().count() != 1
        || error
            .strip_prefix(&start)
            .is_none_or(|rest| !rest.contains(": "))
    {
        complaints.push(format!("not a line of file, element and cause: {error}"));
    }
    complaints
}

fn check_scene(file: &str, scene: &Scene, whole: &Scene, listed: Listed) -> Vec<String> {
    let mut complaints = Vec::new();
    if let Some(word) = exception(REFUSED, file) {
        complaints.push(format!("loads, and should not for {word}"));
    }
    let kept: u64 = whole.meshes.iter().map(|m| m.triangles.len() as u64).sum();
    let dropped: u64 = scene.defects.iter().map(|d| d.count).sum();
    let merged = exception(MERGED, file).unwrap_or(0);
    if kept + dropped + merged != listed.triangles {
        complaints.push(format!(
            "{kept} triangles kept, {dropped} dropped, {merged} merged, of {} listed",
            listed.triangles
        ));
    }
    let placed = scene.placed_triangles();
    // What is dropped from a mesh is dropped wherever it is placed: only files without instances drop anything.
    let want = listed.placed - dropped - merged;
    if placed != want {
        complaints.push(format!("{placed} triangles placed, not {want}"));
    }
    // Stored once or not, every instance shows the triangles and the materials that it had.
    for (index, (instance, was)) in scene.instances.iter().zip(&whole.instances).enumerate() {
        let materials = |scene: &Scene, instance| -> Vec<(u32, u32)> {
            let parts = scene.parts_of(instance);
            parts.map(|p| (p.triangle_count, p.material)).collect()
        };
        if materials(scene, instance) != materials(whole, was) {
            complaints.push(format!("instance {index} shows other materials"));
        }
    }
    for mesh in &scene.meshes {
        if let Err(error) = mesh.validate() {
            complaints.push(format!("mesh {:?}: {error}", mesh.name));
        }
    }
    for integrator in LIT {
        let of = |complaint| format!("{}: {complaint}", integrator.name());
        complaints.extend(check_picture(scene, integrator).into_iter().map(of));
    }
    complaints
}

/// The integrators that compute light.
const LIT: [Integrator; 3] = [
    Integrator::Direct,
    Integrator::Whitted { max_depth: 8 },
    Integrator::Path {
        max_depth: 8,
        search: LightSearch::Both,
    },
];

/// Renders 16 x 16 pixels from a camera that sees everything, and from each of the file's: no number is infinite, negative or none at all.
fn check_picture(scene: &Scene, integrator: Integrator) -> Vec<String> {
    let size = (16, 16);
    let accelerator = AcceleratorKind::Bvh2.build(scene);
    let stage = Stage::new(scene, &*accelerator, Vec3::Y, SkyMode::Auto);
    let options = RenderOptions {
        size,
        window: PixelRect {
            x: 0,
            y: 0,
            width: size.0,
            height: size.1,
        },
        samples: 4,
        noise: None,
        seed: 0,
        integrator,
        filter: PixelFilter::Box,
        counts_cost: false,
        wants_layers: true,
    };
    let mut complaints = Vec::new();
    let framed = frame_scene(scene, &CameraWishes::default(), Vec3::Y, 1.0);
    for (index, camera) in std::iter::once(&framed).chain(&scene.cameras).enumerate() {
        let Some(frame) = camera.frame(size.0, size.1) else {
            complaints.push(format!("{camera:?} sees nothing"));
            continue;
        };
        let never = std::sync::atomic::AtomicBool::new(false);
        let film = render(&stage, &frame, &options, &never);
        let pixels = film.map(|pixel| {
            let (sum, first) = (pixel.sum, pixel.first);
            let numbers =
                [sum.color, sum.backdrop].map(|c| c.is_finite() && c.min_element() >= 0.0);
            let mean = pixel.mean();
            let shares = [mean.diffuse_albedo, mean.specular_albedo];
            let is_sound = numbers == [true, true]
                && shares
                    .iter()
                    .all(|s| s.min_element() >= 0.0 && s.max_element() < 1.01)
                && mean.direct.is_finite()
                && mean.indirect.is_finite()
                && mean.normal.length() < 1.0001
                && (0.0..=1.0).contains(&mean.alpha)
                && first.is_none_or(|f| {
                    f.position.is_finite() && f.depth > 0.0 && f.shading_normal.is_normalized()
                });
            let complaint = (!is_sound).then(|| format!("camera {index}: {mean:?} {first:?}"));
            (sum.alpha > 0.0, complaint)
        });
        let covered = pixels.iter().filter(|(is_covered, _)| *is_covered).count();
        complaints.extend(pixels.into_iter().filter_map(|(_, complaint)| complaint));
        if index == 0 && covered == 0 {
            complaints.push("is not seen from the automatic camera".to_owned());
        }
    }
    complaints
}

/// Real scenes of one object and of many, placed once, often and mirrored.
const WITH_EXTENTS: [&str; 6] = [
    "gltf/chess-board.glb",
    "gltf/khronos/NegativeScaleTest/NegativeScaleTest.gltf",
    "gltf/khronos/SimpleInstancing/SimpleInstancing.gltf",
    "gltf/Sponza/Sponza.gltf",
    "obj/city_etoile/etoile.obj",
    "obj/peterbilt/peterbilt.obj",
];

#[test]
fn no_combination_of_extents_changes_a_picture() {
    let Some(folder) = folder() else { return };
    for file in WITH_EXTENTS {
        let scene = import::load(&[folder.join(file)]).unwrap();
        let framed = frame_scene(&scene, &CameraWishes::default(), Vec3::Y, 1.5);
        let camera = scene.cameras.first().unwrap_or(&framed);
        let options = RenderOptions {
            size: (24, 16),
            window: PixelRect {
                x: 0,
                y: 0,
                width: 24,
                height: 16,
            },
            samples: 2,
            noise: None,
            seed: 0,
            integrator: Integrator::Direct,
            filter: PixelFilter::BlackmanHarris,
            counts_cost: false,
            wants_layers: true,
        };
        let frame = camera.frame(24, 16).unwrap();
        let build = BuildOptions {
            view: Some(View {
                camera: frame,
                size: options.size,
                filter_radius: options.filter.radius(),
            }),
            ..BuildOptions::default()
        };
        let picture = |accelerator: &dyn Accelerator| {
            let stage = Stage::new(&scene, accelerator, Vec3::Y, SkyMode::On);
            let never = std::sync::atomic::AtomicBool::new(false);
            let film = render(&stage, &frame, &options, &never);
            let pixels = film.map(|pixel| {
                let bits = pixel.sum.color.to_array().map(f32::to_bits);
                (
                    bits,
                    pixel
                        .first
                        .map(|f| (f.hit.t.to_bits(), f.hit.instance, f.hit.triangle)),
                )
            });
            assert!(pixels.iter().any(|(_, first)| first.is_some()), "{file}");
            pixels
        };
        let want = picture(&*AcceleratorKind::Bsp.build(&scene));
        let mut objects = ExtentsLoop::build(&scene, &build);
        assert!(picture(&objects) == want, "{file}: auto");
        for set in ExtentSet::all() {
            objects.choose(|_| set);
            assert!(picture(&objects) == want, "{file}: {set}");
        }
    }
}

/// Files that hold the same model, and how far their triangles' places may lie apart, as a share of the model's size.
const SAME: &[(&str, &str, f32)] = &[
    (
        "gltf/khronos/Duck/Duck.gltf",
        "gltf/khronos/Duck/draco/Duck.gltf",
        1e-3,
    ),
    (
        "gltf/khronos/Duck/Duck.gltf",
        "gltf/khronos/Duck/quantized/Duck.gltf",
        1e-3,
    ),
    // Decoded by another program, with the same whole numbers.
    ("gltf/chess-board.glb", "gltf/chess-board-draco.glb", 1e-6),
    (
        "gltf/khronos/Box/Box.gltf",
        "gltf/BoxMeshopt/BoxMeshopt.gltf",
        1e-3,
    ),
    (
        "gltf/BoxMeshopt/BoxMeshopt.gltf",
        "gltf/BoxMeshopt/BoxMeshopt.glb",
        1e-6,
    ),
];

/// The box, the area and the mean place of a scene's surface.
fn measures(scene: &Scene) -> [Vec3; 4] {
    let bounds = scene.bounds();
    let (mut area, mut moment) = (0.0_f64, glam::DVec3::ZERO);
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh as usize];
        let point = |v: u32| instance.world_point(mesh.positions[v as usize]).as_dvec3();
        for &t in &mesh.triangles {
            let [a, b, c] = t.map(point);
            let own = (b - a).cross(c - a).length() / 2.0;
            area += own;
            moment += own * (a + b + c) / 3.0;
        }
    }
    let side = Vec3::splat(area.sqrt() as f32);
    [bounds.min, bounds.max, side, (moment / area).as_vec3()]
}

#[test]
fn packed_models_measure_what_the_plain_ones_do() {
    let Some(folder) = folder() else { return };
    for (plain, packed, share) in SAME {
        let scene = |file: &str| import::load(&[folder.join(file)]).expect("loads");
        let (plain_scene, packed_scene) = (scene(plain), scene(packed));
        let most = share * plain_scene.bounds().diagonal();
        let measures = measures(&plain_scene)
            .into_iter()
            .zip(measures(&packed_scene));
        for (a, b) in measures {
            assert!((a - b).length() <= most, "{packed}: {b}, and {plain}: {a}");
        }
    }
}

#[test]
fn rows_of_the_list_are_understood() {
    let text = "| file | size | vertices | triangles | source |\n\
        |---|---:|---:|---:|---|\n\
        | `a b/c.obj` | 2.3 MiB | 35,947 | 1,069,451 | somewhere |\n\
        | `d.glb` | 1 KiB | 36 | 18 (24 placed) | elsewhere (18 (19 placed)) |\n\
        | repository | commit | note |\n";
    let list = listed(text);
    let row = |triangles, placed| Some(Listed { triangles, placed });
    assert_eq!(list.len(), 2);
    assert_eq!(list.get("a b/c.obj").copied(), row(1_069_451, 1_069_451));
    assert_eq!(list.get("d.glb").copied(), row(18, 24));
}
