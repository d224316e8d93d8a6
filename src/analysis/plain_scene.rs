//! Scenes of triangles and nothing else, to ask methods about.

use glam::{DAffine3, DVec3};

use crate::scene::{Instance, Part, Scene, TriangleMesh};

/// A scene of one mesh, placed where it is.
pub(super) fn scene_of(positions: &[DVec3], triangles: &[[u32; 3]]) -> Scene {
    let mesh = TriangleMesh {
        positions: positions.iter().map(|p| p.as_vec3()).collect(),
        triangles: triangles.to_vec(),
        parts: vec![Part {
            first_triangle: 0,
            triangle_count: triangles.len() as u32,
            material: 0,
        }],
        ..TriangleMesh::default()
    };
    Scene {
        meshes: vec![mesh],
        instances: vec![Instance::new("", 0, DAffine3::IDENTITY)],
        ..Scene::default()
    }
}
