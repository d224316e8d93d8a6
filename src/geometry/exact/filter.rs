//! The questions of this module in double precision, each with a bound on its own error: an answer, or doubt.
//!
//! After Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997: the sum
//! of the absolute values of a determinant's terms (the permanent) times a small constant bounds its error. The
//! constants and their derivations are in [`tolerance`](crate::geometry::tolerance). Doubt includes every NaN.
//!
//! ```
//! use bspray::geometry::{Ray, exact::{Sign, filter}};
//! use glam::Vec3;
//! let ray = Ray::new(Vec3::ZERO, Vec3::Z);
//! let [a, b] = [Vec3::new(1.0, 0.0, 5.0), Vec3::new(0.0, 1.0, 5.0)];
//! assert_eq!(filter::edge_sign(&ray, a, b), Some(Sign::Positive));
//! // The ray passes through the edge: double precision alone does not decide.
//! let [p, q] = [Vec3::new(1.0, 1.0, 5.0), Vec3::new(-1.0, -1.0, 5.0)];
//! assert_eq!(filter::edge_sign(&ray, p, q), None);
//! ```

use glam::{DVec3, Vec3};

use super::Sign;
use crate::geometry::tolerance::{
    DENOMINATOR_FILTER, EDGE_FILTER, NORMAL_FILTER, NUMERATOR_FILTER,
};
use crate::geometry::{Ray, Triangle};

/// The sign of the edge function `det(d, from - o, to - o)` of [`edge_sign`](super::edge_sign), or `None` if double
/// precision does not decide it.
///
/// `Zero` is known only where every term is zero: rays within an axis-aligned plane, which architecture is full of. (No
/// product of three differences or components of `f32` underflows, so a term of zero has a factor that is zero.)
#[allow(
    clippy::float_cmp,
    reason = "the permanent is zero only if every term is, without rounding"
)]
pub fn edge_sign(ray: &Ray, from: Vec3, to: Vec3) -> Option<Sign> {
    let (value, permanent) = edge_function(ray, from, to);
    let error = EDGE_FILTER * permanent;
    if value > error {
        Some(Sign::Positive)
    } else if value < -error {
        Some(Sign::Negative)
    } else if permanent == 0.0 {
        Some(Sign::Zero)
    } else {
        None
    }
}

/// The edge function and its permanent, in cubic units (direction times area).
///
/// Computed as `det(d, from - o, to - from)`, which is the same and whose permanent shrinks with the edge.
pub(crate) fn edge_function(ray: &Ray, from: Vec3, to: Vec3) -> (f64, f64) {
    let direction = ray.direction.as_dvec3();
    let start = from.as_dvec3();
    let (minor, permanent) = cross(start - ray.origin.as_dvec3(), to.as_dvec3() - start);
    (direction.dot(minor), direction.abs().dot(permanent))
}

/// `(b - a) x (c - a)` and its permanents, in square units.
#[inline(always)]
pub(crate) fn normal(triangle: &Triangle) -> (DVec3, DVec3) {
    let [a, b, c] = triangle.corners();
    let a = a.as_dvec3();
    cross(b.as_dvec3() - a, c.as_dvec3() - a)
}

/// `a x b`, and the same with every term made positive.
#[inline(always)]
fn cross(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let plus = DVec3::new(a.y * b.z, a.z * b.x, a.x * b.y);
    let minus = DVec3::new(a.z * b.y, a.x * b.z, a.y * b.x);
    (plus - minus, plus.abs() + minus.abs())
}

/// Whether the corners certainly span a plane. `false` is doubt.
pub fn spans_plane(triangle: &Triangle) -> bool {
    let (normal, permanent) = normal(triangle);
    normal.abs().cmpgt(NORMAL_FILTER * permanent).any()
}

/// An interval that holds the parameter `t` at which the ray's line meets the triangle's plane, in units of the
/// direction's length; `None` if the line may be parallel to the plane.
#[inline(always)]
pub fn depth(ray: &Ray, triangle: &Triangle) -> Option<(f64, f64)> {
    let (normal, permanent) = normal(triangle);
    let direction = ray.direction.as_dvec3();
    let to_plane = triangle.corners()[0].as_dvec3() - ray.origin.as_dvec3();
    let numerator = normal.dot(to_plane);
    let denominator = normal.dot(direction);
    quotient(
        (numerator, NUMERATOR_FILTER * permanent.dot(to_plane.abs())),
        (
            denominator,
            DENOMINATOR_FILTER * permanent.dot(direction.abs()),
        ),
    )
}

/// An interval that holds the quotient of two values, each given with a bound on its error.
#[inline(always)]
pub(crate) fn quotient(
    (numerator, numerator_error): (f64, f64),
    (denominator, denominator_error): (f64, f64),
) -> Option<(f64, f64)> {
    // n/d and n'/d' differ by (|n - n'| + |n/d| |d - d'|) / |d'| at most, and |d'| is at least half of |d|.
    if denominator_error < 0.5 * denominator.abs() {
        let inverse = 1.0 / denominator;
        let t = numerator * inverse;
        let radius = 2.0 * (numerator_error + t.abs() * denominator_error) * inverse.abs();
        Some((t - radius, t + radius))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_seen_from_both_its_triangles_has_opposite_signs() {
        let ray = Ray::new(Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.1, 0.7, -2.0));
        let [p, q] = [Vec3::new(1.0, 2.0, -3.0), Vec3::new(-1.0, 0.5, -7.0)];
        let there = filter_sign(&ray, p, q);
        let back = filter_sign(&ray, q, p);
        assert_eq!((there, back), (Sign::Negative, Sign::Positive));
    }

    #[test]
    fn a_ray_within_an_axis_aligned_plane_needs_no_integers() {
        let ray = Ray::new(Vec3::new(0.1, 7.0, -3.3), Vec3::new(0.7, 0.0, 1e-40));
        let [p, q] = [Vec3::new(1.5, 7.0, -0.3), Vec3::new(-8.0, 7.0, 1e18)];
        assert_eq!(edge_sign(&ray, p, q), Some(Sign::Zero));
        assert_ne!(
            edge_sign(&ray, p, q.with_y(7.0_f32.next_up())),
            Some(Sign::Zero)
        );
    }

    fn filter_sign(ray: &Ray, from: Vec3, to: Vec3) -> Sign {
        edge_sign(ray, from, to).expect("far from the edge")
    }

    #[test]
    fn what_is_not_finite_is_in_doubt() {
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        assert_eq!(edge_sign(&ray, Vec3::NAN, Vec3::X), None);
        let broken = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::splat(f32::INFINITY));
        assert!(!spans_plane(&broken));
        assert_eq!(depth(&ray, &broken), None);
    }

    #[test]
    fn the_interval_around_a_depth_is_narrow() {
        let triangle = Triangle::new(
            Vec3::new(-1.0, -2.0, 0.7),
            Vec3::new(3.0, -2.0, 0.9),
            Vec3::new(0.0, 5.0, 1.1),
        );
        let ray = Ray::new(Vec3::new(0.1, 0.2, 40.0), Vec3::new(0.01, 0.02, -1.0));
        let (low, high) = depth(&ray, &triangle).unwrap();
        assert!(39.0 < low && low < high && high < 40.0);
        assert!(high - low < 1e-12);
    }
}
