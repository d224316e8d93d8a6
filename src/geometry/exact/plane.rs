//! Planes through three points of the input: as exact as these, and so is every question about them.

use glam::{DVec3, Vec3};

use super::bounded::{Bounded, Triple, between, cross, dot};
use super::integer::{Vector, lift, sign};
use super::{Sign, side_of_point};
use crate::geometry::tolerance::{PLANE_TRUST, U64};

/// The plane through three points that do not lie on a line. Its front is the side from which these run counter-clockwise.
///
/// ```
/// use bspray::geometry::exact::{ExactPlane, Point, Sign};
/// use glam::Vec3;
/// let floor = ExactPlane::new([Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)]).expect("it has an area");
/// let wall = ExactPlane::new([Vec3::X, Vec3::new(1.0, 2.0, 0.0), Vec3::new(1.0, 0.0, 3.0)]).expect("it has an area");
/// let slope = ExactPlane::new([Vec3::ZERO, Vec3::new(3.0, 1.0, 0.0), Vec3::Z]).expect("it has an area");
/// // Where the three meet, at (1, 1/3, 0), which no number of the machine is.
/// let corner = Point::OfPlanes([&floor, &wall, &slope]);
/// assert_eq!(corner.side(&slope), Sign::Zero);
/// ```
#[derive(Clone, Debug)]
pub struct ExactPlane {
    points: [Vec3; 3],
    normal: Triple,
}

impl ExactPlane {
    /// The plane; `None` if the points lie on a line or are not finite.
    pub fn new(points: [Vec3; 3]) -> Option<Self> {
        let [a, b, c] = points;
        let triangle = crate::geometry::Triangle::new(a, b, c);
        (!triangle.is_degenerate()).then(|| Self {
            points,
            normal: cross(&between(b, a), &between(c, a)),
        })
    }

    /// The points it was made from.
    pub const fn points(&self) -> &[Vec3; 3] {
        &self.points
    }

    /// The normal in double precision, its greatest component 1 in magnitude, and a bound on the error of each component.
    pub fn normal(&self) -> (DVec3, f64) {
        let value = DVec3::from_array(self.normal.map(|n| n.value));
        let error = self
            .normal
            .iter()
            .fold(0.0_f64, |most, n| most.max(n.error));
        let greatest = value.abs().max_element();
        if greatest.is_finite() && error < PLANE_TRUST * greatest {
            // Twice: the greatest component is as wrong as the others. And four units for two quotients.
            (
                value / greatest,
                2.0 * error / (greatest - error) + 4.0 * U64,
            )
        } else {
            let [a, b, c] = self.points;
            let unit =
                super::normal(&crate::geometry::Triangle::new(a, b, c)).unwrap_or(DVec3::ZERO);
            (unit / unit.abs().max_element(), 16.0 * U64)
        }
    }

    /// The side on which a point of the input lies.
    pub fn side_of(&self, p: Vec3) -> Sign {
        side_of_point(self.points, p)
    }

    /// Whether the other is the same plane: positive if it looks the same way, negative if the opposite way, zero if it is another.
    pub fn same(&self, other: &Self) -> Sign {
        if other.points.iter().any(|&p| self.side_of(p) != Sign::Zero) {
            return Sign::Zero;
        }
        dot(&self.normal, &other.normal).sign().unwrap_or_else(|| {
            let [own, theirs] = [self, other].map(Self::integer_normal);
            own.zip(theirs)
                .map_or(Sign::Zero, |(a, b)| sign(&a.dot(&b)))
        })
    }

    /// Which way the line goes in which the planes meet, `self`'s normal x `other`'s: the sign of the first component that is not zero.
    /// Points along it, in the order of [`Point::compare`](super::Point::compare), ascend if it is positive. Zero if the planes are parallel.
    pub fn direction_of_meeting(&self, other: &Self) -> Sign {
        let known = cross(&self.normal, &other.normal).map(Bounded::sign);
        let mut exact = None;
        for (i, component) in known.into_iter().enumerate() {
            let found = component.unwrap_or_else(|| {
                let exact = exact.get_or_insert_with(|| {
                    let normals = self.integer_normal().zip(other.integer_normal());
                    normals.map(|(a, b)| a.cross(&b))
                });
                exact
                    .as_ref()
                    .map_or(Sign::Zero, |v: &Vector| sign(&v.components()[i]))
            });
            if found != Sign::Zero {
                return found;
            }
        }
        Sign::Zero
    }

    /// In units that do not matter for signs.
    fn integer_normal(&self) -> Option<Vector> {
        let ([a, b, c], _) = lift(self.points)?;
        Some(b.minus(&a).cross(&c.minus(&a)))
    }

    pub(super) fn bounded_normal(&self) -> &Triple {
        &self.normal
    }

    /// `normal . (p - a)`.
    pub(super) fn at(&self, p: Vec3) -> Bounded {
        dot(&self.normal, &between(p, self.points[0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(points: [[f32; 3]; 3]) -> ExactPlane {
        ExactPlane::new(points.map(Vec3::from_array)).unwrap()
    }

    #[test]
    fn equal_planes_are_told_from_turned_and_shifted_ones() {
        let floor = plane([[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 2.0, 1.0]]);
        let same = plane([[5.0, 5.0, 1.0], [9.0, 5.0, 1.0], [9.0, 6.0, 1.0]]);
        let turned = plane([[5.0, 5.0, 1.0], [9.0, 6.0, 1.0], [9.0, 5.0, 1.0]]);
        let shifted = plane([
            [5.0, 5.0, 1.0],
            [9.0, 6.0, 1.0_f32.next_up()],
            [9.0, 5.0, 1.0],
        ]);
        assert_eq!(floor.same(&same), Sign::Positive);
        assert_eq!(floor.same(&turned), Sign::Negative);
        assert_eq!(floor.same(&shifted), Sign::Zero);
    }

    #[test]
    fn the_meeting_of_two_planes_follows_the_right_hand_rule() {
        let floor = plane([[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 2.0, 1.0]]);
        let wall = plane([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        // z x x = y
        assert_eq!(floor.direction_of_meeting(&wall), Sign::Positive);
        assert_eq!(wall.direction_of_meeting(&floor), Sign::Negative);
        assert_eq!(floor.direction_of_meeting(&floor), Sign::Zero);
    }

    #[test]
    fn the_normal_of_a_sliver_has_a_small_bound() {
        let sliver = plane([
            [0.0, 0.0, 0.0],
            [1.0, 2.0, 3.0],
            [1.0_f32.next_up(), 2.0, 3.0],
        ]);
        let (normal, error) = sliver.normal();
        assert!(
            (normal - DVec3::new(0.0, 1.0, -2.0 / 3.0))
                .abs()
                .max_element()
                <= error
        );
        assert!(error < 1e-9, "{error:e}");
        assert!(ExactPlane::new([Vec3::ZERO, Vec3::ONE, Vec3::splat(3.0)]).is_none());
    }
}
