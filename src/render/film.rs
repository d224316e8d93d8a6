//! Where samples gather: a picture in tiles, each of which one thread fills at a time.

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::adaptive::Adaptive;
use super::cryptomatte::{MatteKind, TileMattes};
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

    /// The number of a pixel of the rectangle, in the order of [`PixelRect::pixels`].
    pub(super) fn index(&self, x: u32, y: u32) -> usize {
        ((y - self.y) * self.width + (x - self.x)) as usize
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
    /// Weights of the triangle's second and third corner.
    pub barycentric: (f32, f32),
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

    /// What 1 is of one sample, before the first 1.
    fn share(&self) -> f32 {
        1.0 / self.samples.max(1) as f32
    }

    /// The mean of the samples' colour, coverage and backdrop; black before the first. The parts of the colour are in [`LayerSum`].
    pub fn mean(&self) -> Sample {
        let share = self.share();
        Sample {
            color: self.color * share,
            alpha: self.alpha * share,
            backdrop: self.backdrop * share,
            ..Sample::default()
        }
    }
}

/// Further sums of one pixel, for files of layers.
#[derive(Clone, Copy, Debug, Default)]
pub struct LayerSum {
    direct: Vec3,
    indirect: Vec3,
    diffuse_albedo: Vec3,
    specular_albedo: Vec3,
    normal: Vec3,
    /// Mean of colour and backdrop together, and the sum of the squares of its samples' distances from it (Welford 1962): no large numbers
    /// that cancel, and none at all for equal samples.
    seen: DVec3,
    squares: DVec3,
}

impl LayerSum {
    /// Adds the pixel's `count`th sample, from 1.
    pub(super) fn add(&mut self, sample: &Sample, count: u32) {
        self.direct += sample.direct;
        self.indirect += sample.indirect;
        self.diffuse_albedo += sample.diffuse_albedo;
        self.specular_albedo += sample.specular_albedo;
        self.normal += sample.normal;
        let seen = (sample.color + sample.backdrop).as_dvec3();
        let step = seen - self.seen;
        self.seen += step / f64::from(count);
        self.squares += step * (seen - self.seen);
    }
}

/// What a film knows of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Pixel<'a> {
    /// Its sums.
    pub sum: &'a PixelSum,
    /// What the ray through its centre met; `None` also where that was not asked.
    pub first: Option<&'a FirstHit>,
    /// Further sums; `None` where no layers were asked for.
    pub layers: Option<&'a LayerSum>,
    /// What covers the pixels of its tile, and its index among them.
    mattes: (&'a TileMattes, usize),
}

impl Pixel<'_> {
    /// The mean of the samples; black before the first. What is only in layers is zero without them.
    pub fn mean(&self) -> Sample {
        let mean = self.sum.mean();
        let Some(layers) = self.layers else {
            return mean;
        };
        let share = self.sum.share();
        Sample {
            direct: layers.direct * share,
            indirect: layers.indirect * share,
            diffuse_albedo: layers.diffuse_albedo * share,
            specular_albedo: layers.specular_albedo * share,
            normal: layers.normal * share,
            ..mean
        }
    }

    /// The six ids of the greatest coverage, with the share of the pixel that each covers; zeroes behind the last. None without layers.
    pub(super) fn matte_ranks(&self, kind: MatteKind) -> [(u32, f32); 6] {
        let (tile, index) = self.mattes;
        match self.layers {
            Some(_) => tile.ranks(kind, index, self.sum.samples),
            None => [(0, 0.0); 6],
        }
    }

    /// The variance of the mean of colour and backdrop that as many independent samples would have, estimated from the samples: their own
    /// variance over their number. That of stratified samples, as ours are, is less. Zero before the second sample, and without layers.
    pub fn variance(&self) -> Vec3 {
        let count = f64::from(self.sum.samples);
        match self.layers {
            Some(layers) if count > 1.0 => (layers.squares / ((count - 1.0) * count)).as_vec3(),
            _ => Vec3::ZERO,
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
    /// Empty unless layers are asked for.
    pub(super) layers: Vec<LayerSum>,
    /// Empty unless layers are asked for.
    pub(super) mattes: TileMattes,
    /// Knows nothing unless noise is asked for.
    pub(super) adaptive: Adaptive,
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
            layers: Vec::new(),
            mattes: TileMattes::default(),
            adaptive: Adaptive::default(),
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

    /// Samples of the pixel that has most.
    pub fn most_samples(&self) -> u32 {
        let sums = self.tiles.iter().flat_map(|t| &t.sums);
        sums.map(|p| p.samples).max().unwrap_or(0)
    }

    /// Pixels that would get more samples: those for which the noise asked for is not reached, or all if none was asked for.
    pub fn open_pixels(&self) -> u64 {
        let tiles = self.tiles.iter();
        tiles.map(|t| t.adaptive.open_pixels(&t.rect)).sum()
    }

    /// The tiles, each for the next thread that is free: some take many times as long as others, and shares of equal numbers would leave all threads but one idle in the end.
    pub(super) fn tiles_apart(&mut self) -> impl IndexedParallelIterator<Item = &mut Tile> {
        self.tiles.par_iter_mut().with_max_len(1)
    }

    /// A value of every pixel of the window, row by row from the top. Rows of tiles are worked on in parallel.
    pub fn map<T: Clone + Default + Send>(&self, value: impl Fn(&Pixel) -> T + Sync) -> Vec<T> {
        let width = self.window.width as usize;
        let mut values = vec![T::default(); self.window.area() as usize];
        let bands = values.par_chunks_mut(width * TILE as usize);
        bands
            .zip(self.tiles.par_chunks(width.div_ceil(TILE as usize)))
            .for_each(|(band, tiles)| {
                for tile in tiles {
                    for (index, ((x, y), sum)) in tile.rect.pixels().zip(&tile.sums).enumerate() {
                        let pixel = Pixel {
                            sum,
                            first: tile.first_hits.get(index).and_then(Option::as_ref),
                            layers: tile.layers.get(index),
                            mattes: (&tile.mattes, index),
                        };
                        let row = (y - tile.rect.y) as usize;
                        band[row * width + (x - self.window.x) as usize] = value(&pixel);
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
        let places = film.map(|pixel| {
            assert!(pixel.sum.samples == 1 && pixel.first.is_none());
            (pixel.sum.color.x as u32, pixel.sum.color.y as u32)
        });
        assert_eq!(places, window.pixels().collect::<Vec<_>>());
        assert_eq!(film.samples(), 70 * 33);
    }

    #[test]
    fn variance_is_that_of_the_textbook_and_keeps_its_digits() {
        // A thousand times 10,000 with noise of 0.01: sums of squares in single precision would be all noise.
        let value = |i: u32| 10_000.0 + ((i * 7919) % 1000) as f32 * 2e-5;
        let (mut sum, mut layers) = (PixelSum::default(), LayerSum::default());
        for i in 0..1000 {
            let color = Vec3::new(value(i), -value(i), 3.0);
            let sample = Sample {
                color,
                backdrop: Vec3::new(1.0, 0.5, 0.0),
                direct: color * 0.25,
                normal: Vec3::Y,
                ..Sample::default()
            };
            sum.add(&sample);
            layers.add(&sample, sum.samples);
        }
        let values: Vec<f64> = (0..1000).map(|i| f64::from(value(i) + 1.0)).collect();
        let mean = values.iter().sum::<f64>() / 1000.0;
        let squares = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        let pixel = Pixel {
            sum: &sum,
            first: None,
            layers: Some(&layers),
            mattes: (&TileMattes::default(), 0),
        };
        let want = squares / 999.0 / 1000.0;
        let [x, y, z] = pixel.variance().to_array().map(f64::from);
        assert!((x / want - 1.0).abs() < 1e-3 && z == 0.0, "{x} {want} {z}");
        assert!(
            (y / want - 1.0).abs() < 0.1,
            "rounded before it is added: {y} {want}"
        );
        let mean = pixel.mean();
        assert!((mean.direct.z - 0.75).abs() < 1e-6 && (mean.normal - Vec3::Y).length() < 1e-6);
        let bare = Pixel {
            layers: None,
            ..pixel
        };
        assert_eq!(
            (bare.variance(), bare.mean().direct),
            (Vec3::ZERO, Vec3::ZERO)
        );
    }
}
