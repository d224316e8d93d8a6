//! The children that wait while a ray walks elsewhere.

use std::mem::MaybeUninit;

use super::super::node::{Node, WIDTH, Word};
use super::kernel::Lanes;
use super::nested::MOST_NESTED;

/// Levels that a tree may have at most: the walk's stack is made for them.
pub(in super::super) const MOST_DEPTH: u32 = 112;

/// Children that wait, at most: seven a level, one more, and a mark a treelet.
pub(super) const STACK: usize = 7 * MOST_DEPTH as usize + 1 + MOST_NESTED;

/// A child that waits, and where the ray enters it: the entry's bits above the word's, so that of two the nearer is the lesser number, found without
/// a branch that nothing could predict: bounce rays are 4 to 5 % faster, eye rays, whose order is mostly known, 0 to 3 % slower. (Behind the origin
/// the order is the other way round, which costs steps but loses nothing.)
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Waiting(u64);

impl Waiting {
    #[inline(always)]
    fn new(from: f32, child: Word) -> Self {
        Self(u64::from(from.to_bits()) << 32 | u64::from(child.bits()))
    }

    #[inline(always)]
    fn from(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    fn child(self) -> Word {
        Word::from_bits(self.0 as u32)
    }
}

/// The children that wait, of one node the nearest last.
pub(super) struct Stack {
    waiting: [MaybeUninit<Waiting>; STACK],
    height: usize,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            waiting: [const { MaybeUninit::uninit() }; STACK],
            height: 0,
        }
    }

    /// The nearest of the children in `hit`; the others wait.
    ///
    /// # Safety
    /// As for [`Lanes`]; `hit` is not zero; the stack is as high as the tree's depth allows.
    #[inline(always)]
    pub(super) unsafe fn descend<L: Lanes>(&mut self, node: &Node, mut hit: u32, from: L) -> Word {
        // SAFETY: lanes are below 8; the caller's promise; only what was written is read.
        unsafe {
            let first = hit.trailing_zeros() as usize;
            hit &= hit - 1;
            let child = |lane: usize| *node.children.get_unchecked(lane);
            if hit == 0 {
                return child(first);
            }
            let mut entries = [0.0; WIDTH];
            from.store(&mut entries);
            let entry = |lane: usize| Waiting::new(*entries.get_unchecked(lane), child(lane));
            let (a, b) = (entry(first), entry(hit.trailing_zeros() as usize));
            hit &= hit - 1;
            let (mut near, far) = (a.min(b), a.max(b));
            let base = self.height;
            if hit == 0 {
                self.put(base, far);
                return near.child();
            }
            let third = entry(hit.trailing_zeros() as usize);
            hit &= hit - 1;
            let next = near.max(third);
            near = near.min(third);
            self.put(base, far.max(next));
            self.put(base + 1, far.min(next));
            while hit != 0 {
                let other = entry(hit.trailing_zeros() as usize);
                hit &= hit - 1;
                let next = near.max(other);
                near = near.min(other);
                let end = self.height;
                let mut place = end;
                while place > base {
                    let before = self.waiting.get_unchecked(place - 1).assume_init();
                    if before >= next {
                        break;
                    }
                    self.put(place, before);
                    place -= 1;
                }
                self.put(place, next);
                self.height = end + 1;
            }
            near.child()
        }
    }

    /// What waits so far waits outside of a treelet.
    ///
    /// # Safety
    /// As for `descend`.
    #[inline(always)]
    pub(super) unsafe fn wait_outside(&mut self) {
        // SAFETY: the caller's promise.
        unsafe { self.put(self.height, Waiting::new(f32::NEG_INFINITY, Word::OUT)) };
    }

    /// Writes what waits at a place, which becomes the last.
    ///
    /// # Safety
    /// The stack is as high as the tree's depth allows.
    #[inline(always)]
    unsafe fn put(&mut self, place: usize, waiting: Waiting) {
        // SAFETY: the caller's promise.
        unsafe { self.waiting.get_unchecked_mut(place).write(waiting) };
        self.height = place + 1;
    }

    /// The last that waits and is entered up to `last`.
    ///
    /// # Safety
    /// What is below the height was written.
    #[inline(always)]
    pub(super) unsafe fn pop(&mut self, last: f32) -> Option<Word> {
        while self.height > 0 {
            self.height -= 1;
            // SAFETY: the caller's promise.
            let waiting = unsafe { self.waiting.get_unchecked(self.height).assume_init() };
            if waiting.from() <= last {
                return Some(waiting.child());
            }
        }
        None
    }
}

/// The children that wait in a search for any hit, of one node those first that promise most.
pub(super) struct Promising {
    waiting: [MaybeUninit<Word>; STACK],
    height: usize,
}

impl Promising {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            waiting: [const { MaybeUninit::uninit() }; STACK],
            height: 0,
        }
    }

    /// The last of the children in `hit`; the others wait.
    ///
    /// # Safety
    /// `hit` is not zero, and its bits are below 8; the stack is as high as the tree's depth allows.
    #[inline(always)]
    pub(super) unsafe fn descend(&mut self, node: &Node, mut hit: u32) -> Word {
        let best = 31 - hit.leading_zeros();
        hit &= !(1 << best);
        // SAFETY: the caller's promise.
        unsafe {
            // Known before anything is written: the walk goes on from it at once.
            let promising = *node.children.get_unchecked(best as usize);
            while hit != 0 {
                let next = *node.children.get_unchecked(hit.trailing_zeros() as usize);
                hit &= hit - 1;
                self.waiting.get_unchecked_mut(self.height).write(next);
                self.height += 1;
            }
            promising
        }
    }

    /// What waits so far waits outside of a treelet.
    ///
    /// # Safety
    /// As for `descend`.
    #[inline(always)]
    pub(super) unsafe fn wait_outside(&mut self) {
        // SAFETY: the caller's promise.
        unsafe { self.waiting.get_unchecked_mut(self.height).write(Word::OUT) };
        self.height += 1;
    }

    /// The last that waits.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Word> {
        self.height = self.height.checked_sub(1)?;
        // SAFETY: what is below the height was written.
        Some(unsafe { self.waiting.get_unchecked(self.height).assume_init() })
    }
}
