//! The area that a point cluster's hull takes on the screen: what a screen extent, a box and a sphere are compared with.

use glam::{DVec2, Vec3};

use super::screen::View;

/// Area of the projected hull of `points` (world space), in pixels, in front of the image's borders and beyond them; `None` where a point is not
/// before the eye, whose projection has no area.
///
/// ```
/// use bspray::accel::extents::{View, projected_area};
/// use bspray::scene::{Camera, Projection};
/// use glam::Vec3;
/// let camera = Camera {
///     name: String::new(),
///     position: Vec3::ZERO,
///     focal_point: Vec3::NEG_Z,
///     view_up: Vec3::Y,
///     projection: Projection::Perspective { view_angle: 90.0 },
/// };
/// let view = View { camera: camera.frame(200, 100).expect("it sees"), size: (200, 100), filter_radius: 0.5 };
/// // A right triangle whose legs, at a distance of 2, are a quarter and half of the picture's height.
/// let points = [Vec3::new(0.0, 0.0, -2.0), Vec3::new(1.0, 0.0, -2.0), Vec3::new(0.0, 2.0, -2.0)];
/// let area = projected_area(&points, &view).expect("before the eye");
/// assert!((area - 25.0 * 50.0 / 2.0).abs() < 1e-3);
/// ```
pub fn projected_area(points: &[Vec3], view: &View) -> Option<f64> {
    let [right, up, back, eye] = view.camera.world_from_camera();
    let half = view.camera.half_size();
    let pixel = DVec2::new(f64::from(view.size.0), f64::from(view.size.1)) / 2.0;
    let place = |p: &Vec3| {
        let p = p.as_dvec3() - eye;
        let ahead = -p.dot(back);
        let distance = if view.camera.is_perspective() {
            ahead
        } else {
            1.0
        };
        let across = DVec2::new(p.dot(right) / half.0, p.dot(up) / half.1) / distance;
        (ahead > 0.0).then_some(across * pixel)
    };
    Some(hull_area(points.iter().map(place).collect::<Option<_>>()?))
}

/// Area of the convex hull of points in the plane (the monotone chain; Andrew 1979).
fn hull_area(mut points: Vec<DVec2>) -> f64 {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = &DVec2>| {
        let mut kept: Vec<DVec2> = Vec::new();
        for &p in points {
            while let [.., a, b] = kept[..] {
                if (b - a).perp_dot(p - b) > 0.0 {
                    break;
                }
                kept.pop();
            }
            kept.push(p);
        }
        let twice = kept.windows(2).map(|e| e[0].perp_dot(e[1]));
        twice.sum::<f64>()
    };
    (chain(&mut points.iter()) + chain(&mut points.iter().rev())) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_a_hull_is_that_of_its_corners_in_any_order() {
        let corner = |x: f64, y: f64| DVec2::new(x, y);
        // A trapezium of parallel sides 4 and 2, 3 apart, with points within and on its sides.
        let points = [
            corner(1.0, 3.0),
            corner(1.5, 1.0),
            corner(4.0, 0.0),
            corner(3.0, 3.0),
            corner(0.0, 0.0),
            corner(2.0, 0.0),
        ];
        assert!((hull_area(points.to_vec()) - 9.0).abs() < 1e-12);
        assert!((hull_area(points.iter().rev().copied().collect()) - 9.0).abs() < 1e-12);
        assert_eq!(hull_area(Vec::new()), 0.0);
        assert_eq!(hull_area(vec![DVec2::ONE; 3]), 0.0);
        assert_eq!(hull_area(vec![DVec2::ZERO, DVec2::ONE]), 0.0);
    }
}
