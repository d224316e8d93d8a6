//! Moller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", journal of graphics tools 2(1), 1997, in single precision, with both sides
//! counted.

use super::TestedRay;
use crate::geometry::{Ray, Triangle};

/// A ray for Moller and Trumbore's test without an epsilon.
pub(crate) struct Fast(Ray);

impl TestedRay for Fast {
    #[inline]
    fn new(ray: &Ray) -> Self {
        Self(*ray)
    }

    #[inline]
    fn set_max(&mut self, max: f32) {
        self.0.interval.max = max;
    }

    #[inline]
    fn intersect(&self, triangle: &Triangle) -> Option<f32> {
        moller_trumbore(&self.0, triangle, 0.0)
    }
}

/// `t` of the hit. Triangles whose determinant, the volume that direction and edges span, is below `epsilon` in magnitude are missed; the listing has 1e-6,
/// whatever the unit.
#[inline]
pub(crate) fn moller_trumbore(ray: &Ray, triangle: &Triangle, epsilon: f32) -> Option<f32> {
    let [a, b, c] = *triangle.corners();
    let (to_b, to_c) = (b - a, c - a);
    let across = ray.direction.cross(to_c);
    let determinant = to_b.dot(across);
    if determinant.abs() < epsilon {
        return None;
    }
    let inverse = 1.0 / determinant;
    let from_a = ray.origin - a;
    let u = from_a.dot(across) * inverse;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let around = from_a.cross(to_b);
    let v = ray.direction.dot(around) * inverse;
    if v < 0.0 || u + v > 1.0 {
        return None;
    }
    let t = to_c.dot(around) * inverse;
    (t.is_finite() && ray.interval.contains(t)).then_some(t)
}
