//! Many rays of a pinhole at once, in loops that are compiled for several sets of instructions. World space; places on the picture as in the folder's file.

use glam::Vec3;
use multiversion::multiversion;

use super::{CameraFrame, Shape};
use crate::geometry::LANES;

/// A camera whose rays all begin at the eye and go through a plane screen.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole<'a>(&'a CameraFrame);

impl CameraFrame {
    /// The camera, if it is one without a lens whose rays go from the eye through a screen.
    pub fn pinhole(&self) -> Option<Pinhole<'_>> {
        let is_pinhole = self.shape == Shape::Perspective && self.lens.is_none();
        is_pinhole.then_some(Pinhole(self))
    }
}

impl Pinhole<'_> {
    /// Where all rays begin.
    pub fn eye(&self) -> Vec3 {
        self.0.origin.as_vec3()
    }

    /// The directions of the rays through as many screen positions, in pixels, as there are lanes: all x, all y and all z, each as
    /// [`CameraFrame::ray`] has it, bit for bit.
    pub fn directions(&self, x: &[f64; LANES], y: &[f64; LANES]) -> [[f32; LANES]; 3] {
        directions(self.0, x, y)
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq", "x86_64+avx2"))]
fn directions(frame: &CameraFrame, x: &[f64; LANES], y: &[f64; LANES]) -> [[f32; LANES]; 3] {
    let vectors = [frame.forward, frame.right, frame.up].map(|v| v.to_array());
    let mut all = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let right = (x[lane] * frame.scale.0 - 1.0) * frame.half.0;
        let up = (1.0 - y[lane] * frame.scale.1) * frame.half.1;
        let along = |axis: usize| {
            let [forward, rightwards, upwards] = vectors.map(|v| v[axis]);
            forward + (rightwards * right + upwards * up)
        };
        let [x, y, z] = [along(0), along(1), along(2)];
        let reciprocal = 1.0 / (x * x + y * y + z * z).sqrt();
        all[0][lane] = (x * reciprocal) as f32;
        all[1][lane] = (y * reciprocal) as f32;
        all[2][lane] = (z * reciprocal) as f32;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::tests::camera;
    use super::*;
    use crate::scene::{Camera, Projection};

    #[test]
    fn directions_in_lanes_are_those_of_each() {
        let turned = Camera {
            position: Vec3::new(-3.1, 0.7, 12.3),
            focal_point: Vec3::new(2.9, -1.3, 0.1),
            ..camera(Projection::Perspective { view_angle: 53.0 })
        };
        let frame = turned.frame(641, 357).expect("valid");
        let pinhole = frame.pinhole().expect("a pinhole");
        for row in 0..40 {
            let x = std::array::from_fn(|i| 41.37 * i as f64 - 7.0);
            let y = std::array::from_fn(|i| 9.11 * f64::from(row) + 0.01 * i as f64);
            let all = pinhole.directions(&x, &y);
            for lane in 0..LANES {
                let ray = frame.ray(x[lane], y[lane], None);
                assert_eq!(ray.direction.to_array(), all.map(|d| d[lane]));
                assert_eq!(ray.origin, pinhole.eye());
            }
        }
        let parallel = camera(Projection::Orthographic { height: 4.0 }).frame(9, 9);
        assert!(parallel.expect("valid").pinhole().is_none());
    }
}
