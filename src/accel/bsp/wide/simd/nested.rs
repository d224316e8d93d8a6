//! Walks that go from a tree into its treelets and back.
//!
//! What waits in a treelet lies on the walk's stack above a mark ([`Word::OUT`]), and what waits in the tree around it below.

use std::mem::MaybeUninit;

use super::super::node::Word;
use super::Tree;

/// Trees one within the other, at most.
pub(in super::super) const MOST_NESTED: usize = 8;

/// The trees around the one that a walk is in.
pub(super) struct Outside<'a> {
    trees: [MaybeUninit<Tree<'a>>; MOST_NESTED],
    depth: usize,
}

impl<'a> Outside<'a> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            trees: [const { MaybeUninit::uninit() }; MOST_NESTED],
            depth: 0,
        }
    }

    /// Goes where a word leads that leads elsewhere. Whether that is a treelet, whose root comes next: then a mark must be put on the stack.
    ///
    /// # Safety
    /// A mark was put on the stack for each treelet that was entered, and led out of it when it was popped.
    #[inline(always)]
    pub(super) unsafe fn go(&mut self, tree: &mut Tree<'a>, word: Word) -> bool {
        if word == Word::OUT {
            self.depth -= 1;
            // SAFETY: written when the treelet was entered.
            *tree = unsafe { self.trees.get_unchecked(self.depth).assume_init() };
            return false;
        }
        self.trees[self.depth].write(*tree);
        self.depth += 1;
        *tree = tree.treelet(word);
        true
    }
}
