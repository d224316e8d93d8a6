//! A rough interface between two media: reflection and refraction by GGX facets (Walter et al. 2007, "Microfacet Models for Refraction
//! through Rough Surfaces"), with what its single bounces lose given back by a table. Local frame, the viewer's side is z > 0.
//!
//! The factor of the squared ratio of the indices by which radiance changes inside is left out: it cancels when the light leaves,
//! and camera and lights are taken to be outside.

use glam::Vec3;

use super::energy::GlassEnergy;
use super::{fresnel, ggx};

/// The interface, seen from one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface<'a> {
    /// Index of refraction behind it over the one before it.
    pub(super) eta: f32,
    /// Perceptual roughness.
    pub(super) roughness: f32,
    pub(super) energy: &'a GlassEnergy,
    /// Whether the viewer is outside, as the tables have it.
    pub(super) is_outside: bool,
}

impl Interface<'_> {
    fn alpha(&self) -> f32 {
        self.roughness * self.roughness
    }

    /// Whether it is a mirror and a lens, without lobes.
    pub(super) fn is_smooth(&self) -> bool {
        self.alpha() < ggx::SMOOTH || (self.eta - 1.0).abs() < 1e-4
    }

    fn compensation(&self, o: Vec3) -> f32 {
        1.0 / self
            .energy
            .kept(o.z, self.roughness, self.is_outside)
            .max(0.1)
    }

    /// Value times cosine of the light, and density per steradian. Refracted light is multiplied by `tint`.
    pub(super) fn evaluate(&self, o: Vec3, i: Vec3, tint: Vec3) -> (Vec3, f32) {
        let alpha = self.alpha();
        if self.is_smooth() || i.z == 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let reflects = i.z > 0.0;
        // The facet that sends the light from i to o, turned to the viewer's side.
        let h = if reflects { o + i } else { o + i * self.eta };
        let h = h.normalize_or(Vec3::Z);
        let h = if h.z < 0.0 { -h } else { h };
        let (o_h, i_h) = (o.dot(h), i.dot(h));
        if o_h <= 0.0 || (i_h > 0.0) != reflects {
            return (Vec3::ZERO, 0.0);
        }
        let (reflected, _) = fresnel::dielectric(o_h, self.eta);
        let density = ggx::visible_density(o, h, alpha);
        let share = ggx::seen_share(i.z, o.z, alpha) * self.compensation(o);
        if reflects {
            let density = density / (4.0 * o_h) * reflected;
            (Vec3::splat(share * density), density)
        } else {
            let root = o_h + self.eta * i_h;
            let jacobian = self.eta * self.eta * i_h.abs() / (root * root);
            let density = density * jacobian * (1.0 - reflected);
            (tint * (share * density), density)
        }
    }

    /// A direction, its value times cosine over density, and whether it is refracted. `choice` decides between the two ways.
    pub(super) fn sample(
        &self,
        o: Vec3,
        choice: f32,
        u: [f32; 2],
        tint: Vec3,
    ) -> Option<(Vec3, Vec3)> {
        let alpha = self.alpha();
        let is_smooth = self.is_smooth();
        let h = if is_smooth {
            Vec3::Z
        } else {
            ggx::visible_normal(o, alpha, u)
        };
        let (reflected, refracted) = fresnel::dielectric(o.dot(h), self.eta);
        let share = |i: Vec3| {
            if is_smooth {
                1.0
            } else {
                ggx::seen_share(i.z, o.z, alpha) * self.compensation(o)
            }
        };
        if choice < reflected {
            let i = h * (2.0 * o.dot(h)) - o;
            (i.z > 0.0).then(|| (i, Vec3::splat(share(i))))
        } else {
            let i = refract(o, h, self.eta, refracted?);
            (i.z < 0.0).then(|| (i, tint * share(i)))
        }
    }
}

/// The direction behind a facet `h` of light that leaves towards `o`.
fn refract(o: Vec3, h: Vec3, eta: f32, cosine: f32) -> Vec3 {
    (h * (o.dot(h) / eta - cosine) - o / eta).normalize()
}

/// What one sampled facet keeps of the light, reflected and refracted.
pub(super) fn kept(o: Vec3, h: Vec3, eta: f32, alpha: f32) -> f32 {
    let (reflected, refracted) = fresnel::dielectric(o.dot(h), eta);
    let there = h * (2.0 * o.dot(h)) - o;
    let mut sum = 0.0;
    if there.z > 0.0 {
        sum += reflected * ggx::seen_share(there.z, o.z, alpha);
    }
    if let Some(cosine) = refracted {
        let behind = refract(o, h, eta, cosine);
        if behind.z < 0.0 {
            sum += (1.0 - reflected) * ggx::seen_share(behind.z, o.z, alpha);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refraction_obeys_snell() {
        let o = Vec3::new(0.6, 0.0, 0.8);
        let (_, cosine) = fresnel::dielectric(o.z, 1.5);
        let i = refract(o, Vec3::Z, 1.5, cosine.expect("into the denser medium"));
        assert!((i - Vec3::new(-0.4, 0.0, -(1.0 - 0.16_f32).sqrt())).length() < 1e-6);
    }
}
