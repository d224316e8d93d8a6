//! Where points of the world fall on the screen, and which part of a line the screen shows.
//!
//! Camera space: x to the right, y up, z ahead, in model units, from the eye (or from the middle of the plane from which parallel rays start). Places on the
//! screen are in pixels from the top left corner.

use glam::{DVec2, DVec3, Vec3};

use crate::scene::CameraFrame;

/// Pixels beside the picture up to which lines are kept: more than half of the widest line and its end.
const MARGIN: f64 = 16.0;

/// A camera's map to the screen.
pub(super) struct ScreenMap {
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    eye: DVec3,
    half: DVec2,
    size: DVec2,
    is_perspective: bool,
}

impl ScreenMap {
    /// The map of a camera that was made ready for a picture of this size.
    pub(super) fn new(camera: &CameraFrame, size: (u32, u32)) -> Self {
        let [right, up, back, eye] = camera.world_from_camera();
        Self {
            right,
            up,
            forward: -back,
            eye,
            half: camera.half_size().into(),
            size: DVec2::new(size.0.into(), size.1.into()),
            is_perspective: camera.is_perspective(),
        }
    }

    /// Whether the rays meet in the eye.
    pub(super) fn is_perspective(&self) -> bool {
        self.is_perspective
    }

    /// A point of the world in camera space.
    pub(super) fn seen(&self, point: Vec3) -> DVec3 {
        let p = point.as_dvec3() - self.eye;
        DVec3::new(p.dot(self.right), p.dot(self.up), p.dot(self.forward))
    }

    /// The place of a point in camera space, which must lie ahead if the rays meet in the eye.
    pub(super) fn place(&self, point: DVec3) -> DVec2 {
        let across = if self.is_perspective {
            point.truncate() / point.z
        } else {
            point.truncate()
        };
        let across = across / self.half;
        DVec2::new(across.x + 1.0, 1.0 - across.y) * 0.5 * self.size
    }

    /// The ray through a place, in camera space: its origin, and its direction, of which z is 1.
    pub(super) fn ray(&self, place: DVec2) -> [DVec3; 2] {
        let across = place / self.size * 2.0 - 1.0;
        let across = (DVec2::new(across.x, -across.y) * self.half).extend(0.0);
        if self.is_perspective {
            [DVec3::ZERO, across + DVec3::Z]
        } else {
            [across, DVec3::Z]
        }
    }

    /// The part of a segment in camera space that the picture and a margin show; `None` if that is nothing.
    ///
    /// It is cut by the planes through the eye and the borders, all of which are ahead: no near plane is needed, and what is behind the eye is never
    /// divided by its depth.
    pub(super) fn clip(&self, ends: [DVec3; 2]) -> Option<[DVec3; 2]> {
        let reach = self.half * (1.0 + 2.0 * MARGIN / self.size);
        let inside = |p: DVec3| {
            let scale = if self.is_perspective { p.z } else { 1.0 };
            let [x, y] = [reach.x * scale, reach.y * scale];
            [x - p.x, x + p.x, y - p.y, y + p.y, p.z]
        };
        let [from, to] = ends.map(inside);
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for (a, b) in from.into_iter().zip(to) {
            if a < 0.0 && b < 0.0 {
                return None;
            }
            if a < 0.0 {
                first = first.max(a / (a - b));
            } else if b < 0.0 {
                last = last.min(a / (a - b));
            }
        }
        let cut = [first, last].map(|share| ends[0].lerp(ends[1], share));
        // A point at the eye has no place.
        let has_place = !self.is_perspective || cut.iter().all(|p| p.z > 0.0);
        (first <= last && has_place).then_some(cut)
    }

    /// The segment on the screen, cut as [`ScreenMap::clip`] does it.
    pub(super) fn segment(&self, ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
        let low = DVec2::splat(-2.0 * MARGIN);
        // The rounding of a cut next to the eye may throw a place anywhere.
        let place = |p| self.place(p).clamp(low, self.size - low);
        self.clip(ends).map(|cut| cut.map(place))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scene::{Camera, Projection};

    pub(in crate::render::overlay) const SIZE: (u32, u32) = (320, 200);

    pub(in crate::render::overlay) const PERSPECTIVE: Projection =
        Projection::Perspective { view_angle: 60.0 };

    pub(in crate::render::overlay) const PARALLEL: Projection =
        Projection::Orthographic { height: 7.0 };

    pub(in crate::render::overlay) fn frame(projection: Projection) -> CameraFrame {
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 6.0),
            focal_point: Vec3::new(0.4, 1.1, -1.0),
            view_up: Vec3::new(0.2, 1.0, 0.0),
            projection,
        };
        camera.frame(SIZE.0, SIZE.1).unwrap()
    }

    #[test]
    fn points_on_a_ray_fall_where_the_ray_goes_through_the_screen() {
        for projection in [PERSPECTIVE, PARALLEL] {
            let camera = frame(projection);
            let map = ScreenMap::new(&camera, SIZE);
            for (x, y, t) in [
                (31.0, 187.25, 3.0),
                (300.0, 11.0, 0.25),
                (160.0, 100.0, 40.0),
            ] {
                let ray = camera.ray(x, y, None);
                let point = map.seen(ray.origin + ray.direction * t);
                let place = map.place(point);
                assert!(place.distance(DVec2::new(x, y)) < 1e-3, "{place}");
                let [o, d] = map.ray(place);
                assert!((o + d * point.z - point).length() < 1e-9);
            }
        }
    }

    #[test]
    fn segments_end_where_they_leave_the_margin_or_the_world_ahead() {
        let map = ScreenMap::new(&frame(PERSPECTIVE), SIZE);
        // From 2 behind the eye to 8 ahead, 1 to the left: cut on the left border's plane.
        let ends = [DVec3::new(-1.0, 0.0, -2.0), DVec3::new(-1.0, 0.0, 8.0)];
        let [a, b] = map.segment(ends).unwrap();
        assert!((a - DVec2::new(-MARGIN, 100.0)).length() < 1e-9, "{a}");
        assert!((b - map.place(ends[1])).length() < 1e-9);
        assert!(map.segment([ends[0], ends[0] + DVec3::X]).is_none());
        assert!(map.segment(ends.map(|p| p - DVec3::X * 90.0)).is_none());
        // Through the eye.
        assert!(map.segment([DVec3::NEG_Z, DVec3::Z]).is_none());
        let map = ScreenMap::new(&frame(PARALLEL), SIZE);
        let [a, b] = map.clip(ends).unwrap();
        assert_eq!((a.z, b), (0.0, ends[1]));
    }
}
