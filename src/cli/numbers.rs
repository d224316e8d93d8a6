//! Numbers in JSON: single-precision ones as short as they are, not as the double that holds them, and what JSON has no number for.

use bspray::analysis::Estimate;
use serde_json::{Value, json};

/// The shortest number that reads back as `x`; a text for what JSON has no number for.
pub(super) fn number(x: f32) -> Value {
    match x.to_string().parse::<f64>() {
        Ok(short) if x.is_finite() => json!(short),
        _ => json!(x.to_string()),
    }
}

/// The numbers as an array.
pub(super) fn numbers(values: impl AsRef<[f32]>) -> Value {
    values.as_ref().iter().map(|&x| number(x)).collect()
}

/// The number itself; a text (`inf`, `NaN`) for what JSON has no number for.
pub(super) fn double(x: f64) -> Value {
    if x.is_finite() {
        json!(x)
    } else {
        json!(x.to_string())
    }
}

/// A median with its interval.
pub(super) fn estimate(e: Estimate) -> Value {
    json!({ "median": e.median, "interval_95": [e.low, e.high] })
}

/// A ratio of medians with its interval, and whether that has no 1 in it.
pub(super) fn ratio(e: Estimate) -> Value {
    json!({ "median": e.median, "interval_95": [e.low, e.high], "significant": e.excludes(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        assert_eq!(
            numbers([0.1, -3.0, 1e-40, f32::INFINITY]).to_string(),
            r#"[0.1,-3.0,1e-40,"inf"]"#
        );
        for x in [0.1_f32, 1.0 / 3.0, f32::MAX, 1e-45, 16_777_217.0] {
            assert_eq!(
                number(x).as_f64().map(|y| (y as f32).to_bits()),
                Some(x.to_bits())
            );
        }
    }
}
