//! What a path asks of a surface, whether it has layers or is only matt.

use glam::Vec3;

use super::{Bsdf, Matt, Scattered};
use crate::render::sampler::Sampler;

/// How a place scatters light to one viewer.
#[derive(Clone, Copy, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "it lives on the stack, one at a time"
)]
pub enum Scattering<'a> {
    /// Evenly.
    Matt(Matt),
    /// By the layers of its material.
    Layers(Bsdf<'a>),
}

impl Scattering<'_> {
    /// As [`Bsdf::evaluate`].
    #[inline]
    pub fn evaluate(&self, to_light: Vec3) -> (Vec3, f32) {
        match self {
            Self::Matt(matt) => matt.evaluate(to_light),
            Self::Layers(bsdf) => bsdf.evaluate(to_light),
        }
    }

    /// A direction from which light may come, as [`Bsdf::sample`] has it, with the sampler's next numbers.
    #[inline]
    pub fn sample(&self, sampler: &mut Sampler) -> Option<Scattered> {
        // There is no choice among the lobes of a matt place.
        let choice = sampler.next_1d_if(matches!(self, Self::Layers(_)));
        let numbers = sampler.next_2d();
        match self {
            Self::Matt(matt) => matt.sample(numbers),
            Self::Layers(bsdf) => bsdf.sample(choice, numbers),
        }
    }

    /// As [`Bsdf::is_all_smooth`].
    pub fn is_all_smooth(&self) -> bool {
        match self {
            Self::Matt(matt) => matt.is_black(),
            Self::Layers(bsdf) => bsdf.is_all_smooth(),
        }
    }

    /// As [`Bsdf::shading_normal`].
    pub fn shading_normal(&self) -> Vec3 {
        match self {
            Self::Matt(matt) => matt.normals.shading,
            Self::Layers(bsdf) => bsdf.shading_normal(),
        }
    }

    /// As [`Bsdf::roughness`].
    pub fn roughness(&self) -> f32 {
        match self {
            Self::Matt(_) => 1.0,
            Self::Layers(bsdf) => bsdf.roughness(),
        }
    }

    /// As [`Bsdf::diffuse_albedo`].
    pub fn diffuse_albedo(&self) -> Vec3 {
        match self {
            Self::Matt(matt) => matt.albedo,
            Self::Layers(bsdf) => bsdf.diffuse_albedo(),
        }
    }

    /// As [`Bsdf::specular_albedo`].
    pub fn specular_albedo(&self) -> Vec3 {
        match self {
            Self::Matt(_) => Vec3::ZERO,
            Self::Layers(bsdf) => bsdf.specular_albedo(),
        }
    }
}
