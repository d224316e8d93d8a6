//! A surface that is matt and nothing else (Lambert 1760): what most surfaces of most scenes are, without the layers that they lack. Every number
//! is that of the layers.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::frame::Frame;
use super::{Normals, ScatterKind, Scattered};
use crate::render::lights::around_z;

/// How a matt place scatters light.
#[derive(Clone, Copy, Debug)]
pub struct Matt {
    /// Of which that of the coat does not count.
    pub normals: Normals,
    /// Share of the light that is scattered, by colour.
    pub albedo: Vec3,
}

impl Matt {
    /// As [`Bsdf::evaluate`](super::Bsdf::evaluate).
    pub fn evaluate(&self, to_light: Vec3) -> (Vec3, f32) {
        let cosine = to_light.dot(self.normals.shading);
        let side = to_light.dot(self.normals.geometric);
        let is_lit = cosine > 0.0 && side > 0.0 && !self.is_black();
        if !is_lit {
            return (Vec3::ZERO, 0.0);
        }
        let density = cosine * FRAC_1_PI;
        let value = self.albedo * density * self.normals.terminator(cosine, side);
        (value, density)
    }

    /// As [`Bsdf::sample`](super::Bsdf::sample).
    pub fn sample(&self, u: [f32; 2]) -> Option<Scattered> {
        if self.is_black() {
            return None;
        }
        let frame = Frame::around(self.normals.shading);
        let i = around_z((1.0 - u[0]).sqrt(), u[1]);
        let direction = frame.to_world(i).normalize();
        let (value, density) = self.evaluate(direction);
        let weight = value / density;
        // Densities that overflow belong to directions that rounding alone has met.
        let is_sound = density > 0.0 && density.is_finite() && weight.is_finite();
        is_sound.then_some(Scattered {
            direction,
            weight,
            density,
            kind: ScatterKind::Diffuse,
        })
    }

    /// Whether it scatters no light at all.
    pub fn is_black(&self) -> bool {
        self.albedo.max_element() <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bsdf, Lobes};
    use super::*;

    #[test]
    fn every_number_is_that_of_the_layers() {
        let geometric = Vec3::new(0.2, -0.3, 0.9).normalize();
        let bent = Vec3::new(-0.1, 0.4, 0.8).normalize();
        for (shading, albedo) in [
            (geometric, Vec3::new(0.8, 0.3, 0.1)),
            (bent, Vec3::new(0.0, 0.7, 1.0)),
            (bent, Vec3::ZERO),
        ] {
            let normals = Normals {
                geometric,
                shading,
                coat: shading,
            };
            let matt = Matt { normals, albedo };
            let layers = Bsdf::new(&Lobes::matt(albedo), normals, Vec3::Z, None);
            assert_eq!(matt.is_black(), layers.is_all_smooth());
            let steps = (0..16).flat_map(|i| (0..16).map(move |j| [i, j]));
            for u in steps.map(|u| u.map(|i| (i as f32 + 0.3) / 16.0)) {
                let all = |s: Scattered| (s.direction, s.weight, s.density, s.kind);
                assert_eq!(matt.sample(u).map(all), layers.sample(0.4, u).map(all));
                let [z, turn] = [2.0 * u[0] - 1.0, u[1]];
                let to_light = around_z(z, turn);
                assert_eq!(matt.evaluate(to_light), layers.evaluate(to_light));
            }
        }
    }
}
