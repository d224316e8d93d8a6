//! glTF 2.0 and GLB, through the crate `gltf` as the JSON layer alone: its types stay in this folder.
//!
//! Its wrappers panic on indices that are out of range and on matrices with NaN, its validation refuses what exporters write
//! and accepts node cycles, and its readers know no quantised positions. So indices are looked up with
//! checks, accessors, images and extensions are read here, and the nodes are walked here.
//!
//! Section numbers in this folder are those of the glTF 2.0 specification (Khronos, 2.0.1).
//!
//! Broken parts that the scene does not use do not matter: they are not looked at.

mod accessor;
mod attributes;
mod buffers;
mod container;
mod document;
mod extensions;
mod material;
mod mesh;
mod nodes;
mod notes;
mod primitive;
mod texture;
mod uri;
mod views;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use glam::Vec3;
use rayon::prelude::*;

use self::document::Document;
use self::mesh::MeshRead;
use self::nodes::Placed;
use self::notes::Notes;
use self::texture::Textures;
use super::ImportError;
use crate::geometry::Aabb;
use crate::geometry::tolerance::COORDINATE_LIMIT;
use crate::scene::{Defect, DefectCause, Instance, Scene, TriangleMesh};

/// Reads a glTF file or GLB whose bytes are `bytes`, with the files that it names.
pub(super) fn load(file: &Path, bytes: Vec<u8>) -> Result<Scene, ImportError> {
    let mut notes = Notes::new(file);
    let container = container::split(file, &bytes, &mut notes)?;
    let document = Document::read(file, &container)?;
    extensions::gate(&document, &mut notes)?;
    let placements = nodes::walk(&document, &mut notes)?;

    let mut scene = Scene::default();
    let places = read_meshes(&document, &placements.meshes, &mut scene, &mut notes)?;
    let bounds = place(&document, &placements.meshes, &places, &mut scene);
    let cameras = placements.cameras.iter();
    scene.cameras = cameras
        .filter_map(|c| views::camera(&document, c, &bounds, &mut notes))
        .collect();
    let lights = placements.lights.iter();
    scene.lights = lights
        .filter_map(|l| views::light(&document, l, &mut notes))
        .collect();
    read_materials(&document, &mut scene, &mut notes);
    scene.files.extend(document.files.into_paths());
    scene.notes = notes.finish();
    Ok(scene)
}

/// Reads each mesh that is placed, once. Gives their places in the scene by the file's index.
fn read_meshes(
    document: &Document,
    placed: &[Placed],
    scene: &mut Scene,
    notes: &mut Notes,
) -> Result<BTreeMap<usize, u32>, ImportError> {
    let count = document.root.meshes.len();
    if let Some(p) = placed.iter().find(|p| p.what >= count) {
        let cause = format!("mesh {} is not there: the file has {count}", p.what);
        return Err(document.invalid(document.node_label(p.node), cause));
    }
    let used: BTreeSet<usize> = placed.iter().map(|p| p.what).collect();
    let used: Vec<usize> = used.into_iter().collect();
    let default_material = document.root.materials.len() as u32;
    let read: Vec<Result<MeshRead, ImportError>> = used
        .par_iter()
        .map(|&m| mesh::read(document, m, default_material))
        .collect();
    let mut places = BTreeMap::new();
    // One after the other, so that the first error of the file is the one that is told.
    for (index, read) in used.into_iter().zip(read) {
        let read = read?;
        notes.append(read.notes);
        scene.defects.extend(read.defects);
        if !read.mesh.triangles.is_empty() {
            places.insert(index, scene.meshes.len() as u32);
            scene.meshes.push(read.mesh);
        }
    }
    Ok(places)
}

/// Places the meshes, and gives the box of all in world space. What would lie beyond the coordinate limit there is a defect.
fn place(
    document: &Document,
    placed: &[Placed],
    places: &BTreeMap<usize, u32>,
    scene: &mut Scene,
) -> Aabb {
    let boxes: Vec<Aabb> = scene.meshes.par_iter().map(object_box).collect();
    let mut bounds = Aabb::EMPTY;
    for p in placed {
        let Some(&mesh) = places.get(&p.what) else {
            continue;
        };
        let own = document.root.nodes[p.node].name.as_ref();
        let name = match own.filter(|n| !n.is_empty()) {
            Some(name) => name.clone(),
            None => scene.meshes[mesh as usize].name.clone(),
        };
        let instance = Instance::new(name, mesh, p.world_from_node);
        let object = boxes[mesh as usize];
        let corner = |i: usize| {
            let choose = |bit: usize, low, high| if i & bit == 0 { low } else { high };
            let (min, max) = (object.min, object.max);
            instance.world_point(Vec3::new(
                choose(1, min.x, max.x),
                choose(2, min.y, max.y),
                choose(4, min.z, max.z),
            ))
        };
        let world: Aabb = (0..8).map(corner).collect();
        let extreme = world.min.abs().max(world.max.abs()).max_element();
        if extreme <= COORDINATE_LIMIT {
            bounds = bounds.union(world);
            scene.instances.push(instance);
        } else {
            scene.defects.push(Defect {
                file: document.file.to_owned(),
                element: format!("{} as placed", document.node_label(p.node)),
                cause: DefectCause::TooLarge,
                count: scene.meshes[mesh as usize].triangles.len() as u64,
                first: 0,
            });
        }
    }
    bounds
}

fn object_box(mesh: &TriangleMesh) -> Aabb {
    mesh.positions.iter().copied().collect()
}

/// Reads the materials, under the file's numbers, and of the textures those that the meshes show.
fn read_materials(document: &Document, scene: &mut Scene, notes: &mut Notes) {
    let root = &document.root;
    let parts = scene.meshes.iter().flat_map(|m| &m.parts);
    let used: BTreeSet<usize> = parts.map(|p| p.material as usize).collect();
    let mut shown = BTreeSet::new();
    for material in used.iter().filter_map(|&m| root.materials.get(m)) {
        material::shown_textures(material, &mut shown);
    }
    let textures = Textures::read(document, &shown, notes);
    let materials = root.materials.iter().enumerate();
    scene.materials = materials
        .map(|(i, m)| material::read(m, i, &textures))
        .collect();
    if used.contains(&root.materials.len()) {
        scene.materials.push(material::default_material());
    }
    scene.textures = textures.textures;
    scene.images = textures.images;
}
