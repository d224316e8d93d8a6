//! The tree itself: nodes in one vector, so that the deepest chain is dropped, walked and printed without recursion.

use super::fragment::{Fragment, Polygon};
use crate::geometry::Triangle;
use crate::geometry::exact::ExactPlane;

/// No child there.
pub(super) const NONE: u32 = u32::MAX;

/// A node: the polygons that lie in a plane, and what is in front of it and behind. Or a cell that the build's limits left undivided.
#[derive(Clone, Debug)]
pub struct Node {
    plane: u32,
    first_fragment: u32,
    fragment_count: u32,
    front: u32,
    back: u32,
    depth: u32,
}

fn child(number: u32) -> Option<u32> {
    (number != NONE).then_some(number)
}

impl Node {
    /// Number of its plane; `None` for an undivided cell, whose fragments lie anyhow.
    pub fn plane(&self) -> Option<u32> {
        child(self.plane)
    }

    /// Numbers of the fragments that lie in its plane.
    pub fn fragments(&self) -> std::ops::Range<u32> {
        self.first_fragment..self.first_fragment + self.fragment_count
    }

    /// The node in front of the plane: the side to which its normal points, the lecture's `outsideOnes`.
    pub fn front(&self) -> Option<u32> {
        child(self.front)
    }

    /// The node behind the plane, the lecture's `insideOnes`.
    pub fn back(&self) -> Option<u32> {
        child(self.back)
    }

    /// Nodes above it: 0 for the root.
    pub fn depth(&self) -> u32 {
        self.depth
    }
}

/// a to z, then aa to zz, from `first` instead of a: numbers without a zero.
pub(super) fn letters(number: u32, first: u8) -> String {
    let mut letters = Vec::new();
    let mut rest = u64::from(number) + 1;
    while rest > 0 {
        rest -= 1;
        letters.push(char::from(first + (rest % 26) as u8));
        rest /= 26;
    }
    letters.iter().rev().collect()
}

/// The shape of a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeStats {
    /// Polygons that entered.
    pub polygons: u64,
    /// Triangles of these.
    pub triangles: u64,
    /// Triangles without area, which were left out.
    pub left_out: u64,
    /// Nodes, undivided cells included.
    pub nodes: u64,
    /// Nodes on the longest way from the root, both ends included.
    pub depth: u32,
    /// Mean of that over the nodes without children.
    pub mean_leaf_depth: f64,
    /// Fragments cut in two.
    pub splits: u64,
    /// Fragments in the nodes.
    pub fragments: u64,
    /// Fragments in cells that the build's limits left undivided.
    pub unsplit: u64,
}

impl TreeStats {
    /// Fragments for each polygon: 1 if nothing was split.
    pub fn fragments_per_polygon(&self) -> f64 {
        self.fragments as f64 / self.polygons.max(1) as f64
    }
}

/// A BSP tree of polygons: the lecture's.
///
/// Fragments of a plane in front of it are in one subtree, those behind in the other, those that straddle it in both, split; the polygons in it
/// are in the node. It is built once for a set of polygons, whatever rays come.
#[derive(Clone, Debug, Default)]
pub struct PolygonBsp {
    pub(super) planes: Vec<ExactPlane>,
    pub(super) polygons: Vec<Polygon>,
    pub(super) triangles: Vec<Triangle>,
    pub(super) fragments: Vec<Fragment>,
    pub(super) nodes: Vec<Node>,
    pub(super) left_out: Vec<u32>,
    pub(super) splits: u64,
}

impl PolygonBsp {
    /// The nodes; the root is the first, and parents come before their children.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// A plane by its number.
    pub fn plane(&self, number: u32) -> &ExactPlane {
        &self.planes[number as usize]
    }

    /// All fragments; those of a node stand together.
    pub fn fragments(&self) -> &[Fragment] {
        &self.fragments
    }

    /// The polygons that entered, in the order of their first triangles.
    pub fn polygons(&self) -> &[Polygon] {
        &self.polygons
    }

    /// The triangles from which the tree was built, those left out included.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// Numbers of the triangles that have no area, and so no plane: they are in no node.
    pub fn left_out(&self) -> &[u32] {
        &self.left_out
    }

    /// The lecture's name of a fragment: its polygon counted from 1, and a letter for each piece, `a` for what is most behind.
    pub fn name(&self, fragment: u32) -> String {
        let fragment = &self.fragments[fragment as usize];
        let mut name = (u64::from(fragment.polygon) + 1).to_string();
        if let Some(piece) = fragment.piece {
            name += &letters(piece, b'a');
        }
        name
    }

    /// The tree's shape.
    pub fn stats(&self) -> TreeStats {
        let is_leaf = |n: &&Node| n.front == NONE && n.back == NONE;
        let leaves = self.nodes.iter().filter(is_leaf);
        let (count, sum) = leaves.fold((0_u64, 0_u64), |(count, sum), n| {
            (count + 1, sum + u64::from(n.depth) + 1)
        });
        let undivided = self.nodes.iter().filter(|n| n.plane == NONE);
        TreeStats {
            polygons: self.polygons.len() as u64,
            triangles: self.polygons.iter().map(|p| p.triangles.len() as u64).sum(),
            left_out: self.left_out.len() as u64,
            nodes: self.nodes.len() as u64,
            depth: self.nodes.iter().map(|n| n.depth + 1).max().unwrap_or(0),
            mean_leaf_depth: sum as f64 / count.max(1) as f64,
            splits: self.splits,
            fragments: self.fragments.len() as u64,
            unsplit: undivided.map(|n| u64::from(n.fragment_count)).sum(),
        }
    }

    /// A node below `parent`, without fragments, for the build and for tests of shapes that no build makes.
    pub(super) fn push_node(&mut self, plane: u32, parent: Option<(u32, bool)>) -> u32 {
        let number = self.nodes.len() as u32;
        let depth = parent.map_or(0, |(p, is_front)| {
            let parent = &mut self.nodes[p as usize];
            *(if is_front {
                &mut parent.front
            } else {
                &mut parent.back
            }) = number;
            parent.depth + 1
        });
        self.nodes.push(Node {
            plane,
            first_fragment: self.fragments.len() as u32,
            fragment_count: 0,
            front: NONE,
            back: NONE,
            depth,
        });
        number
    }

    /// Adds a fragment to the last node.
    pub(super) fn push_fragment(&mut self, fragment: Fragment) {
        self.fragments.push(fragment);
        if let Some(node) = self.nodes.last_mut() {
            node.fragment_count += 1;
        }
    }

    /// Visits every node: what is behind, the node, what is in front. The second argument says how the visit came.
    pub(super) fn in_order(&self, mut visit: impl FnMut(u32)) {
        let mut stack = Vec::new();
        let mut at = (!self.nodes.is_empty()).then_some(0);
        loop {
            while let Some(node) = at {
                stack.push(node);
                at = self.nodes[node as usize].back();
            }
            let Some(node) = stack.pop() else { return };
            visit(node);
            at = self.nodes[node as usize].front();
        }
    }
}
