//! A node of eight children, and the word that names a child.

use bytemuck::{Pod, Zeroable};

use super::fragment::Extent;

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Eight children: their extents, and where to find them.
///
/// A lane without a child has an extent that no ray meets.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Node {
    /// Least x, y, z, then greatest x, y, z, of all children.
    pub(super) bounds: [[f32; WIDTH]; 6],
    pub(super) children: [Word; WIDTH],
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [Word(0); WIDTH],
    };

    pub(super) fn set(&mut self, lane: usize, extent: &Extent, child: Word) {
        for axis in 0..3 {
            self.bounds[axis][lane] = extent.min[axis];
            self.bounds[axis + 3][lane] = extent.max[axis];
        }
        self.children[lane] = child;
    }
}

/// A child: a node by its index; or a leaf by where its blocks begin, how many they are, and how many triangles the last has; or, in the place of a
/// leaf, a way to another tree: a treelet by its index, or the one around.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Word(u32);

/// Blocks of a leaf, at most.
pub(super) const MOST_BLOCKS: usize = 4;

impl Word {
    const LEAF: u32 = 1 << 31;
    /// Nodes are counted in units of so many bytes, since a shift is faster than a product.
    const UNIT: usize = 32;
    const NODE_UNITS: u32 = (size_of::<Node>() / Self::UNIT) as u32;
    /// Greatest index of a node.
    pub(super) const MOST_NODES: u32 = (Self::LEAF - 1) / Self::NODE_UNITS;
    const BLOCKS: u32 = 29;
    const COUNT: u32 = 26;
    const PLACES: u32 = (1 << Self::COUNT) - 1;
    /// A leaf at these places is none, but leads to another tree.
    const ELSEWHERE: u32 = 3 << (Self::COUNT - 2);
    /// Greatest place of a block.
    pub(super) const MOST_PLACE: usize = Self::ELSEWHERE as usize - 1;
    /// Greatest index of a treelet.
    const MOST_TREELETS: u32 = Self::PLACES - Self::ELSEWHERE - 1;
    /// Leads out of a treelet, back to the tree around it.
    pub(super) const OUT: Self = Self(Self::LEAF | Self::PLACES);

    pub(super) fn node(index: u32) -> Self {
        assert!(index <= Self::MOST_NODES, "too many nodes for a word");
        Self(index * Self::NODE_UNITS)
    }

    /// A leaf of so many triangles, at least one.
    pub(super) fn leaf(place: usize, count: usize) -> Self {
        let (blocks, last) = ((count - 1) / WIDTH, (count - 1) % WIDTH);
        assert!(
            place <= Self::MOST_PLACE && blocks < MOST_BLOCKS,
            "too many triangles for a word"
        );
        Self(
            Self::LEAF
                | (blocks as u32) << Self::BLOCKS
                | (last as u32) << Self::COUNT
                | place as u32,
        )
    }

    /// The tree's treelet of this index.
    pub(super) fn treelet(index: usize) -> Self {
        assert!(
            index <= Self::MOST_TREELETS as usize,
            "too many treelets for a word"
        );
        Self(Self::LEAF | Self::ELSEWHERE | index as u32)
    }

    /// Of a leaf: whether it is none, but leads to another tree.
    #[inline(always)]
    pub(super) fn leads_elsewhere(self) -> bool {
        self.0 & Self::ELSEWHERE == Self::ELSEWHERE
    }

    /// Index of the treelet to which it leads.
    pub(super) fn treelet_index(self) -> usize {
        (self.0 & Self::PLACES & !Self::ELSEWHERE) as usize
    }

    #[inline(always)]
    pub(super) fn bits(self) -> u32 {
        self.0
    }

    #[inline(always)]
    pub(super) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// How many bytes before a node there are others.
    #[inline(always)]
    pub(super) fn offset(self) -> usize {
        self.0 as usize * Self::UNIT
    }

    /// Where a leaf's blocks begin, in units of [`LINE`](super::store::LINE) words.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        (self.0 & Self::PLACES) as usize
    }

    /// How many blocks a leaf has before its last: they are full.
    #[inline(always)]
    pub(super) fn full_blocks(self) -> usize {
        (self.0 >> Self::BLOCKS & 3) as usize
    }

    /// How many triangles a leaf's last block has.
    #[inline(always)]
    pub(super) fn last_count(self) -> usize {
        (self.0 >> Self::COUNT & 7) as usize + 1
    }
}
