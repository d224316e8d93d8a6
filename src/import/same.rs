//! Meshes that a file holds several times are stored once, and placed as often as before.
//!
//! Many programs write a copy of the mesh for every object that shows it. What is the same is found by content, bit for bit: positions, attributes, triangles and materials;
//! copies that were moved within their own space, or have other materials, stay. Instances keep their numbers, names and triangles. As every mesh that is placed several times,
//! what is shared is tested in its own space from then on, so that distances differ in their last bits from those to copies, which are tested in the world's.

use std::collections::HashMap;
use std::path::Path;

use super::line::one_line;
use crate::scene::{Note, Scene};

/// Triangles from which on a mesh is shared: rays pass an instance's box and are taken to its space before they meet its tree, which costs more than a small part of a
/// larger tree, and a small mesh saves little.
const LEAST_SHARED: usize = 1000;

/// Leaves the copies out, with a note for each mesh that had any.
pub(super) fn share_meshes(scene: &mut Scene, file: &Path) {
    let mut firsts: HashMap<(usize, usize), Vec<usize>> = HashMap::new();
    let mut place_of: Vec<usize> = Vec::with_capacity(scene.meshes.len());
    for (number, mesh) in scene.meshes.iter().enumerate() {
        let alike = (mesh.positions.len(), mesh.triangles.len());
        let candidates = firsts.entry(alike).or_default();
        let same = |&&first: &&usize| {
            mesh.triangles.len() >= LEAST_SHARED && scene.meshes[first].has_content_of(mesh)
        };
        let first = candidates.iter().find(same).copied();
        if first.is_none() {
            candidates.push(number);
        }
        place_of.push(first.unwrap_or(number));
    }
    let mut copies = vec![0_u32; place_of.len()];
    let is_copy = |number: usize| place_of[number] != number;
    (0..place_of.len())
        .filter(|&number| is_copy(number))
        .for_each(|number| copies[place_of[number]] += 1);
    for (mesh, &copies) in scene.meshes.iter().zip(&copies).filter(|(_, c)| **c > 0) {
        let copies = match copies {
            1 => "a copy".to_owned(),
            _ => format!("{copies} copies"),
        };
        scene.notes.push(Note {
            file: file.to_owned(),
            element: one_line(format!("mesh {:?}", mesh.name)),
            text: format!("has {copies} in the file: stored once and placed for each"),
        });
    }
    // Where the meshes that stay come to stand.
    let mut new_number = Vec::with_capacity(place_of.len());
    let mut kept = 0;
    for number in 0..place_of.len() {
        new_number.push(kept);
        kept += u32::from(!is_copy(number));
    }
    for instance in &mut scene.instances {
        instance.mesh = new_number[place_of[instance.mesh as usize]];
    }
    let mut number = 0;
    scene.meshes.retain(|_| {
        number += 1;
        !is_copy(number - 1)
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Part, TriangleMesh};
    use glam::{DAffine3, Vec3};

    fn mesh(name: &str, triangles: u32, bend: f32) -> TriangleMesh {
        let point = |i: u32| Vec3::new(i as f32, bend * (i * i) as f32, (i % 2) as f32);
        TriangleMesh {
            name: name.to_owned(),
            positions: (0..triangles + 2).map(point).collect(),
            triangles: (0..triangles).map(|i| [i, i + 1, i + 2]).collect(),
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: triangles,
                material: 0,
            }],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn copies_go_and_instances_find_the_first_of_them() {
        let mut other = mesh("other material", 1200, 1.0);
        other.parts[0].material = 1;
        let names = [
            "small",
            "large",
            "small copy",
            "bent",
            "copy",
            "",
            "copy 2",
            "last",
        ];
        let meshes = [
            mesh(names[0], 10, 1.0),
            mesh(names[1], 1200, 1.0),
            mesh(names[2], 10, 1.0),
            mesh(names[3], 1200, 2.0),
            mesh(names[4], 1200, 1.0),
            other,
            mesh(names[6], 1200, 1.0),
            mesh(names[7], 5, 3.0),
        ];
        let place = |i: u32| Instance::new(names[i as usize], i, DAffine3::IDENTITY);
        let mut scene = Scene {
            meshes: meshes.to_vec(),
            instances: (0..8).rev().map(place).collect(),
            ..Scene::default()
        };
        share_meshes(&mut scene, Path::new("a.glb"));
        let kept: Vec<&str> = scene.meshes.iter().map(|m| &*m.name).collect();
        assert_eq!(
            kept,
            [
                "small",
                "large",
                "small copy",
                "bent",
                "other material",
                "last"
            ]
        );
        let of: Vec<u32> = scene.instances.iter().rev().map(|i| i.mesh).collect();
        assert_eq!(of, [0, 1, 2, 3, 1, 4, 1, 5]);
        let notes: Vec<String> = scene.notes.iter().map(ToString::to_string).collect();
        let words =
            "a.glb: mesh \"large\": has 2 copies in the file: stored once and placed for each";
        assert_eq!(notes, [words]);
    }
}
