//! The walk, compiled once for each instruction set, and the choice among them at run time.
//!
//! All `unsafe` of the crate is here, but for that of the file that loads Embree: instructions that a machine may lack, and lookups whose indices are right by
//! construction.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod bundle;
mod depth;
mod edges;
mod group;
mod kernel;
mod nested;
mod parts;
mod portable;
mod search;
mod searches;
mod shaft;
mod single;
mod stack;
mod table;
mod test;
mod tested;
mod together;
mod together_any;
mod together_closest;
#[cfg(target_arch = "x86_64")]
mod vectors;

pub(super) use nested::MOST_NESTED;
pub(super) use parts::parts;
pub(super) use stack::MOST_DEPTH;
pub(super) use table::GROUP;
pub(in crate::accel) use test::WideTest;
use tested::LaneTest;

use crate::accel::counters::Counter;
use crate::geometry::Ray;

use super::super::options::BspInstructions;
use super::node::{Node, WIDTH, Word};
use super::store::{FULL_BLOCK, LINE, Store};
use super::walk::Reach;

/// Sets of instructions that the walk is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::accel) enum Instructions {
    /// Plain Rust.
    Portable,
    /// AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 with vectors of 256 bits.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Instructions {
    /// All that this machine has, the best first.
    pub(in crate::accel::bsp) fn available() -> Vec<Self> {
        let mut found = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi1");
            if avx2 && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
                found.push(Self::Avx512);
            }
            if avx2 {
                found.push(Self::Avx2);
            }
        }
        found.push(Self::Portable);
        found
    }

    /// Those that are asked for, if this machine has them.
    pub(in crate::accel::bsp) fn chosen(choice: BspInstructions) -> Option<Self> {
        let wanted = match choice {
            BspInstructions::Auto => return Some(Self::best()),
            #[cfg(target_arch = "x86_64")]
            BspInstructions::Avx512 => Self::Avx512,
            #[cfg(target_arch = "x86_64")]
            BspInstructions::Avx2 => Self::Avx2,
            #[cfg(not(target_arch = "x86_64"))]
            BspInstructions::Avx512 | BspInstructions::Avx2 => return None,
            BspInstructions::Portable => Self::Portable,
        };
        Self::available().contains(&wanted).then_some(wanted)
    }

    /// The best that this machine has.
    pub(in crate::accel::bsp) fn best() -> Self {
        Self::available()[0]
    }
}

/// Hits up to this `t` count only from this number of a triangle on.
pub(in crate::accel) type Passed = Option<(f32, u32)>;

/// The nearest hit, by the triangle's number in the set; or why there is none. As small as an answer can be.
#[derive(Clone, Copy, Debug)]
pub(in crate::accel) struct Found {
    pub(super) t: f32,
    number: u32,
}

impl Found {
    pub(super) const NOTHING: Self = Self {
        t: f32::INFINITY,
        number: u32::MAX,
    };
    const UNUSUAL: Self = Self {
        t: f32::INFINITY,
        number: u32::MAX - 1,
    };

    /// The number of the triangle that was hit.
    #[inline(always)]
    pub(super) fn number(&self) -> Option<u32> {
        (self.number < Self::UNUSUAL.number).then_some(self.number)
    }

    /// Whether a hit comes before this one, and is not passed over.
    #[inline(always)]
    fn is_behind(&self, t: f32, number: u32, passed: Passed) -> bool {
        let wins = t < self.t || (t <= self.t && number < self.number);
        wins && !passed.is_some_and(|(least, end)| t <= least && number < end)
    }

    /// The ray was not for the walk: it is not traceable, or would leave the range of `f32`.
    #[inline(always)]
    pub(super) fn is_unusual(&self) -> bool {
        self.number == Self::UNUSUAL.number
    }
}

/// Whether anything is hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::accel) enum Occluded {
    Yes,
    No,
    /// As [`Found::is_unusual`].
    Unusual,
}

/// What a search walks.
#[derive(Clone, Copy)]
pub(in crate::accel) struct Tree<'a> {
    store: &'a Store,
    nodes: *const Node,
    words: *const u32,
    root: Word,
    reach: &'a Reach,
}

impl<'a> Tree<'a> {
    #[inline(always)]
    pub(super) fn new(store: &'a Store, root: Word, reach: &'a Reach) -> Self {
        Self {
            store,
            nodes: store.nodes.as_ptr(),
            words: store.words.as_ptr(),
            root,
            reach,
        }
    }

    /// Whether words of it may lead elsewhere.
    #[inline(always)]
    fn has_treelets(&self) -> bool {
        !self.store.treelets.is_empty()
    }

    /// One of its treelets, as another tree.
    #[inline(never)]
    fn treelet(&self, word: Word) -> Self {
        let inside = self.store.treelets[word.treelet_index()].get();
        Self::new(&inside.store, inside.root, self.reach)
    }

    /// The node that a word names.
    #[inline(always)]
    fn node(&self, word: Word) -> *const Node {
        self.nodes.wrapping_byte_add(word.offset())
    }

    /// The blocks of a leaf.
    #[inline(always)]
    fn blocks(&self, leaf: Word) -> Blocks {
        Blocks {
            // Within the words: a leaf's place is where its blocks were written.
            block: self.words.wrapping_add(leaf.place() * LINE).cast(),
            full: leaf.full_blocks(),
            last: leaf.last_count(),
        }
    }
}

/// A leaf's blocks, one after the other.
struct Blocks {
    block: *const f32,
    /// Full blocks from this one on that are not the last.
    full: usize,
    /// Triangles of the last block.
    last: usize,
}

impl Blocks {
    /// Where the block begins, and its triangles.
    #[inline(always)]
    fn current(&self) -> (*const f32, usize) {
        let count = if self.full == 0 { self.last } else { WIDTH };
        (self.block, count)
    }

    /// `false` after the last.
    #[inline(always)]
    fn advance(&mut self) -> bool {
        if self.full == 0 {
            return false;
        }
        self.full -= 1;
        self.block = self.block.wrapping_add(FULL_BLOCK);
        true
    }
}

/// Calls a function compiled for the machine's instructions.
macro_rules! dispatch {
    ($instructions:expr, $module:ident::$function:ident $(<$($generic:ty),*>)? ($($argument:expr),*)) => {
        match $instructions {
            // SAFETY: every machine has them.
            Instructions::Portable => unsafe {
                $module::$function::<portable::Lanes $(, $($generic),*)?>($($argument),*)
            },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Instructions::available` found them on this machine.
            Instructions::Avx2 => unsafe { avx2::$function $(::<$($generic),*>)? ($($argument),*) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Instructions::available` found them on this machine.
            Instructions::Avx512 => unsafe { avx512::$function $(::<$($generic),*>)? ($($argument),*) },
        }
    };
}

/// The nearest hit, least number first among equals; hits below `passed` are passed over, see [`Passed`].
#[inline(always)]
pub(super) fn closest<C: Counter>(
    instructions: Instructions,
    tree: Tree<'_>,
    ray: &Ray,
    passed: Passed,
    counter: &mut C,
) -> Found {
    dispatch!(instructions, single::closest<C>(tree, ray, passed, counter))
}

/// Whether anything is hit.
#[inline(always)]
pub(super) fn any<C: Counter>(
    instructions: Instructions,
    tree: Tree<'_>,
    ray: &Ray,
    counter: &mut C,
) -> Occluded {
    dispatch!(instructions, single::any<C>(tree, ray, counter))
}

/// As [`closest`], by a test that is not exact.
fn closest_tested<T: LaneTest, C: Counter>(
    instructions: Instructions,
    tree: Tree<'_>,
    ray: &Ray,
    passed: Passed,
    counter: &mut C,
) -> Found {
    dispatch!(
        instructions,
        tested::closest_tested < T,
        C > (tree, ray, passed, counter)
    )
}

/// As [`any`], by a test that is not exact.
fn any_tested<T: LaneTest, C: Counter>(
    instructions: Instructions,
    tree: Tree<'_>,
    ray: &Ray,
    counter: &mut C,
) -> Occluded {
    dispatch!(
        instructions,
        tested::any_tested < T,
        C > (tree, ray, counter)
    )
}

/// Calls `visit` with the numbers in the leaves that the ray meets, see [`Store::numbers`], within the limit of `t` that the last call
/// returned. `false` if the ray is not for the walk.
pub(super) fn visit<C: Counter>(
    instructions: Instructions,
    tree: Tree<'_>,
    ray: &Ray,
    counter: &mut C,
    visit: &mut dyn FnMut(u32, &mut C) -> f32,
) -> bool {
    dispatch!(instructions, single::visit<C>(tree, ray, counter, visit))
}

/// The nearest hits of up to [`GROUP`] rays, one at least. A bit for each ray that has no answer and must walk alone.
pub(super) fn closest_together(
    instructions: Instructions,
    tree: Tree<'_>,
    rays: &[Ray],
    found: &mut [Found],
) -> u64 {
    dispatch!(
        instructions,
        together_closest::closest_together(tree, rays, found)
    )
}

/// Whether anything is hit, for up to [`GROUP`] rays, one at least. A bit for each ray that has no answer and must walk alone.
pub(super) fn any_together(
    instructions: Instructions,
    tree: Tree<'_>,
    rays: &[Ray],
    hits: &mut [bool],
) -> u64 {
    dispatch!(instructions, together_any::any_together(tree, rays, hits))
}

#[cfg(test)]
mod tests;
