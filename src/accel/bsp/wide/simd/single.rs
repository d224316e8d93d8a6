//! The walk of one ray: nearest child first, for the nearest hit; leaves first, for any.

use std::mem::MaybeUninit;

use super::super::node::{Node, WIDTH, Word};
use super::super::store::{FULL_BLOCK, HEADER};
use super::super::walk::{LaneRay, WalkRay};
use super::kernel::{BlockRay, Candidates, Lanes, NodeRay};
use super::{Found, Occluded, Passed, Tree};
use crate::accel::counters::Counter;
use crate::geometry::{Ray, RayFrame, Triangle, depth};
use glam::Vec3;

/// Levels that a tree may have at most: the walk's stack is made for them.
pub(in super::super) const MOST_DEPTH: u32 = 112;

/// Children that wait, at most: seven a level, and one more.
const STACK: usize = 7 * MOST_DEPTH as usize + 8;

/// A child that waits, and where the ray enters it.
#[derive(Clone, Copy)]
struct Waiting {
    from: f32,
    child: Word,
}

/// The children that wait, of one node the nearest last.
struct Stack {
    waiting: [MaybeUninit<Waiting>; STACK],
    height: usize,
}

impl Stack {
    #[inline(always)]
    fn new() -> Self {
        Self {
            waiting: [const { MaybeUninit::uninit() }; STACK],
            height: 0,
        }
    }

    /// The nearest of the children in `hit`; the others wait.
    ///
    /// # Safety
    /// As for [`Lanes`]; `hit` is not zero; the stack is as high as the tree's depth allows.
    #[inline(always)]
    unsafe fn descend<L: Lanes>(&mut self, node: &Node, mut hit: u32, from: L) -> Word {
        // SAFETY: lanes are below 8; the caller's promise; only what was written is read.
        unsafe {
            let first = hit.trailing_zeros() as usize;
            hit &= hit - 1;
            let child = |lane: usize| *node.children.get_unchecked(lane);
            if hit == 0 {
                return child(first);
            }
            let mut entries = [0.0; WIDTH];
            from.store(&mut entries);
            let entry = |lane: usize| Waiting {
                from: *entries.get_unchecked(lane),
                child: child(lane),
            };
            let second = hit.trailing_zeros() as usize;
            hit &= hit - 1;
            let (mut near, mut far) = (entry(first), entry(second));
            if far.from < near.from {
                (near, far) = (far, near);
            }
            let base = self.height;
            self.waiting.get_unchecked_mut(base).write(far);
            self.height += 1;
            while hit != 0 {
                let lane = hit.trailing_zeros() as usize;
                hit &= hit - 1;
                let mut next = entry(lane);
                if next.from < near.from {
                    (near, next) = (next, near);
                }
                let mut place = self.height;
                while place > base
                    && self.waiting.get_unchecked(place - 1).assume_init().from < next.from
                {
                    *self.waiting.get_unchecked_mut(place) = *self.waiting.get_unchecked(place - 1);
                    place -= 1;
                }
                self.waiting.get_unchecked_mut(place).write(next);
                self.height += 1;
            }
            near.child
        }
    }

    /// The last that waits and is entered up to `last`.
    ///
    /// # Safety
    /// What is below the height was written.
    #[inline(always)]
    unsafe fn pop(&mut self, last: f32) -> Option<Word> {
        while self.height > 0 {
            self.height -= 1;
            // SAFETY: the caller's promise.
            let waiting = unsafe { self.waiting.get_unchecked(self.height).assume_init() };
            if waiting.from <= last {
                return Some(waiting.child);
            }
        }
        None
    }
}

/// One triangle of a block, and its number.
///
/// # Safety
/// `block` begins a block of `count` triangles, of which `lane` is one.
#[inline(always)]
unsafe fn triangle(block: *const f32, count: usize, lane: usize) -> (Triangle, u32) {
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
struct Search<'a> {
    ray: &'a Ray,
    passed: Passed,
    /// Lengths along the frame's z for one unit of `t`.
    rate: f32,
    /// The nearest of those that are known exactly.
    found: Found,
    pending: [MaybeUninit<Pending>; MOST_PENDING],
    pending_count: usize,
    /// Lengths along the frame's z between which a hit matters.
    ends: [f32; 2],
}

impl Search<'_> {
    /// Takes the candidates of a block.
    ///
    /// # Safety
    /// As for [`Lanes`]; `block` begins a block of `count` triangles.
    #[inline(always)]
    unsafe fn take<L: Lanes>(
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
    unsafe fn finish(&mut self) -> Found {
        if self.pending_count > 0 {
            // SAFETY: the caller's promise.
            unsafe { self.settle_pending() };
        }
        self.found
    }
}

/// The nearest hit, the least number first among equals.
#[inline(always)]
pub(super) fn closest<L: Lanes, C: Counter>(
    tree: Tree<'_>,
    ray: &Ray,
    passed: Passed,
    counter: &mut C,
) -> Found {
    let Tree { store, root, reach } = tree;
    let Some(walk) = WalkRay::new(ray, reach) else {
        return Found::UNUSUAL;
    };
    let lane_ray = LaneRay::new(ray, &walk);
    let rate = lane_ray.rate.abs();
    let mut search = Search {
        ray,
        passed,
        rate,
        found: Found::NOTHING,
        pending: [const { MaybeUninit::uninit() }; MOST_PENDING],
        pending_count: 0,
        ends: lane_ray.ends(ray.interval.min, ray.interval.max),
    };
    // From lengths along the frame's z to those of the walk, rounded up.
    let walk_per_length = walk.per_t / rate * (1.0 + 4.0 * f32::EPSILON);
    let mut last = ray.interval.max * walk.per_t;
    let mut stack = Stack::new();
    let mut current = root;
    // SAFETY: the machine has the instructions, by the promise of whoever calls with these lanes; words of the tree name its nodes
    // and blocks; the stack is as high as the tree's depth allows, and read only where it was written.
    unsafe {
        let node_ray = NodeRay::<L>::new(&walk, ray.interval.min * walk.per_t);
        let mut last_lanes = L::splat(last);
        loop {
            if current.is_leaf() {
                counter.leaf();
                let block_ray = BlockRay::<L>::new(&lane_ray);
                let mut block = store.block(current);
                let mut full = current.full_blocks();
                let before = search.ends[1];
                loop {
                    let count = if full == 0 {
                        current.last_count()
                    } else {
                        WIDTH
                    };
                    counter.primitives(count);
                    let candidates = block_ray.test(block, count, search.ends);
                    if candidates.possible != 0 {
                        search.take(block, count, candidates);
                    }
                    if full == 0 {
                        break;
                    }
                    full -= 1;
                    block = block.add(FULL_BLOCK);
                }
                if search.ends[1] < before {
                    last = search.ends[1] * walk_per_length;
                    last_lanes = L::splat(last);
                }
            } else {
                counter.node();
                let node = &*store.node(current);
                let (hit, from) = node_ray.test(node, last_lanes);
                if hit != 0 {
                    current = stack.descend(node, hit, from);
                    continue;
                }
            }
            match stack.pop(last) {
                Some(next) => current = next,
                None => return search.finish(),
            }
        }
    }
}

/// Calls `visit` with the numbers in the leaves that the ray meets, within the limit of `t` that the last call returned. `false` if the ray is
/// not for the walk.
#[inline(always)]
pub(super) fn visit<L: Lanes, C: Counter>(
    tree: Tree<'_>,
    ray: &Ray,
    counter: &mut C,
    visit: &mut dyn FnMut(u32, &mut C) -> f32,
) -> bool {
    let Tree { store, root, reach } = tree;
    let Some(walk) = WalkRay::new(ray, reach) else {
        return false;
    };
    let mut stack = Stack::new();
    let mut current = root;
    let mut last = ray.interval.max * walk.per_t;
    // SAFETY: as in `closest`.
    unsafe {
        let node_ray = NodeRay::<L>::new(&walk, ray.interval.min * walk.per_t);
        loop {
            if current.is_leaf() {
                counter.leaf();
                for &number in store.numbers(current) {
                    let limit = visit(number, counter);
                    if limit < ray.interval.min {
                        return true;
                    }
                    last = limit * walk.per_t;
                }
            } else {
                counter.node();
                let node = &*store.node(current);
                let (hit, from) = node_ray.test(node, L::splat(last));
                if hit != 0 {
                    current = stack.descend(node, hit, from);
                    continue;
                }
            }
            match stack.pop(last) {
                Some(next) => current = next,
                None => return true,
            }
        }
    }
}

/// Whether the ray hits one of a block's triangles whose lanes are `candidates`, exactly.
///
/// # Safety
/// `block` begins a block of `count` triangles.
#[inline(never)]
unsafe fn meets_any(ray: &Ray, block: *const f32, count: usize, mut candidates: u32) -> bool {
    let frame = RayFrame::of_traceable(ray);
    while candidates != 0 {
        let lane = candidates.trailing_zeros() as usize;
        candidates &= candidates - 1;
        // SAFETY: the caller's promise.
        let (triangle, _) = unsafe { triangle(block, count, lane) };
        if frame.intersect(&triangle).is_some() {
            return true;
        }
    }
    false
}

/// Whether anything is hit.
#[inline(always)]
pub(super) fn any<L: Lanes, C: Counter>(tree: Tree<'_>, ray: &Ray, counter: &mut C) -> Occluded {
    let Tree { store, root, reach } = tree;
    let Some(walk) = WalkRay::new(ray, reach) else {
        return Occluded::Unusual;
    };
    let lane_ray = LaneRay::new(ray, &walk);
    let ends = lane_ray.ends(ray.interval.min, ray.interval.max);
    let mut stack = [const { MaybeUninit::<Word>::uninit() }; STACK];
    let mut height = 0_usize;
    let mut current = root;
    let interval = ray.interval;
    // SAFETY: as in `closest`.
    unsafe {
        let node_ray = NodeRay::<L>::new(&walk, interval.min * walk.per_t);
        let last = L::splat(interval.max * walk.per_t);
        loop {
            if current.is_leaf() {
                counter.leaf();
                let block_ray = BlockRay::<L>::new(&lane_ray);
                let mut block = store.block(current);
                let mut full = current.full_blocks();
                loop {
                    let count = if full == 0 {
                        current.last_count()
                    } else {
                        WIDTH
                    };
                    counter.primitives(count);
                    let candidates = block_ray.test(block, count, ends);
                    let hits = candidates.hit != 0
                        || (candidates.possible != 0
                            && meets_any(ray, block, count, candidates.possible));
                    if hits {
                        return Occluded::Yes;
                    }
                    if full == 0 {
                        break;
                    }
                    full -= 1;
                    block = block.add(FULL_BLOCK);
                }
            } else {
                counter.node();
                let node = &*store.node(current);
                let (mut hit, _) = node_ray.test(node, last);
                if hit != 0 {
                    let child = |lane: usize| *node.children.get_unchecked(lane);
                    let best = 31 - hit.leading_zeros();
                    hit &= !(1 << best);
                    current = child(best as usize);
                    while hit != 0 {
                        let next = child(hit.trailing_zeros() as usize);
                        hit &= hit - 1;
                        stack.get_unchecked_mut(height).write(next);
                        height += 1;
                    }
                    continue;
                }
            }
            if height == 0 {
                return Occluded::No;
            }
            height -= 1;
            current = stack.get_unchecked(height).assume_init();
        }
    }
}
