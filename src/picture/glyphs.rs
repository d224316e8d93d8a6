//! Characters as pixels, on machines without fonts: the only file that names the crate `noto-sans-mono-bitmap` (Noto Sans Mono, SIL Open Font
//! License).
//!
//! ```
//! use bspray::picture::glyphs::GlyphSize;
//! let ink = GlyphSize::Small.ink('A').ok_or("a letter")?;
//! assert_eq!(ink.len(), 16 * GlyphSize::Small.width());
//! # Ok::<(), &str>(())
//! ```

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// The heights that there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GlyphSize {
    /// A line of 16 pixels.
    Small,
    /// A line of 32 pixels.
    Large,
}

impl GlyphSize {
    fn raster(self) -> RasterHeight {
        match self {
            Self::Small => RasterHeight::Size16,
            Self::Large => RasterHeight::Size32,
        }
    }

    /// Height of a line, in pixels.
    pub fn height(self) -> usize {
        self.raster().val()
    }

    /// Width of every character, in pixels.
    pub fn width(self) -> usize {
        get_raster_width(FontWeight::Regular, self.raster())
    }

    /// Ink of a character, row by row from the top, 255 for full; `None` for one that the font has not.
    pub fn ink(self, character: char) -> Option<&'static [u8]> {
        get_raster(character, FontWeight::Regular, self.raster()).map(|glyph| glyph.pixels())
    }
}
