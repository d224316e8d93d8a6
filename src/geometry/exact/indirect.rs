//! Points that are known by what they were cut from, and exact questions about them.
//!
//! After Attene 2020, "Indirect Predicates for Geometric Constructions": a point that an algorithm constructs is never rounded, but kept as the
//! line and the plane, or the three planes, that meet in it. A predicate asks in double precision first, with a running bound on the error, and
//! computes in integers where that leaves the answer open.

use std::cmp::Ordering;

use glam::{DVec3, Vec3};

use super::bounded::{Bounded, Triple, between, cross, dot};
use super::homogeneous::Homogeneous;
use super::{ExactPlane, Sign};
use crate::geometry::tolerance::{POSITION_TRUST, RUNNING_BOUND, U64};

/// A point, by its origin. What it is made of must meet in one point.
#[derive(Clone, Copy, Debug)]
pub enum Point<'a> {
    /// A point of the input.
    Explicit(Vec3),
    /// Where the line through two points of the input meets a plane, strictly between the two.
    OnLine {
        /// The points; they lie on different sides of the plane.
        line: [Vec3; 2],
        /// The plane.
        plane: &'a ExactPlane,
    },
    /// Where three planes meet.
    OfPlanes([&'a ExactPlane; 3]),
}

/// A point rounded to double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// The point, in model units.
    pub point: DVec3,
    /// How far each coordinate may be off.
    pub error: f64,
}

impl Position {
    /// The side of the plane, if the error leaves no doubt. `normal` and `error` are the plane's [`ExactPlane::normal`], `through` a point of it.
    #[inline]
    pub fn certain_side(&self, normal: DVec3, error: f64, through: Vec3) -> Option<Sign> {
        let to_point = self.point - through.as_dvec3();
        let reach = to_point.abs().element_sum();
        // The normal's components are at most 1: three times the point's error, the normal's error, and four roundings a term.
        let bound = 3.0 * self.error * (1.0 + error) + (error + 8.0 * U64) * reach;
        let value = normal.dot(to_point);
        if value > bound {
            Some(Sign::Positive)
        } else if value < -bound {
            Some(Sign::Negative)
        } else {
            None
        }
    }
}

impl Point<'_> {
    /// The side of the plane on which it lies, without rounding. [`Sign::Zero`] also for a point that does not exist.
    pub fn side(&self, plane: &ExactPlane) -> Sign {
        match self {
            Self::Explicit(p) => plane.side_of(*p),
            Self::OnLine { line, .. } => {
                // Between its ends, and so on their side if they agree.
                match line.map(|p| plane.side_of(p)) {
                    [Sign::Zero, other] | [other, Sign::Zero] => other,
                    [Sign::Positive, Sign::Positive] => Sign::Positive,
                    [Sign::Negative, Sign::Negative] => Sign::Negative,
                    _ => self.integer_side(plane),
                }
            }
            Self::OfPlanes(planes) => {
                filtered_side(planes, plane).unwrap_or_else(|| self.integer_side(plane))
            }
        }
    }

    /// As [`side`](Self::side), in integers only.
    pub fn integer_side(&self, plane: &ExactPlane) -> Sign {
        Homogeneous::of(self).map_or(Sign::Zero, |point| point.side(plane))
    }

    /// By x, then y, then z, without rounding: the order of points along a line, one way or the other. Equal only if they are the same point.
    pub fn compare(&self, other: &Self) -> Ordering {
        if let [Self::Explicit(a), Self::Explicit(b)] = [self, other] {
            let order = |i: usize| a[i].partial_cmp(&b[i]).unwrap_or(Ordering::Equal);
            return order(0).then_with(|| order(1)).then_with(|| order(2));
        }
        let [a, b] = [self, other].map(|p| p.position());
        let mut exact = None;
        for axis in 0..3 {
            let difference = a.point[axis] - b.point[axis];
            // The difference is rounded by half a unit in its last place, the sum of the errors likewise.
            let error = (a.error + b.error) * RUNNING_BOUND + U64 * difference.abs();
            if difference.abs() > error {
                return difference.total_cmp(&0.0);
            }
            let exact =
                exact.get_or_insert_with(|| Homogeneous::of(self).zip(Homogeneous::of(other)));
            let Some((p, q)) = exact else {
                return Ordering::Equal;
            };
            let order = p.compare(q, axis);
            if order.is_ne() {
                return order;
            }
        }
        Ordering::Equal
    }

    /// The point rounded: to fifteen digits of its greatest coordinate, or to the twelve that double precision alone is trusted with.
    pub fn position(&self) -> Position {
        let (point, error) = match self {
            Self::Explicit(p) => (p.as_dvec3(), 0.0),
            Self::OnLine { line, plane } => split(on_line(*line, plane)),
            Self::OfPlanes(planes) => split(of_planes(planes)),
        };
        if error.is_finite() && error <= POSITION_TRUST * point.abs().max_element() {
            return Position { point, error };
        }
        let point = Homogeneous::of(self).map_or(DVec3::ZERO, |p| p.rounded());
        Position {
            point,
            error: 2.0 * U64 * point.abs().max_element() + f64::MIN_POSITIVE,
        }
    }
}

fn split(point: Triple) -> (DVec3, f64) {
    let error = point.iter().fold(0.0_f64, |most, x| {
        // f64::max would lose a NaN.
        if x.error.is_nan() {
            f64::INFINITY
        } else {
            most.max(x.error)
        }
    });
    (DVec3::from_array(point.map(|x| x.value)), error)
}

fn on_line([p, q]: [Vec3; 2], plane: &ExactPlane) -> Triple {
    let (at_p, at_q) = (plane.at(p), plane.at(q));
    let t = at_p / (at_p - at_q);
    let along = between(q, p);
    std::array::from_fn(|i| Bounded::exact(f64::from(p[i])) + t * along[i])
}

/// The point `x / w`, seen from the first plane's first point.
fn fraction_of_planes(planes: &[&ExactPlane; 3]) -> (Triple, Bounded) {
    let origin = planes[0].points()[0];
    let [n1, n2, n3] = planes.map(ExactPlane::bounded_normal);
    let [d2, d3] =
        [planes[1], planes[2]].map(|p| dot(p.bounded_normal(), &between(p.points()[0], origin)));
    let (second, third) = (cross(n3, n1), cross(n1, n2));
    let x = std::array::from_fn(|i| d2 * second[i] + d3 * third[i]);
    (x, dot(n3, &third))
}

fn of_planes(planes: &[&ExactPlane; 3]) -> Triple {
    let origin = planes[0].points()[0];
    let (x, w) = fraction_of_planes(planes);
    std::array::from_fn(|i| Bounded::exact(f64::from(origin[i])) + x[i] / w)
}

fn filtered_side(planes: &[&ExactPlane; 3], plane: &ExactPlane) -> Option<Sign> {
    let (x, w) = fraction_of_planes(planes);
    let origin = planes[0].points()[0];
    let offset = dot(plane.bounded_normal(), &between(plane.points()[0], origin));
    let side = dot(plane.bounded_normal(), &x) - offset * w;
    Some(side.sign()?.times(w.sign()?))
}
