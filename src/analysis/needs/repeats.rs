//! What a scene holds more than once: vertices and triangles of a mesh, and whole meshes.

use std::collections::{HashMap, HashSet};
use std::hash::Hash;

use crate::scene::{Scene, TriangleMesh};

/// What is there more than once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Repeats {
    /// For each mesh.
    pub meshes: Vec<MeshRepeats>,
}

/// What a mesh holds more than once, or in vain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshRepeats {
    /// Vertices that are the same as one before, in position and all attributes.
    pub vertices: u64,
    /// Vertices that no triangle uses.
    pub unused_vertices: u64,
    /// Triangles with the same three corners, in any order, as one before: no ray meets them first.
    pub triangles: u64,
    /// The first mesh with the same content, if it is not this one.
    pub same_as: Option<u32>,
}

impl Repeats {
    /// Looks at all vertices and triangles.
    pub fn of(scene: &Scene) -> Self {
        let mut meshes: Vec<MeshRepeats> = scene.meshes.iter().map(MeshRepeats::of).collect();
        let mut firsts: HashMap<(usize, usize), Vec<u32>> = HashMap::new();
        for (number, mesh) in scene.meshes.iter().enumerate() {
            let alike = (mesh.positions.len(), mesh.triangles.len());
            let firsts = firsts.entry(alike).or_default();
            let same = |&&first: &&u32| scene.meshes[first as usize].has_content_of(mesh);
            match firsts.iter().find(same) {
                Some(&first) => meshes[number].same_as = Some(first),
                None => firsts.push(number as u32),
            }
        }
        Self { meshes }
    }
}

impl MeshRepeats {
    fn of(mesh: &TriangleMesh) -> Self {
        let position = |v: u32| mesh.positions[v as usize].to_array().map(f32::to_bits);
        let vertex = |v: usize| mesh.vertex_bits(v).collect::<Vec<u32>>();
        let corners = |t: &[u32; 3]| {
            let mut corners = t.map(position);
            corners.sort_unstable();
            corners
        };
        let mut is_used = vec![false; mesh.positions.len()];
        let all = mesh.triangles.iter().flatten();
        all.for_each(|&v| is_used[v as usize] = true);
        Self {
            vertices: repeated((0..mesh.positions.len()).map(vertex)),
            unused_vertices: is_used.iter().filter(|used| !**used).count() as u64,
            triangles: repeated(mesh.triangles.iter().map(corners)),
            same_as: None,
        }
    }
}

/// How many came before.
fn repeated<T: Hash + Eq>(all: impl Iterator<Item = T>) -> u64 {
    let mut seen = HashSet::new();
    all.map(|one| u64::from(!seen.insert(one))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};

    #[test]
    fn what_is_there_twice_is_counted_in_any_order_of_corners() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ZERO, Vec3::X, Vec3::ONE];
        let mesh = TriangleMesh {
            positions: corners.to_vec(),
            // The first and the fourth differ in their texture coordinates, the second and the fifth in nothing.
            uv_sets: vec![
                (0..6)
                    .map(|i| Vec2::splat([0.0, 1.0, 2.0, 3.0, 1.0, 5.0][i]))
                    .collect(),
            ],
            triangles: vec![[0, 1, 2], [2, 0, 1], [3, 2, 4], [0, 2, 4]],
            ..TriangleMesh::default()
        };
        let other = TriangleMesh {
            name: "another name".to_owned(),
            ..mesh.clone()
        };
        let mut moved = mesh.clone();
        moved.positions[2] = Vec3::Z;
        let scene = Scene {
            meshes: vec![mesh, moved, other],
            ..Scene::default()
        };
        let repeats = Repeats::of(&scene).meshes;
        let one = MeshRepeats {
            vertices: 1,
            unused_vertices: 1,
            triangles: 3,
            same_as: None,
        };
        let again = MeshRepeats {
            same_as: Some(0),
            ..one
        };
        assert_eq!(repeats, [one, one, again]);
    }
}
