//! Lines, plates and grey pixels on a transparent picture. Places are in pixels from the full picture's top left corner, pixel centres at halves;
//! colours are linear.
//!
//! A pixel's share in a line follows from the distance between its centre and the line alone. So no crop changes a pixel, lines that
//! meet leave no knots, and a line along pixels that goes through their centres is crisp.

use glam::DVec2;

use crate::render::PixelRect;

/// A linear colour.
pub(super) type Color = [f32; 3];

/// The share of a pixel that a line covers whose middle passes at `distance` from the pixel's centre: 1 within the line, 0 half a pixel beside it, straight
/// between. Exact for lines along rows and columns that are at least a pixel wide, and within 0.09 for others; each has its width in pixels on the average.
pub(super) fn line_coverage(distance: f64, width: f64) -> f64 {
    (0.5 * width + 0.5 - distance).clamp(0.0, 1.0)
}

/// The point of a segment that is next to `place`: its share of the way from the first end to the second, and the point.
pub(super) fn nearest([a, b]: [DVec2; 2], place: DVec2) -> (f64, DVec2) {
    let along = b - a;
    let squared = along.length_squared();
    let share = if squared > 0.0 {
        ((place - a).dot(along) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    // In this form a line along pixels stays on them: no `lerp`.
    (share, a + along * share)
}

/// What is drawn on a part of the picture.
pub(super) struct Canvas {
    window: PixelRect,
    /// Premultiplied.
    pixels: Vec<[f32; 4]>,
    /// Of the lines that wait for their ink.
    coverage: Vec<f32>,
}

impl Canvas {
    /// A transparent canvas.
    pub(super) fn new(window: PixelRect) -> Self {
        let area = window.area() as usize;
        Self {
            window,
            pixels: vec![[0.0; 4]; area],
            coverage: vec![0.0; area],
        }
    }

    /// The pixels, row by row from the top, premultiplied.
    pub(super) fn into_pixels(self) -> Vec<[f32; 4]> {
        self.pixels
    }

    /// Adds a line of a width in pixels, with round ends, to those that wait for their ink.
    pub(super) fn line(&mut self, ends: [DVec2; 2], width: f64) {
        let [a, b] = ends;
        let radius = 0.5 * width + 0.5;
        let (top, bottom) = (a.y.min(b.y) - radius, a.y.max(b.y) + radius);
        for y in centers(top, bottom, self.window.y, self.window.height) {
            let center = f64::from(y) + 0.5;
            // The part of the segment that is near this row.
            let at = |row: f64| ((row - a.y) / (b.y - a.y)).clamp(0.0, 1.0);
            let shares = if (b.y - a.y).abs() > radius {
                [at(center - radius), at(center + radius)]
            } else {
                [0.0, 1.0]
            };
            let [x0, x1] = shares.map(|share| a.lerp(b, share).x);
            let (left, right) = (x0.min(x1) - radius, x0.max(x1) + radius);
            for x in centers(left, right, self.window.x, self.window.width) {
                let place = DVec2::new(f64::from(x) + 0.5, center);
                let (_, point) = nearest(ends, place);
                let share = line_coverage(point.distance(place), width) as f32;
                if let Some(at) = self.index(i64::from(x), i64::from(y)) {
                    self.coverage[at] = self.coverage[at].max(share);
                }
            }
        }
    }

    /// Inks all lines that wait, once where they cross.
    pub(super) fn ink(&mut self, color: Color, opacity: f32) {
        for (pixel, coverage) in self.pixels.iter_mut().zip(&mut self.coverage) {
            lay_over(pixel, color, opacity * std::mem::take(coverage));
        }
    }

    /// Fills a rectangle, given by its left, top, right and bottom edges in pixels.
    pub(super) fn plate(
        &mut self,
        [left, top, right, bottom]: [i64; 4],
        color: Color,
        opacity: f32,
    ) {
        for y in top..bottom {
            for x in left..right {
                self.dot(x, y, color, opacity);
            }
        }
    }

    /// Lays a colour over one pixel; nothing outside of the window.
    pub(super) fn dot(&mut self, x: i64, y: i64, color: Color, opacity: f32) {
        if let Some(at) = self.index(x, y) {
            lay_over(&mut self.pixels[at], color, opacity);
        }
    }

    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let column = u32::try_from(x - i64::from(self.window.x)).ok()?;
        let row = u32::try_from(y - i64::from(self.window.y)).ok()?;
        let is_inside = column < self.window.width && row < self.window.height;
        is_inside.then(|| row as usize * self.window.width as usize + column as usize)
    }
}

/// The pixels of a window whose centres are from `from` to `to`.
fn centers(from: f64, to: f64, first: u32, count: u32) -> std::ops::Range<u32> {
    let end = f64::from(first) + f64::from(count);
    let low = (from - 0.5).ceil().clamp(f64::from(first), end);
    let high = ((to - 0.5).floor() + 1.0).clamp(low, end);
    low as u32..high as u32
}

fn lay_over(pixel: &mut [f32; 4], [r, g, b]: Color, opacity: f32) {
    if opacity > 0.0 {
        for (value, over) in pixel.iter_mut().zip([r, g, b, 1.0]) {
            *value = over * opacity + *value * (1.0 - opacity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: PixelRect = PixelRect {
        x: 10,
        y: 20,
        width: 60,
        height: 40,
    };

    fn alphas(window: PixelRect, ends: [DVec2; 2], width: f64) -> Vec<f32> {
        let mut canvas = Canvas::new(window);
        canvas.line(ends, width);
        canvas.ink([1.0, 0.5, 0.25], 1.0);
        canvas.into_pixels().iter().map(|p| p[3]).collect()
    }

    #[test]
    fn a_line_through_pixel_centres_is_crisp() {
        let ends = [DVec2::new(15.5, 30.5), DVec2::new(25.5, 30.5)];
        let found = alphas(WINDOW, ends, 1.0);
        for ((x, y), alpha) in WINDOW.pixels().zip(found) {
            let is_on = y == 30 && (15..=25).contains(&x);
            assert_eq!(alpha, if is_on { 1.0 } else { 0.0 }, "{x} {y}");
        }
    }

    /// Against the share of 32 x 32 points in each pixel that are in the line's strip.
    #[test]
    fn coverage_is_close_to_that_of_many_points() {
        let ends = [DVec2::new(-30.0, 11.3), DVec2::new(113.0, 71.9)];
        let along = (ends[1] - ends[0]).normalize();
        for width in [1.0, 1.5, 3.0] {
            let mut sums = [0.0; 2];
            for ((x, y), alpha) in WINDOW.pixels().zip(alphas(WINDOW, ends, width)) {
                let mut inside = 0;
                for i in 0..32 * 32 {
                    let (i, j) = (f64::from(i % 32), f64::from(i / 32));
                    let place = DVec2::new(f64::from(x), f64::from(y))
                        + (DVec2::new(i, j) + 0.5) / 32.0
                        - ends[0];
                    inside += u32::from(along.perp_dot(place).abs() <= width / 2.0);
                }
                let want = f64::from(inside) / 1024.0;
                let off = (f64::from(alpha) - want).abs();
                assert!(off < 0.09, "{x} {y}: {alpha} instead of {want}");
                sums = [sums[0] + f64::from(alpha), sums[1] + want];
            }
            assert!((sums[0] / sums[1] - 1.0).abs() < 0.02, "{width}: {sums:?}");
        }
    }

    #[test]
    fn a_crop_shows_the_same_pixels() {
        let crop = PixelRect {
            x: 33,
            y: 31,
            width: 9,
            height: 8,
        };
        for ends in [
            [DVec2::new(12.0, 50.0), DVec2::new(68.2, 12.7)],
            [DVec2::new(40.1, -1e6), DVec2::new(38.0, 1e6)],
        ] {
            let all = alphas(WINDOW, ends, 1.5);
            let cut = WINDOW
                .pixels()
                .zip(&all)
                .filter(|((x, y), _)| (33..42).contains(x) && (31..39).contains(y));
            let cut: Vec<f32> = cut.map(|(_, alpha)| *alpha).collect();
            assert!(cut.iter().any(|a| *a > 0.5));
            assert_eq!(alphas(crop, ends, 1.5), cut);
        }
    }

    #[test]
    fn lines_of_one_ink_are_laid_once_and_colours_over_one_another() {
        let mut canvas = Canvas::new(WINDOW);
        let cross = [20.5, 25.5].map(|x| DVec2::new(x, 25.5));
        canvas.line(cross, 1.0);
        canvas.line([cross[1], cross[0]], 1.0);
        canvas.ink([0.8, 0.4, 0.2], 0.5);
        canvas.dot(22, 25, [0.0, 1.0, 0.0], 0.25);
        canvas.dot(9, 25, [0.0, 1.0, 0.0], 0.25);
        canvas.plate([5, 10, 11, 21], [1.0; 3], 1.0);
        let pixels = canvas.into_pixels();
        let at = |x: usize, y: usize| pixels[(y - 20) * 60 + x - 10];
        assert_eq!(at(21, 25), [0.4, 0.2, 0.1, 0.5]);
        assert_eq!(at(22, 25), [0.3, 0.4, 0.075, 0.625]);
        assert_eq!((at(10, 20), at(11, 20)), ([1.0; 4], [0.0; 4]));
    }
}
