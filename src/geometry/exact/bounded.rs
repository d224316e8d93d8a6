//! Numbers of double precision that carry a bound on their own error.
//!
//! A running error analysis (Higham 2002, "Accuracy and Stability of Numerical Algorithms", 3.3): each operation adds what it may have rounded to
//! what its operands were off by. Slower than a bound derived once for a whole formula, and right for every formula.
//! What overflows gets an error that is infinite or NaN, which decides nothing.

use std::ops::{Add, Div, Mul, Sub};

use super::Sign;
use crate::geometry::tolerance::{RUNNING_BOUND, U64};

/// A number that is off by at most `error`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounded {
    pub(super) value: f64,
    pub(super) error: f64,
}

impl Bounded {
    pub(super) const ZERO: Self = Self::exact(0.0);

    /// A number that is right as it is.
    pub(super) const fn exact(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    /// The difference of two numbers of single precision.
    pub(super) fn difference(a: f32, b: f32) -> Self {
        Self::exact(f64::from(a)) - Self::exact(f64::from(b))
    }

    /// Its sign, or `None` if the error leaves it open.
    #[allow(
        clippy::float_cmp,
        reason = "an error of zero says that the value is right to the last bit"
    )]
    pub(super) fn sign(self) -> Option<Sign> {
        if self.value > self.error {
            Some(Sign::Positive)
        } else if self.value < -self.error {
            Some(Sign::Negative)
        } else {
            self.is_zero().then_some(Sign::Zero)
        }
    }

    #[allow(
        clippy::float_cmp,
        reason = "an error of zero says that the value is right to the last bit"
    )]
    fn is_zero(self) -> bool {
        self.value == 0.0 && self.error == 0.0
    }

    /// The value with an error of at least what rounding it and the bound itself may have cost.
    fn rounded(value: f64, inherited: f64, lost_to_underflow: f64) -> Self {
        Self {
            value,
            error: (inherited + U64 * value.abs()) * RUNNING_BOUND + lost_to_underflow,
        }
    }
}

impl Add for Bounded {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        if self.is_zero() {
            other
        } else if other.is_zero() {
            self
        } else {
            Self::rounded(self.value + other.value, self.error + other.error, 0.0)
        }
    }
}

impl Sub for Bounded {
    type Output = Self;

    #[allow(
        clippy::float_cmp,
        reason = "the difference of equal numbers is zero without rounding"
    )]
    fn sub(self, other: Self) -> Self {
        let inherited = self.error + other.error;
        if inherited == 0.0 && self.value == other.value {
            Self::ZERO
        } else {
            Self::rounded(self.value - other.value, inherited, 0.0)
        }
    }
}

impl Mul for Bounded {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        let inherited = self.value.abs() * other.error
            + other.value.abs() * self.error
            + self.error * other.error;
        Self::rounded(self.value * other.value, inherited, f64::MIN_POSITIVE)
    }
}

impl Div for Bounded {
    type Output = Self;

    /// The error is infinite or NaN if the divisor may be zero.
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        // n/d and n'/d' differ by (|n - n'| + |n/d| |d - d'|) / |d'| at most.
        let least = (other.value.abs() - other.error) * (1.0 - 2.0 * U64);
        if least > 0.0 {
            let inherited = (self.error + value.abs() * other.error) / least;
            Self::rounded(value, inherited, f64::MIN_POSITIVE)
        } else {
            Self {
                value,
                error: f64::INFINITY,
            }
        }
    }
}

/// Three numbers with bounds.
pub(super) type Triple = [Bounded; 3];

/// `a - b` of points in single precision.
pub(super) fn between(a: glam::Vec3, b: glam::Vec3) -> Triple {
    std::array::from_fn(|i| Bounded::difference(a[i], b[i]))
}

pub(super) fn dot(a: &Triple, b: &Triple) -> Bounded {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: &Triple, b: &Triple) -> Triple {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_without_error_stays_known() {
        let x = Bounded::difference(0.1, 0.1) * Bounded::difference(1.0, 1e-30);
        assert_eq!(x.sign(), Some(Sign::Zero));
        assert_eq!((x + Bounded::exact(-2.0)).sign(), Some(Sign::Negative));
    }

    #[test]
    fn what_cancels_or_overflows_or_underflows_is_in_doubt() {
        let third = Bounded::exact(1.0) / Bounded::exact(3.0);
        let zero = third + third + third - Bounded::exact(1.0);
        assert_eq!(zero.sign(), None);
        let huge = Bounded::exact(1e300) * Bounded::exact(1e300);
        assert_eq!((huge - huge).sign(), None);
        let tiny = Bounded::exact(1e-200) * Bounded::exact(1e-200);
        assert_eq!((tiny * Bounded::exact(1e300)).sign(), None);
        assert_eq!((Bounded::exact(1.0) / zero).sign(), None);
    }
}
