//! Points as fractions of integers with one denominator, for the questions that double precision leaves open.

use std::cmp::Ordering;

use dashu_int::IBig;
use dashu_int::ops::{BitTest, DivRem, UnsignedAbs};
use glam::{DVec3, Vec3};

use super::integer::{Vector, lift, sign};
use super::{ExactPlane, Point, Sign};

/// The point `coordinates / weight * 2^unit`.
pub(super) struct Homogeneous {
    coordinates: [IBig; 3],
    /// Greater than zero.
    weight: IBig,
    unit: i32,
}

impl Homogeneous {
    /// The point; `None` if its planes do not meet in one point, or if an input is not finite.
    pub(super) fn of(point: &Point) -> Option<Self> {
        match point {
            Point::Explicit(p) => {
                let ([p], unit) = lift([*p])?;
                Self::new(p.into_components(), IBig::ONE, unit)
            }
            Point::OnLine {
                line: [p, q],
                plane,
            } => {
                let [a, b, c] = *plane.points();
                let ([p, q, a, b, c], unit) = lift([*p, *q, a, b, c])?;
                let normal = b.minus(&a).cross(&c.minus(&a));
                // (f(q) p - f(p) q) / (f(q) - f(p)), f being the plane's function.
                let [at_p, at_q] = [&p, &q].map(|x| normal.dot(&x.minus(&a)));
                let point = q.scaled(&-&at_p).plus(&p.scaled(&at_q));
                Self::new(point.into_components(), at_q - at_p, unit)
            }
            Point::OfPlanes(planes) => {
                let points = planes.map(ExactPlane::points);
                let flat: [Vec3; 9] = std::array::from_fn(|i| points[i / 3][i % 3]);
                let (v, unit) = lift(flat)?;
                let normals =
                    [0, 3, 6].map(|i| v[i + 1].minus(&v[i]).cross(&v[i + 2].minus(&v[i])));
                let offsets = [0, 1, 2].map(|i| normals[i].dot(&v[3 * i]));
                // Cramer's rule.
                let minors = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| normals[i].cross(&normals[j]));
                let weight = normals[0].dot(&minors[0]);
                let [x, y, z] = [0, 1, 2].map(|i| minors[i].scaled(&offsets[i]));
                Self::new(x.plus(&y).plus(&z).into_components(), weight, unit)
            }
        }
    }

    fn new(coordinates: [IBig; 3], weight: IBig, unit: i32) -> Option<Self> {
        match weight.cmp(&IBig::ZERO) {
            Ordering::Equal => None,
            Ordering::Greater => Some(Self {
                coordinates,
                weight,
                unit,
            }),
            Ordering::Less => Some(Self {
                coordinates: coordinates.map(|x| -x),
                weight: -weight,
                unit,
            }),
        }
    }

    /// The side of the plane on which it lies.
    pub(super) fn side(&self, plane: &ExactPlane) -> Sign {
        let Some(([a, b, c], unit)) = lift(*plane.points()) else {
            return Sign::Zero;
        };
        let normal = b.minus(&a).cross(&c.minus(&a));
        // normal . (coordinates - a weight), over the lesser of the two units.
        let [own, theirs] = shifts(self.unit, unit);
        let a = a.scaled(&self.weight).into_components();
        let to_point: [IBig; 3] =
            std::array::from_fn(|i| (&self.coordinates[i] << own) - (&a[i] << theirs));
        sign(&normal.dot(&Vector::new(to_point)))
    }

    /// Compares one coordinate.
    pub(super) fn compare(&self, other: &Self, axis: usize) -> Ordering {
        let [own, theirs] = shifts(self.unit, other.unit);
        ((&self.coordinates[axis] * &other.weight) << own)
            .cmp(&((&other.coordinates[axis] * &self.weight) << theirs))
    }

    /// The point in double precision: each coordinate off by at most one unit in the last place.
    pub(super) fn rounded(&self) -> DVec3 {
        DVec3::from_array(
            self.coordinates
                .each_ref()
                .map(|x| libm::ldexp(quotient(x, &self.weight), self.unit)),
        )
    }
}

/// By how many bits numbers over these units are shifted to one unit.
fn shifts(a: i32, b: i32) -> [usize; 2] {
    let least = a.min(b);
    [a - least, b - least].map(|s| s as usize)
}

/// `a / b` in double precision, from the leading 60 bits of the quotient.
fn quotient(a: &IBig, b: &IBig) -> f64 {
    let (magnitude, divisor) = (a.unsigned_abs(), b.unsigned_abs());
    let scale = 60 - (magnitude.bit_len() as i64 - divisor.bit_len() as i64);
    let (whole, _) = if scale >= 0 {
        (magnitude << scale as usize).div_rem(divisor)
    } else {
        magnitude.div_rem(divisor << scale.unsigned_abs() as usize)
    };
    let value = libm::ldexp(whole.to_f64().value(), -scale as i32);
    if sign(a) == Sign::Negative {
        -value
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_every_kind_have_their_coordinates() {
        let z =
            ExactPlane::new([Vec3::Z, Vec3::new(3.0, 0.0, 1.0), Vec3::new(0.0, 2.0, 1.0)]).unwrap();
        let x = ExactPlane::new([
            Vec3::new(5.0, 0.0, 0.0),
            Vec3::new(5.0, 1.0, 0.0),
            Vec3::new(5.0, 0.0, 4.0),
        ])
        .unwrap();
        // y = x / 3 + 1
        let slope =
            ExactPlane::new([Vec3::Y, Vec3::new(3.0, 2.0, 0.0), Vec3::new(0.0, 1.0, 7.0)]).unwrap();
        let point = Point::OfPlanes([&z, &x, &slope]);
        let third = Homogeneous::of(&point).unwrap().rounded();
        assert_eq!(third, DVec3::new(5.0, 8.0 / 3.0, 1.0));
        let on_line = Point::OnLine {
            line: [Vec3::new(0.0, -3.0, 0.25), Vec3::new(0.0, 6.0, 0.25)],
            plane: &slope,
        };
        let met = Homogeneous::of(&on_line).unwrap();
        assert_eq!(met.rounded(), DVec3::new(0.0, 1.0, 0.25));
        assert_eq!(met.side(&z), Sign::Negative);
        assert_eq!(met.side(&slope), Sign::Zero);
        assert!(met.compare(&Homogeneous::of(&point).unwrap(), 1).is_lt());
        assert!(Homogeneous::of(&Point::OfPlanes([&z, &x, &x])).is_none());
    }
}
