//! Boxes and rays in a space where the scene fills the cube from -1 to 1 and every ray starts near it.
//!
//! obvhs 0.4.0 holds absolute epsilons (1e-4 on the entry of a node of its wide tree, 2^-23 on a direction's components) and
//! tests boxes without a margin, so that it loses rays in scenes that are small, or seen from afar. Here its trees see one and
//! the same scale: boxes are padded by [`BVH_PADDING`], and the ray that walks them starts [`RAY_RUN_UP`] before the
//! scene. Only the walk happens here; triangles are tested with the original ray.

use glam::{DVec3, Vec3};

use crate::geometry::tolerance::{BVH_FAR, BVH_PADDING};
use crate::geometry::{Aabb, Ray};

/// How far before the scene (or the ray's interval) the walk begins, in normalised units: a little more than obvhs's 1e-4,
/// within which no node is entered. More would take shadow rays through what lies behind their origin: with a quarter
/// of a unit they tested twice the nodes.
const RAY_RUN_UP: f64 = 1.0 / 4096.0;

/// Radius of a ball around the scene's cube with all padding: a little above the square root of 3.
const RADIUS: f64 = 1.75;

/// The map from a scene's space to its normalised one: `(p - center) * scale`.
#[derive(Clone, Copy, Debug)]
pub(super) struct NormalizedSpace {
    center: DVec3,
    /// A power of two.
    scale: f64,
}

/// What becomes of a ray.
pub(super) enum Walk {
    /// It passes the scene at a distance.
    Misses,
    /// It starts so far off that double precision cannot say where it passes: everything must be tested.
    TooFar,
    /// It may hit something.
    Through(NormalizedRay),
}

/// A ray in normalised space, moved along itself to where the scene begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct NormalizedRay {
    pub(super) origin: Vec3,
    /// Of unit length, without negative zeros.
    pub(super) direction: Vec3,
    /// Normalised distance from the original ray's origin to this one's.
    start: f64,
    /// Normalised distance of one unit of the original ray's `t`.
    per_t: f64,
    /// Normalised distance at which the ray has left the scene.
    exit: f64,
}

impl NormalizedSpace {
    /// The space in which `bounds` touches the cube from -1 to 1, up to a factor of 2.
    pub(super) fn around(bounds: &Aabb) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let half = ((max - min) * 0.5).max_element();
        let (_, exponent) = libm::frexp(half);
        let scale = if half > 0.0 {
            libm::ldexp(1.0, -exponent)
        } else {
            1.0
        };
        Self {
            center: (min + max) * 0.5,
            scale,
        }
    }

    /// A box of the original space with `margin` (original units) and [`BVH_PADDING`] around it.
    pub(super) fn padded(&self, bounds: &Aabb, margin: f64) -> Aabb {
        let pad = DVec3::splat(margin * self.scale + f64::from(BVH_PADDING));
        Aabb {
            min: ((bounds.min.as_dvec3() - self.center) * self.scale - pad).as_vec3(),
            max: ((bounds.max.as_dvec3() - self.center) * self.scale + pad).as_vec3(),
        }
    }

    /// A length of the original space in normalised units.
    pub(super) fn length(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// How far a point is from the middle of the scene, in the original space's units.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        (point - self.center).length()
    }

    /// Takes a traceable ray to where it meets the scene.
    pub(super) fn walk(&self, ray: &Ray) -> Walk {
        let origin = (ray.origin.as_dvec3() - self.center) * self.scale;
        let length = ray.direction.as_dvec3().length();
        let direction = ray.direction.as_dvec3() / length;
        let per_t = length * self.scale;
        let closest = -origin.dot(direction);
        if closest.abs() > BVH_FAR {
            return Walk::TooFar;
        }
        let half_chord_squared = RADIUS * RADIUS - (origin + direction * closest).length_squared();
        if half_chord_squared < 0.0 {
            return Walk::Misses;
        }
        let half_chord = half_chord_squared.sqrt();
        let first = (f64::from(ray.interval.min.next_down()) * per_t).max(closest - half_chord);
        let exit = closest + half_chord;
        if first > exit || first > f64::from(ray.interval.max.next_up()) * per_t {
            return Walk::Misses;
        }
        let start = first - RAY_RUN_UP;
        Walk::Through(NormalizedRay {
            origin: (origin + direction * start).as_vec3(),
            // Adding zero turns -0.0 into 0.0, which the wide tree's choice of octant needs.
            direction: direction.as_vec3() + Vec3::ZERO,
            start,
            per_t,
            exit: exit - start,
        })
    }
}

impl NormalizedRay {
    /// How far to walk so as to meet every hit whose `t`, rounded to single precision, is at most `t`.
    pub(super) fn limit(&self, t: f32) -> f32 {
        let walked = f64::from(t.next_up()) * self.per_t - self.start;
        (walked.min(self.exit) as f32).next_up()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Interval;

    fn space() -> NormalizedSpace {
        NormalizedSpace::around(&Aabb {
            min: Vec3::new(90.0, -1.0, 0.0),
            max: Vec3::new(110.0, 2.0, 5.0),
        })
    }

    #[test]
    fn the_scene_fits_the_cube() {
        let space = space();
        let b = space.padded(
            &Aabb {
                min: Vec3::new(90.0, -1.0, 0.0),
                max: Vec3::new(110.0, 2.0, 5.0),
            },
            0.0,
        );
        assert!(b.max.x > 0.5 && b.max.x <= 1.0 + BVH_PADDING && b.min.x < -0.5);
        assert_eq!(
            space.length(space.distance(DVec3::new(100.0, 0.5, 18.5))),
            1.0
        );
    }

    #[test]
    fn a_far_ray_starts_before_the_scene() {
        let ray = Ray::new(Vec3::new(1e6, 0.5, 2.5), Vec3::new(-2.0, 0.0, -0.0));
        let Walk::Through(walk) = space().walk(&ray) else {
            panic!("meets the scene")
        };
        assert!(
            (walk.origin.x - RADIUS as f32).abs() < 0.01,
            "{}",
            walk.origin
        );
        assert!(walk.direction.z.is_sign_positive());
        // x = 100, the middle, is at t = (1e6 - 100) / 2.
        let middle = walk.limit((1e6 - 100.0) / 2.0);
        assert!((middle - walk.origin.x).abs() < 0.01, "{middle}");
        assert!(walk.limit(f32::INFINITY) < 4.0);
    }

    #[test]
    fn rays_beside_before_and_behind_the_scene_miss() {
        let at = |o, d| space().walk(&Ray::new(o, d));
        assert!(matches!(
            at(Vec3::new(0.0, 50.0, 0.0), Vec3::X),
            Walk::Misses
        ));
        assert!(matches!(
            at(Vec3::new(0.0, 0.0, 2.0), Vec3::NEG_X),
            Walk::Misses
        ));
        let short = Ray::new(Vec3::new(0.0, 0.0, 2.0), Vec3::X).within(Interval::new(0.0, 10.0));
        assert!(matches!(space().walk(&short), Walk::Misses));
        assert!(matches!(
            at(Vec3::new(1e15, 0.0, 0.0), Vec3::NEG_X),
            Walk::TooFar
        ));
    }
}
