//! Whether rays of groups hit anything: those that do leave the walk.

use super::super::node::{WIDTH, Word};
use super::Tree;
use super::group::{Group, Visit, visit_groups};
use super::kernel::Lanes;
use super::nested::Outside;
use super::single::meets_any;
use super::stack::Promising;
use super::table::{GROUP, Table};
use super::together::{Children, FEW, is_by_triangle, vectors};
use crate::geometry::Ray;

/// The children's order: the last comes first, as for a single ray.
const LAST_FIRST: [f32; WIDTH] = [7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0];

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
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn any_together<L: Lanes>(
    tree: Tree<'_>,
    rays: &[Ray],
    hits: &mut [bool],
) -> u64 {
    let mut any = Any { tree, rays, hits };
    // SAFETY: the caller's promise.
    unsafe { visit_groups::<L>(rays, tree.reach.largest, &mut any) }
}

/// The places of rays that hit something.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn any_of_group<L: Lanes>(
    mut tree: Tree<'_>,
    group: Group<'_, L>,
    table: &Table,
    rays: &[Ray],
) -> u64 {
    let all = table.places();
    let mut children = Children::new();
    let mut outside = Outside::new();
    // SAFETY: the caller's promise.
    let order = unsafe { L::load(LAST_FIRST.as_ptr()) };
    let (mut current, mut active) = (tree.root, all);
    let mut occluded = 0;
    // SAFETY: as in `closest_of_group`.
    unsafe {
        loop {
            if active.count_ones() <= FEW {
                while active != 0 {
                    let place = active.trailing_zeros() as usize;
                    active &= active - 1;
                    let hits = any_alone(tree, current, place, &group, table, rays);
                    occluded |= u64::from(hits) << place;
                }
                if occluded == all {
                    return occluded;
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
                    let hits = any_in_block(&group, table, rays, block, count, active);
                    occluded |= hits;
                    active &= !hits;
                    if active == 0 || !blocks.advance() {
                        break;
                    }
                }
                if occluded == all {
                    return occluded;
                }
            } else {
                let node = tree.node(current);
                let (hit, _) = group.shaft.test(&*node);
                children.push(node, hit, &order, active);
            }
            loop {
                let Some(next) = children.pop() else {
                    return occluded;
                };
                if next.leads_out() {
                    outside.go(&mut tree, Word::OUT);
                    continue;
                }
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

/// Whether one ray of a group hits anything below this word.
///
/// # Safety
/// As for [`Lanes`]; `place` has a ray.
#[inline(always)]
unsafe fn any_alone<L: Lanes>(
    mut tree: Tree<'_>,
    word: Word,
    place: usize,
    group: &Group<'_, L>,
    table: &Table,
    rays: &[Ray],
) -> bool {
    let mut stack = Promising::new();
    let mut outside = Outside::new();
    let mut current = word;
    // SAFETY: as in `closest_of_group`.
    unsafe {
        let bundle = group.bundles.get_unchecked(place / WIDTH);
        let lane = place % WIDTH;
        let node_ray = bundle.node_ray(lane, &group.frame);
        let ends = bundle.ends(lane);
        let last = L::splat(ends[1]);
        loop {
            if current.is_leaf() && current.leads_elsewhere() {
                if outside.go(&mut tree, current) {
                    stack.wait_outside();
                    current = tree.root;
                    continue;
                }
            } else if current.is_leaf() {
                let block_ray = bundle.block_ray(lane, &group.frame);
                let mut blocks = tree.blocks(current);
                loop {
                    let (block, count) = blocks.current();
                    let candidates = block_ray.test(block, count, ends);
                    let hits = candidates.hit != 0
                        || (candidates.possible != 0 && {
                            let ray = &rays[usize::from(table.rays[place % GROUP])];
                            meets_any(ray, block, count, candidates.possible)
                        });
                    if hits {
                        return true;
                    }
                    if !blocks.advance() {
                        break;
                    }
                }
            } else {
                let node = &*tree.node(current);
                let (hit, _) = node_ray.test(node, last);
                if hit != 0 {
                    current = stack.descend(node, hit);
                    continue;
                }
            }
            match stack.pop() {
                Some(next) => current = next,
                None => return false,
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
