//! Cutting convex regions of the plane, in double precision: for drawings.

use glam::DVec2;

/// A half of the plane: where `normal . (p - through)` is not negative.
#[derive(Clone, Copy)]
pub(super) struct HalfPlane {
    pub(super) through: DVec2,
    pub(super) normal: DVec2,
}

impl HalfPlane {
    fn height(&self, p: DVec2) -> f64 {
        self.normal.dot(p - self.through)
    }

    /// The part of a convex region in this half, and where the line crosses its outline.
    pub(super) fn clip(&self, corners: &[DVec2]) -> (Vec<DVec2>, Vec<DVec2>) {
        let (mut kept, mut crossings) = (Vec::new(), Vec::new());
        for (i, &p) in corners.iter().enumerate() {
            let q = corners[(i + 1) % corners.len()];
            let (hp, hq) = (self.height(p), self.height(q));
            if hp >= 0.0 {
                kept.push(p);
            }
            if (hp >= 0.0) != (hq >= 0.0) {
                let crossing = p + (q - p) * (hp / (hp - hq));
                kept.push(crossing);
                crossings.push(crossing);
            }
        }
        (kept, crossings)
    }
}

/// Of a convex region, counter-clockwise.
pub(super) fn area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners
        .iter()
        .zip(next)
        .map(|(p, q)| p.perp_dot(*q))
        .sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_is_cut_into_parts_that_make_it_up() {
        let corners = [[0.0, 0.0], [3.0, 0.0], [4.0, 2.0], [0.0, 1.0]].map(DVec2::from_array);
        let front = HalfPlane {
            through: DVec2::new(1.0, 0.0),
            normal: DVec2::new(2.0, 1.0),
        };
        let back = HalfPlane {
            normal: -front.normal,
            ..front
        };
        let (before, crossings) = front.clip(&corners);
        let (behind, _) = back.clip(&corners);
        assert!((area(&before) + area(&behind) - area(&corners)).abs() < 1e-12);
        assert_eq!(crossings.len(), 2);
        assert!(crossings.iter().all(|&p| front.height(p).abs() < 1e-12));
        // All of it, or nothing.
        let beyond = HalfPlane {
            through: DVec2::new(9.0, 0.0),
            ..front
        };
        assert!(beyond.clip(&corners).0.is_empty());
    }
}
