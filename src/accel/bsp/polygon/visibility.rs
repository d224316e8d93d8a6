//! The order in which an eye sees the fragments: the nearer side of each plane first, as Fuchs, Kedem, Naylor 1980 have it.
//!
//! The lecture follows "always the left child", which holds only where the eye is in front of every plane. Here each node asks on which
//! side of its plane the eye is.

use glam::DVec3;

use super::tree::PolygonBsp;
use crate::geometry::exact::Sign;

/// A fragment as an eye sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Its number.
    pub fragment: u32,
    /// Whether the eye is behind the fragment's plane, or in it: where faces are drawn from the front only, it is never drawn.
    pub faces_away: bool,
}

impl PolygonBsp {
    /// All fragments, so that none hides one that comes before it.
    pub fn front_to_back(&self, eye: DVec3) -> Vec<Seen> {
        let mut seen = Vec::with_capacity(self.fragments.len());
        let mut stack = Vec::new();
        let mut at = (!self.nodes.is_empty()).then_some(0);
        loop {
            while let Some(node) = at {
                let n = &self.nodes[node as usize];
                let is_in_front = n
                    .plane()
                    .is_some_and(|p| self.side_of_eye(p, eye) == Sign::Positive);
                let (near, far) = if is_in_front {
                    (n.front(), n.back())
                } else {
                    (n.back(), n.front())
                };
                stack.push((node, far));
                at = near;
            }
            let Some((node, far)) = stack.pop() else {
                return seen;
            };
            seen.extend(self.nodes[node as usize].fragments().map(|fragment| {
                let polygon = self.fragments[fragment as usize].polygon;
                let plane = self.polygons[polygon as usize].plane;
                Seen {
                    fragment,
                    faces_away: self.side_of_eye(plane, eye) != Sign::Positive,
                }
            }));
            at = far;
        }
    }

    /// The painter's order: all fragments, so that none is hidden by one that comes before it.
    pub fn back_to_front(&self, eye: DVec3) -> Vec<Seen> {
        let mut seen = self.front_to_back(eye);
        seen.reverse();
        seen
    }

    /// Exact for an eye of single precision; else in double precision, where an eye in doubt is in the plane.
    fn side_of_eye(&self, plane: u32, eye: DVec3) -> Sign {
        let plane = &self.planes[plane as usize];
        if eye.as_vec3().as_dvec3().cmpeq(eye).all() {
            return plane.side_of(eye.as_vec3());
        }
        let (normal, error) = plane.normal();
        let position = crate::geometry::exact::Position {
            point: eye,
            error: 0.0,
        };
        position
            .certain_side(normal, error, plane.points()[0])
            .unwrap_or(Sign::Zero)
    }
}
