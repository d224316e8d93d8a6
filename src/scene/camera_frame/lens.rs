//! Rays through a thin lens: what lies in its plane of focus is sharp. World space; places on the picture as in the folder's file.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::{CameraFrame, Shape};
use crate::geometry::Ray;
use crate::scene::Lens;

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
    use crate::scene::Projection;
    use crate::scene::camera_frame::tests::camera;
    use glam::Vec3;

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
}
