//! A shaft around the lines of a group's rays: what lies beside it, none of them meets.
//!
//! In the group's frame, each coordinate x and y of a line is a linear function of z. At both ends of the stretch of z that matters, the
//! least and the greatest over all rays are taken; lines through these bound the rays in between.

use super::super::node::Node;
use super::super::store::HEADER;
use super::bundle::{Bundle, Frame};
use super::kernel::{Lanes, ROW, row};
use crate::geometry::tolerance::SHAFT_ERROR;

/// A line beside all rays: x or y as a function of z.
#[derive(Clone, Copy)]
struct Side<L> {
    at_zero: L,
    slope: L,
    /// Row of a node's bounds with the z at which the line is furthest outwards.
    z: usize,
}

/// A shaft, and a ray in it for the order of boxes.
pub(super) struct Shaft<L> {
    /// For x and y.
    low: [Side<L>; 2],
    high: [Side<L>; 2],
    /// z at its ends, the least first.
    ends: [L; 2],
    /// For x and y, how far the slopes of the rays lie apart.
    pub(super) spread: [f32; 2],
    axes: [usize; 3],
    near: [usize; 3],
    inverse: [L; 2],
    enter: [L; 3],
    sign: L,
}

/// Least and greatest of lanes, and of all.
struct Range<L> {
    least: L,
    greatest: L,
}

impl<L: Lanes> Range<L> {
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn empty() -> Self {
        // SAFETY: the caller's promise.
        unsafe {
            Self {
                least: L::splat(f32::INFINITY),
                greatest: L::splat(f32::NEG_INFINITY),
            }
        }
    }

    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn add(&mut self, x: L) {
        // SAFETY: the caller's promise.
        unsafe {
            self.least = self.least.min(x);
            self.greatest = self.greatest.max(x);
        }
    }

    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn ends(&self) -> [f32; 2] {
        // SAFETY: the caller's promise.
        unsafe { [self.least.least(), self.greatest.greatest()] }
    }
}

impl<L: Lanes> Shaft<L> {
    /// Around all lanes of these bundles, of which there is one at least. `middle` is a lane of the first for the order of boxes.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn around(
        bundles: &[Bundle<L>],
        frame: &Frame,
        largest: f32,
        middle: (usize, usize),
    ) -> Self {
        let sign = frame.sign();
        // SAFETY: the caller's promise.
        unsafe {
            let (mut begin, mut end) = (Range::<L>::empty(), Range::<L>::empty());
            let (mut x_slope, mut y_slope) = (Range::<L>::empty(), Range::<L>::empty());
            let mut spans = Range::<L>::empty();
            let along = L::splat(sign);
            for bundle in bundles {
                begin.add(bundle.origin[2].mul_add(along, bundle.first));
                end.add(bundle.origin[2].mul_add(along, bundle.last));
                x_slope.add(bundle.shear[0]);
                y_slope.add(bundle.shear[1]);
                let [x, y, z] = bundle.origin;
                spans.add(x.abs().add(y.abs()).add(z.abs()));
            }
            let span = spans.ends()[1] + largest;
            let pad = SHAFT_ERROR * span + f32::MIN_POSITIVE;
            let begin = begin.ends()[0].clamp(-largest, largest) - pad;
            let end = end.ends()[1].clamp(-largest, largest) + pad;
            let (begin, end) = (begin * sign, end * sign);
            let mut x = [Range::<L>::empty(), Range::<L>::empty()];
            let mut y = [Range::<L>::empty(), Range::<L>::empty()];
            for bundle in bundles {
                let (to_begin, to_end) = (
                    L::splat(begin).sub(bundle.origin[2]),
                    L::splat(end).sub(bundle.origin[2]),
                );
                x[0].add(bundle.shear[0].mul_add(to_begin, bundle.origin[0]));
                x[1].add(bundle.shear[0].mul_add(to_end, bundle.origin[0]));
                y[0].add(bundle.shear[1].mul_add(to_begin, bundle.origin[1]));
                y[1].add(bundle.shear[1].mul_add(to_end, bundle.origin[1]));
            }
            let [x_low, x_high] = sides(&x, [begin, end], pad, frame.axes[2]);
            let [y_low, y_high] = sides(&y, [begin, end], pad, frame.axes[2]);
            let order = bundles[middle.0].node_ray(middle.1, frame);
            let [x_slope, y_slope] = [x_slope.ends(), y_slope.ends()];
            Self {
                low: [x_low, y_low],
                high: [x_high, y_high],
                ends: [L::splat(begin.min(end)), L::splat(begin.max(end))],
                spread: [x_slope[1] - x_slope[0], y_slope[1] - y_slope[0]],
                axes: frame.axes,
                near: order.near,
                inverse: [order.inverse[0], order.inverse[1]],
                enter: order.enter,
                sign: order.inverse[2],
            }
        }
    }

    /// How far beside the shaft boxes lie along x or y: positive if they do.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn beside(&self, node: &Node, axis: usize) -> L {
        let least = ROW * self.axes[axis];
        let (low, high) = (&self.low[axis], &self.high[axis]);
        // SAFETY: the caller's promise; rows of bounds.
        unsafe {
            let (least, greatest) = (row::<L>(node, least), row::<L>(node, least + 3 * ROW));
            let below = row::<L>(node, low.z).mul_add(low.slope, low.at_zero.sub(greatest));
            let above = row::<L>(node, high.z).neg_mul_add(high.slope, least.sub(high.at_zero));
            below.max(above)
        }
    }

    /// The children whose extents the shaft meets: a bit for each, and about where it enters them.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn test(&self, node: &Node) -> (u32, L) {
        let z = ROW * self.axes[2];
        // SAFETY: the caller's promise; rows of bounds.
        unsafe {
            let before = row::<L>(node, z).sub(self.ends[1]);
            let behind = self.ends[0].sub(row::<L>(node, z + 3 * ROW));
            // A lane without a child is beyond both ends; what is not a number on the way is the first of `max`, which then gives the second.
            let along = before.max(behind);
            let beside = self.beside(node, 1).max(along);
            let outside = self.beside(node, 0).max(beside);
            let x = row::<L>(node, self.near[0]).mul_add(self.inverse[0], self.enter[0]);
            let y = row::<L>(node, self.near[1]).mul_add(self.inverse[1], self.enter[1]);
            let z = row::<L>(node, self.near[2]).mul_add(self.sign, self.enter[2]);
            (outside.at_most(L::splat(0.0)), x.max(y).max(z))
        }
    }

    /// The triangles of a block that are not all on one side of the shaft.
    ///
    /// # Safety
    /// As for [`Lanes`]; `block` begins a block of `count` triangles.
    #[inline(always)]
    pub(super) unsafe fn test_block(&self, block: *const f32, count: usize) -> u32 {
        // SAFETY: the caller's promise; a store ends with eight words to spare.
        unsafe {
            let rows = block.add(HEADER);
            let (next, third) = (3 * count, 6 * count);
            let z = rows.add(self.axes[2] * count);
            let z = [L::load(z), L::load(z.add(next)), L::load(z.add(third))];
            let x = rows.add(self.axes[0] * count);
            let x = [L::load(x), L::load(x.add(next)), L::load(x.add(third))];
            let y = rows.add(self.axes[1] * count);
            let y = [L::load(y), L::load(y.add(next)), L::load(y.add(third))];
            let outside = beyond(&self.low[0], &self.high[0], &x, &z).max(beyond(
                &self.low[1],
                &self.high[1],
                &y,
                &z,
            ));
            let beside = L::splat(0.0).below(outside);
            !beside & ((1 << count) - 1)
        }
    }
}

/// How far the nearest of three corners lies beside two sides: positive if all are beyond one of them.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn beyond<L: Lanes>(low: &Side<L>, high: &Side<L>, x: &[L; 3], z: &[L; 3]) -> L {
    // SAFETY: the caller's promise.
    unsafe {
        let below = z[0]
            .mul_add(low.slope, low.at_zero.sub(x[0]))
            .min(z[1].mul_add(low.slope, low.at_zero.sub(x[1])))
            .min(z[2].mul_add(low.slope, low.at_zero.sub(x[2])));
        let above = z[0]
            .neg_mul_add(high.slope, x[0].sub(high.at_zero))
            .min(z[1].neg_mul_add(high.slope, x[1].sub(high.at_zero)))
            .min(z[2].neg_mul_add(high.slope, x[2].sub(high.at_zero)));
        below.max(above)
    }
}

/// The sides around what lies in these ranges at two z.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn sides<L: Lanes>(
    ranges: &[Range<L>; 2],
    z: [f32; 2],
    pad: f32,
    axis: usize,
) -> [Side<L>; 2] {
    // SAFETY: the caller's promise.
    unsafe {
        let ([begin_low, begin_high], [end_low, end_high]) = (ranges[0].ends(), ranges[1].ends());
        // Any slope will do, the chord's is best.
        let low = chord(begin_low, end_low, z);
        let high = chord(begin_high, end_high, z);
        let low_at_zero = (begin_low - low * z[0]).min(end_low - low * z[1]) - pad;
        let high_at_zero = (begin_high - high * z[0]).max(end_high - high * z[1]) + pad;
        let (least, greatest) = (ROW * axis, ROW * (axis + 3));
        [
            Side {
                at_zero: L::splat(low_at_zero),
                slope: L::splat(low),
                z: if low >= 0.0 { least } else { greatest },
            },
            Side {
                at_zero: L::splat(high_at_zero),
                slope: L::splat(high),
                z: if high >= 0.0 { greatest } else { least },
            },
        ]
    }
}

/// The slope between two points, at most 1 in magnitude as the rays' are; 0 if there is none.
#[inline(always)]
fn chord(from: f32, to: f32, z: [f32; 2]) -> f32 {
    let slope = (to - from) / (z[1] - z[0]);
    if slope.is_nan() {
        0.0
    } else {
        slope.clamp(-1.0, 1.0)
    }
}
