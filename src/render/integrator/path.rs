//! Path tracing: light that comes by any number of bounces (Kajiya 1986), with lights looked for at every bounce and both ways to find them
//! weighed by their densities (Veach and Guibas 1995, the power heuristic).

use glam::Vec3;

use super::media::Media;
use super::{LightSearch, MOST_LAYERS, Radiance, shadow_ray_to, visibility};
use crate::geometry::{Ray, RayOrigin};
use crate::render::bsdf::{ScatterKind, Scattering};
use crate::render::lights::{Incident, Receiver};
use crate::render::ray_cone::RayCone;
use crate::render::sampler::Sampler;
use crate::render::stage::Stage;
use crate::render::surface::{MaterialPoint, Surface};
use crate::render::tracer::{RayKind, Tracer};

/// Bounces after which a path goes on only with a chance that follows what it still carries.
const SAFE_BOUNCES: u32 = 3;

/// Greatest chance of a path to go on: even light that nothing dims comes to an end.
const MOST_CHANCE: f32 = 0.95;

/// A path on its way from the eye.
struct Path {
    /// What one unit of radiance at its end is worth in the picture.
    throughput: Vec3,
    radiance: Vec3,
    media: Media,
}

/// How far paths go, and how they look for lights.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Greatest depth of a ray.
    pub(super) max_depth: u32,
    pub(super) search: LightSearch,
}

impl Limits {
    /// The share that counts of light that was found with density `own`, both per steradian, and could have been found the other way with
    /// density `other`: the power heuristic with exponent 2. `is_looked_for`: found by a ray to a light.
    fn weight(self, own: f32, other: f32, is_looked_for: bool) -> f32 {
        if own == f32::INFINITY {
            return 1.0;
        }
        match self.search {
            LightSearch::Both => {
                let ratio = other / own;
                1.0 / (1.0 + ratio * ratio)
            }
            LightSearch::Lights => f32::from(u8::from(is_looked_for)),
            LightSearch::Surfaces => f32::from(u8::from(!is_looked_for)),
        }
    }
}

/// Where the last ray of a path came from, as far as lights that it meets need to know.
#[derive(Clone, Copy)]
struct From {
    receiver: Receiver,
    /// Density with which the ray was chosen, per steradian.
    density: f32,
}

/// Radiance that leaves a surface towards the origin of `ray`, by paths within limits.
pub(super) fn shade(
    stage: &Stage,
    tracer: &mut Tracer,
    ray: &Ray,
    surface: &Surface,
    material: &MaterialPoint,
    sampler: &mut Sampler,
    limits: Limits,
) -> Radiance {
    let mut path = Path {
        throughput: Vec3::ONE,
        radiance: material.emission,
        media: Media::default(),
    };
    let mut seen = Radiance::default();
    let mut direct = None;
    let (mut ray, mut surface, mut material) = (*ray, *surface, *material);
    loop {
        let depth = ray.source.depth + 1;
        if depth == 2 {
            direct = Some(path.radiance);
        }
        if material.is_unlit {
            path.radiance += path.throughput * material.base_color;
            break;
        }
        if depth > limits.max_depth.max(1) {
            break;
        }
        let view = -ray.direction.normalize_or(Vec3::NEG_Z);
        let own = surface.material(stage);
        let index = surface.material;
        let eta = if own.is_solid() {
            path.media.eta(own, index, surface.is_front)
        } else {
            1.0
        };
        let bsdf = surface.scattering(stage, &material, view, eta);
        if depth == 1 {
            seen.diffuse_albedo = bsdf.diffuse_albedo();
            seen.specular_albedo = bsdf.specular_albedo();
            seen.normal = bsdf.shading_normal();
        }
        if depth > limits.max_depth {
            break;
        }
        path.look_for_lights(stage, tracer, &surface, &bsdf, sampler, (depth, limits));

        let Some(next) = bsdf.sample(sampler) else {
            break;
        };
        path.throughput *= next.weight;
        if next.kind == ScatterKind::Refraction && own.is_solid() {
            path.media = path.media.behind(own, index, surface.is_front);
        }
        if depth > SAFE_BOUNCES {
            let chance = path.throughput.max_element().min(MOST_CHANCE);
            if sampler.next_1d() >= chance {
                break;
            }
            path.throughput /= chance;
        }
        let from = From {
            receiver: surface.receiver(stage),
            density: next.density,
        };
        let kind = match next.kind {
            ScatterKind::Diffuse => RayKind::Diffuse,
            ScatterKind::Reflection => RayKind::Reflection,
            ScatterKind::Refraction => RayKind::Refraction,
        };
        ray = Ray {
            source: RayOrigin { depth, pixel: None },
            ..Ray::new(surface.origin_towards(next.direction), next.direction)
        };
        let cone = surface.cone.widened(spread(next.kind, bsdf.roughness()));
        let Some(hit) = follow(stage, tracer, &mut ray, cone, kind, sampler) else {
            let sky = beyond(stage, next.direction, from.density, limits);
            path.radiance += path.throughput * sky;
            break;
        };
        path.throughput *= path.media.transmittance(hit.0.hit.t);
        (surface, material) = hit;
        if material.emission != Vec3::ZERO {
            let lights = &stage.lights;
            let density = lights.emitter_density(surface.hit, &from.receiver, surface.position);
            let share = limits.weight(from.density, density, false);
            path.radiance += path.throughput * material.emission * share;
        }
    }
    seen.total = path.radiance;
    seen.direct = direct.unwrap_or(path.radiance);
    seen
}

/// The first surface along a ray that stops it: one that is partly transparent does so with the chance of its alpha. The ray is left as
/// the one that met it.
fn follow(
    stage: &Stage,
    tracer: &mut Tracer,
    ray: &mut Ray,
    cone: RayCone,
    kind: RayKind,
    sampler: &mut Sampler,
) -> Option<(Surface, MaterialPoint)> {
    for _ in 0..MOST_LAYERS {
        let hit = tracer.closest(ray, kind)?;
        let surface = Surface::seen(stage, &mut tracer.facets, ray, hit, cone);
        let material = surface.material_point(stage);
        if material.alpha >= 1.0 || sampler.next_1d() < material.alpha {
            return Some((surface, material));
        }
        *ray = ray.behind(hit.t, (hit.instance, hit.triangle));
    }
    None
}

impl Path {
    /// Light that the surface sends back of one light of each sort: a punctual one, a point of an emissive triangle, a direction of
    /// the environment.
    fn look_for_lights(
        &mut self,
        stage: &Stage,
        tracer: &mut Tracer,
        surface: &Surface,
        bsdf: &Scattering,
        sampler: &mut Sampler,
        (depth, limits): (u32, Limits),
    ) {
        if bsdf.is_all_smooth() {
            return;
        }
        let lights = &stage.lights;
        let mut add = |tracer: &mut Tracer, sampler: &mut Sampler, incident: Incident| {
            let (value, density) = bsdf.evaluate(incident.direction);
            let share = limits.weight(incident.density, density, true);
            let worth = value.element_sum();
            let counts = worth > 0.0 && worth.is_finite() && share > 0.0;
            if !counts {
                return;
            }
            let unshadowed = self.throughput * value * incident.irradiance * share;
            let chance = stage.thrift.chance(unshadowed, self.radiance);
            if chance < 1.0 && !sampler.toss(chance) {
                return;
            }
            let shadow = shadow_ray_to(surface, &incident, depth);
            let passed = visibility(stage, tracer, shadow, RayKind::Shadow);
            self.radiance += unshadowed * (passed / chance);
        };
        if lights.has_punctual() {
            let choice = sampler.next_1d_if(lights.has_many_punctual());
            let worth = |direction: Vec3| bsdf.evaluate(direction).0.element_sum();
            if let Some(incident) = lights.one_punctual(surface.position, choice, worth) {
                add(tracer, sampler, incident);
            }
        }
        if lights.has_emitters() {
            let choice = sampler.next_1d();
            let place = sampler.next_2d();
            if let Some(incident) = lights.emitter(stage, &surface.receiver(stage), choice, place) {
                add(tracer, sampler, incident);
            }
        }
        if let Some(environment) = &stage.environment
            && let Some(found) = environment.search(sampler.next_2d())
        {
            add(tracer, sampler, Incident::far(&found));
        }
    }
}

/// Radiance of the environment from a direction that was chosen with a density.
fn beyond(stage: &Stage, direction: Vec3, chosen: f32, limits: Limits) -> Vec3 {
    let Some(environment) = &stage.environment else {
        return Vec3::ZERO;
    };
    let (rest, searched, density) = environment.parts(direction);
    rest + searched * limits.weight(chosen, density, false)
}

/// By how much a bounce widens the cone of a ray, in radians: a part of the lobe that its direction was chosen from, since the samples of a pixel
/// fill the rest.
fn spread(kind: ScatterKind, roughness: f32) -> f32 {
    match kind {
        ScatterKind::Diffuse => 0.25,
        ScatterKind::Reflection | ScatterKind::Refraction => 0.25 * roughness * roughness,
    }
}
