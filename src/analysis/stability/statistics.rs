//! What a count of failures says of the rate behind it.

use serde::{Deserialize, Serialize};

/// Standard deviations of the normal distribution within which 95 % lie.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// A share with its confidence interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// Failures over rays; 0 without rays.
    pub rate: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end: above 0 also where nothing failed, since rays are finitely many.
    pub high: f64,
}

impl Rate {
    /// The share of `failures` among `rays` with its 95 % interval, by Wilson, "Probable Inference, the Law of Succession, and Statistical
    /// Inference", JASA 22, 1927. It stays within 0 and 1 and is right to use for few or no failures, which the textbook's
    /// normal interval is not.
    ///
    /// ```
    /// use bspray::analysis::stability::Rate;
    /// let none = Rate::of(0, 1000);
    /// assert_eq!((none.rate, none.low), (0.0, 0.0));
    /// assert!(0.0038 < none.high && none.high < 0.0039);
    /// ```
    pub fn of(failures: u64, rays: u64) -> Self {
        if rays == 0 {
            return Self {
                rate: 0.0,
                low: 0.0,
                high: 1.0,
            };
        }
        let (n, squared) = (rays as f64, NORMAL_95 * NORMAL_95);
        let rate = failures as f64 / n;
        let middle = (rate + squared / (2.0 * n)) / (1.0 + squared / n);
        let half = NORMAL_95 / (1.0 + squared / n)
            * (rate * (1.0 - rate) / n + squared / (4.0 * n * n)).sqrt();
        Self {
            rate,
            low: if failures == 0 {
                0.0
            } else {
                (middle - half).max(0.0)
            },
            high: if failures == rays {
                1.0
            } else {
                (middle + half).min(1.0)
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_the_literature() {
        // Newcombe, "Two-sided confidence intervals for the single proportion", 1998, table I, method 3.
        for (failures, rays, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let rate = Rate::of(failures, rays);
            assert!((rate.low - low).abs() < 6e-5, "{rate:?}");
            assert!((rate.high - high).abs() < 6e-5, "{rate:?}");
        }
        assert_eq!(Rate::of(7, 7).high, 1.0);
        assert_eq!(Rate::of(0, 0).high, 1.0);
    }
}
