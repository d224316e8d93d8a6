//! Fragments: the part of a triangle that lies in a cell, known by its extent.
//!
//! Only the extent is kept. A fragment that is split again is cut afresh from its triangle, so that errors do not add up
//! over the levels of the tree. In the units and the space of the tree.

use glam::Vec4;

use crate::geometry::tolerance::{CUT_ERROR_BY_PLACE, CUT_ERROR_BY_SIZE};

/// An extent: the least and greatest coordinates of a point cluster, the corners of a cell's fragments. The fourth lanes mean nothing.
///
/// No [`PointCluster`](crate::accel::extents::PointCluster): that finds hulls, which pay for points that are transformed again and again, and a box has no use for one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) min: Vec4,
    pub(super) max: Vec4,
}

impl Extent {
    pub(super) const EMPTY: Self = Self {
        min: Vec4::INFINITY,
        max: Vec4::NEG_INFINITY,
    };

    #[inline(always)]
    pub(super) fn grow(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    #[inline(always)]
    pub(super) fn grow_point(&mut self, point: Vec4) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }

    /// Half the area of the box's faces; 0 if it is empty.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let e = (self.max - self.min).max(Vec4::ZERO);
        e.x * (e.y + e.z) + e.y * e.z
    }
}

/// The part of a triangle within a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fragment {
    /// Its fourth lane holds the triangle's number.
    min: Vec4,
    max: Vec4,
}

impl Fragment {
    pub(super) fn new(extent: Extent, triangle: u32) -> Self {
        let mut min = extent.min;
        min.w = f32::from_bits(triangle);
        Self {
            min,
            max: extent.max,
        }
    }

    #[inline(always)]
    pub(super) fn triangle(&self) -> u32 {
        self.min.w.to_bits()
    }

    #[inline(always)]
    pub(super) fn extent(&self) -> Extent {
        Extent {
            min: self.min,
            max: self.max,
        }
    }

    /// Twice the middle of the extent.
    #[inline(always)]
    pub(super) fn middle(&self) -> Vec4 {
        self.min + self.max
    }

    /// The two parts on either side of the plane where the coordinate `axis` is `position`: below, then above. A side that it
    /// only touches may be `None`, never both.
    ///
    /// Every point of the triangle within the fragment's extent lies in one of the parts' extents.
    pub(super) fn split(
        &self,
        corners: &[Vec4; 3],
        axis: usize,
        position: f32,
    ) -> [Option<Self>; 2] {
        let [mut below, mut above] = [self.extent(); 2];
        below.max[axis] = position;
        above.min[axis] = position;
        let parts = [below, above]
            .map(|side| clipped(corners, &side).map(|e| Self::new(e, self.triangle())));
        if parts[0].is_none() && parts[1].is_none() {
            // Rounding lost it: keep it whole.
            return [Some(*self), None];
        }
        parts
    }
}

/// The extent of the part of a triangle within `cell`, at most `cell` itself.
///
/// Cuts move points by rounding; so the cell is widened by as much before cutting, and the result after, and every point of the
/// true part is inside.
fn clipped(corners: &[Vec4; 3], cell: &Extent) -> Option<Extent> {
    let [a, b, c] = *corners;
    let size = (a.max(b).max(c) - a.min(b).min(c)).truncate().max_element();
    let place = a.abs().max(b.abs()).max(c.abs()).truncate().max_element();
    let slack =
        Vec4::splat(CUT_ERROR_BY_SIZE * size + CUT_ERROR_BY_PLACE * place + f32::MIN_POSITIVE);
    let (low, high) = (cell.min - slack, cell.max + slack);
    let mut polygon = [Vec4::ZERO; 10];
    polygon[..3].copy_from_slice(corners);
    let mut count = 3;
    for axis in 0..3 {
        for (limit, sign) in [(low[axis], 1.0), (high[axis], -1.0)] {
            let inside = |p: &Vec4| (p[axis] - limit) * sign;
            if polygon[..count].iter().all(|p| inside(p) >= 0.0) {
                continue;
            }
            let mut cut = [Vec4::ZERO; 10];
            let mut kept = 0;
            let mut previous = polygon[count - 1];
            let mut before = inside(&previous);
            for &point in &polygon[..count] {
                let here = inside(&point);
                if (before < 0.0) != (here < 0.0) && kept < 10 {
                    let mut crossing = previous + (point - previous) * (before / (before - here));
                    crossing[axis] = limit;
                    cut[kept] = crossing;
                    kept += 1;
                }
                if here >= 0.0 && kept < 10 {
                    cut[kept] = point;
                    kept += 1;
                }
                (previous, before) = (point, here);
            }
            if kept == 0 {
                return None;
            }
            (polygon, count) = (cut, kept);
        }
    }
    let mut extent = Extent::EMPTY;
    polygon[..count].iter().for_each(|&p| extent.grow_point(p));
    Some(Extent {
        min: (extent.min - slack).max(cell.min),
        max: (extent.max + slack).min(cell.max),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fragment(corners: &[Vec4; 3]) -> Fragment {
        let mut extent = Extent::EMPTY;
        corners.iter().for_each(|&p| extent.grow_point(p));
        Fragment::new(extent, 7)
    }

    #[test]
    fn parts_are_cut_from_the_triangle_and_not_from_the_box() {
        let corners = [
            Vec4::ZERO,
            Vec4::new(4.0, 0.0, 0.0, 0.0),
            Vec4::new(0.0, 2.0, 1.0, 0.0),
        ];
        let whole = fragment(&corners);
        let [below, above] = whole.split(&corners, 0, 3.0).map(Option::unwrap);
        assert_eq!((below.triangle(), above.triangle()), (7, 7));
        assert_eq!((below.max.x, above.min.x), (3.0, 3.0));
        // Widened before and after the cut.
        let slack = 4.0 * (CUT_ERROR_BY_SIZE + CUT_ERROR_BY_PLACE);
        let is_close = |x: f32, truth: f32| truth <= x && x - truth <= 2.0 * slack;
        assert!(is_close(above.max.y, 0.5) && is_close(above.max.z, 0.25));
        assert_eq!(below.max.y, 2.0);
        let [left, right] = above.split(&corners, 1, 0.25).map(Option::unwrap);
        assert_eq!((left.min.x, left.max.x), (3.0, 4.0));
        assert!((right.max.x - 3.5).abs() <= 4.0 * slack);
    }

    #[test]
    fn a_part_that_is_only_touched_is_no_part() {
        let corners = [
            Vec4::ZERO,
            Vec4::new(1.0, 0.0, 0.0, 0.0),
            Vec4::new(0.0, 1.0, 0.0, 0.0),
        ];
        let mut high = fragment(&corners);
        high.max.x = 3.0;
        high.max.y = 3.0;
        let parts = high.split(&corners, 0, 2.0);
        assert!(parts[0].is_some() && parts[1].is_none());
    }
}
