//! SSIM: Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to Structural Similarity", IEEE Transactions on
//! Image Processing 13 (4), 2004.
//!
//! On codes in [0, 1] of a display, for red, green and blue apart; the figure is the mean of the three. The paper's is for grey pictures, and would
//! not see a change of hue. Windows lie wholly within the picture, as in the paper.

use rayon::prelude::*;

use super::colors::Colors;

/// Side of the window, in pixels.
const WINDOW: usize = 11;

/// Standard deviation of the window's Gaussian, in pixels.
const DEVIATION: f64 = 1.5;

/// Keep quotients stable where means and variances are small: (K L)^2 of the paper, with K1 = 0.01, K2 = 0.03 and codes up to L = 1.
const STABLE_MEAN: f64 = 0.01 * 0.01;
const STABLE_VARIANCE: f64 = 0.03 * 0.03;

/// Mean SSIM of two pictures of display codes in [0, 1]: 1 for equal ones. `None` where a side has less than 11 pixels.
///
/// # Panics
/// If the pictures' sizes differ.
pub fn ssim(a: &Colors, b: &Colors) -> Option<f64> {
    assert!(
        a.width == b.width && a.pixels.len() == b.pixels.len(),
        "pictures of one size"
    );
    if a.width.min(a.height()) < WINDOW {
        return None;
    }
    let channels = [0, 1, 2].into_par_iter().map(|channel| {
        let plane = |colors: &Colors| {
            let values = colors.pixels.iter().map(|p| f64::from(p[channel]));
            values.collect::<Vec<f64>>()
        };
        of_channel(&plane(a), &plane(b), a.width)
    });
    Some(channels.sum::<f64>() / 3.0)
}

fn of_channel(a: &[f64], b: &[f64], width: usize) -> f64 {
    let weights = weights();
    let mean = |of: &dyn Fn(f64, f64) -> f64| {
        let values: Vec<f64> = a.iter().zip(b).map(|(&a, &b)| of(a, b)).collect();
        blur(&values, width, &weights)
    };
    let (mean_a, mean_b) = (mean(&|a, _| a), mean(&|_, b| b));
    let (aa, bb, ab) = (
        mean(&|a, _| a * a),
        mean(&|_, b| b * b),
        mean(&|a, b| a * b),
    );
    let similarity = |i: usize| {
        let (ma, mb) = (mean_a[i], mean_b[i]);
        let (va, vb, covariance) = (aa[i] - ma * ma, bb[i] - mb * mb, ab[i] - ma * mb);
        (2.0 * ma * mb + STABLE_MEAN) * (2.0 * covariance + STABLE_VARIANCE)
            / ((ma * ma + mb * mb + STABLE_MEAN) * (va + vb + STABLE_VARIANCE))
    };
    (0..mean_a.len()).map(similarity).sum::<f64>() / mean_a.len() as f64
}

/// Of the Gaussian along one axis; they add up to 1.
fn weights() -> [f64; WINDOW] {
    let weight = |i: usize| {
        let x = i as f64 - (WINDOW / 2) as f64;
        libm::exp(-x * x / (2.0 * DEVIATION * DEVIATION))
    };
    let weights: [f64; WINDOW] = std::array::from_fn(weight);
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
}

/// Weighted means of all windows, row by row.
fn blur(values: &[f64], width: usize, weights: &[f64; WINDOW]) -> Vec<f64> {
    let sum = |window: &[f64]| window.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>();
    let columns = width + 1 - WINDOW;
    let rows: Vec<f64> = values
        .chunks(width)
        .flat_map(|row| row.windows(WINDOW).map(sum))
        .collect();
    let height = rows.len() / columns;
    let mut blurred = vec![0.0; columns * (height + 1 - WINDOW)];
    for (y, out) in blurred.chunks_mut(columns).enumerate() {
        for (row, weight) in rows[y * columns..].chunks(columns).zip(weights) {
            out.iter_mut()
                .zip(row)
                .for_each(|(out, value)| *out += weight * value);
        }
    }
    blurred
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Colors {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Colors {
            width,
            pixels: places.map(|(x, y)| [value(x, y); 3]).collect(),
        }
    }

    #[test]
    fn flat_pictures_have_the_formula_of_their_means() {
        let [a, b] = [0.25, 0.5].map(|v| picture(13, 12, |_, _| v));
        let expected = (2.0 * 0.25 * 0.5 + 1e-4) / (0.0625 + 0.25 + 1e-4);
        assert!((ssim(&a, &b).unwrap() - expected).abs() < 1e-12);
        assert_eq!(ssim(&a, &a), Some(1.0));
    }

    #[test]
    fn one_window_is_the_formula_in_two_dimensions() {
        let of_a = |x: usize, y: usize| ((x * 5 + y * 3) % 16) as f32 / 16.0;
        let of_b = |x: usize, y: usize| ((x * 5 + y * y) % 16) as f32 / 16.0;
        // The plain definition, with two-dimensional weights and centred moments.
        let mut total = 0.0;
        let (mut ma, mut mb) = (0.0, 0.0);
        let each = || (0..11_usize).flat_map(|y| (0..11_usize).map(move |x| (x, y)));
        let weight = |(x, y): (usize, usize)| {
            let (dx, dy) = (x as f64 - 5.0, y as f64 - 5.0);
            libm::exp(-(dx * dx + dy * dy) / 4.5)
        };
        for (x, y) in each() {
            let w = weight((x, y));
            total += w;
            ma += w * f64::from(of_a(x, y));
            mb += w * f64::from(of_b(x, y));
        }
        let (ma, mb) = (ma / total, mb / total);
        let (mut va, mut vb, mut both) = (0.0, 0.0, 0.0);
        for (x, y) in each() {
            let w = weight((x, y)) / total;
            let (a, b) = (f64::from(of_a(x, y)) - ma, f64::from(of_b(x, y)) - mb);
            va += w * a * a;
            vb += w * b * b;
            both += w * a * b;
        }
        let expected = (2.0 * ma * mb + 1e-4) * (2.0 * both + 9e-4)
            / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
        let found = ssim(&picture(11, 11, of_a), &picture(11, 11, of_b)).unwrap();
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        assert!(found < 0.9);
    }

    #[test]
    fn a_picture_without_room_for_a_window_has_none() {
        for (width, height) in [(10, 40), (40, 10)] {
            let small = picture(width, height, |_, _| 0.5);
            assert_eq!(ssim(&small, &small), None);
        }
    }

    #[test]
    fn a_change_of_one_channel_counts_a_third() {
        let a = picture(12, 15, |x, _| x as f32 / 12.0);
        let inverted = picture(12, 15, |x, _| 1.0 - x as f32 / 12.0);
        let mut red = a.clone();
        for (pixel, other) in red.pixels.iter_mut().zip(&inverted.pixels) {
            pixel[0] = other[0];
        }
        let (all, one) = (ssim(&a, &inverted).unwrap(), ssim(&a, &red).unwrap());
        assert!(((1.0 - one) * 3.0 - (1.0 - all)).abs() < 1e-12);
        assert!(all < 0.0);
    }
}
