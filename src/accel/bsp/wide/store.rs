//! The finished tree in memory: nodes, and blocks of triangles.
//!
//! A block of `n` triangles is a row of 32-bit words: the bound on its triangles' lengths (see [`lateral_bound`]), then nine rows of `n` coordinates (x of
//! the first corners, y, z, then the second and the third corners), then `n` numbers of triangles. Without gaps: eight lanes
//! are loaded from the start of a row, and those beyond `n` are ignored.

use glam::Vec3;

use super::node::{Node, WIDTH, Word};
use super::pages::Pages;
use super::treelet::Treelet;
use crate::geometry::Triangle;

/// Words that a place counts: leaves begin at multiples of it.
pub(super) const LINE: usize = 16;

/// Words of a block before its coordinates.
pub(super) const HEADER: usize = 1;

/// Rows of a block: nine of coordinates, one of numbers.
pub(super) const ROWS: usize = 10;

/// Words of a full block.
pub(super) const FULL_BLOCK: usize = HEADER + ROWS * WIDTH;

/// Nodes and blocks, while they are written.
#[derive(Default)]
pub(super) struct Draft {
    nodes: Vec<Node>,
    words: Vec<u32>,
    leaves: Vec<Word>,
    treelets: Vec<Treelet>,
}

/// Nodes and blocks.
pub(super) struct Store {
    pub(super) nodes: Pages<Node>,
    pub(super) words: Pages<u32>,
    /// All leaves, for rays that must be tested against everything.
    pub(super) leaves: Vec<Word>,
    /// What is divided when a ray reaches it.
    pub(super) treelets: Vec<Treelet>,
}

impl Draft {
    pub(super) fn reserve_node(&mut self) -> u32 {
        self.nodes.push(Node::EMPTY);
        self.nodes.len() as u32 - 1
    }

    pub(super) fn set_node(&mut self, index: u32, node: Node) {
        self.nodes[index as usize] = node;
    }
}

/// Greatest `|x| + |y|` of a triangle's corners in the frame of a ray whose line meets it, before rounding.
///
/// The line meets the triangle in a point `q`, which has x = y = 0 there. For a corner `p`, `|x| + |y|` is at most `|dx| + |dy| + 2 |dz|` with
/// `d = p - q`, since the shear is at most 1: at most twice the sum of `|d|`'s components, which is greatest where `q` is a corner.
pub(super) fn lateral_bound(triangle: &Triangle) -> f32 {
    let [a, b, c] = *triangle.corners();
    let length = |d: Vec3| d.abs().element_sum();
    2.0 * length(b - a).max(length(c - b)).max(length(a - c))
}

impl Draft {
    /// Appends a leaf of these triangles.
    pub(super) fn push_leaf(
        &mut self,
        numbers: &[u32],
        triangle: impl Fn(u32) -> Triangle,
    ) -> Word {
        self.words
            .resize(self.words.len().next_multiple_of(LINE), 0);
        let place = self.words.len() / LINE;
        for block in numbers.chunks(WIDTH) {
            let bound = block
                .iter()
                .map(|&n| lateral_bound(&triangle(n)))
                .fold(0.0, f32::max);
            self.words.push(bound.to_bits());
            for corner in 0..3 {
                for axis in 0..3 {
                    let row = block
                        .iter()
                        .map(|&n| triangle(n).corners()[corner][axis].to_bits());
                    self.words.extend(row);
                }
            }
            self.words.extend_from_slice(block);
        }
        let leaf = Word::leaf(place, numbers.len());
        self.leaves.push(leaf);
        leaf
    }

    /// Appends what waits for a ray.
    pub(super) fn push_treelet(&mut self, treelet: Treelet) -> Word {
        self.treelets.push(treelet);
        Word::treelet(self.treelets.len() - 1)
    }

    /// Appends a leaf of these numbers alone.
    pub(super) fn push_numbers(&mut self, numbers: &[u32]) -> Word {
        self.words
            .resize(self.words.len().next_multiple_of(LINE), 0);
        let leaf = Word::leaf(self.words.len() / LINE, numbers.len());
        self.words.extend_from_slice(numbers);
        leaf
    }

    /// What was written, in its place, with as much at its end as eight lanes may read too far.
    pub(super) fn finish(mut self) -> Store {
        self.words.extend([0; WIDTH]);
        self.leaves.shrink_to_fit();
        self.treelets.shrink_to_fit();
        Store {
            nodes: Pages::new(self.nodes),
            words: Pages::new(self.words),
            leaves: self.leaves,
            treelets: self.treelets,
        }
    }
}

impl Store {
    /// The numbers of such a leaf.
    pub(super) fn numbers(&self, leaf: Word) -> &[u32] {
        let count = leaf.full_blocks() * WIDTH + leaf.last_count();
        &self.words[leaf.place() * LINE..][..count]
    }

    /// Every triangle of a leaf with its number; some more than once.
    pub(super) fn all_triangles(&self) -> impl Iterator<Item = (u32, Triangle)> + '_ {
        let words = &*self.words;
        self.leaves.iter().flat_map(move |&leaf| {
            let counts = (0..leaf.full_blocks())
                .map(|_| WIDTH)
                .chain([leaf.last_count()]);
            let blocks = counts
                .enumerate()
                .map(move |(block, count)| (leaf.place() * LINE + block * FULL_BLOCK, count));
            blocks.flat_map(move |(block, count)| {
                (0..count).map(move |lane| {
                    let word = |row: usize| words[block + HEADER + row * count + lane];
                    let corner = |c: usize| {
                        Vec3::from_array([0, 1, 2].map(|axis| f32::from_bits(word(3 * c + axis))))
                    };
                    (word(9), Triangle::new(corner(0), corner(1), corner(2)))
                })
            })
        })
    }

    /// Without what is in the treelets.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes)
            + size_of_val(&*self.words)
            + size_of_val(&*self.leaves)
            + size_of_val(&*self.treelets)
    }
}
