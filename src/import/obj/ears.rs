//! Cuts the ears of a polygon (crate `earcut`) and mends what it does to corners on straight lines.

use std::collections::HashMap;

use crate::geometry::tolerance::POLYGON_AREA_TOLERANCE;

/// Most corners of a polygon whose ears are cut. The time grows with the square for comb-like shapes: 27 s for 50,000
/// corners was measured, so that this keeps it near 10 s. Beyond, a polygon is fanned, and noted.
const MOST_EARS: usize = 1 << 15;

/// Corners of a polygon from which on the square of their number counts as work.
const MANY_EARS: usize = 512;

/// Most work for the polygons of a file, in squares of corners: that of 16 of the largest that are cut, a few minutes for combs. Files
/// of honest polygons stay far below: 17,000 of a thousand corners each. Beyond, polygons are fanned, and noted.
const MOST_WORK: usize = 1 << 34;

/// Cuts ears, reusing its memory.
#[derive(Default)]
pub(super) struct Ears {
    plane: Vec<[f64; 2]>,
    earcut: earcut::Earcut<f64>,
    refiner: earcut::Refiner,
    cut: Vec<u32>,
    work: usize,
}

impl Ears {
    /// Cuts a polygon given by its points, counter-clockwise about its own normal. Three indices of corners a triangle, or
    /// `None` if they do not cover the polygon.
    pub(super) fn cut(&mut self, points: &[[f64; 3]]) -> Option<&[u32]> {
        let count = points.len();
        if count > MANY_EARS && count <= MOST_EARS {
            self.work = self.work.saturating_add(count * count);
        }
        if count > MOST_EARS || self.work > MOST_WORK {
            return None;
        }
        if !earcut::utils3d::project3d_to_2d(points, count, &mut self.plane) {
            return None;
        }
        self.earcut.earcut_slice(&self.plane, &[], &mut self.cut);
        let area = |i: u32, j: u32, k: u32| {
            let [a, b, c] = [i, j, k].map(|i| self.plane[i as usize]);
            (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        };
        let whole: f64 = (1..count as u32 - 1).map(|i| area(0, i, i + 1)).sum();
        // The projection keeps the polygon counter-clockwise; ears may be cut the other way round.
        let mut covered = 0.0;
        for ear in self.cut.chunks_exact_mut(3) {
            let signed = area(ear[0], ear[1], ear[2]);
            if signed < 0.0 {
                ear.swap(1, 2);
            }
            covered += signed.abs();
        }
        let is_covered = (covered - whole).abs() <= POLYGON_AREA_TOLERANCE * whole.abs()
            && put_back_skipped(&mut self.cut, count as u32);
        if !is_covered {
            return None;
        }
        self.refiner.refine(&mut self.cut, &self.plane);
        Some(&self.cut)
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
