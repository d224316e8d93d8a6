//! A material's lobes at one place: its factors times its textures, and the normals it is shaded with.

use glam::Vec3;

use super::bsdf::{Bsdf, Lobes, Matt, Normals, Scattering, Solid};
use super::stage::Stage;
use super::surface::{MaterialPoint, Surface};
use super::texture::ColorSpace;

/// Index of refraction that KHR_materials_ior gives to surfaces that reflect everything.
const MIRROR_IOR: f32 = 0.0;

impl Surface {
    /// The material's lobes here.
    pub(super) fn lobes(&self, stage: &Stage, point: &MaterialPoint) -> Lobes {
        let material = self.material(stage);
        let color = |texture| self.texel(stage, texture, ColorSpace::Srgb).truncate();
        let linear = |texture| self.texel(stage, texture, ColorSpace::Linear);
        let surface = linear(material.metallic_roughness_texture);
        let mut f0 = if material.ior == MIRROR_IOR {
            Vec3::ONE
        } else {
            Vec3::splat(Lobes::f0_of(material.ior.max(1.0)))
        };
        let mut f90 = 1.0;
        if let Some(specular) = material.specular {
            f90 = specular.factor * linear(specular.texture).w;
            f0 = (f0 * specular.color * color(specular.color_texture)).min(Vec3::ONE) * f90;
        }
        let transmission = material
            .transmission
            .map_or(0.0, |t| t.factor * linear(t.texture).x);
        let (coat, coat_roughness) = material.clearcoat.map_or((0.0, 0.0), |c| {
            let roughness = c.roughness * linear(c.roughness_texture).y;
            (c.factor * linear(c.texture).x, roughness)
        });
        let (sheen, sheen_roughness) = material.sheen.map_or((Vec3::ZERO, 0.0), |s| {
            let color = s.color * color(s.color_texture);
            (color, s.roughness * linear(s.roughness_texture).w)
        });
        let unit = |x: f32| x.clamp(0.0, 1.0);
        Lobes {
            base_color: point.base_color.clamp(Vec3::ZERO, Vec3::ONE),
            metallic: unit(material.metallic * surface.z),
            roughness: unit(material.roughness * surface.y),
            f0,
            f90,
            transmission: unit(transmission),
            coat: unit(coat),
            coat_roughness: unit(coat_roughness),
            sheen: sheen.clamp(Vec3::ZERO, Vec3::ONE),
            sheen_roughness: unit(sheen_roughness),
        }
    }

    /// The normals with which the surface is shaded for a viewer in direction `view`.
    pub(super) fn normals(&self, stage: &Stage, view: Vec3) -> Normals {
        let bent = |normal| bent(normal, self.geometric_normal, view);
        Normals {
            geometric: self.geometric_normal,
            shading: bent(self.mapped_normal(stage, self.footprint)),
            coat: bent(self.coat_normal(stage, self.footprint)),
        }
    }

    /// How the surface scatters light to a viewer in direction `view`. `eta` is the index of refraction behind it over the one before it,
    /// for materials into which light enters.
    #[inline]
    pub(super) fn scattering<'s>(
        &self,
        stage: &'s Stage,
        point: &MaterialPoint,
        view: Vec3,
        eta: f32,
    ) -> Scattering<'s> {
        if stage.materials[self.material as usize].is_matt {
            let normal = self.mapped_normal(stage, self.footprint);
            let shading = bent(normal, self.geometric_normal, view);
            return Scattering::Matt(Matt {
                normals: Normals {
                    geometric: self.geometric_normal,
                    shading,
                    coat: shading,
                },
                albedo: point.base_color.clamp(Vec3::ZERO, Vec3::ONE),
            });
        }
        Scattering::Layers(self.bsdf_of(stage, &self.lobes(stage, point), view, eta))
    }

    /// The layers of [`Surface::scattering`], of lobes that are known.
    pub(super) fn bsdf_of<'s>(
        &self,
        stage: &'s Stage,
        lobes: &Lobes,
        view: Vec3,
        eta: f32,
    ) -> Bsdf<'s> {
        let energy = stage.glass[self.material as usize].as_deref();
        let solid = energy.map(|energy| Solid {
            eta,
            is_outside: self.is_front,
            energy,
        });
        Bsdf::new(lobes, self.normals(stage, view), view, solid)
    }
}

/// The shading normal, turned towards the viewer as far as it takes for the mirrored view not to point into the surface: without this,
/// mirrors are black along their rims (Keller et al. 2017, "The Iray Light Transport Simulation and Rendering System", A.3).
#[inline]
fn bent(normal: Vec3, geometric: Vec3, view: Vec3) -> Vec3 {
    if normal == geometric {
        return normal;
    }
    let mirrored = normal * (2.0 * normal.dot(view)) - view;
    let height = mirrored.dot(geometric);
    if height >= 0.0 {
        return normal;
    }
    let slope = normal.dot(geometric).max(LEAST_SLOPE);
    let raised = (mirrored - normal * (height / slope)).normalize_or(geometric);
    (view + raised).normalize_or(geometric)
}

/// Least cosine between shading and geometric normal by which is divided: steeper ones raise the mirrored view by less than needed.
const LEAST_SLOPE: f32 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bent_normals_mirror_the_view_out_of_the_surface() {
        for (x, y) in [(0.9, 0.05), (-0.95, 0.02), (0.3, 0.7), (0.0, 0.001)] {
            let view = Vec3::new(x, 0.2, y).normalize();
            for tilt in [-1.2, -0.6, 0.3, 1.4_f32] {
                let normal = Vec3::new(libm::sinf(tilt), 0.0, libm::cosf(tilt));
                if normal.dot(view) <= 0.0 {
                    continue;
                }
                let n = bent(normal, Vec3::Z, view);
                let mirrored = n * (2.0 * n.dot(view)) - view;
                assert!(mirrored.z >= -1e-5, "view {view}, tilt {tilt}: {mirrored}");
                assert!(n.dot(view) > 0.0);
            }
        }
        // Where nothing is wrong, nothing changes.
        let normal = Vec3::new(0.1, 0.0, 1.0).normalize();
        assert_eq!(bent(normal, Vec3::Z, Vec3::Z), normal);
    }
}
