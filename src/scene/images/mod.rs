//! Images: their pixels, what their numbers mean, and their levels of detail.

mod levels;
mod texel;

pub(crate) use levels::Pyramid;
use rayon::prelude::*;
pub(crate) use texel::{fetch, fetch_four};

use super::Scene;

/// The pixels of an image, row by row from the top, as RGBA.
///
/// They are the file's numbers: whether they are sRGB-encoded or linear is the affair of the slot that uses them.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// 8 bits a channel, 255 is 1.
    Rgba8(Vec<[u8; 4]>),
    /// 16 bits a channel, 65,535 is 1.
    Rgba16(Vec<[u16; 4]>),
    /// Floating point, always linear.
    RgbaF32(Vec<[f32; 4]>),
}

/// What an image's numbers mean: the affair of the slot of a material that uses it. Floating-point images are linear in any slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// sRGB-encoded colours; alpha is linear.
    Srgb,
    /// Plain numbers.
    Linear,
}

/// An image of the scene.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Name or path in the file.
    pub name: String,
    /// Width in the file, in pixels; 0 when the image could not be read.
    pub width: u32,
    /// Height in the file, in pixels; 0 when the image could not be read.
    pub height: u32,
    /// The finest level of detail that is kept: 0 for the image as it is in the file, and each further one has half the texels along either side.
    pub finest: u32,
    /// Pixels of that level, or `None` when nothing that is rendered uses them or they could not be read; a note says which.
    pub pixels: Option<Pixels>,
}

/// The finest detail of an image that pictures show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownDetail {
    /// Least width of the patches that lookups stand for, in units of the image's width and height: the side of a square of the same area.
    pub width: f32,
    /// What the image's numbers mean in all slots that use it.
    pub space: ColorSpace,
}

impl Image {
    /// Width and height of the pixels that are kept.
    pub fn size(&self) -> (u32, u32) {
        let side = |side: u32| (side >> self.finest.min(31)).max(side.min(1));
        (side(self.width), side(self.height))
    }

    /// Bytes of the pixels that are kept; 0 if they were not read.
    pub fn bytes(&self) -> u64 {
        let bytes = |pixels| levels::bytes(pixels, self.size());
        self.pixels.as_ref().map_or(0, bytes)
    }

    /// Bytes of the pixels as they are in the file; 0 if they were not read.
    pub fn whole_bytes(&self) -> u64 {
        let bytes = |pixels| levels::bytes(pixels, (self.width, self.height));
        self.pixels.as_ref().map_or(0, bytes)
    }

    /// Drops the levels that are finer than any that is shown.
    ///
    /// ```
    /// use bspray::scene::{ColorSpace, Image, Pixels, ShownDetail};
    /// let pixels = Some(Pixels::Rgba8(vec![[8; 4]; 32]));
    /// let mut image = Image { width: 8, height: 4, pixels, ..Image::default() };
    /// // A square of as much area as 11 texels.
    /// image.keep(ShownDetail { width: 0.6, space: ColorSpace::Linear });
    /// assert_eq!((image.finest, image.size(), image.bytes(), image.whole_bytes()), (1, (4, 2), 32, 128));
    /// ```
    pub fn keep(&mut self, shown: ShownDetail) {
        let texels = self.width as f32 * self.height as f32;
        let level = libm::log2f(shown.width) + 0.5 * libm::log2f(texels) - ROUNDING;
        while level >= (self.finest + 1) as f32
            && let Some(pixels) = &self.pixels
            && let Some(coarser) = levels::below(pixels, self.size(), shown.space)
        {
            self.pixels = Some(coarser);
            self.finest += 1;
        }
    }
}

impl Scene {
    /// Drops of each image the levels that are finer than any that is shown, by the threads of the rayon pool in which it is called.
    pub fn keep_shown(&mut self, shown: &[Option<ShownDetail>]) {
        let images = self.images.par_iter_mut().with_max_len(1);
        images.zip(shown).for_each(|(image, shown)| {
            if let Some(shown) = shown {
                image.keep(*shown);
            }
        });
    }
}

/// What roundings may make of a level: widths are products of a few single-precision numbers.
const ROUNDING: f32 = 1e-3;
