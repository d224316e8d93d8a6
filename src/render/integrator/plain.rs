//! Pictures of what is known of a surface without looking any further.

use glam::Vec3;

use crate::accel::TraceCounters;
use crate::geometry::Ray;
use crate::picture::palette;
use crate::render::stage::Stage;
use crate::render::surface::Surface;

/// Steps of traversal that are as bright as the picture of costs gets: twice what a good tree takes in its worst places.
pub const MOST_STEPS: u64 = 1024;

/// The fractions of the texture coordinates, as red and green.
pub(super) fn uv(surface: &Surface) -> Vec3 {
    let at = surface.uv - surface.uv.floor();
    Vec3::new(at.x, at.y, 0.0)
}

/// A colour for the instance.
pub(super) fn id(surface: &Surface) -> Vec3 {
    Vec3::from_array(palette::distinct(surface.hit.instance))
}

/// The steps that the ray takes.
pub(super) fn cost(stage: &Stage, ray: &Ray) -> Vec3 {
    Vec3::from_array(palette::ramp(share_of_steps(stage, ray)))
}

/// 0 for one step and 1 for [`MOST_STEPS`], by the logarithm.
fn share_of_steps(stage: &Stage, ray: &Ray) -> f32 {
    let mut counters = TraceCounters::default();
    stage.accelerator.closest_hit_counted(ray, &mut counters);
    let steps = counters.nodes + counters.leaves + counters.primitives + counters.extents;
    libm::log2f(steps.max(1) as f32) / libm::log2f(MOST_STEPS as f32)
}
