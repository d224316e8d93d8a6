//! OBJ with MTL, through the crate `tobj`.
//!
//! `text` makes lines of bytes; `prepass` (with `attributes`, `claims`, `faces`, `objects`, `numbers`, `pieces`) makes of those lines
//! a text that `tobj` reads without loss; `reader` has `tobj` read it; `mesh`, `triangulate`, `ears`, `monotone` (with `outline` and `status`) make meshes of the result.
//! `mtl` does for materials what `prepass` does for geometry, `materials` and `textures` convert them. Each of these says
//! at its head what it takes for granted where the format is silent.

mod attributes;
mod claims;
mod ears;
mod faces;
mod files;
mod illumination;
mod materials;
mod mesh;
mod monotone;
mod mtl;
mod notes;
mod numbers;
mod objects;
mod outline;
mod pieces;
mod prepass;
mod reader;
mod status;
mod text;
mod textures;
mod triangulate;

use std::collections::BTreeMap;
use std::path::Path;

use glam::DAffine3;

use super::budget::Budget;
use super::clean::drop_broken_triangles;
use super::line::one_line;
use super::smooth::smooth;
use super::{ImportError, ImportOptions};
use glam::Vec3;

use crate::scene::{Defect, DefectCause, Instance, Material, Scene, TriangleMesh};
use mtl::Libraries;
use notes::Notes;
use objects::Object;
use prepass::Named;
use textures::Textures;
use triangulate::Triangulator;

/// Reads an OBJ file, and the files that it names.
pub(super) fn load(
    file: &Path,
    bytes: &[u8],
    options: &ImportOptions,
    budget: &Budget,
) -> Result<Scene, ImportError> {
    if bytes.trim_ascii().is_empty() {
        return Err(ImportError::invalid(file, "file", "is empty"));
    }
    let mut notes = Notes::new(file);
    let source = text::with_plain_line_ends(bytes);
    let file_name = file.file_stem().unwrap_or_default().to_string_lossy();
    let mut prepared = prepass::prepare(&source, &file_name, budget, &mut notes)?;
    if prepared.objects.is_empty() {
        let cause = match prepared.vertices {
            0 => "holds no vertices and no faces: not an OBJ file, or an empty one".to_owned(),
            vertices => format!("holds {vertices} vertices and no faces; only faces are rendered"),
        };
        return Err(ImportError::invalid(file, "file", cause));
    }
    let objects = std::mem::take(&mut prepared.objects);
    let geometry = reader::read_objects(&mut prepared.store.reader(&prepared.text))
        .map_err(|e| ImportError::invalid(file, "file", format!("the OBJ reader failed: {e}")))?;
    let color_scale = prepared.color_scale;
    let (names, libraries) = (prepared.materials, prepared.libraries);
    drop(prepared.store);
    if geometry.len() != objects.iter().filter(|o| o.face_count > 0).count() {
        return Err(ImportError::invalid(
            file,
            "file",
            "the OBJ reader lost an object",
        ));
    }

    let folder = file.parent().unwrap_or(Path::new(""));
    let has_colors = geometry.iter().any(|g| !g.colors.is_empty());
    let reflectance = if has_colors { 1.0 } else { PLAIN_REFLECTANCE };
    let plain = Material {
        base_color: Vec3::splat(reflectance).extend(1.0),
        ..Material::default()
    };
    let libraries = if options.geometry_only {
        Default::default()
    } else {
        libraries
    };
    let mut materials = Materials {
        plain,
        names,
        libraries: Libraries::load(&libraries, folder, budget, &mut notes),
        textures: Textures::new(budget, options.textures),
        of_name: BTreeMap::new(),
        made: Vec::new(),
        missing: Vec::new(),
    };
    let mut scene = Scene::default();
    let mut triangulator = Triangulator::default();
    let mut geometry = geometry.into_iter();
    for object in &objects {
        scene.defects.extend(too_few_corners(file, object));
        if object.face_count == 0 {
            continue;
        }
        let geometry = geometry.next().unwrap_or_default();
        let (mut mesh, groups, oddities) =
            mesh::build(object, geometry, color_scale, &mut triangulator, |name| {
                materials.index_of(name)
            });
        for text in oddities.notes() {
            notes.element(format!("mesh {:?}", mesh.name), text);
        }
        let refused = |cause| ImportError::invalid(file, &object.name, cause);
        if options.crease_angle.is_some() || !groups.is_empty() {
            let element = || format!("mesh {:?}", object.name);
            let bytes = 3 * SMOOTH_CORNER_BYTES;
            let charged = budget.charge_many(mesh.triangles.len(), bytes, element);
            charged.map_err(refused)?;
        }
        smooth(&mut mesh, &groups, options.crease_angle);
        drop_broken_triangles(&mut mesh, file, &mut scene.defects);
        place(mesh, &mut scene);
    }
    materials.finish(&mut scene, notes);
    Ok(scene)
}

fn place(mesh: TriangleMesh, scene: &mut Scene) {
    if mesh.triangles.is_empty() {
        return;
    }
    let index = scene.meshes.len() as u32;
    scene
        .instances
        .push(Instance::new(&mesh.name, index, DAffine3::IDENTITY));
    scene.meshes.push(mesh);
}

fn too_few_corners(file: &Path, object: &Object) -> Option<Defect> {
    let dropped = object.dropped?;
    Some(Defect {
        file: file.to_owned(),
        element: one_line(format!("mesh {:?} (line {})", object.name, dropped.line)),
        cause: DefectCause::TooFewCorners,
        count: dropped.count,
        first: dropped.first_face,
    })
}

/// Linear reflectance of surfaces of which the file says nothing: plaster, so that a bare scan shows its shape. White
/// would leave no light for highlights; vertex colours, which multiply it, get it all the same.
const PLAIN_REFLECTANCE: f32 = 0.65;

/// Bytes that a corner takes at most while a mesh is smoothed: its place, and a vertex of its own.
const SMOOTH_CORNER_BYTES: usize = 200;

/// The materials that faces use, made when first used.
struct Materials<'b> {
    /// What faces without a known material get.
    plain: Material,
    names: Vec<Named>,
    libraries: Libraries,
    textures: Textures<'b>,
    of_name: BTreeMap<Option<u32>, u32>,
    made: Vec<Material>,
    missing: Vec<u32>,
}

impl Materials<'_> {
    /// The scene's material for the index of a `usemtl` name. A name that no MTL has gets the plain material, so named.
    fn index_of(&mut self, name: Option<u32>) -> u32 {
        if let Some(&index) = self.of_name.get(&name) {
            return index;
        }
        let material = match name.map(|n| &self.names[n as usize].name) {
            None => self.plain.clone(),
            Some(named) => match self.libraries.find(named) {
                Some((source, mtl)) => materials::convert(source, &mut self.textures, mtl),
                None => {
                    self.missing.extend(name);
                    Material {
                        name: named.clone(),
                        ..self.plain.clone()
                    }
                }
            },
        };
        let index = self.made.len() as u32;
        self.made.push(material);
        self.of_name.insert(name, index);
        index
    }

    fn finish(self, scene: &mut Scene, mut notes: Notes) {
        if let Some(&first) = self.missing.first() {
            let Named { name, line } = &self.names[first as usize];
            let others = match self.missing.len() - 1 {
                0 => String::new(),
                count => format!(" and {count} more"),
            };
            let text = "is in no MTL file; the default material is used";
            notes.element(format!("line {line}: material {name:?}{others}"), text);
        }
        scene.materials = self.made;
        scene.files.extend(self.libraries.files());
        scene.files.extend(self.textures.files);
        scene.images = self.textures.images;
        scene.textures = self.textures.textures;
        scene.notes = notes.into_notes();
        scene.notes.extend(self.libraries.into_notes());
    }
}
