//! Levels of detail of an image: each level has half the texels of the one before along either side, rounded down, to one texel.
//!
//! A texel is the mean of what it covers, in linear light. Where a side is odd, it covers two texels and parts of a third
//! (Guthe and Heckbert, "Non-Power-of-Two Mipmapping", NVIDIA 2005), so that every level has the mean of the image. Levels are
//! stored as the image is, each rounded to the nearest code: they take a third of its memory.
//!
//! One thread builds them: it may hold a lock, and if it waited for others to help it would take up work of theirs that waits for that lock.

use glam::Vec4;

use super::texel::{Encoder, fetch};
use super::{ColorSpace, Pixels};
use crate::picture::srgb;

/// All levels of an image but the finest, which is the image itself.
#[derive(Debug)]
pub(crate) struct Pyramid {
    /// Ever smaller, down to one texel; empty for an image of one texel.
    levels: Vec<Level>,
}

/// A level of detail.
#[derive(Debug)]
pub(crate) struct Level {
    /// Width and height in pixels.
    pub(crate) size: (u32, u32),
    pub(crate) pixels: Pixels,
}

impl Pyramid {
    /// The levels of an image of `size` (width and height in pixels) whose numbers mean `space`.
    pub(crate) fn new(pixels: &Pixels, size: (u32, u32), space: ColorSpace) -> Self {
        let mut levels: Vec<Level> = Vec::new();
        let mut last = size;
        while last.0 > 1 || last.1 > 1 {
            let source = levels.last().map_or(pixels, |level| &level.pixels);
            let level = Level::below(source, last, space);
            last = level.size;
            levels.push(level);
        }
        Self { levels }
    }

    /// Bytes of the levels.
    pub(crate) fn memory(&self) -> u64 {
        let levels = self.levels.iter();
        levels.map(|level| bytes(&level.pixels, level.size)).sum()
    }

    /// Bytes that the levels of an image would have.
    pub(crate) fn memory_of(pixels: &Pixels, mut size: (u32, u32)) -> u64 {
        let mut sum = 0;
        while size.0 > 1 || size.1 > 1 {
            size = coarser(size);
            sum += bytes(pixels, size);
        }
        sum
    }

    /// Those below the image, the finest first.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }
}

/// The next coarser level of an image of `size`; `None` for one of a single texel.
pub(super) fn below(pixels: &Pixels, size: (u32, u32), space: ColorSpace) -> Option<Pixels> {
    (size.0 > 1 || size.1 > 1).then(|| Level::below(pixels, size, space).pixels)
}

/// The size of the next coarser level.
fn coarser(size: (u32, u32)) -> (u32, u32) {
    ((size.0 / 2).max(1), (size.1 / 2).max(1))
}

/// Bytes of an image of this size, of texels of this kind.
pub(super) fn bytes(kind: &Pixels, size: (u32, u32)) -> u64 {
    let texel = match kind {
        Pixels::Rgba8(_) => 4,
        Pixels::Rgba16(_) => 8,
        Pixels::RgbaF32(_) => 16,
    };
    u64::from(size.0) * u64::from(size.1) * texel
}

impl Level {
    /// The next coarser level of an image.
    fn below(source: &Pixels, from: (u32, u32), space: ColorSpace) -> Self {
        let size = coarser(from);
        if let Pixels::Rgba8(texels) = source
            && from.0.is_multiple_of(2)
            && from.1.is_multiple_of(2)
        {
            let pixels = Pixels::Rgba8(halved(texels, from, space));
            return Self { size, pixels };
        }
        let columns: Vec<Taps> = (0..size.0).map(|x| Taps::new(x, size.0, from.0)).collect();
        let texels = (0..size.1).flat_map(|y| {
            let row = Taps::new(y, size.1, from.1);
            columns.iter().map(move |column| {
                row.mean(|y| {
                    let start = y as usize * from.0 as usize;
                    column.mean(|x| fetch(source, start + x as usize, space))
                })
            })
        });
        let pixels = match source {
            Pixels::Rgba8(_) => {
                let encoder = Encoder::srgb();
                // Ties go to the even code: upwards, they would make every level brighter than the last. Sixteenths, since
                // the mean of four codes is one exactly only without the division by 255.
                let plain = |v: f32| ((v * (16.0 * 255.0)).round() / 16.0).round_ties_even() as u8;
                let code = |v: Vec4| {
                    let color = v.truncate().to_array();
                    let [r, g, b] = match space {
                        ColorSpace::Srgb => color.map(|c| encoder.code(c)),
                        ColorSpace::Linear => color.map(plain),
                    };
                    [r, g, b, plain(v.w)]
                };
                Pixels::Rgba8(texels.map(code).collect())
            }
            Pixels::Rgba16(_) => {
                let plain = |v: f32| (v * 65_535.0).round_ties_even() as u16;
                let code = |v: Vec4| {
                    let color = v.truncate().to_array();
                    let [r, g, b] = match space {
                        ColorSpace::Srgb => color.map(|c| plain(srgb::encode(c))),
                        ColorSpace::Linear => color.map(plain),
                    };
                    [r, g, b, plain(v.w)]
                };
                Pixels::Rgba16(texels.map(code).collect())
            }
            Pixels::RgbaF32(_) => Pixels::RgbaF32(texels.map(|v| v.to_array()).collect()),
        };
        Self { size, pixels }
    }
}

/// The means of two by two texels, of an image with even sides: what most textures are, several times as fast.
fn halved(texels: &[[u8; 4]], from: (u32, u32), space: ColorSpace) -> Vec<[u8; 4]> {
    let (width, wide) = (from.0 as usize / 2, from.0 as usize);
    let mut means = vec![[0; 4]; width * (from.1 as usize / 2)];
    // Ties go to the even code.
    let plain = |[a, b, c, d]: [u8; 4]| {
        let sum = [a, b, c, d].map(u16::from).iter().sum::<u16>();
        ((sum + 1 + (sum >> 2 & 1)) >> 2) as u8
    };
    let (table, encoder) = (&*srgb::LINEAR_OF_U8, Encoder::srgb());
    let lit = |[a, b, c, d]: [u8; 4]| {
        let [a, b, c, d] = [a, b, c, d].map(|code| table[usize::from(code)]);
        encoder.code((a + b + (c + d)) * 0.25)
    };
    let rows = means.chunks_mut(width);
    rows.zip(texels.chunks(2 * wide)).for_each(|(means, two)| {
        let (upper, lower) = two.split_at(wide);
        let pairs = upper
            .as_chunks::<2>()
            .0
            .iter()
            .zip(lower.as_chunks::<2>().0);
        for (mean, ([a, b], [c, d])) in means.iter_mut().zip(pairs) {
            let of = |channel: usize| [a[channel], b[channel], c[channel], d[channel]];
            let [r, g, b] = match space {
                ColorSpace::Srgb => [0, 1, 2].map(|channel| lit(of(channel))),
                ColorSpace::Linear => [0, 1, 2].map(|channel| plain(of(channel))),
            };
            *mean = [r, g, b, plain(of(3))];
        }
    });
    means
}

/// The texels of the finer level along one side that one of the coarser covers.
struct Taps {
    first: u32,
    /// Shares of `first` and of those behind it; their sum is 1.
    weights: [f32; 3],
    count: u32,
}

impl Taps {
    /// Of texel `index` of `coarse`, half of `fine`, rounded down.
    fn new(index: u32, coarse: u32, fine: u32) -> Self {
        let first = 2 * index;
        if fine == 1 {
            return Self {
                first: 0,
                weights: [1.0, 0.0, 0.0],
                count: 1,
            };
        }
        if fine.is_multiple_of(2) {
            return Self {
                first,
                weights: [0.5, 0.5, 0.0],
                count: 2,
            };
        }
        let all = fine as f32;
        let weights = [coarse - index, coarse, index + 1].map(|w| w as f32 / all);
        Self {
            first,
            weights,
            count: 3,
        }
    }

    fn mean(&self, value: impl Fn(u32) -> Vec4) -> Vec4 {
        let first = value(self.first) * self.weights[0];
        (1..self.count).fold(first, |sum, i| {
            sum + value(self.first + i) * self.weights[i as usize]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn float(size: (u32, u32), value: impl Fn(u32, u32) -> f32) -> Pixels {
        let pixel = |i: u32| {
            let v = value(i % size.0, i / size.0);
            [v, 2.0 * v, 0.0, 1.0]
        };
        Pixels::RgbaF32((0..size.0 * size.1).map(pixel).collect())
    }

    #[test]
    fn every_level_has_the_mean_of_the_image_whatever_its_sides() {
        for size in [(8, 4), (7, 4), (5, 3), (1, 9), (13, 1), (6, 10), (1, 1)] {
            let value = |x: u32, y: u32| ((x * 7 + y * 13) % 11) as f32;
            let pixels = float(size, value);
            let pyramid = Pyramid::new(&pixels, size, ColorSpace::Linear);
            let mean = |pixels: &Pixels| {
                let Pixels::RgbaF32(p) = pixels else { panic!() };
                p.iter().map(|p| f64::from(p[0])).sum::<f64>() / p.len() as f64
            };
            let expected = mean(&pixels);
            for level in &pyramid.levels {
                assert!((mean(&level.pixels) - expected).abs() < 1e-5, "{size:?}");
            }
            assert_eq!(pyramid.memory(), Pyramid::memory_of(&pixels, size));
            let last = pyramid.levels.last().map_or(size, |level| level.size);
            assert_eq!(last, (1, 1));
        }
    }

    #[test]
    fn odd_sides_do_not_shift_the_picture() {
        // A ramp stays a ramp: the value at a texel's middle is the coordinate of that middle, but for the steps of the finer
        // texels of which it covers a part.
        let size = (9, 1);
        let pixels = float(size, |x, _| (x as f32 + 0.5) / 9.0);
        let pyramid = Pyramid::new(&pixels, size, ColorSpace::Linear);
        let Pixels::RgbaF32(p) = &pyramid.levels[0].pixels else {
            panic!()
        };
        for (i, p) in p.iter().enumerate() {
            assert!((p[0] - (i as f32 + 0.5) / 4.0).abs() < 0.05 / 9.0, "{p:?}");
        }
    }

    #[test]
    fn colours_are_mixed_in_linear_light_and_numbers_as_they_are() {
        let board = |i: u32| {
            let v = if (i % 16 + i / 16).is_multiple_of(2) {
                255
            } else {
                0
            };
            [v, v, v, v]
        };
        let pixels = Pixels::Rgba8((0..256).map(board).collect());
        let coarsest = |space| {
            let pyramid = Pyramid::new(&pixels, (16, 16), space);
            assert_eq!((pyramid.levels.len(), pyramid.memory()), (4, 4 * 85));
            let Pixels::Rgba8(p) = &pyramid.levels[3].pixels else {
                panic!()
            };
            p[0]
        };
        // 188 is half of the light; half of 255 goes to the even code, and stays there.
        assert_eq!(coarsest(ColorSpace::Srgb), [188, 188, 188, 128]);
        assert_eq!(coarsest(ColorSpace::Linear), [128; 4]);
    }

    #[test]
    fn the_fast_way_gives_what_the_plain_one_does() {
        let noise = |i: u32| i.wrapping_mul(2_654_435_761).to_be_bytes();
        let codes: Vec<[u8; 4]> = (0..32 * 16).map(noise).collect();
        let floats = |space: ColorSpace| {
            let of = |i| fetch(&Pixels::Rgba8(codes.clone()), i, space).to_array();
            Pixels::RgbaF32((0..codes.len()).map(of).collect())
        };
        for space in [ColorSpace::Srgb, ColorSpace::Linear] {
            let fast = Level::below(&Pixels::Rgba8(codes.clone()), (32, 16), space);
            let exact = Level::below(&floats(space), (32, 16), ColorSpace::Linear);
            let Pixels::Rgba8(fast) = &fast.pixels else {
                panic!()
            };
            for (i, found) in fast.iter().enumerate() {
                let [r, g, b, a] = fetch(&exact.pixels, i, ColorSpace::Linear).to_array();
                let encode = |v: f32| match space {
                    ColorSpace::Srgb => srgb::encode(v),
                    ColorSpace::Linear => v,
                };
                let expected = [encode(r), encode(g), encode(b), a].map(|v| v * 255.0);
                for (found, expected) in found.iter().zip(expected) {
                    assert!((f32::from(*found) - expected).abs() < 0.501, "{i}");
                }
            }
        }
    }

    #[test]
    fn rounding_does_not_brighten_from_level_to_level() {
        // A ramp with noise, so that the levels' exact values lie anywhere between two codes.
        let noise = |i: u32| {
            let hash = (i ^ i >> 7).wrapping_mul(2_654_435_761);
            let v = (i % 512 * 37 / 128 + i / 512 * 19 / 128 + (hash >> 28)) as u8;
            [v, v, v, 255]
        };
        let pixels: Vec<[u8; 4]> = (0..512 * 512).map(noise).collect();
        let mean = pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / pixels.len() as f64;
        let pyramid = Pyramid::new(&Pixels::Rgba8(pixels), (512, 512), ColorSpace::Linear);
        let Pixels::Rgba8(p) = &pyramid.levels[5].pixels else {
            panic!()
        };
        let found = p.iter().map(|p| f64::from(p[0])).sum::<f64>() / p.len() as f64;
        assert!((found - mean).abs() < 0.2, "{found} instead of {mean}");
    }
}
