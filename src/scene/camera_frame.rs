//! A camera for pictures of one size: rays through its pixels, and where points of the world fall on it. World space, right-handed; places on
//! the picture are in pixels from its top left corner, x to the right and y down.

mod lens;
mod pinhole;
mod project;

pub use pinhole::Pinhole;

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};

use super::camera::{Camera, Lens, Projection};
use crate::geometry::{Ray, RayOrigin};

/// A camera made ready for rays of one picture size.
///
/// ```
/// use bspray::scene::{Camera, Projection};
/// use glam::Vec3;
/// let camera = Camera {
///     name: String::new(),
///     position: Vec3::new(0.0, 0.0, 5.0),
///     focal_point: Vec3::ZERO,
///     view_up: Vec3::Y,
///     projection: Projection::Perspective { view_angle: 90.0 },
/// };
/// let frame = camera.frame(200, 100).expect("position and focal point differ");
/// // The middle of the picture looks at the focal point, the middle of its top edge 45 degrees up.
/// assert_eq!(frame.ray(100.0, 50.0, None).direction, Vec3::NEG_Z);
/// assert!((frame.ray(100.0, 0.0, None).direction - Vec3::new(0.0, 1.0, -1.0).normalize()).length() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFrame {
    origin: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Half the screen's width and height at distance 1 (perspective) or in model units (orthographic).
    half: (f64, f64),
    /// Twice the reciprocal of the picture's width and height, per pixel.
    scale: (f64, f64),
    shape: Shape,
    lens: Option<Lens>,
}

/// A [`Projection`] without its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Perspective,
    Orthographic,
    Panoramic,
}

impl CameraFrame {
    /// See [`Camera::frame`].
    pub(super) fn new(camera: &Camera, width: u32, height: u32) -> Option<Self> {
        let origin = camera.position.as_dvec3();
        let forward = (camera.focal_point.as_dvec3() - origin).try_normalize()?;
        let across = |up: DVec3| {
            let right = forward.cross(up);
            // Below this the up vector is along the view for all that single precision can tell.
            (right.length_squared() > 1e-14 * up.length_squared()).then(|| right.normalize())
        };
        let fallback = || {
            let least = forward.abs();
            let axis = if least.y <= least.x && least.y <= least.z {
                DVec3::Y
            } else if least.z <= least.x {
                DVec3::Z
            } else {
                DVec3::X
            };
            forward.cross(axis).normalize()
        };
        let right = across(camera.view_up.as_dvec3()).unwrap_or_else(fallback);
        let up = right.cross(forward);
        let size = (f64::from(width), f64::from(height));
        let (half_height, shape) = match camera.projection {
            Projection::Perspective { view_angle } => {
                let angle = f64::from(view_angle);
                (0.0 < angle && angle < 180.0)
                    .then(|| (libm::tan(angle.to_radians() / 2.0), Shape::Perspective))?
            }
            Projection::Orthographic { height } => (0.0 < height && height.is_finite())
                .then(|| (f64::from(height) / 2.0, Shape::Orthographic))?,
            // There is no screen; the numbers stand for one of a right angle.
            Projection::Panoramic => (1.0, Shape::Panoramic),
        };
        let half = (half_height * size.0 / size.1, half_height);
        Some(Self {
            origin,
            right,
            up,
            forward,
            half,
            scale: (2.0 / size.0, 2.0 / size.1),
            shape,
            lens: None,
        })
    }

    /// The ray through screen position (`x`, `y`), in pixels from the top left corner; pixel centres are at halves.
    ///
    /// Its direction has unit length, so `t` is a distance in model units. `pixel` is what the ray will know of its pixel.
    #[inline]
    pub fn ray(&self, x: f64, y: f64, pixel: Option<(u32, u32)>) -> Ray {
        let (origin, direction) = self.origin_and_direction(x, y);
        let source = RayOrigin { depth: 0, pixel };
        Ray {
            source,
            ..Ray::new(origin.as_vec3(), direction.as_vec3())
        }
    }

    #[inline(always)]
    fn origin_and_direction(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        // From -1 to 1, to the right and upwards.
        let (right, up) = (x * self.scale.0 - 1.0, 1.0 - y * self.scale.1);
        let offset = self.right * (right * self.half.0) + self.up * (up * self.half.1);
        match self.shape {
            Shape::Perspective => (self.origin, (self.forward + offset).normalize()),
            Shape::Orthographic => (self.origin + offset, self.forward),
            Shape::Panoramic => {
                let (east, north) = libm::sincos(right * PI);
                let (upwards, level) = libm::sincos(up * FRAC_PI_2);
                let around = self.forward * north + self.right * east;
                (self.origin, around * level + self.up * upwards)
            }
        }
    }

    /// Distance of a point from the plane through the eye across the view, in model units: the picture's depth. In a panorama, which has no such plane, its distance from
    /// the eye.
    pub fn depth(&self, point: Vec3) -> f32 {
        let from_eye = point.as_dvec3() - self.origin;
        match self.shape {
            Shape::Panoramic => from_eye.length() as f32,
            _ => from_eye.dot(self.forward) as f32,
        }
    }

    /// Right, up and backward unit vectors and the eye: the columns of the matrix that takes camera space (x right,
    /// y up, looking along -z) to world space.
    pub fn world_from_camera(&self) -> [DVec3; 4] {
        [self.right, self.up, -self.forward, self.origin]
    }

    /// Unit vector of the view.
    pub fn forward(&self) -> Vec3 {
        self.forward.as_vec3()
    }

    /// Half the screen's width and height: tangents of the half angles of a perspective camera, model units of an orthographic one.
    pub fn half_size(&self) -> (f64, f64) {
        self.half
    }

    /// Whether the rays go from the eye through a screen.
    pub fn is_perspective(&self) -> bool {
        self.shape == Shape::Perspective
    }

    /// Whether there is a screen at all, so that a place in the world has one on the picture by a matrix. A panorama has none.
    pub fn has_screen(&self) -> bool {
        self.shape != Shape::Panoramic
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn camera(projection: Projection) -> Camera {
        Camera {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 3.0),
            focal_point: Vec3::new(1.0, 2.0, -7.0),
            view_up: Vec3::new(0.0, 5.0, 1.0),
            projection,
        }
    }

    #[test]
    fn corners_of_a_wide_picture() {
        let frame = camera(Projection::Perspective { view_angle: 90.0 })
            .frame(300, 100)
            .expect("valid");
        let corner = frame.ray(0.0, 0.0, Some((0, 0)));
        let d = corner.direction / -corner.direction.z;
        assert!((d - Vec3::new(-3.0, 1.0, -1.0)).length() < 1e-6, "{d}");
        assert_eq!(corner.source.pixel, Some((0, 0)));
        assert!((corner.direction.length() - 1.0).abs() < 1e-6);
        assert_eq!(frame.depth(Vec3::new(50.0, -9.0, -1.0)), 4.0);
    }

    #[test]
    fn orthographic_rays_are_parallel() {
        let frame = camera(Projection::Orthographic { height: 4.0 })
            .frame(200, 100)
            .expect("valid");
        let (a, b) = (frame.ray(0.0, 0.0, None), frame.ray(200.0, 100.0, None));
        assert_eq!(a.direction, b.direction);
        assert!((a.origin - Vec3::new(-3.0, 4.0, 3.0)).length() < 1e-6);
        assert!((b.origin - Vec3::new(5.0, 0.0, 3.0)).length() < 1e-6);
    }

    #[test]
    fn a_panorama_shows_what_is_around_the_eye() {
        let frame = camera(Projection::Panoramic)
            .frame(400, 200)
            .expect("valid");
        let eye = Vec3::new(1.0, 2.0, 3.0);
        for (x, y, want) in [
            (200.0, 100.0, Vec3::NEG_Z),
            (300.0, 100.0, Vec3::X),
            (100.0, 100.0, Vec3::NEG_X),
            (0.0, 100.0, Vec3::Z),
            (37.0, 0.0, Vec3::Y),
            (300.0, 150.0, Vec3::new(1.0, -1.0, 0.0).normalize()),
        ] {
            let ray = frame.ray(x, y, None);
            assert_eq!(ray.origin, eye);
            assert!(
                (ray.direction - want).length() < 1e-6,
                "{x} {y}: {}",
                ray.direction
            );
        }
        assert_eq!(frame.depth(eye + Vec3::new(2.0, 3.0, 6.0)), 7.0);
        assert!(!frame.has_screen());
    }

    #[test]
    fn impossible_cameras_have_no_frame() {
        let good = camera(Projection::Perspective { view_angle: 90.0 });
        assert!(
            Camera {
                focal_point: good.position,
                ..good.clone()
            }
            .frame(10, 10)
            .is_none()
        );
        for view_angle in [0.0, 180.0, -1.0, f32::NAN] {
            assert!(
                camera(Projection::Perspective { view_angle })
                    .frame(10, 10)
                    .is_none()
            );
        }
        let nan = Camera {
            focal_point: Vec3::splat(f32::NAN),
            ..good.clone()
        };
        assert!(nan.frame(10, 10).is_none());
        assert!(
            camera(Projection::Orthographic { height: 0.0 })
                .frame(10, 10)
                .is_none()
        );
    }

    #[test]
    fn an_up_vector_along_the_view_is_replaced() {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let c = Camera {
                focal_point: Vec3::new(1.0, 2.0, 3.0) + axis,
                view_up: axis * 3.0,
                ..camera(Projection::Perspective { view_angle: 30.0 })
            };
            let frame = c.frame(10, 10).expect("the up vector is replaced");
            let [right, up, back, _] = frame.world_from_camera();
            assert!((right.cross(up) - back).length() < 1e-12);
        }
    }
}
