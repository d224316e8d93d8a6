//! Choosing directions by a grid over the sphere: a piecewise-constant density per steradian.
//!
//! Rows are rings of equal polar angle, columns sectors of equal azimuth; a cell is chosen by weight, and a direction within
//! it evenly by solid angle (pbrt-v4, section A.5, but for the sphere's measure in place of the square's). Sums are whole numbers, so that
//! the density is exactly that with which cells are chosen, and 0 only where the weight is. They take 4 bytes a cell.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

/// Sum of all weights of a row, and of all rows, less what rounding adds: below the largest of 32 bits.
const SCALE: f64 = 4.0e9;

/// A place on the sphere: the share of the full circle from the grid's left edge, and the cosine of the polar angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) turn: f64,
    pub(super) cosine: f64,
}

#[derive(Debug)]
pub(super) struct Distribution {
    width: usize,
    height: usize,
    /// For each row, the sum of the weights of it and all above it.
    rows: Vec<u32>,
    /// For each row, for each of its cells, the sum of the weights of it and those to its left.
    cells: Vec<u32>,
    /// Cosines of the polar angles of the rows' edges, from 1 to -1.
    edges: Vec<f64>,
}

impl Distribution {
    /// A grid of `width` times `height` cells whose mean radiance is `weight`, by column and row; not negative. `None` if all
    /// is black.
    pub(super) fn new(
        width: u32,
        height: u32,
        weight: impl Fn(u32, u32) -> f32 + Sync,
    ) -> Option<Self> {
        let (w, h) = (width as usize, height as usize);
        let edge = |row: usize| libm::cos(PI * row as f64 / h as f64);
        let edges: Vec<f64> = (0..=h).map(edge).collect();
        let mut cells = vec![0; w * h];
        let rows = cells.par_chunks_mut(w).enumerate();
        let sums: Vec<f64> = rows
            .map(|(y, row)| {
                let weights = (0..width).map(|x| f64::from(weight(x, y as u32)));
                accumulate(weights, row) * (edges[y] - edges[y + 1])
            })
            .collect();
        let mut rows = vec![0; h];
        let total = accumulate(sums.into_iter(), &mut rows);
        (total > 0.0).then_some(Self {
            width: w,
            height: h,
            rows,
            cells,
            edges,
        })
    }

    /// A place chosen with the numbers given, from 0 below 1.
    pub(super) fn sample(&self, [u, v]: [f32; 2]) -> Place {
        let (row, down) = choose(&self.rows, v);
        let (column, right) = choose(self.row(row), u);
        let (upper, lower) = (self.edges[row], self.edges[row + 1]);
        Place {
            turn: (column as f64 + right) / self.width as f64,
            cosine: upper + (lower - upper) * down,
        }
    }

    /// The density with which a place is chosen, per steradian.
    pub(super) fn density(&self, place: Place) -> f32 {
        let column = (place.turn * self.width as f64) as usize;
        let polar = libm::acos(place.cosine.clamp(-1.0, 1.0)) / PI;
        let row = ((polar * self.height as f64) as usize).min(self.height - 1);
        let cells = self.row(row);
        let share = share(&self.rows, row) * share(cells, column.min(self.width - 1));
        let ring = TAU * (self.edges[row] - self.edges[row + 1]);
        (share * self.width as f64 / ring) as f32
    }

    fn row(&self, row: usize) -> &[u32] {
        &self.cells[row * self.width..][..self.width]
    }
}

/// Writes the running sums of weights, scaled to whole numbers; each weight above 0 counts at least 1. Gives the sum itself.
fn accumulate(weights: impl Iterator<Item = f64> + Clone, sums: &mut [u32]) -> f64 {
    let total: f64 = weights.clone().sum();
    if total <= 0.0 {
        return 0.0;
    }
    let mut exact = 0.0;
    let mut last = 0_u32;
    for (weight, sum) in weights.zip(sums) {
        exact += weight;
        // Fits: the scale leaves room for one more for each of two hundred million cells.
        let least = last + u32::from(weight > 0.0);
        last = if weight > 0.0 {
            ((exact / total * SCALE) as u32).max(least)
        } else {
            last
        };
        *sum = last;
    }
    total
}

/// The cell in which a share of the sum lies, and how far in it.
fn choose(sums: &[u32], share: f32) -> (usize, f64) {
    let total = sums.last().copied().unwrap_or(0);
    let target = f64::from(share) * f64::from(total);
    let index = sums.partition_point(|&sum| f64::from(sum) <= target);
    let index = index.min(sums.len() - 1);
    let before = index.checked_sub(1).map_or(0, |i| sums[i]);
    let inside = (target - f64::from(before)) / f64::from(sums[index] - before);
    // Numbers below 1 stay below it but for rounding.
    (index, inside.clamp(0.0, 1.0))
}

fn share(sums: &[u32], index: usize) -> f64 {
    let total = sums.last().copied().unwrap_or(0);
    if total == 0 {
        return 0.0;
    }
    let before = index.checked_sub(1).map_or(0, |i| sums[i]);
    f64::from(sums[index] - before) / f64::from(total)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Random numbers (splitmix64), which unlike the renderer's are independent.
    pub(in super::super) fn random(seed: u64) -> impl FnMut() -> [f32; 2] {
        let mut state = seed;
        let mut next = move || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ z >> 31) >> 40) as f32 / (1_u32 << 24) as f32
        };
        move || [next(), next()]
    }

    /// A grid of 7 x 5 cells, some of them black.
    fn grid() -> Distribution {
        Distribution::new(7, 5, |x, y| ((x * 3 + y * 5) % 4) as f32).expect("not black")
    }

    #[test]
    fn the_density_integrates_to_one() {
        let grid = grid();
        let (n, m) = (350, 400);
        let mut sum = 0.0;
        for i in 0..n * m {
            let place = Place {
                turn: (f64::from(i % n) + 0.5) / f64::from(n),
                cosine: libm::cos(PI * (f64::from(i / n) + 0.5) / f64::from(m)),
            };
            let sine = (1.0 - place.cosine * place.cosine).sqrt();
            sum += f64::from(grid.density(place)) * sine * PI / f64::from(m) * TAU / f64::from(n);
        }
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    }

    #[test]
    fn samples_are_as_frequent_as_the_density_says() {
        // Pearson's chi-square over the cells, each cut in two along both sides.
        let grid = grid();
        let (n, w, h) = (200_000_u32, 14_u32, 10_u32);
        let mut counts = vec![0_u32; (w * h) as usize];
        let mut numbers = random(7);
        for _ in 0..n {
            let place = grid.sample(numbers());
            assert!(grid.density(place) > 0.0, "{place:?}");
            let row = (libm::acos(place.cosine) / PI * f64::from(h)) as u32;
            let column = (place.turn * f64::from(w)) as u32;
            counts[(row.min(h - 1) * w + column.min(w - 1)) as usize] += 1;
        }
        let mut chi_square = 0.0;
        let mut freedom = -1.0;
        for (i, &count) in (0..).zip(&counts) {
            let (x, y) = (i % w, i / w);
            let edge = |y: u32| libm::cos(PI * f64::from(y) / f64::from(h));
            let middle = Place {
                turn: (f64::from(x) + 0.5) / f64::from(w),
                cosine: (edge(y) + edge(y + 1)) / 2.0,
            };
            let solid_angle = TAU / f64::from(w) * (edge(y) - edge(y + 1));
            let expected = f64::from(grid.density(middle)) * solid_angle * f64::from(n);
            if expected > 0.0 {
                let off = f64::from(count) - expected;
                chi_square += off * off / expected;
                freedom += 1.0;
            } else {
                assert_eq!(count, 0);
            }
        }
        // Its mean is the degrees of freedom, its variance twice that.
        let most = freedom + 4.0 * f64::sqrt(2.0 * freedom);
        assert!(chi_square < most, "{chi_square} of at most {most}");
    }

    #[test]
    fn faint_cells_beside_a_bright_one_are_still_chosen() {
        let weight = |x: u32, y: u32| if (x, y) == (500, 100) { 1e9 } else { 1e-6 };
        let grid = Distribution::new(1000, 500, weight).expect("not black");
        for (turn, cosine) in [(0.0, 1.0), (0.25, 0.3), (0.999, -0.999), (0.501, 0.81)] {
            assert!(grid.density(Place { turn, cosine }) > 0.0);
        }
        assert!(Distribution::new(3, 2, |_, _| 0.0).is_none());
    }
}
