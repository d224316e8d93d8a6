//! Edge functions in double precision: operation by operation what [`Double`] does, in a loop over lanes that a compiler makes vectors of.

use super::LaneTest;
use crate::accel::bsp::wide::node::WIDTH;
use crate::accel::bsp::wide::simd::kernel::Lanes;
use crate::accel::bsp::wide::store::HEADER;
use crate::geometry::{Double, Ray};

/// Origin and direction.
pub(in crate::accel::bsp::wide::simd) struct DoubleRay([[f64; 3]; 2]);

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - b[1] * a[2],
        a[2] * b[0] - b[2] * a[0],
        a[0] * b[1] - b[0] * a[1],
    ]
}

#[inline(always)]
fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `t` of one triangle; NaN where the line misses it.
#[inline(always)]
fn depth([origin, direction]: [[f64; 3]; 2], corners: [[f64; 3]; 3]) -> f32 {
    let [a, b, c] = corners.map(|p| minus(p, origin));
    let u = dot(direction, cross(c, b));
    let v = dot(direction, cross(a, c));
    let w = dot(direction, cross(b, a));
    // Without short cuts, so that lanes need no branches.
    let below = (u < 0.0) | (v < 0.0) | (w < 0.0);
    let above = (u > 0.0) | (v > 0.0) | (w > 0.0);
    let normal = cross(minus(b, a), minus(c, a));
    let t = (dot(normal, a) / dot(normal, direction)) as f32;
    if below & above { f32::NAN } else { t }
}

impl LaneTest for Double {
    type Ready<L: Lanes> = DoubleRay;

    #[inline(always)]
    unsafe fn ready<L: Lanes>(ray: &Ray) -> DoubleRay {
        DoubleRay([ray.origin, ray.direction].map(|v| v.to_array().map(f64::from)))
    }

    #[inline(always)]
    unsafe fn depths<L: Lanes>(
        DoubleRay(ray): &DoubleRay,
        block: *const f32,
        count: usize,
    ) -> (u32, L) {
        let mut depths = [f32::NAN; WIDTH];
        // SAFETY: the caller's promise; a store ends with eight words to spare.
        unsafe {
            let rows: [&[f32; WIDTH]; 9] =
                std::array::from_fn(|row| &*block.add(HEADER + row * count).cast());
            for (lane, t) in depths.iter_mut().enumerate() {
                let corner = |c: usize| {
                    let [x, y, z] = [3 * c, 3 * c + 1, 3 * c + 2];
                    [rows[x][lane], rows[y][lane], rows[z][lane]].map(f64::from)
                };
                *t = depth(*ray, [corner(0), corner(1), corner(2)]);
            }
            (u32::MAX, L::load(depths.as_ptr()))
        }
    }
}
