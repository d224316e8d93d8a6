//! Rays in lanes: as many as a vector has, in one frame, ready for boxes and triangles.
//!
//! The rays of a group have the same signs and the same largest axis. In their frame, which has that axis last, each is a line
//! `origin + length * (shear.x, shear.y, 1) * sign`, and all lengths are along the frame's z.

use super::super::store::HEADER;
use super::edges::{Candidates, Edges, edge_errors};
use super::kernel::{BlockRay, Lanes, NodeRay, ROW};
use crate::geometry::tolerance::{
    BOUND_ROUNDING, GROUP_WALK_ERROR, LEAST_LENGTH, SHEAR_ERROR, U32,
};

/// What the rays of a group have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Frame {
    /// The coordinates' indices, the directions' largest last.
    pub(super) axes: [usize; 3],
    /// In the order of `axes`: whether the directions point down.
    pub(super) is_down: [bool; 3],
}

impl Frame {
    /// Rows of a node's bounds where rays enter, and where they leave: how many bytes come before them.
    #[inline(always)]
    pub(super) fn rows(&self) -> [[usize; 3]; 2] {
        let (mut near, mut far) = ([0; 3], [0; 3]);
        for (i, (axis, is_down)) in self.axes.into_iter().zip(self.is_down).enumerate() {
            near[i] = ROW * (axis + 3 * usize::from(is_down));
            far[i] = ROW * (axis + 3 * usize::from(!is_down));
        }
        [near, far]
    }

    /// 1 or -1: the directions' along the frame's z.
    #[inline(always)]
    pub(super) fn sign(&self) -> f32 {
        if self.is_down[2] { -1.0 } else { 1.0 }
    }
}

/// Rays as they are given, a lane each, coordinates in the order of a frame.
pub(super) struct Given<L> {
    pub(super) origin: [L; 3],
    pub(super) direction: [L; 3],
    pub(super) interval: [L; 2],
}

/// The faces of a box, the same in all lanes: where rays enter, and where they leave. The frame's z is counted along the rays.
pub(super) struct Faces<L> {
    pub(super) near: [L; 3],
    pub(super) far: [L; 3],
}

/// Rays in lanes.
#[derive(Clone, Copy)]
pub(super) struct Bundle<L> {
    pub(super) origin: [L; 3],
    pub(super) shear: [L; 2],
    /// Lengths along the frame's z for one unit of `t`.
    pub(super) rate: L,
    /// Bound on the error of a sheared coordinate.
    error: L,
    inverse: [L; 2],
    enter: [L; 3],
    leave: [L; 3],
    /// Lengths between which a hit matters.
    pub(super) first: L,
    pub(super) last: L,
}

/// The sum of the magnitudes of a vector's components.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn sum_of_magnitudes<L: Lanes>(v: [L; 3]) -> L {
    // SAFETY: the caller's promise.
    unsafe { v[0].abs().add(v[1].abs()).add(v[2].abs()) }
}

impl<L: Lanes> Bundle<L> {
    /// Rays that walk, see [`WalkRay`](super::super::walk::WalkRay), in a tree with coordinates up to `largest`.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn new(given: &Given<L>, frame: &Frame, largest: f32) -> Self {
        let Given {
            origin, direction, ..
        } = *given;
        // SAFETY: the caller's promise.
        unsafe {
            let tiny = L::splat(f32::MIN_POSITIVE);
            let zero = L::splat(0.0);
            let span = sum_of_magnitudes(origin).add(L::splat(largest));
            let displacement = span.mul_add(L::splat(GROUP_WALK_ERROR), tiny);
            let rate = direction[2].abs();
            let shear = [
                direction[0].div(direction[2]),
                direction[1].div(direction[2]),
            ];
            let x = Slope::new(origin[0], shear[0], direction[0], displacement);
            let y = Slope::new(origin[1], shear[1], direction[1], displacement);
            let along = origin[2].mul(L::splat(frame.sign()));
            Self {
                origin,
                shear,
                rate,
                error: span.mul_add(L::splat(SHEAR_ERROR * BOUND_ROUNDING), tiny),
                inverse: [x.inverse, y.inverse],
                enter: [x.enter, y.enter, zero.sub(along.add(displacement))],
                leave: [x.leave, y.leave, displacement.sub(along)],
                first: given.interval[0].mul(rate),
                last: given.interval[1].mul(rate),
            }
        }
    }

    /// At least the difference between any coordinate of the tree and of the origin of the ray in a lane, below 8.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn span(&self, lane: usize) -> f32 {
        // SAFETY: the caller's promise.
        unsafe { self.error.lane(lane) / SHEAR_ERROR }
    }

    /// The rays that meet a box between their ends.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn meet(&self, faces: &Faces<L>) -> u32 {
        let Faces { near, far } = faces;
        // SAFETY: the caller's promise.
        unsafe {
            let first = near[0]
                .mul_add(self.inverse[0], self.enter[0])
                .max(near[1].mul_add(self.inverse[1], self.enter[1]))
                .max(near[2].add(self.enter[2]).max(self.first));
            let last = far[0]
                .mul_add(self.inverse[0], self.leave[0])
                .min(far[1].mul_add(self.inverse[1], self.leave[1]))
                .min(far[2].add(self.leave[2]).min(self.last));
            first.at_most(last)
        }
    }

    /// A bound on the error of the edge functions of any triangle that one of the rays' lines meets, if it is one of a block with this
    /// bound on lengths: as in [`BlockRay::test`].
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn edge_error(&self, lateral_bound: f32) -> L {
        // SAFETY: the caller's promise.
        unsafe {
            let lateral = self.error.mul_add(L::splat(4.0), L::splat(lateral_bound));
            edge_errors(self.error, lateral)
        }
    }

    /// A corner of a triangle, sheared along each ray. Its coordinates stand at these places.
    ///
    /// # Safety
    /// As for [`Lanes`]; a float may be read from each place.
    #[inline(always)]
    unsafe fn sheared(&self, x: *const f32, y: *const f32, z: *const f32) -> [L; 3] {
        // SAFETY: the caller's promise.
        unsafe {
            let z = L::splat(*z).sub(self.origin[2]);
            let x = L::splat(*x).sub(self.origin[0]);
            let y = L::splat(*y).sub(self.origin[1]);
            [
                self.shear[0].neg_mul_add(z, x),
                self.shear[1].neg_mul_add(z, y),
                z,
            ]
        }
    }

    /// The rays that may hit one triangle of a block, with the bound that [`Bundle::edge_error`] gives.
    ///
    /// # Safety
    /// As for [`Lanes`]; `block` begins a block of `count` triangles, of which `lane` is one.
    #[inline(always)]
    pub(super) unsafe fn test(
        &self,
        block: *const f32,
        count: usize,
        lane: usize,
        frame: &Frame,
        error: L,
        active: u32,
    ) -> Candidates<L> {
        // SAFETY: the caller's promise.
        unsafe {
            let rows = block.add(HEADER + lane);
            let x = rows.add(frame.axes[0] * count);
            let y = rows.add(frame.axes[1] * count);
            let z = rows.add(frame.axes[2] * count);
            let (corner, next) = (3 * count, 6 * count);
            let corners = [
                self.sheared(x, y, z),
                self.sheared(x.add(corner), y.add(corner), z.add(corner)),
                self.sheared(x.add(next), y.add(next), z.add(next)),
            ];
            let edges = Edges::of(&corners);
            let met = !edges.misses(error) & active;
            if met == 0 {
                return Candidates::none(error);
            }
            let sign = L::splat(frame.sign());
            edges.judge(&corners, met, sign, LEAST_LENGTH, [self.first, self.last])
        }
    }

    /// One of the rays, for the test of a node's children.
    ///
    /// # Safety
    /// As for [`Lanes`]; `lane` is one of them.
    #[inline(always)]
    pub(super) unsafe fn node_ray(&self, lane: usize, frame: &Frame) -> NodeRay<L> {
        let [near, far] = frame.rows();
        // SAFETY: the caller's promise.
        unsafe {
            NodeRay {
                inverse: [
                    L::splat(self.inverse[0].lane(lane)),
                    L::splat(self.inverse[1].lane(lane)),
                    L::splat(frame.sign()),
                ],
                enter: splat_lane(&self.enter, lane),
                leave: splat_lane(&self.leave, lane),
                near,
                far,
                first: L::splat(self.first.lane(lane)),
            }
        }
    }

    /// One of the rays, for the test of a block.
    ///
    /// # Safety
    /// As for [`Lanes`]; `lane` is one of them.
    #[inline(always)]
    pub(super) unsafe fn block_ray(&self, lane: usize, frame: &Frame) -> BlockRay<L> {
        // SAFETY: the caller's promise.
        unsafe {
            BlockRay {
                axes: frame.axes,
                origin: splat_lane(&self.origin, lane),
                shear: [
                    L::splat(self.shear[0].lane(lane)),
                    L::splat(self.shear[1].lane(lane)),
                ],
                rate: L::splat(frame.sign()),
                error: self.error.lane(lane),
                least: LEAST_LENGTH,
            }
        }
    }

    /// The ends of one of the rays.
    ///
    /// # Safety
    /// As for [`Lanes`]; `lane` is one of them.
    #[inline(always)]
    pub(super) unsafe fn ends(&self, lane: usize) -> [f32; 2] {
        // SAFETY: the caller's promise.
        unsafe { [self.first.lane(lane), self.last.lane(lane)] }
    }
}

/// # Safety
/// As for [`Lanes`]; `lane` is one of them.
#[inline(always)]
unsafe fn splat_lane<L: Lanes>(v: &[L; 3], lane: usize) -> [L; 3] {
    // SAFETY: the caller's promise.
    unsafe {
        [
            L::splat(v[0].lane(lane)),
            L::splat(v[1].lane(lane)),
            L::splat(v[2].lane(lane)),
        ]
    }
}

/// The rays' walk along x or y: `b * inverse + enter` is the length at which they enter the half space beyond a face at `b`.
struct Slope<L> {
    inverse: L,
    enter: L,
    leave: L,
}

impl<L: Lanes> Slope<L> {
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn new(origin: L, shear: L, direction: L, displacement: L) -> Self {
        // SAFETY: the caller's promise.
        unsafe {
            let steepness = L::splat(1.0).div(shear.abs().max(L::splat(U32)));
            let widen = steepness.mul(displacement);
            let inverse = steepness.flipped_with(direction);
            let middle = origin.mul(inverse);
            Self {
                inverse,
                enter: L::splat(0.0).sub(middle.add(widen)),
                leave: widen.sub(middle),
            }
        }
    }
}
