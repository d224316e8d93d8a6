//! Forty million rays at real models: the wide BSP, alone and in batches, against another structure, and against every triangle.
//!
//! The models lie in `../shared/models` beside this repository; where they are not there, nothing is tested. It takes three quarters of an hour on one busy core:
//! `cargo test --release --test sweep_shared -- --ignored --nocapture`.

#[path = "support/random.rs"]
mod random;

use std::path::{Path, PathBuf};

use bspray::accel::{Accelerator, AcceleratorKind, BspQuality, BuildOptions, Hit};
use bspray::geometry::{Interval, Ray, Triangle};
use bspray::import;
use bspray::scene::Scene;
use glam::{DVec3, Vec3};
use random::Random;
use rayon::prelude::*;

/// Rays in all.
const RAYS: usize = 40_000_000;

/// Ray-triangle tests by brute force for each model.
const TESTS: usize = 4_000_000_000;

/// Rays asked at once.
const BATCH: usize = 1024;

fn models(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for path in entries.filter_map(|e| Some(e.ok()?.path())) {
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default();
        if path.is_dir() {
            models(&path, found);
        } else if ["obj", "gltf", "glb"].contains(&extension) {
            found.push(path);
        }
    }
}

/// All triangles in world space, as near as single precision has them.
fn triangles(scene: &Scene) -> Vec<Triangle> {
    let mut all = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh as usize];
        let place = |v: u32| {
            let p: DVec3 = mesh.positions[v as usize].as_dvec3();
            instance.world_from_object.transform_point3(p).as_vec3()
        };
        let corners = mesh.triangles.iter().map(|t| t.map(place));
        all.extend(corners.map(|[a, b, c]| Triangle::new(a, b, c)));
    }
    all
}

/// A ray at a corner, an edge or the inside of some triangle, from afar, from another triangle, along an axis, or ending about there.
fn ray(random: &mut Random, triangles: &[Triangle], middle: Vec3, size: f32) -> Ray {
    let point = |random: &mut Random| {
        let [a, b, c] =
            *triangles[random.integer(0, triangles.len() as i64 - 1) as usize].corners();
        match random.integer(0, 5) {
            0 => a,
            1 => a.lerp(b, random.unit() as f32),
            _ => {
                let (u, v) = (random.unit() as f32, random.unit() as f32);
                let (u, v) = if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                };
                a + u * (b - a) + v * (c - a)
            }
        }
    };
    let aim = point(random);
    match random.integer(0, 7) {
        0 | 1 => Ray::new(middle + 2.0 * size * random.vector(), Vec3::ZERO).towards(aim),
        2 => {
            let axis = random.pick(&[Vec3::X, Vec3::Y, Vec3::Z]);
            Ray::new(aim - 2.0 * size * axis, axis)
        }
        3 => {
            let from = point(random);
            Ray::new(from, aim - from).within(Interval::new(1e-4, 1.0))
        }
        4 => Ray::new(middle + 1e4 * size * random.vector(), Vec3::ZERO).towards(aim),
        _ => Ray::new(point(random), random.vector()).within(Interval::new(1e-4, f32::INFINITY)),
    }
}

trait Towards {
    fn towards(self, aim: Vec3) -> Self;
}

impl Towards for Ray {
    fn towards(mut self, aim: Vec3) -> Self {
        self.direction = aim - self.origin;
        self
    }
}

fn bits(hit: Option<Hit>) -> Option<(u32, u32, u32)> {
    hit.map(|h| (h.t.to_bits(), h.instance, h.triangle))
}

/// Rays asked, and those of them that every triangle was tested for.
fn sweep(path: &Path, count: usize) -> (usize, usize) {
    // What is refused is the importers' affair.
    let Ok(scene) = import::load(&[path.to_owned()]) else {
        return (0, 0);
    };
    let triangles = triangles(&scene);
    let bounds = triangles
        .iter()
        .fold(bspray::geometry::Aabb::EMPTY, |b, t| b.union(t.bounds()));
    let (middle, size) = (
        0.5 * (bounds.min + bounds.max),
        (bounds.max - bounds.min).length(),
    );
    let build = |kind: AcceleratorKind, quality| {
        kind.build_with(
            &scene,
            &BuildOptions {
                quality,
                ..BuildOptions::default()
            },
        )
    };
    let trees: Vec<Box<dyn Accelerator>> = BspQuality::ALL
        .map(|q| build(AcceleratorKind::Bsp, q))
        .into();
    let other = build(AcceleratorKind::Bvh2, BspQuality::Default);
    let linear = build(AcceleratorKind::Linear, BspQuality::Default);
    let by_force = (TESTS / triangles.len()).min(count);
    let step = count.div_ceil(by_force.max(1));
    let mut random = Random::new(1_125, triangles.len() as u64);
    let mut judged = 0;
    for first in (0..count).step_by(BATCH) {
        let rays: Vec<Ray> = (0..BATCH)
            .map(|_| ray(&mut random, &triangles, middle, size))
            .collect();
        let tree = &trees[first / BATCH % trees.len()];
        let (mut hits, mut flags) = (vec![None; BATCH], vec![false; BATCH]);
        tree.closest_hits(&rays, &mut hits);
        tree.any_hits(&rays, &mut flags);
        for (index, ray) in rays.iter().enumerate() {
            let told = format!("{}: {ray:?}", path.display());
            let alone = tree.closest_hit(ray);
            assert_eq!(
                bits(alone),
                bits(hits[index]),
                "alone and in a batch, {told}"
            );
            assert_eq!(tree.any_hit(ray), alone.is_some(), "any alone, {told}");
            assert_eq!(flags[index], alone.is_some(), "any in a batch, {told}");
            assert_eq!(
                bits(alone),
                bits(other.closest_hit(ray)),
                "bsp and bvh2, {told}"
            );
            if (first + index) % step == 0 {
                judged += 1;
                assert_eq!(
                    bits(alone),
                    bits(linear.closest_hit(ray)),
                    "bsp and linear, {told}"
                );
            }
        }
    }
    (count.next_multiple_of(BATCH), judged)
}

#[test]
#[ignore = "takes half an hour"]
fn forty_million_rays_have_the_answers_of_other_structures() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    let mut paths = Vec::new();
    models(&folder, &mut paths);
    paths.sort();
    if paths.is_empty() {
        eprintln!("skipped: there are no models in {}", folder.display());
        return;
    }
    let each = RAYS / paths.len() + RAYS / 500;
    let counts: Vec<_> = paths.par_iter().map(|path| sweep(path, each)).collect();
    let rays: usize = counts.iter().map(|c| c.0).sum();
    let judged: usize = counts.iter().map(|c| c.1).sum();
    let models = counts.iter().filter(|c| c.0 > 0).count();
    eprintln!(
        "{rays} rays at {models} models; {judged} of them against every triangle: no difference"
    );
    assert!(rays >= RAYS, "{rays}");
}
