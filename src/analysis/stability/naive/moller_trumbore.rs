//! Moller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", journal of graphics tools 2(1), 1997, in single precision, with the
//! fixed epsilon of its listing and both sides counted.

use crate::geometry::tolerance::NAIVE_DETERMINANT;
use crate::geometry::{Ray, Triangle};

pub(super) fn intersect(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    let [a, b, c] = *triangle.corners();
    let (to_b, to_c) = (b - a, c - a);
    let across = ray.direction.cross(to_c);
    let determinant = to_b.dot(across);
    if determinant.abs() < NAIVE_DETERMINANT {
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
    ray.interval.contains(t).then_some(t)
}
