//! The light that a surface scatters: its value for a direction, and the choice of one.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::Vec3;

use super::frame::Frame;
use super::layers::{BASE, Bsdf, COAT, DIFFUSE, LOBES, SHEEN, SOLID, THIN};
use super::mirrors::Mirrors;
use super::{ScatterKind, Scattered, charlie};
use crate::render::lights::around_z;

impl Bsdf<'_> {
    /// The value for light from a direction, and the density with which [`Bsdf::sample`] chooses it. Smooth mirrors and lenses count
    /// for nothing: no light that is looked for is in their one direction.
    pub fn evaluate(&self, to_light: Vec3) -> (Vec3, f32) {
        let i = self.frame.to_local(to_light);
        let side = to_light.dot(self.normals.geometric);
        // A shading normal may see light that the surface itself cannot, and the other way: neither counts.
        if i.z * side <= 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let chances = &self.chances;
        let mut value = Vec3::ZERO;
        let mut density = 0.0;
        if i.z > 0.0 {
            value += self.diffuse * (i.z * FRAC_1_PI);
            density += chances[DIFFUSE] * i.z * FRAC_1_PI;
            if chances[SHEEN] > 0.0 {
                let lobe = charlie::value(self.o, i, self.sheen_roughness);
                value += self.sheen * (lobe * i.z);
                density += chances[SHEEN] / TAU;
            }
            // Matt light alone, as in Cycles: mirrors have no terminator, and would only lose light.
            value *= self.normals.terminator(i.z, side);
            let mut add = |mirrors: &Mirrors, i: Vec3, chance: f32| {
                let (white, lobe, cosine) = mirrors.white(i);
                value += mirrors.reflectance(cosine) * white;
                density += chance * lobe;
            };
            if chances[BASE] > 0.0 {
                add(&self.base, i, chances[BASE]);
            }
            if let Some(coat) = &self.coat {
                add(coat, coat.frame.to_local(to_light), chances[COAT]);
            }
        } else if chances[THIN] > 0.0 {
            let (white, lobe, _) = self.base.white(i.with_z(-i.z));
            value += self.thin * white;
            density += chances[THIN] * lobe;
        }
        if let Some(solid) = self.solid.filter(|_| chances[SOLID] > 0.0) {
            let (lobe, of_lobe) = solid.evaluate(self.o, i, self.solid_tint);
            value += lobe * self.solid_share;
            density += chances[SOLID] * of_lobe;
        }
        (value, density)
    }

    /// A direction from which light may come, with a density close to the value's. `None` where nothing is scattered, or the chosen lobe
    /// points into the surface.
    pub fn sample(&self, choice: f32, u: [f32; 2]) -> Option<Scattered> {
        let (lobe, rest) = self.choose(choice)?;
        let chance = self.chances[lobe];
        let mirrored = |mirrors: &Mirrors| {
            let h = mirrors.facet(u);
            h * (2.0 * mirrors.o.dot(h)) - mirrors.o
        };
        let only = |frame: &Frame, i: Vec3, weight: Vec3, kind| Scattered {
            direction: frame.to_world(i).normalize(),
            weight: weight / chance,
            density: f32::INFINITY,
            kind,
        };
        let (i, frame, kind) = match lobe {
            DIFFUSE => {
                let i = around_z((1.0 - u[0]).sqrt(), u[1]);
                (i, &self.frame, ScatterKind::Diffuse)
            }
            SHEEN => (around_z(u[0], u[1]), &self.frame, ScatterKind::Diffuse),
            BASE | COAT => {
                let mirrors = match &self.coat {
                    Some(coat) if lobe == COAT => coat,
                    _ => &self.base,
                };
                let i = mirrored(mirrors);
                if mirrors.is_smooth() {
                    let weight = mirrors.reflectance(mirrors.o.z);
                    let scattered = only(&mirrors.frame, i, weight, ScatterKind::Reflection);
                    return self.on_its_side(scattered);
                }
                (i, &mirrors.frame, ScatterKind::Reflection)
            }
            THIN => {
                if self.base.is_smooth() {
                    return Some(Scattered {
                        direction: -self.view,
                        weight: self.thin / chance,
                        density: f32::INFINITY,
                        kind: ScatterKind::Refraction,
                    });
                }
                // What passes is the mirrors' light, turned to the far side.
                let i = mirrored(&self.base);
                (i.with_z(-i.z), &self.frame, ScatterKind::Refraction)
            }
            _ => {
                let solid = self.solid.as_ref()?;
                let (i, weight) = solid.sample(self.o, rest, u, self.solid_tint)?;
                let kind = if i.z > 0.0 {
                    ScatterKind::Reflection
                } else {
                    ScatterKind::Refraction
                };
                if solid.is_smooth() {
                    let scattered = only(&self.frame, i, weight * self.solid_share, kind);
                    return self.on_its_side(scattered);
                }
                (i, &self.frame, kind)
            }
        };
        // A facet may send light into the surface; there, and where the coat's normal or a bent one differs from that of the base, the
        // direction would be taken for one of another lobe.
        let scatters_back = kind != ScatterKind::Refraction;
        let direction = frame.to_world(i).normalize();
        let back = |normal: Vec3| (direction.dot(normal) > 0.0) == scatters_back;
        if !back(self.normals.geometric) || !back(self.normals.shading) {
            return None;
        }
        let (value, density) = self.evaluate(direction);
        let weight = value / density;
        // Densities that overflow belong to directions that rounding alone has met.
        let is_sound = density > 0.0 && density.is_finite() && weight.is_finite();
        is_sound.then_some(Scattered {
            direction,
            weight,
            density,
            kind,
        })
    }

    /// Whether all its light goes in single directions, so that looking for lights is vain.
    pub fn is_all_smooth(&self) -> bool {
        let is_smooth = |lobe: usize| match lobe {
            COAT => self.coat.is_none_or(|coat| coat.is_smooth()),
            BASE | THIN => self.base.is_smooth(),
            SOLID => self.solid.is_none_or(|solid| solid.is_smooth()),
            _ => false,
        };
        (0..LOBES).all(|lobe| self.chances[lobe] <= 0.0 || is_smooth(lobe))
    }

    /// A lobe, and the number that is left of the choice, uniform again.
    fn choose(&self, choice: f32) -> Option<(usize, f32)> {
        let mut before = 0.0;
        let mut chosen = None;
        for (lobe, &chance) in self.chances.iter().enumerate().filter(|(_, c)| **c > 0.0) {
            let rest = (choice - before) / chance;
            chosen = Some((lobe, rest.clamp(0.0, ONE_BELOW)));
            before += chance;
            if choice < before {
                break;
            }
        }
        chosen
    }

    /// A direction of a smooth mirror or lens, unless a bent shading normal sends it to the wrong side of the surface.
    fn on_its_side(&self, scattered: Scattered) -> Option<Scattered> {
        let side = scattered.direction.dot(self.normals.geometric);
        let is_right = (side > 0.0) == (scattered.kind == ScatterKind::Reflection);
        is_right.then_some(scattered)
    }
}

/// The largest number below 1.
const ONE_BELOW: f32 = 1.0 - f32::EPSILON / 2.0;
