//! The search for the nearest hit among the triangles that lanes have not ruled out.

use std::mem::MaybeUninit;

use glam::Vec3;

use super::super::store::HEADER;
use super::super::walk::LaneRay;
use super::depth::depth_bounds;
use super::edges::Candidates;
use super::kernel::Lanes;
use super::{Found, Passed};
use crate::geometry::{Ray, RayFrame, Triangle, rounded};

/// One triangle of a block, and its number.
///
/// # Safety
/// `block` begins a block of `count` triangles, of which `lane` is one.
#[inline(always)]
pub(super) unsafe fn triangle(block: *const f32, count: usize, lane: usize) -> (Triangle, u32) {
    // SAFETY: the caller's promise.
    unsafe {
        let row = |row: usize| *block.add(HEADER + row * count + lane);
        let corner = |c: usize| Vec3::new(row(3 * c), row(3 * c + 1), row(3 * c + 2));
        (
            Triangle::new(corner(0), corner(1), corner(2)),
            row(9).to_bits(),
        )
    }
}

/// A triangle that is certainly met, at a length along the frame's z that is not known exactly yet.
#[derive(Clone, Copy)]
struct Pending {
    block: *const f32,
    /// Triangles in the block.
    count: u32,
    lane: u32,
    /// Least length at which it may be met.
    near: f32,
}

/// Triangles that wait for their exact depth, at most.
const MOST_PENDING: usize = 8;

/// A search for the nearest hit.
///
/// Exact depths are dear, and of the triangles that a ray meets only the nearest matters. So those that are certainly met wait, and
/// only their bounds take part in the search; mostly one is left at the end.
pub(super) struct Search<'a> {
    ray: &'a Ray,
    passed: Passed,
    /// Lengths along the frame's z for one unit of `t`.
    rate: f32,
    /// Not less than the magnitude of any difference between a corner and the origin, along each axis.
    span: f32,
    /// The nearest of those that are known exactly.
    found: Found,
    pending: [MaybeUninit<Pending>; MOST_PENDING],
    pending_count: usize,
    /// Lengths along the frame's z between which a hit matters.
    pub(super) ends: [f32; 2],
}

impl<'a> Search<'a> {
    /// Nothing yet.
    #[inline(always)]
    pub(super) fn new(ray: &'a Ray, lanes: &LaneRay, passed: Passed) -> Self {
        Self {
            ray,
            passed,
            rate: lanes.rate.abs(),
            span: lanes.span,
            found: Found::NOTHING,
            pending: [const { MaybeUninit::uninit() }; MOST_PENDING],
            pending_count: 0,
            ends: lanes.ends(ray.interval.min, ray.interval.max),
        }
    }

    /// Takes the candidates of a block.
    ///
    /// # Safety
    /// As for [`Lanes`]; `block` begins a block of `count` triangles.
    #[inline(always)]
    pub(super) unsafe fn take<L: Lanes>(
        &mut self,
        block: *const f32,
        count: usize,
        candidates: Candidates<L>,
    ) {
        let certain = if self.passed.is_some() {
            0
        } else {
            candidates.met
        };
        let doubtful = candidates.possible & !certain;
        if doubtful != 0 {
            // SAFETY: the caller's promise.
            unsafe { self.settle(block, count, doubtful) };
        }
        if certain == 0 {
            return;
        }
        let (mut near, mut far) = ([0.0; 8], [0.0; 8]);
        // SAFETY: the caller's promise.
        unsafe {
            candidates.near.store(&mut near);
            candidates.far.store(&mut far);
        }
        let mut left = certain;
        while left != 0 {
            let lane = left.trailing_zeros();
            left &= left - 1;
            // SAFETY: a lane is below 8.
            let (near, far) = unsafe {
                (
                    *near.get_unchecked(lane as usize),
                    *far.get_unchecked(lane as usize),
                )
            };
            if near > self.ends[1] {
                continue;
            }
            if self.pending_count == MOST_PENDING {
                // SAFETY: what waits was put there by this function.
                unsafe { self.settle_many::<L>() };
            } else if self.pending_count == 1 {
                // SAFETY: as above. The usual case: what waited is certainly further.
                let waiting = unsafe { self.pending[0].assume_init() };
                self.pending_count = usize::from(waiting.near <= far);
            }
            self.pending[self.pending_count].write(Pending {
                block,
                count: count as u32,
                lane,
                near,
            });
            self.pending_count += 1;
            if far < self.ends[1] {
                self.ends[1] = far;
            }
        }
    }

    /// Finds the exact depth of what waits.
    ///
    /// # Safety
    /// As for [`Lanes`]; what waits names blocks and lanes of them.
    #[inline(always)]
    unsafe fn settle_pending<L: Lanes>(&mut self) {
        for index in 0..self.pending_count {
            // SAFETY: as many were written; the caller's promise.
            let waiting = unsafe { self.pending[index].assume_init() };
            if waiting.near <= self.ends[1] {
                // SAFETY: the caller's promise.
                unsafe { self.settle_one::<L>(&waiting) };
            }
        }
        self.pending_count = 0;
    }

    /// Finds the exact depth of one that waits.
    ///
    /// # Safety
    /// As for `settle_pending`.
    #[inline(always)]
    unsafe fn settle_one<L: Lanes>(&mut self, waiting: &Pending) {
        let (block, count, lane) = (waiting.block, waiting.count as usize, waiting.lane as usize);
        // SAFETY: the caller's promise.
        let (triangle, number) = unsafe { triangle(block, count, lane) };
        // SAFETY: the caller's promise; a block's first word is the bound on its triangles' lengths.
        let length = 0.5 * unsafe { *block };
        match rounded(depth_bounds::<L>(
            self.ray, &triangle, length, self.span, self.rate,
        )) {
            Some(t) if self.ray.interval.contains(t) => self.offer(t, number),
            Some(_) => {}
            // SAFETY: the caller's promise. With the triangle read again, so that above it need not be in memory.
            None => unsafe { self.settle(block, count, 1 << lane) },
        }
    }

    /// As `settle_pending`, out of the way.
    ///
    /// # Safety
    /// As for `settle_pending`.
    #[cold]
    #[inline(never)]
    unsafe fn settle_many<L: Lanes>(&mut self) {
        // SAFETY: the caller's promise.
        unsafe { self.settle_pending::<L>() }
    }

    /// Tests the triangles of a block whose lanes are in doubt, exactly.
    ///
    /// # Safety
    /// `block` begins a block of `count` triangles.
    #[cold]
    #[inline(never)]
    unsafe fn settle(&mut self, block: *const f32, count: usize, mut doubtful: u32) {
        let frame = RayFrame::of_traceable(self.ray);
        while doubtful != 0 {
            let lane = doubtful.trailing_zeros() as usize;
            doubtful &= doubtful - 1;
            // SAFETY: the caller's promise.
            let (triangle, number) = unsafe { triangle(block, count, lane) };
            if let Some(t) = frame.intersect(&triangle) {
                self.offer(t, number);
            }
        }
    }

    fn offer(&mut self, t: f32, number: u32) {
        if self.found.is_behind(t, number, self.passed) {
            self.found = Found { t, number };
            let length = (t * self.rate).next_up();
            self.ends[1] = self.ends[1].min(length);
        }
    }

    /// The nearest hit.
    ///
    /// # Safety
    /// As for `settle_pending`.
    #[inline(always)]
    pub(super) unsafe fn finish<L: Lanes>(&mut self) -> Found {
        if self.pending_count > 0 {
            // SAFETY: the caller's promise.
            unsafe { self.settle_pending::<L>() };
        }
        self.found
    }
}
