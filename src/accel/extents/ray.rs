//! A ray made ready for tests of extents: its direction scaled by a power of two, its interval with it.

use glam::Vec3;

use crate::geometry::Ray;
use crate::geometry::tolerance::{
    EXTENT_DIRECTIONS, EXTENT_FARTHEST, EXTENT_FLOOR, EXTENT_TIME_ERROR,
};

/// A ray for tests of extents, in the space of these.
#[derive(Clone, Copy, Debug)]
pub struct ExtentRay {
    pub(super) origin: Vec3,
    /// The greatest component lies between 1/2 and 1.
    pub(super) direction: Vec3,
    /// Its length squared, and its length.
    pub(super) squared: f32,
    pub(super) length: f32,
    /// Ends of the interval, in units of the scaled direction, moved apart by what rounding may change.
    pub(super) start: f32,
    pub(super) end: f32,
    /// Whether no hit lies before the origin.
    pub(super) is_forward: bool,
    /// One unit of the original direction in units of the scaled one.
    unit: f32,
    /// Whether all numbers are in the range for which the tests are made. Others pass every test.
    pub(super) is_usual: bool,
}

impl ExtentRay {
    /// Prepares a traceable ray.
    pub fn new(ray: &Ray) -> Self {
        let greatest = ray.direction.abs().max_element();
        let is_usual = EXTENT_DIRECTIONS.contains(&greatest)
            && ray.origin.abs().max_element() <= EXTENT_FARTHEST;
        // The power of two above it: of a usual direction, from 2^-79 to 2^81.
        let exponent = if is_usual {
            (greatest.to_bits() >> 23) + 1
        } else {
            127
        };
        let unit = f32::from_bits(exponent << 23);
        let direction = ray.direction * f32::from_bits((254 - exponent) << 23);
        let squared = direction.length_squared();
        let mut prepared = Self {
            origin: ray.origin,
            direction,
            squared,
            length: squared.sqrt(),
            start: moved(ray.interval.min * unit, -1.0),
            end: 0.0,
            is_forward: ray.interval.min >= 0.0,
            unit,
            is_usual,
        };
        prepared.end_at(ray.interval.max);
        prepared
    }

    /// Lets the ray end at `t`, in units of the original direction.
    pub fn end_at(&mut self, t: f32) {
        self.end = moved(t * self.unit, 1.0);
    }
}

/// A time moved outwards by what the rounding of a hit's `t` may change.
fn moved(t: f32, sign: f32) -> f32 {
    t + sign * (EXTENT_TIME_ERROR * t.abs() + 0.0625 * EXTENT_FLOOR)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Interval;

    #[test]
    fn directions_of_all_lengths_come_to_the_same_ray() {
        for exponent in [-79, -30, 0, 30, 79] {
            let scale = libm::exp2f(exponent as f32);
            let ray = Ray::new(Vec3::ONE, Vec3::new(0.6, -0.3, 0.1) * scale)
                .within(Interval::new(0.25 / scale, 8.0 / scale));
            let prepared = ExtentRay::new(&ray);
            assert!(prepared.is_usual && prepared.is_forward);
            assert_eq!(prepared.direction, Vec3::new(0.6, -0.3, 0.1));
            assert!(prepared.start < 0.25 && prepared.start > 0.2499);
            assert!(prepared.end > 8.0 && prepared.end < 8.0001);
        }
    }

    #[test]
    fn rays_of_extreme_lengths_and_places_are_unusual() {
        let usual = |o, d| ExtentRay::new(&Ray::new(o, d)).is_usual;
        assert!(usual(Vec3::splat(-2e18), Vec3::X));
        assert!(!usual(Vec3::new(0.0, 3e18, 0.0), Vec3::X));
        assert!(!usual(Vec3::ZERO, Vec3::X * 1e-25));
        assert!(!usual(Vec3::ZERO, Vec3::X * 2e24));
    }

    #[test]
    fn an_endless_ray_does_not_end() {
        let prepared = ExtentRay::new(&Ray::new(Vec3::ZERO, Vec3::Z * 3.0));
        assert!(prepared.end == f32::INFINITY && prepared.start < 0.0);
    }
}
