//! The hull of points that all lie in one plane: Andrew's monotone chain ("Another efficient algorithm for convex hulls in two dimensions",
//! Information Processing Letters 9(5), 1979), in space.
//!
//! Points of a plane that are sorted by x, then y, then z are sorted along a line of the plane. Turns are decided without rounding, as sides of
//! the plane through two of the points and an apex beside the plane.

use glam::Vec3;

use crate::geometry::exact::{Sign, side_of_point};

/// Numbers of the points that span the hull. `order` is sorted by coordinates, without duplicates, and in one plane; the points of `plane` are
/// among them, and not on a line.
pub(super) fn vertices(points: &[Vec3], order: &[u32], plane: [u32; 3]) -> Vec<u32> {
    let corners = plane.map(|i| points[i as usize]);
    let apex = apex(corners);
    let is_left = |a: u32, b: u32, c: u32| {
        let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
        side_of_point([a, b, apex], c) == Sign::Negative
    };
    let half = |order: &mut dyn Iterator<Item = u32>| {
        let mut chain: Vec<u32> = Vec::new();
        for point in order {
            while let [.., a, b] = chain[..] {
                if is_left(a, b, point) {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain
    };
    let mut chain = half(&mut order.iter().copied());
    let back = half(&mut order.iter().rev().copied());
    // The ends belong to both.
    chain.extend(
        back.get(1..back.len().saturating_sub(1))
            .unwrap_or_default(),
    );
    chain
}

/// A point beside the plane through three that are not on a line.
fn apex(corners: [Vec3; 3]) -> Vec3 {
    let size = corners
        .iter()
        .fold(f32::MIN_POSITIVE, |m, p| m.max(p.abs().max_element()));
    let axes = Vec3::AXES.into_iter();
    let beside = axes.map(|axis| corners[0] + axis * 4.0 * size);
    // The corner itself lies in the plane, and three displacements along the axes cannot all lie in it.
    beside
        .into_iter()
        .find(|&p| side_of_point(corners, p) != Sign::Zero)
        .unwrap_or(corners[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_on_edge_keeps_its_corners_and_loses_the_rest() {
        let points = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 1.0),
            Vec3::new(0.0, 2.0, 2.0),
            Vec3::new(0.0, 2.0, 5.0),
            Vec3::new(0.0, 4.0, 4.0),
        ];
        // Sorted by coordinates; the first, second, third and last are on a line.
        let mut found = vertices(&points, &[0, 1, 2, 3, 4], [0, 4, 3]);
        found.sort_unstable();
        assert_eq!(found, [0, 3, 4]);
    }

    #[test]
    fn the_apex_lies_beside_planes_along_the_axes_and_far_off() {
        for corners in [
            [Vec3::ZERO, Vec3::X, Vec3::Y],
            [Vec3::X, Vec3::Y, Vec3::Z],
            [Vec3::splat(1e17), Vec3::new(1e17, 1e17, 0.0), Vec3::ZERO],
        ] {
            assert_ne!(side_of_point(corners, apex(corners)), Sign::Zero);
        }
    }
}
