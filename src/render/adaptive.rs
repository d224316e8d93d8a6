//! Samples where they gain most: after each pass, squares of pixels for which more would gain little get no more.
//!
//! **What is asked for.** The relative standard error of a pixel: that of its mean over `√(I² + 0.01)`, of light after exposure, so that its square is what the pixel adds to
//! relMSE (Rousselle et al. 2011). It is estimated from the samples' variance, as if they were independent; stratified ones, as ours are, are better than that. A pixel with `n` samples is done at
//! `level · √(n / 256)`. If all were done at the same error instead, the mean of its square would be no better than that of as many samples everywhere: what is gained where it is noisy is
//! lost where it is not. With the root, `n` grows as the deviation of a sample does, which is where one more sample takes the same from the mean everywhere: the least for all samples together (Neyman 1934).
//!
//! **Who decides.** Half of the pixels of each block of 8 by 8, like a board's black squares, are decided by the others. So no pixel's own samples say whether it gets more. Where they do, pixels that
//! have missed what is bright stop early, those that have met it go on, and the picture is too dark (Kirk and Arvo 1991, "Unbiased Sampling Techniques for Image Synthesis"). What is left of that
//! bias goes by way of the neighbours: how many samples *they* had when they decided is decided by this pixel. It is far below the noise. The noisiest pixel of a half is left out: one that has met a rare bright
//! path alone does not call for samples of all.
//!
//! Nothing but the pixels of a block has a part in what is decided of it, so that threads and tiles change nothing; nor do crops whose sides are on multiples of 8, since blocks are
//! counted from a crop's corner.

use glam::Vec3;

use super::film::{PixelRect, PixelSum};
use super::together::BLOCK;

/// Samples of each pixel before anything is decided: variances of fewer are noise themselves.
pub(super) const LEAST_SAMPLES: u32 = 16;

/// Part of the samples so far that a pass adds, as one over this. More passes waste fewer samples; each costs a little.
const PASS_PART: u32 = 4;

/// Samples at which a pixel may have the error that is asked for; with fewer it must have less, with more it may have more.
const USUAL_SAMPLES: f32 = 256.0;

/// Added to the square of light, which errors are relative to: black is not infinitely exact. That of relMSE.
const DARK: f32 = 0.01;

/// How much noise a picture may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseGoal {
    /// The relative standard error that a pixel may have at 256 samples.
    pub level: f32,
    /// What light is multiplied by.
    pub exposure: f32,
}

/// The samples that a pass adds to `done` where some pixels may need no more, in whole groups of `together`.
pub(super) fn pass(done: u32, together: u32) -> u32 {
    (done / PASS_PART / together).max(1) * together
}

/// What one pixel's samples tell of its noise: their mean, and the sum of the squares of their distances from it (Welford 1962).
#[derive(Clone, Copy, Debug, Default)]
struct NoiseSum {
    mean: Vec3,
    squares: Vec3,
}

impl NoiseSum {
    /// The relative variance of one sample, the mean of the colours.
    fn relative_variance(&self, samples: u32, exposure: f32) -> f32 {
        let light = self.mean * exposure;
        let variance = self.squares * (exposure * exposure / (samples as f32 - 1.0).max(1.0));
        (variance / (light * light + DARK)).element_sum() / 3.0
    }
}

/// Which pixels of a block get samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Share {
    /// Those whose column and row have an even sum, and those where it is odd.
    halves: [bool; 2],
}

impl Share {
    /// All of them.
    pub(super) const ALL: Self = Self { halves: [true; 2] };

    pub(super) fn has(self, x: u32, y: u32) -> bool {
        self.halves[half(x, y)]
    }

    pub(super) fn is_empty(self) -> bool {
        self.halves == [false; 2]
    }
}

fn half(x: u32, y: u32) -> usize {
    ((x ^ y) & 1) as usize
}

/// The noise of a tile's pixels, and which of them go on.
#[derive(Debug, Default)]
pub(super) struct Adaptive {
    sums: Vec<NoiseSum>,
    /// For each block of the tile.
    shares: Vec<Share>,
}

impl Adaptive {
    /// All pixels of a tile, of which nothing is known.
    pub(super) fn new(tile: &PixelRect) -> Self {
        Self {
            sums: vec![NoiseSum::default(); tile.area() as usize],
            shares: vec![Share::ALL; tile.tiles(BLOCK).len()],
        }
    }

    /// Which pixels of a block of the tile get samples: all, if nobody asks for the noise.
    pub(super) fn share(&self, block: usize) -> Share {
        self.shares.get(block).copied().unwrap_or(Share::ALL)
    }

    /// Adds a pixel's `count`th sample, from 1.
    pub(super) fn add(&mut self, pixel: usize, seen: Vec3, count: u32) {
        if let Some(sum) = self.sums.get_mut(pixel) {
            let step = seen - sum.mean;
            sum.mean += step / count as f32;
            sum.squares += step * (seen - sum.mean);
        }
    }

    /// Whether no pixel gets further samples.
    pub(super) fn is_done(&self) -> bool {
        !self.shares.is_empty() && self.shares.iter().all(|share| share.is_empty())
    }

    /// How many pixels of a tile get further samples.
    pub(super) fn open_pixels(&self, tile: &PixelRect) -> u64 {
        let blocks = tile.tiles(BLOCK).into_iter().enumerate();
        let open = |(block, rect): (usize, PixelRect)| {
            let share = self.share(block);
            rect.pixels().filter(|&(x, y)| share.has(x, y)).count() as u64
        };
        blocks.map(open).sum()
    }

    /// Decides which pixels of a tile go on that all have `done` samples so far, or have stopped with fewer.
    pub(super) fn decide(
        &mut self,
        tile: &PixelRect,
        sums: &[PixelSum],
        done: u32,
        goal: NoiseGoal,
    ) {
        let count = done as f32;
        let most = goal.level * goal.level * count * count / USUAL_SAMPLES;
        for (share, block) in self.shares.iter_mut().zip(tile.tiles(BLOCK)) {
            if share.is_empty() {
                continue;
            }
            let mut variances: [Vec<f32>; 2] = Default::default();
            for (x, y) in block.pixels() {
                let index = tile.index(x, y);
                let sum = &self.sums[index];
                let variance = sum.relative_variance(sums[index].samples, goal.exposure);
                variances[half(x, y)].push(variance);
            }
            // Where there are no others, nobody says that it is enough.
            let is_noisy = |half: usize| typical(&variances[1 - half]).is_none_or(|v| v > most);
            share.halves = [0, 1].map(|half| share.halves[half] && is_noisy(half));
        }
    }
}

/// The mean without the greatest, which is left out also if it is no number; `None` of nothing.
fn typical(variances: &[f32]) -> Option<f32> {
    let (last, others) = variances.split_last()?;
    if others.is_empty() {
        return Some(*last);
    }
    let (mut sum, mut greatest) = (0.0, *last);
    for &variance in others {
        // So that what is no number counts as greatest.
        let is_less = variance <= greatest;
        sum += if is_less { variance } else { greatest };
        greatest = if is_less { greatest } else { variance };
    }
    Some(sum / others.len() as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOAL: NoiseGoal = NoiseGoal {
        level: 0.05,
        exposure: 2.0,
    };

    fn rect(width: u32, height: u32) -> PixelRect {
        PixelRect {
            x: 24,
            y: 8,
            width,
            height,
        }
    }

    /// A tile of which each pixel has 16 samples, that alternate between two values.
    fn tile(rect: &PixelRect, light: impl Fn(u32, u32) -> [f32; 2]) -> (Adaptive, Vec<PixelSum>) {
        let mut adaptive = Adaptive::new(rect);
        for (index, (x, y)) in rect.pixels().enumerate() {
            for count in 1..=16 {
                let seen = light(x, y)[count as usize % 2];
                adaptive.add(index, Vec3::splat(seen), count);
            }
        }
        let sum = PixelSum {
            samples: 16,
            ..PixelSum::default()
        };
        (adaptive, vec![sum; rect.area() as usize])
    }

    #[test]
    fn variances_are_relative_to_exposed_light() {
        let (adaptive, _) = tile(&rect(1, 1), |_, _| [0.08, 0.12]);
        // 0.02² · 16 / 15 of a sample, four times that after exposure.
        let want = 4.0 * 0.0004 * 16.0 / 15.0 / (0.04 + 0.01);
        let found = adaptive.sums[0].relative_variance(16, 2.0);
        assert!((found / want - 1.0).abs() < 1e-3, "{found} {want}");
        let black = tile(&rect(1, 1), |_, _| [0.0, 0.0]).0.sums[0];
        assert_eq!(black.relative_variance(16, 2.0), 0.0);
    }

    #[test]
    fn a_half_goes_on_for_the_noise_of_the_other_alone() {
        let rect = rect(16, 8);
        // Noisy pixels in the second block, of the half of even sums.
        let (mut adaptive, sums) = tile(&rect, |x, y| match (x >= 32, (x + y) % 2) {
            (true, 0) => [0.1, 0.5],
            _ => [0.3, 0.3],
        });
        adaptive.decide(&rect, &sums, 16, GOAL);
        assert!(adaptive.share(0).is_empty());
        let second = adaptive.share(1);
        assert!(second.has(36, 13) && !second.has(37, 13) && !adaptive.is_done());
        assert_eq!(adaptive.open_pixels(&rect), 32);
        // Once stopped, nothing begins anew.
        adaptive
            .sums
            .iter_mut()
            .for_each(|s| s.squares = Vec3::splat(1e6));
        adaptive.decide(&rect, &sums, 16, GOAL);
        assert!(adaptive.share(0).is_empty());
    }

    #[test]
    fn the_error_that_is_enough_grows_as_the_root_of_the_samples() {
        let rect = rect(8, 8);
        // Of a sample 0.2 · √(16 / 15) over √(0.36 + 0.01) after exposure: 0.679; done where that over n is 0.05 / 16.
        let is_done = |done: u32| {
            let (mut adaptive, sums) = tile(&rect, |_, _| [0.1, 0.5]);
            adaptive.decide(&rect, &sums, done, GOAL);
            adaptive.is_done()
        };
        let error = 0.4 * (16.0_f32 / 15.0).sqrt() / 0.37_f32.sqrt();
        let enough = error / GOAL.level * 16.0;
        assert!(
            !is_done(enough as u32 - 2) && is_done(enough as u32 + 2),
            "{enough}"
        );
    }

    #[test]
    fn one_pixel_alone_calls_for_nothing() {
        let rect = rect(8, 8);
        for wild in [1e6, f32::NAN, f32::INFINITY] {
            let bright = |x: u32, y: u32| [0.3, if (x, y) == (27, 9) { wild } else { 0.3 }];
            let (mut adaptive, sums) = tile(&rect, bright);
            adaptive.decide(&rect, &sums, 16, GOAL);
            assert!(adaptive.is_done(), "{wild}");
        }
        assert_eq!(typical(&[3.0, 1.0, 9.0, 2.0]), Some(2.0));
        assert_eq!((typical(&[4.0]), typical(&[])), (Some(4.0), None));
    }

    #[test]
    fn a_pixel_without_others_gets_all() {
        let rect = rect(1, 1);
        let (mut adaptive, sums) = tile(&rect, |_, _| [0.3, 0.3]);
        adaptive.decide(&rect, &sums, 16, GOAL);
        assert!(!adaptive.is_done());
    }

    #[test]
    fn passes_are_whole_groups_and_grow() {
        let passes = [16, 64, 128, 150, 640].map(|done| pass(done, 16));
        assert_eq!(passes, [16, 16, 32, 32, 160]);
    }
}
