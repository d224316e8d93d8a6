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
mod animation;
mod attributes;
mod buffers;
mod container;
mod document;
mod extensions;
mod material;
mod mend;
mod mesh;
mod nodes;
mod notes;
mod pose;
mod primitive;
mod sampler;
mod skin;
mod texture;
mod uri;
mod vertices;
mod views;

use std::collections::BTreeSet;
use std::path::Path;

use glam::{DAffine3, Vec3};
use rayon::prelude::*;

use self::document::Document;
use self::mesh::MeshRead;
use self::notes::Notes;
use self::pose::Shape;
use self::texture::Textures;
use super::{FileRead, ImportError, ImportOptions};
use crate::geometry::Aabb;
use crate::geometry::tolerance::COORDINATE_LIMIT;
use crate::scene::{Defect, DefectCause, Instance, Scene, TriangleMesh};

/// Reads a glTF file or GLB whose bytes are `bytes`, with the files that it names.
pub(super) fn load(
    file: &Path,
    bytes: Vec<u8>,
    options: &ImportOptions,
) -> Result<FileRead, ImportError> {
    let mut notes = Notes::new(file);
    let container = container::split(file, &bytes, &mut notes)?;
    let mut document = Document::read(file, &container)?;
    extensions::gate(&document, &mut notes)?;
    animation::pose(&mut document, options.moment, &mut notes)?;
    let placements = nodes::walk(&document, &mut notes)?;

    let mut scene = Scene::default();
    let (shapes, shape_of) = pose::shapes(&document, &placements)?;
    let places = read_meshes(&document, &shapes, &mut scene, &mut notes)?;
    let shown = placements.meshes.iter().zip(shape_of);
    let shown = shown.filter_map(|(placed, shape)| {
        let placement = shapes[shape].pose.placement(placed.world_from_node);
        places[shape].map(|mesh| (placed.node, mesh, placement))
    });
    let bounds = place(&document, shown, &mut scene);
    let cameras = placements.cameras.iter();
    scene.cameras = cameras
        .filter_map(|c| views::camera(&document, c, &bounds, &mut notes))
        .collect();
    let lights = placements.lights.iter();
    scene.lights = lights
        .filter_map(|l| views::light(&document, l, &mut notes))
        .collect();
    read_materials(&document, &mut scene, &mut notes);
    let has_animations = !document.animations.is_empty();
    scene.files.extend(document.files.into_paths());
    scene.notes = notes.finish();
    Ok(FileRead {
        scene,
        has_animations,
    })
}

/// Reads each shape. Gives their places in the scene; those without triangles have none.
fn read_meshes(
    document: &Document,
    shapes: &[Shape],
    scene: &mut Scene,
    notes: &mut Notes,
) -> Result<Vec<Option<u32>>, ImportError> {
    let default_material = document.root.materials.len() as u32;
    let read: Vec<Result<MeshRead, ImportError>> = shapes
        .par_iter()
        .map(|shape| mesh::read(document, shape, default_material))
        .collect();
    let mut places = Vec::with_capacity(shapes.len());
    // One after the other, so that the first error of the file is the one that is told.
    for read in read {
        let read = read?;
        notes.append(read.notes);
        scene.defects.extend(read.defects);
        let has_triangles = !read.mesh.triangles.is_empty();
        places.push(has_triangles.then_some(scene.meshes.len() as u32));
        if has_triangles {
            scene.meshes.push(read.mesh);
        }
    }
    Ok(places)
}

/// Places meshes (node, mesh of the scene, placement), and gives the box of all in world space. What would lie beyond the coordinate limit there is a defect.
fn place(
    document: &Document,
    shown: impl Iterator<Item = (usize, u32, DAffine3)>,
    scene: &mut Scene,
) -> Aabb {
    let boxes: Vec<Aabb> = scene.meshes.par_iter().map(object_box).collect();
    let mut bounds = Aabb::EMPTY;
    for (node, mesh, world_from_object) in shown {
        let own = document.root.nodes[node].name.as_ref();
        let name = match own.filter(|n| !n.is_empty()) {
            Some(name) => name.clone(),
            None => scene.meshes[mesh as usize].name.clone(),
        };
        let instance = Instance::new(name, mesh, world_from_object);
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
                element: format!("{} as placed", document.node_label(node)),
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
