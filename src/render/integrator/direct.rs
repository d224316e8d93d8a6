//! Light that reaches a matt surface directly.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::super::environment::EnvironmentSample;
use super::super::lights::{Incident, cosine_hemisphere};
use super::super::sampler::Sampler;
use super::super::stage::Stage;
use super::super::surface::{MaterialPoint, Surface};
use super::super::tracer::{RayKind, Tracer};
use super::visibility;
use crate::geometry::{Interval, Ray, RayOrigin};

/// Radiance that leaves the surface: its own, and that of every light reflected by Lambert's law. Punctual lights are
/// all asked; of emitters, sun and sky one point each is chosen.
pub(super) fn shade(
    stage: &Stage,
    tracer: &mut Tracer,
    ray: &Ray,
    surface: &Surface,
    material: &MaterialPoint,
    sampler: &mut Sampler,
) -> Vec3 {
    let mut irradiance = Vec3::ZERO;
    if !material.is_unlit {
        lights(stage, ray, surface, sampler, |arriving| {
            let passed = visibility(stage, tracer, arriving.shadow, RayKind::Shadow);
            irradiance += arriving.irradiance * (arriving.cosine * passed);
        });
    }
    reflected(material, irradiance)
}

/// What leaves a surface that gets an irradiance.
pub(super) fn reflected(material: &MaterialPoint, irradiance: Vec3) -> Vec3 {
    if material.is_unlit {
        return material.base_color;
    }
    material.emission + material.base_color * irradiance * FRAC_1_PI
}

/// Light that comes to a surface, if nothing is in its way.
pub(super) struct Arriving {
    /// Irradiance across its direction.
    pub(super) irradiance: Vec3,
    /// Between its direction and the shading normal.
    pub(super) cosine: f32,
    /// Asks what is in its way.
    pub(super) shadow: Ray,
}

/// Finds the light that comes to where a ray met a surface.
#[inline]
pub(super) fn lights(
    stage: &Stage,
    ray: &Ray,
    surface: &Surface,
    sampler: &mut Sampler,
    mut found: impl FnMut(Arriving),
) {
    let depth = ray.source.depth + 1;
    let mut add = |incident: Incident| {
        let cosine = incident.direction.dot(surface.shading_normal);
        if cosine > 0.0 && incident.direction.dot(surface.geometric_normal) > 0.0 {
            found(Arriving {
                irradiance: incident.irradiance,
                cosine,
                shadow: shadow_ray_to(surface, &incident, depth),
            });
        }
    };
    for incident in stage.lights.punctual(surface.position) {
        add(incident);
    }
    if stage.lights.has_emitters() {
        // Three numbers: the choice of the triangle, and the point on it.
        let choice = sampler.next_1d();
        let point = sampler.next_2d();
        if let Some(incident) = stage
            .lights
            .emitter(stage, &surface.receiver(stage), choice, point)
        {
            add(incident);
        }
    }
    if let Some(environment) = &stage.environment {
        let [sun, sky] = [sampler.next_2d(), sampler.next_2d()];
        if let Some(found) = environment.sample_sun(sun) {
            add(Incident::far(&found));
        }
        if environment.is_even() {
            let direction = cosine_hemisphere(surface.shading_normal, sky);
            let cosine = direction.dot(surface.shading_normal);
            let density = cosine * FRAC_1_PI;
            let radiance = environment.far(direction);
            if density > 0.0 {
                let found = EnvironmentSample {
                    direction,
                    radiance,
                    density,
                };
                add(Incident::far(&found));
            }
        } else if let Some(found) = environment.sample_sky(sky) {
            add(Incident::far(&found));
        }
    }
}

/// The ray that asks whether the light arrives.
pub(in super::super) fn shadow_ray_to(surface: &Surface, incident: &Incident, depth: u32) -> Ray {
    let origin = surface.origin_towards(incident.direction);
    let (direction, interval) = match incident.target {
        Some(target) => (target - origin, Interval::new(0.0, 1.0)),
        None => (incident.direction, Interval::FORWARD),
    };
    let source = RayOrigin { depth, pixel: None };
    Ray {
        interval,
        source,
        ..Ray::new(origin, direction)
    }
}
