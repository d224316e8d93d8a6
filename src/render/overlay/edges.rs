//! The visible edges of all triangles, as lines a pixel wide.
//!
//! The ray through each pixel's centre finds the triangle that is seen there, and the distance of the centre from that triangle's projected edges is the line. What is
//! hidden is never found, so that no depths are compared to find out what is visible, and no edge is looked at twice.
//! (Baerentzen et al., Single-pass Wireframe Rendering, 2006.)
//!
//! Half of a silhouette's line lies on what is behind it. So a pixel also draws the edges of triangles that its eight neighbours see, unless its own triangle hides
//! the nearest point of the edge. A line may so reach behind an object by a pixel, where more than one triangle of it is near.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::EDGE_COLOR;
use super::canvas::{Canvas, line_coverage, nearest_share};
use super::screen_map::ScreenMap;
use crate::accel::extents::View;
use crate::render::integrator::first_visible;
use crate::render::{PixelRect, Stage, Tracer};

/// Edge of a tile, in pixels.
const TILE: u32 = 32;

/// Height of a triangle on the screen from which its edges are drawn in full, in line widths. Lines of lower ones are fainter: they would run together and hide the
/// picture of a mesh whose triangles are smaller than pixels.
const FULL_HEIGHT: f64 = 5.0;

/// Opacity of the lines of the smallest triangles.
const LEAST_OPACITY: f64 = 0.2;

/// Draws the edges in the window of a canvas. Rays are sent for its pixels and for those around it, also beyond the picture, so that a crop shows the same.
pub(super) fn draw(
    canvas: &mut Canvas,
    stage: &Stage,
    map: &ScreenMap,
    view: &View,
    window: PixelRect,
    width: f64,
) {
    let tiles = window.tiles(TILE);
    let drawn: Vec<Vec<f32>> = tiles
        .par_iter()
        .map(|rect| Tile::new(stage, map, view, *rect).opacities(map, width))
        .collect();
    for (rect, opacities) in tiles.iter().zip(drawn) {
        for ((x, y), opacity) in rect.pixels().zip(opacities) {
            canvas.dot(x.into(), y.into(), EDGE_COLOR, opacity);
        }
    }
}

/// A triangle on the screen.
struct Drawn {
    /// In camera space.
    corners: [DVec3; 3],
    /// The parts of the edges that the picture shows, in camera space, and their places.
    edges: [Option<([DVec3; 2], [DVec2; 2])>; 3],
    opacity: f64,
}

impl Drawn {
    fn new(map: &ScreenMap, corners: [DVec3; 3]) -> Self {
        let edges = [[0, 1], [1, 2], [2, 0]].map(|ends| {
            let ends = ends.map(|i: usize| corners[i]);
            Some((map.clip(ends)?, map.segment(ends)?))
        });
        Self {
            corners,
            edges,
            opacity: 1.0,
        }
    }

    /// Fainter if the triangle is small. One that the eye's plane cuts is near.
    fn with_opacity(self, map: &ScreenMap, width: f64) -> Self {
        if map.is_perspective() && self.corners.iter().any(|p| p.z <= 0.0) {
            return self;
        }
        let [a, b, c] = self.corners.map(|p| map.place(p));
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let height = (b - a).perp_dot(c - a).abs() / longest.max(f64::MIN_POSITIVE);
        Self {
            opacity: (height / (FULL_HEIGHT * width)).clamp(LEAST_OPACITY, 1.0),
            ..self
        }
    }

    /// Whether the triangle covers a place of the screen, before a depth.
    fn hides(&self, map: &ScreenMap, place: DVec2, depth: f64) -> bool {
        let [origin, direction] = map.ray(place);
        let [a, b, c] = self.corners.map(|p| p - origin);
        // The edge functions: volumes with the ray's direction.
        let volume = |p: DVec3, q: DVec3| direction.dot(p.cross(q));
        let (of_a, of_b, of_c) = (volume(b, c), volume(c, a), volume(a, b));
        let is_inside = (of_a >= 0.0 && of_b >= 0.0 && of_c >= 0.0)
            || (of_a <= 0.0 && of_b <= 0.0 && of_c <= 0.0);
        let sum = of_a + of_b + of_c;
        is_inside && (a.z * of_a + b.z * of_b + c.z * of_c) / sum < depth
    }
}

/// What is seen through the centres of a tile's pixels and of one more all around.
struct Tile {
    rect: PixelRect,
    /// Each triangle once.
    drawn: Vec<Drawn>,
    /// Row by row, with the border.
    seen: Vec<Option<u32>>,
}

impl Tile {
    fn new(stage: &Stage, map: &ScreenMap, view: &View, rect: PixelRect) -> Self {
        let mut tracer = Tracer::new(stage.accelerator, false);
        let mut numbers = HashMap::new();
        let mut drawn = Vec::new();
        let mut seen = Vec::new();
        for row in 0..rect.height + 2 {
            for column in 0..rect.width + 2 {
                let [x, y] = [(rect.x, column), (rect.y, row)]
                    .map(|(first, i)| i64::from(first) + i64::from(i) - 1);
                let inside = |at: i64, end: u32| u32::try_from(at).ok().filter(|&at| at < end);
                // Rays beyond the picture have no pixel, and no screen extent rejects them.
                let pixel = inside(x, view.size.0).zip(inside(y, view.size.1));
                let ray = view.camera.ray(x as f64 + 0.5, y as f64 + 0.5, pixel);
                let hit = first_visible(stage, &mut tracer, ray).map(|(surface, _)| surface.hit);
                seen.push(hit.map(|hit| {
                    *numbers
                        .entry((hit.instance, hit.triangle))
                        .or_insert_with(|| {
                            let instance = &stage.scene.instances[hit.instance as usize];
                            let corners = stage.scene.mesh_of(hit.instance).triangle(hit.triangle);
                            let corners =
                                corners.corners().map(|p| map.seen(instance.world_point(p)));
                            drawn.push(Drawn::new(map, corners));
                            drawn.len() as u32 - 1
                        })
                }));
            }
        }
        Self { rect, drawn, seen }
    }

    /// How much of each pixel's colour is the lines'.
    fn opacities(self, map: &ScreenMap, width: f64) -> Vec<f32> {
        let drawn: Vec<Drawn> = self
            .drawn
            .into_iter()
            .map(|d| d.with_opacity(map, width))
            .collect();
        let columns = self.rect.width as usize + 2;
        let pixel = |(x, y): (u32, u32)| {
            let at = (y - self.rect.y) as usize * columns + (x - self.rect.x) as usize;
            let rows = [at, at + columns, at + 2 * columns];
            let own = self.seen[rows[1] + 1];
            let mut near: Vec<u32> = rows
                .iter()
                .flat_map(|&r| self.seen[r..r + 3].iter().flatten())
                .copied()
                .collect();
            near.sort_unstable();
            near.dedup();
            let place = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            let own_triangle = own.map(|own| &drawn[own as usize]);
            let opacity = near.iter().map(|&number| {
                let other = own_triangle.filter(|_| Some(number) != own);
                line_opacity(map, &drawn[number as usize], other, place, width)
            });
            opacity.fold(0.0, f64::max) as f32
        };
        self.rect.pixels().map(pixel).collect()
    }
}

/// The opacity of a triangle's lines at a place, in front of which another triangle may be.
fn line_opacity(
    map: &ScreenMap,
    drawn: &Drawn,
    other: Option<&Drawn>,
    place: DVec2,
    width: f64,
) -> f64 {
    let mut most = 0.0_f64;
    for (ends, places) in drawn.edges.iter().flatten() {
        let share = nearest_share(*places, place);
        let nearest = places[0].lerp(places[1], share);
        let opacity = drawn.opacity * line_coverage(nearest.distance(place), width);
        if opacity <= most {
            continue;
        }
        // On the screen, it is the reciprocals of depths that are straight.
        let depth = if map.is_perspective() {
            1.0 / ((1.0 - share) / ends[0].z + share / ends[1].z)
        } else {
            ends[0].z + (ends[1].z - ends[0].z) * share
        };
        if !other.is_some_and(|other| other.hides(map, nearest, depth)) {
            most = opacity;
        }
    }
    most
}
