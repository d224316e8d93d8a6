//! Filters of FLIP: what the eye blurs at a number of pixels a degree, and what finds edges and points.
//!
//! All are products of a function of the column and one of the row, so that a filter takes two passes. Four planes of a
//! picture are filtered at once. Beyond its borders a picture goes on as its border.

use std::f64::consts::PI;

use rayon::prelude::*;

/// Taps of a filter along one axis, for each of four planes; the middle one is the pixel's own.
type Taps = Vec<[f32; 4]>;

/// A filter of four planes.
pub(super) struct Filter {
    along_rows: Taps,
    along_columns: Taps,
}

/// A sum of two Gaussians in the plane, a sqrt(pi / b) exp(-pi^2 d^2 / b) at d degrees: (a, b) of each.
///
/// Contrast sensitivity of the three opponent channels, from the table of the paper, whose functions were fitted by Johnson and Fairchild 2003.
const SENSITIVITY: [[(f64, f64); 2]; 3] = [
    [(1.0, 0.0047), (0.0, 1e-5)],
    [(1.0, 0.0053), (0.0, 1e-5)],
    [(34.1, 0.04), (13.5, 0.025)],
];

/// Width of the features that are looked for, in degrees: what the eye sees best (section 4.2.1 of the paper).
const FEATURE_WIDTH: f64 = 0.082;

/// How many standard deviations a filter reaches.
const REACH: f64 = 3.0;

/// Contrast sensitivity, and the shares of the two last planes in the last channel: planes are Yy, Cx, Cz and Cz once more.
pub(super) fn sensitivity(pixels_per_degree: f64) -> (Filter, [f32; 2]) {
    let widest = SENSITIVITY
        .as_flattened()
        .iter()
        .fold(0.0, |w: f64, g| w.max(g.1));
    let deviation = (widest / (2.0 * PI * PI)).sqrt();
    let radius = (REACH * deviation * pixels_per_degree).ceil() as i32;
    let gaussian = |b: f64| {
        let at = move |i: i32| {
            let degrees = f64::from(i) / pixels_per_degree;
            libm::exp(-PI * PI * degrees * degrees / b)
        };
        (-radius..=radius).map(at).collect::<Vec<f64>>()
    };
    let [yy, cx, cz] = SENSITIVITY;
    let gaussians = [yy[0], cx[0], cz[0], cz[1]];
    let taps = gaussians.map(|(_, b)| unit_sum(gaussian(b)));
    // A sum over the square of taps is the square of a sum.
    let volume = |(a, b): (f64, f64)| {
        let sum: f64 = gaussian(b).iter().sum();
        a * (PI / b).sqrt() * sum * sum
    };
    let [first, second] = cz.map(volume);
    let taps = together(taps);
    let filter = Filter {
        along_columns: taps.clone(),
        along_rows: taps,
    };
    (
        filter,
        [first, second].map(|v| (v / (first + second)) as f32),
    )
}

/// Derivatives of a Gaussian: planes are the first along rows and along columns (edges), the second along both (points).
pub(super) fn features(pixels_per_degree: f64) -> Filter {
    let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (REACH * deviation).ceil() as i32;
    let taps = |of: &dyn Fn(f64) -> f64| {
        let at = |i: i32| {
            let x = f64::from(i);
            of(x) * libm::exp(-x * x / (2.0 * deviation * deviation))
        };
        (-radius..=radius).map(at).collect::<Vec<f64>>()
    };
    let blur = unit_sum(taps(&|_| 1.0));
    let edge = unit_halves(taps(&|x| -x));
    let point = unit_halves(taps(&|x| x * x / (deviation * deviation) - 1.0));
    Filter {
        along_rows: together([edge.clone(), blur.clone(), point.clone(), blur.clone()]),
        along_columns: together([blur.clone(), edge, blur, point]),
    }
}

fn unit_sum(mut taps: Vec<f64>) -> Vec<f64> {
    let sum: f64 = taps.iter().sum();
    taps.iter_mut().for_each(|t| *t /= sum);
    taps
}

/// Positive taps add up to 1 and negative ones to -1.
fn unit_halves(mut taps: Vec<f64>) -> Vec<f64> {
    let half = |sign: f64| taps.iter().map(|t| (t * sign).max(0.0)).sum::<f64>();
    let (positive, negative) = (half(1.0), half(-1.0));
    for tap in &mut taps {
        *tap /= if *tap > 0.0 { positive } else { negative };
    }
    taps
}

fn together(planes: [Vec<f64>; 4]) -> Taps {
    (0..planes[0].len())
        .map(|i| std::array::from_fn(|plane| planes[plane][i] as f32))
        .collect()
}

impl Filter {
    /// Filters a picture of that many columns, row by row from the top.
    pub(super) fn apply(&self, pixels: &[[f32; 4]], width: usize) -> Vec<[f32; 4]> {
        let height = pixels.len() / width;
        let mut blurred = vec![[0.0; 4]; pixels.len()];
        let rows = blurred.par_chunks_mut(width).zip(pixels.par_chunks(width));
        rows.for_each(|(out, row)| {
            for (x, out) in out.iter_mut().enumerate() {
                for (at, taps) in near(x, width, self.along_rows.len()).zip(&self.along_rows) {
                    add(out, taps, &row[at]);
                }
            }
        });
        let mut out = vec![[0.0; 4]; pixels.len()];
        out.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
            for (at, taps) in near(y, height, self.along_columns.len()).zip(&self.along_columns) {
                let row = &blurred[at * width..][..width];
                out.iter_mut()
                    .zip(row)
                    .for_each(|(out, value)| add(out, taps, value));
            }
        });
        out
    }
}

/// The places of the taps around a place, none beyond the border.
fn near(place: usize, size: usize, taps: usize) -> impl Iterator<Item = usize> {
    let radius = taps / 2;
    (0..taps).map(move |tap| (place + tap).saturating_sub(radius).min(size - 1))
}

fn add(sum: &mut [f32; 4], taps: &[f32; 4], value: &[f32; 4]) {
    for plane in 0..4 {
        sum[plane] += taps[plane] * value[plane];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_passes_are_the_filter_of_the_formula() {
        // One bright pixel spreads as the kernel, written out in two dimensions.
        let pixels_per_degree = 12.0;
        let (filter, shares) = sensitivity(pixels_per_degree);
        let radius = (filter.along_rows.len() / 2) as i32;
        assert_eq!(radius, 2);
        let width = 9;
        let mut pixels = vec![[0.0; 4]; 9 * 7];
        pixels[3 * width + 4] = [1.0; 4];
        let out = filter.apply(&pixels, width);
        let kernel = |dx: i32, dy: i32| {
            let d2 = f64::from(dx * dx + dy * dy) / (pixels_per_degree * pixels_per_degree);
            SENSITIVITY[2].map(|(a, b)| a * (PI / b).sqrt() * libm::exp(-PI * PI * d2 / b))
        };
        let offsets = || (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| (x, y)));
        let sum: f64 = offsets().flat_map(|(x, y)| kernel(x, y)).sum();
        for (x, y) in offsets() {
            let expected = kernel(x, y).iter().sum::<f64>() / sum;
            let at = out[((3 + y) * width as i32 + 4 + x) as usize];
            let found = f64::from(at[2] * shares[0] + at[3] * shares[1]);
            assert!((found - expected).abs() < 1e-6, "{x} {y}");
        }
        assert!((out.iter().map(|p| p[0]).sum::<f32>() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_step_is_an_edge_across_it_and_a_flat_picture_has_no_feature() {
        let filter = features(67.0);
        assert_eq!(filter.along_rows.len(), 2 * 9 + 1);
        let step: Vec<_> = (0..30 * 20)
            .map(|i| [if i % 30 < 15 { 0.0 } else { 1.0 }; 4])
            .collect();
        let out = filter.apply(&step, 30);
        // From the step's dark side all positive or all negative taps see 1: half of them less the middle one.
        let [across, along, _, along_twice] = out[10 * 30 + 14];
        assert!(across.abs() > 0.9 && across.abs() <= 1.0, "{across}");
        assert!(along.abs() < 1e-6 && along_twice.abs() < 1e-6);
        for flat in filter.apply(&vec![[0.7; 4]; 30 * 20], 30) {
            assert!(flat.iter().all(|v| v.abs() < 1e-6), "{flat:?}");
        }
    }
}
