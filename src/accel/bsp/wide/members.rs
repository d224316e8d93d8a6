//! The triangles of a cell, as long as a leaf can hold them.

use super::fragment::Fragment;

/// Triangles in a leaf, at most.
pub(super) const LEAF_SIZE: usize = super::node::MOST_BLOCKS * super::node::WIDTH;

/// Up to [`LEAF_SIZE`] triangles, in order; or too many.
#[derive(Clone, Copy)]
pub(super) struct Members {
    triangles: [u32; LEAF_SIZE],
    count: u8,
}

impl Members {
    const TOO_MANY: u8 = u8::MAX;

    /// Those of a cell that no leaf can hold.
    pub(super) const UNLISTED: Self = Self {
        triangles: [0; LEAF_SIZE],
        count: Self::TOO_MANY,
    };

    pub(super) fn of(fragments: &[Fragment]) -> Self {
        let mut all = Self {
            triangles: [0; LEAF_SIZE],
            count: 0,
        };
        fragments.iter().for_each(|f| all.insert(f.triangle()));
        all
    }

    fn insert(&mut self, triangle: u32) {
        let count = usize::from(self.count);
        if self.count == Self::TOO_MANY {
            return;
        }
        match self.triangles[..count].binary_search(&triangle) {
            Ok(_) => {}
            Err(_) if count == LEAF_SIZE => self.count = Self::TOO_MANY,
            Err(at) => {
                self.triangles.copy_within(at..count, at + 1);
                self.triangles[at] = triangle;
                self.count += 1;
            }
        }
    }

    pub(super) fn union(a: &Self, b: &Self) -> Self {
        let mut all = *a;
        match b.get() {
            Some(triangles) => triangles.iter().for_each(|&t| all.insert(t)),
            None => all.count = Self::TOO_MANY,
        }
        all
    }

    /// The triangles, unless there are too many.
    pub(super) fn get(&self) -> Option<&[u32]> {
        self.triangles.get(..usize::from(self.count))
    }
}
