//! A closed interval of ray parameters.

/// The closed interval `[min, max]` of a ray's parameter `t`, in units of the ray direction's length.
///
/// Both ends belong to it; `max` may be infinite. An interval whose `min` exceeds its `max`, or that has
/// a NaN, is empty: it contains no `t`.
///
/// ```
/// use bspray::geometry::Interval;
/// let shadow = Interval::new(0.0, 1.0);
/// assert!(shadow.contains(1.0) && !shadow.contains(1.5));
/// assert!(Interval::new(2.0, 1.0).is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Least `t` that counts.
    pub min: f32,
    /// Greatest `t` that counts; may be infinite.
    pub max: f32,
}

impl Interval {
    /// From the ray's origin to infinity.
    pub const FORWARD: Self = Self {
        min: 0.0,
        max: f32::INFINITY,
    };

    /// The interval from `min` to `max`, both included.
    pub const fn new(min: f32, max: f32) -> Self {
        Self { min, max }
    }

    /// Whether `t` lies in the interval. A NaN never does.
    pub fn contains(self, t: f32) -> bool {
        self.min <= t && t <= self.max
    }

    /// Whether no `t` at all lies in the interval.
    pub fn is_empty(self) -> bool {
        // Written so that a NaN at either end makes it empty.
        let holds_something = self.min <= self.max;
        !holds_something
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_belong_and_nan_does_not() {
        let i = Interval::new(1.0, 2.0);
        assert!(i.contains(1.0) && i.contains(2.0));
        assert!(!i.contains(1.0_f32.next_down()) && !i.contains(2.0_f32.next_up()));
        assert!(!i.contains(f32::NAN));
        assert!(Interval::new(f32::NAN, 1.0).is_empty() && Interval::new(0.0, f32::NAN).is_empty());
    }

    #[test]
    fn one_point_is_not_empty() {
        assert!(!Interval::new(3.0, 3.0).is_empty());
        assert!(Interval::FORWARD.contains(f32::MAX));
    }
}
