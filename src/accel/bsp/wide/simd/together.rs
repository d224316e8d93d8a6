//! What the walks of a group of rays share: one test of a node for all, one test of a box for each vector of rays.
//!
//! A child that the group's shaft meets waits with the rays that entered its parent. When its turn comes, the rays that meet its own box
//! go on; where they are few, each finishes the child alone.
//!
//! What did not pay: a shaft around each vector of eight rays rather than around the group (12 % slower), sixteen lanes of 512 bits (0 to 8 % slower),
//! groups of 32 rays (9 % slower).

use std::mem::MaybeUninit;

use super::super::node::{Node, WIDTH};
use super::bundle::Faces;
use super::group::Group;
use super::kernel::Lanes;
use super::stack::STACK;

/// Up to so many rays walk a child each alone. Between 2 and 8 it hardly matters; without it, shadows of leaves (ficus) take 13 % longer.
pub(super) const FEW: u32 = 3;

/// A child of a node that waits, and the rays that entered the node.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    pub(super) node: *const Node,
    pub(super) lane: u32,
    /// About where rays enter it.
    from: f32,
    pub(super) active: u64,
}

impl Waiting {
    /// Whether it is the mark of [`Children::wait_outside`].
    #[inline(always)]
    pub(super) fn leads_out(&self) -> bool {
        self.node.is_null()
    }
}

/// The children that wait, the next one last.
pub(super) struct Children {
    waiting: [MaybeUninit<Waiting>; STACK],
    height: usize,
}

impl Children {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            waiting: [const { MaybeUninit::uninit() }; STACK],
            height: 0,
        }
    }

    /// The children in `hit` wait, the nearest last.
    ///
    /// # Safety
    /// As for [`Lanes`]; the stack is as high as the tree's depth allows.
    #[inline(always)]
    pub(super) unsafe fn push<L: Lanes>(
        &mut self,
        node: *const Node,
        mut hit: u32,
        from: &L,
        active: u64,
    ) {
        let base = self.height;
        while hit != 0 {
            let lane = hit.trailing_zeros();
            hit &= hit - 1;
            // SAFETY: lanes are below 8; the caller's promise; only what was written is read.
            unsafe {
                let next = Waiting {
                    node,
                    lane,
                    from: from.lane(lane as usize),
                    active,
                };
                let mut place = self.height;
                while place > base
                    && self.waiting.get_unchecked(place - 1).assume_init_ref().from < next.from
                {
                    *self.waiting.get_unchecked_mut(place) = *self.waiting.get_unchecked(place - 1);
                    place -= 1;
                }
                self.waiting.get_unchecked_mut(place).write(next);
            }
            self.height += 1;
        }
    }

    /// What waits so far waits outside of a treelet.
    ///
    /// # Safety
    /// As for `push`.
    #[inline(always)]
    pub(super) unsafe fn wait_outside(&mut self) {
        let mark = Waiting {
            node: std::ptr::null(),
            lane: 0,
            from: f32::NEG_INFINITY,
            active: 0,
        };
        // SAFETY: the caller's promise.
        unsafe { self.waiting.get_unchecked_mut(self.height).write(mark) };
        self.height += 1;
    }

    /// # Safety
    /// What is below the height was written.
    #[inline(always)]
    pub(super) unsafe fn pop(&mut self) -> Option<Waiting> {
        self.height = self.height.checked_sub(1)?;
        // SAFETY: the caller's promise.
        Some(unsafe { self.waiting.get_unchecked(self.height).assume_init() })
    }
}

impl<L: Lanes> Group<'_, L> {
    /// Of the active rays, those that meet a child of a node.
    ///
    /// # Safety
    /// As for [`Lanes`]; `lane` is below 8.
    #[inline(always)]
    pub(super) unsafe fn entering(&self, node: &Node, lane: usize, active: u64) -> u64 {
        let [near, far] = self.frame.rows();
        let mut entering = 0;
        // SAFETY: the caller's promise.
        unsafe {
            let sign = self.frame.sign();
            let faces = Faces {
                near: [
                    L::splat(bound(node, near[0], lane)),
                    L::splat(bound(node, near[1], lane)),
                    L::splat(bound(node, near[2], lane) * sign),
                ],
                far: [
                    L::splat(bound(node, far[0], lane)),
                    L::splat(bound(node, far[1], lane)),
                    L::splat(bound(node, far[2], lane) * sign),
                ],
            };
            let mut vectors = vectors(active);
            while vectors != 0 {
                let place = vectors.trailing_zeros() as usize;
                vectors &= vectors - 1;
                let bundle = self.bundles.get_unchecked(place / WIDTH);
                entering |= u64::from(bundle.meet(&faces)) << place;
            }
        }
        entering & active
    }
}

/// One of a node's bounds.
///
/// # Safety
/// `row` is the offset of a row, `lane` below 8.
#[inline(always)]
unsafe fn bound(node: &Node, row: usize, lane: usize) -> f32 {
    // SAFETY: the caller's promise.
    unsafe { *node.bounds.as_ptr().byte_add(row).cast::<f32>().add(lane) }
}

/// Whether triangles are tested one by one against vectors of rays, rather than rays one by one against the block.
///
/// A test of a triangle against eight rays takes about two thirds of the time of one of a ray against a block.
#[inline(always)]
pub(super) fn is_by_triangle(rays: u32, triangles: u32, vectors: u32) -> bool {
    2 * triangles * vectors <= 3 * rays
}

/// The vectors that have active rays: the first bit of each.
#[inline(always)]
pub(super) fn vectors(active: u64) -> u64 {
    let pairs = active | active >> 1;
    let fours = pairs | pairs >> 2;
    (fours | fours >> 4) & 0x0101_0101_0101_0101
}
