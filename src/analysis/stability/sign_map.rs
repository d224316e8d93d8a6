//! The signs of a predicate over neighbouring floats: the picture by which Kettner, Mehlhorn, Pion, Schirra, Yap, "Classroom Examples of Robustness Problems
//! in Geometric Computations", CGTA 40, 2008, show that rounding is not a small error but another geometry.
//!
//! Is the point (0.5, 0.5), moved by so many ulps, left or right of the line through (12, 12) and (24, 24)?

use glam::{Vec2, Vec3};

use super::results::SignMap;
use crate::geometry::{Ray, exact};
use crate::picture::{Raster, RasterPixels};

const FROM: Vec2 = Vec2::splat(12.0);
const TO: Vec2 = Vec2::splat(24.0);

/// Colours of signs below, at and above zero in pictures (right of the line, on it, left of it): blue, yellow, red.
const COLORS: [[u8; 3]; 3] = [[49, 104, 172], [250, 214, 90], [201, 73, 60]];

impl SignMap {
    /// The map of `size` by `size` neighbouring points.
    pub fn new(size: u32) -> Self {
        let point = |i: u32| {
            // 0.5 is the least float of its binade.
            let coordinate = |steps: u32| f32::from_bits(0.5_f32.to_bits() + steps);
            Vec2::new(coordinate(i % size), coordinate(size - 1 - i / size))
        };
        let points = || (0..size * size).map(point);
        let naive: Vec<i8> = points().map(naive_sign).collect();
        let exact: Vec<i8> = points().map(exact_sign).collect();
        let differing = naive.iter().zip(&exact).filter(|(n, e)| n != e).count() as u64;
        Self {
            size,
            naive,
            exact,
            differing,
        }
    }

    /// Both as a picture, naive at the left of exact, each point a square of so many pixels.
    pub fn picture(&self, scale: u32) -> Raster {
        let maps = [&self.naive, &self.exact].map(|map| self.drawn(map, scale));
        let gap = vec![[255; 3]; 2 * scale as usize];
        let side = (self.size * scale) as usize;
        let rows = maps[0].chunks(side).zip(maps[1].chunks(side));
        let pixels: Vec<_> = rows
            .flat_map(|(naive, exact)| [naive, &gap, exact].concat())
            .collect();
        Raster {
            width: 2 * (self.size + 1) * scale,
            height: self.size * scale,
            pixels: RasterPixels::Rgb(pixels),
        }
    }

    /// The naive signs and the exact ones, each point a square of so many pixels.
    pub fn pictures(&self, scale: u32) -> [Raster; 2] {
        let side = self.size * scale;
        [&self.naive, &self.exact].map(|map| Raster {
            width: side,
            height: side,
            pixels: RasterPixels::Rgb(self.drawn(map, scale)),
        })
    }

    fn drawn(&self, map: &[i8], scale: u32) -> Vec<[u8; 3]> {
        let side = self.size * scale;
        let pixel = |i: u32| {
            let (x, y) = (i % side / scale, i / side / scale);
            COLORS[(map[(y * self.size + x) as usize] + 1) as usize]
        };
        (0..side * side).map(pixel).collect()
    }
}

/// The orientation of the line and the point, as it is usually written, in `f32`.
fn naive_sign(p: Vec2) -> i8 {
    let value = (FROM.x - p.x) * (TO.y - p.y) - (FROM.y - p.y) * (TO.x - p.x);
    i8::from(value > 0.0) - i8::from(value < 0.0)
}

/// The same without rounding: the edge function of a ray along z.
fn exact_sign(p: Vec2) -> i8 {
    let ray = Ray::new(p.extend(0.0), Vec3::Z);
    match exact::edge_sign(&ray, FROM.extend(1.0), TO.extend(1.0)) {
        exact::Sign::Negative => -1,
        exact::Sign::Zero => 0,
        exact::Sign::Positive => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_map_is_a_clean_diagonal_and_the_naive_one_is_not() {
        let map = SignMap::new(32);
        for (i, &sign) in (0..).zip(&map.exact) {
            let (x, y): (i32, i32) = (i % 32, 31 - i / 32);
            assert_eq!(i32::from(sign), (y - x).signum(), "{x} {y}");
        }
        assert!(map.differing > 100, "{}", map.differing);
        let picture = map.picture(3);
        assert_eq!((picture.width, picture.height), (32 * 6 + 6, 96));
        assert_eq!(
            picture.pixels.len(),
            (picture.width * picture.height) as usize
        );
    }
}
