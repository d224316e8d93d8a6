//! Where samples gather: a picture in tiles, each of which one thread fills at a time.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::integrator::Sample;
use super::partition::FragmentPoint;
use super::tracer::RayCounts;
use crate::accel::{Hit, TraceCounters};

/// Edge of a tile, in pixels.
const TILE: u32 = 32;

/// A rectangle of pixels; columns and rows count from the full picture's top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    /// Leftmost column.
    pub x: u32,
    /// Topmost row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl PixelRect {
    /// Number of pixels.
    pub fn area(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Columns and rows of all pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let Self {
            x,
            y,
            width,
            height,
        } = *self;
        (y..y + height).flat_map(move |row| (x..x + width).map(move |column| (column, row)))
    }

    /// The rectangle in squares with an edge of `size` pixels, row by row; those on the right and at the bottom may be smaller.
    pub(super) fn tiles(&self, size: u32) -> Vec<Self> {
        let mut tiles = Vec::new();
        for y in (0..self.height).step_by(size as usize) {
            for x in (0..self.width).step_by(size as usize) {
                tiles.push(Self {
                    x: self.x + x,
                    y: self.y + y,
                    width: size.min(self.width - x),
                    height: size.min(self.height - y),
                });
            }
        }
        tiles
    }
}

/// What the ray through a pixel's centre met first, never filtered.
#[derive(Clone, Copy, Debug)]
pub struct FirstHit {
    /// The hit.
    pub hit: Hit,
    /// Index of the scene's material.
    pub material: u32,
    /// Depth along the view axis, in model units.
    pub depth: f32,
    /// Distance from the eye, in model units.
    pub distance: f32,
    /// Place in world space.
    pub position: Vec3,
    /// Shading normal, in world space, towards the eye.
    pub shading_normal: Vec3,
    /// Geometric normal, in world space, towards the eye.
    pub geometric_normal: Vec3,
    /// First set of texture coordinates.
    pub uv: Vec2,
    /// Linear base colour.
    pub albedo: Vec3,
    /// The fragment of the polygon BSP; `None` where the stage has no trees.
    pub fragment: Option<FragmentPoint>,
}

/// The sums of one pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct PixelSum {
    /// Linear radiance of surfaces, multiplied by their coverage.
    pub color: Vec3,
    /// Coverage.
    pub alpha: f32,
    /// Linear radiance from behind the surfaces.
    pub backdrop: Vec3,
    /// Number of samples.
    pub samples: u32,
    /// Steps of traversal of all its rays, where they are counted.
    pub cost: TraceCounters,
}

impl PixelSum {
    pub(super) fn add(&mut self, sample: &Sample) {
        self.color += sample.color;
        self.alpha += sample.alpha;
        self.backdrop += sample.backdrop;
        self.samples += 1;
    }

    /// The mean of the samples; black before the first.
    pub fn mean(&self) -> Sample {
        let share = 1.0 / self.samples.max(1) as f32;
        Sample {
            color: self.color * share,
            alpha: self.alpha * share,
            backdrop: self.backdrop * share,
            ..Sample::default()
        }
    }
}

/// A part of the picture.
#[derive(Debug)]
pub(super) struct Tile {
    pub(super) rect: PixelRect,
    pub(super) sums: Vec<PixelSum>,
    /// Empty until first hits are looked up.
    pub(super) first_hits: Vec<Option<FirstHit>>,
    pub(super) rays: RayCounts,
}

/// A picture in the making, or finished.
#[derive(Debug)]
pub struct Film {
    /// Width and height of the full picture.
    pub size: (u32, u32),
    /// The part of it that is rendered.
    pub window: PixelRect,
    pub(super) tiles: Vec<Tile>,
    /// Whether every pixel has all its samples.
    pub is_complete: bool,
    /// Whether first hits know their fragments of the polygon BSP.
    pub has_fragments: bool,
}

impl Film {
    /// A black film for `window` of a picture of `size`.
    pub(super) fn new(size: (u32, u32), window: PixelRect) -> Self {
        let tile = |rect: PixelRect| Tile {
            rect,
            sums: vec![PixelSum::default(); rect.area() as usize],
            first_hits: Vec::new(),
            rays: RayCounts::default(),
        };
        let tiles = window.tiles(TILE).into_iter().map(tile).collect();
        Self {
            size,
            window,
            tiles,
            is_complete: false,
            has_fragments: false,
        }
    }

    /// Rays sent for all pixels.
    pub fn rays(&self) -> RayCounts {
        let mut sum = RayCounts::default();
        self.tiles.iter().for_each(|t| sum += t.rays);
        sum
    }

    /// Steps of traversal of all pixels, where they were counted.
    pub fn cost(&self) -> TraceCounters {
        let mut sum = TraceCounters::default();
        self.tiles
            .iter()
            .flat_map(|t| &t.sums)
            .for_each(|p| sum += p.cost);
        sum
    }

    /// Samples of all pixels.
    pub fn samples(&self) -> u64 {
        self.tiles
            .iter()
            .flat_map(|t| &t.sums)
            .map(|p| u64::from(p.samples))
            .sum()
    }

    /// A value of every pixel of the window, row by row from the top. Rows of tiles are worked on in parallel.
    pub fn map<T: Clone + Default + Send>(
        &self,
        value: impl Fn(&PixelSum, Option<&FirstHit>) -> T + Sync,
    ) -> Vec<T> {
        let width = self.window.width as usize;
        let mut values = vec![T::default(); self.window.area() as usize];
        let bands = values.par_chunks_mut(width * TILE as usize);
        bands
            .zip(self.tiles.par_chunks(width.div_ceil(TILE as usize)))
            .for_each(|(band, tiles)| {
                for tile in tiles {
                    for (index, ((x, y), sum)) in tile.rect.pixels().zip(&tile.sums).enumerate() {
                        let first = tile.first_hits.get(index).and_then(Option::as_ref);
                        let row = (y - tile.rect.y) as usize;
                        band[row * width + (x - self.window.x) as usize] = value(sum, first);
                    }
                }
            });
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_window_once() {
        let window = PixelRect {
            x: 7,
            y: 11,
            width: 70,
            height: 33,
        };
        let mut film = Film::new((200, 100), window);
        assert_eq!(film.tiles.len(), 6);
        for tile in &mut film.tiles {
            for (pixel, sum) in tile.rect.pixels().zip(&mut tile.sums) {
                sum.color = Vec3::new(pixel.0 as f32, pixel.1 as f32, 0.0);
                sum.samples += 1;
            }
        }
        let places = film.map(|sum, first| {
            assert!(sum.samples == 1 && first.is_none());
            (sum.color.x as u32, sum.color.y as u32)
        });
        assert_eq!(places, window.pixels().collect::<Vec<_>>());
        assert_eq!(film.samples(), 70 * 33);
    }
}
