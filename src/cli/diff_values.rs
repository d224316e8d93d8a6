//! Parsing of the values that arguments of `bspray diff` take.

use bspray::analysis::images::Exposures;

use super::values;

/// A limit of differences: 0 or more, `inf` for none.
pub(super) fn limit(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok();
    value
        .filter(|v| *v >= 0.0)
        .ok_or_else(|| "want a number, 0 or greater, or inf".to_owned())
}

/// Pixels in a degree of vision; filters grow with them.
pub(super) fn pixels_per_degree(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok();
    value
        .filter(|v| (1.0..=1000.0).contains(v))
        .ok_or_else(|| "want a number from 1 to 1000".to_owned())
}

/// `START,STOP,COUNT`: exposures in stops.
pub(super) fn exposures(text: &str) -> Result<Exposures, String> {
    let [start, stop, count] = values::numbers::<f64, 3>(text, "START,STOP,COUNT")?;
    let is_range = -100.0 <= start && start <= stop && stop <= 100.0;
    if is_range && (1.0..=1000.0).contains(&count) && count.fract() <= 0.0 {
        let count = count as u32;
        Ok(Exposures { start, stop, count })
    } else {
        Err("want START <= STOP, both from -100 to 100, and a COUNT from 1 to 1000".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_not_negative_and_exposures_run_upwards() {
        assert_eq!(limit("0.5"), Ok(0.5));
        assert_eq!(limit("inf"), Ok(f64::INFINITY));
        assert!(limit("-1").is_err() && limit("NaN").is_err() && limit("x").is_err());
        let expected = Exposures {
            start: -2.5,
            stop: 3.0,
            count: 4,
        };
        assert_eq!(exposures("-2.5,3,4"), Ok(expected));
        for wrong in ["3,2,4", "1,2,0", "1,2,2.5", "1,2", "NaN,1,2", "0,1,1e9"] {
            assert!(exposures(wrong).is_err(), "{wrong}");
        }
        assert!(pixels_per_degree("67").is_ok() && pixels_per_degree("0.5").is_err());
    }
}
