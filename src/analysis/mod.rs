//! What is measured of accelerators.

mod clock;

pub use clock::{Elapsed, Stopwatch};
