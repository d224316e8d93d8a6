//! How a surface scatters light: glTF's metallic-roughness model with the lobes of its extensions, layered so that no light is made.
//!
//! From the top: a clear coat, sheen, and a base that mixes metal, a dielectric over a matt ground, light that passes a thin wall, and
//! the interface of a solid medium. A layer leaves to those below what its albedo towards the viewer does not reflect: energy
//! is conserved exactly, reciprocity between two layers only nearly, as in other renderers that do so.
//!
//! Directions are unit vectors in world space that point away from the surface. A value is the BSDF times the absolute cosine between
//! the light and the shading normal; densities are per steradian.

mod charlie;
mod energy;
mod frame;
mod fresnel;
mod ggx;
mod glass;
mod layers;
mod matt;
mod mirrored;
mod mirrors;
mod scatter;
mod scattering;

use glam::Vec3;

pub use energy::GlassEnergy;
pub use layers::Bsdf;
pub use matt::Matt;
pub use mirrored::Mirrored;
pub use scattering::Scattering;

/// A solid medium behind a surface.
#[derive(Clone, Copy, Debug)]
pub struct Solid<'a> {
    /// Index of refraction behind the surface over the one before it, seen from the viewer.
    pub eta: f32,
    /// Whether the viewer is outside.
    pub is_outside: bool,
    /// Of the material's interface.
    pub energy: &'a GlassEnergy,
}

/// What a BSDF is made from: a material's values at one place.
#[derive(Clone, Copy, Debug)]
pub struct Lobes {
    /// Linear colour of the ground, of metal, and of light that passes.
    pub base_color: Vec3,
    /// 0 for dielectrics, 1 for metals.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// What the dielectric reflects straight on.
    pub f0: Vec3,
    /// What the dielectric reflects at grazing angles.
    pub f90: f32,
    /// Share of the dielectric's ground through which light passes.
    pub transmission: f32,
    /// Strength of the clear coat.
    pub coat: f32,
    /// Perceptual roughness of the clear coat.
    pub coat_roughness: f32,
    /// Linear colour of the sheen.
    pub sheen: Vec3,
    /// Perceptual roughness of the sheen.
    pub sheen_roughness: f32,
}

impl Lobes {
    /// A matt surface.
    pub fn matt(base_color: Vec3) -> Self {
        Self {
            base_color,
            metallic: 0.0,
            roughness: 1.0,
            f0: Vec3::ZERO,
            f90: 0.0,
            transmission: 0.0,
            coat: 0.0,
            coat_roughness: 0.0,
            sheen: Vec3::ZERO,
            sheen_roughness: 0.0,
        }
    }

    /// What a dielectric of this index of refraction, in air, reflects straight on.
    pub fn f0_of(ior: f32) -> f32 {
        fresnel::reflectance_at_normal(ior)
    }
}

/// The normals of a surface, of unit length, turned to the viewer.
#[derive(Clone, Copy, Debug)]
pub struct Normals {
    /// Of the triangle.
    pub geometric: Vec3,
    /// That of the base.
    pub shading: Vec3,
    /// That of the clear coat.
    pub coat: Vec3,
}

impl Normals {
    /// The same for all.
    pub fn all(normal: Vec3) -> Self {
        Self {
            geometric: normal,
            shading: normal,
            coat: normal,
        }
    }

    /// Fades out light that grazes the surface but not its shading normal, which else would end in a hard line where the triangle turns
    /// away: Chiang, Li and Burley 2019, "Taming the Shadow Terminator". `cosine` and `side` are those of the light to the shading and the geometric normal.
    fn terminator(&self, cosine: f32, side: f32) -> f32 {
        let turned = self.geometric.dot(self.shading).max(0.0);
        let share = side / (cosine * turned);
        if share >= 1.0 {
            1.0
        } else {
            share + share * share - share * share * share
        }
    }
}

/// A direction in which light may come.
#[derive(Clone, Copy, Debug)]
pub struct Scattered {
    /// To the light.
    pub direction: Vec3,
    /// Value over density.
    pub weight: Vec3,
    /// Density per steradian; infinite for the one direction of a smooth mirror or lens.
    pub density: f32,
    /// What became of the light.
    pub kind: ScatterKind,
}

/// The kind of lobe that a direction was chosen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScatterKind {
    /// Matt or sheen.
    Diffuse,
    /// Mirrors, smooth or rough.
    Reflection,
    /// A passage.
    Refraction,
}

impl Scattered {
    /// Whether the direction is the only one of its lobe, which no light that is looked for can be in.
    pub fn is_only_direction(&self) -> bool {
        self.density == f32::INFINITY
    }
}

/// Cosine below which a direction counts as along the surface: its facets would weigh infinitely much.
const LEAST_COSINE: f32 = 1e-4;
