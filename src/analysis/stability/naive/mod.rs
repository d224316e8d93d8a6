//! Methods as textbooks have them, to see what goes wrong: single precision, fixed epsilons, no error bounds. World space, model units.
//! Nothing but a measurement may use them.

mod epsilon_bsp;
mod moller_trumbore;
mod woop;

pub(super) use epsilon_bsp::EpsilonBsp;

use crate::accel::{Hit, world_triangles};
use crate::geometry::{Ray, Triangle};
use crate::scene::Scene;

/// A test of a ray against a triangle: `t` in units of the direction's length, `None` for a miss.
pub(super) type TriangleTest = fn(&Ray, &Triangle) -> Option<f32>;

pub(super) const MOLLER_TRUMBORE: TriangleTest = moller_trumbore::intersect;
pub(super) const WOOP: TriangleTest = woop::intersect;

/// Every triangle, one after the other, with a test of choice.
pub(super) struct Every {
    triangles: Vec<((u32, u32), Triangle)>,
    test: TriangleTest,
}

impl Every {
    pub(super) fn build(scene: &Scene, test: TriangleTest) -> Self {
        Self {
            triangles: world_triangles(scene),
            test,
        }
    }

    /// The nearest hit; of equal ones the first.
    pub(super) fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        if !ray.is_traceable() {
            return None;
        }
        let mut nearest: Option<Hit> = None;
        for ((instance, index), triangle) in &self.triangles {
            if let Some(t) = (self.test)(ray, triangle)
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
    use crate::geometry::exact;
    use glam::Vec3;

    /// Rays well inside and well outside of a triangle, from both sides.
    fn easy(test: TriangleTest) {
        let triangle = Triangle::new(
            Vec3::new(0.1, 0.2, 1.0),
            Vec3::new(3.2, 0.0, 1.3),
            Vec3::new(0.0, 2.1, 0.8),
        );
        let mut hits = 0;
        for i in 0..64_u8 {
            let (x, y) = (
                f32::from(i % 8) * 0.53 - 0.31,
                f32::from(i / 8) * 0.41 - 0.33,
            );
            for (from, way) in [(-2.0, 1.5), (4.0, -0.7)] {
                let ray = Ray::new(Vec3::new(x, y, from), Vec3::new(0.01, -0.02, way));
                let (got, want) = (test(&ray, &triangle), exact::intersect(&ray, &triangle));
                assert_eq!(got.is_some(), want.is_some(), "{ray:?}");
                if let (Some(got), Some(want)) = (got, want) {
                    assert!((got - want).abs() < 1e-5 * want, "{got} {want}");
                    hits += 1;
                }
            }
        }
        assert!(hits > 20, "{hits}");
    }

    #[test]
    fn naive_tests_are_right_about_easy_rays() {
        easy(MOLLER_TRUMBORE);
        easy(WOOP);
    }
}
