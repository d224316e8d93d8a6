//! The nearest hits of groups of rays: the nearest child first, as a ray in the middle meets them.

use super::super::node::{WIDTH, Word};
use super::group::{Group, Visit, visit_groups};
use super::kernel::Lanes;
use super::nested::Outside;
use super::searches::Searches;
use super::stack::Stack;
use super::table::Table;
use super::together::{Children, FEW};
use super::{Found, Tree};
use crate::geometry::Ray;

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

/// The nearest hits of up to [`GROUP`](super::table::GROUP) rays, one at least. A bit for each ray that has no answer and must walk alone.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn closest_together<L: Lanes>(
    tree: Tree<'_>,
    rays: &[Ray],
    found: &mut [Found],
) -> u64 {
    let mut closest = Closest { tree, rays, found };
    // SAFETY: the caller's promise.
    unsafe { visit_groups::<L>(rays, tree.reach.largest, &mut closest) }
}

/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn closest_of_group<L: Lanes>(
    mut tree: Tree<'_>,
    group: Group<'_, L>,
    table: &Table,
    rays: &[Ray],
    found: &mut [Found],
) {
    let mut searches = Searches::new(group, table, rays);
    let mut children = Children::new();
    let mut outside = Outside::new();
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
            } else if current.is_leaf() && current.leads_elsewhere() {
                if outside.go(&mut tree, current) {
                    children.wait_outside();
                    current = tree.root;
                    continue;
                }
            } else if current.is_leaf() {
                let mut blocks = tree.blocks(current);
                loop {
                    let (block, count) = blocks.current();
                    searches.test_block(block, count, active);
                    if !blocks.advance() {
                        break;
                    }
                }
            } else {
                let node = tree.node(current);
                let (hit, from) = searches.group.shaft.test(&*node);
                children.push(node, hit, &from, active);
            }
            loop {
                let Some(next) = children.pop() else {
                    searches.finish(found);
                    return;
                };
                if next.leads_out() {
                    outside.go(&mut tree, Word::OUT);
                    continue;
                }
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
    mut tree: Tree<'_>,
    word: Word,
    place: usize,
    searches: &mut Searches<'_, L>,
) {
    let (index, lane) = (place / WIDTH, place % WIDTH);
    let mut stack = Stack::new();
    let mut outside = Outside::new();
    let mut current = word;
    // SAFETY: as in `closest_of_group`.
    unsafe {
        let node_ray = searches.group.bundles[index].node_ray(lane, &searches.group.frame);
        loop {
            let last = searches.group.bundles[index].last.lane(lane);
            if current.is_leaf() && current.leads_elsewhere() {
                if outside.go(&mut tree, current) {
                    stack.wait_outside();
                    current = tree.root;
                    continue;
                }
            } else if current.is_leaf() {
                let block_ray =
                    searches.group.bundles[index].block_ray(lane, &searches.group.frame);
                let mut blocks = tree.blocks(current);
                loop {
                    let (block, count) = blocks.current();
                    let ends = searches.group.bundles[index].ends(lane);
                    let candidates = block_ray.test(block, count, ends);
                    if candidates.possible != 0 {
                        searches.take_of_block(place, block, count, candidates);
                    }
                    if !blocks.advance() {
                        break;
                    }
                }
            } else {
                let node = &*tree.node(current);
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
