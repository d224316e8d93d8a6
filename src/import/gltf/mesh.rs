//! A glTF mesh as one [`TriangleMesh`], a part for each run of primitives of one material.
//!
//! Primitives that name the same accessors share their vertices, and vertices that no triangle uses are left out: files keep
//! the vertices of many primitives, and of many meshes, in one accessor.

use std::ops::Range;

use ::gltf::json::mesh::{Mode, Primitive};
use ::gltf::json::validation::Checked;
use glam::{Vec2, Vec3, Vec4};

use super::accessor::Accessor;
use super::attributes::{Attributes, color_or_white, finite_or_zero, unit_or_zero};
use super::document::Document;
use super::notes::Notes;
use super::primitive;
use crate::import::{ImportError, clean};
use crate::scene::{Defect, Part, TriangleMesh};

/// A mesh with what there is to say about it.
pub(super) struct MeshRead {
    pub(super) mesh: TriangleMesh,
    pub(super) notes: Notes,
    pub(super) defects: Vec<Defect>,
}

/// Vertices that primitives share.
struct Group {
    attributes: Attributes,
    vertex_count: usize,
    /// Named in messages.
    first_primitive: usize,
    /// The triangles over them. Until the vertices are read, these count vertices as the accessors do.
    runs: Vec<Range<usize>>,
}

/// Reads mesh `index`, which is there. Parts name materials by the file's index; those without one have `default_material`.
pub(super) fn read(
    document: &Document,
    index: usize,
    default_material: u32,
) -> Result<MeshRead, ImportError> {
    let json = &document.root.meshes[index];
    let label = document.mesh_label(index);
    let mut reader = Reader {
        document,
        label: &label,
        notes: Notes::new(document.file),
        mesh: TriangleMesh {
            name: json.name.clone().unwrap_or_else(|| label.clone()),
            ..TriangleMesh::default()
        },
        groups: Vec::new(),
    };
    for (i, primitive) in json.primitives.iter().enumerate() {
        reader.read_triangles(i, primitive, default_material)?;
    }
    if json.primitives.iter().any(|p| p.targets.is_some()) {
        let text = "morph targets are left out: shown without them";
        reader.notes.add(&label, text);
    }
    for group in std::mem::take(&mut reader.groups) {
        let primitive = group.first_primitive;
        reader
            .read_vertices(group)
            .map_err(|cause| document.invalid(format!("{label}, primitive {primitive}"), cause))?;
    }
    let Reader {
        mut mesh, notes, ..
    } = reader;
    let mut defects = Vec::new();
    clean::drop_broken_triangles(&mut mesh, document.file, &mut defects);
    Ok(MeshRead {
        mesh,
        notes,
        defects,
    })
}

struct Reader<'a, 'file> {
    document: &'a Document<'file>,
    label: &'a str,
    notes: Notes,
    mesh: TriangleMesh,
    groups: Vec<Group>,
}

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
        let Some(attributes) = Attributes::of(json, &element, &mut self.notes) else {
            self.notes.add(element, "left out: it has no positions");
            return Ok(());
        };
        let positions = Accessor::open(document, attributes.position).map_err(invalid)?;
        let is_draco = json
            .extensions
            .as_ref()
            .is_some_and(|e| e.others.contains_key("KHR_draco_mesh_compression"));
        if is_draco && positions.is_empty_shell() {
            let cause = "is only there in KHR_draco_mesh_compression: decode the file first, for example with gltf-transform";
            return Err(ImportError::unsupported(document.file, element, cause));
        }
        let vertex_count = positions.count;
        let indices = self.indices(json, vertex_count).map_err(invalid)?;
        let materials = document.root.materials.len();
        let material = match json.material {
            None => default_material,
            Some(m) if m.value() < materials => m.value() as u32,
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
        match self.groups.iter_mut().find(|g| g.attributes == attributes) {
            Some(group) => group.runs.push(run),
            None => self.groups.push(Group {
                attributes,
                vertex_count,
                first_primitive: index,
                runs: vec![run],
            }),
        }
        Ok(())
    }

    /// A primitive's vertex indices, all below `vertex_count`.
    fn indices(&self, json: &Primitive, vertex_count: usize) -> Result<Vec<u32>, String> {
        let Some(accessor) = json.indices else {
            // Fits: the count of an accessor has 32 bits.
            return Ok((0..vertex_count as u32).collect());
        };
        let indices = Accessor::open(self.document, accessor.value())?.indices()?;
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

    /// Adds the vertices that a group's triangles use, and makes the triangles name them.
    fn read_vertices(&mut self, group: Group) -> Result<(), String> {
        let base = self.mesh.positions.len();
        let used = self.renumber(&group.runs)?;
        let document = self.document;
        let open = |name: &str, index: usize, widths| {
            let accessor = Accessor::open(document, index).and_then(|a| a.with_width(widths));
            match accessor {
                Ok(a) if a.count < group.vertex_count => Err(format!(
                    "{name}: accessor {index} has {} elements for {} vertices",
                    a.count, group.vertex_count
                )),
                Ok(a) => Ok(a),
                Err(cause) => Err(format!("{name}: {cause}")),
            }
        };
        let mesh = &mut self.mesh;
        let end = base + used.len();

        let positions = open("POSITION", group.attributes.position, 3..=3)?;
        let positions = positions.read(&used, [0.0; 3]);
        let positions = positions.into_iter().map(Vec3::from).collect();
        append(&mut mesh.positions, positions);
        if let Some(index) = group.attributes.normal {
            let normals = open("NORMAL", index, 3..=3)?.read(&used, [0.0; 3]);
            mesh.normals.resize(base, Vec3::ZERO);
            let normals = normals.into_iter().map(unit_or_zero).collect();
            append(&mut mesh.normals, normals);
        } else if !mesh.normals.is_empty() {
            mesh.normals.resize(end, Vec3::ZERO);
        }
        if let Some(index) = group.attributes.color {
            // The format wants integers normalised here; not all exporters say that they are.
            let colors = open("COLOR_0", index, 3..=4)?.into_normalized();
            let colors = colors.read(&used, [1.0; 4]);
            mesh.colors.resize(base, Vec4::ONE);
            let colors = colors.into_iter().map(color_or_white).collect();
            append(&mut mesh.colors, colors);
        } else if !mesh.colors.is_empty() {
            mesh.colors.resize(end, Vec4::ONE);
        }
        for &(set, index) in &group.attributes.uvs {
            let uvs = open(&format!("TEXCOORD_{set}"), index, 2..=2)?.read(&used, [0.0; 2]);
            let set = set as usize;
            if mesh.uv_sets.len() <= set {
                mesh.uv_sets.resize(set + 1, Vec::new());
            }
            mesh.uv_sets[set].resize(base, Vec2::ZERO);
            let uvs = uvs.into_iter().map(finite_or_zero).collect();
            append(&mut mesh.uv_sets[set], uvs);
        }
        for set in mesh.uv_sets.iter_mut().filter(|s| !s.is_empty()) {
            set.resize(end, Vec2::ZERO);
        }
        Ok(())
    }

    /// Makes the triangles of `runs` name the vertices that they use in the order of the accessor, behind those that the mesh
    /// already has. Gives those vertices, as the accessor counts, ascending.
    fn renumber(&mut self, runs: &[Range<usize>]) -> Result<Vec<u32>, String> {
        const UNUSED: u32 = u32::MAX;
        let base = self.mesh.positions.len();
        let corners = |triangles: &[[u32; 3]]| {
            let low = triangles.as_flattened().iter().copied().min();
            low.zip(triangles.as_flattened().iter().copied().max())
        };
        let (low, high) = runs
            .iter()
            .filter_map(|run| corners(&self.mesh.triangles[run.clone()]))
            .reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
            .unwrap_or((0, 0));
        // One place for each vertex between the least and the greatest: they are there, and indices name them.
        let mut place = vec![UNUSED; (high - low) as usize + 1];
        for run in runs {
            for &v in self.mesh.triangles[run.clone()].as_flattened() {
                place[(v - low) as usize] = 0;
            }
        }
        let mut used = Vec::with_capacity(place.len());
        for (v, place) in (low..=high).zip(&mut place) {
            if *place != UNUSED {
                *place = u32::try_from(base + used.len())
                    .map_err(|_| "the mesh has more than 2^32 vertices".to_owned())?;
                used.push(v);
            }
        }
        if base != 0 || low != 0 || used.len() != place.len() {
            for run in runs {
                for v in self.mesh.triangles[run.clone()].as_flattened_mut() {
                    *v = place[(*v - low) as usize];
                }
            }
        }
        Ok(used)
    }
}

/// Adds `more` at the end; most meshes have one group, of which the vectors are taken as they are.
fn append<T>(values: &mut Vec<T>, more: Vec<T>) {
    if values.is_empty() {
        *values = more;
    } else {
        values.extend(more);
    }
}
