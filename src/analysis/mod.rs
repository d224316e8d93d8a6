//! What is measured: accelerators by their speed on the rays of one view, by whether their answers are true and where they fail ([`stability`]), and pictures by
//! how they differ.
//!
//! ```
//! use bspray::accel::AcceleratorKind;
//! use bspray::analysis::{CompareOptions, Comparison};
//! use bspray::render::{CameraWishes, SkyMode, frame_scene};
//! use glam::Vec3;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = bspray::import::load(&["models/lecture-block.obj".into()])?;
//! let camera = frame_scene(&scene, &CameraWishes::default(), Vec3::Y, 1.0);
//! let options = CompareOptions {
//!     kinds: vec![AcceleratorKind::Bsp, AcceleratorKind::Bvh2],
//!     size: (64, 64),
//!     repetitions: 1,
//!     ..CompareOptions::default()
//! };
//! let frame = camera.frame(64, 64).ok_or("the camera sees nothing")?;
//! let comparison = Comparison::of(&scene, &frame, &options, &|_| ());
//! assert!(comparison.is_first_right());
//! # Ok(())
//! # }
//! ```

mod accuracy;
mod clock;
mod compare;
mod dispute;
pub mod images;
mod ladder;
mod machine;
mod measure;
pub mod report;
pub mod stability;
mod view_rays;

pub use accuracy::{Fault, Faults, Oracle, judge};
pub use clock::{Elapsed, Stopwatch};
pub use compare::{
    BuiltMethod, CompareOptions, Comparison, MethodOnSet, Phase, SetReport, compare_set,
};
pub use dispute::WrongRay;
pub use ladder::{Ladder, LadderOptions, LadderStep, StepOnRays, ray_sets};
pub use machine::{compiled_instructions, machine, processor};
pub use measure::{Speed, Spread, Timing, answers, build, speeds_in_turns, steps};
pub use view_rays::{Query, RayPurpose, RaySet, ViewOptions, view_rays};
