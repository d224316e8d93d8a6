//! What a set of instructions has to offer: lanes, and the two tests of a ray made of eight of them.

use super::super::node::{Node, WIDTH};
use super::super::store::HEADER;
use super::super::walk::{LaneRay, WalkRay};
use super::edges::{Candidates, Edges};
use crate::geometry::tolerance::edge_error;

/// Eight lanes of `f32`: as in memory, the first lane first, and nothing else.
///
/// # Safety
/// Every function may be called only where the machine has the instructions.
pub(super) trait Lanes: Copy {
    unsafe fn splat(x: f32) -> Self;
    /// From any address of eight floats.
    unsafe fn load(from: *const f32) -> Self;
    unsafe fn store(self, to: &mut [f32; 8]);
    unsafe fn add(self, other: Self) -> Self;
    unsafe fn sub(self, other: Self) -> Self;
    unsafe fn mul(self, other: Self) -> Self;
    unsafe fn div(self, other: Self) -> Self;
    /// `self * factor + summand`, fused or not.
    unsafe fn mul_add(self, factor: Self, summand: Self) -> Self;
    /// `summand - self * factor`, fused or not.
    unsafe fn neg_mul_add(self, factor: Self, summand: Self) -> Self;
    /// `self * factor - less`, fused or not.
    unsafe fn mul_sub(self, factor: Self, less: Self) -> Self;
    unsafe fn min(self, other: Self) -> Self;
    unsafe fn max(self, other: Self) -> Self;
    /// A bit for each lane where `self <= other`.
    unsafe fn at_most(self, other: Self) -> u32;
    /// A bit for each lane where `self < other`.
    unsafe fn below(self, other: Self) -> u32;
    /// A bit for each lane where `self < low` and `high < other`.
    unsafe fn below_and_above(self, low: Self, other: Self, high: Self) -> u32;
    unsafe fn abs(self) -> Self;
    /// With its sign flipped where `other` is negative.
    unsafe fn flipped_with(self, other: Self) -> Self;
    /// `a * b + c` in double precision, fused or not.
    fn fused(a: f64, b: f64, c: f64) -> f64;
    /// A bit for each lane whose sign is minus, that of zero too.
    unsafe fn signs(self) -> u32;
    /// The least of all lanes, none of which is a NaN.
    unsafe fn least(self) -> f32;
    /// The greatest.
    unsafe fn greatest(self) -> f32;

    /// One lane, below 8.
    #[inline(always)]
    unsafe fn lane(&self, lane: usize) -> f32 {
        // SAFETY: lanes are as in memory.
        unsafe { *std::ptr::from_ref(self).cast::<f32>().add(lane) }
    }

    /// Another value in one lane, below 8.
    #[inline(always)]
    unsafe fn set_lane(&mut self, lane: usize, value: f32) {
        // SAFETY: lanes are as in memory.
        unsafe { *std::ptr::from_mut(self).cast::<f32>().add(lane) = value }
    }
}

/// A ray in lanes, for the test of a node.
#[derive(Clone, Copy)]
pub(super) struct NodeRay<L> {
    pub(super) inverse: [L; 3],
    pub(super) enter: [L; 3],
    pub(super) leave: [L; 3],
    /// Rows of a node's bounds where the ray enters, and where it leaves: how many bytes come before them.
    pub(super) near: [usize; 3],
    pub(super) far: [usize; 3],
    pub(super) first: L,
}

impl<L: Lanes> NodeRay<L> {
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn new(walk: &WalkRay, first: f32) -> Self {
        let [near, far] = ROWS_BY_SIGNS[(walk.inverse.is_negative_bitmask() & 7) as usize];
        // SAFETY: the caller's promise.
        unsafe {
            Self {
                inverse: splat3(walk.inverse.truncate().to_array()),
                enter: splat3(walk.enter.truncate().to_array()),
                leave: splat3(walk.leave.truncate().to_array()),
                near,
                far,
                first: L::splat(first),
            }
        }
    }

    #[inline(always)]
    unsafe fn enters(&self, node: &Node, axis: usize) -> L {
        // SAFETY: the caller's promise.
        unsafe { row::<L>(node, self.near[axis]).mul_add(self.inverse[axis], self.enter[axis]) }
    }

    #[inline(always)]
    unsafe fn leaves(&self, node: &Node, axis: usize) -> L {
        // SAFETY: the caller's promise.
        unsafe { row::<L>(node, self.far[axis]).mul_add(self.inverse[axis], self.leave[axis]) }
    }

    /// The children whose extents the ray meets before `last`: a bit for each, and where it enters them.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn test(&self, node: &Node, last: L) -> (u32, L) {
        // SAFETY: the caller's promise.
        unsafe {
            let enter = [
                self.enters(node, 0),
                self.enters(node, 1),
                self.enters(node, 2),
            ];
            let leave = [
                self.leaves(node, 0),
                self.leaves(node, 1),
                self.leaves(node, 2),
            ];
            let first = enter[0].max(enter[1]).max(enter[2].max(self.first));
            let last = leave[0].min(leave[1]).min(leave[2].min(last));
            (first.at_most(last), first)
        }
    }
}

/// Where the rows of a node's bounds are at which a ray enters, and at which it leaves, by the signs of its direction: a bit each for those
/// that are negative.
const ROWS_BY_SIGNS: [[[usize; 3]; 2]; 8] = rows_by_signs();

const fn rows_by_signs() -> [[[usize; 3]; 2]; 8] {
    let mut rows = [[[0; 3]; 2]; 8];
    let mut signs = 0;
    while signs < 8 {
        let mut axis = 0;
        while axis < 3 {
            let is_negative = signs >> axis & 1;
            rows[signs][is_negative][axis] = ROW * axis;
            rows[signs][1 - is_negative][axis] = ROW * (axis + 3);
            axis += 1;
        }
        signs += 1;
    }
    rows
}

/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn splat3<L: Lanes>(v: [f32; 3]) -> [L; 3] {
    // SAFETY: the caller's promise.
    unsafe { [L::splat(v[0]), L::splat(v[1]), L::splat(v[2])] }
}

/// Bytes of a row of a node's bounds.
pub(super) const ROW: usize = size_of::<[f32; WIDTH]>();

/// A row of a node's bounds.
///
/// # Safety
/// As for [`Lanes`]; `offset` is that of a row.
#[inline(always)]
pub(super) unsafe fn row<L: Lanes>(node: &Node, offset: usize) -> L {
    // SAFETY: the caller's promise.
    unsafe { L::load(node.bounds.as_ptr().byte_add(offset).cast()) }
}

/// A ray in lanes, for the test of a block.
#[derive(Clone, Copy)]
pub(super) struct BlockRay<L> {
    pub(super) axes: [usize; 3],
    pub(super) origin: [L; 3],
    pub(super) shear: [L; 2],
    /// Its sign is the direction's along the frame's z.
    pub(super) rate: L,
    pub(super) error: f32,
    /// Error of a length that does not shrink with it.
    pub(super) least: f32,
}

impl<L: Lanes> BlockRay<L> {
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    pub(super) unsafe fn new(ray: &LaneRay) -> Self {
        // SAFETY: the caller's promise.
        unsafe {
            Self {
                axes: ray.axes,
                origin: splat3(ray.origin),
                shear: [L::splat(ray.shear[0]), L::splat(ray.shear[1])],
                rate: L::splat(ray.rate),
                error: ray.error,
                least: ray.least,
            }
        }
    }

    /// The corners whose coordinates along the frame's axes stand at these places.
    ///
    /// # Safety
    /// As for [`Lanes`]; eight floats may be read from each place.
    #[inline(always)]
    unsafe fn sheared(&self, x: *const f32, y: *const f32, z: *const f32) -> [L; 3] {
        // SAFETY: the caller's promise.
        unsafe {
            let z = L::load(z).sub(self.origin[2]);
            let x = L::load(x).sub(self.origin[0]);
            let y = L::load(y).sub(self.origin[1]);
            [
                self.shear[0].neg_mul_add(z, x),
                self.shear[1].neg_mul_add(z, y),
                z,
            ]
        }
    }

    /// The triangles of a block that the ray may hit.
    ///
    /// First the edge functions of Woop, Benthin and Wald, as [`RayFrame`](crate::geometry::RayFrame) has them, against a bound on
    /// their error that holds for every triangle of the block which the line meets. For what is left, which is little, the bound
    /// of each lane, and where along the ray they lie.
    ///
    /// # Safety
    /// As for [`Lanes`]; `block` begins a block of `count` triangles.
    #[inline(always)]
    pub(super) unsafe fn test(
        &self,
        block: *const f32,
        count: usize,
        ends: [f32; 2],
    ) -> Candidates<L> {
        // SAFETY: the caller's promise; a store ends with eight words to spare.
        unsafe {
            let rows = block.add(HEADER);
            let x = rows.add(self.axes[0] * count);
            let y = rows.add(self.axes[1] * count);
            let z = rows.add(self.axes[2] * count);
            let (corner, next) = (3 * count, 6 * count);
            let [ax, ay, az] = self.sheared(x, y, z);
            let [bx, by, bz] = self.sheared(x.add(corner), y.add(corner), z.add(corner));
            let [cx, cy, cz] = self.sheared(x.add(next), y.add(next), z.add(next));
            let corners = [[ax, ay, az], [bx, by, bz], [cx, cy, cz]];
            let edges = Edges::of(&corners);
            let error = edge_error(self.error, *block + 4.0 * self.error);
            let met = !edges.misses(L::splat(error)) & ((1 << count) - 1);
            if met == 0 {
                return Candidates::none(edges.u);
            }
            let ends = [L::splat(ends[0]), L::splat(ends[1])];
            edges.judge(&corners, met, self.rate, self.least, ends)
        }
    }
}
