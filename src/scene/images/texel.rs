//! Texels as linear values: 8 and 16 bits are decoded by tables, so that images keep the memory of their files.

use std::sync::LazyLock;

use glam::Vec4;

use super::{ColorSpace, Pixels};
use crate::picture::srgb;

/// Each 8-bit code as a share of 1.
static UNIT_OF_U8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| code as f32 / 255.0));

/// The linear value of each 16-bit sRGB code: 256 KB, made when the first such image is looked up.
static LINEAR_OF_U16: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=u16::MAX).map(srgb::linear_of_u16).collect());

/// A texel's linear value.
pub(crate) fn fetch(pixels: &Pixels, index: usize, space: ColorSpace) -> Vec4 {
    match pixels {
        Pixels::Rgba8(p) => of_u8(p[index], table(space)),
        Pixels::Rgba16(p) => of_u16(p[index], space),
        Pixels::RgbaF32(p) => Vec4::from_array(p[index]),
    }
}

/// The texels of two columns and two rows (their offset in the image): upper left, upper right, lower left, lower right.
pub(crate) fn fetch_four(
    pixels: &Pixels,
    columns: [usize; 2],
    rows: [usize; 2],
    space: ColorSpace,
) -> [Vec4; 4] {
    let [left, right] = columns;
    let [top, below] = rows;
    let indices = [top + left, top + right, below + left, below + right];
    match pixels {
        Pixels::Rgba8(p) => {
            let table = table(space);
            indices.map(|i| of_u8(p[i], table))
        }
        Pixels::Rgba16(p) => indices.map(|i| of_u16(p[i], space)),
        Pixels::RgbaF32(p) => indices.map(|i| Vec4::from_array(p[i])),
    }
}

fn table(space: ColorSpace) -> &'static [f32; 256] {
    match space {
        ColorSpace::Srgb => &srgb::LINEAR_OF_U8,
        ColorSpace::Linear => &UNIT_OF_U8,
    }
}

fn of_u8([r, g, b, a]: [u8; 4], table: &[f32; 256]) -> Vec4 {
    let [r, g, b] = [r, g, b].map(|c| table[usize::from(c)]);
    Vec4::new(r, g, b, f32::from(a) / 255.0)
}

fn of_u16([r, g, b, a]: [u16; 4], space: ColorSpace) -> Vec4 {
    let plain = |x: u16| f32::from(x) / 65535.0;
    let [r, g, b] = match space {
        ColorSpace::Srgb => {
            let table = &*LINEAR_OF_U16;
            [r, g, b].map(|c| table[usize::from(c)])
        }
        ColorSpace::Linear => [r, g, b].map(plain),
    };
    Vec4::new(r, g, b, plain(a))
}

/// Linear values as codes of 8 bits, rounded to the nearest.
pub(super) struct Encoder {
    /// The code at the lower end of each interval of [`Self::STEPS`].
    guess: Vec<u8>,
    /// Linear value from which on each code is the nearest.
    least: [f32; 256],
}

impl Encoder {
    /// Intervals of the linear range: few codes share one, even in the dark.
    const STEPS: usize = 4096;

    /// Encodes to sRGB.
    pub(super) fn srgb() -> &'static Self {
        static ENCODER: LazyLock<Encoder> = LazyLock::new(|| {
            let least = |code: usize| match code {
                0 => 0.0,
                code => srgb::decode((code as f32 - 0.5) / 255.0),
            };
            let least: [f32; 256] = std::array::from_fn(least);
            let code_of = |value: f32| least.partition_point(|&l| l <= value).max(1) - 1;
            let guess = |step: usize| code_of(step as f32 / Encoder::STEPS as f32) as u8;
            Encoder {
                guess: (0..=Encoder::STEPS).map(guess).collect(),
                least,
            }
        });
        &ENCODER
    }

    /// The code of a linear value of 0 to 1.
    pub(super) fn code(&self, linear: f32) -> u8 {
        let linear = linear.clamp(0.0, 1.0);
        let mut code = self.guess[(linear * Self::STEPS as f32) as usize];
        while code < u8::MAX && self.least[usize::from(code) + 1] <= linear {
            code += 1;
        }
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_encoder_gives_the_nearest_code() {
        let encoder = Encoder::srgb();
        for i in 0..=100_000 {
            let linear = i as f32 / 100_000.0;
            let (code, exact) = (encoder.code(linear), srgb::encode(linear) * 255.0);
            assert!((f32::from(code) - exact).abs() < 0.5001, "{linear}");
        }
        for code in 0..=u8::MAX {
            assert_eq!(encoder.code(srgb::LINEAR_OF_U8[usize::from(code)]), code);
        }
    }

    #[test]
    fn codes_of_8_and_16_bits_mean_the_same() {
        let wide = |c: u8| u16::from(c) * 257;
        for code in 0..=u8::MAX {
            let color = [code, 255 - code, 7, code];
            let (eight, sixteen) = (vec![color], vec![color.map(wide)]);
            for space in [ColorSpace::Srgb, ColorSpace::Linear] {
                let a = fetch(&Pixels::Rgba8(eight.clone()), 0, space);
                let b = fetch(&Pixels::Rgba16(sixteen.clone()), 0, space);
                assert!((a - b).abs().max_element() < 1e-6, "{code} {space:?}");
            }
        }
    }
}
