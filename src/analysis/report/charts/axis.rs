//! Axes: their range, their ticks, and where values lie.

use std::ops::Range;

use plotters::coord::ranged1d::{
    KeyPointHint, KeyPointWeight, NoDefaultFormatting, Ranged, ValueFormatter,
};

use super::Scale;

/// Ticks that are wished for.
const TICKS: f64 = 7.0;

/// Share of an axis that is left free beyond the values.
const FREE: f64 = 0.05;

/// An axis with its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ruler {
    scale: Scale,
    from: f64,
    to: f64,
    ticks: Vec<f64>,
    names: Vec<String>,
    /// Where 0 lies, if it has a place of its own.
    zero: Option<f64>,
}

/// How far below the least value 0 lies on an axis that runs by factors, in powers of ten and as a share of all that is shown.
const ZERO: (f64, f64) = (0.5, 0.12);

impl Ruler {
    /// For these values, of which those that a logarithm has none of are left out.
    pub(super) fn of(scale: Scale, values: impl Iterator<Item = f64>) -> Self {
        if scale == Scale::LogAndZero {
            let mut ruler = Self::of(Scale::Log, values);
            let zero = ruler.from - ZERO.0 - (ruler.to - ruler.from) * ZERO.1;
            ruler.from = zero - (ruler.to - zero) * FREE;
            ruler.ticks.insert(0, 0.0);
            ruler.zero = Some(zero);
            return ruler;
        }
        let placed = values.filter_map(|v| place(scale, v));
        let (least, greatest) = placed.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
            (a.min(v), b.max(v))
        });
        if least > greatest {
            return Self::of(scale, [1.0, 10.0].into_iter());
        }
        let width = (greatest - least).max(match scale {
            Scale::Linear => greatest.abs().max(1e-9) * 1e-3,
            Scale::Log | Scale::LogAndZero => 0.3,
        });
        // What has no negative values, and begins near 0, begins at 0.
        let from = least - width * FREE;
        let from = match scale {
            Scale::Linear if least >= 0.0 && least < width * 0.5 => 0.0,
            _ => from,
        };
        let to = greatest.max(least + width) + width * FREE;
        let ticks = match scale {
            Scale::Linear => linear_ticks(from, to),
            Scale::Log | Scale::LogAndZero => log_ticks(from, to),
        };
        Self {
            scale,
            from,
            to,
            ticks,
            names: Vec::new(),
            zero: None,
        }
    }

    /// One place for each name, 0, 1, 2 and so on; from the top if the axis is vertical.
    pub(super) fn of_names(names: &[String], is_vertical: bool) -> Self {
        let last = names.len() as f64 - 0.5;
        let (from, to) = if is_vertical {
            (last, -0.5)
        } else {
            (-0.5, last)
        };
        Self {
            scale: Scale::Linear,
            from,
            to,
            ticks: (0..names.len()).map(|i| i as f64).collect(),
            names: names.to_vec(),
            zero: None,
        }
    }

    /// Whether a value has a place on the axis.
    pub(super) fn has(&self, value: f64) -> bool {
        self.place(value).is_some()
    }

    /// The value, or the end of the axis that it is beyond.
    pub(super) fn clamped(&self, value: f64) -> f64 {
        let end = |end: f64| match self.scale {
            Scale::Linear => end,
            Scale::Log | Scale::LogAndZero => libm::exp10(end),
        };
        match self.place(value) {
            Some(at) if at > self.to => end(self.to),
            Some(at) if at >= self.from => value,
            _ => end(self.from),
        }
    }

    /// Where a value lies, before the range.
    fn place(&self, value: f64) -> Option<f64> {
        match self.zero {
            Some(zero) if (0.0..=0.0).contains(&value) => Some(zero),
            _ => place(self.scale, value),
        }
    }

    /// What stands beside a tick.
    pub(super) fn name(&self, value: f64) -> String {
        if let Some(name) = self.names.get(value.round().max(0.0) as usize) {
            return name.clone();
        }
        let magnitude = value.abs();
        if magnitude > 0.0 && !(1e-3..1e5).contains(&magnitude) {
            format!("{value:e}")
        } else {
            // A tick is a short number; sums of steps have a long tail.
            let text = format!("{value:.6}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}

/// Where a value lies, before the range; `None` for what is no finite number there.
fn place(scale: Scale, value: f64) -> Option<f64> {
    let at = match scale {
        Scale::Linear => value,
        Scale::Log | Scale::LogAndZero if value > 0.0 => libm::log10(value),
        Scale::Log | Scale::LogAndZero => return None,
    };
    at.is_finite().then_some(at)
}

/// Multiples of 1, 2 or 5 times a power of ten.
fn linear_ticks(from: f64, to: f64) -> Vec<f64> {
    let rough = (to - from) / TICKS;
    let power = libm::exp10(libm::log10(rough).floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * power)
        .into_iter()
        .find(|step| *step >= rough);
    let step = step.unwrap_or(10.0 * power);
    let (first, last) = ((from / step).ceil() as i64, (to / step).floor() as i64);
    (first..=last).map(|i| i as f64 * step).collect()
}

/// Powers of ten, with 2 and 5 between where these are few.
fn log_ticks(from: f64, to: f64) -> Vec<f64> {
    let decades = to - from;
    let every = (decades / TICKS).ceil().max(1.0) as i32;
    let between: &[f64] = if decades < 3.5 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0]
    };
    let (first, last) = (from.floor() as i32, to.ceil() as i32);
    let powers = (first..=last).filter(|p| p.rem_euclid(every) == 0);
    let ticks = powers.flat_map(|p| between.iter().map(move |m| decimal(*m as i32, p)));
    ticks
        .filter(|t| (from..=to).contains(&libm::log10(*t)))
        .collect()
}

/// `mantissa` times ten to `power`, the nearest number to it.
fn decimal(mantissa: i32, power: i32) -> f64 {
    format!("{mantissa}e{power}").parse().unwrap_or(f64::MAX)
}

impl Ranged for Ruler {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let at = self.place(*value).unwrap_or(self.from);
        let share = (at - self.from) / (self.to - self.from);
        limit.0 + (f64::from(limit.1 - limit.0) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match hint.weight() {
            KeyPointWeight::Bold => self.ticks.clone(),
            KeyPointWeight::Any => Vec::new(),
        }
    }

    fn range(&self) -> Range<f64> {
        self.from..self.to
    }
}

impl ValueFormatter<f64> for Ruler {
    fn format_ext(&self, value: &f64) -> String {
        self.name(*value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        let ruler = Ruler::of(Scale::Linear, [0.0, 0.37].into_iter());
        let names: Vec<String> = ruler.ticks.iter().map(|t| ruler.name(*t)).collect();
        assert_eq!(names, ["0", "0.1", "0.2", "0.3"]);
        let ruler = Ruler::of(Scale::Log, [3e-5, 0.5, 0.0, f64::NAN].into_iter());
        let names: Vec<String> = ruler.ticks.iter().map(|t| ruler.name(*t)).collect();
        assert_eq!(names, ["1e-4", "0.001", "0.01", "0.1"]);
        let ruler = Ruler::of(Scale::LogAndZero, [3e-5, 0.5, 0.0].into_iter());
        let names: Vec<String> = ruler.ticks.iter().map(|t| ruler.name(*t)).collect();
        assert_eq!(names, ["0", "1e-4", "0.001", "0.01", "0.1"]);
        assert!(ruler.has(0.0) && !ruler.has(-1.0));
        assert!(ruler.map(&0.0, (0, 100)) + 5 < ruler.map(&3e-5, (0, 100)));
        let ruler = Ruler::of(Scale::Log, [1.5, 40.0].into_iter());
        let names: Vec<String> = ruler.ticks.iter().map(|t| ruler.name(*t)).collect();
        assert_eq!(names, ["2", "5", "10", "20"]);
    }

    #[test]
    fn values_lie_between_the_ends_whatever_they_are() {
        for values in [&[][..], &[5.0], &[0.0], &[-3.0, 7.0], &[1e-300, 1e300]] {
            for scale in [Scale::Linear, Scale::Log, Scale::LogAndZero] {
                let ruler = Ruler::of(scale, values.iter().copied());
                for &value in values.iter().filter(|v| ruler.has(**v)) {
                    let at = ruler.map(&value, (100, 0));
                    assert!((0..=100).contains(&at), "{scale:?} {values:?}: {at}");
                }
                let at = ruler.map(&ruler.clamped(f64::NEG_INFINITY), (0, 100));
                // Where the axis ends below the least number, with 0.
                let most = if scale == Scale::LogAndZero { 6 } else { 0 };
                assert!((0..=most).contains(&at), "{scale:?} {values:?}: {at}");
            }
        }
        let names = ["a".to_owned(), "b".to_owned()];
        let ruler = Ruler::of_names(&names, true);
        assert_eq!(
            (ruler.map(&0.0, (400, 0)), ruler.name(1.0)),
            (100, "b".to_owned())
        );
    }
}
