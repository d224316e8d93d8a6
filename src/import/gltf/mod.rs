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
mod draco;
mod extensions;
mod instancing;
mod ktx2;
mod material;
mod mend;
mod mesh;
mod meshopt_views;
mod nodes;
mod notes;
mod pose;
mod primitive;
mod sampler;
mod skin;
mod texture;
mod uri;
mod variants;
mod vertices;
mod views;

use std::collections::BTreeSet;
use std::path::Path;

use glam::DAffine3;
use rayon::prelude::*;

use self::document::Document;
use self::mesh::MeshRead;
use self::notes::Notes;
use self::pose::Shape;
use self::texture::Textures;
use super::budget::Budget;
use super::line::one_line;
use super::smooth::smooth;
use super::{FileRead, ImportError, ImportOptions, ShownImages, TextureNeeds, images};
use crate::geometry::Aabb;
use crate::geometry::tolerance::COORDINATE_LIMIT;
use crate::scene::{Defect, DefectCause, Instance, Scene, TriangleMesh};

/// Reads a glTF file or GLB whose bytes are `bytes`, with the files that it names.
pub(super) fn load(
    file: &Path,
    bytes: &[u8],
    options: &ImportOptions,
    shown: Option<&ShownImages>,
    budget: &Budget,
) -> Result<FileRead, ImportError> {
    let mut notes = Notes::new(file);
    let container = container::split(file, bytes, &mut notes)?;
    let mut document = Document::read(file, &container, budget)?;
    extensions::gate(&document, &mut notes)?;
    animation::pose(&mut document, options.moment, &mut notes)?;
    let variant = variants::choose(&document, options.variant.as_deref(), &mut notes)?;
    let placements = nodes::walk(&document, &mut notes)?;

    let mut scene = Scene::default();
    let (shapes, shape_of) = pose::shapes(&document, &placements)?;
    let drops_broken = !options.geometry_only;
    let places = read_meshes(
        &document,
        &shapes,
        variant,
        drops_broken,
        &mut scene,
        &mut notes,
    )?;
    let mut bounds = Aabb::EMPTY;
    let boxes: Vec<Aabb> = scene.meshes.par_iter().map(object_box).collect();
    for (placed, shape) in placements.meshes.iter().zip(shape_of) {
        let Some(mesh) = places[shape] else { continue };
        let node = shapes[shape].pose.placement(placed.world_from_node);
        let object = boxes[mesh as usize];
        charge_instances(&document, placed.node, 1)?;
        let many = instancing::placements(&document, placed.node, &mut notes)?;
        for node_from_instance in many.unwrap_or_else(|| vec![DAffine3::IDENTITY]) {
            let placement = node * node_from_instance;
            let world = place(&document, placed.node, mesh, placement, object, &mut scene)?;
            bounds = bounds.union(world);
        }
    }
    let cameras = placements.cameras.iter();
    scene.cameras = cameras
        .filter_map(|c| views::camera(&document, c, &bounds, &mut notes))
        .collect();
    let lights = placements.lights.iter();
    scene.lights = lights
        .filter_map(|l| views::light(&document, l, &mut notes))
        .collect();
    if options.geometry_only {
        // One for each that a part may name.
        let count = document.root.materials.len() + 1;
        scene.materials = vec![material::default_material(); count];
    } else {
        read_materials(&document, options.textures, shown, &mut scene, &mut notes);
        for mesh in &mut scene.meshes {
            let charge = smooth_charge(mesh, options);
            let charged = budget.charge(charge, || format!("mesh {:?}", mesh.name));
            charged.map_err(|cause| document.invalid(&mesh.name, cause))?;
            smooth(mesh, &[], options.crease_angle);
        }
    }
    let has_animations = !document.animations.is_empty();
    let has_variants = !variants::names(&document).is_empty();
    scene.files.extend(document.files.into_paths());
    scene.notes = notes.finish();
    Ok(FileRead {
        scene,
        has_animations,
        has_variants,
    })
}

/// Reads each shape; `drops_broken` is for triangles that cannot be rendered. Gives their places in the scene; those without triangles have none.
fn read_meshes(
    document: &Document,
    shapes: &[Shape],
    variant: Option<usize>,
    drops_broken: bool,
    scene: &mut Scene,
    notes: &mut Notes,
) -> Result<Vec<Option<u32>>, ImportError> {
    let default_material = document.root.materials.len() as u32;
    let read: Vec<Result<MeshRead, ImportError>> = shapes
        .par_iter()
        .with_max_len(1)
        .map(|shape| mesh::read(document, shape, variant, default_material, drops_broken))
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

/// Places a mesh of the scene, of which the box in object space is `object`, where a node shows it. Gives its box in world space,
/// an empty one if it would lie beyond the coordinate limit, which is a defect.
fn place(
    document: &Document,
    node: usize,
    mesh: u32,
    world_from_object: DAffine3,
    object: Aabb,
    scene: &mut Scene,
) -> Result<Aabb, ImportError> {
    let label = || document.node_label(node);
    if !world_from_object.is_finite() {
        return Err(document.invalid(label(), "its transform is not finite"));
    }
    if scene.instances.len() + scene.defects.len() > instancing::MOST_INSTANCES {
        let most = instancing::MOST_INSTANCES;
        return Err(document.invalid(label(), format!("the file has more than {most} instances")));
    }
    let own = document.root.nodes[node].name.as_ref();
    let name = match own.filter(|n| !n.is_empty()) {
        Some(name) => name.clone(),
        None => scene.meshes[mesh as usize].name.clone(),
    };
    let instance = Instance::new(name, mesh, world_from_object);
    let world = instance.world_bounds(&object);
    let extreme = world.min.abs().max(world.max.abs()).max_element();
    if extreme <= COORDINATE_LIMIT {
        scene.instances.push(instance);
        return Ok(world);
    }
    scene.defects.push(Defect {
        file: document.file.to_owned(),
        element: one_line(format!("{} as placed", label())),
        cause: DefectCause::TooLarge,
        count: scene.meshes[mesh as usize].triangles.len() as u64,
        first: 0,
    });
    Ok(Aabb::EMPTY)
}

/// Bytes of an instance and, while it is read, its placement.
const INSTANCE_BYTES: usize = size_of::<Instance>() + 3 * size_of::<DAffine3>();

/// Takes the memory of what a node shows `count` times. Every instance has its own copy of the node's name.
fn charge_instances(document: &Document, node: usize, count: usize) -> Result<(), ImportError> {
    let name = document.root.nodes[node].name.as_ref();
    let bytes = INSTANCE_BYTES + document.file.as_os_str().len() + name.map_or(0, String::len);
    let label = || document.node_label(node);
    let charged = document.budget.charge_many(count, bytes, label);
    charged.map_err(|cause| document.invalid(label(), cause))
}

/// Bytes that smoothing takes at most: every corner gets a vertex of its own.
fn smooth_charge(mesh: &TriangleMesh, options: &ImportOptions) -> u64 {
    /// A corner's place, and a vertex with its attributes and the list of its copies.
    const CORNER_BYTES: u64 = 200;
    match options.crease_angle {
        Some(_) => 3 * CORNER_BYTES * mesh.triangles.len() as u64,
        None => 0,
    }
}

fn object_box(mesh: &TriangleMesh) -> Aabb {
    mesh.positions.iter().copied().collect()
}

/// Reads the materials, under the file's numbers, and of the textures those that the meshes show and that are needed, as finely as they are shown.
fn read_materials(
    document: &Document,
    needs: TextureNeeds,
    shown: Option<&ShownImages>,
    scene: &mut Scene,
    notes: &mut Notes,
) {
    let root = &document.root;
    let parts = scene.meshes.iter().flat_map(|m| &m.parts);
    let used: BTreeSet<usize> = parts.map(|p| p.material as usize).collect();
    let mut read = BTreeSet::new();
    for material in used.iter().filter_map(|&m| root.materials.get(m)) {
        material::shown_textures(material, needs, &mut read);
    }
    let materials = |textures: &Textures| {
        let materials = root.materials.iter().enumerate();
        let materials = materials.map(|(i, m)| material::read(m, i, textures));
        let plain = used.contains(&root.materials.len());
        let plain = plain.then(material::default_material);
        materials.chain(plain).collect()
    };
    let detail = shown.map(|shown| {
        let found = Textures::find(document);
        scene.materials = materials(&found);
        scene.textures = found.textures;
        scene.images = found.images;
        shown(scene)
    });
    let textures = Textures::read(document, &read, &detail.unwrap_or_default(), notes);
    scene.materials = materials(&textures);
    for (material, json) in scene.materials.iter_mut().zip(&root.materials) {
        material::mark_lost_color(material, json, &textures, notes);
    }
    let materials = scene.materials.iter();
    let is_marked = materials
        .filter_map(|m| m.base_color_texture)
        .any(|t| t.texture == textures.stand_in());
    scene.textures = textures.textures;
    scene.images = textures.images;
    if is_marked {
        images::add_stand_in(&mut scene.images, &mut scene.textures);
    }
}
