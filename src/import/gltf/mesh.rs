//! A glTF mesh as one [`TriangleMesh`], a part for each run of primitives of one material.
//!
//! Primitives that name the same accessors share their vertices, and vertices that no triangle uses are left out: files keep
//! the vertices of many primitives, and of many meshes, in one accessor.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;

use ::gltf::json::mesh::{Mode, Primitive};
use ::gltf::json::validation::Checked;

use super::accessor::Accessor;
use super::attributes::Attributes;
use super::document::Document;
use super::draco;
use super::material;
use super::notes::Notes;
use super::pose::{MeshPose, Shape};
use super::primitive;
use super::variants;
use super::vertices::{self, Group};
use crate::import::{ImportError, clean};
use crate::scene::{Defect, Part, TriangleMesh};

/// A mesh with what there is to say about it.
pub(super) struct MeshRead {
    pub(super) mesh: TriangleMesh,
    pub(super) notes: Notes,
    pub(super) defects: Vec<Defect>,
}

/// Reads a mesh in its shape, with the materials of a variant. Parts name materials by the file's index; those without one have `default_material`. `drops_broken` is for triangles
/// that cannot be rendered.
pub(super) fn read(
    document: &Document,
    shape: &Shape,
    variant: Option<usize>,
    default_material: u32,
    drops_broken: bool,
) -> Result<MeshRead, ImportError> {
    let index = shape.mesh;
    let json = &document.root.meshes[index];
    let label = document.mesh_label(index);
    let mut reader = Reader {
        document,
        label: &label,
        pose: &shape.pose,
        variant,
        notes: Notes::new(document.file),
        mesh: TriangleMesh {
            name: json.name.clone().unwrap_or_else(|| label.clone()),
            ..TriangleMesh::default()
        },
        shows_tangents: document.root.materials.iter().any(material::shows_tangents),
        groups: Vec::new(),
        group_of: HashMap::new(),
    };
    let name_bytes = size_of::<TriangleMesh>() + 2 * reader.mesh.name.len();
    let charged = document.budget.charge(name_bytes as u64, || label.clone());
    charged.map_err(|cause| document.invalid(&label, cause))?;
    for (i, primitive) in json.primitives.iter().enumerate() {
        reader.read_triangles(i, primitive, default_material)?;
    }
    for group in std::mem::take(&mut reader.groups) {
        let primitive = group.first_primitive;
        vertices::read(document, &label, &group, &shape.pose, &mut reader.mesh)
            .map_err(|cause| document.invalid(format!("{label}, primitive {primitive}"), cause))?;
    }
    let Reader {
        mut mesh, notes, ..
    } = reader;
    let mut defects = Vec::new();
    if drops_broken {
        clean::drop_broken_triangles(&mut mesh, document.file, &mut defects);
    }
    Ok(MeshRead {
        mesh,
        notes,
        defects,
    })
}

struct Reader<'a, 'file> {
    document: &'a Document<'file>,
    label: &'a str,
    pose: &'a MeshPose,
    variant: Option<usize>,
    notes: Notes,
    mesh: TriangleMesh,
    /// Whether some material of the file looks tangents up; which one a primitive has may be a variant's affair.
    shows_tangents: bool,
    groups: Vec<Group>,
    /// The group of primitives with these attributes that are not compressed.
    group_of: HashMap<Attributes, usize>,
}

/// Bytes of an index: itself, and the triangle of which it is the last in a strip.
const INDEX_BYTES: usize = size_of::<u32>() + size_of::<[u32; 3]>();

impl Reader<'_, '_> {
    /// Adds the triangles of a primitive to its group.
    fn read_triangles(
        &mut self,
        index: usize,
        json: &Primitive,
        default_material: u32,
    ) -> Result<(), ImportError> {
        let document = self.document;
        let element = format!("{}, primitive {index}", self.label);
        let invalid = |cause: String| document.invalid(&element, cause);
        let Checked::Valid(mode) = json.mode else {
            return Err(invalid("its mode is unknown".to_owned()));
        };
        if !primitive::has_triangles(mode) {
            self.notes.add(element, "points and lines are left out");
            return Ok(());
        }
        let shows_tangents = self.shows_tangents;
        let attributes = Attributes::of(json, self.pose, shows_tangents, &element, &mut self.notes);
        let Some(attributes) = attributes else {
            self.notes.add(element, "left out: it has no positions");
            return Ok(());
        };
        let unpacked = match draco::extension(document, json) {
            Some(extension) => {
                Some(draco::unpack(document, json, &element, extension).map_err(invalid)?)
            }
            None => None,
        };
        let (mode, vertex_count, indices) = match &unpacked {
            // Whatever the primitive says, Draco has lists of triangles.
            Some(u) => (Mode::Triangles, u.vertex_count, Cow::Borrowed(&u.indices)),
            None => {
                let positions = Accessor::open(document, attributes.position).map_err(invalid)?;
                let indices = self.indices(json, &element, positions.count);
                let indices = indices.map_err(invalid)?;
                (mode, positions.count, Cow::Owned(indices))
            }
        };
        let materials = document.root.materials.len();
        let own = json.material.map(|m| m.value());
        let material = self.variant.and_then(|v| variants::material(json, v));
        let material = match material.or(own) {
            None => default_material,
            Some(m) if m < materials => m as u32,
            Some(m) => {
                let cause = format!("material {m} is not there: the file has {materials}");
                return Err(invalid(cause));
            }
        };
        let triangles = primitive::triangles(mode, &indices);
        if triangles.is_empty() {
            self.notes.add(element, "left out: it has no triangles");
            return Ok(());
        }
        if mode == Mode::Triangles && indices.len() % 3 != 0 {
            let text = "the one or two indices behind its last triangle are ignored";
            self.notes.add(&element, text);
        }
        let run = self.add_part(triangles, material).map_err(invalid)?;
        let is_plain = unpacked.is_none();
        let known = self.group_of.get(&attributes).filter(|_| is_plain);
        if let Some(&group) = known {
            self.groups[group].runs.push(run);
            return Ok(());
        }
        if is_plain {
            self.group_of.insert(attributes.clone(), self.groups.len());
        }
        self.groups.push(Group {
            attributes,
            vertex_count,
            unpacked,
            first_primitive: index,
            runs: vec![run],
        });
        Ok(())
    }

    /// A primitive's vertex indices, all below `vertex_count`.
    fn indices(
        &self,
        json: &Primitive,
        element: &str,
        vertex_count: usize,
    ) -> Result<Vec<u32>, String> {
        let accessor = json
            .indices
            .map(|a| Accessor::open(self.document, a.value()));
        let accessor = accessor.transpose()?;
        let count = accessor.as_ref().map_or(vertex_count, |a| a.count);
        let budget = self.document.budget;
        budget.charge_many(count, INDEX_BYTES, || element.to_owned())?;
        let Some(accessor) = accessor else {
            // Fits: the count of an accessor has 32 bits.
            return Ok((0..vertex_count as u32).collect());
        };
        let indices = accessor.indices()?;
        match primitive::first_beyond(&indices, vertex_count) {
            None => Ok(indices),
            Some(at) => Err(format!(
                "index {at} names vertex {} of {vertex_count}",
                indices[at]
            )),
        }
    }

    /// Adds triangles of one material. Gives their places.
    fn add_part(
        &mut self,
        triangles: Vec<[u32; 3]>,
        material: u32,
    ) -> Result<Range<usize>, String> {
        let first = self.mesh.triangles.len();
        append(&mut self.mesh.triangles, triangles);
        let run = first..self.mesh.triangles.len();
        if u32::try_from(run.end).is_err() {
            return Err("the mesh has more than 2^32 triangles".to_owned());
        }
        let count = run.len() as u32;
        match self.mesh.parts.last_mut() {
            Some(part) if part.material == material => part.triangle_count += count,
            _ => self.mesh.parts.push(Part {
                first_triangle: first as u32,
                triangle_count: count,
                material,
            }),
        }
        Ok(run)
    }
}

/// Adds `more` at the end; most meshes have one group, of which the vectors are taken as they are.
pub(super) fn append<T>(values: &mut Vec<T>, more: Vec<T>) {
    if values.is_empty() {
        *values = more;
    } else {
        values.extend(more);
    }
}
