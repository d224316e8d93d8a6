//! The painter's picture: fragments drawn over one another in the polygon BSP's order from behind to in front. It must be the traced picture, triangle by triangle.
//!
//! A fragment covers a pixel if the pixel's own ray hits one of its triangles, by the crate's exact test, at a point in the fragment's cell, by rational
//! numbers: no tolerance anywhere. The painter has no depths. Where the ray hits several triangles at one and the same `t` (through an edge that they share, or where they coincide), any of
//! them may be the last that is drawn, and tracing has the one of the least name: there, and only there, the names may differ.
//!
//! Instances have trees of their own, and the painter no order among these: of their pictures, each pixel takes the nearest.

mod canvas;
#[path = "../support/random.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod random;
#[path = "../support/rational.rs"]
mod rational;
#[path = "../support/scenes.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod scenes;
#[path = "../support/soup.rs"]
mod soup;

use std::path::Path;

use bspray::accel::bsp::polygon::SceneTrees;
use bspray::accel::{AcceleratorKind, BspOrder, BuildOptions, Hit, TestSpaces};
use bspray::geometry::Triangle;
use bspray::picture::Samples;
use bspray::render::{CameraWishes, Integrator, SkyMode, Stage, frame_scene, layers, render};
use bspray::scene::{Camera, CameraFrame, Instance, Projection, Scene};
use canvas::{Canvas, trace_fronts};
use glam::{DAffine3, DVec3, Vec3};
use random::Random;
use rayon::prelude::*;

/// Pixels that met something, and those where two triangles were met at one `t` and another was drawn than traced.
#[derive(Clone, Copy, Debug, Default)]
struct Agreement {
    met: usize,
    ties: usize,
}

/// Paints and traces, and compares the names of what is seen, pixel by pixel.
fn compare(
    name: &str,
    scene: &Scene,
    camera: &CameraFrame,
    size: (u32, u32),
    options: &BuildOptions,
) -> Agreement {
    let spaces = TestSpaces::of(scene);
    let trees = SceneTrees::build(scene, options);
    let center = |x: u32, y: u32| camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5, Some((x, y)));
    let canvases: Vec<Canvas> = trees
        .placements()
        .iter()
        .map(|placed| {
            let ray = match placed.instance {
                Some((instance, _)) => spaces.test(scene, &center(0, 0), instance, 0).0,
                None => center(0, 0),
            };
            Canvas::new(&trees, placed, ray.origin)
        })
        .collect();
    let accelerator = AcceleratorKind::default().build(scene);
    // The traced picture of names is that of the program: the layers `id` and `prim`.
    let stage = Stage::new(scene, &*accelerator, Vec3::Y, SkyMode::Auto);
    assert!(!stage.has_alpha, "{name}: the painter paints everything");
    let render_options = scenes::options(size, 1, Integrator::Facing);
    let never = std::sync::atomic::AtomicBool::new(false);
    let picture = layers(&render(&stage, camera, &render_options, &never), camera);
    let channel = |name: &str| match picture.channel(name) {
        Some(Samples::U32(values)) => values.clone(),
        other => panic!("{other:?}"),
    };
    let (ids, prims) = (channel("id"), channel("prim"));
    let pixel = |index: usize| {
        let (x, y) = (index as u32 % size.0, index as u32 / size.0);
        let ray = center(x, y);
        let mut agreement = Agreement::default();
        for fronts_only in [false, true] {
            let painted = canvases
                .iter()
                .filter_map(|c| c.paint(scene, &spaces, &ray, fronts_only))
                .min_by(|a, b| {
                    let key = |h: &Hit| (h.instance, h.triangle);
                    a.t.total_cmp(&b.t).then(key(a).cmp(&key(b)))
                });
            let traced = if fronts_only {
                trace_fronts(scene, &spaces, &*accelerator, &ray)
            } else {
                let hit = accelerator.closest_hit(&ray);
                let pair = hit.map_or((u32::MAX, u32::MAX), |h| (h.instance, h.triangle));
                assert_eq!(pair, (ids[index], prims[index]), "{name} at {x},{y}");
                hit
            };
            let t = |hit: Option<Hit>| hit.map(|h| h.t.to_bits());
            if t(painted) != t(traced) {
                return Err(format!(
                    "{name}, {} at {x},{y}: {painted:?} is painted, {traced:?} is traced",
                    options.order
                ));
            }
            agreement.met += usize::from(traced.is_some());
            agreement.ties += usize::from(painted != traced);
        }
        Ok(agreement)
    };
    let pixels = (size.0 * size.1) as usize;
    let sum = |a: Agreement, b: Agreement| {
        Ok(Agreement {
            met: a.met + b.met,
            ties: a.ties + b.ties,
        })
    };
    let all = (0..pixels).into_par_iter().map(pixel);
    // One complaint, not one a pixel.
    all.try_reduce(Agreement::default, sum)
        .unwrap_or_else(|complaint| panic!("{complaint}"))
}

fn load(path: &Path) -> Scene {
    bspray::import::load(&[path.to_owned()]).expect("a model")
}

fn model(name: &str) -> Scene {
    load(
        &Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("models")
            .join(name),
    )
}

fn from(eye: Vec3, target: Vec3, size: (u32, u32)) -> CameraFrame {
    let camera = Camera {
        name: String::new(),
        position: eye,
        focal_point: target,
        view_up: Vec3::Y,
        projection: Projection::Perspective { view_angle: 45.0 },
    };
    camera.frame(size.0, size.1).expect("it sees something")
}

/// As `render` chooses it.
fn framed(scene: &Scene, size: (u32, u32)) -> CameraFrame {
    let aspect = f64::from(size.0) / f64::from(size.1);
    let camera = frame_scene(scene, &CameraWishes::default(), Vec3::Y, aspect);
    camera.frame(size.0, size.1).expect("it sees something")
}

const SIZE: (u32, u32) = (48, 36);

#[test]
fn the_painter_sees_the_lectures_examples_in_every_order_as_they_are_traced() {
    // The lecture's two eyes; one in the planes of two faces, one in that of the caps, and one within the block.
    let eyes = [
        Vec3::new(0.5, 3.0, 2.0),
        Vec3::new(3.0, 3.0, -1.0),
        Vec3::new(4.0, 1.0, 1.0),
        Vec3::new(5.0, 2.0, 0.0),
        Vec3::new(0.25, 0.75, 0.5),
    ];
    let (block, edges) = (model("lecture-block.obj"), model("lecture-edges.obj"));
    for order in BspOrder::ALL {
        for merges_coplanar in [false, true] {
            let options = BuildOptions {
                order,
                merges_coplanar,
                ..BuildOptions::default()
            };
            for eye in eyes {
                let camera = from(eye, Vec3::new(0.9, 0.8, 0.45), SIZE);
                let seen = compare("the block", &block, &camera, SIZE, &options);
                assert!(
                    seen.met > 200 && seen.ties * 20 < seen.met,
                    "{eye}: {seen:?}"
                );
            }
            let camera = from(Vec3::new(1.5, -7.0, 5.0), Vec3::new(3.4, 2.0, 0.3), SIZE);
            let seen = compare("the edges", &edges, &camera, SIZE, &options);
            assert!(seen.met > 200 && seen.ties * 20 < seen.met, "{seen:?}");
        }
    }
}

#[test]
fn the_painter_sees_the_models_as_they_are_traced() {
    // The still life has instances that are turned, stretched and shared.
    for name in ["cornell-box.obj", "concave.obj", "lecture-objects.gltf"] {
        let scene = model(name);
        for order in [BspOrder::File, BspOrder::Sah] {
            let options = BuildOptions {
                order,
                ..BuildOptions::default()
            };
            let seen = compare(name, &scene, &framed(&scene, SIZE), SIZE, &options);
            assert!(
                seen.met > 600 && seen.ties * 50 < seen.met,
                "{name}: {seen:?}"
            );
        }
    }
}

#[test]
fn the_painter_sees_soups_and_their_instances_as_they_are_traced() {
    for seed in 0..3 {
        let mut random = Random::new(seed, 7);
        let loose: Vec<Triangle> = (0..40)
            .map(|_| {
                let [a, b, c] = [0; 3].map(|_| random.vector() * 3.0 + 2.5);
                Triangle::new(a, b, c)
            })
            .collect();
        let on_grid = soup::tangle(&mut random, 40);
        for (name, triangles) in [("loose triangles", loose), ("a tangle", on_grid)] {
            let single = soup::scene_of(&triangles);
            let mut placed = soup::scene_of(&triangles);
            placed.instances = [
                DAffine3::IDENTITY,
                DAffine3::from_translation(DVec3::new(4.1, 0.3, -2.0)),
                DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7),
                // Mirrored and stretched.
                DAffine3::from_scale(DVec3::new(-0.7, 1.3, 1.0)),
            ]
            .map(|place| Instance::new("", 0, place))
            .to_vec();
            for scene in [&single, &placed] {
                let eye = Vec3::new(1.3, 2.7, 9.1) + random.vector();
                let camera = from(eye, Vec3::splat(2.5), SIZE);
                let seen = compare(name, scene, &camera, SIZE, &BuildOptions::default());
                // On the grid many triangles coincide.
                let most = if name == "a tangle" { 2 } else { 50 };
                assert!(
                    seen.met > 600 && seen.ties * most < seen.met,
                    "{name}: {seen:?}"
                );
            }
        }
    }
}

/// Models of tens of thousands of triangles, beside this repository; where they are not there, nothing is tested.
#[test]
#[ignore = "takes a minute"]
fn the_painter_sees_large_models_as_they_are_traced() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    let size = (40, 30);
    for name in [
        "obj/teapot.obj",
        "obj/wingnut.obj",
        "obj/sword-quads.obj",
        "obj/bunny.obj",
    ] {
        let path = folder.join(name);
        if !path.exists() {
            continue;
        }
        let scene = load(&path);
        let seen = compare(
            name,
            &scene,
            &framed(&scene, size),
            size,
            &BuildOptions::default(),
        );
        println!("{name}: {seen:?}");
        assert!(
            seen.met > 200 && seen.ties * 20 < seen.met,
            "{name}: {seen:?}"
        );
    }
}
