//! Meshes that a file holds several times are stored once, and placed as often as before.
//!
//! Many programs write a copy of the mesh for every object that shows it, and formats whose materials belong to meshes ask for one for every material. What is the same is found by content, bit for bit: positions,
//! attributes and triangles; copies that were moved within their own space stay. Instances keep their numbers, names, triangles and materials. As every mesh that is placed several times,
//! what is shared is tested in its own space from then on, so that distances differ in their last bits from those to copies, which are tested in the world's.

use std::collections::HashMap;
use std::path::Path;

use super::line::one_line;
use crate::scene::{Note, Part, Scene, TriangleMesh};

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
            let first = &scene.meshes[first];
            mesh.triangles.len() >= LEAST_SHARED
                && first.has_shape_of(mesh)
                && has_tangents_of(scene, first, mesh)
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
        let first = place_of[instance.mesh as usize];
        let [shown, own] = [first, instance.mesh as usize].map(|m| &scene.meshes[m].parts);
        if shown != own {
            instance.materials = own.iter().map(|part| part.material).collect();
        }
        instance.mesh = new_number[first];
    }
    let mut number = 0;
    scene.meshes.retain(|_| {
        number += 1;
        !is_copy(number - 1)
    });
}

/// Whether the materials of two meshes with the same parts want tangents along the same texture coordinates.
fn has_tangents_of(scene: &Scene, mesh: &TriangleMesh, other: &TriangleMesh) -> bool {
    let set = |part: &Part| scene.materials[part.material as usize].normal_uv_set();
    let mut parts = mesh.parts.iter().zip(&other.parts);
    parts.all(|(a, b)| a.material == b.material || set(a) == set(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Material, Texture, TextureRef};
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
        let mut bumpy = mesh("bumpy", 1200, 1.0);
        bumpy.parts[0].material = 2;
        let names = [
            "small",
            "large",
            "small copy",
            "bent",
            "copy",
            "",
            "copy 2",
            "last",
            "bumpy",
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
            bumpy,
        ];
        let place = |i: u32| Instance::new(names[i as usize], i, DAffine3::IDENTITY);
        let mut materials = vec![Material::default(); 3];
        materials[2].normal_texture = Some(TextureRef::default());
        let mut scene = Scene {
            meshes: meshes.to_vec(),
            instances: (0..9).rev().map(place).collect(),
            materials,
            textures: vec![Texture::default()],
            ..Scene::default()
        };
        share_meshes(&mut scene, Path::new("a.glb"));
        let kept: Vec<&str> = scene.meshes.iter().map(|m| &*m.name).collect();
        assert_eq!(
            kept,
            ["small", "large", "small copy", "bent", "last", "bumpy"]
        );
        let of: Vec<u32> = scene.instances.iter().rev().map(|i| i.mesh).collect();
        assert_eq!(of, [0, 1, 2, 3, 1, 1, 1, 4, 5]);
        let shown: Vec<u32> = (0..9).rev().map(|i| scene.material_of(i, 4)).collect();
        assert_eq!(shown, [0, 0, 0, 0, 0, 1, 0, 0, 2]);
        let own = scene.instances.iter().filter(|i| !i.materials.is_empty());
        assert_eq!(own.count(), 1, "the others show those of the mesh");
        let notes: Vec<String> = scene.notes.iter().map(ToString::to_string).collect();
        let words =
            "a.glb: mesh \"large\": has 3 copies in the file: stored once and placed for each";
        assert_eq!(notes, [words]);
    }
}
