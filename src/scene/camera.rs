//! Cameras: where the eye is and how the world falls on the screen. World space, right-handed.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{DQuat, DVec2, DVec3, Vec3};

use crate::geometry::{Ray, RayOrigin};

/// How the world falls on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A pinhole.
    Perspective {
        /// The full angle between the picture's top and bottom, in degrees.
        view_angle: f32,
    },
    /// Parallel rays.
    Orthographic {
        /// Height of the picture, in model units.
        height: f32,
    },
    /// Everything around the eye, by longitude along the rows and latitude along the columns (equirectangular). The view is in the middle.
    Panoramic,
}

/// A thin lens: what is in its plane of focus is sharp, all else is blurred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the opening, in model units.
    pub radius: f64,
    /// Depth of the plane of focus along the view axis, in model units.
    pub focus_distance: f64,
}

/// A camera, given by the numbers that a user can type.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name in the file; empty for cameras of our own.
    pub name: String,
    /// Where the eye is; for parallel rays, the middle of the plane from which they start.
    pub position: Vec3,
    /// A point that appears in the middle of the picture.
    pub focal_point: Vec3,
    /// A vector that appears to point upwards; neither unit nor perpendicular to the view.
    pub view_up: Vec3,
    /// How the world falls on the screen.
    pub projection: Projection,
}

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

impl Camera {
    /// The camera after it has gone around the line through `middle` along `axis` (unit length) by an angle in radians, counter-clockwise as seen from the axis's tip, looking on as it did.
    #[must_use]
    pub fn turned_around(&self, middle: DVec3, axis: DVec3, angle: f64) -> Self {
        let turn = DQuat::from_axis_angle(axis, angle);
        let point = |p: Vec3| (middle + turn * (p.as_dvec3() - middle)).as_vec3();
        Self {
            position: point(self.position),
            focal_point: point(self.focal_point),
            view_up: (turn * self.view_up.as_dvec3()).as_vec3(),
            ..self.clone()
        }
    }

    /// The camera for a picture of `width` times `height` square pixels.
    ///
    /// `None` if position and focal point are one point, the angle or height is not positive (or the angle not below 180
    /// degrees), or a number is not finite. An up vector along the view (or of no length) is replaced by the axis
    /// that is most across the view.
    pub fn frame(&self, width: u32, height: u32) -> Option<CameraFrame> {
        let origin = self.position.as_dvec3();
        let forward = (self.focal_point.as_dvec3() - origin).try_normalize()?;
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
        let right = across(self.view_up.as_dvec3()).unwrap_or_else(fallback);
        let up = right.cross(forward);
        let size = (f64::from(width), f64::from(height));
        let (half_height, shape) = match self.projection {
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
        Some(CameraFrame {
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
}

impl CameraFrame {
    /// The camera with a thin lens instead of a pinhole, for [`lens_ray`](Self::lens_ray).
    #[must_use]
    pub fn with_lens(self, lens: Lens) -> Self {
        Self {
            lens: Some(lens),
            ..self
        }
    }

    /// The lens, if the camera is no pinhole.
    pub fn lens(&self) -> Option<Lens> {
        self.lens
    }

    /// The ray through a screen position, as [`ray`](Self::ray) has it, that starts at the point of the lens that two numbers in [0, 1) choose: evenly from its disk, by
    /// the concentric map of Shirley and Chiu (1997). It meets the ray through the lens's middle in the plane of focus. Without a lens, and for
    /// panoramas, it is that ray.
    ///
    /// It knows no pixel: what is behind a pixel is not where its screen position says.
    pub fn lens_ray(&self, x: f64, y: f64, numbers: [f32; 2]) -> Ray {
        let middle = self.ray(x, y, None);
        let Some(lens) = self.lens.filter(|_| self.shape != Shape::Panoramic) else {
            return middle;
        };
        let (origin, direction) = self.origin_and_direction(x, y);
        let focus = origin + direction * (lens.focus_distance / direction.dot(self.forward));
        let (across, upwards) = concentric_disk(numbers);
        let start = origin + (self.right * across + self.up * upwards) * lens.radius;
        Ray {
            source: middle.source,
            ..Ray::new(start.as_vec3(), (focus - start).normalize().as_vec3())
        }
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

    /// Where a point of the world falls on the picture, in pixels from its top left corner as in [`ray`](Self::ray), which it inverts; also beyond the picture's edges.
    ///
    /// `None` where no ray can lead: at the eye and, in perspective, in the plane through the eye across the view and behind it.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let from_eye = point - self.origin;
        let [x, y, z] = [self.right, self.up, self.forward].map(|axis| from_eye.dot(axis));
        // From -1 to 1, to the right and upwards.
        let (right, up) = match self.shape {
            Shape::Perspective if z > 0.0 => (x / (z * self.half.0), y / (z * self.half.1)),
            Shape::Perspective => return None,
            Shape::Orthographic => (x / self.half.0, y / self.half.1),
            Shape::Panoramic if from_eye == DVec3::ZERO => return None,
            Shape::Panoramic => {
                let level = (x * x + z * z).sqrt();
                (libm::atan2(x, z) / PI, libm::atan2(y, level) / FRAC_PI_2)
            }
        };
        let place = DVec2::new((right + 1.0) / self.scale.0, (1.0 - up) / self.scale.1);
        place.is_finite().then_some(place)
    }

    /// The way from one place on the picture to another, in pixels to the right and down. In a panorama, whose left and right edges meet, the shorter one.
    pub fn way(&self, from: DVec2, to: DVec2) -> DVec2 {
        let mut way = to - from;
        if self.shape == Shape::Panoramic {
            let width = 2.0 / self.scale.0;
            way.x -= width * (way.x / width).round();
        }
        way
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

/// A point of the unit disk for a point of the unit square: squares around its middle become circles (Shirley and Chiu 1997, "A Low
/// Distortion Map Between Disk and Square"), so that what is stratified stays so.
fn concentric_disk([u, v]: [f32; 2]) -> (f64, f64) {
    let (a, b) = (2.0 * f64::from(u) - 1.0, 2.0 * f64::from(v) - 1.0);
    let (radius, angle) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else if b == 0.0 {
        return (0.0, 0.0);
    } else {
        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
    };
    let (sine, cosine) = libm::sincos(angle);
    (radius * cosine, radius * sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(projection: Projection) -> Camera {
        Camera {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 3.0),
            focal_point: Vec3::new(1.0, 2.0, -7.0),
            view_up: Vec3::new(0.0, 5.0, 1.0),
            projection,
        }
    }

    #[test]
    fn a_camera_goes_around_and_looks_on_as_it_did() {
        let camera = Camera {
            name: "a".to_owned(),
            position: Vec3::new(3.0, 5.0, 1.0),
            focal_point: Vec3::new(1.0, 4.0, 1.0),
            view_up: Vec3::Y,
            projection: Projection::Orthographic { height: 2.0 },
        };
        let middle = DVec3::new(1.0, 0.0, 1.0);
        let quarter = camera.turned_around(middle, DVec3::Y, std::f64::consts::FRAC_PI_2);
        // Seen from above, from the east to the north.
        assert!((quarter.position - Vec3::new(1.0, 5.0, -1.0)).length() < 1e-6);
        assert!((quarter.focal_point - camera.focal_point).length() < 1e-6);
        assert_eq!(
            (quarter.projection, &quarter.name),
            (camera.projection, &camera.name)
        );
        let still = camera.turned_around(middle, DVec3::Y, 0.0);
        assert_eq!(still, camera);
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
    fn points_on_a_ray_fall_where_it_came_from() {
        for projection in [
            Projection::Perspective { view_angle: 70.0 },
            Projection::Orthographic { height: 3.0 },
            Projection::Panoramic,
        ] {
            let frame = camera(projection).frame(300, 200).expect("valid");
            // The last one is beyond the edge; a panorama has nothing there.
            let beyond = if frame.has_screen() { 340.5 } else { 3.0 };
            for (x, y) in [(0.5, 0.5), (211.0, 37.25), (beyond, 150.0)] {
                let ray = frame.ray(x, y, None);
                let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * 7.0;
                let found = frame.project(point).expect("before the eye");
                let off = (found - DVec2::new(x, y)).length();
                assert!(off < 1e-4, "{projection:?} {x} {y}: {found}");
            }
        }
    }

    #[test]
    fn only_a_perspective_loses_what_is_behind_the_eye() {
        let behind = DVec3::new(1.5, 2.0, 4.0);
        let project = |projection| {
            let frame = camera(projection).frame(300, 200).expect("valid");
            frame.project(behind)
        };
        assert_eq!(project(Projection::Perspective { view_angle: 70.0 }), None);
        let parallel = project(Projection::Orthographic { height: 4.0 });
        assert!(
            parallel.is_some_and(|p| (p.x - 175.0).abs() < 1e-4),
            "{parallel:?}"
        );
        assert!(project(Projection::Panoramic).is_some());
        let eye = camera(Projection::Panoramic).position.as_dvec3();
        let frame = camera(Projection::Panoramic)
            .frame(300, 200)
            .expect("valid");
        assert_eq!(frame.project(eye), None);
    }

    #[test]
    fn ways_over_the_seam_of_a_panorama_are_short() {
        let (left, right) = (DVec2::new(2.0, 10.0), DVec2::new(297.0, 30.0));
        let way = |projection| {
            let frame = camera(projection).frame(300, 200).expect("valid");
            frame.way(left, right)
        };
        let short = way(Projection::Panoramic) - DVec2::new(-5.0, 20.0);
        assert!(short.length() < 1e-9, "{short}");
        let flat = way(Projection::Orthographic { height: 1.0 });
        assert_eq!(flat, DVec2::new(295.0, 20.0));
    }

    #[test]
    fn rays_through_the_lens_meet_in_the_plane_of_focus_and_fill_its_disk() {
        let lens = Lens {
            radius: 0.25,
            focus_distance: 4.0,
        };
        for projection in [
            Projection::Perspective { view_angle: 70.0 },
            Projection::Orthographic { height: 3.0 },
        ] {
            let frame = camera(projection)
                .frame(300, 100)
                .expect("valid")
                .with_lens(lens);
            let middle = frame.ray(40.0, 80.0, None);
            let sharp = middle.origin + middle.direction * (4.0 / -middle.direction.z);
            let (mut sum, mut square) = (Vec3::ZERO, 0.0);
            for i in 0..64 * 64 {
                let numbers = [i % 64, i / 64].map(|n| (n as f32 + 0.5) / 64.0);
                let ray = frame.lens_ray(40.0, 80.0, numbers);
                let there =
                    ray.origin + ray.direction * ((3.0 - 4.0 - ray.origin.z) / ray.direction.z);
                assert!((there - sharp).length() < 1e-5, "{there} {sharp}");
                let offset = ray.origin - middle.origin;
                assert!(offset.length() < 0.25 && offset.z.abs() < 1e-6);
                sum += offset / 4096.0;
                square += offset.length_squared() / 4096.0;
            }
            // The mean square of the distance in an even disk is half that of its radius.
            assert!(
                sum.length() < 1e-4 && (square - 0.25 * 0.25 / 2.0).abs() < 1e-4,
                "{sum} {square}"
            );
        }
        let pinhole = camera(Projection::Orthographic { height: 3.0 })
            .frame(9, 9)
            .expect("valid");
        assert_eq!(
            pinhole.lens_ray(2.0, 3.0, [0.1, 0.9]),
            pinhole.ray(2.0, 3.0, None)
        );
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
