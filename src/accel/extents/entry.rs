//! An object of the loop: which of its extents are asked, and the ray with which its triangles are.

use super::choice::{ExtentSet, ExtentTest};
use super::object::{ObjectExtents, WorldRay};
use super::ray::ExtentRay;
use crate::accel::counters::Counter;
use crate::geometry::Ray;

/// An object of the loop.
#[derive(Clone, Debug)]
pub struct ExtentObject {
    /// Index of the scene's instance.
    pub instance: u32,
    /// Its extents.
    pub extents: ObjectExtents,
    /// Those that are tested.
    pub tests: ExtentSet,
    /// Points in the cluster of its mesh, and on its hull.
    pub points: (usize, usize),
    /// Which set of triangles it shows.
    pub(super) set: u32,
}

impl ExtentObject {
    /// The ray for the full test, given it in world space and, if it was taken there, in object space. `None` if it has left single precision.
    pub(super) fn tested_ray(&self, ray: &Ray, in_object: Option<Ray>) -> Option<Ray> {
        if !self.extents.is_tested_in_object() {
            return Some(*ray);
        }
        let ray = in_object.or_else(|| self.extents.object_ray(ray))?;
        ray.is_traceable().then_some(ray)
    }

    /// The ray for the full test, if it passes the object's tests.
    #[inline]
    pub(super) fn enter<C: Counter>(
        &self,
        number: u32,
        ray: &Ray,
        limit: f32,
        world: &WorldRay,
        counter: &mut C,
    ) -> Option<Ray> {
        let limited = limited(ray, limit);
        let mut in_object = None;
        let mut prepared = None;
        let tests = if world.has_pixel {
            self.tests
        } else {
            self.tests.without(ExtentTest::Screen)
        };
        for test in tests.tests() {
            if test.is_in_object_space() && in_object.is_none() {
                in_object = self.extents.object_ray(&limited);
                prepared = in_object.map(|ray| ExtentRay::new(&ray));
                counter.transform(number);
            }
            let mut planes = 0;
            let extents = &self.extents;
            let is_admitted = extents.admits(test, ray, world, prepared.as_ref(), &mut planes);
            counter.extent(number, test, planes, is_admitted);
            if !is_admitted {
                return None;
            }
        }
        if self.extents.is_tested_in_object() && in_object.is_none() {
            counter.transform(number);
        }
        counter.enter(number);
        let tested = self.tested_ray(&limited, in_object);
        if tested.is_none() {
            counter.leave(number, false);
        }
        tested
    }
}

/// The ray up to a limit.
pub(super) fn limited(ray: &Ray, limit: f32) -> Ray {
    let mut ray = *ray;
    ray.interval.max = limit;
    ray
}
