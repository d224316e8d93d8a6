//! Shading normals where a file has none: the mean of the faces around a corner that belong together.
//!
//! Faces belong together if they are in one smoothing group of an OBJ file (`s`), or if they meet at no more than the crease angle that the user asks for.
//! Each counts by its angle at the corner (Thuermer and Wuthrich 1998), so that the result does not depend on how polygons are cut into triangles.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::scene::TriangleMesh;

/// Corners at one place up to which they are compared with one another; where more meet, they stay flat. The time grows with its square. Larger: models whose
/// vertices are all at one place take hours; smaller: tips of finely cut cones have edges.
const MOST_AT_A_PLACE: usize = 2048;

/// A corner without a normal, and where it is.
struct Corner {
    place: [u32; 3],
    triangle: u32,
    number: u8,
}

/// Gives corners without a normal those of the faces around that belong together. `groups` has each triangle's smoothing group, 0 for none, or is
/// empty; `crease_angle` is in degrees.
///
/// Vertices get copies where their corners differ; vertices at one place count as one.
pub(super) fn smooth(mesh: &mut TriangleMesh, groups: &[u32], crease_angle: Option<f32>) {
    if crease_angle.is_none() && groups.iter().all(|&group| group == 0) {
        return;
    }
    mesh.normals.resize(mesh.positions.len(), Vec3::ZERO);
    let cosine = crease_angle.map(|degrees| libm::cos(f64::from(degrees).to_radians()));
    let faces: Vec<DVec3> = (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = corners(mesh, t);
            (b - a).cross(c - a).normalize_or_zero()
        })
        .collect();
    let group = |t: u32| groups.get(t as usize).copied().unwrap_or(0);
    let belong_together = |a: u32, b: u32| {
        let [m, n] = [a, b].map(|t| faces[t as usize]);
        a == b
            || (group(a) != 0 && group(a) == group(b))
            || cosine.is_some_and(|cosine| m.dot(n) >= cosine)
    };
    let mut bare = bare_corners(mesh);
    bare.sort_unstable_by_key(|c| (c.place, c.triangle, c.number));
    let mut vertices = Vertices {
        is_set: vec![false; mesh.positions.len()],
        copies: HashMap::new(),
    };
    for together in bare.chunk_by(|a, b| a.place == b.place) {
        if together.len() > MOST_AT_A_PLACE {
            continue;
        }
        let weighted: Vec<DVec3> = together
            .iter()
            .map(|c| faces[c.triangle as usize] * angle(mesh, c))
            .collect();
        for corner in together {
            let around = together.iter().zip(&weighted);
            let around = around.filter(|(c, _)| belong_together(c.triangle, corner.triangle));
            let sum: DVec3 = around.map(|(_, normal)| normal).sum();
            vertices.set(mesh, corner, sum.normalize_or_zero().as_vec3());
        }
    }
    if mesh.normals.iter().all(|n| *n == Vec3::ZERO) {
        mesh.normals.clear();
    }
}

fn corners(mesh: &TriangleMesh, triangle: usize) -> [DVec3; 3] {
    mesh.triangles[triangle].map(|v| mesh.positions[v as usize].as_dvec3())
}

/// The corners that have no normal.
fn bare_corners(mesh: &TriangleMesh) -> Vec<Corner> {
    let mut bare = Vec::new();
    for (triangle, vertices) in (0..).zip(&mesh.triangles) {
        for (number, &vertex) in (0..).zip(vertices) {
            if mesh.normals[vertex as usize] == Vec3::ZERO {
                // Adding zero makes one of both zeros.
                let place = mesh.positions[vertex as usize] + 0.0;
                bare.push(Corner {
                    place: place.to_array().map(f32::to_bits),
                    triangle,
                    number,
                });
            }
        }
    }
    bare
}

/// The triangle's angle at a corner, in radians; 0 where it has none.
fn angle(mesh: &TriangleMesh, corner: &Corner) -> f64 {
    let points = corners(mesh, corner.triangle as usize);
    let at = |offset: usize| points[(usize::from(corner.number) + offset) % 3];
    let (to, other) = (at(1) - at(0), at(2) - at(0));
    let angle = libm::atan2(to.cross(other).length(), to.dot(other));
    if angle.is_finite() { angle } else { 0.0 }
}

/// The mesh's vertices while they get their normals.
struct Vertices {
    is_set: Vec<bool>,
    copies: HashMap<(u32, [u32; 3]), u32>,
}

impl Vertices {
    /// Gives a corner its normal: at its vertex, or at a copy of it if that has another one already.
    fn set(&mut self, mesh: &mut TriangleMesh, corner: &Corner, normal: Vec3) {
        let name = &mut mesh.triangles[corner.triangle as usize][usize::from(corner.number)];
        let vertex = *name as usize;
        if !std::mem::replace(&mut self.is_set[vertex], true) {
            mesh.normals[vertex] = normal;
            return;
        }
        let bits = |n: Vec3| n.to_array().map(f32::to_bits);
        if bits(mesh.normals[vertex]) == bits(normal) {
            return;
        }
        *name = *self
            .copies
            .entry((vertex as u32, bits(normal)))
            .or_insert_with(|| {
                mesh.positions.push(mesh.positions[vertex]);
                mesh.normals.push(normal);
                if !mesh.tangents.is_empty() {
                    mesh.tangents.push(mesh.tangents[vertex]);
                }
                if !mesh.colors.is_empty() {
                    mesh.colors.push(mesh.colors[vertex]);
                }
                for set in mesh.uv_sets.iter_mut().filter(|s| !s.is_empty()) {
                    set.push(set[vertex]);
                }
                mesh.positions.len() as u32 - 1
            });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Part;
    use glam::{Vec2, Vec4};

    /// A rectangle of two triangles and a right triangle that meet at the y axis, at an angle of 60 degrees between their normals.
    fn fold() -> TriangleMesh {
        let (sine, cosine) = (0.75_f32.sqrt(), 0.5);
        TriangleMesh {
            positions: vec![
                Vec3::ZERO,
                2.0 * Vec3::Y,
                Vec3::new(-3.0, 2.0, 0.0),
                Vec3::new(-3.0, 0.0, 0.0),
                Vec3::new(4.0 * cosine, 0.0, -4.0 * sine),
            ],
            uv_sets: vec![Vec::new(), vec![Vec2::ONE; 5]],
            colors: vec![Vec4::ONE; 5],
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 4, 1]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 3,
                material: 0,
            }],
            ..TriangleMesh::default()
        }
    }

    /// The normals at both ends of the fold, seen from either side.
    fn at_fold(mesh: &TriangleMesh) -> [[Vec3; 2]; 2] {
        let normal = |t: usize, c: usize| mesh.normals[mesh.triangles[t][c] as usize];
        [[normal(0, 0), normal(0, 1)], [normal(2, 0), normal(2, 2)]]
    }

    const FLAT: Vec3 = Vec3::Z;

    fn folded() -> Vec3 {
        Vec3::new(0.75_f32.sqrt(), 0.0, 0.5)
    }

    #[test]
    fn faces_within_the_crease_angle_share_their_normals() {
        let mut mesh = fold();
        smooth(&mut mesh, &[], Some(60.1));
        assert_eq!((mesh.validate(), mesh.positions.len()), (Ok(()), 5));
        let [[left, left_end], [right, right_end]] = at_fold(&mesh);
        assert_eq!((left, left_end), (right, right_end));
        // A right angle on either side counts the same, though one is cut in two.
        let middle = (FLAT + folded()).normalize();
        assert!((left - middle).length() < 1e-6);
        // At the other end a right angle meets one of atan(4 / 2).
        let weighted =
            (FLAT * std::f32::consts::FRAC_PI_2 + folded() * libm::atanf(2.0)).normalize();
        assert!((left_end - weighted).length() < 1e-6);
    }

    #[test]
    fn a_crease_splits_its_vertices_with_all_that_they_carry() {
        let mut mesh = fold();
        smooth(&mut mesh, &[], Some(59.9));
        assert_eq!((mesh.validate(), mesh.positions.len()), (Ok(()), 7));
        assert_eq!((mesh.uv_sets[1].len(), mesh.colors.len()), (7, 7));
        for (side, own) in at_fold(&mesh).into_iter().zip([FLAT, folded()]) {
            assert!(side.iter().all(|n| (*n - own).length() < 1e-6), "{side:?}");
        }
    }

    #[test]
    fn groups_are_smooth_at_any_angle_and_others_flat() {
        for (groups, is_smooth) in [([7, 7, 7], true), ([7, 7, 1], false), ([0, 0, 0], false)] {
            let mut mesh = fold();
            smooth(&mut mesh, &groups, None);
            let is_flat = mesh.normals.is_empty() || at_fold(&mesh)[0] != at_fold(&mesh)[1];
            assert_eq!(is_flat, !is_smooth, "{groups:?}");
        }
    }

    #[test]
    fn given_normals_stay_and_broken_faces_spoil_none() {
        let mut mesh = fold();
        mesh.normals = vec![Vec3::ZERO; 5];
        mesh.normals[0] = Vec3::X;
        mesh.positions.extend([Vec3::NAN, Vec3::INFINITY]);
        mesh.normals.extend([Vec3::ZERO; 2]);
        mesh.uv_sets[1].extend([Vec2::ZERO; 2]);
        mesh.colors.extend([Vec4::ONE; 2]);
        mesh.triangles.push([1, 5, 6]);
        mesh.parts[0].triangle_count = 4;
        smooth(&mut mesh, &[1; 4], None);
        let [[left, left_end], [right, right_end]] = at_fold(&mesh);
        assert_eq!([left, right], [Vec3::X; 2]);
        assert!(left_end == right_end && left_end.is_normalized());
    }

    #[test]
    fn very_many_corners_at_one_place_stay_flat() {
        let count = 3000;
        let mut mesh = TriangleMesh::default();
        for i in 0..count {
            let first = mesh.positions.len() as u32;
            let y = i as f32;
            mesh.positions
                .extend([Vec3::ZERO, Vec3::new(1.0, y, 0.0), Vec3::new(1.0, y, 1.0)]);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        smooth(&mut mesh, &[], Some(180.0));
        assert_eq!(mesh.normals[0], Vec3::ZERO);
        assert!(mesh.normals[1].is_normalized());
    }
}
