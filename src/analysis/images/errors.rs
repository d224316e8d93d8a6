//! Errors of numbers: of each channel, and of colours.

use rayon::prelude::*;

use super::colors::Colors;
use super::pair::{Both, Pair};
use crate::picture::Encoding;

/// Added to the reference's square in [`ColorErrors::rel_mse`], so that black pixels do not divide by zero. From Rousselle, Knaus, Zwicker, "Adaptive
/// Sampling and Reconstruction using Greedy Error Minimization" (2011); a greater one forgives noise in dark places.
const REL_MSE_FLOOR: f64 = 0.01;

/// Values of a channel that are no finite numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NonFinite {
    /// NaN, in the first picture and in the second.
    pub nan: [usize; 2],
    /// Infinite ones.
    pub infinite: [usize; 2],
    /// Pixels where only one is finite, or both are no numbers of another kind or sign.
    pub unlike: usize,
}

/// Where a channel differs most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// Column and row, from the top left corner of the display window.
    pub at: (i32, i32),
    /// The values of both pictures.
    pub values: [f64; 2],
}

/// The differences of a channel. Equal infinities, and NaN beside NaN, are no difference.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelErrors {
    /// The channel.
    pub name: String,
    /// Mean absolute difference. Pixels of [`NonFinite::unlike`] are left out of this and the next two.
    pub mean: f64,
    /// Root of the mean squared difference.
    pub rms: f64,
    /// Peak signal over `rms`, in dB: the peak is the greatest absolute value of both pictures, and at least 1. Infinite without differences.
    pub psnr: f64,
    /// Greatest absolute difference; infinite where values are unlike.
    pub greatest: f64,
    /// The first pixel that has it; `None` without differences.
    pub worst: Option<Worst>,
    /// Pixels that differ by more than the threshold of failure.
    pub beyond: usize,
    /// What is no number.
    pub non_finite: NonFinite,
}

/// The difference of two values: 0 where they are alike, infinite where no finite number says it.
pub(super) fn difference([a, b]: [f64; 2]) -> f64 {
    let difference = (a - b).abs();
    if difference.is_finite() {
        difference
    } else if is_alike([a, b]) {
        0.0
    } else {
        f64::INFINITY
    }
}

/// Whether both are equal, or both are no number.
#[allow(
    clippy::float_cmp,
    reason = "the same numbers are meant, and the same infinities"
)]
pub(super) fn is_alike([a, b]: [f64; 2]) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

impl ChannelErrors {
    pub(super) fn of(pair: &Pair, channel: &Both, threshold: f64) -> Self {
        let (mut sum, mut squares, mut peak, mut counted) = (0.0, 0.0, 1.0_f64, 0_usize);
        let (mut greatest, mut worst) = (0.0, None);
        let mut beyond = 0;
        let mut non_finite = NonFinite::default();
        for pixel in 0..pair.pixels() {
            let values = pair.values(channel, pixel);
            for (side, value) in values.into_iter().enumerate() {
                non_finite.nan[side] += usize::from(value.is_nan());
                non_finite.infinite[side] += usize::from(value.is_infinite());
                if value.is_finite() {
                    peak = peak.max(value.abs());
                }
            }
            let difference = difference(values);
            beyond += usize::from(difference > threshold);
            if difference > greatest {
                (greatest, worst) = (difference, Some((pixel, values)));
            }
            if difference.is_finite() {
                sum += difference;
                squares += difference * difference;
                counted += 1;
            } else {
                non_finite.unlike += 1;
            }
        }
        let count = counted.max(1) as f64;
        let mse = squares / count;
        Self {
            name: channel.name.to_owned(),
            mean: sum / count,
            rms: mse.sqrt(),
            psnr: psnr(mse, peak),
            greatest,
            worst: worst.map(|(pixel, values)| Worst {
                at: pair.place(pixel),
                values,
            }),
            beyond,
            non_finite,
        }
    }
}

/// Peak signal to noise in dB; infinite without noise.
fn psnr(mse: f64, peak: f64) -> f64 {
    if mse > 0.0 {
        10.0 * libm::log10(peak * peak / mse)
    } else {
        f64::INFINITY
    }
}

/// Errors of colours, over red, green and blue together. Pixels with a colour that is not finite are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorErrors {
    /// Mean squared difference, of the numbers in the files.
    pub mse: f64,
    /// Mean of (a - b)^2 / (b^2 + 0.01) of linear light, b being the reference (Rousselle et al. 2011).
    pub rel_mse: f64,
    /// Peak signal over the root of `mse`, in dB; the peak is the greatest absolute value of both pictures, and at least 1.
    pub psnr: f64,
    /// Pixels that were left out.
    pub left_out: usize,
}

impl ColorErrors {
    /// Of pictures of one size; `reference` is the second.
    pub fn of(test: &Colors, reference: &Colors, encoding: Encoding) -> Self {
        let linear = [test, reference].map(|c| c.linear(encoding));
        let pixel = |i: usize| {
            let pixels = [test, reference].map(|c| c.pixels[i]);
            if !pixels.as_flattened().iter().all(|v| v.is_finite()) {
                return Sums {
                    left_out: 1,
                    ..Sums::default()
                };
            }
            let [a, b] = pixels.map(|p| p.map(f64::from));
            let [la, lb] = [0, 1].map(|side| linear[side].pixels[i].map(f64::from));
            let square = |a: f64, b: f64| (a - b) * (a - b);
            Sums {
                squares: (0..3).map(|k| square(a[k], b[k])).sum(),
                relative: (0..3)
                    .map(|k| square(la[k], lb[k]) / (lb[k] * lb[k] + REL_MSE_FLOOR))
                    .sum(),
                peak: a.iter().chain(&b).fold(1.0, |p: f64, v| p.max(v.abs())),
                counted: 3,
                left_out: 0,
            }
        };
        // Rows are added one after another, so that no sum depends on the number of threads.
        let rows: Vec<Sums> = (0..test.height())
            .into_par_iter()
            .map(|y| {
                let row = y * test.width..(y + 1) * test.width;
                row.map(pixel).fold(Sums::default(), Sums::plus)
            })
            .collect();
        let sums = rows.into_iter().fold(Sums::default(), Sums::plus);
        let count = sums.counted.max(1) as f64;
        let mse = sums.squares / count;
        Self {
            mse,
            rel_mse: sums.relative / count,
            psnr: psnr(mse, sums.peak.max(1.0)),
            left_out: sums.left_out,
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    squares: f64,
    relative: f64,
    peak: f64,
    counted: usize,
    left_out: usize,
}

impl Sums {
    fn plus(self, other: Self) -> Self {
        Self {
            squares: self.squares + other.squares,
            relative: self.relative + other.relative,
            peak: self.peak.max(other.peak),
            counted: self.counted + other.counted,
            left_out: self.left_out + other.left_out,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pair::{Selection, Side};
    use super::*;
    use crate::picture::{Channel, Picture, Samples};

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    fn errors(a: Samples, b: Samples) -> ChannelErrors {
        let side = |samples: Samples| Side {
            picture: Picture::new(samples.len() as u32, 1).with_channel(Channel::new("x", samples)),
            encoding: Encoding::Linear,
        };
        let (a, b) = (side(a), side(b));
        let pair = Pair::of(&a, &b, &Selection::default()).unwrap();
        ChannelErrors::of(&pair, &pair.channels[0], 0.3)
    }

    #[test]
    fn errors_of_a_channel_are_those_computed_by_hand() {
        let found = errors(
            Samples::F32(vec![1.0, 2.0, -4.0, 0.5]),
            Samples::F32(vec![1.0, 1.5, -2.0, 0.75]),
        );
        assert!(near(found.mean, (0.5 + 2.0 + 0.25) / 4.0));
        let mse = (0.25 + 4.0 + 0.0625) / 4.0;
        assert!(near(found.rms, f64::sqrt(mse)));
        assert!(near(found.psnr, 10.0 * libm::log10(16.0 / mse)));
        assert_eq!((found.greatest, found.beyond), (2.0, 2));
        let worst = found.worst.unwrap();
        assert_eq!((worst.at, worst.values), ((2, 0), [-4.0, -2.0]));
    }

    #[test]
    fn whole_numbers_are_compared_to_the_last_one() {
        let found = errors(
            Samples::U32(vec![u32::MAX, 7]),
            Samples::U32(vec![u32::MAX - 1, 7]),
        );
        assert_eq!((found.greatest, found.beyond), (1.0, 1));
        let same = errors(Samples::U32(vec![3]), Samples::F16(vec![3.0]));
        assert_eq!((same.greatest, same.worst), (0.0, None));
        assert_eq!(same.psnr, f64::INFINITY);
    }

    #[test]
    fn what_is_no_number_is_counted_and_equal_only_to_its_like() {
        let (nan, inf) = (f32::NAN, f32::INFINITY);
        let found = errors(
            Samples::F32(vec![nan, inf, -inf, nan, inf, 1.0, 1.0]),
            Samples::F32(vec![nan, inf, -inf, 1.0, -inf, inf, 1.5]),
        );
        let expected = NonFinite {
            nan: [2, 1],
            infinite: [3, 4],
            unlike: 3,
        };
        assert_eq!(found.non_finite, expected);
        assert_eq!((found.greatest, found.beyond), (f64::INFINITY, 4));
        assert_eq!(found.worst.unwrap().at, (3, 0));
        // Three pairs are alike, one differs by 0.5, three are left out.
        assert!(near(found.mean, 0.5 / 4.0));
    }

    #[test]
    fn errors_of_colours_are_those_computed_by_hand() {
        let colors = |pixels: &[[f32; 3]]| Colors {
            width: 1,
            pixels: pixels.to_vec(),
        };
        let test = colors(&[[1.0, 0.5, 0.0], [3.0, 1.0, 1.0], [f32::NAN, 0.0, 0.0]]);
        let reference = colors(&[[1.0, 0.0, 0.25], [1.0, 1.0, 1.0], [0.0; 3]]);
        let found = ColorErrors::of(&test, &reference, Encoding::Linear);
        assert!(near(found.mse, (0.25 + 0.0625 + 4.0) / 6.0));
        let relative = 0.25 / 0.01 + 0.0625 / (0.0625 + 0.01) + 4.0 / 1.01;
        assert!(near(found.rel_mse, relative / 6.0));
        assert!(near(found.psnr, 10.0 * libm::log10(9.0 / found.mse)));
        assert_eq!(found.left_out, 1);
        // Codes are decoded for the relative error alone.
        let [a, b] = [0.5, 0.25].map(|v| colors(&[[v; 3]]));
        let found = ColorErrors::of(&a, &b, Encoding::Display);
        assert!(near(found.mse, 0.0625));
        let [a, b] = [0.5, 0.25].map(|v| f64::from(crate::picture::srgb::decode(v)));
        assert!(near(found.rel_mse, (a - b) * (a - b) / (b * b + 0.01)));
        assert!(near(found.psnr, 10.0 * libm::log10(1.0 / 0.0625)));
    }
}
