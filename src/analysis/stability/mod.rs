//! Where methods fail: sweeps over what makes ray tracing hard, each answer judged by exact arithmetic.
//!
//! A [`Sweep`] makes scenes and rays from a parameter, in a dozen steps or more from mild to hard. Every [`Method`] answers, and each answer is judged
//! from the `f32` inputs without rounding. Two standards apart:
//!
//! - The crate's own accelerators owe what `linear` owes, bit for bit, to closest and any hits, alone and in batches, inside the
//!   [`Domain`](crate::accel::Domain). What is outside is named in [`Step::outside`] and not counted.
//! - Other methods owe the nearest triangle at a plausible depth: half of the digits of `f32`. Hits whose exact depths round to one `t`, and the neighbour over an
//!   edge at the true depth, are counted as unresolved, not as errors.
//!
//! An error is blamed on the triangle test if brute force with the same test makes it too (of Embree: each triangle in a scene of its own), and on the traversal otherwise, and is explained by what the ray
//! passes ([`Trouble`]). Rates come with Wilson's interval. Equal options give equal results on any number of threads, but for children that run out of time.
//!
//! ```
//! use bspray::analysis::stability::{Method, StressOptions, StressResults, Sweep};
//!
//! let options = StressOptions {
//!     sweeps: vec![Sweep::named("edges-inside")?],
//!     methods: vec![Method::DEFAULT, "moller-trumbore".parse()?],
//!     rays: 64,
//!     leak_rays: 1000,
//!     ..StressOptions::default()
//! };
//! let results = StressResults::of(&options, &|_| ());
//! assert_eq!(results.default_failures(), 0);
//! let naive = &results.sweeps[0].methods[1];
//! assert!(naive.first_failure.is_some());
//! # Ok::<(), String>(())
//! ```

mod child;
mod defects;
mod ending;
mod judged;
mod leaks;
mod limits;
mod methods;
mod naive;
use super::random;
mod results;
mod runner;
mod sign_map;
mod statistics;
mod sweeps;
mod truth;

pub use super::accuracy::{Blame, Kind, Trouble};
pub use child::{CellTask, Isolation, answer};
pub use ending::Ending;
pub use methods::Method;
pub use results::{
    Cell, DefectResult, FirstFailure, FormulaResult, HitRecord, LeakResult, MethodResult,
    RayRecord, SignMap, Step, StressResults, SweepResult, WrongAnswer, parameter_text,
};
pub use runner::StressOptions;
pub use statistics::Rate;
pub use sweeps::Sweep;
