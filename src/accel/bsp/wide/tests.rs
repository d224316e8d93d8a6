//! Tests of the wide tree as a whole, and what those of its parts share.

use super::*;
use crate::accel::bake;
use crate::accel::counters::Uncounted;
use crate::geometry::Interval;
use crate::scene::{Instance, Part, Scene, TriangleMesh};
use glam::{DAffine3, Mat3};

/// Numbers in -1..1 from a seed (SplitMix64).
pub(super) struct Numbers(pub(super) u64);

impl Numbers {
    pub(super) fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    pub(super) fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// Small triangles, needles through the whole, and a floor whose corners lie on a grid.
fn scene() -> Scene {
    let mut numbers = Numbers(7);
    let mut positions = Vec::new();
    for _ in 0..4500 {
        let middle = numbers.point();
        positions.extend([0; 3].map(|_| middle + 0.1 * numbers.point()));
    }
    for _ in 0..100 {
        let (a, b) = (numbers.point(), numbers.point());
        positions.extend([a, b, b + 1e-4 * numbers.point()]);
    }
    for cell in 0..64 {
        let corner = Vec3::new((cell % 8) as f32, 0.0, (cell / 8) as f32) * 0.25 - Vec3::ONE;
        positions.extend([corner, corner + 0.25 * Vec3::X, corner + 0.25 * Vec3::Z]);
    }
    let count = positions.len() as u32 / 3;
    let mesh = TriangleMesh {
        positions,
        triangles: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        parts: vec![Part {
            first_triangle: 0,
            triangle_count: count,
            material: 0,
        }],
        ..TriangleMesh::default()
    };
    let instance = Instance::new("soup", 0, DAffine3::IDENTITY);
    Scene {
        meshes: vec![mesh],
        instances: vec![instance],
        ..Scene::default()
    }
}

pub(super) fn set(quality: BspQuality) -> WideSet {
    set_along(None, quality)
}

pub(super) fn set_along(axes: Option<Axes>, quality: BspQuality) -> WideSet {
    set_grown(axes, quality, Growth::Whole)
}

pub(super) fn set_grown(axes: Option<Axes>, quality: BspQuality, growth: Growth) -> WideSet {
    let set = bake::bake(&scene()).sets.remove(0);
    let options = BuildOptions {
        quality,
        ..BuildOptions::default()
    };
    WideSet::build_along(axes, set, &options, growth)
}

/// Axes unlike those of space.
pub(super) fn turned() -> Axes {
    Axes::new(Mat3::from_axis_angle(Vec3::ONE.normalize(), 0.5))
}

/// From near and far, along axes and grid lines, of all lengths, and within bounds.
pub(super) fn rays() -> Vec<Ray> {
    let mut numbers = Numbers(11);
    (0..6000)
        .map(|i| {
            let on_grid = |v: Vec3| (v * 8.0).round() / 8.0;
            let (mut from, mut to) = (2.0 * numbers.point(), numbers.point());
            if i % 3 == 0 {
                (from, to) = (on_grid(from), on_grid(to));
            }
            if i % 5 == 0 {
                from *= 1000.0;
            }
            let scale = [1.0, 1e-9, 3e8, 1e-3][i % 4];
            let mut ray = Ray::new(from, (to - from) * scale);
            if i % 7 == 0 {
                let t = numbers.next().abs() / scale;
                ray = ray.within(Interval::new(0.1 * t, t));
            }
            ray
        })
        .collect()
}

#[test]
fn every_set_of_instructions_gives_the_answer_of_testing_everything() {
    let rays = rays();
    let along = |axes| BspQuality::ALL.map(|quality| (axes, quality, Growth::Whole));
    let whole = [None, Some(turned())].into_iter().flat_map(along);
    let reached = [
        (None, BspQuality::Default, Growth::Reached),
        (Some(turned()), BspQuality::Fast, Growth::ReachedAlone),
    ];
    for (axes, quality, growth) in whole.chain(reached) {
        let mut tree = set_grown(axes, quality, growth);
        let before = tree.stats();
        assert_eq!(before.unbuilt_triangles > 0, growth != Growth::Whole);
        let mut hits = 0;
        for ray in &rays {
            let mut nearest = Nearest::of(ray);
            if ray.is_traceable() {
                tree.test_everything(ray, None, &mut nearest, &mut Uncounted);
            }
            let truth = nearest.hit();
            hits += usize::from(truth.is_some());
            for instructions in Instructions::available() {
                tree.instructions = instructions;
                let found = tree.closest_alone(ray, &mut Uncounted);
                assert_eq!(found, truth, "{instructions:?} {quality} {axes:?} {ray:?}");
                let any = tree.any_alone(ray, &mut Uncounted);
                assert_eq!(
                    any,
                    truth.is_some(),
                    "{instructions:?} {quality} {axes:?} {ray:?}"
                );
            }
        }
        assert!(hits > rays.len() / 3, "{hits} hits");
        let after = tree.stats();
        assert!(after.unbuilt_triangles < before.triangles / 10);
        assert_eq!(after.triangles, before.triangles);
    }
}

#[test]
fn only_cells_that_rays_reach_are_built() {
    let tree = set_grown(None, BspQuality::Default, Growth::Reached);
    let before = tree.stats();
    // Nothing lies beside.
    let beside = Ray::new(Vec3::new(9.0, 9.0, 9.0), Vec3::X);
    assert_eq!(tree.closest_alone(&beside, &mut Uncounted), None);
    assert_eq!(tree.stats(), before);
    let corner = Ray::new(Vec3::splat(-3.0), Vec3::new(1.0, 1.01, 0.99))
        .within(crate::geometry::Interval::new(0.0, 2.1));
    tree.any_alone(&corner, &mut Uncounted);
    let after = tree.stats();
    let built = before.unbuilt_triangles - after.unbuilt_triangles;
    assert!(
        0 < built && built < before.unbuilt_triangles / 2,
        "{before:?} {after:?}"
    );
    assert!(after.nodes > before.nodes && after.depth >= before.depth);
}

#[test]
fn the_tree_is_the_same_for_any_number_of_threads() {
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| set(BspQuality::Default))
    };
    let (one, four) = (build(1), build(4));
    let (one, four) = (&one.tree.store, &four.tree.store);
    assert_eq!(*one.words, *four.words);
    assert_eq!(one.nodes.len(), four.nodes.len());
    for (a, b) in one.nodes.iter().zip(&*four.nodes) {
        assert_eq!((a.bounds, a.children), (b.bounds, b.children));
    }
}

#[test]
fn copies_of_triangles_are_dropped_where_nobody_misses_them() {
    let mut scene = scene();
    let mesh = &mut scene.meshes[0];
    let count = mesh.triangles.len();
    // Again in another order of corners, and the first of all thrice.
    let again = |&[a, b, c]: &[u32; 3]| [b, c, a];
    let copies: Vec<_> = mesh.triangles.iter().map(again).collect();
    mesh.triangles.extend(copies);
    mesh.triangles.push([2, 1, 0]);
    mesh.parts[0].triangle_count = mesh.triangles.len() as u32;
    let build = |drops_copies| {
        let set = bake::bake(&scene).sets.remove(0);
        let options = BuildOptions {
            quality: BspQuality::Fast,
            drops_copies,
            ..BuildOptions::default()
        };
        WideSet::build_along(None, set, &options, Growth::Whole)
    };
    let (all, once) = (build(false), build(true));
    let members = |set: &WideSet| set.tree.store.all_triangles().map(|(n, _)| n).collect();
    let (of_all, of_once): (Vec<u32>, Vec<u32>) = (members(&all), members(&once));
    assert_eq!(of_all.len(), 2 * count + 1);
    // Where a cell of copies was halved by number, some are left.
    assert!(of_once.len() <= count + count / 100, "{}", of_once.len());
    assert!((0..count as u32).all(|n| of_once.contains(&n)));
    assert!(once.stats().bytes < all.stats().bytes * 2 / 3);
    for ray in rays() {
        let closest = |set: &WideSet| set.closest_alone(&ray, &mut Uncounted);
        assert_eq!(closest(&once), closest(&all), "{ray:?}");
    }
}

#[test]
fn fragments_stay_within_their_allowance() {
    let triangles = set(BspQuality::Fast).names.count() as usize;
    let members = |quality| set(quality).tree.store.all_triangles().count();
    assert_eq!(members(BspQuality::Fast), triangles);
    let default = members(BspQuality::Default);
    assert!(triangles < default && default <= 2 * triangles, "{default}");
    assert!(members(BspQuality::Best) <= 3 * triangles);
}
