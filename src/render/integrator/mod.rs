//! From an eye ray to a colour.

mod ambient;
mod direct;
mod geometry;
mod lit;
mod media;
mod path;
mod plain;
mod whitted;

pub(super) use direct::shadow_ray_to;
pub(super) use lit::Lit;
pub use plain::MOST_STEPS;

use glam::Vec3;

use super::partition;
use super::ray_cone::RayCone;
use super::sampler::Sampler;
use super::stage::Stage;
use super::surface::{MaterialPoint, Surface};
use super::tracer::{RayKind, Tracer};
use crate::accel::Hit;
use crate::geometry::Ray;

/// How colours come about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// Path tracing: light by any number of bounces.
    Path {
        /// Bounces: the greatest depth of a ray, where eye rays have 0.
        max_depth: u32,
        /// How lights that have a size are found.
        search: LightSearch,
    },
    /// Whitted's ray tracing, as the lecture has it: light from the lights, and what mirrors and glass show of other surfaces.
    Whitted {
        /// The lecture's recursion level: the greatest depth of a ray, where eye rays have 0.
        max_depth: u32,
    },
    /// Light that reaches a surface directly, with shadows; surfaces are matt (Lambert).
    Direct,
    /// Ambient occlusion: the share of the hemisphere above a surface that is free within a distance.
    Ao {
        /// How far a ray must get to count as free, in model units.
        distance: f32,
    },
    /// The shading normal, from -1..1 mapped to 0..1.
    Normals,
    /// How much the surface faces the eye: grey for fronts, red for backs.
    Facing,
    /// The base colour.
    Albedo,
    /// Texture coordinates, their fractions as red and green.
    Uv,
    /// A colour for each instance.
    Id,
    /// The steps of traversal of an eye ray, from dark for one to bright for [`MOST_STEPS`], by their logarithm.
    Cost,
    /// A colour for each fragment of the polygon BSP; grey if the stage has no trees.
    Fragment,
    /// How deep in the polygon BSP a fragment is, dark for the root; grey if the stage has no trees.
    BspDepth,
}

/// How a path finds lights that have a size. All ways have the same mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSearch {
    /// By rays to points of lights and by the path's own rays, weighed by their densities (multiple importance sampling).
    #[default]
    Both,
    /// By rays to points of lights, where a surface is not a smooth mirror or lens (next-event estimation).
    Lights,
    /// By the path's own rays, chosen by how the surface scatters.
    Surfaces,
}

/// What a sample of a pixel saw. Colours are linear radiance.
///
/// All but `alpha` and `backdrop` is already multiplied by how much of the pixel the surfaces cover.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Light from surfaces: the sum of `direct` and `indirect`, but for rounding.
    pub color: Vec3,
    /// Share that surfaces cover.
    pub alpha: f32,
    /// Light from behind all surfaces, already multiplied by the share that they leave free.
    pub backdrop: Vec3,
    /// The part of `color` that left the surface that the eye sees by itself, or came to it from a light without meeting another surface.
    pub direct: Vec3,
    /// The part of `color` that met further surfaces on its way.
    pub indirect: Vec3,
    /// Share of white light from everywhere that the surface throws back in all directions, 0 to 1.
    pub diffuse_albedo: Vec3,
    /// Share of white light from everywhere that the surface mirrors, sharply or not, or lets through, 0 to 1.
    pub specular_albedo: Vec3,
    /// Shading normal in world space, of unit length where one surface covers all.
    pub normal: Vec3,
}

/// Light that leaves a surface, and what the surface is like.
#[derive(Clone, Copy, Debug, Default)]
struct Radiance {
    total: Vec3,
    direct: Vec3,
    diffuse_albedo: Vec3,
    specular_albedo: Vec3,
    normal: Vec3,
}

impl Radiance {
    /// A colour that no light makes.
    fn plain(color: Vec3, normal: Vec3, material: &MaterialPoint) -> Self {
        Self {
            total: color,
            direct: color,
            diffuse_albedo: material.base_color,
            specular_albedo: Vec3::ZERO,
            normal,
        }
    }
}

impl Sample {
    /// Lays a surface that covers `share` of the pixel behind those so far.
    fn add(&mut self, seen: &Radiance, share: f32) {
        self.color += seen.total * share;
        self.direct += seen.direct * share;
        self.indirect += (seen.total - seen.direct) * share;
        self.diffuse_albedo += seen.diffuse_albedo * share;
        self.specular_albedo += seen.specular_albedo * share;
        self.normal += seen.normal * share;
        self.alpha += share;
    }
}

/// Surfaces with alpha that one ray passes before the rest counts as covered. Real models stack a few leaves or panes; the
/// bound is for files in which thousands of transparent copies lie in one place.
const MOST_LAYERS: u32 = 64;

/// Share of the light below which what lies behind is not looked at any more: less than a step of 8 bits.
const NEARLY_OPAQUE: f32 = 1.0 / 512.0;

/// The grey behind pictures that are not lit by the sky.
const BACKDROP: Vec3 = Vec3::splat(0.05);

impl Integrator {
    /// The name on the command line and in reports.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Path { .. } => "path",
            Self::Whitted { .. } => "whitted",
            Self::Direct => "direct",
            Self::Ao { .. } => "ao",
            Self::Normals => "normals",
            Self::Facing => "facing",
            Self::Albedo => "albedo",
            Self::Uv => "uv",
            Self::Id => "id",
            Self::Cost => "cost",
            Self::Fragment => "fragment",
            Self::BspDepth => "bsp-depth",
        }
    }

    /// About how many rays it sends for a sample: what to expect, not what to rely on.
    pub const fn rays_a_sample(&self) -> u32 {
        match self {
            Self::Path { .. } => 6,
            Self::Whitted { .. } => 3,
            Self::Direct | Self::Ao { .. } => 2,
            _ => 1,
        }
    }

    /// Whether its colours are light, which a camera would see.
    pub const fn computes_light(&self) -> bool {
        matches!(
            self,
            Self::Path { .. } | Self::Whitted { .. } | Self::Direct
        )
    }

    /// Whether the stage must have the scene's polygon BSPs.
    pub const fn shows_trees(&self) -> bool {
        matches!(self, Self::Fragment | Self::BspDepth)
    }

    /// Whether its colours tell how the accelerator works.
    pub const fn shows_steps(&self) -> bool {
        matches!(self, Self::Cost)
    }

    /// What the eye sees along a ray, of which the first hit is known, with a cone. Surfaces with alpha are laid over one another, front to back.
    pub fn sample(
        &self,
        stage: &Stage,
        tracer: &mut Tracer,
        (mut ray, mut first): (Ray, Option<Hit>),
        cone: RayCone,
        sampler: &mut Sampler,
    ) -> Sample {
        let mut sample = Sample::default();
        for _ in 0..MOST_LAYERS {
            let Some(hit) = first else {
                sample.backdrop = self.backdrop(stage, &ray) * (1.0 - sample.alpha);
                return sample;
            };
            let surface = Surface::seen(stage, &mut tracer.facets, &ray, hit, cone);
            let material = surface.material_point(stage);
            if material.alpha > 0.0 {
                let seen = self.shade(stage, tracer, &ray, &surface, &material, sampler);
                let share = material.alpha * (1.0 - sample.alpha);
                sample.add(&seen, share);
                tracer.cover(hit.instance, surface.material, share);
            }
            if 1.0 - sample.alpha < NEARLY_OPAQUE {
                break;
            }
            ray = ray.behind(hit.t, (hit.instance, hit.triangle));
            first = tracer.closest(&ray, RayKind::Eye);
        }
        sample.alpha = 1.0;
        sample
    }

    fn shade(
        &self,
        stage: &Stage,
        tracer: &mut Tracer,
        ray: &Ray,
        surface: &Surface,
        material: &MaterialPoint,
        sampler: &mut Sampler,
    ) -> Radiance {
        let color = match *self {
            Self::Path { max_depth, search } => {
                let limits = path::Limits { max_depth, search };
                return path::shade(stage, tracer, ray, surface, material, sampler, limits);
            }
            Self::Whitted { max_depth } => {
                return whitted::shade(stage, tracer, ray, surface, material, sampler, max_depth);
            }
            Self::Direct => direct::shade(stage, tracer, ray, surface, material, sampler),
            Self::Ao { distance } => ambient::shade(stage, tracer, ray, surface, distance, sampler),
            Self::Normals => geometry::normals(surface),
            Self::Facing => geometry::facing(ray, surface),
            Self::Albedo => material.base_color,
            Self::Uv => plain::uv(surface),
            Self::Id => plain::id(surface),
            Self::Cost => plain::cost(stage, ray),
            Self::Fragment => partition::fragment(stage, ray, surface),
            Self::BspDepth => partition::depth(stage, ray, surface),
        };
        Radiance::plain(color, surface.shading_normal, material)
    }

    fn backdrop(&self, stage: &Stage, ray: &Ray) -> Vec3 {
        match self {
            Self::Cost => plain::cost(stage, ray),
            _ if self.computes_light() => stage.backdrop(ray.direction.normalize_or(Vec3::Y)),
            _ if stage.hides_environment => Vec3::ZERO,
            _ => BACKDROP,
        }
    }
}

/// The first surface along a ray that is there at all: its alpha is not zero. The ray is left as the one that met it.
pub(super) fn first_visible(
    stage: &Stage,
    tracer: &mut Tracer,
    ray: &mut Ray,
    cone: RayCone,
    kind: RayKind,
) -> Option<(Surface, MaterialPoint)> {
    for _ in 0..MOST_LAYERS {
        let hit = tracer.closest(ray, kind)?;
        let surface = Surface::seen(stage, &mut tracer.facets, ray, hit, cone);
        let material = surface.material_point(stage);
        if material.alpha > 0.0 {
            return Some((surface, material));
        }
        *ray = ray.behind(hit.t, (hit.instance, hit.triangle));
    }
    None
}

/// The share of light that arrives along a shadow ray: 0 behind an opaque surface.
fn visibility(stage: &Stage, tracer: &mut Tracer, ray: Ray, kind: RayKind) -> f32 {
    if !stage.has_alpha {
        return f32::from(u8::from(!tracer.any(&ray, kind)));
    }
    let mut ray = ray;
    let mut visibility = 1.0;
    for _ in 0..MOST_LAYERS {
        let Some(hit) = tracer.closest(&ray, kind) else {
            return visibility;
        };
        visibility *= 1.0 - Surface::at(stage, &ray, hit).alpha(stage);
        if visibility < NEARLY_OPAQUE {
            return 0.0;
        }
        ray = ray.behind(hit.t, (hit.instance, hit.triangle));
    }
    0.0
}
