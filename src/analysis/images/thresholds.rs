//! When pictures count as different: the thresholds of idiff (OpenImageIO), with its meaning and its defaults.

/// What idiff allows by default: less than any code of 8 or 16 bits.
pub const DEFAULT_THRESHOLD: f64 = 1e-6;

/// The limits of one verdict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// A pixel is beyond the limit if the absolute difference of any channel is greater.
    pub threshold: f64,
    /// Percentage of pixels that may be beyond it.
    pub percent: f64,
    /// No pixel at all may differ by more.
    pub hard: f64,
}

impl Default for Limits {
    /// No pixel may differ by more than [`DEFAULT_THRESHOLD`].
    fn default() -> Self {
        Self {
            threshold: DEFAULT_THRESHOLD,
            percent: 0.0,
            hard: f64::INFINITY,
        }
    }
}

impl Limits {
    /// Whether so many pixels of all, or the greatest difference, are too much.
    pub fn are_exceeded(&self, beyond: usize, pixels: usize, greatest: f64) -> bool {
        beyond as f64 > self.percent / 100.0 * pixels as f64 || greatest > self.hard
    }
}

/// What is said of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Within all limits.
    Same,
    /// Within the limits of failure, beyond those of warning.
    Warning,
    /// Beyond the limits of failure, or of another shape.
    Different,
}

impl Verdict {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Warning => "warning",
            Self::Different => "different",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percentage_is_exceeded_by_more_than_its_share_and_hard_limits_by_one_pixel() {
        let limits = Limits {
            threshold: 0.1,
            percent: 2.5,
            hard: 0.5,
        };
        assert!(!limits.are_exceeded(5, 200, 0.5));
        assert!(limits.are_exceeded(6, 200, 0.2));
        assert!(limits.are_exceeded(0, 200, 0.500_001));
        assert!(!Limits::default().are_exceeded(0, 1, 1e-7));
        assert!(Limits::default().are_exceeded(1, 1_000_000, 0.1));
    }
}
