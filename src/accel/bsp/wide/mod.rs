//! The wide BSP: polygons split into cells by planes, and every cell with the extent of its own point cluster.
//!
//! The lecture's two halves in one structure. Planes divide the polygons into cells ([`plane`], [`build`]); the fragments in a cell are a point
//! cluster, and its extent is what a ray is tested against, eight cells at a time ([`node`], [`simd`]). Leaves hold blocks of up to eight
//! original triangles, tested at once: fragments steer, originals are hit, by the crate's one test ([`RayFrame`]), so that answers are
//! exact and the same for every set of instructions. The same tree can be walked with tests that are not exact ([`WideTest`]).
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
mod walk;

pub(super) use simd::Instructions;
pub(in crate::accel) use simd::WideTest;
pub(in crate::accel) use top::WideTop;

use std::marker::PhantomData;

use glam::{Vec3, Vec4};

use super::options::{BspAxes, BspQuality, BuildOptions};
use crate::accel::TraceSet;
use crate::accel::bake::TriangleSet;
use crate::accel::counters::{BuildStats, Counter};
use crate::accel::hit::{Hit, Nearest};
use crate::accel::names::Names;
use crate::geometry::{Ray, RayFrame};
use axes::Axes;
use build::{Builder, Plan};
use node::Word;
use plane::Costs;
use simd::{Found, MOST_DEPTH, Occluded, Tree};
use store::{Draft, Store};
use walk::Reach;

/// A set of triangles under a wide BSP, tested by `T`.
pub(in crate::accel) struct WideSet<T = RayFrame> {
    store: Store,
    root: Word,
    reach: Reach,
    depth: u32,
    instructions: Instructions,
    names: Names,
    test: PhantomData<T>,
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

impl<T: WideTest> WideSet<T> {
    fn tree(&self) -> Tree<'_> {
        Tree::new(&self.store, self.root, &self.reach)
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

    /// For rays that the walk is not for.
    #[cold]
    fn test_everything<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        let tested = T::new(ray);
        for (number, triangle) in self.store.all_triangles() {
            counter.primitives(1);
            if let Some(t) = tested.intersect(&triangle) {
                self.names.offer(t, number, instance, nearest);
            }
        }
    }

    pub(in crate::accel) fn build(triangles: TriangleSet, options: &BuildOptions) -> Self {
        WideSet::build_exact(&triangles, options).tested_by()
    }
}

impl WideSet {
    /// The same tree, tested otherwise: what builds it is compiled once.
    fn tested_by<T>(self) -> WideSet<T> {
        WideSet {
            store: self.store,
            root: self.root,
            reach: self.reach,
            depth: self.depth,
            instructions: self.instructions,
            names: self.names,
            test: PhantomData,
        }
    }

    fn build_exact(triangles: &TriangleSet, options: &BuildOptions) -> Self {
        let axes = match options.axes {
            BspAxes::Auto => Axes::of_dominant_normals(triangles.iter().map(|t| &t.triangle)),
            BspAxes::Space => None,
        };
        let instructions = Instructions::chosen(options.instructions);
        Self {
            instructions: instructions.unwrap_or_else(Instructions::best),
            ..Self::build_along(axes, triangles, options.quality)
        }
    }

    /// Along axes of its own, or those of space.
    fn build_along(axes: Option<Axes>, triangles: &TriangleSet, quality: BspQuality) -> Self {
        let in_tree = |p: Vec3| axes.as_ref().map_or(p, |axes| axes.corner(p)).extend(0.0);
        let corners: Vec<[Vec4; 3]> = triangles
            .iter()
            .map(|t| t.triangle.corners().map(in_tree))
            .collect();
        let reach = Reach::of(triangles.iter().map(|t| &t.triangle), &corners, axes);
        let builder = Builder {
            corners: &corners,
            plan: plan(quality),
        };
        let tree = builder.build();
        let leaf = |members: &[u32], draft: &mut Draft| {
            draft.push_leaf(members, |n| triangles[n as usize].triangle)
        };
        let mut draft = Draft::default();
        let (root, depth) = collapse::write(&tree, &leaf, &mut draft);
        assert!(depth <= MOST_DEPTH, "the build bounds the depth");
        Self {
            store: draft.finish(),
            root,
            reach,
            depth,
            instructions: Instructions::best(),
            names: Names::of(triangles),
            test: PhantomData,
        }
    }
}

impl<T: WideTest> TraceSet for WideSet<T> {
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        let found = T::closest(
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
        match T::any(self.instructions, self.tree(), ray, counter) {
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
        let found = T::closest(self.instructions, self.tree(), ray, passed, counter);
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
        match T::any(self.instructions, self.tree(), ray, counter) {
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
        BuildStats {
            triangles: u64::from(self.names.count()),
            nodes: (self.store.nodes.len() + self.store.leaves.len()) as u64,
            depth: self.depth,
            bytes: (self.store.bytes() + self.names.bytes()) as u64,
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
    pub(super) fn scene() -> Scene {
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
        WideSet::build_along(axes, &bake::bake(&scene()).sets[0], quality)
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
        let along = |axes| BspQuality::ALL.map(|quality| (axes, quality));
        for (axes, quality) in [None, Some(turned())].into_iter().flat_map(along) {
            let mut tree = set_along(axes, quality);
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
        }
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
        assert_eq!(*one.store.words, *four.store.words);
        assert_eq!(one.store.nodes.len(), four.store.nodes.len());
        for (a, b) in one.store.nodes.iter().zip(&*four.store.nodes) {
            assert_eq!((a.bounds, a.children), (b.bounds, b.children));
        }
    }

    #[test]
    fn fragments_stay_within_their_allowance() {
        let triangles = set(BspQuality::Fast).names.count() as usize;
        let members = |quality| set(quality).store.all_triangles().count();
        assert_eq!(members(BspQuality::Fast), triangles);
        let default = members(BspQuality::Default);
        assert!(triangles < default && default <= 2 * triangles, "{default}");
        assert!(members(BspQuality::Best) <= 3 * triangles);
    }
}
