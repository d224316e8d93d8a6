//! The search for the nearest hit among the triangles that lanes have not ruled out.

use std::mem::MaybeUninit;

use glam::Vec3;

use super::super::store::HEADER;
use super::super::walk::LaneRay;
use super::edges::Candidates;
use super::kernel::Lanes;
use super::{Found, Passed};
use crate::geometry::{Ray, RayFrame, Triangle, depth};

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
                unsafe { self.settle_many() };
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
    /// What waits names blocks and lanes of them.
    #[inline(always)]
    unsafe fn settle_pending(&mut self) {
        for index in 0..self.pending_count {
            // SAFETY: as many were written; the caller's promise.
            let waiting = unsafe { self.pending[index].assume_init() };
            if waiting.near <= self.ends[1] {
                // SAFETY: the caller's promise.
                let (triangle, number) = unsafe {
                    triangle(waiting.block, waiting.count as usize, waiting.lane as usize)
                };
                if let Some(t) = depth(self.ray, &triangle) {
                    self.offer(t, number);
                }
            }
        }
        self.pending_count = 0;
    }

    /// As `settle_pending`, out of the way.
    ///
    /// # Safety
    /// As for `settle_pending`.
    #[cold]
    #[inline(never)]
    unsafe fn settle_many(&mut self) {
        // SAFETY: the caller's promise.
        unsafe { self.settle_pending() }
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
        let wins = t < self.found.t || (t <= self.found.t && number < self.found.number);
        let is_passed = self
            .passed
            .is_some_and(|(least, end)| t <= least && number < end);
        if wins && !is_passed {
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
    pub(super) unsafe fn finish(&mut self) -> Found {
        if self.pending_count > 0 {
            // SAFETY: the caller's promise.
            unsafe { self.settle_pending() };
        }
        self.found
    }
}
