//! From the binary tree to nodes of eight children, by dynamic programming.
//!
//! After Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017: for each cell, the
//! least cost of having it as one root, as two, up to eight. One root is a leaf, if its triangles fill four blocks at most, or a node.

use super::build::{Cell, Content, Rest};
use super::fragment::Extent;
use super::members::Members;
use super::node::{Node, WIDTH, Word};
use super::plane::Costs;
use super::store::Draft;

/// What a wide node costs, in the unit of [`Costs`]: the test of its eight children, and finding the nearest of those that are met.
const NODE: f32 = 1.15;

/// The least cost of a cell as one to eight roots, weighted by the areas of extents.
#[derive(Clone, Copy)]
pub(super) struct Roots {
    cost: [f32; WIDTH],
    /// As one root, it is a leaf.
    is_leaf: bool,
}

impl Roots {
    fn leaf_cost(extent: &Extent, members: &Members, costs: &Costs) -> f32 {
        members.get().map_or(f32::INFINITY, |triangles| {
            extent.half_area() * costs.leaf(triangles.len())
        })
    }

    pub(super) fn of_leaf(extent: &Extent, members: &Members, costs: &Costs) -> Self {
        Self {
            cost: [Self::leaf_cost(extent, members, costs); WIDTH],
            is_leaf: true,
        }
    }

    /// Of a cell that is divided later, by what a ray in it costs.
    pub(super) fn undivided(extent: &Extent, cost: f32) -> Self {
        Self {
            cost: [extent.half_area() * cost; WIDTH],
            is_leaf: false,
        }
    }

    pub(super) fn of_halves(
        extent: &Extent,
        halves: &[Cell; 2],
        members: &Members,
        costs: &Costs,
    ) -> Self {
        let [a, b] = [&halves[0].roots, &halves[1].roots];
        let mut cost = [f32::INFINITY; WIDTH];
        for roots in 2..=WIDTH {
            cost[roots - 1] = (1..roots)
                .map(|k| a.cost[k - 1] + b.cost[roots - k - 1])
                .fold(f32::INFINITY, f32::min);
        }
        let node = cost[WIDTH - 1] + extent.half_area() * NODE;
        let leaf = Self::leaf_cost(extent, members, costs);
        let is_leaf = leaf <= node;
        cost[0] = leaf.min(node);
        for roots in 1..WIDTH {
            cost[roots] = cost[roots].min(cost[roots - 1]);
        }
        Self { cost, is_leaf }
    }
}

impl Cell {
    /// How much a search for any hit gains by looking here: the chance that a ray through the cell hits something, over what looking costs.
    ///
    /// The chance is that of surfaces strewn about: a ray through a convex body passes on average as many surfaces as
    /// they have area in units of half the body's own.
    fn promise(&self) -> f32 {
        let area = self.extent.half_area();
        (1.0 - libm::expf(-self.surface / area)) * area / self.roots.cost[0]
    }
}

/// The cells that become the roots of `cell`, at most `roots` many.
#[allow(
    clippy::float_cmp,
    reason = "the same sums, computed again, to find which one was the least"
)]
fn roots<'a>(cell: &'a Cell, roots_left: usize, is_top: bool, found: &mut Vec<&'a Cell>) {
    let Content::Inner(halves) = &cell.content else {
        found.push(cell);
        return;
    };
    let mut count = roots_left;
    if !is_top {
        while count > 1 && cell.roots.cost[count - 1] >= cell.roots.cost[count - 2] {
            count -= 1;
        }
        if count == 1 {
            found.push(cell);
            return;
        }
    }
    let [a, b] = [&halves[0].roots.cost, &halves[1].roots.cost];
    let sum = |k: usize| a[k - 1] + b[count - k - 1];
    let mut best = 1;
    for k in 2..count {
        if sum(k) < sum(best) {
            best = k;
        }
    }
    roots(&halves[0], best, false, found);
    roots(&halves[1], count - best, false, found);
}

/// What becomes of the ends of the binary tree.
pub(super) trait Ends {
    /// Writes a leaf of these triangles.
    fn leaf(&self, members: &[u32], draft: &mut Draft) -> Word;
    /// Writes a cell that is not divided yet, `above` levels below the root.
    fn later(&self, rest: Rest, above: u32, draft: &mut Draft) -> Word;
}

/// Writes the tree, `above` levels below the root; the word for it, and its own levels, without those that are built later.
pub(super) fn write(cell: &Cell, above: u32, ends: &impl Ends, draft: &mut Draft) -> (Word, u32) {
    if let Content::Later(rest) = &cell.content {
        return (ends.later(rest.take(), above, draft), 0);
    }
    if cell.roots.is_leaf
        && let Some(members) = cell.members.get()
    {
        return (ends.leaf(members, draft), 1);
    }
    let mut children = Vec::with_capacity(WIDTH);
    roots(cell, WIDTH, true, &mut children);
    children.sort_by(|a, b| a.promise().total_cmp(&b.promise()));
    let index = draft.reserve_node();
    let mut node = Node::EMPTY;
    let mut levels = 0;
    for (lane, child) in children.into_iter().enumerate() {
        let (word, below) = write(child, above + 1, ends, draft);
        node.set(lane, &child.extent, word);
        levels = levels.max(below);
    }
    draft.set_node(index, node);
    (Word::node(index), levels + 1)
}
