//! Woop, Benthin and Wald's test as published, in lanes: operation by operation what [`Watertight`] does, nothing fused. Lanes with an edge function of zero are worked
//! out again in double precision, one by one.

use super::LaneTest;
use crate::accel::bsp::wide::simd::kernel::Lanes;
use crate::accel::bsp::wide::store::HEADER;
use crate::geometry::{Ray, Watertight};

/// A ray's frame in lanes.
pub(in crate::accel::bsp::wide::simd) struct WatertightRay<L> {
    /// The coordinates' indices, the direction's largest last.
    axes: [usize; 3],
    /// In the order of `axes`.
    origin: [L; 3],
    shear: [L; 3],
}

/// A corner's coordinates along the frame's x and y.
type Flat<L> = [L; 2];

#[inline(always)]
unsafe fn edge<L: Lanes>(p: Flat<L>, q: Flat<L>) -> L {
    // SAFETY: the caller's promise.
    unsafe { p[0].mul(q[1]).sub(p[1].mul(q[0])) }
}

/// The edge functions of one lane in double precision, rounded.
#[cold]
#[inline(never)]
unsafe fn edges_again<L: Lanes>([a, b, c]: [Flat<L>; 3], lane: usize) -> [f32; 3] {
    // SAFETY: the caller's promise.
    let point = |p: Flat<L>| p.map(|x| f64::from(unsafe { x.lane(lane) }));
    let [a, b, c] = [point(a), point(b), point(c)];
    let edge = |p: [f64; 2], q: [f64; 2]| (p[0] * q[1] - p[1] * q[0]) as f32;
    [edge(c, b), edge(a, c), edge(b, a)]
}

impl LaneTest for Watertight {
    type Ready<L: Lanes> = WatertightRay<L>;

    #[inline(always)]
    unsafe fn ready<L: Lanes>(ray: &Ray) -> WatertightRay<L> {
        let (last, shear) = Self::frame(ray);
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        let origin = ray.origin.to_array();
        // SAFETY: the caller's promise.
        let splat = |x: f32| unsafe { L::splat(x) };
        WatertightRay {
            axes,
            origin: axes.map(|axis| splat(origin[axis])),
            shear: shear.to_array().map(splat),
        }
    }

    #[inline(always)]
    unsafe fn depths<L: Lanes>(
        ray: &WatertightRay<L>,
        block: *const f32,
        count: usize,
    ) -> (u32, L) {
        // SAFETY: the caller's promise; lanes are below 8.
        unsafe {
            let (a, az) = ray.sheared(block, count, 0);
            let (b, bz) = ray.sheared(block, count, 1);
            let (c, cz) = ray.sheared(block, count, 2);
            let (mut u, mut v, mut w) = (edge(c, b), edge(a, c), edge(b, a));
            let mut again = zeros(u) | zeros(v) | zeros(w);
            while again != 0 {
                let lane = again.trailing_zeros() as usize;
                again &= again - 1;
                let exact = edges_again([a, b, c], lane);
                u.set_lane(lane, exact[0]);
                v.set_lane(lane, exact[1]);
                w.set_lane(lane, exact[2]);
            }
            let zero = L::splat(0.0);
            let below = u.below(zero) | v.below(zero) | w.below(zero);
            let above = zero.below(u) | zero.below(v) | zero.below(w);
            let determinant = u.add(v).add(w);
            let sum = u.mul(az).add(v.mul(bz)).add(w.mul(cz));
            (!(below & above) & !zeros(determinant), sum.div(determinant))
        }
    }
}

impl<L: Lanes> WatertightRay<L> {
    /// A corner of all triangles of a block in the frame: flat, and its depth.
    ///
    /// # Safety
    /// As for [`LaneTest::depths`].
    #[inline(always)]
    unsafe fn sheared(&self, block: *const f32, count: usize, corner: usize) -> (Flat<L>, L) {
        // SAFETY: the caller's promise; a store ends with eight words to spare.
        unsafe {
            let rows = block.add(HEADER + 3 * corner * count);
            let x = L::load(rows.add(self.axes[0] * count)).sub(self.origin[0]);
            let y = L::load(rows.add(self.axes[1] * count)).sub(self.origin[1]);
            let z = L::load(rows.add(self.axes[2] * count)).sub(self.origin[2]);
            let flat = [x.sub(self.shear[0].mul(z)), y.sub(self.shear[1].mul(z))];
            (flat, self.shear[2].mul(z))
        }
    }
}

/// The lanes that are zero, of either sign.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn zeros<L: Lanes>(x: L) -> u32 {
    // SAFETY: the caller's promise.
    unsafe {
        let zero = L::splat(0.0);
        zero.at_most(x) & x.at_most(zero)
    }
}
