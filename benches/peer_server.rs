//! An accelerator behind the line protocol of an outside benchmark, which sends the same rays through several libraries.
//!
//! `cargo run --release --example peer_server -- SCENE.tri --accel NAME [--bsp-quality Q] [--bsp-axes A] [--bsp-instructions I] [--batch]`
//!
//! | it is told | it answers |
//! | --- | --- |
//! | (start) | `ready BUILD_SECONDS BYTES` |
//! | `rays FILE` | `ok COUNT` |
//! | `closest` or `any` | `time WALL_SECONDS CPU_SECONDS` for one pass over those rays, on one thread |
//! | `dump FILE` | writes the last pass's results, then `ok` |
//! | anything else | ends |
//!
//! A `.tri` file is `BTRI`, u32 version, u32 count, u32 0, and 9 `f32` a triangle; a `.ray` file is `BRAY`, u32 version,
//! u32 count, u32 kind, and 8 `f32` a ray: origin, direction, least and greatest `t`. Results are an `f32` `t` and a `u32` triangle a
//! ray (infinite and all ones for a miss), or one byte 0 or 1. All of it is little-endian. The time is that of the
//! loop over the rays, with the turning of a ray into our own form in it. A build of less than a second is the shortest of three, on one thread.

#![allow(clippy::print_stdout, reason = "the protocol is lines on it")]

use std::io::{self, BufRead};

use anyhow::{Context, bail};
use bspray::accel::{
    Accelerator, AcceleratorKind, BspAxes, BspInstructions, BspQuality, BuildOptions, Hit,
};
use bspray::analysis::{Stopwatch, build};
use bspray::geometry::{Interval, Ray};
use bspray::scene::{Instance, Part, Scene, TriangleMesh};
use glam::{DAffine3, Vec3};

/// Rays that a batch holds: a tile of 32 x 32 pixels.
const BATCH: usize = 1024;

/// A ray as the file has it: origin, direction, least and greatest `t`.
type RawRay = [f32; 8];

fn main() -> anyhow::Result<()> {
    let args = Args::parse(std::env::args().skip(1))?;
    let scene = scene(&args.scene)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let once = || args.kind.build_with(&scene, &args.options);
    let (accelerator, cost) = pool.install(|| build(&once, None));
    drop(pool);
    println!("ready {} {}", cost.seconds, accelerator.build_stats().bytes);
    serve(&*accelerator, args.is_batch)
}

struct Args {
    scene: String,
    kind: AcceleratorKind,
    options: BuildOptions,
    is_batch: bool,
}

impl Args {
    fn parse(mut words: impl Iterator<Item = String>) -> anyhow::Result<Self> {
        let mut args = Self {
            scene: String::new(),
            kind: AcceleratorKind::default(),
            options: BuildOptions::default(),
            is_batch: false,
        };
        while let Some(word) = words.next() {
            match &*word {
                "--accel" => {
                    args.kind = choice(&word, &AcceleratorKind::ALL, |k| k.name(), &mut words)?;
                }
                "--bsp-quality" => {
                    let all = BspQuality::ALL;
                    args.options.quality = choice(&word, &all, |q| q.name(), &mut words)?;
                }
                "--bsp-axes" => {
                    args.options.axes = choice(&word, &BspAxes::ALL, |a| a.name(), &mut words)?;
                }
                "--bsp-instructions" => {
                    let mut here = BspInstructions::ALL.to_vec();
                    here.retain(|i| i.is_available());
                    args.options.instructions = choice(&word, &here, |i| i.name(), &mut words)?;
                }
                "--batch" => args.is_batch = true,
                other if args.scene.is_empty() && !other.starts_with("--") => args.scene = word,
                other => bail!("{other}: unknown argument"),
            }
        }
        if args.scene.is_empty() {
            bail!(
                "usage: peer_server SCENE.tri --accel NAME [--bsp-quality Q] [--bsp-axes A] [--bsp-instructions I] [--batch]"
            );
        }
        Ok(args)
    }
}

/// The one of `all` that the next word names.
fn choice<T: Copy>(
    option: &str,
    all: &[T],
    name: impl Fn(T) -> &'static str,
    words: &mut impl Iterator<Item = String>,
) -> anyhow::Result<T> {
    let word = words
        .next()
        .with_context(|| format!("{option} needs a name"))?;
    let found = all.iter().find(|x| name(**x) == word).copied();
    found.with_context(|| format!("{option} {word}: unknown, or not on this machine"))
}

/// The `f32`s of a file, `N` a record.
fn records<const N: usize>(path: &str, magic: &[u8; 4]) -> anyhow::Result<Vec<[f32; N]>> {
    let bytes = std::fs::read(path).with_context(|| path.to_owned())?;
    let words: Vec<[u8; 4]> = bytes.as_chunks::<4>().0.to_vec();
    let count = words.get(2).map_or(0, |w| u32::from_le_bytes(*w) as usize);
    if words.first() != Some(magic) || bytes.len() != 16 + count * N * 4 {
        bail!("{path}: not a file of {}", String::from_utf8_lossy(magic));
    }
    let floats: Vec<f32> = words[4..].iter().map(|w| f32::from_le_bytes(*w)).collect();
    Ok(floats.as_chunks::<N>().0.to_vec())
}

/// One mesh in one place: the triangle's number is its place in the file.
fn scene(path: &str) -> anyhow::Result<Scene> {
    let corners: Vec<[f32; 9]> = records(path, b"BTRI")?;
    let count = corners.len() as u32;
    let mesh = TriangleMesh {
        positions: corners
            .iter()
            .flat_map(|c| [0, 3, 6].map(|i| Vec3::new(c[i], c[i + 1], c[i + 2])))
            .collect(),
        triangles: (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        parts: vec![Part {
            first_triangle: 0,
            triangle_count: count,
            material: 0,
        }],
        ..TriangleMesh::default()
    };
    Ok(Scene {
        meshes: vec![mesh],
        instances: vec![Instance::new("scene", 0, DAffine3::IDENTITY)],
        ..Scene::default()
    })
}

fn ray(raw: &RawRay) -> Ray {
    let [ox, oy, oz, dx, dy, dz, min, max] = *raw;
    Ray::new(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz)).within(Interval::new(min, max))
}

fn serve(accelerator: &dyn Accelerator, is_batch: bool) -> anyhow::Result<()> {
    let mut rays: Vec<RawRay> = Vec::new();
    let (mut hits, mut flags) = (Vec::new(), Vec::new());
    let mut was_any = false;
    for line in io::stdin().lock().lines() {
        let line = line?;
        match line.split_once(' ').unwrap_or((&line, "")) {
            ("rays", path) => {
                rays = records(path, b"BRAY")?;
                hits = vec![None; rays.len()];
                flags = vec![false; rays.len()];
                println!("ok {}", rays.len());
            }
            (mode @ ("closest" | "any"), _) => {
                was_any = mode == "any";
                let watch = Stopwatch::start();
                match (was_any, is_batch) {
                    (false, false) => closest(accelerator, &rays, &mut hits),
                    (true, false) => any(accelerator, &rays, &mut flags),
                    (false, true) => in_batches(&rays, &mut hits, |r, h| {
                        accelerator.closest_hits(r, h);
                    }),
                    (true, true) => in_batches(&rays, &mut flags, |r, h| {
                        accelerator.any_hits(r, h);
                    }),
                }
                let elapsed = watch.elapsed();
                println!("time {} {}", elapsed.wall, elapsed.cpu);
            }
            ("dump", path) => {
                let bytes = if was_any {
                    flags.iter().map(|&f| u8::from(f)).collect()
                } else {
                    hits.iter().flat_map(record).collect::<Vec<u8>>()
                };
                std::fs::write(path, bytes).with_context(|| path.to_owned())?;
                println!("ok");
            }
            _ => break,
        }
    }
    Ok(())
}

fn closest(accelerator: &dyn Accelerator, rays: &[RawRay], hits: &mut [Option<Hit>]) {
    for (raw, hit) in rays.iter().zip(hits) {
        *hit = accelerator.closest_hit(&ray(raw));
    }
}

fn any(accelerator: &dyn Accelerator, rays: &[RawRay], flags: &mut [bool]) {
    for (raw, flag) in rays.iter().zip(flags) {
        *flag = accelerator.any_hit(&ray(raw));
    }
}

fn in_batches<A>(rays: &[RawRay], answers: &mut [A], mut trace: impl FnMut(&[Ray], &mut [A])) {
    let mut batch = Vec::with_capacity(BATCH);
    for (raw, answers) in rays.chunks(BATCH).zip(answers.chunks_mut(BATCH)) {
        batch.clear();
        batch.extend(raw.iter().map(ray));
        trace(&batch, answers);
    }
}

fn record(hit: &Option<Hit>) -> [u8; 8] {
    let (t, triangle) = hit.map_or((f32::INFINITY, u32::MAX), |h| (h.t, h.triangle));
    let ([a, b, c, d], [e, f, g, h]) = (t.to_le_bytes(), triangle.to_le_bytes());
    [a, b, c, d, e, f, g, h]
}
