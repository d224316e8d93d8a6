//! The tests of rays against boxes and spheres ("Box and Sphere Extents (2)", "Implementing Sphere Extent Testing").
//!
//! Conservative in single precision: what lies in the extent, and up to its margin beside it, is never missed by a ray that hits it. The
//! errors are those of [`tolerance`](crate::geometry::tolerance).

use glam::Vec3;

use super::ray::ExtentRay;
use crate::geometry::tolerance::{
    EXTENT_DISTANCE_ERROR, EXTENT_FARTHEST, EXTENT_FLOOR, EXTENT_SQUARE_ERROR, EXTENT_TIME_ERROR,
};
use crate::geometry::{Aabb, BoundingSphere};

/// The test of an axis-aligned box.
///
/// ```
/// use bspray::accel::extents::{BoxExtent, ExtentRay};
/// use bspray::geometry::{Aabb, Ray};
/// use glam::Vec3;
/// let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 3.0) };
/// let extent = BoxExtent::new(&bounds, 0.0).expect("in range");
/// let mut planes = 0;
/// let from = Vec3::new(0.5, 0.5, 9.0);
/// assert!(extent.admits(&ExtentRay::new(&Ray::new(from, Vec3::NEG_Z)), &mut planes));
/// assert_eq!(planes, 6);
/// // An early out: beside the first plane already.
/// assert!(!extent.admits(&ExtentRay::new(&Ray::new(from - Vec3::X, Vec3::NEG_Z)), &mut planes));
/// assert_eq!(planes, 7);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct BoxExtent {
    min: Vec3,
    max: Vec3,
}

impl BoxExtent {
    /// The test of a box with a margin around it, in model units. `None` for an empty box, and beyond [`EXTENT_FARTHEST`].
    pub fn new(bounds: &Aabb, margin: f32) -> Option<Self> {
        let margin = margin + EXTENT_FLOOR;
        let down = |p: Vec3| p.map(|x| (x - margin).next_down());
        let (min, max) = (down(bounds.min), -down(-bounds.max));
        let is_near = |p: Vec3| p.abs().cmple(Vec3::splat(EXTENT_FARTHEST)).all();
        let is_usable = !bounds.is_empty() && is_near(min) && is_near(max);
        is_usable.then_some(Self { min, max })
    }

    /// Whether the ray may hit what is in the box, within its interval. Adds the planes that it had to look at: one to six, since the candidate
    /// interval often vanishes early.
    #[inline]
    pub fn admits(&self, ray: &ExtentRay, planes: &mut u32) -> bool {
        if !ray.is_usual {
            return true;
        }
        let (mut t_in, mut t_out) = (ray.start, ray.end);
        for axis in 0..3 {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            let (min, max) = (self.min[axis], self.max[axis]);
            *planes += 1;
            // A ray that is parallel to the planes crosses none; any other number, however small, divides.
            if d == 0.0 {
                if o < min {
                    return false;
                }
                *planes += 1;
                if o > max {
                    return false;
                }
                continue;
            }
            let (first, last) = if d > 0.0 { (min, max) } else { (max, min) };
            let t = (first - o) / d;
            // An infinite time makes a NaN, which `max` and `min` pass over.
            t_in = t_in.max(t - EXTENT_TIME_ERROR * t.abs());
            if t_in > t_out {
                return false;
            }
            *planes += 1;
            let t = (last - o) / d;
            t_out = t_out.min(t + EXTENT_TIME_ERROR * t.abs());
            if t_in > t_out {
                return false;
            }
        }
        true
    }
}

/// The test of a sphere.
///
/// ```
/// use bspray::accel::extents::{ExtentRay, SphereExtent};
/// use bspray::geometry::{BoundingSphere, Ray};
/// use glam::Vec3;
/// let sphere = BoundingSphere { center: Vec3::new(1.0, 2.0, 3.0), radius: 0.5 };
/// let extent = SphereExtent::new(&sphere, 0.0).expect("in range");
/// let admits = |o, d| extent.admits(&ExtentRay::new(&Ray::new(o, d)));
/// assert!(admits(Vec3::new(1.0, 2.4, 9.0), Vec3::NEG_Z));
/// assert!(!admits(Vec3::new(1.0, 2.6, 9.0), Vec3::NEG_Z));
/// // The lecture's test is of a line, and would admit this one, which goes away.
/// assert!(!admits(Vec3::new(1.0, 2.4, 9.0), Vec3::Z));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SphereExtent {
    center: Vec3,
    /// With its margin.
    radius: f32,
}

impl SphereExtent {
    /// The test of a sphere with a margin around it, in model units. `None` if it reaches beyond [`EXTENT_FARTHEST`].
    pub fn new(sphere: &BoundingSphere, margin: f32) -> Option<Self> {
        let radius = (sphere.radius + (margin + EXTENT_FLOOR).next_up()).next_up();
        let farthest = sphere.center.abs().max_element() + radius;
        (farthest <= EXTENT_FARTHEST).then_some(Self {
            center: sphere.center,
            radius,
        })
    }

    /// Whether the ray may hit what is in the sphere, within its interval.
    ///
    /// The lecture's discriminant `B^2 - A C` cancels where the sphere is far and small; the same number is
    /// `r^2 |d|^2 - |(o - c) x d|^2`, whose error grows with the distance and not with its square.
    #[inline]
    pub fn admits(&self, ray: &ExtentRay) -> bool {
        if !ray.is_usual {
            return true;
        }
        let from_center = ray.origin - self.center;
        let error = EXTENT_DISTANCE_ERROR * from_center.abs().element_sum();
        let radius = self.radius + error;
        let grown = radius * radius * (1.0 + EXTENT_SQUARE_ERROR);
        if from_center.cross(ray.direction).length_squared() > grown * ray.squared {
            return false;
        }
        let along = from_center.dot(ray.direction);
        // Behind the origin: that lies outside, and the ray goes away.
        if ray.is_forward && along > error && from_center.length_squared() > grown {
            return false;
        }
        // Beyond the end.
        let first = -along - radius * ray.length * (1.0 + EXTENT_SQUARE_ERROR) - error;
        let end = ray.end * ray.squared * (1.0 + EXTENT_SQUARE_ERROR);
        !(first > 0.0 && first > end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Interval, Ray};

    fn slab() -> Aabb {
        Aabb {
            min: Vec3::new(-1.0, 2.0, 5.0),
            max: Vec3::new(0.0, 4.0, 8.0),
        }
    }

    #[test]
    fn boxes_beside_behind_and_beyond_the_end_are_rejected() {
        let extent = BoxExtent::new(&slab(), 0.0).unwrap();
        let admits = |ray: Ray| extent.admits(&ExtentRay::new(&ray), &mut 0);
        let ray = Ray::new(Vec3::new(-0.5, 3.0, 0.0), Vec3::Z * 2.0);
        assert!(admits(ray));
        assert!(admits(ray.within(Interval::new(0.0, 2.5))));
        assert!(!admits(ray.within(Interval::new(0.0, 2.49))));
        assert!(!admits(ray.within(Interval::new(4.01, 9.0))));
        assert!(!admits(Ray::new(ray.origin, Vec3::NEG_Z)));
        assert!(admits(
            Ray::new(ray.origin, Vec3::NEG_Z).within(Interval::new(-6.0, 0.0))
        ));
        assert!(!admits(Ray::new(Vec3::new(0.1, 3.0, 0.0), Vec3::Z)));
        assert!(!admits(Ray::new(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0))));
    }

    #[test]
    fn rays_along_faces_edges_and_through_corners_are_admitted() {
        let extent = BoxExtent::new(&slab(), 0.0).unwrap();
        for corner in 0..8 {
            let pick = |i: usize| {
                if corner >> i & 1 == 0 {
                    slab().min[i]
                } else {
                    slab().max[i]
                }
            };
            let corner = Vec3::new(pick(0), pick(1), pick(2));
            for direction in [Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::new(0.1, 0.7, -0.3)] {
                let ray = Ray::new(corner - direction * 3.0, direction);
                assert!(extent.admits(&ExtentRay::new(&ray), &mut 0), "{ray:?}");
            }
        }
    }

    #[test]
    fn the_candidate_interval_vanishes_early() {
        let extent = BoxExtent::new(&slab(), 0.0).unwrap();
        let planes = |o, d| {
            let mut planes = 0;
            extent.admits(&ExtentRay::new(&Ray::new(o, d)), &mut planes);
            planes
        };
        let origin = Vec3::new(-0.5, 3.0, 0.0);
        assert_eq!(planes(origin, Vec3::new(0.01, 0.01, 1.0)), 6);
        // Out by the second plane of the first axis: the box lies behind.
        assert_eq!(planes(Vec3::new(1.0, 3.0, 6.0), Vec3::ONE), 2);
        // Out by the third: it leaves the first slab before it enters the second.
        assert_eq!(
            planes(Vec3::new(-9.0, 9.0, 6.0), Vec3::new(1.0, -0.1, 0.1)),
            3
        );
    }

    #[test]
    fn spheres_beside_behind_and_beyond_the_end_are_rejected() {
        let sphere = BoundingSphere {
            center: Vec3::new(1.0, 2.0, 3.0),
            radius: 1.5,
        };
        let extent = SphereExtent::new(&sphere, 0.0).unwrap();
        let admits = |ray: Ray| extent.admits(&ExtentRay::new(&ray));
        let ray = Ray::new(Vec3::new(1.0, 2.0, -7.0), Vec3::Z * 2.0);
        assert!(admits(ray) && admits(ray.within(Interval::new(0.0, 4.25))));
        assert!(!admits(ray.within(Interval::new(0.0, 4.24))));
        assert!(!admits(Ray::new(ray.origin, Vec3::NEG_Z)));
        assert!(admits(
            Ray::new(ray.origin, Vec3::NEG_Z).within(Interval::new(-20.0, 0.0))
        ));
        // From within, in every direction, and from the surface outwards, where it may touch.
        assert!(admits(Ray::new(Vec3::new(2.0, 2.5, 3.0), Vec3::X)));
        assert!(admits(Ray::new(Vec3::new(2.5, 2.0, 3.0), Vec3::X)));
        assert!(!admits(Ray::new(Vec3::new(2.51, 2.0, 3.0), Vec3::X)));
    }

    #[test]
    fn far_and_small_spheres_are_neither_lost_nor_seen_everywhere() {
        let sphere = BoundingSphere {
            center: Vec3::new(1e5, 2e5, 3e5),
            radius: 1.0,
        };
        let extent = SphereExtent::new(&sphere, 0.0).unwrap();
        let at = |target: Vec3| extent.admits(&ExtentRay::new(&Ray::new(Vec3::ZERO, target)));
        assert!(at(sphere.center));
        // The discriminant in single precision knows no difference to a ray that passes at a distance of 100.
        assert!(!at(sphere.center + Vec3::new(0.0, 3.0, -2.0)));
    }

    #[test]
    fn extents_beyond_the_range_do_not_exist() {
        let far = Aabb {
            min: Vec3::ZERO,
            max: Vec3::splat(3e18),
        };
        assert!(BoxExtent::new(&far, 0.0).is_none());
        assert!(BoxExtent::new(&Aabb::EMPTY, 0.0).is_none());
        let sphere = BoundingSphere {
            center: Vec3::X * 1.5e18,
            radius: 1e18,
        };
        assert!(SphereExtent::new(&sphere, 0.0).is_none());
        assert!(SphereExtent::new(&sphere, f32::NAN).is_none());
    }
}
