//! The wide BSP: polygons split into cells by planes, and every cell with the extent of its own point cluster.
//!
//! The lecture's two halves in one structure. Planes divide the polygons into cells ([`plane`], [`build`]); the fragments in a cell are a point
//! cluster, and its extent is what a ray is tested against, eight cells at a time ([`node`], [`simd`]). Leaves hold blocks of up to eight
//! original triangles, tested at once: fragments steer, originals are hit, by the crate's one test ([`RayFrame`]), so that answers are
//! exact and the same for every set of instructions.
//!
//! Kin: the BVH with spatial splits of Stich, Friedrich, Dietrich 2009; the general BSP of Ize, Wald, Parker 2008; early split clipping of Ernst and
//! Greiner 2007.

mod batch;
mod build;
mod collapse;
mod fragment;
mod node;
mod plane;
mod simd;
mod store;
mod top;
mod walk;

pub(in crate::accel) use top::WideTop;

use glam::Vec4;

use super::options::BspQuality;
use crate::accel::TraceSet;
use crate::accel::bake::TriangleSet;
use crate::accel::counters::{BuildStats, Counter};
use crate::accel::hit::{Hit, Nearest};
use crate::geometry::{Ray, RayFrame};
use build::{Builder, Plan};
use node::Word;
use plane::Costs;
use simd::{Found, Instructions, MOST_DEPTH, Occluded, Tree};
use store::Store;
use walk::Reach;

/// A set of triangles under a wide BSP.
pub(in crate::accel) struct WideSet {
    store: Store,
    root: Word,
    reach: Reach,
    depth: u32,
    instructions: Instructions,
    names: Names,
}

/// The names of triangles by their number: in the order of instances, and in each of triangles.
struct Names {
    count: u32,
    /// Where each instance's numbers begin.
    instances: Vec<(u32, u32)>,
}

impl Names {
    fn of(set: &TriangleSet) -> Self {
        let mut instances: Vec<(u32, u32)> = Vec::new();
        for (number, named) in set.iter().enumerate() {
            let number = number as u32;
            if instances
                .last()
                .is_none_or(|&(_, last)| last != named.instance)
            {
                instances.push((number - named.index, named.instance));
            }
        }
        Self {
            count: set.len() as u32,
            instances,
        }
    }

    /// Instance and triangle.
    #[inline(always)]
    fn name(&self, number: u32) -> (u32, u32) {
        let at = if self.instances.len() == 1 {
            0
        } else {
            self.instances
                .partition_point(|&(first, _)| first <= number)
                - 1
        };
        let (first, instance) = self.instances[at];
        (instance, number - first)
    }

    /// How many come up to this name, itself included, when hits are under the name of `instance` or of their own.
    fn up_to(&self, name: (u32, u32), instance: Option<u32>) -> u32 {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            let (own, index) = self.name(middle);
            if (instance.unwrap_or(own), index) <= name {
                low = middle + 1
            } else {
                high = middle
            }
        }
        low
    }
}

/// Costs in the unit of a node's test, found by trial on the scenes of `benches/record`.
const COSTS: Costs = Costs {
    step: 1.0,
    leaf: 0.4,
    block: 0.6,
    triangle: 0.02,
};

fn plan(quality: BspQuality) -> Plan {
    let (bins, allowance) = match quality {
        BspQuality::Fast => ([16, 8], 0.0),
        BspQuality::Default => ([32, 16], 1.0),
        BspQuality::Best => ([32, 32], 2.0),
    };
    Plan {
        costs: COSTS,
        bins,
        allowance,
    }
}

impl WideSet {
    fn tree(&self) -> Tree<'_> {
        Tree {
            store: &self.store,
            root: self.root,
            reach: self.reach,
        }
    }

    fn offer(&self, t: f32, number: u32, instance: Option<u32>, nearest: &mut Nearest) {
        let (own, index) = self.names.name(number);
        nearest.offer(t, instance.unwrap_or(own), index);
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
        let frame = RayFrame::new(ray);
        for (number, triangle) in self.store.all_triangles() {
            counter.primitives(1);
            if let Some(t) = frame.intersect(&triangle) {
                self.offer(t, number, instance, nearest);
            }
        }
    }

    pub(in crate::accel) fn build(triangles: TriangleSet, quality: BspQuality) -> Self {
        let point = |p: glam::Vec3| p.extend(0.0);
        let corners: Vec<[Vec4; 3]> = triangles
            .iter()
            .map(|t| t.triangle.corners().map(point))
            .collect();
        let largest = corners
            .iter()
            .flatten()
            .fold(0.0_f32, |most, p| most.max(p.abs().max_element()));
        let builder = Builder {
            corners: &corners,
            plan: plan(quality),
        };
        let tree = builder.build();
        let leaf = |members: &[u32], store: &mut Store| {
            store.push_leaf(members, |n| triangles[n as usize].triangle)
        };
        let mut store = Store::default();
        let (root, depth) = collapse::write(&tree, &leaf, &mut store);
        assert!(depth <= MOST_DEPTH, "the build bounds the depth");
        store.finish();
        Self {
            store,
            root,
            reach: Reach { largest },
            depth,
            instructions: Instructions::best(),
            names: Names::of(&triangles),
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
            self.offer(found.t, number, instance, nearest);
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
        BuildStats {
            triangles: u64::from(self.names.count),
            nodes: (self.store.nodes.len() + self.store.leaves.len()) as u64,
            depth: self.depth,
            bytes: (self.store.bytes() + size_of_val(&*self.names.instances)) as u64,
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
    use glam::{DAffine3, Vec3};

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
        let mut sets = bake::bake(&scene()).sets;
        WideSet::build(sets.remove(0), quality)
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
        for quality in BspQuality::ALL {
            let mut tree = set(quality);
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
                    assert_eq!(found, truth, "{instructions:?} {quality} {ray:?}");
                    let any = tree.any_alone(ray, &mut Uncounted);
                    assert_eq!(any, truth.is_some(), "{instructions:?} {quality} {ray:?}");
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
        assert_eq!(one.store.words, four.store.words);
        assert_eq!(one.store.nodes.len(), four.store.nodes.len());
        for (a, b) in one.store.nodes.iter().zip(&four.store.nodes) {
            assert_eq!((a.bounds, a.children), (b.bounds, b.children));
        }
    }

    #[test]
    fn fragments_stay_within_their_allowance() {
        let triangles = set(BspQuality::Fast).names.count as usize;
        let members = |quality| set(quality).store.all_triangles().count();
        assert_eq!(members(BspQuality::Fast), triangles);
        let default = members(BspQuality::Default);
        assert!(triangles < default && default <= 2 * triangles, "{default}");
        assert!(members(BspQuality::Best) <= 3 * triangles);
    }
}
