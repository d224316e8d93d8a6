//! Arguments that choose the camera.

use std::fmt::Write;

use anyhow::{Context, bail};
use bspray::accel::extents::View;
use bspray::render::{CameraWishes, frame_scene};
use bspray::scene::{Camera, Projection, Scene};
use clap::Args;
use glam::Vec3;

use super::values;

/// The camera. Without any of these it is the file's first camera, or else one that sees the whole scene.
#[derive(Args, Debug)]
#[command(next_help_heading = "Camera")]
pub(super) struct CameraArgs {
    /// A camera of the file, by its number from 0 or its name; `auto` for one that sees the whole scene
    #[arg(long, value_name = "N|NAME", conflicts_with_all = ["camera_position", "camera_focal_point", "camera_view_up",
        "camera_view_angle", "camera_direction"])]
    camera_index: Option<String>,
    /// Where the eye is
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    camera_position: Option<Vec3>,
    /// What the eye looks at
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    camera_focal_point: Option<Vec3>,
    /// What points upwards in the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true)]
    camera_view_up: Option<Vec3>,
    /// Angle between the picture's top and bottom, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::view_angle)]
    camera_view_angle: Option<f32>,
    /// Direction in which the eye looks
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true,
        conflicts_with = "camera_focal_point")]
    camera_direction: Option<Vec3>,
    /// The scene's upward axis
    #[arg(long, value_name = "AXIS", value_parser = values::axis, default_value = "+Y", allow_hyphen_values = true)]
    up: Vec3,
}

impl CameraArgs {
    /// The scene's upward axis.
    pub(super) fn up(&self) -> Vec3 {
        self.up
    }

    /// The camera for a picture of `size`.
    ///
    /// # Errors
    /// There is no such camera in the file.
    pub(super) fn choose(&self, scene: &Scene, size: (u32, u32)) -> anyhow::Result<Camera> {
        let wishes = CameraWishes {
            position: self.camera_position,
            focal_point: self.camera_focal_point,
            view_up: self.camera_view_up,
            view_angle: self.camera_view_angle,
            direction: self.camera_direction,
        };
        let automatic = || {
            frame_scene(
                scene,
                &wishes,
                self.up,
                f64::from(size.0) / f64::from(size.1),
            )
        };
        let has_wishes = wishes.position.is_some()
            || wishes.focal_point.is_some()
            || wishes.view_up.is_some()
            || wishes.view_angle.is_some()
            || wishes.direction.is_some();
        let camera = match self.camera_index.as_deref() {
            Some("auto") => automatic(),
            Some(wanted) => named_camera(scene, wanted)?.clone(),
            None if has_wishes => automatic(),
            None => scene.cameras.first().cloned().unwrap_or_else(automatic),
        };
        if camera.frame(size.0, size.1).is_none() {
            bail!(
                "the camera sees nothing: its position and focal point are one point, or its angle is impossible"
            );
        }
        Ok(camera)
    }
}

fn named_camera<'a>(scene: &'a Scene, wanted: &str) -> anyhow::Result<&'a Camera> {
    let by_number = wanted
        .parse::<usize>()
        .ok()
        .and_then(|n| scene.cameras.get(n));
    if let Some(camera) = by_number.or_else(|| scene.cameras.iter().find(|c| c.name == wanted)) {
        return Ok(camera);
    }
    if scene.cameras.is_empty() {
        bail!("--camera-index {wanted}: the models have no camera");
    }
    let list: Vec<_> = scene
        .cameras
        .iter()
        .enumerate()
        .map(|(i, c)| format!("{i} {:?}", c.name))
        .collect();
    bail!(
        "--camera-index {wanted}: no such camera; there are {}",
        list.join(", ")
    );
}

/// The camera as arguments that can be pasted to get the same picture.
pub(super) fn as_flags(camera: &Camera, scene: &Scene, up: Vec3) -> String {
    let comma = |v: Vec3| format!("{},{},{}", v.x, v.y, v.z);
    let place = format!(
        "--camera-position {} --camera-focal-point {} --camera-view-up {}",
        comma(camera.position),
        comma(camera.focal_point),
        comma(camera.view_up),
    );
    let index = scene.cameras.iter().position(|c| c == camera);
    let mut flags = match (camera.projection, index) {
        (Projection::Perspective { view_angle }, _) => {
            format!("{place} --camera-view-angle {view_angle}")
        }
        // By number: names may be shared, or need quotes.
        (Projection::Orthographic { .. }, Some(index)) => format!("--camera-index {index}"),
        (Projection::Orthographic { height }, None) => {
            format!("{place} --projection orthographic --ortho-height {height}")
        }
        (Projection::Panoramic, _) => format!("{place} --projection panoramic"),
    };
    let axes = ["+X", "-X", "+Y", "-Y", "+Z", "-Z"];
    if let Some(axis) = axes
        .into_iter()
        .find(|a| values::axis(a) == Ok(up))
        .filter(|a| *a != "+Y")
    {
        let _ = write!(flags, " --up {axis}");
    }
    flags
}

/// What a camera shows in a picture of this size.
///
/// # Errors
/// The camera is impossible.
pub(super) fn view(camera: &Camera, size: (u32, u32), filter_radius: f64) -> anyhow::Result<View> {
    Ok(View {
        camera: camera
            .frame(size.0, size.1)
            .context("the camera is impossible")?,
        size,
        filter_radius,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_keep_every_bit() {
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(0.1, -1e-7, 3.0),
            focal_point: Vec3::new(1.0 / 3.0, 2.0, 5e9),
            view_up: Vec3::Y,
            projection: Projection::Perspective { view_angle: 30.0 },
        };
        let flags = as_flags(&camera, &Scene::default(), Vec3::Z);
        let value = |name: &str| {
            flags
                .split(name)
                .nth(1)
                .and_then(|r| r.split_whitespace().next())
                .map(str::to_owned)
        };
        assert_eq!(
            values::vector(&value("--camera-position ").unwrap()),
            Ok(camera.position)
        );
        assert_eq!(
            values::vector(&value("--camera-focal-point ").unwrap()),
            Ok(camera.focal_point)
        );
        assert!(flags.ends_with("--camera-view-angle 30 --up +Z"), "{flags}");
    }
}
