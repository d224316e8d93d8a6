//! Methods as textbooks have them, to see what goes wrong: single precision, fixed epsilons, no error bounds. World space, model units.
//! Nothing but a measurement may use them.

mod epsilon_bsp;

pub(super) use epsilon_bsp::EpsilonBsp;

use crate::accel::{Hit, world_triangles};
use crate::geometry::tolerance::NAIVE_DETERMINANT;
use crate::geometry::{Ray, Triangle, moller_trumbore};
use crate::scene::Scene;

/// Moller and Trumbore's test with the epsilon of its listing.
pub(super) fn textbook_test(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    moller_trumbore(ray, triangle, NAIVE_DETERMINANT)
}

/// Every triangle, one after the other, by the textbook's test.
pub(super) struct Every(Vec<((u32, u32), Triangle)>);

impl Every {
    pub(super) fn build(scene: &Scene) -> Self {
        Self(world_triangles(scene))
    }

    /// The nearest hit; of equal ones the first.
    pub(super) fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        if !ray.is_traceable() {
            return None;
        }
        let mut nearest: Option<Hit> = None;
        for ((instance, index), triangle) in &self.0 {
            if let Some(t) = textbook_test(ray, triangle)
                && nearest.is_none_or(|hit| t < hit.t)
            {
                nearest = Some(Hit {
                    t,
                    instance: *instance,
                    triangle: *index,
                });
            }
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn the_textbook_misses_what_is_small_in_its_unit() {
        let triangle = |size| Triangle::new(Vec3::ZERO, Vec3::X * size, Vec3::Y * size);
        let at = |size: f32| {
            let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0 / size) * size, Vec3::NEG_Z);
            textbook_test(&ray, &triangle(size))
        };
        assert_eq!(
            (at(1.0), at(0.01), at(0.0009)),
            (Some(1.0), Some(1.0), None)
        );
    }
}
