//! Ray tracing after Whitted ("An improved illumination model for shaded display", 1980), as the lecture teaches it: at each surface a
//! shadow ray to each light, one mirror ray and one refraction ray, down to a recursion level.
//!
//! What the model has no rays for is stood in for: the light of the sky that matt surfaces get is what reaches their normal when nothing is in the way,
//! lessened by baked occlusion; mirrors of middling roughness show the smooth reflection weakly and the sky for the rest; shadows of
//! glass are lighter by what it lets pass, unbent.

use glam::Vec3;

use super::media::Media;
use super::{MOST_LAYERS, NEARLY_OPAQUE, Radiance, first_visible, shadow_ray_to};
use crate::geometry::{Ray, RayOrigin};
use crate::render::lights::{Incident, Receiver};
use crate::render::ray_cone::RayCone;
use crate::render::sampler::Sampler;
use crate::render::stage::Stage;
use crate::render::surface::{MaterialPoint, Surface};
use crate::render::texture::ColorSpace;
use crate::render::tracer::{RayKind, Tracer};

/// Share of the picture's light below which a ray is not sent: less than a step of 8 bits.
const LEAST_WEIGHT: f32 = 1.0 / 512.0;

/// Roughness from which a mirror shows nothing but the sky.
const MATT_MIRROR: f32 = 0.5;

struct Whitted<'t, 's, 'a> {
    stage: &'t Stage<'s>,
    tracer: &'t mut Tracer<'a>,
    sampler: &'t mut Sampler,
    max_depth: u32,
}

/// Radiance that leaves a surface towards the origin of `ray`, by rays of at most `max_depth`.
pub(super) fn shade(
    stage: &Stage,
    tracer: &mut Tracer,
    ray: &Ray,
    surface: &Surface,
    material: &MaterialPoint,
    sampler: &mut Sampler,
    max_depth: u32,
) -> Radiance {
    let mut whitted = Whitted {
        stage,
        tracer,
        sampler,
        max_depth,
    };
    whitted.shade(ray, surface, material, Media::default(), Vec3::ONE)
}

impl Whitted<'_, '_, '_> {
    /// `weight`: what the radiance is worth in the picture.
    fn shade(
        &mut self,
        ray: &Ray,
        surface: &Surface,
        material: &MaterialPoint,
        media: Media,
        weight: Vec3,
    ) -> Radiance {
        if material.is_unlit {
            return Radiance::plain(material.base_color, surface.shading_normal, material);
        }
        let stage = self.stage;
        let depth = ray.source.depth + 1;
        let view = -ray.direction.normalize_or(Vec3::NEG_Z);
        let own = surface.material(stage);
        let index = surface.material;
        let eta = if own.is_solid() {
            media.eta(own, index, surface.is_front)
        } else {
            1.0
        };
        let lobes = surface.lobes(stage, material);
        let bsdf = surface.bsdf_of(stage, &lobes, view, eta);

        let mut direct = material.emission;
        if depth <= self.max_depth {
            for incident in self.lights(&surface.receiver(self.stage)) {
                let (value, _) = bsdf.evaluate(incident.direction);
                if value != Vec3::ZERO {
                    let shadow = shadow_ray_to(surface, &incident, depth);
                    direct += value * incident.irradiance * self.passed(shadow);
                }
            }
        }
        let normal = bsdf.shading_normal();
        let ambient = |direction| {
            let environment = stage.environment.as_ref();
            environment.map_or(Vec3::ZERO, |e| e.ambient(direction))
        };
        let occlusion = surface.texel(stage, own.occlusion_texture, ColorSpace::Linear);
        let occlusion = 1.0 + own.occlusion_strength * (occlusion.x - 1.0);
        direct += bsdf.diffuse_albedo() * ambient(normal) * occlusion;

        let mirrored = bsdf.mirrored();
        let direction = mirrored.reflection;
        let smoothness = (1.0 - lobes.roughness / MATT_MIRROR).clamp(0.0, 1.0);
        // Coats and glass are taken as smooth: they are what is seen in them.
        let sharp = mirrored.clear + mirrored.base * (smoothness * smoothness);
        let blurred = mirrored.base + mirrored.clear - sharp;
        direct += blurred * ambient(direction) * occlusion;
        let cone = surface.cone;
        let mut send = |direction, kind, media, share| {
            let from = surface.origin_towards(direction);
            let source = RayOrigin { depth, pixel: None };
            let ray = Ray {
                source,
                ..Ray::new(from, direction)
            };
            self.send((ray, cone), kind, media, share, weight)
        };
        let mut indirect = send(direction, RayKind::Reflection, media, sharp);
        if let Some((direction, share)) = mirrored.refraction {
            let behind = if own.is_solid() {
                media.behind(own, index, surface.is_front)
            } else {
                media
            };
            indirect += send(direction, RayKind::Refraction, behind, share);
        }
        Radiance {
            total: direct + indirect,
            direct,
            diffuse_albedo: bsdf.diffuse_albedo(),
            specular_albedo: bsdf.specular_albedo(),
            normal,
        }
    }

    /// The light that a ray brings, times `share`.
    fn send(
        &mut self,
        (mut ray, cone): (Ray, RayCone),
        kind: RayKind,
        media: Media,
        share: Vec3,
        weight: Vec3,
    ) -> Vec3 {
        let weight = weight * share;
        if weight.max_element() < LEAST_WEIGHT || ray.source.depth > self.max_depth {
            return Vec3::ZERO;
        }
        let seen = match first_visible(self.stage, self.tracer, &mut ray, cone, kind) {
            None => {
                let environment = self.stage.environment.as_ref();
                environment.map_or(Vec3::ZERO, |e| e.far(ray.direction))
            }
            Some((surface, material)) => {
                let seen = self.shade(&ray, &surface, &material, media, weight);
                seen.total * media.transmittance(surface.hit.t)
            }
        };
        seen * share
    }

    /// Light from all punctual lights, a point of the emissive triangles and one of the sun.
    fn lights(&mut self, receiver: &Receiver) -> Vec<Incident> {
        let lights = &self.stage.lights;
        let mut all: Vec<_> = lights.punctual(receiver.position).collect();
        if lights.has_emitters() {
            let choice = self.sampler.next_1d();
            let place = self.sampler.next_2d();
            all.extend(lights.emitter(self.stage, receiver, choice, place));
        }
        if let Some(environment) = &self.stage.environment {
            let found = environment.sample_sun(self.sampler.next_2d());
            all.extend(found.as_ref().map(Incident::far));
        }
        all
    }

    /// The share of light that arrives along a shadow ray.
    fn passed(&mut self, ray: Ray) -> Vec3 {
        let stage = self.stage;
        if !stage.has_transmission {
            return Vec3::splat(super::visibility(stage, self.tracer, ray, RayKind::Shadow));
        }
        let mut ray = ray;
        let mut passed = Vec3::ONE;
        for _ in 0..MOST_LAYERS {
            let Some(hit) = self.tracer.closest(&ray, RayKind::Shadow) else {
                return passed;
            };
            let surface = Surface::at(stage, &ray, hit);
            let material = surface.material_point(stage);
            let lobes = surface.lobes(stage, &material);
            let glass = (1.0 - lobes.metallic) * lobes.transmission;
            let color = lobes.base_color * (Vec3::ONE - lobes.f0) * glass;
            passed *= color.lerp(Vec3::ONE, 1.0 - material.alpha);
            if passed.max_element() < NEARLY_OPAQUE {
                return Vec3::ZERO;
            }
            ray = ray.behind(hit.t, (hit.instance, hit.triangle));
        }
        Vec3::ZERO
    }
}
