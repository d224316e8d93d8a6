//! The exposures at which pictures of linear light are compared, and how a display shows them at each.

use super::super::colors::Colors;

/// Coefficients of the tone map, (a x^2 + b x) / (c x^2 + d x + e): Narkowicz's fit to ACES (2015), for light times 0.6.
const TONE_MAP: [f64; 5] = [
    0.6 * 0.6 * 2.51,
    0.6 * 0.03,
    0.6 * 0.6 * 2.43,
    0.6 * 0.59,
    0.14,
];

/// Share of a display's light at which the brightest pixel, and the median one, are shown at the two ends.
const BRIGHT: f64 = 0.85;

/// Relative luminance of linear red, green and blue, as Rec. 709 rounds it.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// A median luminance below this counts as this, as in the authors' evaluator: the machine epsilon of `f32`.
const LEAST_MEDIAN: f64 = f32::EPSILON as f64;

/// Exposures, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The least, in stops: each doubles the light.
    pub start: f64,
    /// The greatest, in stops.
    pub stop: f64,
    /// How many; at least 1.
    pub count: u32,
}

impl Exposures {
    /// From one that shows the reference's brightest pixel to one that shows its median pixel, at least two, at most a stop apart.
    pub fn of(reference: &Colors) -> Self {
        let mut luminances: Vec<f64> = reference.pixels.iter().map(luminance).collect();
        luminances.sort_by(f64::total_cmp);
        let median = luminances[luminances.len() / 2].max(LEAST_MEDIAN);
        let largest = luminances[luminances.len() - 1].max(median);
        let at_bright = inverse_tone_map(BRIGHT);
        let [start, stop] = [largest, median].map(|l| libm::log2(at_bright / l));
        Self {
            start,
            stop,
            count: ((stop - start).ceil() as u32).max(2),
        }
    }

    /// Each of them, in stops.
    pub(super) fn stops(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / f64::from(self.count.max(2) - 1);
        (0..self.count.max(1)).map(move |i| self.start + step * f64::from(i))
    }
}

fn luminance(rgb: &[f32; 3]) -> f64 {
    let weighed = rgb.iter().zip(LUMINANCE);
    weighed
        .map(|(&light, weight)| f64::from(light) * weight)
        .sum()
}

/// Light on a display in [0, 1], of light at an exposure.
pub(super) fn shown(light: f32, stops: f64) -> f32 {
    let x = f64::from(light.max(0.0)) * libm::exp2(stops);
    let [a, b, c, d, e] = TONE_MAP;
    ((a * x * x + b * x) / (c * x * x + d * x + e)).clamp(0.0, 1.0) as f32
}

/// The light that the tone map shows as `y`: the positive root of (a - y c) x^2 + (b - y d) x - y e.
fn inverse_tone_map(y: f64) -> f64 {
    let [a, b, c, d, e] = TONE_MAP;
    let (a, b, c) = (a - y * c, b - y * d, -y * e);
    ((b * b - 4.0 * a * c).sqrt() - b) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Colors {
        Colors {
            width: values.len(),
            pixels: values.iter().map(|&v| [v; 3]).collect(),
        }
    }

    #[test]
    fn the_tone_map_has_its_inverse() {
        for y in [0.1, 0.5, BRIGHT] {
            let x = inverse_tone_map(y);
            assert!((f64::from(shown(x as f32, 0.0)) - y).abs() < 1e-6, "{y}");
            assert!((f64::from(shown(x as f32 / 4.0, 2.0)) - y).abs() < 1e-6);
        }
        assert_eq!(shown(-1.0, 3.0), 0.0);
        assert_eq!(shown(f32::MAX, 100.0), 1.0);
    }

    #[test]
    fn exposures_are_those_of_the_evaluator() {
        // Start, stop and number as version 1.7 of the authors' evaluator tells them, which computes in single precision.
        for (values, start, stop, count) in [
            (
                &[1.0, 2.0, 3.0, 4.0, 5.0][..],
                -1.238_630_9,
                -0.501_665_4,
                2,
            ),
            (&[1.0, 2.0, 3.0, 4.0], -0.916_702_8, -0.501_665_4, 2),
            (&[0.25, 0.25, 1.0, 1.0], 1.083_297_3, 1.083_297_3, 2),
            // Mostly black.
            (&[0.0, 0.0, 0.0, 3.0], -0.501_665_4, 24.083_297_7, 25),
        ] {
            let found = Exposures::of(&grey(values));
            assert!((found.start - start).abs() < 1e-5, "{found:?}");
            assert!((found.stop - stop).abs() < 1e-5, "{found:?}");
            assert_eq!(found.count, count);
            let stops: Vec<f64> = found.stops().collect();
            assert_eq!(stops.len(), count as usize);
            assert!((stops[0] - start).abs() < 1e-5);
            assert!((stops[stops.len() - 1] - stop).abs() < 1e-5);
        }
    }
}
