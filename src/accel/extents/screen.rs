//! Screen extents: pixels outside of which no eye ray hits an object (the lecture's "Using Projection Extents").
//!
//! Only eye rays ([`RayOrigin::pixel`](crate::geometry::RayOrigin)) can be tested, and only those of the camera that the extent was built for. The lecture projects each point
//! of the cluster; where points lie behind the eye that gives nonsense. Here a column bounds the object if the plane through the eye and that column has all
//! points on one side, which is the same where all are before the eye, and right where they are not: a floor below the eye keeps its
//! horizon, and an object around the eye fills the screen.
//!
//! There is no lens here: with depth of field rays do not meet in the eye, and in a panorama there is no screen. Such cameras give no view, and their rays know no pixel.

use glam::{DVec3, Vec3};

use crate::geometry::Ray;
use crate::geometry::tolerance::{SCREEN_ERROR, U32};
use crate::scene::CameraFrame;

/// The camera that eye rays come from, for structures that are built for one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The camera.
    pub camera: CameraFrame,
    /// Width and height of the picture that it is for, in pixels.
    pub size: (u32, u32),
    /// How far eye rays may pass from the middle of their pixel, in pixels, along either axis: half the width of the pixel filter.
    pub filter_radius: f64,
}

impl View {
    /// Greatest tangents that an eye ray's angles may have (perspective), or greatest distances from the axis in model units, with a pixel to spare.
    fn reach(&self) -> [f64; 2] {
        let half = self.camera.half_size();
        let more = |half: f64, pixels: u32| {
            half * (1.0 + 2.0 * (self.filter_radius + 1.0) / f64::from(pixels))
        };
        [more(half.0, self.size.0), more(half.1, self.size.1)]
    }

    /// Distance of the farthest origin of an eye ray from `point`, in model units.
    pub(super) fn origin_distance(&self, point: DVec3) -> f64 {
        let [_, _, _, eye] = self.camera.world_from_camera();
        let [x, y] = if self.camera.is_perspective() {
            [0.0; 2]
        } else {
            self.reach()
        };
        (eye - point).length() + x + y
    }
}

/// The pixels whose eye rays may hit an object: columns and rows from the top left, all ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScreenExtent {
    /// Leftmost column; greater than `right` if no eye ray hits the object.
    pub left: u32,
    /// Rightmost column.
    pub right: u32,
    /// Topmost row.
    pub top: u32,
    /// Bottommost row.
    pub bottom: u32,
}

impl ScreenExtent {
    /// The extent of no pixel.
    pub const NOWHERE: Self = Self {
        left: 1,
        right: 0,
        top: 1,
        bottom: 0,
    };

    /// The extent of an object in the hull of `points`, or up to `margin` (model units) beside it, in world space.
    ///
    /// ```
    /// use bspray::accel::extents::{ScreenExtent, View};
    /// use bspray::scene::{Camera, Projection};
    /// use glam::Vec3;
    /// let camera = Camera {
    ///     name: String::new(),
    ///     position: Vec3::ZERO,
    ///     focal_point: Vec3::NEG_Z,
    ///     view_up: Vec3::Y,
    ///     projection: Projection::Perspective { view_angle: 90.0 },
    /// };
    /// let size = (200, 100);
    /// let view = View { camera: camera.frame(200, 100).expect("it sees"), size, filter_radius: 0.5 };
    /// // From the middle to half the way up, and a quarter of the height to the right.
    /// let points = [Vec3::new(0.0, 0.0, -2.0), Vec3::new(0.5, 1.0, -2.0)];
    /// let extent = ScreenExtent::new(&points, 0.0, &view);
    /// assert_eq!((extent.left, extent.right, extent.top, extent.bottom), (99, 112, 24, 50));
    /// assert!(extent.contains(105, 40) && !extent.contains(98, 40));
    /// ```
    pub fn new(points: &[Vec3], margin: f64, view: &View) -> Self {
        let [right, up, back, eye] = view.camera.world_from_camera();
        let seen = |p: &Vec3| {
            let p = p.as_dvec3() - eye;
            DVec3::new(p.dot(right), p.dot(up), -p.dot(back))
        };
        let seen: Vec<DVec3> = points.iter().map(seen).collect();
        let reach = view.reach();
        let (limits, error) = if view.camera.is_perspective() {
            let along = |axis: usize, sign: f64| {
                let points = seen.iter().map(|p| (sign * p[axis], p.z));
                sign * least_tangent(points, margin, reach[axis])
            };
            let error = SCREEN_ERROR * (1.0 + reach[0] * reach[0] + reach[1] * reach[1]);
            ([0, 1].map(|a| [along(a, 1.0), along(a, -1.0)]), error)
        } else {
            // Origins and directions of the rays are rounded: each by u a component.
            let far = seen.iter().fold(0.0, |far, p| p.z.abs().max(far));
            let start = eye.abs().max_element() + reach[0] + reach[1];
            let error = margin + 4.0 * f64::from(U32) * (start + far);
            if seen.iter().all(|p| p.z < -error) {
                return Self::NOWHERE;
            }
            let along = |axis: usize| {
                let ends = (f64::INFINITY, f64::NEG_INFINITY);
                let (min, max) = seen
                    .iter()
                    .fold(ends, |(a, b), p| (p[axis].min(a), p[axis].max(b)));
                [min, max]
            };
            ([along(0), along(1)], error)
        };
        let half = view.camera.half_size();
        let column = |x: f64| (x / half.0 + 1.0) * 0.5 * f64::from(view.size.0);
        let row = |y: f64| (1.0 - y / half.1) * 0.5 * f64::from(view.size.1);
        let radius = view.filter_radius;
        let first = |place: f64| (place - 0.5 - radius).ceil().max(0.0) as u32;
        let last = |place: f64| {
            let last = (place - 0.5 + radius).floor();
            (last >= 0.0).then_some(last as u32)
        };
        let [[x0, x1], [y0, y1]] = limits;
        let (Some(right), Some(bottom)) = (last(column(x1 + error)), last(row(y0 - error))) else {
            return Self::NOWHERE;
        };
        let (left, top) = (first(column(x0 - error)), first(row(y1 + error)));
        let (right, bottom) = (right.min(view.size.0 - 1), bottom.min(view.size.1 - 1));
        if left > right || top > bottom {
            return Self::NOWHERE;
        }
        Self {
            left,
            right,
            top,
            bottom,
        }
    }

    /// Whether the extent holds a pixel.
    pub fn contains(&self, column: u32, row: u32) -> bool {
        (self.left..=self.right).contains(&column) && (self.top..=self.bottom).contains(&row)
    }

    /// Number of its pixels.
    pub fn area(&self) -> u64 {
        let side = |first: u32, last: u32| u64::from((last + 1).saturating_sub(first));
        side(self.left, self.right) * side(self.top, self.bottom)
    }

    /// Whether screen extents can tell anything of the ray: it is an eye ray that does not go backwards too.
    #[inline]
    pub fn asks(ray: &Ray) -> bool {
        ray.source.pixel.is_some() && ray.source.depth == 0 && ray.interval.min >= 0.0
    }

    /// Whether the ray may hit what is in the extent. Rays of which it can tell nothing always may.
    #[inline]
    pub fn admits(&self, ray: &Ray) -> bool {
        let pixel = ray.source.pixel.filter(|_| Self::asks(ray));
        pixel.is_none_or(|(column, row)| self.contains(column, row))
    }
}

/// The greatest tangent `c` of at most `reach` such that all points (across, ahead), and all up to `margin` beside them, lie on the side `across >= c ahead`;
/// minus infinity if there is none. A ray of a lesser tangent, from the eye forwards, meets none of them.
fn least_tangent(points: impl Iterator<Item = (f64, f64)>, margin: f64, reach: f64) -> f64 {
    let (mut low, mut high) = (f64::NEG_INFINITY, reach);
    for (across, ahead) in points {
        // Moved by the margin, a point changes the difference by at most margin (1 + |c|).
        let across = across - margin * (1.0 + reach);
        if ahead > 0.0 {
            high = high.min(across / ahead);
        } else if ahead < 0.0 {
            low = low.max(across / ahead);
        } else if across < 0.0 {
            return f64::NEG_INFINITY;
        }
    }
    if low <= high { high } else { f64::NEG_INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Interval, RayOrigin};
    use crate::scene::{Camera, Projection};

    fn view(projection: Projection) -> View {
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 3.0),
            focal_point: Vec3::new(1.0, 2.0, -7.0),
            view_up: Vec3::Y,
            projection,
        };
        View {
            camera: camera.frame(320, 240).unwrap(),
            size: (320, 240),
            filter_radius: 1.5,
        }
    }

    const WIDE: Projection = Projection::Perspective { view_angle: 90.0 };

    /// Every ray that is sent through the filter of a pixel outside passes all the points' segments: checked at the segments' points.
    fn check(points: &[Vec3], view: &View) -> ScreenExtent {
        let extent = ScreenExtent::new(points, 0.0, view);
        let [right, up, back, eye] = view.camera.world_from_camera();
        let half = view.camera.half_size();
        for i in 0..points.len() {
            for j in 0..points.len() {
                for share in [0.0, 0.01, 0.3, 0.5] {
                    let p = points[i].as_dvec3().lerp(points[j].as_dvec3(), share) - eye;
                    let ahead = -p.dot(back);
                    let scale = if view.camera.is_perspective() {
                        ahead
                    } else {
                        1.0
                    };
                    if ahead <= 0.0 {
                        continue;
                    }
                    let x = (p.dot(right) / scale / half.0 + 1.0) * 160.0;
                    let y = (1.0 - p.dot(up) / scale / half.1) * 120.0;
                    for (column, row) in (0..320).flat_map(|c| (0..240).map(move |r| (c, r))) {
                        let is_near = |place: f64, pixel: u32| {
                            (place - f64::from(pixel) - 0.5).abs() <= view.filter_radius
                        };
                        if is_near(x, column) && is_near(y, row) {
                            assert!(extent.contains(column, row), "{p} at {x}, {y}: {extent:?}");
                        }
                    }
                }
            }
        }
        extent
    }

    #[test]
    fn objects_before_the_eye_fill_their_projection_and_the_filter() {
        for projection in [WIDE, Projection::Orthographic { height: 7.0 }] {
            let points = [
                Vec3::new(0.0, 1.5, -1.0),
                Vec3::new(2.5, 2.0, -2.0),
                Vec3::new(1.0, 3.0, 0.0),
            ];
            let extent = check(&points, &view(projection));
            assert!(
                extent.area() > 100 && extent.area() < 320 * 240 / 4,
                "{extent:?}"
            );
        }
    }

    #[test]
    fn a_floor_that_goes_on_behind_the_eye_ends_at_its_horizon() {
        let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        let floor = [
            corner(-50.0, -47.0),
            corner(50.0, -47.0),
            corner(50.0, 60.0),
            corner(-50.0, 60.0),
        ];
        let extent = check(&floor, &view(WIDE));
        // The far edge is 2 below the eye at a distance of 50: 0.04 of half the height.
        assert_eq!((extent.left, extent.right, extent.bottom), (0, 319, 239));
        assert!((122..=124).contains(&extent.top), "{extent:?}");
    }

    #[test]
    fn what_surrounds_the_eye_fills_the_screen_and_what_lies_behind_is_nowhere() {
        let around = |center: Vec3| -> Vec<Vec3> {
            let corner = |i: u32| {
                Vec3::new((i & 1) as f32, (i & 2) as f32, (i & 4) as f32) - Vec3::new(0.5, 1.0, 2.0)
            };
            (0..8).map(|i| center + corner(i)).collect()
        };
        let eye = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(check(&around(eye), &view(WIDE)).area(), 320 * 240);
        let behind = around(eye + Vec3::new(1.0, 1.0, 5.0));
        assert_eq!(check(&behind, &view(WIDE)), ScreenExtent::NOWHERE);
        let parallel = view(Projection::Orthographic { height: 4.0 });
        assert_eq!(check(&behind, &parallel), ScreenExtent::NOWHERE);
        let beside = around(eye + Vec3::new(300.0, 0.0, -5.0));
        assert_eq!(check(&beside, &view(WIDE)).area(), 0);
    }

    #[test]
    fn only_eye_rays_that_go_forward_are_tested() {
        let mut ray = Ray::new(Vec3::ZERO, Vec3::X);
        assert!(ScreenExtent::NOWHERE.admits(&ray));
        ray.source.pixel = Some((3, 4));
        assert!(!ScreenExtent::NOWHERE.admits(&ray));
        assert!(ScreenExtent::NOWHERE.admits(&ray.within(Interval::new(-1.0, 1.0))));
        ray.source = RayOrigin {
            depth: 1,
            ..ray.source
        };
        assert!(ScreenExtent::NOWHERE.admits(&ray));
    }
}
