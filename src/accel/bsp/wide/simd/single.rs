//! The walk of one ray: nearest child first, for the nearest hit; the most promising first, for any.

use std::marker::PhantomData;

use super::super::node::Word;
use super::super::walk::{LaneRay, WalkRay};
use super::kernel::{BlockRay, Lanes, NodeRay};
use super::nested::Outside;
use super::search::{Search, triangle};
use super::stack::{Promising, Stack};
use super::{Found, Occluded, Passed, Tree};
use crate::accel::counters::Counter;
use crate::geometry::{Interval, Ray, RayFrame, is_beside};

/// What a walk to the nearest hit does in leaves.
pub(super) trait NearestLeaf<C: Counter> {
    /// Looks at a leaf: where the walk now ends, if that is nearer than before.
    ///
    /// # Safety
    /// As for [`Lanes`]; the word names a leaf of the tree.
    unsafe fn nearest(&mut self, tree: &Tree<'_>, leaf: Word, counter: &mut C) -> Option<f32>;
}

/// What a walk to any hit does in leaves.
pub(super) trait AnyLeaf<C: Counter> {
    /// Whether anything in a leaf is hit.
    ///
    /// # Safety
    /// As for [`Lanes`]; the word names a leaf of the tree.
    unsafe fn any(&self, tree: &Tree<'_>, leaf: Word, counter: &mut C) -> bool;
}

/// Walks to the nearest: the nearest child first, and none that begins behind the walk's end.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn nearest_first<L: Lanes, C: Counter>(
    tree: Tree<'_>,
    walk: &WalkRay,
    interval: Interval,
    counter: &mut C,
    leaves: &mut impl NearestLeaf<C>,
) {
    // SAFETY: the caller's promise.
    unsafe {
        if tree.has_treelets() {
            nearest_first_in::<L, C, true>(tree, walk, interval, counter, leaves);
        } else {
            nearest_first_in::<L, C, false>(tree, walk, interval, counter, leaves);
        }
    }
}

/// As [`nearest_first`], compiled for trees with treelets and for those without, whose leaves need not be asked where they lead: 4 % of the instructions.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn nearest_first_in<L: Lanes, C: Counter, const HAS_TREELETS: bool>(
    mut tree: Tree<'_>,
    walk: &WalkRay,
    interval: Interval,
    counter: &mut C,
    leaves: &mut impl NearestLeaf<C>,
) {
    let mut last = interval.max * walk.per_t;
    let mut stack = Stack::new();
    let mut outside = Outside::new();
    let mut current = tree.root;
    // SAFETY: the caller's promise; words of the tree name its nodes
    // and blocks; the stack is as high as the tree's depth allows, and read only where it was written.
    unsafe {
        let node_ray = NodeRay::<L>::new(walk, interval.min * walk.per_t);
        let mut last_lanes = L::splat(last);
        loop {
            if HAS_TREELETS && current.is_leaf() && current.leads_elsewhere() {
                if outside.go(&mut tree, current) {
                    stack.wait_outside();
                    current = tree.root;
                    continue;
                }
            } else if current.is_leaf() {
                counter.leaf();
                if let Some(nearer) = leaves.nearest(&tree, current, counter) {
                    last = nearer;
                    last_lanes = L::splat(last);
                }
            } else {
                counter.node();
                let node = &*tree.node(current);
                let (hit, from) = node_ray.test(node, last_lanes);
                if hit != 0 {
                    current = stack.descend(node, hit, from);
                    continue;
                }
            }
            match stack.pop(last) {
                Some(next) => current = next,
                None => return,
            }
        }
    }
}

/// Walks until something is hit: the most promising child first.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn promising_first<L: Lanes, C: Counter>(
    tree: Tree<'_>,
    walk: &WalkRay,
    interval: Interval,
    counter: &mut C,
    leaves: &impl AnyLeaf<C>,
) -> Occluded {
    // SAFETY: the caller's promise.
    unsafe {
        if tree.has_treelets() {
            promising_first_in::<L, C, true>(tree, walk, interval, counter, leaves)
        } else {
            promising_first_in::<L, C, false>(tree, walk, interval, counter, leaves)
        }
    }
}

/// As [`nearest_first_in`], for [`promising_first`].
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn promising_first_in<L: Lanes, C: Counter, const HAS_TREELETS: bool>(
    mut tree: Tree<'_>,
    walk: &WalkRay,
    interval: Interval,
    counter: &mut C,
    leaves: &impl AnyLeaf<C>,
) -> Occluded {
    let mut stack = Promising::new();
    let mut outside = Outside::new();
    let mut current = tree.root;
    // SAFETY: as in `nearest_first`.
    unsafe {
        let node_ray = NodeRay::<L>::new(walk, interval.min * walk.per_t);
        let last = L::splat(interval.max * walk.per_t);
        loop {
            if HAS_TREELETS && current.is_leaf() && current.leads_elsewhere() {
                if outside.go(&mut tree, current) {
                    stack.wait_outside();
                    current = tree.root;
                    continue;
                }
            } else if current.is_leaf() {
                counter.leaf();
                if leaves.any(&tree, current, counter) {
                    return Occluded::Yes;
                }
            } else {
                counter.node();
                let node = &*tree.node(current);
                let (hit, _) = node_ray.test(node, last);
                if hit != 0 {
                    current = stack.descend(node, hit);
                    continue;
                }
            }
            match stack.pop() {
                Some(next) => current = next,
                None => return Occluded::No,
            }
        }
    }
}

/// The exact test, for the nearest hit.
struct Exact<'a, 'b, L> {
    lane_ray: &'b LaneRay,
    search: &'b mut Search<'a>,
    lanes: PhantomData<L>,
}

impl<L: Lanes, C: Counter> NearestLeaf<C> for Exact<'_, '_, L> {
    #[inline(always)]
    unsafe fn nearest(&mut self, tree: &Tree<'_>, leaf: Word, counter: &mut C) -> Option<f32> {
        // SAFETY: the caller's promise.
        unsafe {
            let block_ray = BlockRay::<L>::new(self.lane_ray);
            let mut blocks = tree.blocks(leaf);
            let before = self.search.ends[1];
            loop {
                let (block, count) = blocks.current();
                counter.primitives(count);
                let candidates = block_ray.test(block, count, self.search.ends);
                if candidates.possible != 0 {
                    self.search.take(block, count, candidates);
                }
                if !blocks.advance() {
                    break;
                }
            }
            let end = self.search.ends[1];
            (end < before).then(|| self.lane_ray.walked(end))
        }
    }
}

/// The exact test, for any hit.
struct ExactAny<'a, L> {
    lane_ray: LaneRay,
    ray: &'a Ray,
    /// Lengths along the frame's z between which a hit matters.
    ends: [f32; 2],
    lanes: PhantomData<L>,
}

impl<L: Lanes, C: Counter> AnyLeaf<C> for ExactAny<'_, L> {
    #[inline(always)]
    unsafe fn any(&self, tree: &Tree<'_>, leaf: Word, counter: &mut C) -> bool {
        // SAFETY: the caller's promise.
        unsafe {
            let block_ray = BlockRay::<L>::new(&self.lane_ray);
            let mut blocks = tree.blocks(leaf);
            loop {
                let (block, count) = blocks.current();
                counter.primitives(count);
                let candidates = block_ray.test(block, count, self.ends);
                let is_hit = candidates.hit != 0
                    || (candidates.possible != 0
                        && meets_any(self.ray, block, count, candidates.possible));
                if is_hit {
                    return true;
                }
                if !blocks.advance() {
                    return false;
                }
            }
        }
    }
}

/// The nearest hit, the least number first among equals.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn closest<L: Lanes, C: Counter>(
    tree: Tree<'_>,
    ray: &Ray,
    passed: Passed,
    counter: &mut C,
) -> Found {
    let Some(walk) = WalkRay::new(ray, tree.reach) else {
        return Found::UNUSUAL;
    };
    let lane_ray = LaneRay::new(ray, &walk);
    let mut search = Search::new(ray, &lane_ray, passed);
    let mut leaves = Exact::<L> {
        lane_ray: &lane_ray,
        search: &mut search,
        lanes: PhantomData,
    };
    // SAFETY: the caller's promise.
    unsafe {
        nearest_first::<L, C>(tree, &walk, ray.interval, counter, &mut leaves);
        search.finish::<L>()
    }
}

/// Whether anything is hit.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn any<L: Lanes, C: Counter>(
    tree: Tree<'_>,
    ray: &Ray,
    counter: &mut C,
) -> Occluded {
    let Some(walk) = WalkRay::new(ray, tree.reach) else {
        return Occluded::Unusual;
    };
    let lane_ray = LaneRay::new(ray, &walk);
    let leaves = ExactAny::<L> {
        ends: lane_ray.ends(ray.interval.min, ray.interval.max),
        lane_ray,
        ray,
        lanes: PhantomData,
    };
    // SAFETY: the caller's promise.
    unsafe { promising_first::<L, C>(tree, &walk, ray.interval, counter, &leaves) }
}

/// Calls `visit` with the numbers in the leaves that the ray meets, within the limit of `t` that the last call returned. `false` if the ray is
/// not for the walk.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn visit<L: Lanes, C: Counter>(
    tree: Tree<'_>,
    ray: &Ray,
    counter: &mut C,
    visit: &mut dyn FnMut(u32, &mut C) -> f32,
) -> bool {
    let Some(walk) = WalkRay::new(ray, tree.reach) else {
        return false;
    };
    let mut stack = Stack::new();
    let mut current = tree.root;
    let mut last = ray.interval.max * walk.per_t;
    // SAFETY: as in `nearest_first`, which does not end within a leaf.
    unsafe {
        let node_ray = NodeRay::<L>::new(&walk, ray.interval.min * walk.per_t);
        loop {
            if current.is_leaf() {
                counter.leaf();
                for &number in tree.store.numbers(current) {
                    let limit = visit(number, counter);
                    if limit < ray.interval.min {
                        return true;
                    }
                    last = limit * walk.per_t;
                }
            } else {
                counter.node();
                let node = &*tree.node(current);
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
pub(super) unsafe fn meets_any(
    ray: &Ray,
    block: *const f32,
    count: usize,
    mut candidates: u32,
) -> bool {
    while candidates != 0 {
        let lane = candidates.trailing_zeros() as usize;
        candidates &= candidates - 1;
        // SAFETY: the caller's promise.
        let (triangle, _) = unsafe { triangle(block, count, lane) };
        // Mostly the triangle that the ray leaves.
        if is_beside(ray, &triangle) {
            continue;
        }
        if RayFrame::of_traceable(ray).intersect(&triangle).is_some() {
            return true;
        }
    }
    false
}
