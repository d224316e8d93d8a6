//! Small textures that repeat, as PNG: shades of grey by which materials multiply their colours.
//!
//! All are sums of value noise on lattices whose ends meet, so no seam shows.

use std::io;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::chance::Chance;

/// Width and height in pixels: with two metres a repetition, a pixel is 8 mm.
const SIZE: u32 = 256;

/// Noise that repeats after 1 in u and v, between 0 and 1.
struct Noise {
    columns: usize,
    rows: usize,
    values: Vec<f64>,
}

impl Noise {
    fn new(columns: usize, rows: usize, seed: u64) -> Self {
        let mut chance = Chance::new(seed);
        let values = (0..columns * rows).map(|_| chance.unit()).collect();
        Self {
            columns,
            rows,
            values,
        }
    }

    fn at(&self, u: f64, v: f64) -> f64 {
        let (x, y) = (u * self.columns as f64, v * self.rows as f64);
        let (left, top) = (x.floor(), y.floor());
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (fx, fy) = (smooth(x - left), smooth(y - top));
        let value = |dx: i64, dy: i64| {
            let column = (left as i64 + dx).rem_euclid(self.columns as i64) as usize;
            let row = (top as i64 + dy).rem_euclid(self.rows as i64) as usize;
            self.values[row * self.columns + column]
        };
        let upper = value(0, 0) * (1.0 - fx) + value(1, 0) * fx;
        let lower = value(0, 1) * (1.0 - fx) + value(1, 1) * fx;
        upper * (1.0 - fy) + lower * fy
    }
}

/// The mean of noise at `octaves` scales, each half as strong and twice as fine as the one before.
fn cloud(columns: usize, rows: usize, octaves: u32, seed: u64) -> impl Fn(f64, f64) -> f64 {
    let layers: Vec<Noise> = (0..octaves)
        .map(|o| Noise::new(columns << o, rows << o, seed + u64::from(o)))
        .collect();
    move |u, v| {
        let mut weight = 1.0;
        let (mut sum, mut weights) = (0.0, 0.0);
        for layer in &layers {
            sum += layer.at(u, v) * weight;
            weights += weight;
            weight *= 0.5;
        }
        sum / weights
    }
}

/// A picture of a function of u and v, whose values from 0 to 1 become codes.
fn png(shade: impl Fn(f64, f64) -> f64) -> io::Result<Vec<u8>> {
    let codes: Vec<u8> = (0..SIZE * SIZE)
        .map(|pixel| {
            let [u, v] =
                [pixel % SIZE, pixel / SIZE].map(|p| (f64::from(p) + 0.5) / f64::from(SIZE));
            (shade(u, v).clamp(0.0, 1.0) * 255.0).round() as u8
        })
        .collect();
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::Adaptive)
        .write_image(&codes, SIZE, SIZE, ExtendedColorType::L8)
        .map_err(io::Error::other)?;
    Ok(file)
}

/// Trowelled plaster: large clouds of wear, fine grain, a few darker stains.
pub(super) fn plaster() -> io::Result<Vec<u8>> {
    let clouds = cloud(3, 3, 3, 100);
    let grain = cloud(40, 40, 2, 200);
    let stains = cloud(5, 4, 3, 300);
    png(|u, v| {
        let stain = ((stains(u, v) - 0.56) * 4.0).clamp(0.0, 1.0);
        0.93 + (clouds(u, v) - 0.5) * 0.20 + (grain(u, v) - 0.5) * 0.10 - stain * 0.07
    })
}

/// Limestone: beds that lie flat, with grain.
pub(super) fn stone() -> io::Result<Vec<u8>> {
    let beds = cloud(2, 12, 3, 400);
    let grain = cloud(32, 48, 3, 500);
    png(|u, v| 0.92 + (beds(u, v) - 0.5) * 0.16 + (grain(u, v) - 0.5) * 0.18)
}

/// Oak: fibres along v.
pub(super) fn wood() -> io::Result<Vec<u8>> {
    let fibres = cloud(64, 2, 2, 600);
    let bands = cloud(12, 1, 3, 700);
    png(|u, v| 0.82 + (fibres(u, v) - 0.5) * 0.42 + (bands(u, v) - 0.5) * 0.34)
}
