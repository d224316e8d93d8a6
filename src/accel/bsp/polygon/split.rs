//! Cutting a fragment by a plane, without rounding, concave fragments and those with holes included.
//!
//! Each half is made of the chains of corners that lie strictly on its side, closed along the line of the cut. A corner in the plane belongs to a
//! chain only as its end, so that an edge along the cut leaves no spike. Where several chains end on the line, they are put in order along it;
//! just beside the line, the polygon lies between each chain that leaves the half and the next that enters it.

use std::cmp::Ordering;

use super::fragment::{Corner, Edge, Fragment, Loop, Origin};
use crate::geometry::Triangle;
use crate::geometry::exact::{ExactPlane, Sign};

/// Where a polygon lies to a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placing {
    /// In front, or touching from there.
    Front,
    /// Behind, or touching from there.
    Back,
    /// In the plane.
    Coplanar,
    /// On both sides.
    Spanning,
}

/// A plane of the table, ready for quick questions.
pub(super) struct Cutter<'a> {
    pub(super) planes: &'a [ExactPlane],
    pub(super) number: u32,
    normal: glam::DVec3,
    error: f64,
    through: glam::Vec3,
}

impl<'a> Cutter<'a> {
    pub(super) fn new(planes: &'a [ExactPlane], number: u32) -> Self {
        let plane = &planes[number as usize];
        let (normal, error) = plane.normal();
        Self {
            planes,
            number,
            normal,
            error,
            through: plane.points()[0],
        }
    }

    fn plane(&self) -> &ExactPlane {
        &self.planes[self.number as usize]
    }

    /// The side of a corner, without rounding.
    pub(super) fn side(&self, corner: &Corner) -> Sign {
        corner
            .position
            .certain_side(self.normal, self.error, self.through)
            .unwrap_or_else(|| corner.origin.point(self.planes).side(self.plane()))
    }

    /// Where the fragment lies, without rounding.
    pub(super) fn place(&self, fragment: &Fragment) -> Placing {
        let (mut front, mut back) = (false, false);
        for corner in fragment.corners() {
            match self.side(corner) {
                Sign::Positive => front = true,
                Sign::Negative => back = true,
                Sign::Zero => {}
            }
            if front && back {
                return Placing::Spanning;
            }
        }
        match (front, back) {
            (true, _) => Placing::Front,
            (false, true) => Placing::Back,
            (false, false) => Placing::Coplanar,
        }
    }

    /// The halves of a fragment that lies on both sides: in front and behind.
    pub(super) fn split(
        &self,
        fragment: &Fragment,
        support: u32,
        triangle: impl Fn(u32) -> Triangle,
    ) -> [Fragment; 2] {
        let sides: Vec<Vec<Sign>> = fragment
            .loops
            .iter()
            .map(|l| l.iter().map(|c| self.side(c)).collect())
            .collect();
        [Sign::Positive, Sign::Negative].map(|side| Fragment {
            polygon: fragment.polygon,
            loops: self.half(&fragment.loops, &sides, support, side),
            triangles: fragment
                .triangles
                .iter()
                .copied()
                .filter(|&t| {
                    triangle(t)
                        .corners()
                        .iter()
                        .any(|&p| self.plane().side_of(p) == side)
                })
                .collect(),
            piece: None,
        })
    }

    /// Where the edge from this corner crosses the plane.
    fn crossing(&self, from: &Corner, edge: Edge, support: u32) -> Corner {
        let origin = match from.edge {
            Edge::Given(line) => Origin::OnLine(line, self.number),
            Edge::Cut(cut) => Origin::OfPlanes([support, cut, self.number]),
        };
        Corner::new(origin, edge, self.planes)
    }

    fn half(&self, loops: &[Loop], sides: &[Vec<Sign>], support: u32, wanted: Sign) -> Vec<Loop> {
        let cut = Edge::Cut(self.number);
        let mut whole = Vec::new();
        // Each chain begins and ends in the plane; the edge of its last corner lies there.
        let mut chains: Vec<Loop> = Vec::new();
        for (corners, sides) in loops.iter().zip(sides) {
            let n = corners.len();
            let Some(start) = (0..n).find(|&i| sides[i] != wanted) else {
                whole.push(corners.clone());
                continue;
            };
            let mut chain = Loop::new();
            for step in 1..=n {
                let (before, at) = ((start + step - 1) % n, (start + step) % n);
                let (was_in, is_in) = (sides[before] == wanted, sides[at] == wanted);
                if is_in {
                    if !was_in {
                        let entry = if sides[before] == Sign::Zero {
                            corners[before]
                        } else {
                            self.crossing(&corners[before], corners[before].edge, support)
                        };
                        chain.push(entry);
                    }
                    chain.push(corners[at]);
                } else if was_in {
                    let exit = if sides[at] == Sign::Zero {
                        Corner {
                            edge: cut,
                            ..corners[at]
                        }
                    } else {
                        self.crossing(&corners[before], cut, support)
                    };
                    chain.push(exit);
                    chains.push(std::mem::take(&mut chain));
                }
            }
        }
        whole.extend(self.close(chains, support, wanted));
        whole
    }

    /// Joins chains along the plane into loops.
    fn close(&self, mut chains: Vec<Loop>, support: u32, wanted: Sign) -> Vec<Loop> {
        let order = |a: &Corner, b: &Corner| {
            a.origin
                .point(self.planes)
                .compare(&b.origin.point(self.planes))
        };
        let mut follower = vec![0; chains.len()];
        if chains.len() > 1 {
            // The half lies to the left of the way along its cut edges: they go along the half's gradient x the polygon's normal.
            let ascends = self
                .plane()
                .direction_of_meeting(&self.planes[support as usize])
                == wanted;
            let along = |o: Ordering| if ascends { o } else { o.reverse() };
            let ends: Vec<Corner> = chains.iter().map(|c| c[c.len() - 1]).collect();
            let entries: Vec<Corner> = chains.iter().map(|c| c[0]).collect();
            let sorted = |corners: &[Corner]| {
                let mut numbers: Vec<usize> = (0..corners.len()).collect();
                numbers.sort_by(|&i, &j| along(order(&corners[i], &corners[j])));
                numbers
            };
            // The k-th that leaves goes on with the k-th that enters: between them lies the polygon.
            for (x, e) in sorted(&ends).into_iter().zip(sorted(&entries)) {
                follower[x] = e;
            }
        }
        let mut loops = Vec::new();
        let mut is_done = vec![false; chains.len()];
        for first in 0..chains.len() {
            let mut joined = Loop::new();
            let mut at = first;
            while !is_done[at] {
                is_done[at] = true;
                joined.append(&mut chains[at]);
                at = follower[at];
                // The end of a chain and the beginning of the next may be one point.
                let next = chains[at].first().or(joined.first()).copied();
                if let (Some(end), Some(next)) = (joined.last(), next)
                    && order(end, &next).is_eq()
                {
                    joined.pop();
                }
            }
            if joined.len() > 2 {
                loops.push(joined);
            }
        }
        loops
    }
}
