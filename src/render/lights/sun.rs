//! The sun that comes with the sky.

use glam::Vec3;

use super::{Incident, around};
use crate::scene::Sky;

/// A disc, so that its shadows have soft edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sun {
    /// Unit vector to the sun's middle.
    direction: Vec3,
    /// Cosine of the disc's angular radius.
    cos_radius: f32,
    /// Solid angle of the disc, in steradians.
    solid_angle: f32,
    /// Irradiance on a surface across its direction.
    irradiance: Vec3,
}

/// Angular radius of our sun, in degrees: larger than the real one (0.27), so that shadows soften within the size of a model.
const SUN_RADIUS: f64 = 1.5;

impl Sun {
    /// The sun of a sky: high, before the scene, to the left of the usual camera.
    pub(super) fn of(sky: &Sky) -> Self {
        let up = sky.up;
        let front = if up.z.abs() > 0.9 {
            Vec3::NEG_Y
        } else {
            Vec3::Z
        };
        let front = (front - up * front.dot(up)).normalize_or(Vec3::X);
        let right = up.cross(front);
        let half = libm::sin(0.5 * SUN_RADIUS.to_radians());
        Self {
            direction: (front * 0.55 - right * 0.45 + up).normalize(),
            cos_radius: (1.0 - 2.0 * half * half) as f32,
            solid_angle: (std::f64::consts::TAU * 2.0 * half * half) as f32,
            irradiance: Vec3::new(2.10, 1.98, 1.80),
        }
    }

    /// Light from a point of the disc.
    pub(super) fn sample(&self, [u, v]: [f32; 2]) -> Incident {
        let cosine = 1.0 - u * (1.0 - self.cos_radius);
        Incident {
            direction: around(self.direction, cosine, v),
            target: None,
            irradiance: self.irradiance,
            density: 1.0 / self.solid_angle,
        }
    }

    /// Radiance from a direction, a unit vector, and the density with which [`Sun::sample`] chooses it.
    pub(super) fn towards(&self, direction: Vec3) -> Option<(Vec3, f32)> {
        let is_inside = direction.dot(self.direction) >= self.cos_radius;
        is_inside.then(|| (self.irradiance / self.solid_angle, 1.0 / self.solid_angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_disc_is_where_its_samples_are() {
        let sun = Sun::of(&Sky::daylight(Vec3::Y));
        for i in 0..100 {
            let sample = sun.sample([i as f32 / 101.0, (i * 37 % 100) as f32 / 100.0]);
            let (radiance, density) = sun.towards(sample.direction).expect("inside the disc");
            assert_eq!(density, sample.density);
            assert!((radiance / density - sample.irradiance).abs().max_element() < 1e-6);
        }
        assert!(sun.towards(Vec3::NEG_Y).is_none());
    }
}
