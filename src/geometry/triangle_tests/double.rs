//! Edge functions in double precision: the signed volumes of the direction and an edge, after Kensler and Shirley, "Optimizing Ray-Triangle Intersection via
//! Automated Search", IEEE Symposium on Interactive Ray Tracing 2006. `t` is that of the plane.

use glam::DVec3;

use super::TestedRay;
use crate::geometry::{Ray, Triangle};

/// A ray for the test in double precision.
pub(crate) struct Double {
    origin: DVec3,
    direction: DVec3,
    ray: Ray,
}

impl TestedRay for Double {
    #[inline]
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
            ray: *ray,
        }
    }

    #[inline]
    fn set_max(&mut self, max: f32) {
        self.ray.interval.max = max;
    }

    #[inline]
    fn intersect(&self, triangle: &Triangle) -> Option<f32> {
        let [a, b, c] = triangle.corners().map(|p| p.as_dvec3() - self.origin);
        // A product of two vectors and that of the same in the other order are exact opposites: two triangles judge a shared edge alike.
        let [u, v, w] = [c.cross(b), a.cross(c), b.cross(a)].map(|n| self.direction.dot(n));
        let (least, greatest) = (u.min(v).min(w), u.max(v).max(w));
        if least < 0.0 && greatest > 0.0 {
            return None;
        }
        let normal = (b - a).cross(c - a);
        let t = (normal.dot(a) / normal.dot(self.direction)) as f32;
        (t.is_finite() && self.ray.interval.contains(t)).then_some(t)
    }
}
