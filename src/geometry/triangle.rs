//! Triangles: their corners, and what follows from these alone. Model units; counter-clockwise corners face the reader.
//!
//! The test of a ray against a triangle is [`RayFrame`](super::RayFrame).

use glam::Vec3;

use super::exact::{self, filter};
use super::tolerance::NORMAL_TRUST;
use super::{Aabb, Ray};

/// A triangle, given by its corners.
///
/// ```
/// use bspray::geometry::Triangle;
/// use glam::Vec3;
/// let triangle = Triangle::new(Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0));
/// assert_eq!(triangle.area(), 3.0);
/// assert_eq!(triangle.normal(), Some(Vec3::Z));
/// assert!(!triangle.is_degenerate());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    corners: [Vec3; 3],
}

impl Triangle {
    /// The triangle with these corners.
    #[inline]
    pub const fn new(a: Vec3, b: Vec3, c: Vec3) -> Self {
        Self { corners: [a, b, c] }
    }

    /// The corners, in the order given.
    #[inline]
    pub const fn corners(&self) -> &[Vec3; 3] {
        &self.corners
    }

    /// Whether the corners lie on one line (or in one point), decided without rounding. A triangle with a coordinate
    /// that is not finite counts as degenerate.
    pub fn is_degenerate(&self) -> bool {
        !filter::spans_plane(self) && exact::is_degenerate(self)
    }

    /// The unit normal on the side from which the corners run counter-clockwise; `None` exactly if the triangle is
    /// degenerate.
    ///
    /// Computed in `f64`, and in integers for slivers, where `f64` would not do; each component is within one ulp of 1
    /// (2^-23) of the true one.
    pub fn normal(&self) -> Option<Vec3> {
        let (normal, permanent) = filter::normal(self);
        if normal.abs().max_element() > NORMAL_TRUST * permanent.max_element() {
            Some(normal.normalize().as_vec3())
        } else {
            exact::normal(self).map(|normal| normal.as_vec3())
        }
    }

    /// Area in square units, computed in `f64` and rounded; infinite where `f32` ends (coordinates above 1e19).
    pub fn area(&self) -> f32 {
        let (normal, _) = filter::normal(self);
        (0.5 * normal.length()) as f32
    }

    /// The smallest box that holds the triangle.
    pub fn bounds(&self) -> Aabb {
        self.corners.into_iter().collect()
    }

    /// Barycentric coordinates of the point where the ray's line meets the triangle.
    ///
    /// Computed from the edge functions in `f64` and rounded. For a line that meets the triangle the error is at most
    /// 2^-23 + 2^-48 `P / |n . d|`, where `P` is the sum of the absolute values of all products in the three edge
    /// functions: about the greater of the single precision's rounding and 2^-48 times the distance over the
    /// triangle's height as the ray sees it. The answer always lies in the triangle, and is its centroid where nothing
    /// better is known (a line within the triangle's plane, a degenerate triangle). For a line that misses, it is some
    /// point of the triangle.
    #[allow(
        clippy::float_cmp,
        reason = "the sum is tested against the one divisor that has no quotient"
    )]
    pub fn barycentric(&self, ray: &Ray) -> Barycentric {
        let [of_a, of_b, of_c] =
            exact::edges(self).map(|(from, to)| filter::edge_function(ray, from, to).0);
        let sum = of_a + of_b + of_c;
        if sum == 0.0 || !sum.is_finite() {
            return Barycentric {
                u: 1.0 / 3.0,
                v: 1.0 / 3.0,
            };
        }
        let u = ((of_b / sum) as f32).clamp(0.0, 1.0);
        let v = ((of_c / sum) as f32).clamp(0.0, 1.0 - u);
        Barycentric { u, v }
    }
}

/// Where in a triangle a point lies: `(1 - u - v) a + u b + v c`.
///
/// From [`Triangle::barycentric`], neither `u` nor `v` nor `1 - u - v` is negative.
///
/// ```
/// use bspray::geometry::{Barycentric, Ray, Triangle};
/// use glam::Vec3;
/// let triangle = Triangle::new(Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0));
/// let ray = Ray::new(Vec3::new(1.0, 1.0, 9.0), Vec3::NEG_Z);
/// assert_eq!(triangle.barycentric(&ray), Barycentric { u: 0.25, v: 0.5 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barycentric {
    /// Weight of the second corner.
    pub u: f32,
    /// Weight of the third corner.
    pub v: f32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn sample() -> Triangle {
        Triangle::new(
            Vec3::new(1.0, 2.0, 3.0),
            Vec3::new(4.0, 2.0, 3.0),
            Vec3::new(1.0, 7.0, 5.0),
        )
    }

    #[test]
    fn measures_of_a_triangle_with_three_different_edges() {
        let t = sample();
        assert_eq!(t.area(), 0.5 * 3.0 * 29.0_f32.sqrt());
        let normal = DVec3::new(0.0, -2.0, 5.0).normalize().as_vec3();
        assert_eq!(t.normal(), Some(normal));
        assert_eq!(t.bounds().min, Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(t.bounds().max, Vec3::new(4.0, 7.0, 5.0));
    }

    #[test]
    fn degeneracy_is_a_matter_of_the_last_bit() {
        let [a, b] = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.1, 1.2, 1.3)];
        assert!(Triangle::new(a, b, a).is_degenerate());
        assert!(Triangle::new(a, a, a).is_degenerate());
        let third = Vec3::splat(3.0);
        assert!(Triangle::new(Vec3::ZERO, Vec3::splat(0.1), third).is_degenerate());
        let beside = third.with_y(third.y.next_up());
        let sliver = Triangle::new(Vec3::ZERO, Vec3::splat(0.1), beside);
        assert!(!sliver.is_degenerate() && sliver.normal().is_some());
        // Twenty-five digits apart: f64 sees three corners on a line.
        let far = Vec3::new(1e18, 1e18, 0.0);
        let bent = Triangle::new(-far, Vec3::new(1.0, 1.0_f32.next_up(), 0.0), far);
        assert_eq!(filter::normal(&bent).0, DVec3::ZERO);
        assert!(!bent.is_degenerate());
        assert_eq!(bent.normal(), Some(Vec3::NEG_Z));
        // And the other way round: f64 sees area where there is none.
        let step = Vec3::new(3.0, 5.0, 7.0);
        let [high, low] = [(1u64 << 56) as f32, -((1u64 << 55) as f32)];
        let straight = Triangle::new(step * high, step * 16.0, step * low);
        assert_ne!(filter::normal(&straight).0, DVec3::ZERO);
        assert!(straight.is_degenerate() && straight.normal().is_none());
        assert!(Triangle::new(Vec3::NAN, a, b).is_degenerate());
    }

    #[test]
    fn what_has_no_meeting_point_gets_the_centroid() {
        let third = Barycentric {
            u: 1.0 / 3.0,
            v: 1.0 / 3.0,
        };
        let parallel = Ray::new(Vec3::ZERO, Vec3::X);
        assert_eq!(sample().barycentric(&parallel), third);
        let broken = Ray::new(Vec3::NAN, Vec3::X);
        assert_eq!(sample().barycentric(&broken), third);
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            cases: 2_000,
            rng_seed: RngSeed::Fixed(1_997),
            ..ProptestConfig::default()
        })]

        #[test]
        fn barycentric_coordinates_give_the_point_back(
            u in 0.0..1.0f64, v in 0.0..1.0f64,
            origin in prop::array::uniform3(-100.0..100.0f32),
        ) {
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let [a, b, c] = sample().corners().map(|p| p.as_dvec3());
            let aim = (1.0 - u - v) * a + u * b + v * c;
            let origin = Vec3::from_array(origin);
            let ray = Ray::new(origin, (aim - origin.as_dvec3()).as_vec3());
            // The aim is only as good as the direction's rounding, which a grazing ray magnifies.
            let length = ray.direction.length();
            let grazing = ray.direction.dot(sample().normal().unwrap()).abs() / length;
            prop_assume!(grazing > 0.01);
            let tolerance = 4e-7 * f64::from(length) / f64::from(grazing);
            let found = sample().barycentric(&ray);
            prop_assert!((f64::from(found.u) - u).abs() < tolerance);
            prop_assert!((f64::from(found.v) - v).abs() < tolerance);
        }

        #[test]
        fn barycentric_coordinates_never_leave_the_triangle(
            p in prop::array::uniform32(prop::num::f32::ANY),
        ) {
            let v = |i: usize| Vec3::new(p[i], p[i + 1], p[i + 2]);
            let triangle = Triangle::new(v(0), v(3), v(6));
            let found = triangle.barycentric(&Ray::new(v(9), v(12)));
            prop_assert!(found.u >= 0.0 && found.v >= 0.0);
            prop_assert!(found.u + found.v <= 1.0 && 1.0 - found.u - found.v >= 0.0);
        }

        #[test]
        fn the_filter_and_the_integers_agree_about_degeneracy(
            p in prop::array::uniform9(prop_oneof![
                (-3i8..=3).prop_map(f32::from),
                (-3i8..=3).prop_map(|x| f32::from(x) * 0.1),
                (-3i8..=3).prop_map(|x| (f32::from(x) * 0.1).next_up()),
            ]),
        ) {
            let v = |i: usize| Vec3::new(p[i], p[i + 1], p[i + 2]);
            let triangle = Triangle::new(v(0), v(3), v(6));
            prop_assert_eq!(triangle.is_degenerate(), exact::is_degenerate(&triangle));
            prop_assert_eq!(triangle.normal().is_none(), triangle.is_degenerate());
            if let (Some(fast), Some(truth)) = (triangle.normal(), exact::normal(&triangle)) {
                prop_assert!((fast.as_dvec3() - truth).abs().max_element() <= f64::from(f32::EPSILON));
            }
        }
    }
}
