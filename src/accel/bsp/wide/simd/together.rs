//! The walk of a group of rays: one test of a node for all, one test of a box for each vector of rays.
//!
//! A child that the group's shaft meets waits with the rays that entered its parent. When its turn comes, the rays that meet its own box
//! go on; where they are few, each finishes the child alone.

use std::mem::MaybeUninit;

use super::super::node::{Node, WIDTH, Word};
use super::super::store::FULL_BLOCK;
use super::bundle::Faces;
use super::group::{GROUP, Group, Table, Visit, visit_groups};
use super::kernel::Lanes;
use super::searches::Searches;
use super::single::{STACK, Stack, meets_any};
use super::{Found, Tree};
use crate::geometry::Ray;

/// Up to so many rays walk a child each alone.
const FEW: u32 = 2;

/// A child of a node that waits, and the rays that entered the node.
#[derive(Clone, Copy)]
struct Waiting {
    node: *const Node,
    lane: u32,
    /// About where rays enter it.
    from: f32,
    active: u64,
}

/// The children that wait, the next one last.
struct Children {
    waiting: [MaybeUninit<Waiting>; STACK],
    height: usize,
}

impl Children {
    #[inline(always)]
    fn new() -> Self {
        Self {
            waiting: [const { MaybeUninit::uninit() }; STACK],
            height: 0,
        }
    }

    /// The children in `hit` wait, the nearest last.
    ///
    /// # Safety
    /// As for [`Lanes`]; the stack is as high as the tree's depth allows.
    #[inline(always)]
    unsafe fn push<L: Lanes>(&mut self, node: *const Node, mut hit: u32, from: &L, active: u64) {
        let base = self.height;
        while hit != 0 {
            let lane = hit.trailing_zeros();
            hit &= hit - 1;
            // SAFETY: lanes are below 8; the caller's promise; only what was written is read.
            unsafe {
                let next = Waiting {
                    node,
                    lane,
                    from: from.lane(lane as usize),
                    active,
                };
                let mut place = self.height;
                while place > base
                    && self.waiting.get_unchecked(place - 1).assume_init_ref().from < next.from
                {
                    *self.waiting.get_unchecked_mut(place) = *self.waiting.get_unchecked(place - 1);
                    place -= 1;
                }
                self.waiting.get_unchecked_mut(place).write(next);
            }
            self.height += 1;
        }
    }

    /// # Safety
    /// What is below the height was written.
    #[inline(always)]
    unsafe fn pop(&mut self) -> Option<Waiting> {
        self.height = self.height.checked_sub(1)?;
        // SAFETY: the caller's promise.
        Some(unsafe { self.waiting.get_unchecked(self.height).assume_init() })
    }
}

impl<L: Lanes> Group<'_, L> {
    /// Of the active rays, those that meet a child of a node.
    ///
    /// # Safety
    /// As for [`Lanes`]; `lane` is below 8.
    #[inline(always)]
    unsafe fn entering(&self, node: &Node, lane: usize, active: u64) -> u64 {
        let [near, far] = self.frame.rows();
        let mut entering = 0;
        // SAFETY: the caller's promise.
        unsafe {
            let sign = self.frame.sign();
            let faces = Faces {
                near: [
                    L::splat(bound(node, near[0], lane)),
                    L::splat(bound(node, near[1], lane)),
                    L::splat(bound(node, near[2], lane) * sign),
                ],
                far: [
                    L::splat(bound(node, far[0], lane)),
                    L::splat(bound(node, far[1], lane)),
                    L::splat(bound(node, far[2], lane) * sign),
                ],
            };
            let mut vectors = vectors(active);
            while vectors != 0 {
                let place = vectors.trailing_zeros() as usize;
                vectors &= vectors - 1;
                let bundle = self.bundles.get_unchecked(place / WIDTH);
                entering |= u64::from(bundle.meet(&faces)) << place;
            }
        }
        entering & active
    }
}

/// One of a node's bounds.
///
/// # Safety
/// `row` is the offset of a row, `lane` below 8.
#[inline(always)]
unsafe fn bound(node: &Node, row: usize, lane: usize) -> f32 {
    // SAFETY: the caller's promise.
    unsafe { *node.bounds.as_ptr().byte_add(row).cast::<f32>().add(lane) }
}

/// Whether triangles are tested one by one against vectors of rays, rather than rays one by one against the block.
#[inline(always)]
pub(super) fn is_by_triangle(rays: u32, triangles: u32, vectors: u32) -> bool {
    2 * triangles * vectors <= 3 * rays
}

/// The nearest hits of rays: for groups of them, the others are left.
struct Closest<'a> {
    tree: Tree<'a>,
    rays: &'a [Ray],
    found: &'a mut [Found],
}

impl<L: Lanes> Visit<L> for Closest<'_> {
    #[inline(always)]
    unsafe fn visit(&mut self, group: Group<'_, L>, table: &Table) {
        // SAFETY: the caller's promise.
        unsafe { closest_of_group(self.tree, group, table, self.rays, self.found) }
    }
}

/// The nearest hits of up to [`GROUP`] rays, one at least. A bit for each ray that has no answer and must walk alone.
#[inline(always)]
pub(super) fn closest_together<L: Lanes>(tree: Tree<'_>, rays: &[Ray], found: &mut [Found]) -> u64 {
    let mut closest = Closest { tree, rays, found };
    // SAFETY: the machine has the instructions, by the promise of whoever calls with these lanes.
    unsafe { visit_groups::<L>(rays, tree.reach.largest, &mut closest) }
}

/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn closest_of_group<L: Lanes>(
    tree: Tree<'_>,
    group: Group<'_, L>,
    table: &Table,
    rays: &[Ray],
    found: &mut [Found],
) {
    let store = tree.store;
    let mut searches = Searches::new(group, table, rays);
    let mut children = Children::new();
    let (mut current, mut active) = (tree.root, table.places());
    // SAFETY: the caller's promise; words of the tree name its nodes and blocks; the stack is as high as the tree's depth allows, and read
    // only where it was written.
    unsafe {
        loop {
            if active.count_ones() <= FEW {
                while active != 0 {
                    let place = active.trailing_zeros() as usize;
                    active &= active - 1;
                    closest_alone(tree, current, place, &mut searches);
                }
            } else if current.is_leaf() {
                let mut block = store.block(current);
                let mut full = current.full_blocks();
                loop {
                    let count = if full == 0 {
                        current.last_count()
                    } else {
                        WIDTH
                    };
                    searches.test_block(block, count, active);
                    if full == 0 {
                        break;
                    }
                    full -= 1;
                    block = block.add(FULL_BLOCK);
                }
            } else {
                let node = store.node(current);
                let (hit, from) = searches.group.shaft.test(&*node);
                children.push(node, hit, &from, active);
            }
            loop {
                let Some(next) = children.pop() else {
                    searches.finish(found);
                    return;
                };
                let (node, lane) = (&*next.node, next.lane as usize);
                active = searches.group.entering(node, lane, next.active);
                if active != 0 {
                    current = *node.children.get_unchecked(lane);
                    break;
                }
            }
        }
    }
}

/// One ray of a group alone, below this word.
///
/// # Safety
/// As for [`Lanes`]; `place` has a ray.
#[inline(always)]
unsafe fn closest_alone<L: Lanes>(
    tree: Tree<'_>,
    word: Word,
    place: usize,
    searches: &mut Searches<'_, L>,
) {
    let (index, lane) = (place / WIDTH, place % WIDTH);
    let mut stack = Stack::new();
    let mut current = word;
    // SAFETY: as in `closest_of_group`.
    unsafe {
        let node_ray = searches.group.bundles[index].node_ray(lane, &searches.group.frame);
        loop {
            let last = searches.group.bundles[index].last.lane(lane);
            if current.is_leaf() {
                let block_ray =
                    searches.group.bundles[index].block_ray(lane, &searches.group.frame);
                let mut block = tree.store.block(current);
                let mut full = current.full_blocks();
                loop {
                    let count = if full == 0 {
                        current.last_count()
                    } else {
                        WIDTH
                    };
                    let ends = searches.group.bundles[index].ends(lane);
                    let candidates = block_ray.test(block, count, ends);
                    if candidates.possible != 0 {
                        searches.take_of_block(place, block, count, candidates);
                    }
                    if full == 0 {
                        break;
                    }
                    full -= 1;
                    block = block.add(FULL_BLOCK);
                }
            } else {
                let node = &*tree.store.node(current);
                let (hit, from) = node_ray.test(node, L::splat(last));
                if hit != 0 {
                    current = stack.descend(node, hit, from);
                    continue;
                }
            }
            match stack.pop(searches.group.bundles[index].last.lane(lane)) {
                Some(next) => current = next,
                None => return,
            }
        }
    }
}

/// Whether rays hit anything: for groups of them, the others are left.
struct Any<'a> {
    tree: Tree<'a>,
    rays: &'a [Ray],
    hits: &'a mut [bool],
}

impl<L: Lanes> Visit<L> for Any<'_> {
    #[inline(always)]
    unsafe fn visit(&mut self, group: Group<'_, L>, table: &Table) {
        // SAFETY: the caller's promise.
        let occluded = unsafe { any_of_group(self.tree, group, table, self.rays) };
        for (place, &ray) in table.rays.iter().enumerate().take(table.count) {
            self.hits[usize::from(ray)] = occluded >> place & 1 != 0;
        }
    }
}

/// Whether anything is hit, for up to [`GROUP`] rays, one at least. A bit for each ray that has no answer and must walk alone.
#[inline(always)]
pub(super) fn any_together<L: Lanes>(tree: Tree<'_>, rays: &[Ray], hits: &mut [bool]) -> u64 {
    let mut any = Any { tree, rays, hits };
    // SAFETY: the machine has the instructions, by the promise of whoever calls with these lanes.
    unsafe { visit_groups::<L>(rays, tree.reach.largest, &mut any) }
}

/// The places of rays that hit something.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn any_of_group<L: Lanes>(
    tree: Tree<'_>,
    group: Group<'_, L>,
    table: &Table,
    rays: &[Ray],
) -> u64 {
    let store = tree.store;
    let all = table.places();
    let mut children = Children::new();
    let (mut current, mut active) = (tree.root, all);
    let mut occluded = 0;
    // SAFETY: as in `closest_of_group`.
    unsafe {
        loop {
            if current.is_leaf() {
                let mut block = store.block(current);
                let mut full = current.full_blocks();
                loop {
                    let count = if full == 0 {
                        current.last_count()
                    } else {
                        WIDTH
                    };
                    let hits = any_in_block(&group, table, rays, block, count, active);
                    occluded |= hits;
                    active &= !hits;
                    if full == 0 || active == 0 {
                        break;
                    }
                    full -= 1;
                    block = block.add(FULL_BLOCK);
                }
                if occluded == all {
                    return occluded;
                }
            } else {
                let node = store.node(current);
                let (hit, from) = group.shaft.test(&*node);
                children.push(node, hit, &from, active);
            }
            loop {
                let Some(next) = children.pop() else {
                    return occluded;
                };
                let (node, lane) = (&*next.node, next.lane as usize);
                active = group.entering(node, lane, next.active & !occluded);
                if active != 0 {
                    current = *node.children.get_unchecked(lane);
                    break;
                }
            }
        }
    }
}

/// Of the active rays, those that hit a triangle of a block.
///
/// # Safety
/// As for [`Lanes`]; `block` begins a block of `count` triangles.
#[inline(always)]
unsafe fn any_in_block<L: Lanes>(
    group: &Group<'_, L>,
    table: &Table,
    rays: &[Ray],
    block: *const f32,
    count: usize,
    active: u64,
) -> u64 {
    let mut occluded = 0;
    // SAFETY: the caller's promise.
    unsafe {
        let possible = group.shaft.test_block(block, count);
        if possible == 0 {
            return 0;
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
                let bundle = group.bundles.get_unchecked(first / WIDTH);
                let mut part = (active >> first) as u32 & 0xff;
                let error = bundle.edge_error(*block);
                let mut triangles = possible;
                while triangles != 0 && part != 0 {
                    let triangle = triangles.trailing_zeros() as usize;
                    triangles &= triangles - 1;
                    let candidates = bundle.test(block, count, triangle, &group.frame, error, part);
                    let mut hits = candidates.hit;
                    let mut doubtful = candidates.possible & !hits;
                    while doubtful != 0 {
                        let lane = doubtful.trailing_zeros();
                        doubtful &= doubtful - 1;
                        let place = first + lane as usize;
                        let ray = &rays[usize::from(table.rays[place % GROUP])];
                        hits |= u32::from(meets_any(ray, block, count, 1 << triangle)) << lane;
                    }
                    part &= !hits;
                    occluded |= u64::from(hits) << first;
                }
            }
        } else {
            let mut left = active;
            while left != 0 {
                let place = left.trailing_zeros() as usize;
                left &= left - 1;
                let bundle = group.bundles.get_unchecked(place / WIDTH);
                let lane = place % WIDTH;
                let block_ray = bundle.block_ray(lane, &group.frame);
                let candidates = block_ray.test(block, count, bundle.ends(lane));
                let hits = candidates.hit != 0
                    || (candidates.possible != 0 && {
                        let ray = &rays[usize::from(table.rays[place % GROUP])];
                        meets_any(ray, block, count, candidates.possible)
                    });
                occluded |= u64::from(hits) << place;
            }
        }
    }
    occluded
}

/// The vectors that have active rays: the first bit of each.
#[inline(always)]
pub(super) fn vectors(active: u64) -> u64 {
    let pairs = active | active >> 1;
    let fours = pairs | pairs >> 2;
    (fours | fours >> 4) & 0x0101_0101_0101_0101
}
