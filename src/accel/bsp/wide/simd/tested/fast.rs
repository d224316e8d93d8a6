//! Moller and Trumbore's test without an epsilon, in lanes: operation by operation what [`Fast`] does, nothing fused.

use super::LaneTest;
use crate::accel::bsp::wide::simd::kernel::Lanes;
use crate::accel::bsp::wide::store::HEADER;
use crate::geometry::{Fast, Ray};

/// A ray in lanes.
pub(in crate::accel::bsp::wide::simd) struct FastRay<L> {
    origin: [L; 3],
    direction: [L; 3],
}

/// Lanes of a block's nine rows of coordinates: corner by corner, x, y and z.
///
/// # Safety
/// As for [`Lanes`]; `block` begins a block of `count` triangles.
#[inline(always)]
unsafe fn corners<L: Lanes>(block: *const f32, count: usize) -> [[L; 3]; 3] {
    // SAFETY: the caller's promise; a store ends with eight words to spare.
    unsafe {
        let row = |row: usize| L::load(block.add(HEADER + row * count));
        [
            [row(0), row(1), row(2)],
            [row(3), row(4), row(5)],
            [row(6), row(7), row(8)],
        ]
    }
}

#[inline(always)]
unsafe fn minus<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    // SAFETY: the caller's promise.
    unsafe { [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])] }
}

#[inline(always)]
unsafe fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    // SAFETY: the caller's promise.
    unsafe { a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2])) }
}

#[inline(always)]
unsafe fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    // SAFETY: the caller's promise.
    unsafe {
        [
            a[1].mul(b[2]).sub(b[1].mul(a[2])),
            a[2].mul(b[0]).sub(b[2].mul(a[0])),
            a[0].mul(b[1]).sub(b[0].mul(a[1])),
        ]
    }
}

impl LaneTest for Fast {
    type Ready<L: Lanes> = FastRay<L>;

    #[inline(always)]
    unsafe fn ready<L: Lanes>(ray: &Ray) -> FastRay<L> {
        // SAFETY: the caller's promise.
        let splat = |v: glam::Vec3| v.to_array().map(|x| unsafe { L::splat(x) });
        FastRay {
            origin: splat(ray.origin),
            direction: splat(ray.direction),
        }
    }

    #[inline(always)]
    unsafe fn depths<L: Lanes>(ray: &FastRay<L>, block: *const f32, count: usize) -> (u32, L) {
        // SAFETY: the caller's promise.
        unsafe {
            let [a, b, c] = corners::<L>(block, count);
            let (to_b, to_c) = (minus(b, a), minus(c, a));
            let across = cross(ray.direction, to_c);
            let inverse = L::splat(1.0).div(dot(to_b, across));
            let from_a = minus(ray.origin, a);
            let u = dot(from_a, across).mul(inverse);
            let around = cross(from_a, to_b);
            let v = dot(ray.direction, around).mul(inverse);
            let t = dot(to_c, around).mul(inverse);
            let (zero, one) = (L::splat(0.0), L::splat(1.0));
            let outside = v.below(zero) | one.below(u.add(v));
            (zero.at_most(u) & u.at_most(one) & !outside, t)
        }
    }
}
