//! The wide BSP: polygons split into cells by planes, and every cell with the extent of its own point cluster.
//!
//! The lecture's two halves in one structure. Planes divide the polygons into cells ([`plane`], [`build`]); the fragments in a cell are a point
//! cluster, and its extent is what a ray is tested against, eight cells at a time ([`node`], [`simd`]). Leaves hold blocks of up to eight
//! original triangles, tested at once: fragments steer, originals are hit, by the crate's one test ([`RayFrame`]), so that answers are
//! exact and the same for every set of instructions.
//!
//! Kin: the BVH with spatial splits of Stich, Friedrich, Dietrich 2009; the general BSP of Ize, Wald, Parker 2008; early split clipping of Ernst and
//! Greiner 2007.

mod axes;
mod batch;
mod build;
mod collapse;
mod fragment;
mod node;
mod pages;
mod plane;
mod simd;
mod store;
mod top;
mod treelet;
mod walk;

pub(super) use simd::Instructions;
pub(in crate::accel) use top::WideTop;

use std::sync::{Arc, Weak};

use glam::{Vec3, Vec4};

use super::options::{BspAxes, BspQuality, BuildOptions};
use crate::accel::TraceSet;
use crate::accel::bake::TriangleSet;
use crate::accel::counters::{BuildStats, Counter};
use crate::accel::hit::{Hit, Nearest};
use crate::accel::names::Names;
use crate::geometry::{Ray, RayFrame};
use axes::Axes;
use build::Plan;
use fragment::Fragment;
use plane::Costs;
use simd::{Found, Occluded, Tree};
use treelet::{Branch, Part, Source};
use walk::Reach;

pub(in crate::accel) use treelet::Growth;

/// A set of triangles under a wide BSP.
pub(in crate::accel) struct WideSet {
    tree: Branch,
    /// What is left to build its treelets from, while there are any that no ray has reached.
    source: Weak<Source>,
    reach: Reach,
    instructions: Instructions,
    names: Names,
}

/// Costs in the unit of a node's test, found by trial on the scenes of `benches/record`. A division into two costs little, so that the collapse to
/// nodes of eight has much to choose from: with 0.3 instead of 1, and [`collapse`]'s nodes a little dearer, 2.5 % less time a ray, and a quarter more to build.
const COSTS: Costs = Costs {
    step: 0.3,
    leaf: 0.4,
    block: 0.6,
    triangle: 0.02,
};

/// Cells of so few triangles are not divided: to divide them takes a fifth of the build, and no ray gains.
const UNDIVIDED: usize = 3;

fn plan(quality: BspQuality) -> Plan {
    let (bins, allowance, step) = match quality {
        // A dearer step leaves less to divide.
        BspQuality::Fast => ([16, 8], 0.0, 1.0),
        BspQuality::Default => ([32, 16], 1.0, COSTS.step),
        BspQuality::Best => ([32, 32], 2.0, COSTS.step),
    };
    Plan {
        costs: Costs { step, ..COSTS },
        bins,
        undivided: UNDIVIDED,
        allowance,
    }
}

impl WideSet {
    fn tree(&self) -> Tree<'_> {
        Tree::new(&self.tree.store, self.tree.root, &self.reach)
    }

    #[inline(always)]
    fn hit(&self, found: &Found) -> Option<Hit> {
        let (instance, triangle) = self.names.name(found.number()?);
        Some(Hit {
            t: found.t,
            instance,
            triangle,
        })
    }

    /// Which hits a ray that continues behind another passes over: up to which `t`, and below which number.
    fn passed(&self, ray: &Ray, instance: Option<u32>) -> Option<(f32, u32)> {
        let name = ray.behind?;
        Some((ray.interval.min, self.names.up_to(name, instance)))
    }

    /// How many triangles are in cells that wait, and in no leaf yet.
    fn unbuilt(&self) -> u64 {
        let count = self.names.count() as usize;
        let (mut is_built, mut is_waiting) = (vec![false; count], vec![false; count]);
        self.tree.each_part(&mut |part| match part {
            Part::Built(store) => {
                let numbers = store.all_triangles().map(|(number, _)| number);
                numbers.for_each(|number| is_built[number as usize] = true);
            }
            Part::Waiting(fragments, _) => {
                let numbers = fragments.iter().map(Fragment::triangle);
                numbers.for_each(|number| is_waiting[number as usize] = true);
            }
        });
        let both = is_waiting.iter().zip(&is_built);
        both.filter(|(waiting, built)| **waiting && !**built)
            .count() as u64
    }

    /// For rays that the walk is not for.
    #[cold]
    fn test_everything<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        let frame = RayFrame::new(ray);
        self.tree.each_triangle(&mut |number, triangle| {
            counter.primitives(1);
            if let Some(t) = frame.intersect(triangle) {
                self.names.offer(t, number, instance, nearest);
            }
        });
    }

    /// With `drops_copies`, of triangles in the same place only the one of the least number is there.
    pub(in crate::accel) fn build(
        triangles: TriangleSet,
        options: &BuildOptions,
        growth: Growth,
        drops_copies: bool,
    ) -> Self {
        let axes = match options.axes {
            BspAxes::Auto => Axes::of_dominant_normals(triangles.iter().map(|t| &t.triangle)),
            BspAxes::Space => None,
        };
        let instructions = Instructions::chosen(options.instructions);
        Self {
            instructions: instructions.unwrap_or_else(Instructions::best),
            ..Self::build_along(axes, triangles, options.quality, growth, drops_copies)
        }
    }

    /// Along axes of its own, or those of space.
    fn build_along(
        axes: Option<Axes>,
        triangles: TriangleSet,
        quality: BspQuality,
        growth: Growth,
        drops_copies: bool,
    ) -> Self {
        let turned: Option<Vec<[Vec4; 3]>> = axes.as_ref().map(|axes| {
            let corner = |p: Vec3| axes.corner(p).extend(0.0);
            let corners = triangles.iter().map(|t| t.triangle.corners().map(corner));
            corners.collect()
        });
        let in_tree = turned.as_deref().unwrap_or_default();
        let reach = Reach::of(triangles.iter().map(|t| &t.triangle), in_tree, axes);
        let names = Names::of(&triangles);
        let source = Arc::new(Source {
            triangles,
            turned,
            plan: plan(quality),
            drops_copies,
        });
        Self {
            tree: Branch::new(&source, growth),
            source: Arc::downgrade(&source),
            reach,
            instructions: Instructions::best(),
            names,
        }
    }
}

impl TraceSet for WideSet {
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        let found = simd::closest(
            self.instructions,
            self.tree(),
            ray,
            self.passed(ray, instance),
            counter,
        );
        if let Some(number) = found.number() {
            self.names.offer(found.t, number, instance, nearest);
        } else if found.is_unusual() {
            self.test_everything(ray, instance, nearest, counter);
        }
    }

    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        match simd::any(self.instructions, self.tree(), ray, counter) {
            Occluded::Yes => true,
            Occluded::No => false,
            Occluded::Unusual => {
                let mut nearest = Nearest::of(ray);
                self.test_everything(ray, None, &mut nearest, counter);
                nearest.hit().is_some()
            }
        }
    }

    fn closest_alone<C: Counter>(&self, ray: &Ray, counter: &mut C) -> Option<Hit> {
        let passed = if ray.behind.is_some() {
            self.passed(ray, None)
        } else {
            None
        };
        let found = simd::closest(self.instructions, self.tree(), ray, passed, counter);
        let hit = self.hit(&found);
        if hit.is_some() {
            return hit;
        }
        if found.is_unusual() && ray.is_traceable() {
            let mut nearest = Nearest::of(ray);
            self.test_everything(ray, None, &mut nearest, counter);
            return nearest.hit();
        }
        None
    }

    fn any_alone<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        match simd::any(self.instructions, self.tree(), ray, counter) {
            Occluded::Yes => true,
            Occluded::No => false,
            Occluded::Unusual => ray.is_traceable() && self.any(ray, counter),
        }
    }

    fn closest_alone_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.closest_batch(rays, hits);
    }

    fn any_alone_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        self.any_batch(rays, hits);
    }

    fn stats(&self) -> BuildStats {
        let count = self.names.count();
        let (mut nodes, mut bytes, mut is_waiting) = (0, self.names.bytes(), false);
        self.tree.each_part(&mut |part| match part {
            Part::Built(store) => {
                nodes += store.nodes.len() + store.leaves.len();
                bytes += store.bytes();
            }
            Part::Waiting(fragments, _) => {
                bytes += size_of_val(fragments);
                is_waiting = true;
            }
        });
        bytes += self.source.upgrade().map_or(0, |source| source.bytes());
        BuildStats {
            triangles: u64::from(count),
            unbuilt_triangles: if is_waiting { self.unbuilt() } else { 0 },
            nodes: nodes as u64,
            depth: self.tree.depth(),
            bytes: bytes as u64,
            ..BuildStats::default()
        }
    }
}

#[cfg(test)]
mod tests {
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
        WideSet::build_along(axes, set, quality, growth, false)
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
            WideSet::build_along(None, set, BspQuality::Fast, Growth::Whole, drops_copies)
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
}
