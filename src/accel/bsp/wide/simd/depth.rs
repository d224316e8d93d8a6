//! The depth of a hit in double precision, with a coarse bound on its error.

use super::kernel::Lanes;
use crate::geometry::exact::filter;
use crate::geometry::tolerance::{BOUND_ROUNDING, DENOMINATOR_FILTER, NUMERATOR_FILTER};
use crate::geometry::{Ray, Triangle};

/// An interval that holds the `t` at which the ray's line meets the triangle's plane.
///
/// As [`filter::depth`], with a coarser bound that takes no sums of permanents: the products in `(u x v) . p` add up to no more than the
/// sums of `u`'s and of `v`'s components and the greatest of `p`'s. `length` is at least the sum of components of any edge, `span` at least the
/// difference between any coordinate of a corner and the origin's, `rate` the greatest component of the direction.
#[inline(always)]
pub(super) fn depth_bounds<L: Lanes>(
    ray: &Ray,
    triangle: &Triangle,
    length: f32,
    span: f32,
    rate: f32,
) -> Option<(f64, f64)> {
    let [a, b, c] = *triangle.corners();
    let (o, d) = (ray.origin, ray.direction);
    let [ux, uy, uz] = [apart(b.x, a.x), apart(b.y, a.y), apart(b.z, a.z)];
    let [vx, vy, vz] = [apart(c.x, a.x), apart(c.y, a.y), apart(c.z, a.z)];
    let [px, py, pz] = [apart(a.x, o.x), apart(a.y, o.y), apart(a.z, o.z)];
    let [dx, dy, dz] = [f64::from(d.x), f64::from(d.y), f64::from(d.z)];
    let nx = L::fused(uy, vz, -(uz * vy));
    let ny = L::fused(uz, vx, -(ux * vz));
    let nz = L::fused(ux, vy, -(uy * vx));
    let numerator = L::fused(nx, px, L::fused(ny, py, nz * pz));
    let denominator = L::fused(nx, dx, L::fused(ny, dy, nz * dz));
    let length = f64::from(length * BOUND_ROUNDING);
    let size = length * length;
    filter::quotient(
        (numerator, NUMERATOR_FILTER * size * f64::from(span)),
        (denominator, DENOMINATOR_FILTER * size * f64::from(rate)),
    )
}

#[inline(always)]
fn apart(p: f32, q: f32) -> f64 {
    f64::from(p) - f64::from(q)
}
