//! 8-bit pictures: what PNG and JPEG hold.

use super::srgb;

/// 8-bit sRGB pixels, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RasterPixels {
    /// Without alpha.
    Rgb(Vec<[u8; 3]>),
    /// With alpha, which is linear and not multiplied into the colour.
    Rgba(Vec<[u8; 4]>),
}

impl RasterPixels {
    /// Number of pixels.
    pub fn len(&self) -> usize {
        match self {
            Self::Rgb(pixels) => pixels.len(),
            Self::Rgba(pixels) => pixels.len(),
        }
    }

    /// Whether there is no pixel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// An 8-bit picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` pixels; another number is an error on writing.
    pub pixels: RasterPixels,
}

impl Raster {
    /// Encodes display light: linear, in [0, 1], as a tone map gives it. Values are rounded to the nearest code.
    pub fn from_rgb(width: u32, height: u32, linear: &[[f32; 3]]) -> Self {
        let pixels = linear.iter().map(|c| c.map(srgb::u8_of_linear)).collect();
        Self {
            width,
            height,
            pixels: RasterPixels::Rgb(pixels),
        }
    }

    /// Encodes display light with alpha; the colour is linear and not multiplied by alpha, which PNG asks for.
    pub fn from_rgba(width: u32, height: u32, linear: &[[f32; 4]]) -> Self {
        let encode = |&[r, g, b, a]: &[f32; 4]| {
            let [r, g, b] = [r, g, b].map(srgb::u8_of_linear);
            [r, g, b, srgb::unit_to_u8(a)]
        };
        Self {
            width,
            height,
            pixels: RasterPixels::Rgba(linear.iter().map(encode).collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_is_encoded_and_alpha_is_not() {
        let raster = Raster::from_rgba(1, 2, &[[0.0, 0.18, 1.0, 0.5], [f32::NAN, 2.0, -1.0, 7.0]]);
        let expected = RasterPixels::Rgba(vec![[0, 118, 255, 128], [0, 255, 0, 255]]);
        assert_eq!(raster.pixels, expected);
        let raster = Raster::from_rgb(1, 1, &[[0.0, 0.18, 1.0]]);
        assert_eq!(raster.pixels, RasterPixels::Rgb(vec![[0, 118, 255]]));
    }
}
