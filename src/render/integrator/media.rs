//! The media that a path is in: glass within glass, and what they take from the light.

use glam::Vec3;

use crate::scene::Material;

/// Media that can lie within one another; a path that enters more forgets the outermost.
const MOST: usize = 4;

/// A medium.
#[derive(Clone, Copy, Debug)]
struct Medium {
    /// Index of the scene's material.
    material: u32,
    ior: f32,
    /// Share of the light lost, per model unit, by colour.
    absorption: Vec3,
}

/// The media, the one in which the path is on top. Where media overlap, the one that was entered last counts, so that a liquid may reach a
/// little into the wall of its glass.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Media {
    stack: [Option<Medium>; MOST],
}

impl Media {
    /// The index of refraction behind a surface over that before it. `is_front`: whether the path comes from outside.
    pub(super) fn eta(&self, material: &Material, index: u32, is_front: bool) -> f32 {
        let here = self.stack[0].map_or(1.0, |m| m.ior);
        if is_front {
            return material.ior / here;
        }
        match self.without(index) {
            Some(rest) => rest.stack[0].map_or(1.0, |m| m.ior) / here,
            // The path began inside.
            None => 1.0 / material.ior,
        }
    }

    /// The media behind the surface.
    pub(super) fn behind(&self, material: &Material, index: u32, is_front: bool) -> Self {
        if !is_front {
            return self.without(index).unwrap_or(*self);
        }
        let mut media = *self;
        media.stack.rotate_right(1);
        media.stack[0] = Some(Medium {
            material: index,
            ior: material.ior,
            absorption: material.volume.map_or(Vec3::ZERO, |v| {
                let lost = v.attenuation_color.max(LEAST_COLOR);
                let lost = Vec3::from_array(lost.to_array().map(|c| -libm::logf(c)));
                lost / v.attenuation_distance
            }),
        });
        media
    }

    /// The share of light that is left after a distance, in model units.
    pub(super) fn transmittance(&self, distance: f32) -> Vec3 {
        match self.stack[0] {
            Some(m) if m.absorption != Vec3::ZERO => {
                let lost = m.absorption * distance;
                Vec3::from_array(lost.to_array().map(|x| libm::expf(-x)))
            }
            _ => Vec3::ONE,
        }
    }

    fn without(&self, index: u32) -> Option<Self> {
        let is_it = |m: &Option<Medium>| m.is_some_and(|m| m.material == index);
        let place = self.stack.iter().position(is_it)?;
        let mut media = *self;
        media.stack[place..].rotate_left(1);
        media.stack[MOST - 1] = None;
        Some(media)
    }
}

/// Black glass: what is left after the attenuation distance is less than any picture shows, and has a logarithm.
const LEAST_COLOR: Vec3 = Vec3::splat(1e-6);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Volume;

    fn medium(ior: f32, color: Vec3) -> Material {
        Material {
            ior,
            volume: Some(Volume {
                thickness: 1.0,
                thickness_texture: None,
                attenuation_distance: 2.0,
                attenuation_color: color,
            }),
            ..Material::default()
        }
    }

    #[test]
    fn light_has_the_attenuation_colour_after_the_attenuation_distance() {
        let color = Vec3::new(0.25, 0.5, 1.0);
        let media = Media::default().behind(&medium(1.5, color), 3, true);
        assert!((media.transmittance(2.0) - color).abs().max_element() < 1e-6);
        let further = media.transmittance(4.0);
        assert!((further - color * color).abs().max_element() < 1e-6);
        assert_eq!(Media::default().transmittance(9.0), Vec3::ONE);
    }

    #[test]
    fn a_liquid_in_a_glass_that_it_reaches_into_meets_no_air() {
        let (glass, water) = (medium(1.5, Vec3::ONE), medium(1.25, Vec3::ONE));
        let air = Media::default();
        assert_eq!(air.eta(&glass, 0, true), 1.5);
        let in_glass = air.behind(&glass, 0, true);
        // Into the liquid while still in the wall, then out of the wall: no change there.
        assert_eq!(in_glass.eta(&water, 1, true), 1.25 / 1.5);
        let in_both = in_glass.behind(&water, 1, true);
        assert_eq!(in_both.eta(&glass, 0, false), 1.0);
        let in_water = in_both.behind(&glass, 0, false);
        assert_eq!(in_water.eta(&water, 1, false), 1.0 / 1.25);
        assert_eq!(
            in_water.behind(&water, 1, false).transmittance(1.0),
            Vec3::ONE
        );
    }

    #[test]
    fn an_eye_within_glass_leaves_it_into_air() {
        assert_eq!(
            Media::default().eta(&medium(1.5, Vec3::ONE), 0, false),
            1.0 / 1.5
        );
    }
}
