//! Ambient occlusion.

use glam::Vec3;

use super::super::lights::cosine_hemisphere;
use super::super::sampler::Sampler;
use super::super::stage::Stage;
use super::super::surface::Surface;
use super::super::tracer::{RayKind, Tracer};
use super::visibility;
use crate::geometry::{Interval, Ray, RayOrigin};

/// White where a ray of the hemisphere, chosen by its cosine, gets as far as `distance`; black where it does not.
pub(super) fn shade(
    stage: &Stage,
    tracer: &mut Tracer,
    ray: &Ray,
    surface: &Surface,
    distance: f32,
    sampler: &mut Sampler,
) -> Vec3 {
    let direction = cosine_hemisphere(surface.shading_normal, sampler.next_2d());
    if direction.dot(surface.geometric_normal) <= 0.0 {
        return Vec3::ZERO;
    }
    let source = RayOrigin {
        depth: ray.source.depth + 1,
        pixel: None,
    };
    let interval = Interval::new(0.0, distance);
    let ray = Ray {
        interval,
        source,
        ..Ray::new(surface.origin_towards(direction), direction)
    };
    Vec3::splat(visibility(stage, tracer, ray, RayKind::Ambient))
}
