//! Random numbers: each is a function of the pixel, the sample's index, the dimension and the seed, and of nothing else, so
//! that any thread count, tile order or crop gives the same pixels.
//!
//! Within a pixel the samples are an Owen-scrambled Sobol sequence (Burley 2020, "Practical Hash-based Owen Scrambling",
//! JCGT 9(4), through the crate `sobol_burley`); pixels are scrambled independently.

/// Numbers that the sequence gives at once.
const SET: u32 = 4;

/// Sets of four dimensions that the sequence has; beyond them it is scrambled anew.
const SETS: u32 = 64;

/// Samples that the sequence has; beyond them it is scrambled anew.
const SAMPLES: u32 = 1 << 16;

/// The numbers of one sample of one pixel, dimension by dimension.
#[derive(Clone, Debug)]
pub struct Sampler {
    seed: u32,
    sample: u32,
    dimension: u32,
    set: [f32; SET as usize],
}

impl Sampler {
    /// The numbers of sample `sample` of the pixel in column `x` and row `y`.
    pub fn new(x: u32, y: u32, sample: u32, seed: u32) -> Self {
        // Pictures have at most 65,536 columns and rows.
        let seed = hash(hash(seed ^ (sample / SAMPLES).rotate_right(8)) ^ (y << 16 | x));
        Self {
            seed,
            sample: sample % SAMPLES,
            dimension: 0,
            set: [0.0; SET as usize],
        }
    }

    /// The next number, in [0, 1).
    pub fn next_1d(&mut self) -> f32 {
        let slot = self.dimension % SET;
        if slot == 0 {
            let set = self.dimension / SET;
            // The first round of dimensions keeps the pixel's own seed.
            let round = set / SETS;
            let seed = if round == 0 {
                self.seed
            } else {
                hash(self.seed ^ round)
            };
            self.set = sobol_burley::sample_4d(self.sample, set % SETS, seed);
        }
        self.dimension += 1;
        self.set[slot as usize]
    }

    /// The next two numbers, each in [0, 1). They are of one set of dimensions, so that they are stratified together.
    pub fn next_2d(&mut self) -> [f32; 2] {
        if self.dimension % SET == SET - 1 {
            self.dimension += 1;
        }
        [self.next_1d(), self.next_1d()]
    }
}

/// Mixes 32 bits: the hash `lowbias32` of Chris Wellons' search for such functions (2018), a bijection without fixed
/// structure in its low bits.
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
        ] {
            assert_ne!(base, other);
        }
        let mut s = Sampler::new(3, 5, 7, 9);
        assert_ne!(s.next_1d(), s.next_1d());
    }

    #[test]
    fn samples_of_a_pixel_are_stratified() {
        // 256 samples of a (0, 2)-sequence put one into each of 16 times 16 squares; random numbers would leave about 94 empty.
        for pixel in 0..20 {
            let mut hit = [false; 256];
            for sample in 0..256 {
                let [u, v] = first(pixel, 77, sample, 1);
                assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v));
                hit[(u * 16.0) as usize * 16 + (v * 16.0) as usize] = true;
            }
            assert_eq!(hit.iter().filter(|h| **h).count(), 256);
        }
    }

    #[test]
    fn means_are_right_beyond_the_ends_of_the_sequence() {
        let mut sum = 0.0;
        for i in 0..1000 {
            let mut s = Sampler::new(i, 0, SAMPLES * 3 + i, 4);
            (0..SETS * SET).for_each(|_| {
                s.next_1d();
            });
            sum += s.next_1d();
        }
        // Standard error of the mean of 1,000 uniform numbers: 0.0091.
        assert!((sum / 1000.0 - 0.5).abs() < 0.04, "{sum}");
    }
}
