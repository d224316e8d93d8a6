//! Vertices that a mesh holds several times become one.
//!
//! Files without indices have three vertices for each triangle, six times as many as a closed surface needs, and no two of its triangles are known to be neighbours. Vertices are the same where position and all attributes are, bit for bit.

use std::collections::HashMap;
use std::collections::hash_map::{DefaultHasher, Entry};
use std::hash::{Hash, Hasher};
use std::path::Path;

use rayon::prelude::*;

use super::line::one_line;
use crate::scene::{Note, Scene, TriangleMesh};

/// Triangles from which on vertices are joined: a small mesh saves little.
const LEAST_TRIANGLES: usize = 1000;

/// Vertices a triangle from which on some are likely to be the same: a surface with indices has about half as many as triangles.
const LEAST_VERTICES: usize = 2;

/// Vertices of a mesh that are looked at first; where fewer than one of [`LEAST_SHARE`] is there again, the others are not.
const LOOKED_AT: usize = 3072;
const LEAST_SHARE: usize = 20;

/// Joins the vertices, with a note for each mesh that had any.
pub(super) fn join_vertices(scene: &mut Scene, file: &Path) {
    let joined: Vec<usize> = scene
        .meshes
        .par_iter_mut()
        .with_max_len(1)
        .map(join)
        .collect();
    for (mesh, joined) in scene.meshes.iter().zip(joined).filter(|(_, j)| *j > 0) {
        let all = mesh.positions.len() + joined;
        scene.notes.push(Note {
            file: file.to_owned(),
            element: one_line(format!("mesh {:?}", mesh.name)),
            text: format!("{joined} of {all} vertices are the same as others: joined with them"),
        });
    }
}

/// Joins the vertices of a mesh. Gives how many went.
fn join(mesh: &mut TriangleMesh) -> usize {
    let all = mesh.positions.len();
    let triangles = mesh.triangles.len();
    if triangles < LEAST_TRIANGLES || all < LEAST_VERTICES * triangles {
        return 0;
    }
    let some = all.min(LOOKED_AT);
    if some - firsts(mesh, some).1.len() < some.div_ceil(LEAST_SHARE) {
        return 0;
    }
    let (new_names, kept) = firsts(mesh, all);
    let mut triangles = std::mem::take(&mut mesh.triangles);
    triangles
        .iter_mut()
        .flatten()
        .for_each(|v| *v = new_names[*v as usize]);
    *mesh = TriangleMesh {
        triangles,
        parts: std::mem::take(&mut mesh.parts),
        outlines: std::mem::take(&mut mesh.outlines),
        ..mesh.with_vertices(&kept)
    };
    all - kept.len()
}

/// For each of the first `count` vertices its place among those that are not the same as one before, and these.
fn firsts(mesh: &TriangleMesh, count: usize) -> (Vec<u32>, Vec<u32>) {
    // By their hash, the place of the last that has it; before it come others.
    let mut places: HashMap<u64, u32> = HashMap::with_capacity(count);
    let (mut kept, mut before) = (Vec::new(), Vec::new());
    let mut find = |vertex: usize| {
        let mut hasher = DefaultHasher::new();
        mesh.vertex_bits(vertex)
            .for_each(|bits| bits.hash(&mut hasher));
        let new = kept.len() as u32;
        let mut found = None;
        let entry = places.entry(hasher.finish());
        let mut other = match &entry {
            Entry::Occupied(last) => Some(*last.get()),
            Entry::Vacant(_) => None,
        };
        let last = other;
        while let (Some(place), None) = (other, found) {
            let is_same = mesh
                .vertex_bits(kept[place as usize] as usize)
                .eq(mesh.vertex_bits(vertex));
            found = is_same.then_some(place);
            other = before[place as usize];
        }
        found.unwrap_or_else(|| {
            entry.insert_entry(new);
            kept.push(vertex as u32);
            before.push(last);
            new
        })
    };
    let names = (0..count).map(&mut find).collect();
    (names, kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Part;
    use glam::{Vec2, Vec3};

    /// A strip of triangles without indices, whose texture coordinates are those of the place, or those of the corner in its triangle.
    fn strip(uv_of_corner: bool) -> TriangleMesh {
        let place = |i: u32| Vec3::new(i as f32, (i % 2) as f32, 0.0);
        let corners = || (0..1200_u32).flat_map(|t| (0..3).map(move |c| (t, c)));
        let uv = |(t, c): (u32, u32)| match uv_of_corner {
            true => Vec2::new(t as f32, c as f32),
            false => Vec2::splat((t + c) as f32),
        };
        TriangleMesh {
            name: "strip".to_owned(),
            positions: corners().map(|(t, c)| place(t + c)).collect(),
            uv_sets: vec![Vec::new(), corners().map(uv).collect()],
            triangles: (0..1200).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 1200,
                material: 0,
            }],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn vertices_that_are_the_same_are_joined_and_triangles_keep_their_corners() {
        let mut scene = Scene {
            meshes: vec![strip(false), strip(true)],
            ..Scene::default()
        };
        let before = scene.clone();
        join_vertices(&mut scene, Path::new("a.glb"));
        assert_eq!(scene.meshes[0].positions.len(), 1202);
        assert_eq!(scene.meshes[1].positions.len(), 3600, "no two are the same");
        for (mesh, before) in scene.meshes.iter().zip(&before.meshes) {
            assert!(mesh.validate().is_ok() && mesh.parts == before.parts);
            for (t, b) in mesh.triangles.iter().zip(&before.triangles) {
                for (&v, &was) in t.iter().zip(b) {
                    assert!(
                        mesh.vertex_bits(v as usize)
                            .eq(before.vertex_bits(was as usize))
                    );
                }
            }
        }
        let notes: Vec<String> = scene.notes.iter().map(ToString::to_string).collect();
        let words =
            "a.glb: mesh \"strip\": 2398 of 3600 vertices are the same as others: joined with them";
        assert_eq!(notes, [words]);
    }

    #[test]
    fn small_meshes_and_those_with_indices_are_left_alone() {
        let mut small = strip(false);
        small.retain_triangles(|t| t < 900);
        assert_eq!(join(&mut small), 0);
        let mut mesh = strip(false);
        mesh.triangles = mesh.triangles.repeat(2);
        mesh.parts[0].triangle_count *= 2;
        assert_eq!(join(&mut mesh), 0);
        let mut empty = TriangleMesh::default();
        assert_eq!(join(&mut empty), 0);
    }
}
