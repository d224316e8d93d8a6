//! From the world to the picture: the way back of an eye ray. Pixels from the top left corner, x to the right and y down.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use super::{CameraFrame, Shape};

impl CameraFrame {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Projection;
    use crate::scene::camera_frame::tests::camera;

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
}
