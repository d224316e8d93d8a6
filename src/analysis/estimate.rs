//! What repeated measurements say of a number: their median, and where it lies by the bootstrap.
//!
//! The interval is the percentile interval of Efron, "Bootstrap Methods: Another Look at the Jackknife", Annals of Statistics 7, 1979: of so many samples, drawn
//! from the values with replacement, it has the medians but for the lowest and the highest fortieth. It takes nothing for granted about how the values are distributed,
//! and covers the true median in some 95 of 100 cases from nine values on.

use super::random::Random;

/// Samples drawn. Efron and Tibshirani ask for 1000 for an interval of 95 %; more would change its ends by less than their own error.
const RESAMPLES: usize = 2000;

/// Share of the medians beyond each end.
const TAIL: f64 = 0.025;

/// Fewest values that can tell a difference at 5 %: all of five lie at one side of their median in `2 / 2^5` of the cases, of six in `2 / 2^6`.
const LEAST_VALUES: usize = 6;

/// A median, and its interval of 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Lower end of the interval.
    pub low: f64,
    /// Half of the values are at most this.
    pub median: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// Of so many values.
    pub values: usize,
}

impl Estimate {
    /// Of the values; `None` without values. Equal seeds give equal intervals.
    ///
    /// ```
    /// use bspray::analysis::Estimate;
    /// let ratios = [1.9, 2.1, 2.0, 2.2, 2.1, 1.8, 2.0, 2.0, 2.3];
    /// let ratio = Estimate::of(ratios.to_vec(), 0).expect("there are values");
    /// assert_eq!(ratio.median, 2.0);
    /// assert!(1.9 <= ratio.low && ratio.high <= 2.2);
    /// assert!(ratio.excludes(1.0));
    /// ```
    pub fn of(mut values: Vec<f64>, seed: u64) -> Option<Self> {
        let count = values.len();
        if count == 0 {
            return None;
        }
        let median_of_all = median(&mut values);
        let mut random = Random::new(seed, "bootstrap", count as u64);
        let mut sample = vec![0.0; count];
        let mut medians: Vec<f64> = (0..RESAMPLES)
            .map(|_| {
                sample.fill_with(|| values[random.below(count)]);
                median(&mut sample)
            })
            .collect();
        medians.sort_by(f64::total_cmp);
        let beyond = (RESAMPLES as f64 * TAIL) as usize;
        Some(Self {
            low: medians[beyond],
            median: median_of_all,
            high: medians[RESAMPLES - 1 - beyond],
            values: count,
        })
    }

    /// Half the length of the interval.
    pub fn half_width(&self) -> f64 {
        (self.high - self.low) / 2.0
    }

    /// Whether the values say, at 5 %, that the median is not `x`: the interval does not have it, and there are values enough to tell.
    pub fn excludes(&self, x: f64) -> bool {
        self.values >= LEAST_VALUES && (x < self.low || self.high < x)
    }
}

/// The middle value, or the mean of the two in the middle. There is one value at least; their order is lost.
fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    let is_odd = values.len() % 2 == 1;
    let (below, &mut upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    if is_odd {
        return upper;
    }
    let lower = below.iter().copied().max_by(f64::total_cmp);
    lower.map_or(upper, |lower| (lower + upper) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_lie_in_the_middle_of_any_order() {
        assert_eq!(median(&mut [40.0, 10.0, 30.0, 20.0]), 25.0);
        assert_eq!(median(&mut [5.0, -1.0, 3.0]), 3.0);
        let one = Estimate::of(vec![3.0], 0).unwrap();
        assert_eq!((one.low, one.median, one.high), (3.0, 3.0, 3.0));
        assert_eq!(Estimate::of(Vec::new(), 0), None);
        let flat = Estimate::of(vec![2.0; 9], 0).unwrap();
        assert_eq!(flat.half_width(), 0.0);
    }

    #[test]
    fn intervals_cover_the_median_of_a_skewed_distribution_as_often_as_they_say() {
        // Exponential, of median ln 2: machines are slow now and then, and never fast.
        let mut random = Random::new(11, "exponential", 0);
        for count in [9, 16, 25] {
            let trials = 1500;
            let covered = (0..trials).filter(|&trial| {
                let draw = |_| -libm::log(1.0 - random.unit());
                let values: Vec<f64> = (0..count).map(draw).collect();
                let estimate = Estimate::of(values, trial).unwrap();
                (estimate.low..=estimate.high).contains(&std::f64::consts::LN_2)
            });
            let share = covered.count() as f64 / trials as f64;
            assert!((0.925..0.985).contains(&share), "{count}: {share}");
        }
    }

    #[test]
    fn too_few_values_tell_no_difference() {
        let far = |count| Estimate::of(vec![2.0; count], 0).unwrap();
        assert!(!far(5).excludes(1.0));
        assert!(far(6).excludes(1.0));
        assert!(!far(6).excludes(2.0));
        let around = vec![0.9, 1.1, 1.2, 0.8, 1.0, 1.1, 0.95];
        assert!(!Estimate::of(around, 0).unwrap().excludes(1.0));
    }
}
