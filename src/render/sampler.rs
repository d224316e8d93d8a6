//! Random numbers: each is a function of the pixel, the sample's index, the dimension, the seed and the number of samples a pixel, and of nothing
//! else, so that any thread count, tile order or crop gives the same pixels.
//!
//! All samples of the picture are one Sobol sequence of two dimensions, which the pixels take in an order that is hierarchical: every aligned block of
//! pixels, of whatever size a power of two, has an aligned stretch of the sequence, and with it a well distributed set of points of its own. Pixels that are
//! near one another have points that complete one another, so that their errors cancel where the eye takes them together: what is left is blue noise (Ahmed and Wonka
//! 2020, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels", ACM TOG 39(6)). The halves of a stretch
//! go to the two halves of a block at random, by a nested scramble of the index (Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4)).
//! Values are Owen-scrambled by the same means. Each pair of dimensions has another order and other
//! scrambles, but the same two dimensions of the sequence, of which the first two are the best.
//!
//! The pixels complete one another only when each has taken all of its samples. Of a number that is a power of two, all of the stretch is used; of another, or in a render that is
//! ended early, each pixel has a beginning of its own stretch, which is a set as good as one of independent scrambles, and the noise is white.

use multiversion::multiversion;

use crate::geometry::LANES;

/// Samples that one order has, as a power of two; beyond them it is scrambled anew.
const MOST_SAMPLES_LOG2: u32 = 16;

/// The numbers of one sample of one pixel, dimension by dimension.
#[derive(Clone, Debug)]
pub struct Sampler {
    seed: u32,
    /// Where the sample is among all of the picture, before the scramble: the low 32 bits with the first last, and the others.
    reversed: u32,
    high: u32,
    /// Pairs of dimensions taken so far.
    pairs: u32,
    /// The second number of a pair of which the first was taken alone.
    spare: Option<Spare>,
    /// Coins tossed so far.
    tosses: u32,
}

/// A number that waits to be taken.
#[derive(Clone, Copy, Debug)]
enum Spare {
    Known(f32),
    /// The second of this pair, which nobody has asked for so far.
    OfPair(u32),
}

impl Sampler {
    /// The numbers of sample `sample` of the pixel in column `x` and row `y`, where nobody knows how many there will be.
    pub fn new(x: u32, y: u32, sample: u32, seed: u32) -> Self {
        Self::among(x, y, sample, 1 << MOST_SAMPLES_LOG2, seed)
    }

    /// The numbers of sample `sample` of the pixel in column `x` and row `y` (at most 65,535), which gets `samples` of them.
    #[inline]
    pub fn among(x: u32, y: u32, sample: u32, samples: u32, seed: u32) -> Self {
        let log2 = samples
            .max(1)
            .next_power_of_two()
            .ilog2()
            .min(MOST_SAMPLES_LOG2);
        // Morton's order. With the diagonals of squares as halves (x ^ y in place of x), 1.3 to 1.8 times as much of the error stays in low frequencies.
        let pixel = spread(y) << 1 | spread(x);
        let index = pixel << log2 | u64::from(sample & ((1 << log2) - 1));
        Self {
            seed: hash(seed ^ (sample >> log2).rotate_right(8)),
            reversed: (index as u32).reverse_bits(),
            high: (index >> 32) as u32,
            pairs: 0,
            spare: None,
            tosses: 0,
        }
    }

    /// The next number, in [0, 1).
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        match self.spare.take() {
            Some(Spare::Known(second)) => second,
            Some(Spare::OfPair(pair)) => self.pair(pair)[1],
            None => {
                let [first, second] = self.next_2d();
                self.spare = Some(Spare::Known(second));
                first
            }
        }
    }

    /// The next number if it `counts`; else 0 in its place, which costs nothing.
    #[inline]
    pub fn next_1d_if(&mut self, counts: bool) -> f32 {
        if counts {
            return self.next_1d();
        }
        if self.spare.take().is_none() {
            self.spare = Some(Spare::OfPair(self.pairs));
            self.pairs += 1;
        }
        0.0
    }

    /// The next two numbers, each in [0, 1), which are stratified together.
    #[inline]
    pub fn next_2d(&mut self) -> [f32; 2] {
        self.pairs += 1;
        self.pair(self.pairs - 1)
    }

    /// Whether something happens that does so with a chance. No dimension is used up, so that the other numbers are what they are without it; in turn these numbers are
    /// independent of one another, and not stratified.
    #[inline]
    pub fn toss(&mut self, chance: f32) -> bool {
        self.tosses += 1;
        let place = self.reversed ^ hash(self.high ^ self.tosses.wrapping_mul(0x85eb_ca6b));
        let number = hash(hash(place) ^ self.seed);
        ((number >> 8) as f32) < chance * (1 << 24) as f32
    }

    #[inline]
    fn pair(&self, pair: u32) -> [f32; 2] {
        let [first, second] = pair_of(self.place(pair), self.reversed, self.high).map(u64::from);
        // Both are reversed at once.
        let both = (first << 32 | second).reverse_bits();
        [both as u32, (both >> 32) as u32].map(in_unit_interval)
    }

    /// What sets a pair of this sampler apart from its others.
    #[inline(always)]
    fn place(&self, pair: u32) -> u32 {
        self.seed.wrapping_add(pair.wrapping_mul(0x9e37_79b9))
    }

    /// As [`Sampler::next_2d`] of each of as many samplers as there are lanes: all first numbers, and all second ones.
    #[inline]
    pub(super) fn next_2d_of_all(samplers: &mut [Self; LANES]) -> [[f32; LANES]; 2] {
        let places = std::array::from_fn(|i| samplers[i].place(samplers[i].pairs));
        let reversed = std::array::from_fn(|i| samplers[i].reversed);
        let high = std::array::from_fn(|i| samplers[i].high);
        samplers.iter_mut().for_each(|s| s.pairs += 1);
        pairs_in_lanes(&places, &reversed, &high)
    }
}

/// [`pair_of`] in each lane.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn pairs_in_lanes(
    places: &[u32; LANES],
    reversed: &[u32; LANES],
    high: &[u32; LANES],
) -> [[f32; LANES]; 2] {
    let mut pairs = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let [first, second] = pair_of(places[lane], reversed[lane], high[lane]);
        pairs[0][lane] = in_unit_interval(first.reverse_bits());
        pairs[1][lane] = in_unit_interval(second.reverse_bits());
    }
    pairs
}

/// The two numbers of a pair as fractions of 32 bits, the first digit lowest, for what sets it apart and where its sample is.
#[inline(always)]
fn pair_of(place: u32, reversed: u32, high: u32) -> [u32; 2] {
    let seed = hash(place);
    // The first dimension of the sequence is the index with its bits reversed, which is what the scramble works on.
    let first = scramble(reversed, hash(seed ^ high)).reverse_bits();
    // Nested scrambles of the digits, after Owen.
    [
        scramble(first, seed.wrapping_mul(0x2c1b_3c6d)),
        scramble(pascal(first), seed.wrapping_mul(0x297a_2d39) ^ 0x5555_5555),
    ]
}

/// A fraction of 32 bits as a number in [0, 1).
#[inline(always)]
fn in_unit_interval(fraction: u32) -> f32 {
    (fraction >> 8) as f32 * (1.0 / (1 << 24) as f32)
}

/// The bits of a number below 65,536, with a zero before each.
fn spread(x: u32) -> u64 {
    let mut x = x & 0xffff;
    x = (x | x << 8) & 0x00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333;
    x = (x | x << 1) & 0x5555_5555;
    u64::from(x)
}

/// The second dimension of the Sobol sequence for the first, both with their first bit lowest: the bits are multiplied by Pascal's triangle modulo 2.
#[inline(always)]
fn pascal(mut x: u32) -> u32 {
    x ^= x >> 16;
    x ^= (x & 0xff00_ff00) >> 8;
    x ^= (x & 0xf0f0_f0f0) >> 4;
    x ^= (x & 0xcccc_cccc) >> 2;
    x ^ (x & 0xaaaa_aaaa) >> 1
}

/// Changes each bit of `x` by a function of those below it, the seed and its place: the permutation of Laine and Karras (2011) with the constants that Nathan Vegdahl found in
/// 2021 ("Building a Better LK Hash"), which mixes better.
#[inline(always)]
fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(seed >> 16 | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Mixes 32 bits: the hash `lowbias32` of Chris Wellons' search for such functions (2018), a bijection without fixed
/// structure in its low bits.
#[inline(always)]
fn hash(mut x: u32) -> u32 {
    x = x.wrapping_add(0x9e37_79b9);
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(x: u32, y: u32, sample: u32, seed: u32) -> [f32; 2] {
        Sampler::new(x, y, sample, seed).next_2d()
    }

    #[test]
    fn a_number_depends_on_pixel_sample_dimension_and_seed() {
        let base = first(3, 5, 7, 9);
        assert_eq!(base, first(3, 5, 7, 9));
        for other in [
            first(5, 3, 7, 9),
            first(4, 5, 7, 9),
            first(3, 5, 8, 9),
            first(3, 5, 7, 10),
            first(3, 5, 7 + (1 << MOST_SAMPLES_LOG2), 9),
            first(65_535, 65_535, 7, 9),
        ] {
            assert_ne!(base, other);
        }
        let mut s = Sampler::new(3, 5, 7, 9);
        assert_ne!(s.next_1d(), s.next_1d());
        assert_ne!(s.next_2d(), s.next_2d());
    }

    #[test]
    fn numbers_that_do_not_count_leave_the_others_as_they_are() {
        let numbers = |counts: [bool; 5]| {
            let mut s = Sampler::new(3, 5, 7, 9);
            let [a, b, c, d, e] = counts.map(|counts| (s.next_1d_if(counts), s.next_2d()));
            [a, b, c, d, e]
        };
        let all = numbers([true; 5]);
        for skipped in 0..32 {
            let counts = [0, 1, 2, 3, 4].map(|i| skipped >> i & 1 == 0);
            for ((some, all), counts) in numbers(counts).into_iter().zip(all).zip(counts) {
                assert_eq!(some.0, if counts { all.0 } else { 0.0 });
                assert_eq!(some.1, all.1);
            }
        }
    }

    #[test]
    fn numbers_in_lanes_are_those_of_each() {
        let mut samplers: [_; LANES] = std::array::from_fn(|i| {
            let i = i as u32;
            Sampler::among(
                i * 4099 % 65_536,
                60_000 + i,
                i * i,
                1 << (i % 17),
                i.wrapping_mul(0x9e37_79b9),
            )
        });
        for _ in 0..3 {
            let mut alone = samplers.clone();
            let all = Sampler::next_2d_of_all(&mut samplers);
            for (lane, sampler) in alone.iter_mut().enumerate() {
                assert_eq!(sampler.next_2d(), all.map(|numbers| numbers[lane]));
                assert_eq!(sampler.pairs, samplers[lane].pairs);
            }
        }
    }

    #[test]
    fn coins_fall_by_their_chance_whatever_else_is_asked() {
        let samples =
            || (0..4).flat_map(|x| (0..5000).map(move |s| Sampler::among(x, 9, s, 5000, 7)));
        for (nth, chance) in [(1, 0.1_f32), (2, 0.1), (3, 0.5), (9, 0.995)] {
            let heads = samples().filter(|s| {
                let mut sampler = s.clone();
                let before = (1..nth).filter(|_| sampler.toss(0.5)).count();
                sampler.next_2d();
                // Of those of which the last one before was this or that.
                assert!(before < nth);
                sampler.toss(chance)
            });
            let share = heads.count() as f32 / 20_000.0;
            let error = (chance * (1.0 - chance) / 20_000.0).sqrt();
            assert!(
                (share - chance).abs() < 4.0 * error,
                "{nth} {chance} {share}"
            );
        }
        let mut sampler = Sampler::new(1, 2, 3, 4);
        assert!(!sampler.toss(0.0) && sampler.toss(1.0));
        let (mut a, mut b) = (Sampler::new(1, 2, 3, 4), Sampler::new(1, 2, 3, 4));
        b.toss(0.3);
        assert_eq!((a.next_2d(), a.next_1d()), (b.next_2d(), b.next_1d()));
        // Two coins of a sample do not know of one another.
        let both = samples().filter(|s| {
            let mut sampler = s.clone();
            sampler.toss(0.5) & sampler.toss(0.5)
        });
        assert!((both.count() as f32 / 20_000.0 - 0.25).abs() < 0.013);
    }

    #[test]
    fn the_second_dimension_is_that_of_sobols_direction_numbers() {
        // v(1) = 1, and v(j) = v(j - 1) xor v(j - 1) / 2 of the polynomial x + 1, as fractions of 32 bits.
        let mut directions = [1_u32 << 31; 32];
        for j in 1..32 {
            directions[j] = directions[j - 1] ^ directions[j - 1] >> 1;
        }
        for index in [0_u32, 1, 2, 3, 5, 8, 21, 1000, 0x8000_0001, 0xdead_beef] {
            let chosen = (0..32).filter(|j| index >> j & 1 == 1);
            let want = chosen.fold(0, |value, j| value ^ directions[j]);
            assert_eq!(pascal(index).reverse_bits(), want, "{index}");
        }
    }

    /// Asserts that the points lie one each in the cells of every grid of as many cells, from rows to columns.
    fn assert_is_net(points: &[[f32; 2]]) {
        let log2 = points.len().ilog2();
        for columns in (0..=log2).map(|l| 1_usize << l) {
            let rows = points.len() / columns;
            let mut hit = vec![false; points.len()];
            for [u, v] in points {
                assert!((0.0..1.0).contains(u) && (0.0..1.0).contains(v));
                hit[(u * columns as f32) as usize * rows + (v * rows as f32) as usize] = true;
            }
            assert!(hit.iter().all(|h| *h), "{columns} columns");
        }
    }

    #[test]
    fn samples_of_a_pixel_and_of_blocks_of_pixels_are_stratified() {
        for (x, y) in [(0, 0), (77, 13), (4095, 2160), (65_532, 65_528)] {
            for pair in 0..3 {
                let at = |x, y, sample, samples| {
                    let mut sampler = Sampler::among(x, y, sample, samples, 1);
                    (0..pair).for_each(|_| {
                        sampler.next_2d();
                    });
                    sampler.next_2d()
                };
                let own: Vec<_> = (0..64).map(|s| at(x, y, s, 64)).collect();
                assert_is_net(&own);
                assert_is_net(&own[..16]);
                let unknown: Vec<_> = (0..32).map(|s| at(x, y, s, 1 << 16)).collect();
                assert_is_net(&unknown);
                let (x, y) = (x & !3, y & !3);
                let block = (0..16).flat_map(|i| (0..8).map(move |s| (x + i % 4, y + i / 4, s)));
                let block: Vec<_> = block.map(|(x, y, s)| at(x, y, s, 8)).collect();
                assert_is_net(&block);
                let row = [(x, y), (x + 1, y)];
                let pair = row
                    .iter()
                    .flat_map(|&(x, y)| (0..8).map(move |s| (x, y, s)));
                assert_is_net(&pair.map(|(x, y, s)| at(x, y, s, 8)).collect::<Vec<_>>());
            }
        }
    }

    /// Mean square of the errors of pixels, and of the means over squares of 16 by 16 that lie athwart the aligned ones, times 256, which is
    /// the same for white noise; the mean over several seeds.
    fn errors(sampler: impl Fn(u32, u32, u32, u32) -> Sampler, samples: u32) -> [f64; 2] {
        const SIDE: u32 = 128;
        const SEEDS: u32 = 6;
        // A slope with an edge that is along no axis; its mean by a fine grid.
        let value = |[u, v]: [f32; 2]| {
            let (u, v) = (f64::from(u), f64::from(v));
            if 0.8 * u + 0.6 * v < 0.61 {
                0.4 + u * v
            } else {
                0.0
            }
        };
        let grid = (0..1_000_000).map(|i| [(i % 1000) as f32, (i / 1000) as f32]);
        let want = grid
            .map(|p| value(p.map(|c| (c + 0.5) / 1000.0)))
            .sum::<f64>()
            / 1e6;
        let mut sums = [0.0; 2];
        for seed in 0..SEEDS {
            let error = |x, y| {
                let values = (0..samples).map(|s| {
                    let mut sampler = sampler(x, y, s, seed);
                    sampler.next_2d();
                    value(sampler.next_2d())
                });
                values.sum::<f64>() / f64::from(samples) - want
            };
            let pixels = (0..SIDE * SIDE).map(|i| error(i % SIDE, i / SIDE));
            let all: Vec<f64> = pixels.collect();
            let square = |i: u32| {
                let (x, y) = (i % 7 * 16 + 3, i / 7 * 16 + 1);
                let cells = (0..256).map(|c| all[((y + c / 16) * SIDE + x + c % 16) as usize]);
                let mean = cells.sum::<f64>() / 256.0;
                mean * mean * 256.0
            };
            sums[0] += all.iter().map(|e| e * e).sum::<f64>() / all.len() as f64;
            sums[1] += (0..49).map(square).sum::<f64>() / 49.0;
        }
        sums.map(|s| s / f64::from(SEEDS))
    }

    #[test]
    fn errors_of_pixels_near_one_another_cancel() {
        let of_pixel = |x, y, seed| hash(hash(seed) ^ (y << 16 | x));
        for samples in [1, 4, 16] {
            let ours = errors(
                |x, y, s, seed| Sampler::among(x, y, s, samples, seed),
                samples,
            );
            let white = errors(
                |x, y, s, seed| Sampler::among(0, 0, s, samples, of_pixel(x, y, seed)),
                samples,
            );
            println!("{samples} samples: {ours:?}, scrambled independently {white:?}");
            assert!(ours[0] < 1.15 * white[0], "{samples}: {ours:?} {white:?}");
            assert!(ours[1] < 0.6 * white[1], "{samples}: {ours:?} {white:?}");
        }
        // Ended early, they are as good as independent ones.
        let ours = errors(Sampler::new, 16);
        let white = errors(
            |x, y, s, seed| Sampler::new(0, 0, s, of_pixel(x, y, seed)),
            16,
        );
        assert!(ours[0] < 1.15 * white[0], "{ours:?} {white:?}");
        assert!(ours[1] < 1.5 * white[1], "{ours:?} {white:?}");
    }

    #[test]
    fn means_are_right_beyond_the_ends_of_an_order() {
        let mut sum = 0.0;
        for i in 0..1000 {
            let mut s = Sampler::new(i, 0, (3 << MOST_SAMPLES_LOG2) + i, 4);
            (0..256).for_each(|_| {
                s.next_1d();
            });
            sum += s.next_1d();
        }
        // Standard error of the mean of 1,000 uniform numbers: 0.0091.
        assert!((sum / 1000.0 - 0.5).abs() < 0.04, "{sum}");
    }
}
