//! The lecture's cost model ("The Cost Saving").

/// How many times faster rays are with an extent than without, as the lecture predicts it: `m / (1 + f m)`.
///
/// `m` is the cost of the full test in tests of the extent, `f` the share of rays that reach the extent. Below 1, the extent is a loss.
///
/// ```
/// use bspray::accel::extents::speed_ratio;
/// // The lecture's example: "about 13".
/// assert!((speed_ratio(20.0, 1.0 / 40.0) - 40.0 / 3.0).abs() < 1e-12);
/// ```
pub fn speed_ratio(m: f64, f: f64) -> f64 {
    m / (1.0 + f * m)
}
