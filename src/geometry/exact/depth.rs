//! Where along a ray something lies, as a fraction without rounding.

use std::cmp::Ordering;

use dashu_int::IBig;
use dashu_int::ops::{BitTest, DivRem, UnsignedAbs};

/// The exact parameter `t` at which a ray's line meets a triangle's plane: a fraction of two integers, in units of
/// the direction's length.
///
/// Depths along the same ray are ordered, and equal depths are equal, without rounding.
///
/// ```
/// use bspray::geometry::{Ray, Triangle, exact};
/// use glam::Vec3;
/// let third = Triangle::new(Vec3::new(-9.0, -9.0, 1.0), Vec3::new(9.0, -9.0, 1.0), Vec3::new(0.0, 9.0, 1.0));
/// let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.0, 3.0));
/// let depth = exact::depth(&ray, &third).expect("the ray meets it");
/// assert_eq!(depth.to_f32(), 1.0 / 3.0);
/// assert_eq!(depth, exact::depth(&ray, &third).expect("still"));
/// ```
#[derive(Clone, Debug)]
pub struct Depth {
    numerator: IBig,
    /// Greater than zero.
    denominator: IBig,
}

impl Depth {
    /// The fraction `numerator / denominator * 2^exponent`; `None` if the denominator is zero.
    pub(super) fn new(numerator: IBig, denominator: IBig, exponent: i32) -> Option<Self> {
        let shift = exponent.unsigned_abs() as usize;
        let (numerator, denominator) = match exponent.cmp(&0) {
            Ordering::Less => (numerator, denominator << shift),
            Ordering::Equal => (numerator, denominator),
            Ordering::Greater => (numerator << shift, denominator),
        };
        match denominator.cmp(&IBig::ZERO) {
            Ordering::Less => Some(Self {
                numerator: -numerator,
                denominator: -denominator,
            }),
            Ordering::Equal => None,
            Ordering::Greater => Some(Self {
                numerator,
                denominator,
            }),
        }
    }

    /// The nearest `f32`, ties to even; infinite if the nearest would exceed `f32::MAX`. Zero is always `+0.0`, also
    /// where a negative depth rounds to zero, so that equal results have equal bits.
    pub fn to_f32(&self) -> f32 {
        let magnitude = (&self.numerator).unsigned_abs();
        let denominator = (&self.denominator).unsigned_abs();
        // The quotient lies between 2^(bits - 1) and 2^(bits + 1).
        let bits = magnitude.bit_len() as i64 - denominator.bit_len() as i64;
        if self.numerator.is_zero() || bits < -152 {
            return 0.0;
        }
        let negative = self.numerator < IBig::ZERO;
        let rounded = if bits > 130 {
            f32::INFINITY
        } else {
            // Rounded to odd at 26 or 27 bits, which fits in f64 without loss and leaves the hardware enough to round
            // to nearest even, subnormal results included (Boldo and Melquiond 2008, "Emulation of FMA").
            let scale = 25 - bits;
            let (quotient, rest) = if scale >= 0 {
                (magnitude << scale as usize).div_rem(denominator)
            } else {
                magnitude.div_rem(denominator << scale.unsigned_abs() as usize)
            };
            let quotient = u32::try_from(quotient).expect("the scale leaves a quotient below 2^26");
            let odd = 2 * quotient + u32::from(!rest.is_zero());
            (f64::from(odd) * power_of_two(-scale - 1)) as f32
        };
        // Adding +0 turns -0 into +0.
        if negative { -rounded + 0.0 } else { rounded }
    }
}

/// `2^exponent` for the exponents of normal `f64`.
fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

impl Ord for Depth {
    fn cmp(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }
}

impl PartialOrd for Depth {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Depth {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Depth {}

#[cfg(test)]
mod tests {
    use super::*;

    fn fraction(numerator: i64, denominator: i64, exponent: i32) -> Depth {
        Depth::new(numerator.into(), denominator.into(), exponent).unwrap()
    }

    #[test]
    fn ties_go_to_even() {
        let one = 1_i64 << 25;
        let half_ulp = 2;
        assert_eq!(fraction(one + half_ulp, one, 0).to_f32(), 1.0);
        assert_eq!(
            fraction(one + 3 * half_ulp, one, 0).to_f32(),
            1.0_f32.next_up().next_up()
        );
        assert_eq!(
            fraction(one + half_ulp + 1, one, 0).to_f32(),
            1.0_f32.next_up()
        );
        assert_eq!(
            fraction(-one - half_ulp - 1, one, 0).to_f32(),
            -1.0_f32.next_up()
        );
    }

    #[test]
    fn subnormal_and_huge_depths_round_once() {
        assert_eq!(fraction(3, 1, -150).to_f32(), f32::from_bits(2));
        assert_eq!(fraction(1, 1, -150).to_f32().to_bits(), 0);
        assert_eq!(fraction(-1, 1, -150).to_f32().to_bits(), 0);
        assert_eq!(fraction(-1, 1, -4000).to_f32().to_bits(), 0);
        assert_eq!(fraction(5, 3, -150).to_f32(), f32::from_bits(1));
        let largest = (1_i64 << 25) - 2;
        assert_eq!(fraction(largest, 1, 103).to_f32(), f32::MAX);
        assert_eq!(fraction(largest + 1, 1, 103).to_f32(), f32::INFINITY);
        assert_eq!(fraction(-1, 1, 4000).to_f32(), f32::NEG_INFINITY);
    }

    #[test]
    fn fractions_are_ordered_by_value() {
        assert_eq!(fraction(1, 2, 0), fraction(-3, -6, 0));
        assert_eq!(fraction(1, 2, 0), fraction(1, 1, -1));
        assert!(fraction(1, 3, 0) < fraction(1, 2, 0));
        assert!(fraction(1, -3, 0) > fraction(1, -2, 0));
        assert!(Depth::new(IBig::ONE, IBig::ZERO, 0).is_none());
    }
}
