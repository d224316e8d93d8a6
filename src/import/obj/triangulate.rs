//! Polygons to triangles, in the space and units of the mesh, without losing a corner or a face.
//!
//! A polygon of n corners becomes n - 2 triangles on the same corners, so that it meets its neighbours at every vertex.
//! In this order:
//! - corners that repeat the one before are skipped (exporters write triangles as quads so);
//! - a quad is cut along the shorter diagonal that lies inside;
//! - if the fan from the first corner turns the same way everywhere, it is right, and taken;
//! - else ears are cut off (crate `earcut`) in the polygon's plane, or, where there are many corners, a line sweeps over it
//!   (`monotone`). Ears skip corners on straight lines, which are then put back into the triangle beside them, and the triangles
//!   are made Delaunay: three corners on a line can be an ear too, which only flipping its edge gets rid of;
//! - where that does not cover the polygon's area, because it crosses itself or has no plane, the fan is taken after all:
//!   the format does not say what such a polygon looks like, and so nothing of it is lost.

use glam::{DVec3, Vec3};

use super::ears::Ears;
use crate::geometry::tolerance::COORDINATE_LIMIT;

/// Triangulates polygons, reusing its memory.
#[derive(Default)]
pub(super) struct Triangulator {
    corners: Vec<u32>,
    points: Vec<[f64; 3]>,
    ears: Ears,
}

/// What became of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// Its triangles cover it.
    Covered,
    /// It crosses itself or has no plane; it became a fan.
    Fanned,
}

impl Triangulator {
    /// The corners of the last polygon without those that repeat the one before.
    pub(super) fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Adds the triangles of a polygon of at least 3 vertices to `triangles`.
    pub(super) fn polygon(
        &mut self,
        polygon: &[u32],
        positions: &[Vec3],
        triangles: &mut Vec<[u32; 3]>,
    ) -> Outcome {
        let at = |v: u32| positions[v as usize];
        self.corners.clear();
        self.corners.extend_from_slice(polygon);
        self.corners.dedup_by(|b, a| at(*a) == at(*b));
        while let [first, .., last] = self.corners[..]
            && at(first) == at(last)
            && self.corners.len() > 1
        {
            self.corners.pop();
        }
        if self.corners.len() < 3 {
            // One point or one line: kept as read, to be counted and dropped with the other triangles without area.
            self.corners.clear();
            self.corners.extend_from_slice(polygon);
            return fan(&self.corners, 0, triangles, Outcome::Fanned);
        }
        if let [a, b, c] = self.corners[..] {
            triangles.push([a, b, c]);
            return Outcome::Covered;
        }
        let is_usable = |p: Vec3| p.is_finite() && p.abs().max_element() <= COORDINATE_LIMIT;
        if let Some(broken) = self.corners.iter().position(|&v| !is_usable(at(v))) {
            // Every triangle gets the broken corner: the polygon goes as a whole.
            return fan(&self.corners, broken, triangles, Outcome::Covered);
        }
        let origin = at(self.corners[0]).as_dvec3();
        let point = |v: u32| at(v).as_dvec3() - origin;
        if let [a, b, c, d] = self.corners[..]
            && let Some(halves) = quad([a, b, c, d].map(point), [a, b, c, d])
        {
            triangles.extend(halves);
            return Outcome::Covered;
        }
        self.points.clear();
        self.points
            .extend(self.corners.iter().map(|&v| point(v).to_array()));
        let normal = newell_normal(&self.points);
        if self.corners.len() > 4 && is_fan(&self.points, normal) {
            return fan(&self.corners, 0, triangles, Outcome::Covered);
        }
        let Some(ears) = self.ears.cut(&self.points) else {
            return fan(&self.corners, 0, triangles, Outcome::Fanned);
        };
        let corners = &self.corners;
        triangles.extend(
            ears.chunks_exact(3)
                .map(|t| [t[0], t[1], t[2]].map(|i| corners[i as usize])),
        );
        Outcome::Covered
    }
}

/// Twice the area along the normal, by Newell's sum.
fn newell_normal(points: &[[f64; 3]]) -> DVec3 {
    let mut previous = points
        .last()
        .copied()
        .map_or(DVec3::ZERO, DVec3::from_array);
    points.iter().fold(DVec3::ZERO, |sum, &point| {
        let point = DVec3::from_array(point);
        sum + std::mem::replace(&mut previous, point).cross(point)
    })
}

/// Whether every triangle of the fan from the first corner turns as the polygon does.
fn is_fan(points: &[[f64; 3]], normal: DVec3) -> bool {
    // The first corner is the origin.
    points[1..].windows(2).all(|p| {
        DVec3::from_array(p[0])
            .cross(DVec3::from_array(p[1]))
            .dot(normal)
            > 0.0
    })
}

fn fan(corners: &[u32], apex: usize, triangles: &mut Vec<[u32; 3]>, outcome: Outcome) -> Outcome {
    let corner = |i: usize| corners[(apex + i) % corners.len()];
    triangles.extend((1..corners.len() - 1).map(|i| [corner(0), corner(i), corner(i + 1)]));
    outcome
}

/// The halves of a quad along the shorter of the diagonals that lie inside; the one from the first corner if they are as
/// long. `None` if none does.
fn quad([a, b, c, d]: [DVec3; 4], corners: [u32; 4]) -> Option<[[u32; 3]; 2]> {
    // The diagonals' product is Newell's sum for four corners.
    let normal = (c - a).cross(d - b);
    let turns = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) > 0.0;
    let along_ac = turns(a, b, c) && turns(a, c, d);
    let along_bd = turns(a, b, d) && turns(b, c, d);
    let bd_is_shorter = (d - b).length_squared() < (c - a).length_squared();
    let [a, b, c, d] = corners;
    match (along_ac, along_bd) {
        (false, false) => None,
        (true, true) if !bd_is_shorter => Some([[a, b, c], [a, c, d]]),
        (true, false) => Some([[a, b, c], [a, c, d]]),
        _ => Some([[a, b, d], [b, c, d]]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangulate(points: &[[f32; 3]]) -> (Vec<[u32; 3]>, Outcome) {
        let positions: Vec<Vec3> = points.iter().map(|&p| Vec3::from_array(p)).collect();
        let polygon: Vec<u32> = (0..points.len() as u32).collect();
        let mut triangles = Vec::new();
        let outcome = Triangulator::default().polygon(&polygon, &positions, &mut triangles);
        (triangles, outcome)
    }

    /// Twice the area of the triangles along the polygon's normal, and of the polygon; none may turn the other way.
    fn areas(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> (f64, f64) {
        let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
        let normal = newell_normal(&points);
        let unit = normal.normalize();
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| DVec3::from_array(points[i as usize]));
            (b - a).cross(c - a).dot(unit)
        };
        assert!(triangles.iter().all(|t| area(t) > 0.0), "{triangles:?}");
        (triangles.iter().map(area).sum(), normal.length())
    }

    fn tilted(points: &[[f32; 2]]) -> Vec<[f32; 3]> {
        points
            .iter()
            .map(|&[x, y]| [x - 0.5 * y, 2.0 * y, 3.0 * x + y])
            .collect()
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        let dart = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 3.0]];
        let comb = [
            [0.0, 0.0],
            [7.0, 0.0],
            [7.0, 4.0],
            [6.0, 4.0],
            [6.0, 1.0],
            [4.0, 1.0],
            [4.0, 5.0],
            [3.0, 5.0],
            [3.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        for shape in [&dart[..], &comb[..]] {
            for turn in 0..shape.len() {
                let mut shape = shape.to_vec();
                shape.rotate_left(turn);
                for points in [
                    tilted(&shape),
                    shape.iter().rev().map(|p| [p[0], p[1], 7.0]).collect(),
                ] {
                    let (triangles, outcome) = triangulate(&points);
                    assert_eq!(
                        (triangles.len(), outcome),
                        (shape.len() - 2, Outcome::Covered)
                    );
                    let (covered, whole) = areas(&points, &triangles);
                    assert!((covered - whole).abs() < 1e-6 * whole);
                }
            }
        }
    }

    #[test]
    fn corners_on_a_straight_line_are_kept() {
        let shape = [
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [5.0, 0.0],
            [5.0, 1.0],
            [5.0, 3.0],
            [2.0, 3.0],
            [0.0, 3.0],
            [0.0, 2.0],
        ];
        for turn in 0..shape.len() {
            let mut shape = shape.to_vec();
            shape.rotate_left(turn);
            let points: Vec<[f32; 3]> = shape.iter().map(|p| [p[0], p[1], 0.0]).collect();
            let (triangles, outcome) = triangulate(&points);
            assert_eq!(
                (triangles.len(), outcome),
                (shape.len() - 2, Outcome::Covered),
                "{turn}"
            );
            let used: std::collections::BTreeSet<u32> =
                triangles.iter().flatten().copied().collect();
            assert_eq!(used.len(), shape.len());
            assert!((areas(&points, &triangles).0 - 30.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_quad_is_cut_along_its_shorter_diagonal() {
        let kite = |x: f32| {
            [
                [0.0, 0.0, 0.0],
                [x, -1.0, 0.0],
                [6.0, 0.0, 0.0],
                [x, 1.0, 0.0],
            ]
        };
        assert_eq!(triangulate(&kite(3.0)).0, [[0, 1, 3], [1, 2, 3]]);
        let flat = [
            [0.0, 0.0, 0.0],
            [3.0, -9.0, 0.0],
            [6.0, 0.0, 0.0],
            [3.0, 9.0, 0.0],
        ];
        assert_eq!(triangulate(&flat).0, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn repeated_corners_vanish() {
        let square = [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let [a, b, c, d] = square;
        assert_eq!(triangulate(&[a, b, c, c]).0.len(), 1);
        assert_eq!(triangulate(&[a, a, b, c, d, d, a]).0.len(), 2);
        assert_eq!(triangulate(&[a, a, b, b]).0.len(), 2);
        assert_eq!(triangulate(&[a, a, a, a]).0.len(), 2);
    }

    #[test]
    fn what_cannot_be_covered_becomes_a_fan() {
        let bow_tie = [
            [0.0, 0.0, 0.0],
            [2.0, 2.0, 0.0],
            [2.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
        ];
        assert_eq!(
            triangulate(&bow_tie),
            (vec![[0, 1, 2], [0, 2, 3]], Outcome::Fanned)
        );
        let line: Vec<[f32; 3]> = (0..5).map(|i| [i as f32, 2.0 * i as f32, 0.0]).collect();
        assert_eq!(triangulate(&line).0.len(), 3);
        let square = [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let thrice: Vec<[f32; 3]> = square.iter().cycle().take(12).copied().collect();
        assert_eq!(triangulate(&thrice).0.len(), 10);
    }

    #[test]
    fn every_triangle_of_a_polygon_has_its_broken_corner() {
        let mut points = vec![
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [3.0, 1.0, 0.0],
            [2.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
        ];
        points[3][1] = f32::NAN;
        let (triangles, _) = triangulate(&points);
        assert!(triangles.len() == 3 && triangles.iter().all(|t| t.contains(&3)));
    }
}
