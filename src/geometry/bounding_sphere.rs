//! Bounding spheres: the lecture's `SphereInfo` ("Implementing Extent Testing (2)").

use glam::Vec3;

/// A sphere given by its centre and its radius, in model units; its surface belongs to it.
///
/// The lecture keeps the square of the radius. We keep the radius, which the conservative test has to enlarge.
///
/// ```
/// use bspray::geometry::BoundingSphere;
/// use glam::Vec3;
/// let points = [Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)];
/// let sphere = BoundingSphere::around(Vec3::ZERO, &points).expect("finite points");
/// assert!(points.iter().all(|&p| sphere.contains(p)));
/// assert!((sphere.radius - 14.0_f32.sqrt()).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingSphere {
    /// The middle.
    pub center: Vec3,
    /// Distance from the middle to the surface, never negative.
    pub radius: f32,
}

impl BoundingSphere {
    /// The sphere about `center` that just holds the points, its radius rounded upwards; of radius 0 without points.
    ///
    /// `None` if a number is not finite, or the radius exceeds single precision.
    pub fn around(center: Vec3, points: &[Vec3]) -> Option<Self> {
        let farthest = points.iter().fold(0.0_f64, |most, p| {
            most.max((p.as_dvec3() - center.as_dvec3()).length_squared())
        });
        let is_finite = center.is_finite() && points.iter().all(|p| p.is_finite());
        // Up by one more than the rounding to single precision needs, which pays for those in double precision.
        let radius = if farthest > 0.0 {
            (farthest.sqrt() as f32).next_up()
        } else {
            0.0
        };
        (is_finite && radius.is_finite()).then_some(Self { center, radius })
    }

    /// Whether the sphere holds `point`, which is decided in double precision.
    pub fn contains(&self, point: Vec3) -> bool {
        let distance = (point.as_dvec3() - self.center.as_dvec3()).length();
        distance <= f64::from(self.radius)
    }

    /// Area of the surface, in square units.
    pub fn surface_area(&self) -> f64 {
        4.0 * std::f64::consts::PI * f64::from(self.radius) * f64::from(self.radius)
    }

    /// Volume, in cubic units.
    pub fn volume(&self) -> f64 {
        self.surface_area() * f64::from(self.radius) / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_radius_is_rounded_upwards_and_no_more() {
        // The square root of 14, which no number of the machine is.
        let sphere = BoundingSphere::around(Vec3::ONE, &[Vec3::new(2.0, 3.0, 4.0)]).unwrap();
        assert!(f64::from(sphere.radius) > 14.0_f64.sqrt());
        assert!(f64::from(sphere.radius.next_down().next_down()) < 14.0_f64.sqrt());
        assert!(sphere.contains(Vec3::new(2.0, 3.0, 4.0)));
        assert!(!sphere.contains(Vec3::new(2.0, 3.0, 4.1)));
    }

    #[test]
    fn area_and_volume_of_a_sphere_of_radius_two() {
        let sphere = BoundingSphere {
            center: Vec3::ONE,
            radius: 2.0,
        };
        assert!((sphere.surface_area() - 50.265_482_457).abs() < 1e-8);
        assert!((sphere.volume() - 33.510_321_638).abs() < 1e-8);
    }

    #[test]
    fn a_point_has_no_radius_and_infinity_no_sphere() {
        let point = BoundingSphere::around(Vec3::ONE, &[Vec3::ONE]).unwrap();
        assert!(point.radius == 0.0 && point.contains(Vec3::ONE));
        assert!(BoundingSphere::around(Vec3::ZERO, &[Vec3::INFINITY]).is_none());
        assert!(BoundingSphere::around(Vec3::NAN, &[]).is_none());
        assert!(BoundingSphere::around(Vec3::MIN, &[Vec3::MAX]).is_none());
    }
}
