//! Parts of the tree that are built when the first ray reaches them.
//!
//! A large tree is built down to cells that are a small share of it; each of these is a treelet, which is built the same way, from what is left of
//! its cell, by the thread whose ray comes first. Others that come meanwhile wait. Planes and extents are those of the tree that is built at
//! once; only nodes of eight do not reach across the border of a treelet.
//!
//! Whoever builds holds a lock, and so works alone: a thread that waits for the help of others takes up work of theirs, which may wait for that lock.

use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use glam::Vec4;

use super::build::{Builder, Corners, Plan, Rest};
use super::collapse::{self, Ends};
use super::fragment::Fragment;
use super::members::LEAF_SIZE;
use super::node::Word;
use super::simd::{MOST_DEPTH, MOST_NESTED};
use super::store::{Draft, Store};
use crate::accel::bake::TriangleSet;
use crate::geometry::Triangle;

/// Fragments up to which a cell is built as a whole.
const WHOLE: usize = 1024;

/// Cells that are less than this share of the tree are left for later.
const SHARE: usize = 64;

/// Fragments that are worth a treelet: fewer are divided at once.
const LEAST: usize = 128;

/// What all cells of a set are built from.
pub(super) struct Source {
    pub(super) triangles: TriangleSet,
    /// The triangles' corners along the tree's axes, if it has any of its own.
    pub(super) turned: Option<Vec<[Vec4; 3]>>,
    pub(super) plan: Plan,
    /// Whether of triangles in the same place only the first is there.
    pub(super) drops_copies: bool,
}

/// How much of a tree is built at once, and by whom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::accel) enum Growth {
    /// All of it, by all threads.
    Whole,
    /// The upper part, by all threads; what lies below when a ray reaches it.
    Reached,
    /// The same, by a thread that holds a lock.
    ReachedAlone,
}

/// A tree, or the part of one from one border of treelets to the next.
pub(super) struct Branch {
    pub(super) store: Store,
    pub(super) root: Word,
    /// Its own levels, leaves included.
    levels: u32,
}

/// A cell that is built when a ray reaches it.
pub(super) struct Treelet {
    built: OnceLock<Branch>,
    /// Nothing once somebody builds it.
    waiting: Mutex<Option<Waiting>>,
    /// Levels of the branch that lie above it.
    above: u32,
}

/// A part of a tree.
pub(super) enum Part<'a> {
    /// Nodes and leaves.
    Built(&'a Store),
    /// Fragments in a cell that no ray has reached.
    Waiting(&'a [Fragment], &'a Source),
}

struct Waiting {
    source: Arc<Source>,
    rest: Rest,
    /// How many branches lie above it.
    nesting: usize,
}

impl Source {
    pub(super) fn bytes(&self) -> usize {
        let turned = self.turned.as_deref().map_or(0, size_of_val);
        size_of_val(&*self.triangles) + turned
    }

    fn triangle(&self, number: u32) -> Triangle {
        self.triangles[number as usize].triangle
    }

    fn builder(&self, is_shared: bool, later: Option<RangeInclusive<usize>>) -> Builder<'_> {
        Builder {
            corners: match &self.turned {
                Some(turned) => Corners::Turned(turned),
                None => Corners::Plain(&self.triangles),
            },
            plan: self.plan,
            later,
            is_shared,
        }
    }
}

impl Branch {
    /// The tree over all triangles.
    pub(super) fn new(source: &Arc<Source>, growth: Growth) -> Self {
        let is_shared = growth != Growth::ReachedAlone;
        let rest = source.builder(is_shared, None).everything();
        if growth == Growth::Whole {
            return Self::of(source, rest, is_shared, None);
        }
        Self::of(source, rest, is_shared, Some(1))
    }

    /// Of a cell, down to treelets within this many branches, or wholly.
    fn of(source: &Arc<Source>, rest: Rest, is_shared: bool, nesting: Option<usize>) -> Self {
        let count = rest.fragments.len();
        let later = nesting
            .filter(|&nesting| nesting < MOST_NESTED && count > WHOLE)
            .map(|_| LEAST..=(count / SHARE).max(WHOLE / 4));
        let cell = source.builder(is_shared, later).build(rest);
        let mut draft = Draft::default();
        let ends = Leaves {
            source,
            nesting: nesting.unwrap_or(0),
        };
        let (root, levels) = collapse::write(&cell, 0, &ends, &mut draft);
        assert!(levels <= MOST_DEPTH, "the build bounds the depth");
        Self {
            store: draft.finish(),
            root,
            levels,
        }
    }

    /// Levels of the deepest part that is built.
    pub(super) fn depth(&self) -> u32 {
        let treelets = self.store.treelets.iter();
        let below = treelets.filter_map(|t| Some(t.above + t.built.get()?.depth()));
        below.fold(self.levels, u32::max)
    }

    /// Calls `visit` with every part of the tree.
    pub(super) fn each_part(&self, visit: &mut dyn FnMut(Part<'_>)) {
        visit(Part::Built(&self.store));
        for treelet in &self.store.treelets {
            let lock = treelet.waiting();
            match &*lock {
                Some(left) => visit(Part::Waiting(&left.rest.fragments, &left.source)),
                None => {
                    drop(lock);
                    treelet.get().each_part(visit);
                }
            }
        }
    }

    /// Calls `visit` with the number of every triangle; with some more than once.
    pub(super) fn each_triangle(&self, visit: &mut dyn FnMut(u32, &Triangle)) {
        self.each_part(&mut |part| match part {
            Part::Built(store) => store.all_triangles().for_each(|(n, t)| visit(n, &t)),
            Part::Waiting(fragments, source) => {
                let numbers = fragments.iter().map(Fragment::triangle);
                numbers.for_each(|n| visit(n, &source.triangle(n)));
            }
        });
    }
}

impl Treelet {
    /// What it is when it is built, now if need be.
    pub(super) fn get(&self) -> &Branch {
        self.built.get_or_init(|| {
            let waiting = self.waiting().take();
            let Waiting {
                source,
                rest,
                nesting,
            } = waiting.expect("nobody else builds it");
            Branch::of(&source, rest, false, Some(nesting + 1))
        })
    }

    fn waiting(&self) -> std::sync::MutexGuard<'_, Option<Waiting>> {
        // Nothing that is done under this lock can fail half-way.
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The numbers without those of triangles that have the same corners, in any order, as one before; and how many they are.
///
/// No plane divides such triangles, so that nearly all of them meet in a leaf; looking for them there takes a hundredth of the build.
fn without_copies(
    members: &[u32],
    triangle: impl Fn(u32) -> Triangle,
) -> ([u32; LEAF_SIZE], usize) {
    let (mut firsts, mut marks) = ([0; LEAF_SIZE], [0; LEAF_SIZE]);
    let mut count = 0;
    for &number in members {
        // A sum does not mind the order, and mostly differs.
        let corners = triangle(number);
        let coordinates = corners.corners().iter().flat_map(|p| p.to_array());
        let mark = coordinates.fold(0_u32, |sum, x| sum.wrapping_add(x.to_bits()));
        let is_same = |other| sorted(&triangle(other)) == sorted(&corners);
        let is_copy = (0..count).any(|i| marks[i] == mark && is_same(firsts[i]));
        if !is_copy {
            (firsts[count], marks[count]) = (number, mark);
            count += 1;
        }
    }
    (firsts, count)
}

/// The corners as bits, in an order of their own.
fn sorted(triangle: &Triangle) -> [[u32; 3]; 3] {
    let mut corners = triangle.corners().map(|p| p.to_array().map(f32::to_bits));
    corners.sort_unstable();
    corners
}

/// Leaves of triangles, and treelets.
struct Leaves<'a> {
    source: &'a Arc<Source>,
    nesting: usize,
}

impl Ends for Leaves<'_> {
    fn leaf(&self, members: &[u32], draft: &mut Draft) -> Word {
        let triangle = |n| self.source.triangle(n);
        if self.source.drops_copies {
            let (firsts, count) = without_copies(members, triangle);
            draft.push_leaf(&firsts[..count], triangle)
        } else {
            draft.push_leaf(members, triangle)
        }
    }

    fn later(&self, rest: Rest, above: u32, draft: &mut Draft) -> Word {
        draft.push_treelet(Treelet {
            built: OnceLock::new(),
            waiting: Mutex::new(Some(Waiting {
                source: Arc::clone(self.source),
                rest,
                nesting: self.nesting,
            })),
            above,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::{Cell, Content};
    use super::super::fragment::Extent;
    use super::super::tests::set_grown;
    use super::*;
    use crate::accel::BspQuality;

    fn bits(extent: &Extent) -> [[u32; 3]; 2] {
        [extent.min, extent.max].map(|p| p.truncate().to_array().map(f32::to_bits))
    }

    /// Compares binary trees, of which `later` is divided further where it waits. How often it did.
    fn compare(whole: &Cell, later: &Cell, builder: &Builder<'_>) -> usize {
        assert_eq!(bits(&whole.extent), bits(&later.extent));
        match (&whole.content, &later.content) {
            (Content::Leaf, Content::Leaf) => {
                assert_eq!(whole.members.get(), later.members.get());
                0
            }
            (Content::Inner(a), Content::Inner(b)) => {
                let pairs = a.iter().zip(&**b);
                pairs.map(|(a, b)| compare(a, b, builder)).sum()
            }
            (_, Content::Later(rest)) => 1 + compare(whole, &builder.build(rest.take()), builder),
            _ => panic!("one is a leaf, the other is not"),
        }
    }

    #[test]
    fn planes_and_extents_are_those_of_the_tree_that_is_built_at_once() {
        for quality in [BspQuality::Fast, BspQuality::Default] {
            let tree = set_grown(None, quality, Growth::Reached);
            let source = tree.source.upgrade().unwrap();
            let whole = source.builder(true, None);
            let whole = whole.build(whole.everything());
            let parts = source.builder(false, Some(100..=1000));
            let later = parts.build(parts.everything());
            assert!(compare(&whole, &later, &parts) > 5);
        }
    }

    #[test]
    fn what_it_was_built_from_goes_with_the_last_treelet() {
        let tree = set_grown(None, BspQuality::Default, Growth::Reached);
        assert!(tree.source.upgrade().is_some());
        for treelet in &tree.tree.store.treelets {
            treelet.get();
        }
        assert!(tree.source.upgrade().is_none());
    }
}
