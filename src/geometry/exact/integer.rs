//! `f32` vectors as vectors of integers, and the sums of products of them that geometry needs.
//!
//! A finite `f32` is an integer times a power of two. All coordinates of a set of vectors are written over one power,
//! the greatest that keeps every one an integer, so that the integers of everyday models stay below 2^40 and their
//! threefold products below 2^128, where `dashu-int` does not allocate. (Over the fixed power 2^-149, which would do as
//! well, they would have 150 to 277 bits and products of 830.)
//!
//! This file, `depth.rs`, `homogeneous.rs` and `mod.rs` beside it are the only ones that name `dashu-int`.

use dashu_int::IBig;
use glam::Vec3;

use super::Sign;

/// Three integers, in units of a power of two that travels beside them.
pub(super) struct Vector([IBig; 3]);

/// The vectors as integers, and the exponent `k` of their common unit `2^k`; `None` if a component is not finite.
pub(super) fn lift<const N: usize>(vectors: [Vec3; N]) -> Option<([Vector; N], i32)> {
    if !vectors.iter().all(|v| v.is_finite()) {
        return None;
    }
    let parts = vectors.map(|v| v.to_array().map(odd_part));
    let unit = parts
        .iter()
        .flatten()
        .filter(|(mantissa, _)| *mantissa != 0)
        .map(|(_, exponent)| *exponent)
        .min()
        .unwrap_or(0);
    let integers = parts.map(|v| {
        Vector(v.map(|(mantissa, exponent)| match mantissa {
            0 => IBig::ZERO,
            _ => IBig::from(mantissa) << (exponent - unit) as usize,
        }))
    });
    Some((integers, unit))
}

/// A finite `x` as `mantissa * 2^exponent` with an odd mantissa, or zero.
fn odd_part(x: f32) -> (i32, i32) {
    let bits = x.to_bits();
    let biased = (bits >> 23 & 0xff) as i32;
    let fraction = (bits & 0x7f_ffff) as i32;
    let magnitude = if biased == 0 {
        fraction
    } else {
        fraction | 0x80_0000
    };
    if magnitude == 0 {
        return (0, 0);
    }
    let zeros = magnitude.trailing_zeros() as i32;
    let odd = magnitude >> zeros;
    (
        if x < 0.0 { -odd } else { odd },
        biased.max(1) - 150 + zeros,
    )
}

impl Vector {
    pub(super) fn minus(&self, other: &Self) -> Self {
        let [a, b] = [&self.0, &other.0];
        Self([&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]])
    }

    pub(super) fn cross(&self, other: &Self) -> Self {
        let [a, b] = [&self.0, &other.0];
        Self([
            &a[1] * &b[2] - &a[2] * &b[1],
            &a[2] * &b[0] - &a[0] * &b[2],
            &a[0] * &b[1] - &a[1] * &b[0],
        ])
    }

    pub(super) fn dot(&self, other: &Self) -> IBig {
        let [a, b] = [&self.0, &other.0];
        &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
    }

    pub(super) const fn new(components: [IBig; 3]) -> Self {
        Self(components)
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        let [a, b] = [&self.0, &other.0];
        Self([&a[0] + &b[0], &a[1] + &b[1], &a[2] + &b[2]])
    }

    pub(super) fn scaled(&self, by: &IBig) -> Self {
        Self(self.0.each_ref().map(|x| x * by))
    }

    pub(super) fn into_components(self) -> [IBig; 3] {
        self.0
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.iter().all(IBig::is_zero)
    }

    /// The components, for whoever needs their size.
    pub(super) fn components(&self) -> &[IBig; 3] {
        &self.0
    }
}

/// The sign of an integer.
pub(super) fn sign(x: &IBig) -> Sign {
    Sign::of(x.cmp(&IBig::ZERO))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lifting_loses_nothing() {
        let values = [
            0.0,
            -0.0,
            1.0,
            -1.5,
            0.1,
            1e18,
            -3.3e-30,
            f32::MAX,
            f32::MIN_POSITIVE,
            f32::from_bits(1),
            -f32::from_bits(0x7f_ffff),
        ];
        for x in values {
            let (mantissa, exponent) = odd_part(x);
            let back = libm::ldexp(f64::from(mantissa), exponent);
            assert_eq!(back, f64::from(x), "{x:e}");
            assert!(mantissa == 0 || mantissa % 2 != 0);
        }
    }

    #[test]
    fn the_unit_is_the_greatest_that_serves_all() {
        let (integers, unit) =
            lift([Vec3::new(3.0, 0.0, 0.25), Vec3::new(-8.0, 0.5, 1.0)]).unwrap();
        assert_eq!(unit, -2);
        assert_eq!(integers[0].0, [12, 0, 1].map(IBig::from));
        assert_eq!(integers[1].0, [-32, 2, 4].map(IBig::from));
        assert!(lift([Vec3::new(0.0, f32::NAN, 0.0)]).is_none());
        assert!(lift([Vec3::splat(f32::INFINITY)]).is_none());
    }

    #[test]
    fn products_follow_the_right_hand_rule() {
        let ([x, y], _) = lift([Vec3::X, Vec3::new(0.0, 2.0, 0.0)]).unwrap();
        assert_eq!(x.cross(&y).0, [0, 0, 2].map(IBig::from));
        assert_eq!(y.dot(&y), IBig::from(4));
        assert_eq!(sign(&y.cross(&x).0[2]), Sign::Negative);
        assert!(y.minus(&y).is_zero());
    }
}
