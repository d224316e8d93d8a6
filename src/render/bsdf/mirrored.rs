//! What a surface would show if its rough mirrors were smooth: the mirror and refraction rays of Whitted's ray tracing.

use glam::Vec3;

use super::fresnel;
use super::layers::Bsdf;

/// The directions of a smooth surface, and the shares of light that come from them.
#[derive(Clone, Copy, Debug)]
pub struct Mirrored {
    /// To what the base mirrors.
    pub reflection: Vec3,
    /// Of the light from there, what the base's rough mirrors send on.
    pub base: Vec3,
    /// The same of the clear coat and the interface of solid glass.
    pub clear: Vec3,
    /// To what is seen through the surface.
    pub refraction: Option<(Vec3, Vec3)>,
}

impl Bsdf<'_> {
    /// The directions of its mirrors and lenses, roughness left aside.
    pub fn mirrored(&self) -> Mirrored {
        let normal = self.normals.shading;
        let cosine = self.o.z;
        let mut clear = self.coat_albedo;
        let mut refraction = None;
        if let Some(solid) = self.solid {
            let (reflected, refracted) = fresnel::dielectric(cosine, solid.eta);
            clear += Vec3::splat(reflected * self.solid_share);
            refraction = refracted.map(|behind| {
                let along = normal * (cosine / solid.eta - behind) - self.view / solid.eta;
                let share = self.solid_tint * ((1.0 - reflected) * self.solid_share);
                (along.normalize(), share)
            });
        } else if self.thin_albedo != Vec3::ZERO {
            refraction = Some((-self.view, self.thin_albedo));
        }
        let reflection = normal * (2.0 * normal.dot(self.view)) - self.view;
        Mirrored {
            reflection: reflection.normalize(),
            base: self.mirror_albedo - self.coat_albedo,
            clear,
            refraction,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{GlassEnergy, Lobes, Normals, Solid};
    use super::*;

    #[test]
    fn glass_shows_all_of_what_is_before_and_behind_it() {
        let energy = GlassEnergy::new(1.5);
        let solid = Solid {
            eta: 1.5,
            is_outside: true,
            energy: &energy,
        };
        let lobes = Lobes {
            transmission: 1.0,
            f0: Vec3::splat(0.04),
            f90: 1.0,
            roughness: 0.0,
            ..Lobes::matt(Vec3::ONE)
        };
        let view = Vec3::new(0.6, 0.8, 0.0);
        let bsdf = Bsdf::new(&lobes, Normals::all(Vec3::Y), view, Some(solid));
        let mirrored = bsdf.mirrored();
        let share = mirrored.base + mirrored.clear;
        assert!((mirrored.reflection - Vec3::new(-0.6, 0.8, 0.0)).length() < 1e-6);
        let (through, passed) = mirrored.refraction.expect("glass is seen through");
        // Snell: the sine of 0.6 becomes 0.4.
        assert!((through - Vec3::new(-0.4, -(0.84_f32.sqrt()), 0.0)).length() < 1e-6);
        assert!((share + passed - Vec3::ONE).abs().max_element() < 1e-6);
    }
}
