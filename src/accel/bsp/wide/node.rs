//! A node of eight children, and the word that names a child.

use super::fragment::Extent;

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Eight children: their extents, and where to find them.
///
/// A lane without a child has an extent that no ray meets.
#[derive(Clone, Debug)]
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

/// A child: a node by its index; or a leaf by where its blocks begin, how many they are, and how many triangles the last has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(super) struct Word(u32);

/// Blocks of a leaf, at most.
pub(super) const MOST_BLOCKS: usize = 4;

impl Word {
    const LEAF: u32 = 1 << 31;
    const BLOCKS: u32 = 29;
    const COUNT: u32 = 26;
    /// Greatest place of a block.
    pub(super) const MOST_PLACE: usize = (1 << Self::COUNT) - 1;

    pub(super) fn node(index: u32) -> Self {
        Self(index)
    }

    /// A leaf of so many triangles, at least one.
    pub(super) fn leaf(place: usize, count: usize) -> Self {
        let (blocks, last) = ((count - 1) / WIDTH, (count - 1) % WIDTH);
        debug_assert!(place <= Self::MOST_PLACE && blocks < MOST_BLOCKS);
        Self(
            Self::LEAF
                | (blocks as u32) << Self::BLOCKS
                | (last as u32) << Self::COUNT
                | place as u32,
        )
    }

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// The index of a node.
    #[inline(always)]
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }

    /// Where a leaf's blocks begin, in units of [`LINE`](super::store::LINE) words.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        self.0 as usize & Self::MOST_PLACE
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
