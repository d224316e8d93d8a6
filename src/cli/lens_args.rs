//! Arguments that say how the world falls on the picture: projection and lens.

use anyhow::bail;
use bspray::render::DEFAULT_VIEW_ANGLE;
use bspray::scene::{Camera, CameraFrame, Lens, Projection};
use clap::{Args, ValueEnum};

use super::{UsageError, values};

/// How the world falls on the picture.
#[derive(Args, Debug)]
#[command(next_help_heading = "Camera")]
pub(super) struct LensArgs {
    /// Another projection than the camera's own
    #[arg(long, value_enum, value_name = "NAME")]
    projection: Option<ProjectionName>,
    /// Height of an orthographic picture, in model units [default: what the camera sees at its focal point]
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, requires = "projection")]
    ortho_height: Option<f32>,
    /// Radius of a lens, in model units: what is out of focus is blurred [default: a pinhole]
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    aperture: Option<f32>,
    /// Depth along the view at which the lens is sharp, in model units [default: that of the focal point]
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, requires = "aperture")]
    focus_distance: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ProjectionName {
    /// A pinhole or a lens
    Perspective,
    /// Parallel rays
    Orthographic,
    /// Everything around the eye: longitude by latitude, for a picture twice as wide as high
    Panoramic,
}

impl LensArgs {
    /// Refuses what does not go together.
    ///
    /// # Errors
    /// A height without parallel rays, or a panorama with a lens or a drawing.
    pub(super) fn check(&self, has_overlay: bool) -> anyhow::Result<()> {
        let is_panoramic = self.projection == Some(ProjectionName::Panoramic);
        let words = if self.ortho_height.is_some()
            && self.projection != Some(ProjectionName::Orthographic)
        {
            "--ortho-height: only --projection orthographic has a height"
        } else if is_panoramic && self.aperture.is_some() {
            "--aperture: a panorama has no lens"
        } else if is_panoramic && has_overlay {
            "--overlay: a panorama has no screen to draw on"
        } else {
            return Ok(());
        };
        bail!(UsageError(words.to_owned()));
    }

    /// The camera with the projection that is asked for.
    pub(super) fn project(&self, camera: Camera) -> Camera {
        let angle = match camera.projection {
            Projection::Perspective { view_angle } => view_angle,
            _ => DEFAULT_VIEW_ANGLE,
        };
        let projection = match (self.projection, camera.projection) {
            (None, own) => own,
            (Some(ProjectionName::Perspective), own @ Projection::Perspective { .. }) => own,
            (Some(ProjectionName::Perspective), _) => Projection::Perspective { view_angle: angle },
            (Some(ProjectionName::Panoramic), _) => Projection::Panoramic,
            (Some(ProjectionName::Orthographic), own) => {
                let height = match (self.ortho_height, own) {
                    (Some(height), _) | (None, Projection::Orthographic { height }) => height,
                    _ => {
                        let distance = (camera.focal_point - camera.position).length();
                        2.0 * distance * libm::tanf(angle.to_radians() / 2.0)
                    }
                };
                Projection::Orthographic { height }
            }
        };
        Camera {
            projection,
            ..camera
        }
    }

    /// The camera with the lens that is asked for.
    pub(super) fn add_to(&self, frame: CameraFrame, camera: &Camera) -> CameraFrame {
        let Some(radius) = self.aperture else {
            return frame;
        };
        let focus_distance = self
            .focus_distance
            .unwrap_or_else(|| frame.depth(camera.focal_point));
        frame.with_lens(Lens {
            radius: f64::from(radius),
            focus_distance: f64::from(focus_distance),
        })
    }

    /// The lens as arguments, with a blank in front; empty without one.
    pub(super) fn as_flags(&self) -> String {
        let flag = |name: &str, value: Option<f32>| {
            value.map_or(String::new(), |value| format!(" --{name} {value}"))
        };
        flag("aperture", self.aperture) + &flag("focus-distance", self.focus_distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn args() -> LensArgs {
        LensArgs {
            projection: None,
            ortho_height: None,
            aperture: None,
            focus_distance: None,
        }
    }

    fn camera() -> Camera {
        Camera {
            name: String::new(),
            position: Vec3::new(0.0, 3.0, 4.0),
            focal_point: Vec3::ZERO,
            view_up: Vec3::Y,
            projection: Projection::Perspective { view_angle: 90.0 },
        }
    }

    #[test]
    fn parallel_rays_show_as_much_as_the_eye_did_at_its_focal_point() {
        let parallel = LensArgs {
            projection: Some(ProjectionName::Orthographic),
            ..args()
        };
        let Projection::Orthographic { height } = parallel.project(camera()).projection else {
            panic!("parallel rays were asked for");
        };
        assert!((height - 10.0).abs() < 1e-5, "{height}");
        assert_eq!(args().project(camera()), camera());
    }

    #[test]
    fn a_lens_is_sharp_at_the_focal_point_unless_told_otherwise() {
        let frame = camera().frame(30, 20).expect("it sees");
        assert_eq!(args().add_to(frame, &camera()), frame);
        let mut lens = args();
        lens.aperture = Some(0.5);
        let distance = |lens: &LensArgs| {
            let lens = lens.add_to(frame, &camera()).lens().expect("a lens");
            assert!((lens.radius - 0.5).abs() < 1e-9);
            lens.focus_distance
        };
        assert!((distance(&lens) - 5.0).abs() < 1e-6);
        lens.focus_distance = Some(2.0);
        assert!((distance(&lens) - 2.0).abs() < 1e-9);
        assert_eq!(lens.as_flags(), " --aperture 0.5 --focus-distance 2");
    }
}
