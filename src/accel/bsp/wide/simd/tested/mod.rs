//! The walk with a triangle test that is not exact: eight triangles at a time, as the published test has them, and no second look at any.
//!
//! Beside [`single`](super::single) this shows what exactness costs: the same tree, walked in the same order, with the same lanes. Only the leaves differ. Every ray goes alone.

mod double;
mod fast;
mod watertight;

use super::super::store::HEADER;
use super::super::walk::WalkRay;
use super::kernel::Lanes;
use super::single::{AnyLeaf, NearestLeaf, nearest_first, promising_first};
use super::{Found, Occluded, Passed, Tree};
use crate::accel::bsp::wide::node::Word;
use crate::accel::counters::Counter;
use crate::geometry::tolerance::PLAUSIBLE_DEPTH;
use crate::geometry::{Interval, Ray, TestedRay};

/// A triangle test in lanes. Its slow twin is the [`TestedRay`], whose bits it has.
pub(super) trait LaneTest: TestedRay {
    /// A ray made ready.
    type Ready<L: Lanes>;

    /// # Safety
    /// As for [`Lanes`].
    unsafe fn ready<L: Lanes>(ray: &Ray) -> Self::Ready<L>;

    /// Which triangles of a block the ray's line meets, a bit for each, and at what `t`; that may be NaN or infinite. Bits beyond `count` mean nothing.
    ///
    /// # Safety
    /// As for [`Lanes`]; `block` begins a block of `count` triangles.
    unsafe fn depths<L: Lanes>(ready: &Self::Ready<L>, block: *const f32, count: usize)
    -> (u32, L);
}

/// A ray for the leaves: its test, and between which `t` a hit counts.
struct TestedLeaves<T: LaneTest, L: Lanes> {
    ready: T::Ready<L>,
    first: L,
    last: L,
    passed: Passed,
    found: Found,
    per_t: f32,
}

impl<T: LaneTest, L: Lanes> TestedLeaves<T, L> {
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn new(ray: &Ray, passed: Passed, per_t: f32) -> Self {
        let Interval { min, max } = ray.interval;
        // SAFETY: the caller's promise.
        unsafe {
            Self {
                ready: T::ready(ray),
                // A hit is at a finite `t`.
                first: L::splat(min.max(f32::MIN)),
                last: L::splat(max.min(f32::MAX)),
                passed,
                found: Found::NOTHING,
                per_t,
            }
        }
    }

    /// The triangles of a block that are hit where that counts, and their `t`.
    ///
    /// # Safety
    /// As for [`LaneTest::depths`].
    #[inline(always)]
    unsafe fn hits(&self, block: *const f32, count: usize) -> (u32, L) {
        // SAFETY: the caller's promise.
        unsafe {
            let (met, t) = T::depths::<L>(&self.ready, block, count);
            let inside = self.first.at_most(t) & t.at_most(self.last);
            (met & inside & ((1 << count) - 1), t)
        }
    }
}

impl<T: LaneTest, L: Lanes, C: Counter> NearestLeaf<C> for TestedLeaves<T, L> {
    #[inline(always)]
    unsafe fn nearest(&mut self, tree: &Tree<'_>, leaf: Word, counter: &mut C) -> Option<f32> {
        let before = self.found.t;
        let mut blocks = tree.blocks(leaf);
        // SAFETY: the caller's promise.
        unsafe {
            loop {
                let (block, count) = blocks.current();
                counter.primitives(count);
                let (mut hits, t) = self.hits(block, count);
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    let number = (*block.add(HEADER + 9 * count + lane)).to_bits();
                    let t = t.lane(lane);
                    if self.found.is_behind(t, number, self.passed) {
                        self.found = Found { t, number };
                    }
                }
                if !blocks.advance() {
                    break;
                }
            }
            if self.found.t >= before {
                return None;
            }
            let t = self.found.t;
            self.last = L::splat(t);
            // Other triangles in the same place may be found a little nearer: such a test rounds.
            Some((t + t.abs() * PLAUSIBLE_DEPTH as f32) * self.per_t)
        }
    }
}

impl<T: LaneTest, L: Lanes, C: Counter> AnyLeaf<C> for TestedLeaves<T, L> {
    #[inline(always)]
    unsafe fn any(&self, tree: &Tree<'_>, leaf: Word, counter: &mut C) -> bool {
        let mut blocks = tree.blocks(leaf);
        loop {
            let (block, count) = blocks.current();
            counter.primitives(count);
            // SAFETY: the caller's promise.
            if unsafe { self.hits(block, count) }.0 != 0 {
                return true;
            }
            if !blocks.advance() {
                return false;
            }
        }
    }
}

/// The nearest hit by the test, the least number first among equals.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn closest_tested<L: Lanes, T: LaneTest, C: Counter>(
    tree: Tree<'_>,
    ray: &Ray,
    passed: Passed,
    counter: &mut C,
) -> Found {
    let Some(walk) = WalkRay::new(ray, tree.reach) else {
        return Found::UNUSUAL;
    };
    // SAFETY: the caller's promise.
    unsafe {
        let mut leaves = TestedLeaves::<T, L>::new(ray, passed, walk.per_t);
        nearest_first::<L, C>(tree, &walk, ray.interval, counter, &mut leaves);
        leaves.found
    }
}

/// Whether anything is hit by the test.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
pub(super) unsafe fn any_tested<L: Lanes, T: LaneTest, C: Counter>(
    tree: Tree<'_>,
    ray: &Ray,
    counter: &mut C,
) -> Occluded {
    let Some(walk) = WalkRay::new(ray, tree.reach) else {
        return Occluded::Unusual;
    };
    // SAFETY: the caller's promise.
    unsafe {
        let leaves = TestedLeaves::<T, L>::new(ray, None, walk.per_t);
        promising_first::<L, C>(tree, &walk, ray.interval, counter, &leaves)
    }
}

/// Each triangle of a block by the test: the bits of its `t`, if the ray's line meets it there.
///
/// # Safety
/// As for [`LaneTest::depths`].
#[cfg(test)]
#[inline(always)]
pub(super) unsafe fn block_tested<L: Lanes, T: LaneTest>(
    ray: &Ray,
    block: *const f32,
    count: usize,
) -> [Option<u32>; 8] {
    // SAFETY: the caller's promise.
    unsafe {
        let leaves = TestedLeaves::<T, L>::new(ray, None, 1.0);
        let (hits, t) = leaves.hits(block, count);
        std::array::from_fn(|lane| (hits >> lane & 1 != 0).then(|| t.lane(lane).to_bits()))
    }
}
