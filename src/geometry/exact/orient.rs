//! On which side of a plane a point of the input lies: Shewchuk's adaptive predicate, from the crate `robust`, which only this file names.

use glam::Vec3;

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
    let below = robust::orient3d(a, b, c, p);
    if below < 0.0 {
        Sign::Positive
    } else if below > 0.0 {
        Sign::Negative
    } else {
        Sign::Zero
    }
}
