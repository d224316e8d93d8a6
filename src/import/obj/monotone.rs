//! Triangulates a polygon in its plane in O(n log n): a line sweeps down over it (Garey, Johnson, Preparata and Tarjan 1978; de Berg
//! et al., Computational Geometry, chapter 3).
//!
//! The line cuts the inside into regions, each right of an edge that leads down. In each lies a piece that is monotone, that is, has
//! one chain of corners at its left and one at its right; it is triangulated while it grows. Where two regions merge, both pieces
//! stay until the next corner of the region, which closes one of them. Units are those of the points; signs of areas are exact.
//!
//! Corners that lie on one another, as where a hole is joined to the outline, are told apart by `outline`. A polygon that crosses
//! itself gives nothing, or triangles that do not cover it: the caller looks.

use super::outline::Outline;
use super::status::Status;
use crate::geometry::exact::Sign;

/// A chain of a monotone piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

/// A monotone piece: the corners that still lack triangles, the upper first. All but the first are on one chain.
#[derive(Debug)]
struct Piece {
    waiting: Vec<u32>,
    side: Side,
}

/// What lies right of an edge that leads down.
#[derive(Debug)]
struct Region {
    left: Piece,
    /// After two regions merged: the right one's piece. Both end at the corner where they merged.
    right: Option<Piece>,
}

/// Triangles of a polygon, counter-clockwise, three corners each. `points` go round it counter-clockwise.
///
/// `None` if the polygon is found to cross itself.
pub(super) fn triangulate(points: &[[f64; 2]], triangles: &mut Vec<u32>) -> Option<()> {
    let count = points.len();
    triangles.clear();
    let outline = Outline { points };
    let order = outline.downwards()?;
    let mut rank = vec![0_u32; count];
    for (place, &corner) in (0..).zip(&order) {
        rank[corner as usize] = place;
    }
    let mut sweep = Sweep {
        outline,
        rank,
        status: Status::default(),
        regions: (0..count).map(|_| None).collect(),
        triangles,
    };
    order.into_iter().try_for_each(|corner| sweep.pass(corner))
}

struct Sweep<'p> {
    outline: Outline<'p>,
    /// The place of each corner in the order from above.
    rank: Vec<u32>,
    status: Status,
    /// Of each edge in the status, by its upper corner.
    regions: Vec<Option<Region>>,
    triangles: &'p mut Vec<u32>,
}

impl Sweep<'_> {
    /// The line passes a corner.
    fn pass(&mut self, corner: u32) -> Option<()> {
        let (before, after) = (self.outline.before(corner), self.outline.after(corner));
        let rank = |i: u32| self.rank[i as usize];
        let comes_from_above = rank(before) < rank(corner);
        let goes_down = rank(corner) < rank(after);
        let turn = self.outline.turn([before, corner, after]);
        let place = self
            .status
            .find(|edge| self.outline.is_right_of(corner, edge));
        match (comes_from_above, goes_down) {
            // A beginning, or the top of a gap.
            (false, true) if turn == Sign::Positive => {
                self.regions[corner as usize] = Some(Region::new(Piece::new(corner)));
                self.status.insert(place, corner);
            }
            (false, true) if turn == Sign::Negative => {
                let around = self.status.before(place)?;
                let (left, right) = self.split(around, corner)?;
                self.regions[around as usize] = Some(Region::new(left));
                self.regions[corner as usize] = Some(Region::new(right));
                self.status.insert(place, corner);
            }
            // The left side goes on.
            (true, true) => {
                self.status.replace(place, before, corner)?;
                let piece = self.close_left(before, corner)?;
                self.regions[corner as usize] = Some(Region::new(piece));
            }
            // The right side goes on.
            (false, false) => {
                let around = self.status.before(place)?;
                let piece = self.close_right(around, corner)?;
                self.regions[around as usize] = Some(Region::new(piece));
            }
            // An end, or the bottom of what stands between two regions.
            (true, false) if turn == Sign::Positive => {
                self.status.remove(place, before)?;
                let region = self.regions[before as usize].take()?;
                for piece in [Some(region.left), region.right].into_iter().flatten() {
                    self.fan(&piece, corner);
                }
            }
            (true, false) if turn == Sign::Negative => {
                let around = self.status.before(place)?;
                self.status.remove(place, before)?;
                let right = self.close_left(before, corner)?;
                let left = self.close_right(around, corner)?;
                self.regions[around as usize] = Some(Region {
                    left,
                    right: Some(right),
                });
            }
            // A spike without width.
            _ => return None,
        }
        Some(())
    }

    /// Adds a corner at the left of the region of `edge`. Gives the piece that goes on, the only one.
    fn close_left(&mut self, edge: u32, corner: u32) -> Option<Piece> {
        let region = self.regions[edge as usize].take()?;
        let mut going_on = region.left;
        if let Some(right) = region.right {
            self.fan(&going_on, corner);
            going_on = right;
        }
        self.add(&mut going_on, corner, Side::Left);
        Some(going_on)
    }

    /// Adds a corner at the right of the region of `edge`. Gives the piece that goes on, the only one.
    fn close_right(&mut self, edge: u32, corner: u32) -> Option<Piece> {
        let mut region = self.regions[edge as usize].take()?;
        if let Some(right) = region.right {
            self.fan(&right, corner);
        }
        self.add(&mut region.left, corner, Side::Right);
        Some(region.left)
    }

    /// Cuts the region of `edge` from its lowest corner to a corner within. Gives the pieces left and right of the cut.
    fn split(&mut self, edge: u32, corner: u32) -> Option<(Piece, Piece)> {
        let region = self.regions[edge as usize].take()?;
        let mut old = region.left;
        if let Some(mut right) = region.right {
            self.add(&mut old, corner, Side::Right);
            self.add(&mut right, corner, Side::Left);
            return Some((old, right));
        }
        let side = old.side;
        let mut new = Piece::new(*old.waiting.last()?);
        match side {
            // The lowest corner is on the left: what is left of the cut begins there.
            Side::Left => {
                self.add(&mut new, corner, Side::Right);
                self.add(&mut old, corner, Side::Left);
                Some((new, old))
            }
            Side::Right => {
                self.add(&mut new, corner, Side::Left);
                self.add(&mut old, corner, Side::Right);
                Some((old, new))
            }
        }
    }

    /// Adds a corner to a piece, and the triangles that lie between it and the corners above.
    fn add(&mut self, piece: &mut Piece, corner: u32, side: Side) {
        if piece.waiting.len() > 1 && piece.side != side {
            self.fan(piece, corner);
            let last = piece.waiting.len() - 1;
            piece.waiting.drain(..last);
        } else {
            while let [.., a, b] = piece.waiting[..] {
                let triangle = match side {
                    Side::Left => [a, b, corner],
                    Side::Right => [corner, b, a],
                };
                if !self.outline.is_ear(triangle) {
                    break;
                }
                self.triangles.extend(triangle);
                piece.waiting.pop();
            }
        }
        piece.waiting.push(corner);
        piece.side = side;
    }

    /// The triangles between a corner and all that wait on the other chain.
    fn fan(&mut self, piece: &Piece, corner: u32) {
        for pair in piece.waiting.windows(2) {
            self.triangles.extend(match piece.side {
                Side::Left => [pair[0], pair[1], corner],
                Side::Right => [corner, pair[1], pair[0]],
            });
        }
    }
}

impl Piece {
    fn new(top: u32) -> Self {
        Self {
            waiting: vec![top],
            side: Side::Left,
        }
    }
}

impl Region {
    fn new(left: Piece) -> Self {
        Self { left, right: None }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec2;

    use super::*;
    use crate::geometry::tolerance::POLYGON_AREA_TOLERANCE;

    fn area(points: &[[f64; 2]], triangle: &[u32]) -> f64 {
        let [a, b, c] = [0, 1, 2].map(|k| DVec2::from(points[triangle[k] as usize]));
        (b - a).perp_dot(c - a)
    }

    /// Whether the triangles cover a polygon and none faces the other way, also when it is turned.
    fn is_covered(points: &[[f64; 2]]) -> bool {
        (0..12).all(|turn| {
            // Quarter turns are exact; of the others, coordinates as files have them.
            let (sin, cos) = match turn {
                0 => (0.0, 1.0),
                1 => (1.0, 0.0),
                2 => (0.0, -1.0),
                3 => (-1.0, 0.0),
                _ => (libm::sin(f64::from(turn)), libm::cos(f64::from(turn))),
            };
            let turned = points.iter().map(|&[x, y]| {
                let turned = [x * cos - y * sin, x * sin + y * cos];
                turned.map(|c| f64::from(c as f32))
            });
            let points: Vec<[f64; 2]> = turned.collect();
            let mut triangles = Vec::new();
            let is_done = triangulate(&points, &mut triangles).is_some();
            let areas = || triangles.chunks_exact(3).map(|t| area(&points, t));
            let count = points.len() as u32;
            let whole: f64 = (1..count - 1).map(|i| area(&points, &[0, i, i + 1])).sum();
            is_done
                && triangles.len() == 3 * (points.len() - 2)
                && areas().all(|a| a >= -POLYGON_AREA_TOLERANCE * whole)
                && (areas().sum::<f64>() - whole).abs() <= POLYGON_AREA_TOLERANCE * whole
        })
    }

    #[test]
    fn stars_combs_and_spirals_are_covered() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        for count in [3, 4, 5, 8, 33, 1000] {
            let star: Vec<[f64; 2]> = (0..count)
                .map(|i| {
                    let (angle, radius) = (TAU * f64::from(i) / f64::from(count), 0.1 + random());
                    [radius * libm::cos(angle), 3.0 * radius * libm::sin(angle)]
                })
                .collect();
            assert!(is_covered(&star), "star of {count}");
        }
        let comb = (0..700).map(|i| {
            [
                f64::from(700 - i),
                if i % 4 < 2 { 90.0 } else { f64::from(i % 3) },
            ]
        });
        let comb: Vec<[f64; 2]> = [[0.0, -5.0], [701.0, -5.0]]
            .into_iter()
            .chain(comb)
            .collect();
        assert!(is_covered(&comb));
        let arm = |offset: f64| {
            (0..600).map(move |i| {
                let angle = f64::from(i) / 20.0;
                let radius = 5.0 + angle + offset;
                [radius * libm::cos(angle), radius * libm::sin(angle)]
            })
        };
        let spiral: Vec<[f64; 2]> = arm(3.0).chain(arm(0.0).rev()).collect();
        assert!(is_covered(&spiral));
    }

    #[test]
    fn corners_on_straight_lines_are_kept() {
        // A plate with three corners more on each side, and its neighbour with steps.
        let side = |from: [f64; 2], to: [f64; 2]| {
            (0..4).map(move |i| [0, 1].map(|k| from[k] + (to[k] - from[k]) * f64::from(i) / 4.0))
        };
        let corners = [
            [0.0, 0.0],
            [8.0, 0.0],
            [8.0, 4.0],
            [4.0, 4.0],
            [4.0, 8.0],
            [0.0, 8.0],
        ];
        let plate: Vec<[f64; 2]> = (0..6)
            .flat_map(|i| side(corners[i], corners[(i + 1) % 6]))
            .collect();
        for begin in 0..plate.len() {
            let mut plate = plate.clone();
            plate.rotate_left(begin);
            assert!(is_covered(&plate), "{begin}");
        }
    }

    #[test]
    fn crossings_and_spikes_do_no_harm() {
        let polygons: [&[[f64; 2]]; 4] = [
            &[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]],
            &[[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [2.0, 0.0], [1.0, 1.0]],
            &[[1.0, 1.0]; 5],
            &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]],
        ];
        for points in polygons {
            let mut triangles = Vec::new();
            let _ = triangulate(points, &mut triangles);
            assert!(triangles.len() <= 3 * points.len());
        }
        assert!(!is_covered(polygons[0]));
    }
}
