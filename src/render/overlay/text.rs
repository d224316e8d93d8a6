//! Names as pixels.

use super::canvas::{Canvas, Color};
use crate::picture::glyphs::GlyphSize;

/// Longest name that is written out, in characters.
const LONGEST: usize = 24;

/// What stands for the middle of a longer one: what tells names apart is at either end.
const GAP: &str = "..";

/// Characters of a longer name before the gap.
const HEAD: usize = 14;

/// Stands for a character that the font has not.
const UNKNOWN: char = '\u{fffd}';

/// A line of text of one of two heights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Font(GlyphSize);

impl Font {
    /// The font for a scale of 1, or of more.
    pub(super) fn of_scale(scale: u32) -> Self {
        Self(if scale > 1 {
            GlyphSize::Large
        } else {
            GlyphSize::Small
        })
    }

    /// Height of a line, in pixels.
    pub(super) fn height(self) -> u32 {
        self.0.height() as u32
    }

    /// Width of a text, in pixels: all characters have the same.
    pub(super) fn width(self, text: &str) -> u32 {
        (text.chars().count() * self.0.width()) as u32
    }

    fn has(self, character: char) -> bool {
        let glyph = self.0.ink(character);
        // A soft hyphen and the like have a glyph without ink.
        character == ' ' || glyph.is_some_and(|g| g.iter().any(|&ink| ink > 0))
    }

    /// A name that can be drawn: characters that the font has not are replaced, and a long name loses its middle.
    pub(super) fn printable(self, name: &str) -> String {
        let known: Vec<char> = name
            .trim()
            .chars()
            .map(|c| if self.has(c) { c } else { UNKNOWN })
            .collect();
        if known.len() <= LONGEST {
            return known.into_iter().collect();
        }
        let tail = LONGEST - HEAD - GAP.len();
        let head = known[..HEAD].iter();
        let tail = known[known.len() - tail..].iter();
        head.copied()
            .chain(GAP.chars())
            .chain(tail.copied())
            .collect()
    }

    /// Draws a text whose top left corner is at a place.
    pub(super) fn draw(
        self,
        canvas: &mut Canvas,
        (left, top): (i64, i64),
        text: &str,
        color: Color,
    ) {
        let mut left = left;
        for character in text.chars() {
            let Some(glyph) = self.0.ink(character) else {
                continue;
            };
            for (y, row) in (top..).zip(glyph.chunks(self.0.width())) {
                for (x, ink) in (left..).zip(row) {
                    canvas.dot(x, y, color, f32::from(*ink) / 255.0);
                }
            }
            left += self.0.width() as i64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::PixelRect;

    #[test]
    fn names_are_shortened_in_the_middle_and_unknown_characters_show() {
        let font = Font::of_scale(1);
        assert_eq!(font.printable(" Ball.001 "), "Ball.001");
        assert_eq!(font.printable("Größe Łódź"), "Größe Łódź");
        assert_eq!(
            font.printable("椅子 a\u{7}b\u{301}"),
            "\u{fffd}\u{fffd} a\u{fffd}b\u{fffd}"
        );
        let long = font.printable("a_very_long_name_of_an_object_0012");
        assert_eq!(long, "a_very_long_na..ect_0012");
        assert_eq!(long.chars().count(), LONGEST);
    }

    #[test]
    fn a_text_fills_its_measure_and_no_more() {
        let window = PixelRect {
            x: 0,
            y: 0,
            width: 120,
            height: 50,
        };
        for scale in [1, 2] {
            let font = Font::of_scale(scale);
            let mut canvas = Canvas::new(window);
            font.draw(&mut canvas, (10, 5), "Mg\u{fffd}", [1.0; 3]);
            let (width, height) = (font.width("Mg\u{fffd}"), font.height());
            assert_eq!((width % 3, height), (0, 16 * scale));
            let inked = window.pixels().zip(canvas.into_pixels());
            let inked: Vec<_> = inked
                .filter(|(_, p)| p[3] > 0.0)
                .map(|(at, _)| at)
                .collect();
            let is_inside = |&(x, y): &(u32, u32)| {
                (10..10 + width).contains(&x) && (5..5 + height).contains(&y)
            };
            assert!(inked.len() > 60 && inked.iter().all(is_inside));
            // Each third of it has ink.
            for third in 0..3 {
                let (from, to) = (10 + width / 3 * third, 10 + width / 3 * (third + 1));
                assert!(inked.iter().any(|(x, _)| (from..to).contains(x)));
            }
        }
    }
}
