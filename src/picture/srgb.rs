//! The sRGB transfer function (IEC 61966-2-1), exact and in its two pieces, between linear values and encoded ones.
//!
//! Linear and encoded values are in [0, 1].
//!
//! ```
//! use bspray::picture::srgb;
//!
//! assert_eq!(srgb::u8_of_linear(0.5), 188);
//! assert_eq!(srgb::u8_of_linear(srgb::LINEAR_OF_U8[77]), 77);
//! ```

use std::sync::LazyLock;

/// Encodes a linear value: 12.92 c up to 0.0031308, 1.055 c^(1/2.4) - 0.055 above.
///
/// Total: below 0 and NaN give 0, above 1 gives 1. The result is within 2 ulps of the exact formula.
pub fn encode(linear: f32) -> f32 {
    let c = unit(linear);
    if c <= 0.003_130_8 {
        12.92 * c
    } else {
        // In double precision: 1.055 x - 0.055 cancels, and 1/2.4 is no `f32`.
        (1.055 * libm::pow(f64::from(c), 1.0 / 2.4) - 0.055).min(1.0) as f32
    }
}

/// Decodes to a linear value: c / 12.92 up to 0.04045, ((c + 0.055) / 1.055)^2.4 above.
///
/// Total: below 0 and NaN give 0, above 1 gives 1.
pub fn decode(encoded: f32) -> f32 {
    decode_f64(f64::from(unit(encoded)))
}

/// The linear value of each 8-bit code, for texture lookups.
pub static LINEAR_OF_U8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| decode_f64(code as f64 / 255.0)));

/// Linear value of a 16-bit code.
pub fn linear_of_u16(code: u16) -> f32 {
    decode_f64(f64::from(code) / 65_535.0)
}

/// The 8-bit sRGB code of a linear value, rounded to the nearest.
pub fn u8_of_linear(linear: f32) -> u8 {
    unit_to_u8(encode(linear))
}

/// The 8-bit code of a value that is stored as it is (alpha): [0, 1] to 0 to 255, rounded to the nearest. NaN is 0.
pub fn unit_to_u8(value: f32) -> u8 {
    // The cast saturates, and takes NaN to 0.
    (value * 255.0 + 0.5) as u8
}

/// Into [0, 1]; NaN, which is not greater than 0, becomes 0.
fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

fn decode_f64(c: f64) -> f32 {
    if c <= 0.040_45 {
        (c / 12.92) as f32
    } else {
        libm::pow((c + 0.055) / 1.055, 2.4) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_values_hold() {
        // Middle grey, 18 %, is code 118; half of the light is code 188; the toe's end is code 10.31.
        assert_eq!(u8_of_linear(0.18), 118);
        assert_eq!(u8_of_linear(0.5), 188);
        assert!((encode(0.003_130_8) - 0.040_45).abs() < 1e-6);
        assert!((LINEAR_OF_U8[128] - 0.215_860_53).abs() < 1e-7);
        assert!((LINEAR_OF_U8[1] - 1.0 / (255.0 * 12.92)).abs() < 1e-10);
        assert_eq!(
            [encode(0.0), encode(1.0), decode(0.0), decode(1.0)],
            [0.0, 1.0, 0.0, 1.0]
        );
    }

    #[test]
    fn every_8_bit_code_comes_back() {
        for code in 0..=255_u8 {
            assert_eq!(u8_of_linear(LINEAR_OF_U8[usize::from(code)]), code);
            assert_eq!(unit_to_u8(f32::from(code) / 255.0), code);
        }
    }

    #[test]
    fn every_16_bit_code_comes_back_and_grows() {
        let mut last = -1.0;
        for code in 0..=u16::MAX {
            let linear = linear_of_u16(code);
            assert!(linear > last);
            last = linear;
            assert_eq!((encode(linear) * 65_535.0).round(), f32::from(code));
        }
    }

    #[test]
    fn all_inputs_give_codes() {
        let cases = [f32::NAN, -1.0, -0.0, 1.0 + 1e-6, f32::INFINITY, f32::MAX];
        assert_eq!(cases.map(u8_of_linear), [0, 0, 0, 255, 255, 255]);
        assert_eq!(cases.map(unit_to_u8), [0, 0, 0, 255, 255, 255]);
        assert_eq!(u8_of_linear(f32::NEG_INFINITY), 0);
    }

    #[test]
    fn encoding_grows_across_the_join() {
        // But for the step of 2.9e-8 down that the standard's rounded constants leave there.
        let mut last = 0.0_f32;
        let mut c = 0.003_1_f32;
        while c < 0.003_2 {
            let encoded = encode(c);
            assert!(encoded >= last - 3e-8, "{c}");
            last = encoded;
            c = c.next_up();
        }
    }
}
