//! Charts as pixels, on machines without fonts.
//!
//! A chart is drawn at twice the size and halved, which smooths what plotters leaves jagged.

use std::convert::Infallible;

use plotters::prelude::DrawingBackend;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendTextStyle, DrawingErrorKind};

use crate::picture::glyphs::GlyphSize;
use crate::picture::{Raster, RasterPixels};

/// Codes of a picture, on white.
pub(super) struct Bitmap {
    size: (u32, u32),
    pixels: Vec<[u8; 3]>,
}

impl Bitmap {
    pub(super) fn new(size: (u32, u32)) -> Self {
        Self {
            size,
            pixels: vec![[255; 3]; size.0 as usize * size.1 as usize],
        }
    }

    /// The mean of every two by two pixels.
    pub(super) fn halved(&self) -> Raster {
        let (width, height) = (self.size.0 / 2, self.size.1 / 2);
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x as usize, y as usize)));
        let stride = self.size.0 as usize;
        let mean = |(x, y): (usize, usize)| {
            let first = 2 * y * stride + 2 * x;
            let four = [0, 1, stride, stride + 1].map(|step| self.pixels[first + step]);
            std::array::from_fn(|c| (four.iter().map(|p| u32::from(p[c])).sum::<u32>() / 4) as u8)
        };
        Raster {
            width,
            height,
            pixels: RasterPixels::Rgb(places.map(mean).collect()),
        }
    }
}

/// How many pixels of a chart a pixel of a large glyph takes, for a text of some size.
fn magnification<S: BackendTextStyle>(style: &S) -> i32 {
    ((style.size() / GlyphSize::Large.height() as f64).round() as i32).max(1)
}

impl DrawingBackend for &mut Bitmap {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Result<(), DrawingErrorKind<Infallible>> {
        Ok(())
    }

    fn present(&mut self) -> Result<(), DrawingErrorKind<Infallible>> {
        Ok(())
    }

    fn draw_pixel(
        &mut self,
        (x, y): BackendCoord,
        color: BackendColor,
    ) -> Result<(), DrawingErrorKind<Infallible>> {
        let inside = |v: i32, size: u32| u32::try_from(v).ok().filter(|v| *v < size);
        if let (Some(x), Some(y)) = (inside(x, self.size.0), inside(y, self.size.1)) {
            let pixel = &mut self.pixels[y as usize * self.size.0 as usize + x as usize];
            let [r, g, b] = [color.rgb.0, color.rgb.1, color.rgb.2];
            for (code, new) in pixel.iter_mut().zip([r, g, b]) {
                let mixed = f64::from(*code) * (1.0 - color.alpha) + f64::from(new) * color.alpha;
                *code = (mixed + 0.5) as u8;
            }
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        at: BackendCoord,
    ) -> Result<(), DrawingErrorKind<Infallible>> {
        let times = magnification(style);
        let (width, height) = self.estimate_text_size(text, style)?;
        let (width, height) = (width as i32, height as i32);
        let left = match style.anchor().h_pos {
            HPos::Left => 0,
            HPos::Center => -width / 2,
            HPos::Right => -width,
        };
        let top = match style.anchor().v_pos {
            VPos::Top => 0,
            VPos::Center => -height / 2,
            VPos::Bottom => -height,
        };
        let (color, turn) = (style.color(), style.transform());
        let columns = GlyphSize::Large.width() as i32;
        for (place, character) in (0..).zip(text.chars()) {
            let glyph = GlyphSize::Large.ink(character);
            let glyph = glyph.or_else(|| GlyphSize::Large.ink('\u{fffd}'));
            for (i, &ink) in (0..)
                .zip(glyph.unwrap_or_default())
                .filter(|(_, ink)| **ink > 0)
            {
                let (x, y) = ((place * columns + i % columns) * times, i / columns * times);
                for (dx, dy) in (0..times).flat_map(|dy| (0..times).map(move |dx| (dx, dy))) {
                    let (x, y) = turn.transform(left + x + dx, top + y + dy);
                    let alpha = color.alpha * f64::from(ink) / 255.0;
                    self.draw_pixel((at.0 + x, at.1 + y), BackendColor { alpha, ..color })?;
                }
            }
        }
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let times = magnification(style) as u32;
        let characters = text.chars().count() as u32;
        Ok((
            characters * GlyphSize::Large.width() as u32 * times,
            GlyphSize::Large.height() as u32 * times,
        ))
    }
}
