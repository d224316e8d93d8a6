//! The outline of a polygon in its plane, and what a line that sweeps down over it asks of its corners.
//!
//! Corners of equal height are taken from left to right, as if the line were tilted a little more. Exporters join holes to the outline by
//! edges that are walked to and fro, so that corners lie on one another, which has no order: they are taken as if each were moved
//! into the inside by less than all else, which opens the joints. Signs of areas are exact; those of moved corners are not.

use std::cmp::Ordering;

use glam::DVec2;

use crate::geometry::exact::{Sign, side_of_line};

/// How much the sweeping line is tilted: a corner's height is y plus this times x. Models have many corners of one y, or of one x, and
/// between three that the line meets at once there would be triangles without area. Of few bits, so that heights are exact, or nearly.
const SLOPE: f64 = 9.0 / 32.0;

/// Corners, counter-clockwise; a corner's edge leads to the next.
pub(super) struct Outline<'p> {
    pub(super) points: &'p [[f64; 2]],
}

impl Outline<'_> {
    /// Which way a triangle turns: positive counter-clockwise.
    pub(super) fn turn(&self, [a, b, c]: [u32; 3]) -> Sign {
        side_of_line([self.at(a), self.at(b)], self.at(c))
    }

    /// The corner before.
    pub(super) fn before(&self, corner: u32) -> u32 {
        corner
            .checked_sub(1)
            .unwrap_or(self.points.len() as u32 - 1)
    }

    /// The corner after.
    pub(super) fn after(&self, corner: u32) -> u32 {
        (corner + 1) % self.points.len() as u32
    }

    fn at(&self, corner: u32) -> DVec2 {
        self.points[corner as usize].into()
    }

    /// Where a corner is moved: to the left of the way that the outline takes there.
    fn inwards(&self, corner: u32) -> DVec2 {
        let [before, at, after] =
            [self.before(corner), corner, self.after(corner)].map(|i| self.at(i));
        ((at - before).normalize_or_zero() + (after - at).normalize_or_zero()).perp()
    }

    /// All corners from above downwards. `None` if one has no place.
    pub(super) fn downwards(&self) -> Option<Vec<u32>> {
        // Without numbers that are none there is an order.
        if !self.points.as_flattened().iter().all(|c| c.is_finite()) {
            return None;
        }
        let height = |a: DVec2| a.y + a.x * SLOPE;
        let compare = |a: DVec2, b: DVec2| {
            let down = height(b).partial_cmp(&height(a));
            let right = a.x.partial_cmp(&b.x);
            down.unwrap_or(Ordering::Equal)
                .then(right.unwrap_or(Ordering::Equal))
        };
        let mut order: Vec<u32> = (0..self.points.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| {
            compare(self.at(a), self.at(b))
                .then_with(|| compare(self.inwards(a), self.inwards(b)))
                .then(a.cmp(&b))
        });
        Some(order)
    }

    /// Whether a triangle is counter-clockwise after all corners were moved a little inwards.
    fn is_left_turn_when_moved(&self, triangle: [u32; 3]) -> bool {
        match self.turn(triangle) {
            Sign::Positive => true,
            Sign::Negative => false,
            Sign::Zero => {
                // How fast its area grows while they move.
                let [a, b, c] = triangle.map(|i| self.at(i));
                let [va, vb, vc] = triangle.map(|i| self.inwards(i));
                (vb - va).perp_dot(c - a) + (b - a).perp_dot(vc - va) > 0.0
            }
        }
    }

    /// Whether a corner lies right of an edge that leads down, that is, left of its direction.
    pub(super) fn is_right_of(&self, corner: u32, edge: u32) -> bool {
        let end = self.after(edge);
        end != corner && self.is_left_turn_when_moved([edge, end, corner])
    }

    /// Whether a triangle can be cut off. One without area cannot, except where corners lie on one another.
    pub(super) fn is_ear(&self, triangle: [u32; 3]) -> bool {
        let [a, b, c] = triangle.map(|i| self.at(i));
        match a == b || b == c || a == c {
            true => self.is_left_turn_when_moved(triangle),
            false => self.turn(triangle) == Sign::Positive,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square with a slit from the left, as exporters join holes: corners 1 and 3 lie on one another.
    const SLIT: [[f64; 2]; 7] = [
        [0.0, 4.0],
        [0.0, 2.0],
        [1.0, 2.0],
        [0.0, 2.0],
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
    ];

    #[test]
    fn joints_are_opened() {
        let outline = Outline { points: &SLIT };
        // Of the corners on one another, the one above the slit comes first; its tip, which lies higher, before both.
        assert_eq!(outline.downwards(), Some(vec![6, 0, 2, 1, 3, 5, 4]));
        assert!(outline.inwards(1).y > 0.0 && outline.inwards(3).y < 0.0);
        // The corner below the slit is right of no edge that ends above it, and the other way round.
        assert!(outline.is_right_of(5, 3) && !outline.is_right_of(1, 0));
        assert!(outline.is_ear([1, 3, 5]) && !outline.is_ear([3, 1, 5]));
        assert!(!outline.is_ear([0, 1, 4]));
    }

    #[test]
    fn corners_without_a_place_have_no_order() {
        let points = [[0.0, 0.0], [f64::NAN, 0.0], [0.0, f64::INFINITY]];
        assert_eq!(Outline { points: &points }.downwards(), None);
        // Both zeros are one height.
        let points = [[32.0, -9.0], [0.0, -0.0], [-32.0, 9.0], [0.0, 1.0]];
        let order = Outline { points: &points }.downwards();
        assert_eq!(order, Some(vec![3, 2, 1, 0]));
    }
}
