//! The choice of the plane that divides a cell: candidates along the axes, and what each would cost.
//!
//! The cost is that of the surface area heuristic (MacDonald and Booth 1990), with the areas of the *extents of the fragments* on
//! each side, not of the cells, since the extents are what a ray is tested against. Candidates are the borders of bins (Wald 2007).
//! Polygons that a plane crosses are split by it, or all kept whole on the side of their middle: the choice of spatial and
//! object splits of Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009.

use glam::{IVec4, Vec4};

use super::fragment::{Extent, Fragment};
use super::sample::Sample;

/// How much dearer a split may seem than keeping fragments whole. Halves of a split do not overlap, which the cost does not see: with 1.05
/// instead of 1 a fifth more memory, and Sponza (from inside) 7 % faster; with 1.1 half as much again, and nothing is faster.
const SPLIT_PREFERENCE: f32 = 1.05;

/// Bins an axis at most.
pub(super) const MOST_BINS: usize = 32;

/// What steps of a traversal cost, in units of one node's test of its children.
#[derive(Clone, Copy, Debug)]
pub(super) struct Costs {
    /// One division into two.
    pub(super) step: f32,
    /// A leaf, however large.
    pub(super) leaf: f32,
    /// One block of up to eight triangles, with however many in it.
    pub(super) block: f32,
    /// Each triangle of a block.
    pub(super) triangle: f32,
}

impl Costs {
    /// Of a leaf of so many triangles.
    pub(super) fn leaf(&self, count: usize) -> f32 {
        self.leaf + self.block * count.div_ceil(8) as f32 + self.triangle * count as f32
    }

    /// Of so many fragments, by blocks that are not counted out yet.
    #[inline(always)]
    pub(super) fn of(&self, count: u32) -> f32 {
        let count = count as f32;
        self.block * (count * 0.125).max(0.7) + self.triangle * count
    }
}

/// What becomes of the fragments that the plane crosses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crossing {
    /// They are split.
    Split,
    /// They go whole to the side of their middle.
    Keep,
}

/// The best of the candidates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    pub(super) axis: usize,
    /// Coordinate of the plane; if fragments are kept whole, that of twice their middle.
    pub(super) position: f32,
    pub(super) crossing: Crossing,
    /// Relative to the area of the node.
    pub(super) cost: f32,
    /// Extents and counts on both sides.
    pub(super) sides: [(Extent, u32); 2],
}

/// A bin: what begins and what ends in it, and the extent of what is in it.
#[derive(Clone, Copy)]
struct Bin {
    extent: Extent,
    begins: u32,
    ends: u32,
}

const NO_BIN: Bin = Bin {
    extent: Extent::EMPTY,
    begins: 0,
    ends: 0,
};

/// A division of a box into bins along all three axes.
struct Grid {
    origin: Vec4,
    per_unit: Vec4,
    width: Vec4,
    last: IVec4,
}

impl Grid {
    fn new(extent: &Extent, bins: usize) -> Self {
        let size = extent.max - extent.min;
        let per_unit = (Vec4::splat(bins as f32) / size).map_finite();
        Self {
            origin: extent.min,
            per_unit,
            width: size / bins as f32,
            last: IVec4::splat(bins as i32 - 1),
        }
    }

    #[inline(always)]
    fn bin(&self, point: Vec4) -> IVec4 {
        ((point - self.origin) * self.per_unit)
            .as_ivec4()
            .clamp(IVec4::ZERO, self.last)
    }

    fn border(&self, axis: usize, bin: usize) -> f32 {
        self.origin[axis] + self.width[axis] * bin as f32
    }
}

trait MapFinite {
    /// Zero for lanes that are not finite.
    fn map_finite(self) -> Self;
}

impl MapFinite for Vec4 {
    fn map_finite(self) -> Self {
        Vec4::select(self.is_finite_mask(), self, Vec4::ZERO)
    }
}

/// The cheapest plane for these fragments, if there is any that divides them. `middles` bounds twice their middles.
pub(super) fn choose(
    fragments: &[Fragment],
    extent: &Extent,
    middles: &Extent,
    costs: &Costs,
    bins: usize,
    may_split: bool,
) -> Option<Choice> {
    let sample = Sample::of(fragments);
    let choice = choose_among(&sample, extent, middles, costs, bins, may_split);
    // Counts as among all.
    let every = sample.every() as u32;
    choice.map(|choice| Choice {
        sides: choice.sides.map(|(extent, count)| (extent, count * every)),
        ..choice
    })
}

pub(super) fn choose_among(
    fragments: &Sample<'_>,
    extent: &Extent,
    middles: &Extent,
    costs: &Costs,
    bins: usize,
    may_split: bool,
) -> Option<Choice> {
    let area = extent.half_area();
    let kept = best_kept(fragments, middles, costs, bins, area);
    if !may_split {
        return kept;
    }
    if let Some(kept) = &kept {
        // Where the halves do not overlap, splitting gains nothing.
        let [(a, _), (b, _)] = &kept.sides;
        let overlap = Extent {
            min: a.min.max(b.min),
            max: a.max.min(b.max),
        };
        let size = overlap.max - overlap.min;
        if size.x < 0.0 || size.y < 0.0 || size.z < 0.0 {
            return Some(*kept);
        }
    }
    let split = best_split(fragments, extent, costs, bins, area);
    match (kept, split) {
        (Some(kept), Some(split)) => Some(if split.cost < kept.cost * SPLIT_PREFERENCE {
            split
        } else {
            kept
        }),
        (kept, split) => kept.or(split),
    }
}

fn best_kept(
    fragments: &Sample<'_>,
    middles: &Extent,
    costs: &Costs,
    bins: usize,
    area: f32,
) -> Option<Choice> {
    let grid = Grid::new(middles, bins);
    let mut table = [[NO_BIN; MOST_BINS]; 3];
    fragments.for_each(|fragment| {
        let bin = grid.bin(fragment.middle());
        let extent = fragment.extent();
        for axis in 0..3 {
            let bin = &mut table[axis][bin[axis] as usize];
            bin.extent.grow(&extent);
            bin.begins += 1;
            bin.ends += 1;
        }
    });
    sweep(
        &table,
        &grid,
        costs,
        bins,
        area,
        Crossing::Keep,
        fragments.count(),
    )
}

fn best_split(
    fragments: &Sample<'_>,
    extent: &Extent,
    costs: &Costs,
    bins: usize,
    area: f32,
) -> Option<Choice> {
    let grid = Grid::new(extent, bins);
    let mut table = [[NO_BIN; MOST_BINS]; 3];
    fragments.for_each(|fragment| {
        let whole = fragment.extent();
        let (first, last) = (grid.bin(whole.min), grid.bin(whole.max));
        for axis in 0..3 {
            let (first, last) = (first[axis] as usize, last[axis] as usize);
            let row = &mut table[axis];
            row[first].begins += 1;
            row[last].ends += 1;
            if first == last {
                row[first].extent.grow(&whole);
                continue;
            }
            for (bin, cell) in row.iter_mut().enumerate().take(last + 1).skip(first) {
                let mut part = whole;
                part.min[axis] = part.min[axis].max(grid.border(axis, bin));
                part.max[axis] = part.max[axis].min(grid.border(axis, bin + 1));
                cell.extent.grow(&part);
            }
        }
    });
    sweep(
        &table,
        &grid,
        costs,
        bins,
        area,
        Crossing::Split,
        fragments.count(),
    )
}

/// The cheapest border between bins.
fn sweep(
    table: &[[Bin; MOST_BINS]; 3],
    grid: &Grid,
    costs: &Costs,
    bins: usize,
    area: f32,
    crossing: Crossing,
    total: u32,
) -> Option<Choice> {
    let mut best: Option<Choice> = None;
    let mut best_sum = f32::INFINITY;
    for (axis, row) in table.iter().enumerate() {
        if grid.per_unit[axis] <= 0.0 {
            continue;
        }
        let mut above = [(Extent::EMPTY, 0); MOST_BINS];
        let mut side = (Extent::EMPTY, 0);
        for bin in (1..bins).rev() {
            side.0.grow(&row[bin].extent);
            side.1 += row[bin].ends;
            above[bin] = side;
        }
        let mut below = (Extent::EMPTY, 0);
        for bin in 1..bins {
            below.0.grow(&row[bin - 1].extent);
            below.1 += row[bin - 1].begins;
            let above = above[bin];
            if below.1 == 0 || above.1 == 0 || (below.1 == total && above.1 == total) {
                continue;
            }
            let sum =
                below.0.half_area() * costs.of(below.1) + above.0.half_area() * costs.of(above.1);
            if sum < best_sum {
                best_sum = sum;
                best = Some(Choice {
                    axis,
                    position: grid.border(axis, bin),
                    crossing,
                    cost: costs.step + sum / area,
                    sides: [below, above],
                });
            }
        }
    }
    best
}
