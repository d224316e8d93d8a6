//! A triangle made ready for many rays that are known to meet it. Model units.

use glam::{DVec3, Vec3};

use super::exact::filter;
use super::tolerance::NORMAL_TRUST;
use super::{Barycentric, Ray, Triangle};

/// A triangle with what all rays that meet it need to know, in double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    triangle: Triangle,
    /// Its unit normal, as [`Triangle::normal`] has it.
    pub(crate) normal: Option<Vec3>,
    start: DVec3,
    /// From the first corner to the second and the third.
    edges: [DVec3; 2],
    /// Twice the area along the normal; `None` for slivers, where double precision does not know it.
    area: Option<DVec3>,
}

impl Facet {
    pub(crate) fn new(triangle: Triangle) -> Self {
        let [a, b, c] = triangle.corners().map(|p| p.as_dvec3());
        let (area, permanent) = filter::normal(&triangle);
        let is_known = area.abs().max_element() > NORMAL_TRUST * permanent.max_element();
        Self {
            triangle,
            normal: triangle.normal(),
            start: a,
            edges: [b - a, c - a],
            area: is_known.then_some(area),
        }
    }

    /// As [`Triangle::barycentric`], of which it keeps the promises.
    ///
    /// The three edge functions are `-n . d` in all, with a normal of which the error is bounded as theirs are; that of the edges
    /// at the first corner have a product of the ray in common (Moeller and Trumbore 1997).
    #[allow(
        clippy::float_cmp,
        reason = "the sum is tested against the one divisor that has no quotient"
    )]
    #[inline]
    pub(crate) fn barycentric(&self, ray: &Ray) -> Barycentric {
        let Some(area) = self.area else {
            return self.triangle.barycentric(ray);
        };
        let direction = ray.direction.as_dvec3();
        let moment = direction.cross(self.start - ray.origin.as_dvec3());
        let sum = -area.dot(direction);
        let inverse = 1.0 / sum;
        if sum == 0.0 || !inverse.is_finite() {
            return self.triangle.barycentric(ray);
        }
        let u = ((self.edges[1].dot(moment) * inverse) as f32).clamp(0.0, 1.0);
        let v = ((-self.edges[0].dot(moment) * inverse) as f32).clamp(0.0, 1.0 - u);
        if u.is_nan() || v.is_nan() {
            return self.triangle.barycentric(ray);
        }
        Barycentric { u, v }
    }

    /// A point of the triangle, rounded once.
    #[inline]
    pub(crate) fn point(&self, at: Barycentric) -> Vec3 {
        let [to_b, to_c] = self.edges;
        (self.start + to_b * f64::from(at.u) + to_c * f64::from(at.v)).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn point() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-3.0_f32..3.0).prop_map(Vec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(29), ..ProptestConfig::default() })]

        #[test]
        fn a_facet_has_the_answers_of_its_triangle(
            (a, b, c) in (point(), point(), point()),
            (u, v) in (0.0_f32..1.0, 0.0_f32..1.0),
            eye in point(),
            distance in prop::sample::select(vec![1e-3_f32, 1.0, 1e4]),
        ) {
            let triangle = Triangle::new(a, b, c);
            let facet = Facet::new(triangle);
            prop_assert_eq!(facet.normal, triangle.normal());
            let Some(normal) = facet.normal else { return Ok(()) };
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let target = a + (b - a) * u + (c - a) * v;
            let ray = Ray::new(target + eye * distance, -eye);
            // Beyond, both know little.
            prop_assume!(normal.dot(eye.normalize_or_zero()).abs() > 1e-3);
            let (own, other) = (facet.barycentric(&ray), triangle.barycentric(&ray));
            prop_assert!((own.u - other.u).abs() <= 2.0 * f32::EPSILON, "{:?} {:?}", own, other);
            prop_assert!((own.v - other.v).abs() <= 2.0 * f32::EPSILON, "{:?} {:?}", own, other);
            prop_assert!(own.u >= 0.0 && own.v >= 0.0 && own.u + own.v <= 1.0);
        }
    }

    #[test]
    fn slivers_and_rays_in_the_plane_have_the_answers_of_the_triangle() {
        let third = Vec3::splat(3.0);
        let slivers = [third, third.with_y(third.y.next_up())];
        for c in slivers.into_iter().chain([Vec3::new(0.0, 2.0, 0.0)]) {
            let triangle = Triangle::new(Vec3::ZERO, Vec3::splat(0.1), c);
            for direction in [Vec3::X, Vec3::new(0.1, 0.1, 0.1), Vec3::new(-0.3, 1.0, 0.2)] {
                let ray = Ray::new(Vec3::splat(0.05) - direction, direction);
                let (own, other) = (
                    Facet::new(triangle).barycentric(&ray),
                    triangle.barycentric(&ray),
                );
                assert!((own.u - other.u).abs() < 1e-6 && (own.v - other.v).abs() < 1e-6);
            }
        }
    }
}
