//! Surface and volume of meshes: what their extents are compared with.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};

use super::mesh::TriangleMesh;

/// How large a mesh is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshMeasure {
    /// Area of its triangles, in square units.
    pub surface: f64,
    /// The volume that it encloses, in cubic units; `None` if it does not: some edge is not used as often in one direction as in the other.
    pub volume: Option<f64>,
}

impl TriangleMesh {
    /// Surface and volume of the mesh where `map` places it, in double precision.
    ///
    /// Vertices at one place are one; the volume is that of the divergence theorem, so that what is enclosed twice counts twice.
    ///
    /// ```
    /// use bspray::scene::TriangleMesh;
    /// use glam::{DAffine3, DVec3, Vec3};
    /// // A tetrahedron of legs 1, 2 and 3, twice as wide.
    /// let mesh = TriangleMesh {
    ///     positions: vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::Y, 3.0 * Vec3::Z],
    ///     triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    ///     ..TriangleMesh::default()
    /// };
    /// let measure = mesh.measure(&DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0)));
    /// assert!((measure.volume.expect("it is closed") - 2.0).abs() < 1e-12);
    /// let slope = DVec3::new(6.0, 6.0, 4.0).length() / 2.0;
    /// assert!((measure.surface - (2.0 + 3.0 + 3.0 + slope)).abs() < 1e-12);
    /// ```
    pub fn measure(&self, map: &DAffine3) -> MeshMeasure {
        let places: Vec<DVec3> = self.positions.iter().map(|p| p.as_dvec3()).collect();
        let placed: Vec<DVec3> = places.iter().map(|p| map.transform_point3(*p)).collect();
        // A point near the mesh, since volumes of far tetrahedra would cancel.
        let middle = self.triangles.first().map(|t| placed[t[0] as usize]);
        let middle = middle.unwrap_or_default();
        let (mut surface, mut volume) = (0.0, 0.0);
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| placed[v as usize] - middle);
            surface += (b - a).cross(c - a).length() / 2.0;
            volume += a.dot(b.cross(c)) / 6.0;
        }
        MeshMeasure {
            surface,
            volume: self.is_closed().then_some(volume.abs()),
        }
    }

    /// Whether every edge is used as often in one direction as in the other, vertices at one place being one.
    fn is_closed(&self) -> bool {
        let mut names = HashMap::new();
        // Adding zero makes one of both zeros.
        let key = |p: &glam::Vec3| (*p + 0.0).to_array().map(f32::to_bits);
        let names: Vec<u32> = (0..)
            .zip(&self.positions)
            .map(|(vertex, p)| *names.entry(key(p)).or_insert(vertex))
            .collect();
        let mut balances: HashMap<(u32, u32), i64> = HashMap::new();
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| names[v as usize]);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (edge, sign) = if from < to {
                    ((from, to), 1)
                } else {
                    ((to, from), -1)
                };
                if from != to {
                    *balances.entry(edge).or_default() += sign;
                }
            }
        }
        !self.triangles.is_empty() && balances.values().all(|&balance| balance == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn an_open_mesh_has_no_volume_and_doubled_vertices_do_not_open_one() {
        let corners = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::Y, 3.0 * Vec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        // Three vertices of its own for each triangle, one zero being negative.
        let mut positions: Vec<Vec3> = faces
            .iter()
            .flatten()
            .map(|&v: &usize| corners[v])
            .collect();
        positions[0] = -Vec3::ZERO;
        let mesh = |triangles: usize| TriangleMesh {
            positions: positions.clone(),
            triangles: (0..triangles as u32)
                .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                .collect(),
            ..TriangleMesh::default()
        };
        // Far away, mirrored and sheared.
        let map = DAffine3 {
            matrix3: glam::DMat3::from_cols(
                DVec3::new(-1.0, 0.0, 0.0),
                DVec3::new(5.0, 1.0, 0.0),
                DVec3::new(0.0, 0.0, 7.0),
            ),
            translation: DVec3::splat(1e6),
        };
        let volume = mesh(4).measure(&map).volume.unwrap();
        assert!((volume - 7.0).abs() < 1e-6, "{volume}");
        assert_eq!(mesh(3).measure(&map).volume, None);
        assert_eq!(TriangleMesh::default().measure(&map).volume, None);
    }
}
