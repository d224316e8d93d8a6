//! What is measured: accelerators by their speed on the rays of one view, by whether their answers are true and where they fail ([`stability`]), and pictures by
//! how they differ.
//!
//! ```
//! use bspray::accel::AcceleratorKind;
//! use bspray::analysis::{CompareOptions, Comparison, Contestant};
//! use bspray::render::{CameraWishes, SkyMode, frame_scene};
//! use glam::Vec3;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = bspray::import::load(&["models/lecture-block.obj".into()])?;
//! let camera = frame_scene(&scene, &CameraWishes::default(), Vec3::Y, 1.0);
//! let options = CompareOptions {
//!     contestants: [AcceleratorKind::Bsp, AcceleratorKind::Bvh2].map(Contestant::structure).to_vec(),
//!     size: (64, 64),
//!     repetitions: 1,
//!     ..CompareOptions::default()
//! };
//! let frame = camera.frame(64, 64).ok_or("the camera sees nothing")?;
//! let comparison = Comparison::of(&scene, &frame, &options, &|_, _| ())?;
//! assert!(comparison.is_first_right());
//! # Ok(())
//! # }
//! ```

pub mod accuracy;
pub mod chart;
mod clock;
mod compare;
mod estimate;
pub mod images;
mod ladder;
mod machine;
mod measure;
mod memory;
mod plain_scene;
mod random;
pub mod report;
mod specular_rays;
pub mod stability;
mod view_rays;
mod work;

pub use accuracy::{Fault, Faults, Mistakes, Oracle, WrongRay, judge};
pub use clock::{Elapsed, Stopwatch};
pub use compare::{
    Agreement, Built, BuiltMethod, CompareOptions, Comparison, Contestant, CostPictures, Distances,
    Entrant, MethodOnSet, NamedRays, PairReport, Phase, RayFileError, Replayed, Said, SetReport,
    Source, compare_set, rays_of_view, read_rays, replay, write_rays,
};
pub use estimate::Estimate;
pub use ladder::{Ladder, LadderOptions, LadderStep, StepOnRays, ray_sets};
pub use machine::{compiled_instructions, machine, processor};
pub use measure::{BuildCost, Speed, Timing, answers, build, speeds_in_turns, steps};
pub use memory::MemoryMeter;
pub use view_rays::{Query, RayPurpose, RaySet, ViewOptions, view_rays};
pub use work::Work;
