//! The colours of a picture, as the measures that need all three channels take them.

use rayon::prelude::*;

use crate::picture::{Encoding, MOST_RADIANCE, srgb};

/// Colours of a rectangle of pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Colors {
    /// Columns.
    pub width: usize,
    /// Red, green and blue, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
}

impl Colors {
    /// Rows.
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width.max(1)
    }

    /// Every number replaced by another.
    pub(super) fn map(&self, of: impl Fn(f32) -> f32 + Sync) -> Self {
        Self {
            width: self.width,
            pixels: self.pixels.par_iter().map(|p| p.map(&of)).collect(),
        }
    }

    /// With finite numbers only: NaN and negative infinity become 0, infinity [`MOST_RADIANCE`]. Measures that look at
    /// neighbourhoods would lose a neighbourhood to each of them.
    pub(super) fn finite(&self) -> Self {
        self.map(|v| match v {
            v if v.is_finite() => v,
            v if v > 0.0 => MOST_RADIANCE,
            _ => 0.0,
        })
    }

    /// Linear light.
    pub(super) fn linear(&self, encoding: Encoding) -> Self {
        match encoding {
            Encoding::Linear => self.clone(),
            Encoding::Display => self.map(srgb::decode),
        }
    }

    /// What a display shows without a tone map: sRGB codes in [0, 1]; more light than 1 is cut off.
    pub(super) fn display(&self, encoding: Encoding) -> Self {
        match encoding {
            Encoding::Linear => self.map(srgb::encode),
            Encoding::Display => self.clone(),
        }
    }
}
