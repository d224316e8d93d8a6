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
mod members;
mod node;
mod pages;
mod plane;
mod sample;
mod simd;
mod store;
#[cfg(test)]
mod tests;
mod top;
mod treelet;
mod walk;

pub(super) use simd::Instructions;
pub(in crate::accel) use simd::WideTest;
pub(in crate::accel) use top::WideTop;

use std::marker::PhantomData;
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

/// A set of triangles under a wide BSP, tested by `T`.
pub(in crate::accel) struct WideSet<T = RayFrame> {
    tree: Branch,
    /// What is left to build its treelets from, while there are any that no ray has reached.
    source: Weak<Source>,
    reach: Reach,
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
        let tested = T::new(ray);
        self.tree.each_triangle(&mut |number, triangle| {
            counter.primitives(1);
            if let Some(t) = tested.intersect(triangle) {
                self.names.offer(t, number, instance, nearest);
            }
        });
    }

    pub(in crate::accel) fn build(
        triangles: TriangleSet,
        options: &BuildOptions,
        growth: Growth,
    ) -> Self {
        WideSet::build_exact(triangles, options, growth).tested_by()
    }
}

impl WideSet {
    /// The same tree, tested otherwise: what builds it is compiled once.
    fn tested_by<T>(self) -> WideSet<T> {
        WideSet {
            tree: self.tree,
            source: self.source,
            reach: self.reach,
            instructions: self.instructions,
            names: self.names,
            test: PhantomData,
        }
    }

    fn build_exact(triangles: TriangleSet, options: &BuildOptions, growth: Growth) -> Self {
        let axes = match options.axes {
            BspAxes::Auto => Axes::of_dominant_normals(triangles.iter().map(|t| &t.triangle)),
            BspAxes::Space => None,
        };
        let instructions = Instructions::chosen(options.instructions);
        Self {
            instructions: instructions.unwrap_or_else(Instructions::best),
            ..Self::build_along(axes, triangles, options, growth)
        }
    }

    /// Along axes of its own, or those of space.
    fn build_along(
        axes: Option<Axes>,
        triangles: TriangleSet,
        options: &BuildOptions,
        growth: Growth,
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
            plan: plan(options.quality),
            drops_copies: options.drops_copies,
        });
        Self {
            tree: Branch::new(&source, growth),
            source: Arc::downgrade(&source),
            reach,
            instructions: Instructions::best(),
            names,
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
