//! Scenes of loose triangles.

use bspray::geometry::Triangle;
use bspray::scene::{Instance, Part, Scene, TriangleMesh};
use glam::{DAffine3, Vec3};

use crate::random::Random;

/// Triangles as a mesh without shared vertices.
pub(crate) fn mesh_of(triangles: &[Triangle]) -> TriangleMesh {
    let count = triangles.len() as u32;
    TriangleMesh {
        positions: triangles.iter().flat_map(|t| *t.corners()).collect(),
        triangles: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        parts: vec![Part {
            first_triangle: 0,
            triangle_count: count,
            material: 0,
        }],
        ..TriangleMesh::default()
    }
}

/// Triangles where they are.
pub(crate) fn scene_of(triangles: &[Triangle]) -> Scene {
    Scene {
        meshes: vec![mesh_of(triangles)],
        instances: vec![Instance::new("", 0, DAffine3::IDENTITY)],
        materials: vec![bspray::scene::Material::default()],
        ..Scene::default()
    }
}

/// Random triangles on a small grid, so that much touches, is coplanar or coincides.
pub(crate) fn tangle(random: &mut Random, count: usize) -> Vec<Triangle> {
    let mut point = |_| Vec3::from_array([0; 3].map(|_| random.integer(0, 5) as f32));
    (0..count)
        .map(|_| {
            let [a, b, c] = [0; 3].map(&mut point);
            Triangle::new(a, b, c)
        })
        .collect()
}
