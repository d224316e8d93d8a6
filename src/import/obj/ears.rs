//! Cuts polygons in their plane: small ones by ears (crate `earcut`), others by a sweep, whose time does not grow with the square of
//! their corners. Mends what ears do to corners on straight lines.

use std::collections::HashMap;

use super::monotone;
use crate::geometry::tolerance::POLYGON_AREA_TOLERANCE;

/// Most corners of a polygon that is cut by ears at once. Below, they are as fast as the sweep.
const FEW_CORNERS: usize = 64;

/// Most work for ears of larger polygons, those of a file on which the sweep failed since they cross themselves: the sum of the
/// squares of their corners. 0.2 us for each was measured at worst (zigzags of 4,000 and 8,000 corners), and so 7 s for all. Beyond,
/// polygons are fanned, and noted.
const MOST_EARS: usize = 1 << 25;

/// Most work for making the triangles of large polygons of a file less thin, in the same measure. 2 ns for each were measured at worst
/// (parabolas of 10,000 and 100,000 corners), and so 17 s for all; a polygon of 90,000 corners is within. Beyond, it is done in groups.
const MOST_FLIPS: usize = 1 << 33;

/// Triangles of a group: 2 us a corner at worst. Those of polygons with more stay thin across the borders of their groups, and may have
/// no area where many corners are nearly on a line.
const FLIPPED_AT_ONCE: usize = 1024;

/// Cuts polygons, reusing its memory.
pub(super) struct Ears {
    plane: Vec<[f64; 2]>,
    earcut: earcut::Earcut<f64>,
    refiner: earcut::Refiner,
    cut: Vec<u32>,
    ears_left: usize,
    flips_left: usize,
}

impl Default for Ears {
    fn default() -> Self {
        Self {
            plane: Vec::new(),
            earcut: earcut::Earcut::default(),
            refiner: earcut::Refiner::default(),
            cut: Vec::new(),
            ears_left: MOST_EARS,
            flips_left: MOST_FLIPS,
        }
    }
}

impl Ears {
    /// Cuts a polygon given by its points, counter-clockwise about its own normal. Three indices of corners a triangle, or
    /// `None` if they do not cover the polygon.
    pub(super) fn cut(&mut self, points: &[[f64; 3]]) -> Option<&[u32]> {
        let count = points.len();
        let work = count.saturating_mul(count);
        if !earcut::utils3d::project3d_to_2d(points, count, &mut self.plane) {
            return None;
        }
        let is_swept = count > FEW_CORNERS
            && monotone::triangulate(&self.plane, &mut self.cut).is_some()
            && self.covers();
        if !is_swept {
            if count > FEW_CORNERS {
                self.ears_left = self.ears_left.checked_sub(work)?;
            }
            self.earcut.earcut_slice(&self.plane, &[], &mut self.cut);
            if !self.covers() || !put_back_skipped(&mut self.cut, count as u32) {
                return None;
            }
        }
        let flips_left = match count > FLIPPED_AT_ONCE {
            true => self.flips_left.checked_sub(work),
            false => Some(self.flips_left),
        };
        self.flips_left = flips_left.unwrap_or(self.flips_left);
        let at_once = if flips_left.is_some() {
            count
        } else {
            FLIPPED_AT_ONCE
        };
        for group in self.cut.chunks_mut(3 * at_once) {
            self.refiner.refine(group, &self.plane);
        }
        Some(&self.cut)
    }

    /// Whether the triangles cover the polygon. Makes all of them counter-clockwise, as the projection keeps the polygon; ears may
    /// be cut the other way round.
    fn covers(&mut self) -> bool {
        let area = |i: u32, j: u32, k: u32| {
            let [a, b, c] = [i, j, k].map(|i| self.plane[i as usize]);
            (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        };
        let count = self.plane.len() as u32;
        let whole: f64 = (1..count - 1).map(|i| area(0, i, i + 1)).sum();
        let mut covered = 0.0;
        for ear in self.cut.chunks_exact_mut(3) {
            let signed = area(ear[0], ear[1], ear[2]);
            if signed < 0.0 {
                ear.swap(1, 2);
            }
            covered += signed.abs();
        }
        (covered - whole).abs() <= POLYGON_AREA_TOLERANCE * whole.abs()
    }
}

/// Puts the corners that no triangle uses into the triangle at the straight line on which they lie. Whether there is a
/// place for every one, so that there are `count - 2` triangles.
fn put_back_skipped(cut: &mut Vec<u32>, count: u32) -> bool {
    if cut.len() as u32 == 3 * (count - 2) {
        return true;
    }
    let mut is_used = vec![false; count as usize];
    cut.iter().for_each(|&i| is_used[i as usize] = true);
    let Some(start) = is_used.iter().position(|&used| used) else {
        return false;
    };
    let mut triangle_at_edge: HashMap<(u32, u32), usize> = HashMap::new();
    let add = |map: &mut HashMap<(u32, u32), usize>, at: usize, [a, b, c]: [u32; 3]| {
        map.extend([((a, b), at), ((b, c), at), ((c, a), at)]);
    };
    for (at, t) in cut.chunks_exact(3).enumerate() {
        add(&mut triangle_at_edge, 3 * at, [t[0], t[1], t[2]]);
    }
    // Walk round once, from a used corner to the next used one.
    let mut from = start as u32;
    let mut skipped = Vec::new();
    for step in 1..=count {
        let corner = (start as u32 + step) % count;
        if !is_used[corner as usize] {
            skipped.push(corner);
            continue;
        }
        for &corner_between in &skipped {
            let Some(&at) = triangle_at_edge.get(&(from, corner)) else {
                return false;
            };
            let Some(third) = (0..3).find(|&i| cut[at + i] != from && cut[at + i] != corner) else {
                return false;
            };
            let apex = cut[at + third];
            cut[at..at + 3].copy_from_slice(&[from, corner_between, apex]);
            add(&mut triangle_at_edge, at, [from, corner_between, apex]);
            add(
                &mut triangle_at_edge,
                cut.len(),
                [corner_between, corner, apex],
            );
            cut.extend([corner_between, corner, apex]);
            from = corner_between;
        }
        skipped.clear();
        from = corner;
    }
    cut.len() as u32 == 3 * (count - 2)
}
