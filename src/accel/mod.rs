//! Structures that find what a ray hits. Each is one of [`AcceleratorKind`], the one registry that tests, benches, the
//! command line and reports go through.
//!
//! The contract, which one generic test suite runs over every kind: `any_hit(r) == closest_hit(r).is_some()`; `t` lies in the
//! ray's closed interval; both sides of a triangle count; an empty scene or a ray that is not traceable gives `None`; the triangle
//! is the original one; every kind returns what `linear` returns, bit for bit, the least (t, instance, triangle) winning.
//!
//! # Domain
//!
//! That contract holds for every ray and every scene inside [`Domain`], which says what is outside by name: coordinates beyond
//! [`COORDINATE_LIMIT`](crate::geometry::tolerance::COORDINATE_LIMIT) or not finite, rays that are not traceable, and rays that the way to an object's
//! space takes out of `f32`. Inside it, what a hit is follows [`exact`](crate::geometry::exact) to the last bit: a triangle without area and one that
//! lies in the ray's plane are never hit, and neither is what lies so far off that `t` exceeds `f32`. A mesh that is placed several times
//! is tested in its own space with the ray rounded once ([`TestSpaces`]), and the answer is exact for that ray. `bspray stress` looks for answers that break this.

mod bake;
pub mod bsp;
mod bvh;
mod bvh_as_shipped;
mod bvh_sets;
mod counters;
mod domain;
mod embree;
pub mod extents;
mod hit;
mod instances;
mod lazy;
mod linear;
mod names;
mod normalized;
mod placement;

pub use bake::TestSpaces;
pub use bsp::{BspAxes, BspInstructions, BspOrder, BspQuality, BuildOptions, BuildTime};
pub use bvh_as_shipped::{AsShipped, FormulaCheck, ShippedTree, formula_checks, world_triangles};
pub use counters::{BuildStats, TraceCounters};
pub use domain::{Domain, Outside};
pub use embree::{Embree, EmbreeError, EmbreeMode, EmbreeScene};
pub use hit::Hit;

use bake::{Baked, Placement};
use bsp::wide::{Growth, WideSet, WideTest, WideTop};
use bvh::BvhKind;
use bvh_sets::{BvhSet, BvhTop};
use counters::{Counter, Uncounted};
use hit::Nearest;
use instances::{EveryPlacement, Instances};
use linear::LinearSet;

use crate::geometry::{Double, Fast, Ray, RayFrame, TestedRay, TriangleTest, Watertight};
use crate::scene::Scene;

/// A built structure that answers what rays hit.
///
/// ```
/// use bspray::accel::AcceleratorKind;
/// use bspray::geometry::Ray;
/// use bspray::scene::{Instance, Part, Scene, TriangleMesh};
/// use glam::{DAffine3, Vec3};
///
/// let mesh = TriangleMesh {
///     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
///     triangles: vec![[0, 1, 2]],
///     parts: vec![Part { first_triangle: 0, triangle_count: 1, material: 0 }],
///     ..TriangleMesh::default()
/// };
/// let instance = Instance::new("triangle", 0, DAffine3::IDENTITY);
/// let scene = Scene { meshes: vec![mesh], instances: vec![instance], ..Scene::default() };
/// let accelerator = AcceleratorKind::Bvh2.build(&scene);
/// let ray = Ray::new(Vec3::new(0.25, 0.25, 2.0), Vec3::NEG_Z);
/// assert_eq!(accelerator.closest_hit(&ray).map(|hit| hit.t), Some(2.0));
/// ```
pub trait Accelerator: Send + Sync {
    /// The nearest hit within the ray's interval.
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit within the ray's interval.
    fn any_hit(&self, ray: &Ray) -> bool;

    /// As [`Accelerator::closest_hit`], and adds the steps it took to `counters`.
    fn closest_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> Option<Hit>;

    /// As [`Accelerator::any_hit`], and adds the steps it took to `counters`.
    fn any_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> bool;

    /// The nearest hits of many rays: each as [`Accelerator::closest_hit`] has it. Neighbours that go the same way may be faster together.
    ///
    /// # Panics
    /// If there are not as many answers as rays.
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one answer a ray");
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest_hit(ray);
        }
    }

    /// Whether anything is hit, for many rays: each as [`Accelerator::any_hit`] has it.
    ///
    /// # Panics
    /// If there are not as many answers as rays.
    fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one answer a ray");
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.any_hit(ray);
        }
    }

    /// Its size.
    fn build_stats(&self) -> BuildStats;
}

/// What an accelerator has to write: each query once, for whoever counts or does not.
trait Trace: Send + Sync {
    fn trace_closest<C: Counter>(&self, ray: &Ray, counter: &mut C) -> Option<Hit>;
    fn trace_any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool;
    fn stats(&self) -> BuildStats;

    fn trace_closest_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]);
    fn trace_any_batch(&self, rays: &[Ray], hits: &mut [bool]);
}

/// What the level of instances needs of the structure of one set of triangles. Rays are traceable and in the set's space.
trait TraceSet: Send + Sync {
    /// Offers hits, the nearest among them, under the name of `instance` or of their own.
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    );
    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool;
    fn stats(&self) -> BuildStats;

    /// The nearest hit, where this set is all there is. The ray need not be traceable.
    fn closest_alone<C: Counter>(&self, ray: &Ray, counter: &mut C) -> Option<Hit> {
        ray.is_traceable().then_some(())?;
        let mut nearest = Nearest::of(ray);
        self.closest(ray, None, &mut nearest, counter);
        nearest.hit()
    }

    /// Whether anything is hit, where this set is all there is. The ray need not be traceable, and does not continue behind a hit.
    fn any_alone<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        ray.is_traceable() && self.any(ray, counter)
    }

    /// The nearest hits, as many as rays: each as [`TraceSet::closest_alone`] has it.
    fn closest_alone_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest_alone(ray, &mut Uncounted);
        }
    }

    /// Whether anything is hit, as many answers as rays, where this set is all there is. Rays may continue behind a hit.
    fn any_alone_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = if ray.behind.is_some() {
                // Names matter, which only the search for the nearest hit looks at.
                self.closest_alone(ray, &mut Uncounted).is_some()
            } else {
                self.any_alone(ray, &mut Uncounted)
            };
        }
    }
}

impl<T: Trace> Accelerator for T {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.trace_closest(ray, &mut Uncounted)
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        self.trace_any(ray, &mut Uncounted)
    }

    fn closest_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> Option<Hit> {
        self.trace_closest(ray, counters)
    }

    fn any_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> bool {
        self.trace_any(ray, counters)
    }

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one answer a ray");
        self.trace_closest_batch(rays, hits);
    }

    fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one answer a ray");
        self.trace_any_batch(rays, hits);
    }

    fn build_stats(&self) -> BuildStats {
        self.stats()
    }
}

/// The kinds of accelerators.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AcceleratorKind {
    /// Every triangle, one after the other.
    Linear,
    /// A BSP of eight cells a node, each with the extent of its fragments.
    #[default]
    Bsp,
    /// The lecture's BSP of polygons.
    BspPolygon,
    /// obvhs's binary BVH.
    Bvh2,
    /// obvhs's compressed BVH of eight children a node (Ylitie, Karras, Laine 2017).
    Cwbvh,
    /// The lecture's loop over all objects, with their extents.
    Extents,
}

impl AcceleratorKind {
    /// All kinds, the default first.
    pub const ALL: [Self; 6] = [
        Self::Bsp,
        Self::BspPolygon,
        Self::Bvh2,
        Self::Cwbvh,
        Self::Extents,
        Self::Linear,
    ];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Bsp => "bsp",
            Self::BspPolygon => "bsp-polygon",
            Self::Bvh2 => "bvh2",
            Self::Cwbvh => "cwbvh",
            Self::Extents => "extents",
        }
    }

    /// One line about it.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Linear => "every triangle, one after the other: the reference",
            Self::Bsp => {
                "wide polygon BSP, eight cells a node with the extents of their fragments: the fastest"
            }
            Self::BspPolygon => {
                "the lecture's BSP of polygons, exact: fragments in the planes of nodes"
            }
            Self::Bvh2 => "binary bounding volume hierarchy (obvhs)",
            Self::Cwbvh => "compressed bounding volume hierarchy, eight children a node (obvhs)",
            Self::Extents => {
                "the lecture's loop over all objects, with their extents (--extents, --mesh-accel)"
            }
        }
    }

    /// Builds the structure over all instances of the scene, as most users want it.
    pub fn build(self, scene: &Scene) -> Box<dyn Accelerator> {
        self.build_with(scene, &BuildOptions::default())
    }

    /// Builds the structure over all instances of the scene. Kinds that leave no choice do not look at the options.
    pub fn build_with(self, scene: &Scene, options: &BuildOptions) -> Box<dyn Accelerator> {
        match options.test {
            TriangleTest::Exact => self.build_tested::<RayFrame>(scene, options),
            TriangleTest::Double => self.build_tested::<Double>(scene, options),
            TriangleTest::Watertight => self.build_tested::<Watertight>(scene, options),
            TriangleTest::Fast => self.build_tested::<Fast>(scene, options),
        }
    }

    fn build_tested<T: WideTest>(
        self,
        scene: &Scene,
        options: &BuildOptions,
    ) -> Box<dyn Accelerator> {
        let baked = bake::bake(scene);
        let every = |placements: &[Placement]| EveryPlacement(placements.len() as u32);
        match self {
            Self::Linear => Box::new(Instances::build(baked, LinearSet::<T>::new, every)),
            Self::Bsp => wide::<T>(baked, options),
            Self::BspPolygon => {
                let mut outlines = bsp::polygon::outlines(scene, &baked).into_iter();
                let set = |set| {
                    let outlines = outlines.next().unwrap_or_default();
                    bsp::polygon::PolygonSet::<T>::build(set, &outlines, options)
                };
                Box::new(Instances::build(baked, set, every))
            }
            Self::Bvh2 => bvh::<T>(baked, options, BvhKind::Binary),
            Self::Cwbvh => bvh::<T>(baked, options, BvhKind::Wide),
            Self::Extents => Box::new(extents::ExtentsLoop::of(scene, baked, options)),
        }
    }
}

fn wide<T: WideTest>(baked: Baked, options: &BuildOptions) -> Box<dyn Accelerator> {
    let options = *options;
    let build = move |set, growth| WideSet::<T>::build(set, &options, growth);
    let top = WideTop::build;
    if options.time == BuildTime::Ahead {
        let whole = |set| build(set, Growth::Whole);
        return Box::new(Instances::build(baked, whole, top));
    }
    let later = move |set| build(set, Growth::ReachedAlone);
    let world = |set| build(set, Growth::Reached);
    Box::new(lazy::instances(baked, world, later, top))
}

fn bvh<T: TestedRay>(baked: Baked, options: &BuildOptions, kind: BvhKind) -> Box<dyn Accelerator> {
    let set = move |set| BvhSet::<T>::build(set, kind);
    let top = |placements: &[Placement]| BvhTop::build(placements, kind);
    if options.time == BuildTime::Ahead {
        return Box::new(Instances::build(baked, set, top));
    }
    Box::new(lazy::instances(baked, set, set, top))
}

impl std::fmt::Display for AcceleratorKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
