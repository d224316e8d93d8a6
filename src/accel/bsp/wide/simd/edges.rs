//! The test of triangles and rays in lanes: edge functions, bounds on their errors, and where along the rays hits may lie.

use super::kernel::Lanes;
use crate::geometry::tolerance::{LANE_DEPTH_ERROR, LANE_SHEAR_ERROR, PRODUCT_ERROR};

/// The edge functions of a triangle and a ray in each lane, of Woop, Benthin and Wald.
#[derive(Clone, Copy)]
pub(super) struct Edges<L> {
    pub(super) u: L,
    v: L,
    w: L,
    least: L,
    greatest: L,
}

impl<L: Lanes> Edges<L> {
    /// Of sheared corners.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn of(corners: &[[L; 3]; 3]) -> Self {
        let [[ax, ay, _], [bx, by, _], [cx, cy, _]] = *corners;
        // SAFETY: the caller's promise.
        unsafe {
            let u = cx.mul_sub(by, cy.mul(bx));
            let v = ax.mul_sub(cy, ay.mul(cx));
            let w = bx.mul_sub(ay, by.mul(ax));
            let (least, greatest) = (u.min(v).min(w), u.max(v).max(w));
            Self {
                u,
                v,
                w,
                least,
                greatest,
            }
        }
    }

    /// The lanes whose ray certainly misses, with a bound on the edge functions' error.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn misses(&self, error: L) -> u32 {
        // SAFETY: the caller's promise.
        unsafe {
            let below = L::splat(0.0).sub(error);
            self.least.below_and_above(below, self.greatest, error)
        }
    }

    /// What is known of the lanes in `met`: with the error bound of each, and where along the ray they lie. `rate` has the sign of the
    /// direction along the frame's z; `least_length` the error of a length that does not shrink with it; `ends` are the lengths between which a hit
    /// matters.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn judge(
        &self,
        corners: &[[L; 3]; 3],
        met: u32,
        rate: L,
        least_length: f32,
        ends: [L; 2],
    ) -> Candidates<L> {
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = *corners;
        let Self {
            u,
            v,
            w,
            least,
            greatest,
        } = *self;
        // SAFETY: the caller's promise.
        unsafe {
            let depth = az.abs().max(bz.abs()).max(cz.abs());
            let lateral = ax
                .abs()
                .add(ay.abs())
                .max(bx.abs().add(by.abs()))
                .max(cx.abs().add(cy.abs()));
            let tiny = L::splat(f32::MIN_POSITIVE);
            let error = edge_errors(depth.mul_add(L::splat(LANE_SHEAR_ERROR), tiny), lateral);
            let misses = least.below_and_above(L::splat(0.0).sub(error), greatest, error);
            let certain = error.below(least) | greatest.below(L::splat(0.0).sub(error));
            // Where along the ray: see `tolerance::LANE_DEPTH_ERROR`.
            let inverse = L::splat(1.0).div(u.add(v).add(w));
            let nearest = u
                .mul(inverse)
                .mul_add(az, v.mul(inverse).mul_add(bz, w.mul(inverse).mul(cz)));
            let nearest = nearest.flipped_with(rate);
            let share = error
                .mul(inverse.abs())
                .mul_add(L::splat(8.0), L::splat(2.0 * LANE_DEPTH_ERROR));
            let margin = depth.mul_add(share, L::splat(least_length));
            let (near, far) = (nearest.sub(margin), nearest.add(margin));
            let [first, last] = ends;
            let outside = far.below(first) | last.below(near);
            let possible = met & !misses & !outside;
            let met = possible & certain & first.below(near);
            Candidates {
                possible,
                met,
                hit: met & far.below(last),
                near,
                far,
            }
        }
    }
}

/// [`edge_error`](crate::geometry::tolerance::edge_error), in lanes.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn edge_errors<L: Lanes>(shear: L, lateral: L) -> L {
    // SAFETY: the caller's promise.
    unsafe {
        let tiny = L::splat(f32::MIN_POSITIVE);
        let products = lateral.mul(lateral).mul_add(L::splat(PRODUCT_ERROR), tiny);
        shear.add(shear).mul_add(lateral.add(shear), products)
    }
}

/// What the lanes know of a block's triangles: a bit for each.
#[derive(Clone, Copy)]
pub(super) struct Candidates<L> {
    /// Not certainly missed.
    pub(super) possible: u32,
    /// Of these, those that the ray's line certainly meets, after the interval's beginning.
    pub(super) met: u32,
    /// Of these, those that it certainly meets before the interval's end.
    pub(super) hit: u32,
    /// For those met: between which lengths of the ray along the frame's z.
    pub(super) near: L,
    pub(super) far: L,
}

impl<L: Lanes> Candidates<L> {
    /// None; any value will do for the lengths.
    #[inline(always)]
    pub(super) fn none(any: L) -> Self {
        Self {
            possible: 0,
            met: 0,
            hit: 0,
            near: any,
            far: any,
        }
    }
}
