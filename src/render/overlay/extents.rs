//! The lecture's figure "Computing Projection Extents (2)": each object's screen extent on the picture, with its name; and the outlines of its box and sphere
//! in world space beside it.
//!
//! A screen extent is drawn on its outermost pixels: it holds every pixel up to the outer side of its line. The outlines of boxes and
//! spheres are those of the shapes without the margins for rounding, which are too small to be seen.

use glam::{DVec2, Vec3};

use super::canvas::{Canvas, Color};
use super::labels::{self, Frame};
use super::screen_map::ScreenMap;
use super::silhouette::silhouette;
use super::text::Font;
use super::{BOX_COLOR, OverlayReport, PLATE_OPACITY, SCREEN_COLOR, SPHERE_COLOR};
use crate::accel::extents::{ObjectExtents, ScreenExtent};
use crate::geometry::Aabb;

/// How dark the seam beside each line is, which keeps it readable on a picture of its own colour.
const SEAM_OPACITY: f32 = 0.6;

/// Pixels between a plate's border and its text, at a scale of 1.
const PADDING: u32 = 3;

/// Share of the picture's width and height up to which the legend is shown.
const MOST_LEGEND: (f64, f64) = (0.5, 0.2);

/// Draws the extents of objects, each given with its name, on a picture of `size` pixels. Lines and text are `scale` times as large as usual.
pub(super) fn draw(
    canvas: &mut Canvas,
    map: &ScreenMap,
    size: (u32, u32),
    objects: &[(&str, &ObjectExtents)],
    scale: u32,
) -> OverlayReport {
    let screens: Vec<(&str, ScreenExtent)> = objects
        .iter()
        .filter_map(|(name, extents)| Some((*name, extents.screen?)))
        .filter(|(_, extent)| extent.area() > 0)
        .collect();
    let mut spheres = Vec::new();
    let mut boxes = Vec::new();
    for shapes in objects.iter().filter_map(|(_, extents)| extents.world) {
        boxes.extend(box_edges(map, &shapes.bounds));
        spheres.extend(shapes.sphere.iter().flat_map(|s| silhouette(map, s)));
    }
    let width = f64::from(scale);
    let frames = screens.iter().flat_map(|(_, e)| frame_lines(e, width));
    let layers = [
        (spheres, SPHERE_COLOR),
        (boxes, BOX_COLOR),
        (frames.collect(), SCREEN_COLOR),
    ];
    for (lines, _) in &layers {
        lines.iter().for_each(|&l| canvas.line(l, width + 2.0));
    }
    canvas.ink([0.0; 3], SEAM_OPACITY);
    for (lines, color) in &layers {
        lines.iter().for_each(|&l| canvas.line(l, width));
        canvas.ink(*color, 1.0);
    }
    let font = Font::of_scale(scale);
    let legend = Legend::new(size, font, scale);
    legend.draw(canvas);
    let named = draw_names(canvas, size, legend.frame, &screens, font, scale);
    OverlayReport {
        objects: objects.len(),
        on_picture: screens.len(),
        named,
        without_screen_extent: objects.iter().filter(|(_, e)| e.screen.is_none()).count(),
    }
}

/// Middles of the four lines that fill an extent's outermost pixels.
fn frame_lines(extent: &ScreenExtent, width: f64) -> [[DVec2; 2]; 4] {
    let inset = 0.5 * width;
    let [left, top] = [extent.left, extent.top].map(|first| f64::from(first) + inset);
    let [right, bottom] = [extent.right, extent.bottom].map(|last| f64::from(last) + 1.0 - inset);
    let corners = [(left, top), (right, top), (right, bottom), (left, bottom)].map(DVec2::from);
    [[0, 1], [1, 2], [2, 3], [3, 0]].map(|ends| ends.map(|i: usize| corners[i]))
}

/// The edges of a box on the screen, as far as they are in the picture.
fn box_edges(map: &ScreenMap, bounds: &Aabb) -> Vec<[DVec2; 2]> {
    let corner = |i: usize| {
        let pick = |axis: usize| [bounds.min, bounds.max][i >> axis & 1][axis];
        map.seen(Vec3::new(pick(0), pick(1), pick(2)))
    };
    let starts = (0..3).flat_map(|axis| (0..8).map(move |i| (i, 1 << axis)));
    let edges = starts.filter(|(from, step)| from & step == 0);
    edges
        .filter_map(|(from, step)| map.segment([corner(from), corner(from | step)]))
        .collect()
}

/// Draws as many names as find a place, and tells how many.
fn draw_names(
    canvas: &mut Canvas,
    size: (u32, u32),
    legend: Option<Frame>,
    screens: &[(&str, ScreenExtent)],
    font: Font,
    scale: u32,
) -> usize {
    let texts: Vec<String> = screens
        .iter()
        .map(|(name, _)| font.printable(name))
        .collect();
    let padding = PADDING * scale;
    let names: Vec<_> = screens
        .iter()
        .zip(&texts)
        .map(|((_, extent), text)| (*extent, (font.width(text) + 2 * padding, font.height())))
        .collect();
    let taken: Vec<Frame> = legend.into_iter().collect();
    let places = labels::place(size, &taken, &names);
    for (frame, text) in places.iter().zip(&texts) {
        if let Some(frame) = frame {
            canvas.plate(*frame, [0.0; 3], PLATE_OPACITY);
            let corner = (frame[0] + i64::from(padding), frame[1]);
            font.draw(canvas, corner, text, SCREEN_COLOR);
        }
    }
    places.iter().flatten().count()
}

/// What the colours mean, in the lower left corner of pictures that are large enough.
struct Legend {
    /// `None` if there is none.
    frame: Option<Frame>,
    font: Font,
    scale: u32,
}

impl Legend {
    const LINES: [(&str, Color); 3] = [
        ("screen extent", SCREEN_COLOR),
        ("world box", BOX_COLOR),
        ("world sphere", SPHERE_COLOR),
    ];

    /// Width of the piece of line before each text, at a scale of 1.
    const PIECE: u32 = 18;

    fn new(size: (u32, u32), font: Font, scale: u32) -> Self {
        let widths = Self::LINES.map(|(text, _)| font.width(text));
        let text = widths.into_iter().max().unwrap_or_default();
        let width = text + (Self::PIECE + 3 * PADDING) * scale;
        let height = font.height() * Self::LINES.len() as u32 + 2 * PADDING * scale;
        let fits = f64::from(width) <= MOST_LEGEND.0 * f64::from(size.0)
            && f64::from(height) <= MOST_LEGEND.1 * f64::from(size.1);
        let [left, bottom] = [
            i64::from(4 * scale),
            i64::from(size.1) - i64::from(4 * scale),
        ];
        let frame = [
            left,
            bottom - i64::from(height),
            left + i64::from(width),
            bottom,
        ];
        Self {
            frame: fits.then_some(frame),
            font,
            scale,
        }
    }

    fn draw(&self, canvas: &mut Canvas) {
        let Some(frame) = self.frame else { return };
        canvas.plate(frame, [0.0; 3], PLATE_OPACITY);
        let padding = i64::from(PADDING * self.scale);
        let left = frame[0] + padding;
        let piece = i64::from(Self::PIECE * self.scale);
        for (row, (text, color)) in (0_i64..).zip(Self::LINES) {
            let top = frame[1] + padding + row * i64::from(self.font.height());
            let middle = top + i64::from(self.font.height() / 2);
            let half = i64::from(self.scale);
            canvas.plate(
                [left, middle - half, left + piece, middle + half],
                color,
                1.0,
            );
            let corner = (left + piece + padding, top);
            self.font.draw(canvas, corner, text, [1.0; 3]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::screen_map::tests::{PERSPECTIVE, SIZE, frame};
    use super::*;
    use crate::render::PixelRect;

    #[test]
    fn the_frame_of_an_extent_is_on_its_outermost_pixels() {
        let extent = ScreenExtent {
            left: 3,
            right: 9,
            top: 5,
            bottom: 17,
        };
        let window = PixelRect {
            x: 0,
            y: 0,
            width: 20,
            height: 20,
        };
        for width in [1_u32, 2] {
            let mut canvas = Canvas::new(window);
            for line in frame_lines(&extent, width.into()) {
                canvas.line(line, width.into());
            }
            canvas.ink([1.0; 3], 1.0);
            for ((x, y), pixel) in window.pixels().zip(canvas.into_pixels()) {
                let inner =
                    |first: u32, last: u32, at: u32| (first + width..=last - width).contains(&at);
                let is_line = extent.contains(x, y) && !(inner(3, 9, x) && inner(5, 17, y));
                // Round corners of wide lines lose a little.
                assert!(
                    if is_line {
                        pixel[3] > 0.7
                    } else {
                        pixel[3] == 0.0
                    },
                    "{x} {y} {pixel:?}"
                );
            }
        }
    }

    #[test]
    fn a_box_has_twelve_edges_of_which_each_corner_has_three() {
        let map = ScreenMap::new(&frame(PERSPECTIVE), SIZE);
        let bounds = Aabb {
            min: Vec3::new(-0.5, 0.0, -2.0),
            max: Vec3::new(0.5, 2.0, 1.0),
        };
        let edges = box_edges(&map, &bounds);
        assert_eq!(edges.len(), 12);
        for i in 0..8 {
            let pick = |axis: usize| {
                if i >> axis & 1 == 0 {
                    bounds.min[axis]
                } else {
                    bounds.max[axis]
                }
            };
            let place = map.place(map.seen(Vec3::new(pick(0), pick(1), pick(2))));
            let ends = edges
                .iter()
                .flatten()
                .filter(|end| end.distance(place) < 1e-6);
            assert_eq!(ends.count(), 3);
        }
    }

    #[test]
    fn the_legend_is_left_out_of_small_pictures() {
        let legend = |size| Legend::new(size, Font::of_scale(1), 1).frame;
        assert_eq!(legend((64, 64)), None);
        let [left, top, right, bottom] = legend((640, 480)).unwrap();
        assert!(left > 0 && right < 200 && top > 400 && bottom < 480);
    }
}
