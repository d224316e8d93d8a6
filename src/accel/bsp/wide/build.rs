//! The binary tree: cells divided by planes until dividing no longer pays.
//!
//! Depth is bounded, and so is the number of fragments: each cell has an allowance of further fragments, which it hands on to
//! its halves in proportion to what they hold. Both halves are built at the same time where they are large; since neither looks at
//! the other, the tree is the same for any number of threads.

use std::ops::RangeInclusive;

use glam::Vec4;

use super::collapse::Roots;
use super::fragment::{Extent, Fragment};
use super::members::{LEAF_SIZE, Members};
use super::plane::{self, Choice, Costs, Crossing, MOST_BINS};
use crate::accel::bake::NamedTriangle;

/// Up to how many fragments so many bins an axis are enough: more take a tenth of the build and change no ray's time.
const FEW: [(usize, usize); 2] = [(8, 4), (16, 8)];

/// Levels of division by planes; what is left then is halved by number, which takes at most 32 more.
const MOST_LEVELS: u32 = 64;

/// Fragments from which on the halves of a cell are built at the same time.
const PARALLEL_FROM: usize = 4096;

/// How the tree is built.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    pub(super) costs: Costs,
    /// Bins an axis, for many fragments and for few.
    pub(super) bins: [usize; 2],
    /// Cells of so few fragments are not divided.
    pub(super) undivided: usize,
    /// Further fragments allowed, in units of the number of triangles.
    pub(super) allowance: f32,
}

impl Plan {
    /// Bins an axis for a cell of so many fragments.
    fn bins(&self, count: usize) -> usize {
        let few = FEW.iter().find(|&&(most, _)| count <= most);
        let many = self.bins[usize::from(count <= 64)].min(MOST_BINS);
        few.map_or(many, |&(_, bins)| bins.min(many))
    }

    /// For placed sets, of which each has a tree of its own: one to a leaf, and none is split.
    pub(super) const OF_PLACEMENTS: Self = Self {
        costs: Costs {
            step: 1.0,
            leaf: 0.4,
            block: 0.0,
            triangle: 10.0,
        },
        bins: [16, 16],
        undivided: 1,
        allowance: 0.0,
    };
}

/// A node of the binary tree.
pub(super) struct Cell {
    pub(super) extent: Extent,
    pub(super) content: Content,
    /// About the area of its fragments.
    pub(super) surface: f32,
    /// What it costs to have it as one to eight roots.
    pub(super) roots: Roots,
    /// The triangles of all its fragments, in order, if a leaf can hold them.
    pub(super) members: Members,
}

pub(super) enum Content {
    Leaf,
    Inner(Box<[Cell; 2]>),
    /// Not divided yet. Who writes the tree takes it out.
    Later(std::cell::Cell<Rest>),
}

/// A cell that is not divided yet: with the same in hand, it is divided by the same planes at any time.
#[derive(Debug, Default)]
pub(super) struct Rest {
    pub(super) fragments: Vec<Fragment>,
    pub(super) allowance: usize,
    /// Levels of division by planes above it.
    pub(super) level: u32,
}

/// The triangles that fragments are parts of, in the tree's space.
#[derive(Clone, Copy)]
pub(super) enum Corners<'a> {
    /// Nobody asks for them: fragments are not cut.
    Unknown,
    /// Where the tree's space is theirs.
    Plain(&'a [NamedTriangle]),
    /// Where it has axes of its own.
    Turned(&'a [[Vec4; 3]]),
}

impl Corners<'_> {
    #[inline(always)]
    fn of(&self, triangle: u32) -> Option<[Vec4; 3]> {
        let index = triangle as usize;
        match self {
            Self::Unknown => None,
            Self::Plain(all) => Some(all[index].triangle.corners().map(|p| p.extend(0.0))),
            Self::Turned(all) => Some(all[index]),
        }
    }

    fn count(&self) -> usize {
        match self {
            Self::Unknown => 0,
            Self::Plain(all) => all.len(),
            Self::Turned(all) => all.len(),
        }
    }
}

/// What stays the same throughout a build.
pub(super) struct Builder<'a> {
    pub(super) corners: Corners<'a>,
    pub(super) plan: Plan,
    /// Cells of so many fragments are left for later.
    pub(super) later: Option<RangeInclusive<usize>>,
    /// Whether other threads help. Not while a lock is held: a thread that waits for their help would take up work that may wait for the lock.
    pub(super) is_shared: bool,
}

impl Builder<'_> {
    /// All triangles, undivided.
    pub(super) fn everything(&self) -> Rest {
        let whole = |number: u32| {
            let mut extent = Extent::EMPTY;
            let corners = self.corners.of(number);
            let points = corners.iter().flatten();
            points.for_each(|&p| extent.grow_point(p));
            Fragment::new(extent, number)
        };
        self.undivided((0..self.corners.count() as u32).map(whole).collect())
    }

    /// These fragments, undivided.
    pub(super) fn undivided(&self, fragments: Vec<Fragment>) -> Rest {
        Rest {
            allowance: (fragments.len() as f32 * self.plan.allowance) as usize,
            fragments,
            level: 0,
        }
    }

    /// The tree over what is left of a cell.
    pub(super) fn build(&self, rest: Rest) -> Cell {
        self.divide(rest.fragments, rest.allowance, rest.level)
    }

    /// A half of a cell.
    fn half(&self, fragments: Vec<Fragment>, allowance: usize, level: u32) -> Cell {
        let count = fragments.len();
        if self.later.as_ref().is_some_and(|l| l.contains(&count)) {
            let rest = Rest {
                fragments,
                allowance,
                level,
            };
            return self.later(rest);
        }
        self.divide(fragments, allowance, level)
    }

    /// A cell that is divided later. What it costs is a guess: each level halves its fragments, and a ray goes to one of the halves.
    fn later(&self, rest: Rest) -> Cell {
        let mut extent = Extent::EMPTY;
        rest.fragments.iter().for_each(|f| extent.grow(&f.extent()));
        let levels = libm::log2f(rest.fragments.len() as f32);
        let costs = &self.plan.costs;
        Cell {
            surface: rest.fragments.iter().map(|f| self.surface(f)).sum(),
            content: Content::Later(std::cell::Cell::new(rest)),
            roots: Roots::undivided(&extent, costs.leaf(1) + levels * costs.step),
            members: Members::UNLISTED,
            extent,
        }
    }

    fn divide(&self, fragments: Vec<Fragment>, allowance: usize, level: u32) -> Cell {
        let (mut extent, mut middles) = (Extent::EMPTY, Extent::EMPTY);
        for fragment in &fragments {
            extent.grow(&fragment.extent());
            middles.grow_point(fragment.middle());
        }
        let count = fragments.len();
        if count <= self.plan.undivided {
            return self.leaf(extent, &fragments);
        }
        let bins = self.plan.bins(count);
        let choice = (level < MOST_LEVELS)
            .then(|| {
                plane::choose(
                    &fragments,
                    &extent,
                    &middles,
                    &self.plan.costs,
                    bins,
                    allowance > 0,
                )
            })
            .flatten();
        if count <= LEAF_SIZE {
            let whole = self.plan.costs.leaf(count);
            let pays = choice.is_some_and(|c| c.cost < whole);
            if !pays {
                return self.leaf(extent, &fragments);
            }
        }
        let halves = choice
            .and_then(|choice| self.partition(&fragments, &choice, allowance))
            .unwrap_or_else(|| {
                let (a, b) = fragments.split_at(count / 2);
                [a.to_vec(), b.to_vec()]
            });
        drop(fragments);
        let more = (halves[0].len() + halves[1].len()).saturating_sub(count);
        let left = allowance.saturating_sub(more) as f64;
        let total = (halves[0].len() + halves[1].len()) as f64;
        let shares = [0, 1].map(|side| (left * halves[side].len() as f64 / total) as usize);
        let [a, b] = halves;
        let (a, b) = (
            || self.half(a, shares[0], level + 1),
            || self.half(b, shares[1], level + 1),
        );
        let (a, b) = if self.is_shared && count >= PARALLEL_FROM {
            rayon::join(a, b)
        } else {
            (a(), b())
        };
        Cell::inner(extent, [a, b], &self.plan.costs)
    }

    fn leaf(&self, extent: Extent, fragments: &[Fragment]) -> Cell {
        let members = Members::of(fragments);
        Cell {
            surface: fragments.iter().map(|f| self.surface(f)).sum(),
            content: Content::Leaf,
            roots: Roots::of_leaf(&extent, &members, &self.plan.costs),
            members,
            extent,
        }
    }

    /// About the area of a fragment: its triangle's share, by the areas of their extents.
    fn surface(&self, fragment: &Fragment) -> f32 {
        let Some([a, b, c]) = self.corners.of(fragment.triangle()) else {
            return 0.0;
        };
        let whole = Extent {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
        };
        let share = fragment.extent().half_area() / whole.half_area();
        let [u, v] = [b - a, c - a].map(Vec4::truncate);
        if share.is_finite() {
            0.5 * u.cross(v).length() * share
        } else {
            0.0
        }
    }

    /// The fragments below and above the plane; `None` if it does not divide them after all.
    fn partition(
        &self,
        fragments: &[Fragment],
        choice: &Choice,
        allowance: usize,
    ) -> Option<[Vec<Fragment>; 2]> {
        let Choice { axis, position, .. } = *choice;
        let [mut below, mut above] = choice
            .sides
            // A sample's count may be a little less than is there.
            .map(|(_, count)| Vec::with_capacity((count + count / 32) as usize));
        match choice.crossing {
            Crossing::Keep => {
                for fragment in fragments {
                    let side = if fragment.middle()[axis] < position {
                        &mut below
                    } else {
                        &mut above
                    };
                    side.push(*fragment);
                }
            }
            Crossing::Split => {
                let mut sides = choice.sides;
                let mut left = allowance;
                for fragment in fragments {
                    let extent = fragment.extent();
                    if extent.max[axis] <= position {
                        below.push(*fragment);
                    } else if extent.min[axis] >= position {
                        above.push(*fragment);
                    } else {
                        let keep = self.keeps_whole(&extent, &mut sides, left == 0);
                        if let Some(side) = keep {
                            [&mut below, &mut above][side].push(*fragment);
                            continue;
                        }
                        let Some(corners) = self.corners.of(fragment.triangle()) else {
                            below.push(*fragment);
                            continue;
                        };
                        let [a, b] = fragment.split(&corners, axis, position);
                        left -= usize::from(a.is_some() && b.is_some());
                        below.extend(a);
                        above.extend(b);
                    }
                }
            }
        }
        let count = fragments.len();
        let is_progress = below.len() < count || above.len() < count;
        let divides = is_progress && !below.is_empty() && !above.is_empty();
        divides.then_some([below, above])
    }

    /// Whether a fragment that the plane crosses costs less when it is kept whole, and on which side.
    fn keeps_whole(
        &self,
        extent: &Extent,
        sides: &mut [(Extent, u32); 2],
        must: bool,
    ) -> Option<usize> {
        let costs = &self.plan.costs;
        let [(a, na), (b, nb)] = *sides;
        let widened = |mut side: Extent| {
            side.grow(extent);
            side
        };
        let split = a.half_area() * costs.of(na) + b.half_area() * costs.of(nb);
        let in_a =
            widened(a).half_area() * costs.of(na) + b.half_area() * costs.of(nb.saturating_sub(1));
        let in_b =
            a.half_area() * costs.of(na.saturating_sub(1)) + widened(b).half_area() * costs.of(nb);
        if !must && split <= in_a.min(in_b) {
            return None;
        }
        let side = usize::from(in_b < in_a);
        sides[side].0 = widened(sides[side].0);
        sides[1 - side].1 = sides[1 - side].1.saturating_sub(1);
        Some(side)
    }
}

impl Cell {
    fn inner(extent: Extent, halves: [Self; 2], costs: &Costs) -> Self {
        let members = Members::union(&halves[0].members, &halves[1].members);
        let roots = Roots::of_halves(&extent, &halves, &members, costs);
        Self {
            extent,
            surface: halves[0].surface + halves[1].surface,
            content: Content::Inner(Box::new(halves)),
            roots,
            members,
        }
    }
}
