//! A sun: light from a disc infinitely far away.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

/// A disc of even radiance on the sky.
#[derive(Clone, Copy, Debug)]
pub(super) struct SunDisc {
    /// Unit vector to the middle.
    direction: Vec3,
    /// 1 less the cosine of the angular radius, which a cosine near 1 has too few bits for.
    height: f32,
    /// Radiance of each of its points.
    radiance: Vec3,
}

/// Towards the studio's sun, in coordinates along right, up and front.
pub(super) const STUDIO_DIRECTION: DVec3 = DVec3::new(-0.45, 1.0, 0.55);

/// Angular radius of the studio's sun, in degrees: larger than the real one (0.27), so that shadows soften within the size of a model.
const STUDIO_RADIUS: f64 = 1.5;

/// Irradiance of the studio's sun on a surface across.
const STUDIO_IRRADIANCE: Vec3 = Vec3::new(2.10, 1.98, 1.80);

impl SunDisc {
    /// The studio's sun.
    pub(super) fn of_studio(direction: Vec3) -> Self {
        Self::new(direction, STUDIO_RADIUS, STUDIO_IRRADIANCE)
    }

    /// The sun in a direction (unit), of an angular radius in degrees, whose irradiance on a surface across is given.
    pub(super) fn new(direction: Vec3, radius: f64, irradiance: Vec3) -> Self {
        let half = libm::sin(radius.to_radians() / 2.0);
        let height = 2.0 * half * half;
        Self {
            direction,
            height: height as f32,
            radiance: irradiance / (2.0 * PI * height) as f32,
        }
    }

    /// Radiance from a direction (unit): 0 beside the disc.
    pub(super) fn radiance(&self, direction: Vec3) -> Vec3 {
        if self.has(direction) {
            self.radiance
        } else {
            Vec3::ZERO
        }
    }

    /// Irradiance on a surface across the direction to the sun.
    pub(super) fn irradiance(&self) -> Vec3 {
        self.radiance * self.solid_angle()
    }

    /// A direction to a point of the disc, evenly chosen with the numbers given.
    pub(super) fn sample(&self, [u, v]: [f32; 2]) -> Vec3 {
        let (tangent, bitangent) = self.direction.any_orthonormal_pair();
        let height = u * self.height;
        let sine = (height * (2.0 - height)).sqrt();
        let (s, c) = libm::sincosf(v * std::f32::consts::TAU);
        let across = tangent * (sine * c) + bitangent * (sine * s);
        (self.direction * (1.0 - height) + across).normalize()
    }

    /// The density with which a direction is chosen, per steradian.
    pub(super) fn density(&self, direction: Vec3) -> f32 {
        if self.has(direction) {
            1.0 / self.solid_angle()
        } else {
            0.0
        }
    }

    fn solid_angle(&self) -> f32 {
        std::f32::consts::TAU * self.height
    }

    /// By the chord, whose square is twice the height: a cosine near 1 is too coarse.
    fn has(&self, direction: Vec3) -> bool {
        (direction - self.direction).length_squared() <= 2.0 * self.height
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_discs_light_is_the_irradiance_asked_for() {
        let direction = Vec3::new(1.0, 2.0, -0.5).normalize();
        let sun = SunDisc::new(direction, 0.2665, Vec3::new(3.0, 2.0, 1.0));
        let n = 40;
        let mut sum = Vec3::ZERO;
        let mut inside = 0;
        for i in 0..n * n {
            let numbers = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
            let d = sun.sample(numbers);
            let angle = f64::from((d - direction).length()).to_degrees();
            assert!(angle < 0.2667, "{angle}");
            if sun.density(d) > 0.0 {
                sum += sun.radiance(d) * d.dot(direction) / sun.density(d);
                inside += 1;
            }
        }
        let found = sum / inside as f32;
        assert!(
            (found - Vec3::new(3.0, 2.0, 1.0)).length() < 1e-3,
            "{found}"
        );
        assert!(inside as f32 > 0.999 * (n * n) as f32, "{inside}");
        assert!((sun.irradiance().x - 3.0).abs() < 1e-5);
        assert_eq!(sun.radiance(-direction), Vec3::ZERO);
    }
}
