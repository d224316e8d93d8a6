//! Pixel filters, used by importance: samples fall as densely as the filter weighs them, so that each counts 1 and touches
//! its own pixel only.

use std::sync::LazyLock;

/// How light between pixel centres is shared out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelFilter {
    /// The mean over the pixel's square.
    Box,
    /// A window of Blackman and Harris, three pixels wide: soft edges without the ringing of negative lobes.
    #[default]
    BlackmanHarris,
}

/// Half the width of the Blackman-Harris window, in pixels.
const BLACKMAN_HARRIS_RADIUS: f64 = 1.5;

/// Entries of the inverse of the window's distribution; between them it is straight.
const TABLE: usize = 2049;

/// The offset below which a share of `i / (TABLE - 1)` of the Blackman-Harris window's weight lies.
static INVERSE_CDF: LazyLock<[f32; TABLE]> = LazyLock::new(blackman_harris_inverse_cdf);

impl PixelFilter {
    /// How far from the pixel's centre samples fall at most, along either axis, in pixels.
    pub const fn radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::BlackmanHarris => BLACKMAN_HARRIS_RADIUS,
        }
    }

    /// An offset from the pixel's centre, in pixels, for two numbers in [0, 1).
    pub fn sample(self, [u, v]: [f32; 2]) -> (f64, f64) {
        (self.offset(u), self.offset(v))
    }

    fn offset(self, u: f32) -> f64 {
        match self {
            Self::Box => f64::from(u) - 0.5,
            Self::BlackmanHarris => {
                let place = u * (TABLE - 1) as f32;
                let index = (place as usize).min(TABLE - 2);
                let [low, high] = [INVERSE_CDF[index], INVERSE_CDF[index + 1]];
                f64::from(low + (high - low) * (place - index as f32))
            }
        }
    }
}

/// The window, for `x` from -1 to 1 (Harris 1978, the four-term window of -92 dB).
fn blackman_harris(x: f64) -> f64 {
    let phase = std::f64::consts::PI * (x + 1.0);
    0.35875 - 0.48829 * libm::cos(phase) + 0.14128 * libm::cos(2.0 * phase)
        - 0.01168 * libm::cos(3.0 * phase)
}

fn blackman_harris_inverse_cdf() -> [f32; TABLE] {
    const STEPS: usize = 8192;
    let place = |step: usize| 2.0 * step as f64 / STEPS as f64 - 1.0;
    let mut cdf = vec![0.0];
    for step in 0..STEPS {
        cdf.push(cdf[step] + blackman_harris(0.5 * (place(step) + place(step + 1))));
    }
    let total = cdf[STEPS];
    let inverse = |i: usize| {
        let wanted = total * i as f64 / (TABLE - 1) as f64;
        let step = cdf.partition_point(|&c| c < wanted).clamp(1, STEPS);
        let within = (wanted - cdf[step - 1]) / (cdf[step] - cdf[step - 1]);
        let x = place(step - 1) + (place(step) - place(step - 1)) * within;
        (x * BLACKMAN_HARRIS_RADIUS) as f32
    };
    std::array::from_fn(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_samples_stay_in_the_pixel() {
        let filter = PixelFilter::Box;
        assert_eq!(filter.sample([0.0, 0.75]), (-0.5, 0.25));
    }

    #[test]
    fn blackman_harris_samples_follow_the_window() {
        let filter = PixelFilter::BlackmanHarris;
        let n = 200_000;
        let (mut inside, mut square) = (0.0, 0.0);
        for i in 0..n {
            let (x, _) = filter.sample([(i as f32 + 0.5) / n as f32, 0.0]);
            assert!(x.abs() <= filter.radius());
            inside += f64::from(u8::from(x.abs() < 0.5)) / f64::from(n);
            square += x * x / f64::from(n);
        }
        // Against a fine sum over the window itself.
        let (mut weight, mut want_inside, mut want_square) = (0.0, 0.0, 0.0);
        for i in 0..n {
            let x = (f64::from(i) + 0.5) / f64::from(n) * 3.0 - 1.5;
            let w = blackman_harris(x / 1.5);
            weight += w;
            want_inside += if x.abs() < 0.5 { w } else { 0.0 };
            want_square += w * x * x;
        }
        assert!(
            (inside - want_inside / weight).abs() < 2e-3,
            "{inside} {}",
            want_inside / weight
        );
        assert!(
            (square - want_square / weight).abs() < 2e-3,
            "{square} {}",
            want_square / weight
        );
    }
}
