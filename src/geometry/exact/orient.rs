//! On which side of a plane, or of a line in a plane, a point of the input lies: Shewchuk's adaptive predicate, from the crate `robust`, which only this file names.

use glam::{DVec2, Vec3};

use super::Sign;

/// The side of the plane through `a`, `b`, `c` on which `p` lies: positive where these run counter-clockwise. Without rounding:
/// sums and products of three `f32` neither overflow nor underflow in the `f64` terms of the predicate.
///
/// ```
/// use bspray::geometry::exact::{Sign, side_of_point};
/// use glam::Vec3;
/// let plane = [Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)];
/// assert_eq!(side_of_point(plane, Vec3::new(9.0, 9.0, f32::from_bits(1))), Sign::Positive);
/// assert_eq!(side_of_point(plane, Vec3::new(9.0, 9.0, 0.0)), Sign::Zero);
/// ```
pub fn side_of_point(plane: [Vec3; 3], p: Vec3) -> Sign {
    let [a, b, c, p] = [plane[0], plane[1], plane[2], p].map(|p| robust::Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    });
    // Theirs is positive below the plane.
    sign(-robust::orient3d(a, b, c, p))
}

/// The side of the line from `a` to `b` on which `p` lies: positive where `a`, `b`, `p` run counter-clockwise. Without rounding where
/// products of two differences of coordinates neither overflow nor underflow.
///
/// ```
/// use bspray::geometry::exact::{Sign, side_of_line};
/// use glam::DVec2;
/// let line = [DVec2::new(0.1, 0.1), DVec2::new(0.3, 0.3)];
/// assert_eq!(side_of_line(line, DVec2::new(0.7, 0.7)), Sign::Zero);
/// assert_eq!(side_of_line(line, DVec2::new(0.7, 0.7_f64.next_up())), Sign::Positive);
/// ```
pub fn side_of_line(line: [DVec2; 2], p: DVec2) -> Sign {
    let [a, b, p] = [line[0], line[1], p].map(|p| robust::Coord { x: p.x, y: p.y });
    sign(robust::orient2d(a, b, p))
}

fn sign(value: f64) -> Sign {
    if value > 0.0 {
        Sign::Positive
    } else if value < 0.0 {
        Sign::Negative
    } else {
        Sign::Zero
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_a_slope_are_told_from_it_at_every_scale() {
        for scale in [1e-30, 1.0, 3e9, 1e18] {
            let plane = [[0.0, 0.0, 0.0], [3.0, 0.0, 1.0], [0.0, 2.0, 1.0]]
                .map(|p| Vec3::from_array(p) * scale);
            let p = plane[1] * 0.5;
            assert_eq!(side_of_point(plane, p), Sign::Zero);
            assert_eq!(
                side_of_point(plane, p.with_z(p.z.next_up())),
                Sign::Positive
            );
            assert_eq!(
                side_of_point(plane, p.with_z(p.z.next_down())),
                Sign::Negative
            );
        }
    }

    #[test]
    fn a_turned_plane_has_its_sides_exchanged() {
        let [a, b, c] = [
            Vec3::ZERO,
            Vec3::new(3.0, 0.0, 0.0),
            Vec3::new(0.0, 2.0, 0.0),
        ];
        let least = Vec3::new(7.0, -5.0, f32::from_bits(1));
        assert_eq!(side_of_point([a, b, c], least), Sign::Positive);
        assert_eq!(side_of_point([a, c, b], least), Sign::Negative);
        assert_eq!(side_of_point([b, c, a], least), Sign::Positive);
    }
}
