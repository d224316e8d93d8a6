//! The lecture's loop over all objects ("Using Extents (5)"): each is asked in turn, and its extents first.

use glam::DVec3;

use super::choice::{ExtentChoice, ExtentSet, ExtentTest};
use super::cluster::PointCluster;
use super::cost::CostTable;
use super::entry::ExtentObject;
use super::object::{ObjectExtents, WorldRay};
use super::ray::ExtentRay;
use super::screen::ScreenExtent;
use super::tally::{ExtentTally, ObjectTally};
use super::{probe, set::MeshSet};
use crate::accel::bake::{self, Baked, TestSpaces};
use crate::accel::counters::{BuildStats, Counter, Uncounted};
use crate::accel::hit::{Hit, Nearest};
use crate::accel::normalized::NormalizedSpace;
use crate::accel::{BuildOptions, Trace, TraceSet};
use crate::geometry::tolerance::INSTANCE_FAR;
use crate::geometry::{Aabb, Ray};
use crate::scene::Scene;

/// A loop over all objects, with their extents; within an object, a structure of its triangles.
///
/// ```
/// use bspray::accel::extents::{ExtentChoice, ExtentSet, ExtentTally, ExtentTest, ExtentsLoop};
/// use bspray::accel::BuildOptions;
/// use bspray::geometry::Ray;
/// use glam::Vec3;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scene = bspray::import::load(&["models/lecture-objects.gltf".into()])?;
/// let only_boxes = ExtentChoice::Fixed(ExtentSet::NONE.with(ExtentTest::BoxWorld));
/// let objects = ExtentsLoop::build(&scene, &BuildOptions { extents: only_boxes, ..BuildOptions::default() });
/// let mut tally = ExtentTally::new(objects.objects().len());
/// let ray = Ray::new(Vec3::new(0.6, 3.0, 9.2), Vec3::new(0.0, -0.2, -1.0));
/// assert!(objects.closest_tallied(&ray, &mut tally).is_some());
/// let boxes = tally.total().tests[ExtentTest::BoxWorld.index()];
/// assert_eq!(boxes.tested, 14);
/// assert!(boxes.rejected >= 8 && boxes.hits >= 1);
/// # Ok(())
/// # }
/// ```
pub struct ExtentsLoop {
    pub(super) sets: Vec<MeshSet>,
    pub(super) objects: Vec<ExtentObject>,
    space: NormalizedSpace,
    pub(super) table: CostTable,
}

impl ExtentsLoop {
    /// Builds the structures and extents of all objects of the scene, and chooses their tests.
    pub fn build(scene: &Scene, options: &BuildOptions) -> Self {
        Self::of(scene, bake::bake(scene), options)
    }

    pub(in crate::accel) fn of(scene: &Scene, baked: Baked, options: &BuildOptions) -> Self {
        let spaces = TestSpaces::of(scene);
        let bounds = baked
            .placements
            .iter()
            .fold(Aabb::EMPTY, |b, p| b.union(p.bounds));
        let space = NormalizedSpace::around(&bounds);
        // Meshes that are placed once are in one set; here each is an object.
        let mut set_of_instance = vec![None; scene.instances.len()];
        let mut sets = Vec::new();
        for placement in &baked.placements {
            if let Some(placed) = &placement.instance {
                set_of_instance[placed.index as usize] = Some(placement.set);
            }
        }
        let world = baked.placements.iter().find(|p| p.instance.is_none());
        let world = world.map(|p| p.set as usize);
        for (number, set) in baked.sets.into_iter().enumerate() {
            if Some(number) != world {
                sets.push(MeshSet::build(set, options));
                continue;
            }
            for of_instance in set.chunk_by(|a, b| a.instance == b.instance) {
                set_of_instance[of_instance[0].instance as usize] = Some(sets.len() as u32);
                sets.push(MeshSet::build(of_instance.to_vec(), options));
            }
        }
        let clusters: Vec<_> = scene
            .meshes
            .iter()
            .map(|mesh| PointCluster::new(&mesh.cluster(usize::MAX)))
            .collect();
        let near = INSTANCE_FAR / space.length(1.0);
        let mut objects = Vec::new();
        for (index, instance) in (0_u32..).zip(&scene.instances) {
            let cluster = clusters[instance.mesh as usize].as_ref();
            let Some((set, cluster)) = set_of_instance[index as usize].zip(cluster) else {
                continue;
            };
            let extents = ObjectExtents::new(
                instance,
                cluster,
                spaces.is_object_space(index),
                options.sphere,
                near + space.distance(instance.world_from_object.translation),
                options.view.as_ref(),
            );
            objects.push(ExtentObject {
                instance: index,
                extents,
                tests: ExtentSet::NONE,
                points: (cluster.count(), cluster.hull().len()),
                set,
            });
        }
        let mut built = Self {
            sets,
            objects,
            space,
            table: CostTable::of(options.mesh),
        };
        match options.extents {
            ExtentChoice::Fixed(set) => built.choose(|_| set),
            ExtentChoice::Auto => {
                let studies = probe::study(scene, &built, options.view.as_ref(), &bounds);
                built.choose(|object| studies[object].best());
            }
        }
        built
    }

    /// The objects: all instances that have triangles, in their order.
    pub fn objects(&self) -> &[ExtentObject] {
        &self.objects
    }

    /// The costs that plans are made with.
    pub fn costs(&self) -> &CostTable {
        &self.table
    }

    /// Chooses the tests of every object, by its place in the loop. Tests that an object has not are left out.
    pub fn choose(&mut self, choice: impl Fn(usize) -> ExtentSet) {
        for (number, object) in self.objects.iter_mut().enumerate() {
            let wanted = choice(number).tests();
            object.tests = wanted.filter(|&t| object.extents.has(t)).collect();
        }
    }

    /// As [`Accelerator::closest_hit`](crate::accel::Accelerator::closest_hit), and counts the outcomes at every object.
    pub fn closest_tallied(&self, ray: &Ray, tally: &mut ExtentTally) -> Option<Hit> {
        self.trace_closest(ray, tally)
    }

    /// As [`Accelerator::any_hit`](crate::accel::Accelerator::any_hit), and counts the outcomes at every object.
    pub fn any_tallied(&self, ray: &Ray, tally: &mut ExtentTally) -> bool {
        self.trace_any(ray, tally)
    }

    /// What was counted, by the table of costs.
    pub fn tallied_cost(&self, tally: &ExtentTally) -> f64 {
        let of_object = |(object, tally): (&ExtentObject, &ObjectTally)| {
            let tests = ExtentTest::ALL.into_iter().zip(&tally.tests);
            let tests = tests.map(|(test, t)| {
                let planes = t.planes as f64 / t.tested.max(1) as f64;
                self.table.test(test, planes) * t.tested as f64
            });
            let is_for_tests = object.tests.tests().any(ExtentTest::is_in_object_space);
            let transform = if is_for_tests {
                self.table.transform
            } else {
                self.table.bare_transform
            };
            tests.sum::<f64>()
                + transform * tally.transforms as f64
                + self.table.enter * tally.full_tests as f64
                + self.table.steps(&tally.steps)
        };
        self.objects.iter().zip(&tally.objects).map(of_object).sum()
    }

    /// A traceable ray made ready for the tests of all objects.
    pub fn world_ray(&self, ray: &Ray) -> WorldRay {
        let distance = self.space.distance(DVec3::from(ray.origin));
        WorldRay {
            ray: ExtentRay::new(ray),
            is_near: self.space.length(distance) <= INSTANCE_FAR,
            has_pixel: ScreenExtent::asks(ray),
        }
    }

    /// The full test: offers the nearest hit of the object's triangles, and tells whether it is the nearest of all so far.
    pub(super) fn full_test<C: Counter>(
        &self,
        object: &ExtentObject,
        ray: &Ray,
        nearest: &mut Nearest,
        counter: &mut C,
    ) -> bool {
        let is_placed = object.extents.is_tested_in_object();
        let instance = is_placed.then_some(object.instance);
        self.sets[object.set as usize].closest(ray, instance, nearest, counter);
        nearest
            .hit()
            .is_some_and(|hit| hit.instance == object.instance)
    }
}

impl Trace for ExtentsLoop {
    fn trace_closest<C: Counter>(&self, ray: &Ray, counter: &mut C) -> Option<Hit> {
        ray.is_traceable().then_some(())?;
        let mut nearest = Nearest::of(ray);
        let mut world = self.world_ray(ray);
        for (number, object) in (0..).zip(&self.objects) {
            let entered = object.enter(number, ray, nearest.limit(), &world, counter);
            let Some(tested) = entered else { continue };
            let is_hit = self.full_test(object, &tested, &mut nearest, counter);
            counter.leave(number, is_hit);
            if is_hit {
                world.ray.end_at(nearest.limit());
            }
        }
        nearest.hit()
    }

    fn trace_any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        if !ray.is_traceable() {
            return false;
        }
        if ray.behind.is_some() {
            // Names matter, which only the search for the nearest hit looks at.
            return self.trace_closest(ray, counter).is_some();
        }
        let world = self.world_ray(ray);
        for (number, object) in (0..).zip(&self.objects) {
            let entered = object.enter(number, ray, ray.interval.max, &world, counter);
            let Some(tested) = entered else { continue };
            let is_hit = self.sets[object.set as usize].any(&tested, counter);
            counter.leave(number, is_hit);
            if is_hit {
                return true;
            }
        }
        false
    }

    fn trace_closest_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.trace_closest(ray, &mut Uncounted);
        }
    }

    fn trace_any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.trace_any(ray, &mut Uncounted);
        }
    }

    fn stats(&self) -> BuildStats {
        let mut stats = BuildStats::default();
        self.sets.iter().for_each(|s| stats += s.stats());
        stats.placements = self.objects.len() as u64;
        stats.bytes += size_of_val(&*self.objects) as u64;
        stats
    }
}
