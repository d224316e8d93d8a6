//! Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, as published: edge functions in single precision in a frame of the ray,
//! again in double precision where one is zero, and `t` in single precision. Watertight, but neither its edges nor its depths are exact.

use glam::{Vec3, Vec3Swizzles};

use super::TestedRay;
use crate::geometry::{Ray, Triangle};

/// A ray for Woop's test: its frame.
pub(crate) struct Watertight {
    ray: Ray,
    /// The direction's largest component, which becomes the frame's z.
    largest: u8,
    /// `d.x / d.z`, `d.y / d.z` and `1 / d.z` in the frame's order.
    shear: Vec3,
}

/// The vector with its axes in the frame's order, the one of this index last.
#[inline]
fn ordered(v: Vec3, largest: u8) -> Vec3 {
    match largest {
        0 => v.yzx(),
        1 => v.zxy(),
        _ => v,
    }
}

impl Watertight {
    /// The direction's largest component, and `d.x / d.z`, `d.y / d.z` and `1 / d.z` in the frame's order.
    #[inline(always)]
    pub(crate) fn frame(ray: &Ray) -> (usize, Vec3) {
        let tested = Self::new(ray);
        (usize::from(tested.largest), tested.shear)
    }
}

impl TestedRay for Watertight {
    #[inline]
    fn new(ray: &Ray) -> Self {
        let magnitude = ray.direction.abs();
        let largest = if magnitude.x > magnitude.y && magnitude.x > magnitude.z {
            0
        } else if magnitude.y > magnitude.z {
            1
        } else {
            2
        };
        let d = ordered(ray.direction, largest);
        Self {
            ray: *ray,
            largest,
            shear: Vec3::new(d.x / d.z, d.y / d.z, 1.0 / d.z),
        }
    }

    #[inline]
    fn set_max(&mut self, max: f32) {
        self.ray.interval.max = max;
    }

    #[inline]
    #[allow(
        clippy::float_cmp,
        reason = "zero is what the published test compares with"
    )]
    fn intersect(&self, triangle: &Triangle) -> Option<f32> {
        let sheared = triangle.corners().map(|p| {
            let p = ordered(p - self.ray.origin, self.largest);
            Vec3::new(
                p.x - self.shear.x * p.z,
                p.y - self.shear.y * p.z,
                self.shear.z * p.z,
            )
        });
        let [a, b, c] = sheared;
        let edge = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
        let mut functions = [edge(c, b), edge(a, c), edge(b, a)];
        if functions.contains(&0.0) {
            let edge = |p: Vec3, q: Vec3| {
                let (p, q) = (p.as_dvec3(), q.as_dvec3());
                (p.x * q.y - p.y * q.x) as f32
            };
            functions = [edge(c, b), edge(a, c), edge(b, a)];
        }
        if functions.iter().any(|f| *f < 0.0) && functions.iter().any(|f| *f > 0.0) {
            return None;
        }
        let [u, v, w] = functions;
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let t = (u * a.z + v * b.z + w * c.z) / determinant;
        (t.is_finite() && self.ray.interval.contains(t)).then_some(t)
    }
}
