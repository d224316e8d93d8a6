//! FLIP: how different two pictures look to a person who flips between them, for each pixel from 0 (not at all) to 1.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for Alternating Images", HPG 2020,
//! for display pictures; Andersson, Nilsson, Shirley, Akenine-Möller, "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics
//! 2021, for linear light. Written from their formulas; tests compare with version 1.7 of the authors' evaluator, whose choices hold
//! where the papers leave one (the border, the median of an even number, black references).

mod exposures;
mod filters;
mod spaces;

use rayon::prelude::*;

pub use exposures::Exposures;

use super::colors::Colors;
use filters::Filter;
use spaces::{lab, opponent, rgb_of_opponent};

/// Pixels a degree of vision of the papers' display: 3840 pixels over 0.7 m, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

/// Exponent that compresses colour differences (q_c).
const COLOR_EXPONENT: f64 = 0.7;

/// Share of the largest colour difference (p_c) below which differences are spread over [0, `COLOR_TARGET`].
const COLOR_BEND: f64 = 0.4;

/// What a difference at the bend becomes (p_t).
const COLOR_TARGET: f64 = 0.95;

/// Exponent that stretches differences of features (q_f).
const FEATURE_EXPONENT: f64 = 0.5;

/// Filters and constants at one number of pixels a degree.
struct Eye {
    sensitivity: Filter,
    blue_yellow_shares: [f32; 2],
    features: Filter,
    largest_color: f64,
}

/// What is compared of one picture.
struct Seen {
    /// L*a*b* after the eye's blur, with Hunt's adjustment.
    colors: Vec<[f64; 3]>,
    /// Strengths of edges and of points.
    features: Vec<[f64; 2]>,
}

/// The map of FLIP between display pictures, given as linear light in [0, 1].
///
/// # Panics
/// If the pictures' sizes differ, or there is no pixel.
///
/// ```
/// use bspray::analysis::images::{Colors, PIXELS_PER_DEGREE, flip_ldr};
///
/// let [black, white] = [0.0, 1.0].map(|v| Colors { width: 4, pixels: vec![[v; 3]; 12] });
/// let map = flip_ldr(&black, &white, PIXELS_PER_DEGREE);
/// assert!(map.iter().all(|v| (v - 0.9674).abs() < 1e-4));
/// ```
pub fn flip_ldr(test: &Colors, reference: &Colors, pixels_per_degree: f64) -> Vec<f32> {
    Eye::new(pixels_per_degree).compare(test, reference)
}

/// The map of FLIP between pictures of linear light of any amount, and the exposures it was taken at: by default those that show what is
/// darkest and brightest in the reference. Each pixel has its greatest difference over all exposures, tone-mapped.
///
/// # Panics
/// If the pictures' sizes differ, or there is no pixel.
pub fn flip_hdr(
    test: &Colors,
    reference: &Colors,
    pixels_per_degree: f64,
    exposures: Option<Exposures>,
) -> (Vec<f32>, Exposures) {
    let eye = Eye::new(pixels_per_degree);
    let exposures = exposures.unwrap_or_else(|| Exposures::of(reference));
    let mut greatest = vec![0.0; reference.pixels.len()];
    for stops in exposures.stops() {
        let shown = |colors: &Colors| colors.map(|v| exposures::shown(v, stops));
        let map = eye.compare(&shown(test), &shown(reference));
        for (greatest, value) in greatest.iter_mut().zip(map) {
            *greatest = value.max(*greatest);
        }
    }
    (greatest, exposures)
}

impl Eye {
    fn new(pixels_per_degree: f64) -> Self {
        let (sensitivity, blue_yellow_shares) = filters::sensitivity(pixels_per_degree);
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt(lab(rgb)));
        Self {
            sensitivity,
            blue_yellow_shares,
            features: filters::features(pixels_per_degree),
            largest_color: libm::pow(hyab(green, blue), COLOR_EXPONENT),
        }
    }

    fn compare(&self, test: &Colors, reference: &Colors) -> Vec<f32> {
        let is_same_size =
            test.width == reference.width && test.pixels.len() == reference.pixels.len();
        assert!(
            is_same_size && !test.pixels.is_empty(),
            "pictures of one size, with pixels"
        );
        let (test, reference) = (self.see(test), self.see(reference));
        (0..test.colors.len())
            .into_par_iter()
            .map(|i| {
                let color = self.color_difference(test.colors[i], reference.colors[i]);
                let [edge, point] =
                    [0, 1].map(|k| (test.features[i][k] - reference.features[i][k]).abs());
                let feature = libm::pow(
                    edge.max(point) * std::f64::consts::FRAC_1_SQRT_2,
                    FEATURE_EXPONENT,
                );
                libm::pow(color, 1.0 - feature) as f32
            })
            .collect()
    }

    fn see(&self, picture: &Colors) -> Seen {
        let opponents: Vec<[f32; 3]> = picture
            .pixels
            .par_iter()
            .map(|&rgb| opponent(rgb).map(|v| v as f32))
            .collect();
        let planes: Vec<[f32; 4]> = opponents.iter().map(|&[y, x, z]| [y, x, z, z]).collect();
        let blurred = self.sensitivity.apply(&planes, picture.width);
        let [first, second] = self.blue_yellow_shares;
        let colors = blurred.par_iter().map(|&[yy, cx, cz1, cz2]| {
            let cz = first * cz1 + second * cz2;
            let rgb = rgb_of_opponent([yy, cx, cz].map(f64::from));
            hunt(lab(rgb.map(|v| v.clamp(0.0, 1.0))))
        });
        let colors = colors.collect();
        let lightness: Vec<[f32; 4]> = opponents
            .iter()
            .map(|o| [(o[0] + 16.0) / 116.0; 4])
            .collect();
        let found = self.features.apply(&lightness, picture.width);
        let length = |a: f32, b: f32| {
            let [a, b] = [a, b].map(f64::from);
            (a * a + b * b).sqrt()
        };
        let features = found
            .iter()
            .map(|&[ex, ey, px, py]| [length(ex, ey), length(px, py)])
            .collect();
        Seen { colors, features }
    }

    /// In [0, 1].
    fn color_difference(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let difference = libm::pow(hyab(a, b), COLOR_EXPONENT);
        let bend = COLOR_BEND * self.largest_color;
        let spread = if difference < bend {
            COLOR_TARGET / bend * difference
        } else {
            let beyond = (difference - bend) / (self.largest_color - bend);
            COLOR_TARGET + beyond * (1.0 - COLOR_TARGET)
        };
        spread.min(1.0)
    }
}

/// Colours of dark places look less colourful (Hunt 1952).
fn hunt([l, a, b]: [f64; 3]) -> [f64; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

/// Distance of colours that may be far apart: lightness and chroma are added (Abasi, Amani Tehran, Fairchild 2019).
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [l, u, v]: [f64; 3] = std::array::from_fn(|i| a[i] - b[i]);
    l.abs() + (u * u + v * v).sqrt()
}

#[cfg(test)]
mod tests;
