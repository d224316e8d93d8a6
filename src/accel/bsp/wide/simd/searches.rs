//! The searches for the nearest hits of a group's rays.
//!
//! As [`Search`](super::search::Search) does it for one ray: of the triangles that a ray certainly meets, the nearest waits for its exact depth
//! until the end; a hit that may be as near makes both exact at once.

use std::mem::MaybeUninit;

use super::super::node::WIDTH;
use super::Found;
use super::depth::depth_bounds;
use super::edges::Candidates;
use super::group::Group;
use super::kernel::Lanes;
use super::search::triangle;
use super::table::{GROUP, Table};
use super::together::{is_by_triangle, vectors};
use crate::geometry::{Ray, RayFrame, is_beside, rounded};

/// A triangle that is certainly met.
#[derive(Clone, Copy)]
struct Pending {
    block: *const f32,
    /// Triangles in the block, in its eighth upwards; the triangle's lane below.
    count_and_lane: u32,
    /// Least length at which it may be met.
    near: f32,
}

impl Pending {
    const NOTHING: Self = Self {
        block: std::ptr::null(),
        count_and_lane: 0,
        near: f32::INFINITY,
    };

    fn count(&self) -> usize {
        (self.count_and_lane >> 3) as usize
    }

    fn lane(&self) -> usize {
        (self.count_and_lane & 7) as usize
    }
}

/// Searches, one for each ray of a group.
pub(super) struct Searches<'a, L> {
    pub(super) group: Group<'a, L>,
    table: &'a Table,
    rays: &'a [Ray],
    pending: [Pending; GROUP],
    /// The nearest of those that are known exactly.
    found: [MaybeUninit<Found>; GROUP],
    /// The places of rays for which there is one.
    exact: u64,
}

impl<'a, L: Lanes> Searches<'a, L> {
    #[inline(always)]
    pub(super) fn new(group: Group<'a, L>, table: &'a Table, rays: &'a [Ray]) -> Self {
        Self {
            group,
            table,
            rays,
            pending: [Pending::NOTHING; GROUP],
            found: [const { MaybeUninit::uninit() }; GROUP],
            exact: 0,
        }
    }

    /// Tests the triangles of a block against the active rays.
    ///
    /// # Safety
    /// As for [`Lanes`]; `block` begins a block of `count` triangles; active places have rays.
    #[inline(always)]
    pub(super) unsafe fn test_block(&mut self, block: *const f32, count: usize, active: u64) {
        // SAFETY: the caller's promise.
        unsafe {
            let possible = self.group.shaft.test_block(block, count);
            if possible == 0 {
                return;
            }
            if is_by_triangle(
                active.count_ones(),
                possible.count_ones(),
                vectors(active).count_ones(),
            ) {
                let mut vectors = vectors(active);
                while vectors != 0 {
                    let first = vectors.trailing_zeros() as usize;
                    vectors &= vectors - 1;
                    let part = (active >> first) as u32 & 0xff;
                    self.test_triangles(block, count, possible, first, part);
                }
                return;
            }
            let mut left = active;
            while left != 0 {
                let place = left.trailing_zeros() as usize;
                left &= left - 1;
                let (bundle, lane) = (
                    self.group.bundles.get_unchecked(place / WIDTH),
                    place % WIDTH,
                );
                let block_ray = bundle.block_ray(lane, &self.group.frame);
                let candidates = block_ray.test(block, count, bundle.ends(lane));
                if candidates.possible != 0 {
                    self.take_of_block(place, block, count, candidates);
                }
            }
        }
    }

    /// Tests triangles of a block one by one against a vector of rays.
    ///
    /// # Safety
    /// As for `test_block`.
    #[inline(always)]
    unsafe fn test_triangles(
        &mut self,
        block: *const f32,
        count: usize,
        mut triangles: u32,
        first: usize,
        part: u32,
    ) {
        // SAFETY: the caller's promise.
        unsafe {
            let error = self
                .group
                .bundles
                .get_unchecked(first / WIDTH)
                .edge_error(*block);
            while triangles != 0 {
                let triangle = triangles.trailing_zeros() as usize;
                triangles &= triangles - 1;
                let bundle = self.group.bundles.get_unchecked(first / WIDTH);
                let frame = &self.group.frame;
                let candidates = bundle.test(block, count, triangle, frame, error, part);
                let mut left = candidates.possible;
                while left != 0 {
                    let lane = left.trailing_zeros() as usize;
                    left &= left - 1;
                    let place = first + lane;
                    let pending = Pending {
                        block,
                        count_and_lane: (count << 3 | triangle) as u32,
                        near: candidates.near.lane(lane),
                    };
                    let is_met = candidates.met >> lane & 1 != 0;
                    self.take(place, is_met, pending, candidates.far.lane(lane));
                }
            }
        }
    }

    /// Takes the candidates of a block for one ray.
    ///
    /// # Safety
    /// As for `test_block`.
    #[inline(always)]
    pub(super) unsafe fn take_of_block(
        &mut self,
        place: usize,
        block: *const f32,
        count: usize,
        candidates: Candidates<L>,
    ) {
        let mut left = candidates.possible;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            // SAFETY: the caller's promise.
            unsafe {
                let pending = Pending {
                    block,
                    count_and_lane: (count << 3 | lane) as u32,
                    near: candidates.near.lane(lane),
                };
                let is_met = candidates.met >> lane & 1 != 0;
                self.take(place, is_met, pending, candidates.far.lane(lane));
            }
        }
    }

    /// Takes one triangle that a ray may meet, at `far` at most if it does.
    ///
    /// # Safety
    /// As for `test_block`.
    #[inline(always)]
    unsafe fn take(&mut self, place: usize, is_met: bool, pending: Pending, far: f32) {
        // SAFETY: the caller's promise: places are below `GROUP`.
        unsafe {
            let bundle = self.group.bundles.get_unchecked_mut(place / WIDTH);
            let lane = place % WIDTH;
            if !is_met {
                self.settle(place, pending);
                return;
            }
            let end = bundle.last.lane(lane);
            if pending.near > end {
                return;
            }
            let waiting = self.pending.get_unchecked_mut(place);
            if waiting.near <= far && !waiting.block.is_null() {
                self.settle_both(place, pending);
                return;
            }
            *waiting = pending;
            if far < end {
                bundle.last.set_lane(lane, far);
            }
        }
    }

    /// A ray's triangles that may be equally near.
    ///
    /// # Safety
    /// As for `test_block`.
    #[cold]
    #[inline(never)]
    unsafe fn settle_both(&mut self, place: usize, pending: Pending) {
        let waiting = std::mem::replace(&mut self.pending[place], Pending::NOTHING);
        // SAFETY: the caller's promise.
        unsafe {
            self.offer(place, waiting);
            self.offer(place, pending);
        }
    }

    /// A triangle that a ray may meet or not.
    ///
    /// # Safety
    /// As for `test_block`.
    #[cold]
    #[inline(never)]
    unsafe fn settle(&mut self, place: usize, pending: Pending) {
        let ray = &self.rays[usize::from(self.table.rays[place])];
        // SAFETY: the caller's promise.
        unsafe {
            let (triangle, number) = triangle(pending.block, pending.count(), pending.lane());
            if is_beside(ray, &triangle) {
                return;
            }
            if let Some(t) = RayFrame::of_traceable(ray).intersect(&triangle) {
                self.offer_exact(place, t, number);
            }
        }
    }

    /// A triangle that a ray certainly meets: its exact depth.
    ///
    /// # Safety
    /// As for `test_block`.
    #[inline(always)]
    unsafe fn offer(&mut self, place: usize, pending: Pending) {
        // SAFETY: the caller's promise.
        unsafe {
            let ray = self.rays.get_unchecked(usize::from(self.table.rays[place]));
            let (triangle, number) = triangle(pending.block, pending.count(), pending.lane());
            let bundle = self.group.bundles.get_unchecked(place / WIDTH);
            let lane = place % WIDTH;
            let (span, rate) = (bundle.span(lane), bundle.rate.lane(lane));
            // A block's first word is twice the bound on its triangles' edges.
            let length = 0.5 * *pending.block;
            match rounded(depth_bounds::<L>(ray, &triangle, length, span, rate)) {
                Some(t) if ray.interval.contains(t) => self.offer_exact(place, t, number),
                Some(_) => {}
                None => self.settle(place, pending),
            }
        }
    }

    /// # Safety
    /// As for `test_block`.
    unsafe fn offer_exact(&mut self, place: usize, t: f32, number: u32) {
        if self.exact >> place & 1 != 0 {
            // SAFETY: it was written when the bit was set.
            let found = unsafe { self.found[place].assume_init() };
            if t > found.t || (t >= found.t && number >= found.number) {
                return;
            }
        }
        self.exact |= 1 << place;
        self.found[place].write(Found { t, number });
        let bundle = &mut self.group.bundles[place / WIDTH];
        let lane = place % WIDTH;
        // SAFETY: the caller's promise.
        unsafe {
            let length = (t * bundle.rate.lane(lane)).next_up();
            if length < bundle.last.lane(lane) {
                bundle.last.set_lane(lane, length);
            }
        }
    }

    /// The nearest hits, in the order in which the rays were given.
    ///
    /// # Safety
    /// As for `test_block`.
    #[inline(always)]
    pub(super) unsafe fn finish(mut self, found: &mut [Found]) {
        for place in 0..self.table.count {
            let pending = self.pending[place];
            // SAFETY: the caller's promise; what is exact was written.
            unsafe {
                if !pending.block.is_null() {
                    self.offer(place, pending);
                }
                found[usize::from(self.table.rays[place])] = if self.exact >> place & 1 != 0 {
                    self.found[place].assume_init()
                } else {
                    Found::NOTHING
                };
            }
        }
    }
}
