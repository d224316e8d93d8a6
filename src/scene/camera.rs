//! Cameras as people give them: where the eye is and how the world falls on the screen. World space, right-handed.

use glam::{DQuat, DVec3, Vec3};

use super::CameraFrame;

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
        CameraFrame::new(self, width, height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
