//! The axes of a tree: those of the space, or those of its polygons' own planes.
//!
//! Where most of the surface lies in planes at right angles to each other but not to the axes (a building that was turned), boxes along the
//! dominant normals hold it much more tightly. Such a tree is built from turned corners, and rays are turned for the walk; triangles are hit as they
//! are. Any matrix would do, since a line and a polygon that meet still meet after it; only what is rounded counts
//! ([`TURNED_WALK_ERROR`](crate::geometry::tolerance::TURNED_WALK_ERROR)).

use glam::{DMat3, DVec3, Mat3, Vec3, Vec4};

use crate::geometry::Triangle;

/// A matrix that takes the triangles' space to the tree's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    /// Its columns.
    columns: [Vec4; 3],
}

/// Greatest share of the extents' area along the space's axes that own axes may leave: turning rays costs about 3 ns of 50 to 300.
const GREATEST_SHARE: f64 = 0.9;

/// Cells along each side of the map of directions: about 2 degrees wide.
const CELLS: usize = 64;

/// Triangles that are looked at, about, where there are more.
const SAMPLE: usize = 1 << 17;

/// Cosine of the greatest angle, 3 degrees, of normals that count as one direction.
const ALIKE: f64 = 0.998_6;

/// Sine of the same angle.
const ACROSS: f64 = 0.052_3;

impl Axes {
    /// Those of the dominant normals, if the triangles' extents along them are much smaller.
    pub(super) fn of_dominant_normals<'a>(
        triangles: impl ExactSizeIterator<Item = &'a Triangle> + Clone,
    ) -> Option<Self> {
        // Odd, so that it passes over neither half of rectangles.
        let step = (triangles.len() / SAMPLE) | 1;
        let triangles = triangles.step_by(step);
        let normals = triangles.clone().map(area_vector);
        let first = dominant(normals.clone(), |_| true)?;
        let second = dominant(normals, |n| n.dot(first).abs() <= ACROSS * n.length())
            .unwrap_or_else(|| first.any_orthogonal_vector());
        let second = second.reject_from_normalized(first).try_normalize()?;
        let turn = DMat3::from_cols(first, second, first.cross(second)).transpose();
        let axes = Self::new(turn.as_mat3());
        let turned: f64 = triangles.clone().map(|t| axes.extent_area(t)).sum();
        let plain: f64 = triangles
            .map(|t| half_area(t.corners().iter().map(|p| p.as_dvec3())))
            .sum();
        (turned < GREATEST_SHARE * plain).then_some(axes)
    }

    /// From a rotation.
    pub(super) fn new(turn: Mat3) -> Self {
        Self {
            columns: [turn.x_axis, turn.y_axis, turn.z_axis].map(|c| c.extend(0.0)),
        }
    }

    /// A corner in the tree's space: computed in `f64`, rounded once.
    pub(super) fn corner(&self, p: Vec3) -> Vec3 {
        self.exact(p).as_vec3()
    }

    fn exact(&self, p: Vec3) -> DVec3 {
        let [x, y, z] = self.columns.map(|c| c.truncate().as_dvec3());
        let p = p.as_dvec3();
        x * p.x + y * p.y + z * p.z
    }

    /// A ray's origin or direction in the tree's space, in `f32`.
    #[inline(always)]
    pub(super) fn turn(&self, v: Vec4) -> Vec4 {
        let [x, y, z] = self.columns;
        x * v.x + y * v.y + z * v.z
    }

    fn extent_area(&self, triangle: &Triangle) -> f64 {
        half_area(triangle.corners().iter().map(|&p| self.exact(p)))
    }
}

/// Half the area of the box around the points.
fn half_area(points: impl Iterator<Item = DVec3> + Clone) -> f64 {
    let low = points.clone().fold(DVec3::INFINITY, DVec3::min);
    let high = points.fold(DVec3::NEG_INFINITY, DVec3::max);
    let size = high - low;
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// Normal to the triangle, as long as its area.
fn area_vector(triangle: &Triangle) -> DVec3 {
    let [a, b, c] = triangle.corners().map(|p| p.as_dvec3());
    0.5 * (b - a).cross(c - a)
}

/// The direction, up to its sign, in which most area of those normals points which `counts` lets pass; of unit length.
fn dominant(
    normals: impl Iterator<Item = DVec3> + Clone,
    counts: impl Fn(DVec3) -> bool,
) -> Option<DVec3> {
    let normals = normals.filter(|&n| n.is_finite() && n != DVec3::ZERO && counts(n));
    let mut areas = vec![0.0_f64; CELLS * CELLS];
    for normal in normals.clone() {
        areas[cell(normal)] += normal.length();
    }
    let most = (0..areas.len()).max_by(|&a, &b| areas[a].total_cmp(&areas[b]))?;
    let in_cell = normals.clone().filter(|&n| cell(n) == most);
    let middle = mean(in_cell)?;
    // Again with all that is near, since a direction may lie on the border of cells.
    mean(normals.filter(|n| n.dot(middle).abs() >= ALIKE * n.length()))
}

/// The mean direction of normals whose sign does not matter, all of them near each other.
fn mean(mut normals: impl Iterator<Item = DVec3>) -> Option<DVec3> {
    let first = normals.next()?;
    normals
        .fold(
            first,
            |sum, n| if n.dot(first) < 0.0 { sum - n } else { sum + n },
        )
        .try_normalize()
}

/// The cell of the map, an octahedron's upper half unfolded to a square, that the direction or its opposite lies in.
fn cell(normal: DVec3) -> usize {
    let n = if normal.z < 0.0 { -normal } else { normal };
    let n = n / (n.x.abs() + n.y.abs() + n.z);
    let place = |x: f64| (((x + 1.0) * 0.5 * CELLS as f64) as usize).min(CELLS - 1);
    place(n.x + n.y) * CELLS + place(n.x - n.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The faces of a box of 1 x 2 x 3, turned.
    fn brick(turn: DMat3) -> Vec<Triangle> {
        let corner = |i: usize| {
            let bit = |k: usize| (i >> k & 1) as f64;
            (turn * DVec3::new(bit(0), 2.0 * bit(1), 3.0 * bit(2))).as_vec3()
        };
        let quads = [
            [0, 1, 3, 2],
            [4, 6, 7, 5],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 5, 7, 3],
        ];
        let halves = quads.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        halves
            .into_iter()
            .flatten()
            .map(|t| {
                let [a, b, c] = t.map(corner);
                Triangle::new(a, b, c)
            })
            .collect()
    }

    #[test]
    fn a_turned_brick_gets_its_own_axes_and_an_upright_one_none() {
        assert!(Axes::of_dominant_normals(brick(DMat3::IDENTITY).iter()).is_none());
        let turn = DMat3::from_axis_angle(DVec3::ONE.normalize(), 0.5);
        let bricks = brick(turn);
        let axes = Axes::of_dominant_normals(bricks.iter()).unwrap();
        let total: f64 = bricks.iter().map(|t| axes.extent_area(t)).sum();
        // Boxes without volume: twice the brick's surface, since a face's box is as large as the face and holds two triangles.
        assert!((total - 44.0).abs() < 1e-4, "{total}");
        let [x, y, z] = axes.columns.map(Vec4::truncate);
        let gram = Mat3::from_cols(x, y, z);
        assert!((gram.determinant() - 1.0).abs() < 1e-6);
        let p = Vec3::new(0.3, -7.0, 2.0);
        assert!((axes.turn(p.extend(0.0)).truncate() - axes.corner(p)).length() < 1e-5);
    }

    #[test]
    fn opposite_normals_lie_in_one_cell() {
        for n in [
            DVec3::new(1.0, 2.0, 3.0),
            DVec3::new(-3.0, 1.0, 0.5),
            DVec3::new(0.1, -2.0, 7.0),
        ] {
            assert_eq!(cell(n), cell(-n));
        }
    }

    #[test]
    fn what_has_no_area_has_no_axes() {
        let point = Triangle::new(Vec3::ONE, Vec3::ONE, Vec3::ONE);
        assert!(Axes::of_dominant_normals([point].iter()).is_none());
    }
}
