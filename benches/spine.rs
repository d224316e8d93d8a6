//! The cost of everything around tracing: scaling over threads, the tile loop with camera, sampler and film, and import.
//!
//! `cargo bench --bench spine [-- MODEL]`; without a model, `models/lecture-objects.gltf` serves. Ratios come from one run, their sides taken in turns; the median and the spread (quartiles) are
//! printed as a Markdown table. Every render is checked against the number of rays it must send before it is timed.

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use std::fmt::Write;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use bspray::accel::{Accelerator, AcceleratorKind, BuildStats, Hit, TraceCounters};
use bspray::geometry::Ray;
use bspray::render::{
    CameraWishes, Film, Integrator, PixelFilter, PixelRect, RenderOptions, SkyMode, Stage,
    frame_scene, render,
};
use bspray::scene::{Scene, TriangleMesh};
use glam::Vec3;

const SIZE: (u32, u32) = (320, 240);
const SAMPLES: u32 = 8;
const ROUNDS: usize = 15;

fn main() {
    // `cargo test --benches` runs this too, without asking for a measurement.
    if !std::env::args().any(|a| a == "--bench") {
        println!("run with `cargo bench --bench spine`");
        return;
    }
    let own = || Path::new(env!("CARGO_MANIFEST_DIR")).join("models/lecture-objects.gltf");
    let named = std::env::args().skip(1).find(|a| !a.starts_with("--"));
    let model = named.map_or_else(own, PathBuf::from);
    println!("| measured | median | quartiles |\n|---|---:|---:|");
    rendering(&model);
    import(&model);
}

/// Scaling over two threads, and what is not tracing.
fn rendering(model: &Path) {
    let scene = bspray::import::load(&[model.to_owned()]).expect("the model loads");
    let accelerator = AcceleratorKind::default().build(&scene);
    let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::On);
    let name = model
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let pool = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads start")
    };
    let (one, two) = (pool(1), pool(2));

    let film = one.install(|| picture(&stage, Integrator::Direct));
    let expected = u64::from(SIZE.0) * u64::from(SIZE.1) * u64::from(SAMPLES);
    assert_eq!(film.rays().eye, expected, "every sample sends one eye ray");
    assert_eq!(
        film.rays(),
        two.install(|| picture(&stage, Integrator::Direct)).rays()
    );

    let time = |pool: &rayon::ThreadPool, stage: &Stage, integrator| {
        seconds(|| {
            black_box(pool.install(|| picture(stage, integrator)));
        })
    };
    let ratios =
        rounds(|| time(&one, &stage, Integrator::Direct) / time(&two, &stage, Integrator::Direct));
    row(&format!("{name}: speed of two threads over one"), ratios);

    // The same picture without a scene: what remains is the tile loop, camera, sampler, filter and film.
    let nothing = Nothing;
    let empty = Scene::default();
    let bare = Stage::new(&empty, &nothing, Vec3::Y, SkyMode::On);
    let rays = recorded_rays(&stage);
    assert_eq!(rays.0.len() as u64, expected);
    let tracing = || {
        seconds(|| {
            rays.0.iter().for_each(|r| {
                black_box(accelerator.closest_hit(r));
            });
            rays.1.iter().for_each(|r| {
                black_box(accelerator.any_hit(r));
            });
        })
    };
    let ratios = rounds(|| time(&one, &bare, Integrator::Facing) / tracing());
    row(
        &format!("{name}: tile loop, camera, sampler and film over tracing"),
        ratios,
    );
}

/// Import speed of the model's triangles, so many times over that the file is some tens of megabytes, in MB/s on one core.
fn import(model: &Path) {
    let scene = bspray::import::load(&[model.to_owned()]).expect("the model loads");
    let mesh = &scene.meshes[0];
    let name = model
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let copies = 1_000_000_usize.div_ceil(mesh.triangles.len());
    let folder = tempfile::tempdir().expect("a folder for the files");
    for (file, bytes, goal) in [
        ("a.obj", obj(mesh, copies), 100),
        ("a.glb", glb(mesh, copies), 150),
    ] {
        let path = folder.path().join(file);
        let size = bytes.len() as f64 / 1e6;
        std::fs::write(&path, bytes).expect("the file is written");
        let one = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .expect("threads start");
        let load = || {
            one.install(|| bspray::import::load(std::slice::from_ref(&path)))
                .expect("the copy loads")
        };
        assert_eq!(
            load().placed_triangles(),
            (mesh.triangles.len() * copies) as u64
        );
        let speeds = rounds(|| {
            size / seconds(|| {
                black_box(load());
            })
        });
        row(
            &format!("{name} x {copies} as {file}, {size:.0} MB: import, MB/s (goal {goal})"),
            speeds,
        );
    }
}

fn obj(mesh: &TriangleMesh, copies: usize) -> Vec<u8> {
    let mut text = String::new();
    for copy in 0..copies {
        for p in &mesh.positions {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        let first = copy * mesh.positions.len() + 1;
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|v| v as usize + first);
            let _ = writeln!(text, "f {a} {b} {c}");
        }
    }
    text.into_bytes()
}

fn glb(mesh: &TriangleMesh, copies: usize) -> Vec<u8> {
    let (vertices, triangles) = (mesh.positions.len() * copies, mesh.triangles.len() * copies);
    let positions = mesh
        .positions
        .iter()
        .flat_map(|p| p.to_array())
        .flat_map(f32::to_le_bytes)
        .collect::<Vec<_>>();
    let mut data = positions.repeat(copies);
    for copy in 0..copies {
        let first = (copy * mesh.positions.len()) as u32;
        data.extend(
            mesh.triangles
                .iter()
                .flatten()
                .flat_map(|v| (v + first).to_le_bytes()),
        );
    }
    let json = serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5125, "count": triangles * 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": vertices * 12 },
            { "buffer": 0, "byteOffset": vertices * 12, "byteLength": triangles * 12 },
        ],
        "buffers": [{ "byteLength": data.len() }],
    });
    let json = json.to_string();
    let length = json.len().next_multiple_of(4);
    let mut glb = b"glTF".to_vec();
    for word in [2, (12 + 8 + length + 8 + data.len()) as u32, length as u32] {
        glb.extend(word.to_le_bytes());
    }
    glb.extend(b"JSON");
    glb.extend(format!("{json:length$}").bytes());
    glb.extend((data.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(data);
    glb
}

fn picture(stage: &Stage, integrator: Integrator) -> Film {
    let camera = frame_scene(
        stage.scene,
        &CameraWishes::default(),
        Vec3::Y,
        f64::from(SIZE.0) / f64::from(SIZE.1),
    );
    let frame = camera
        .frame(SIZE.0, SIZE.1)
        .expect("the camera sees the scene");
    let options = RenderOptions {
        size: SIZE,
        window: PixelRect {
            x: 0,
            y: 0,
            width: SIZE.0,
            height: SIZE.1,
        },
        samples: SAMPLES,
        noise: None,
        seed: 0,
        integrator,
        filter: PixelFilter::BlackmanHarris,
        counts_cost: false,
        wants_layers: false,
    };
    render(stage, &frame, &options, &AtomicBool::new(false))
}

/// The eye rays and the shadow rays of the picture.
fn recorded_rays(stage: &Stage) -> (Vec<Ray>, Vec<Ray>) {
    let recorder = Recorder {
        inner: stage.accelerator,
        eye: Default::default(),
        shadow: Default::default(),
    };
    let stage = Stage::new(stage.scene, &recorder, Vec3::Y, SkyMode::On);
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("threads start");
    one.install(|| picture(&stage, Integrator::Direct));
    let take =
        |rays: &std::sync::Mutex<Vec<Ray>>| std::mem::take(&mut *rays.lock().expect("one thread"));
    (take(&recorder.eye), take(&recorder.shadow))
}

/// Passes rays on and keeps them.
struct Recorder<'a> {
    inner: &'a dyn Accelerator,
    eye: std::sync::Mutex<Vec<Ray>>,
    shadow: std::sync::Mutex<Vec<Ray>>,
}

impl Accelerator for Recorder<'_> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.eye.lock().expect("one thread").push(*ray);
        self.inner.closest_hit(ray)
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        self.shadow.lock().expect("one thread").push(*ray);
        self.inner.any_hit(ray)
    }

    fn closest_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> Option<Hit> {
        self.inner.closest_hit_counted(ray, counters)
    }

    fn any_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> bool {
        self.inner.any_hit_counted(ray, counters)
    }

    fn build_stats(&self) -> BuildStats {
        self.inner.build_stats()
    }
}

/// Hits nothing, at no cost.
struct Nothing;

impl Accelerator for Nothing {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        black_box(ray);
        None
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        black_box(ray);
        false
    }

    fn closest_hit_counted(&self, ray: &Ray, _: &mut TraceCounters) -> Option<Hit> {
        self.closest_hit(ray)
    }

    fn any_hit_counted(&self, ray: &Ray, _: &mut TraceCounters) -> bool {
        self.any_hit(ray)
    }

    fn build_stats(&self) -> BuildStats {
        BuildStats::default()
    }
}

fn seconds(work: impl FnOnce()) -> f64 {
    let started = Instant::now();
    work();
    started.elapsed().as_secs_f64()
}

fn rounds(mut once: impl FnMut() -> f64) -> Vec<f64> {
    once();
    (0..ROUNDS).map(|_| once()).collect()
}

fn row(name: &str, mut values: Vec<f64>) {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share).round() as usize];
    println!(
        "| {name} | {:.3} | {:.3} to {:.3} |",
        at(0.5),
        at(0.25),
        at(0.75)
    );
}
