//! The vertices of a mesh: its attributes, and what morph targets and joints make of them.
//!
//! Vertices that bend are bent in double precision and rounded once.

use std::ops::{Range, RangeInclusive};

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3, Vec4};

use super::accessor::Accessor;
use super::attributes::{
    Attributes, color_or_white, finite_or_zero, tangent_or_zero, unit_or_zero,
};
use super::document::Document;
use super::draco::Unpacked;
use super::mesh::append;
use super::pose::MeshPose;
use super::skin::Skin;
use crate::scene::TriangleMesh;

/// Vertices that primitives share.
pub(super) struct Group {
    pub(super) attributes: Attributes,
    pub(super) vertex_count: usize,
    /// The attributes' data, where it was compressed.
    pub(super) unpacked: Option<Unpacked>,
    /// Named in messages.
    pub(super) first_primitive: usize,
    /// The triangles over them. Until the vertices are read, these count vertices as the accessors do.
    pub(super) runs: Vec<Range<usize>>,
}

/// Adds the vertices that a group's triangles use to `mesh`, in the shape of `pose`, and makes the triangles name them.
pub(super) fn read(
    document: &Document,
    mesh_label: &str,
    group: &Group,
    pose: &MeshPose,
    mesh: &mut TriangleMesh,
) -> Result<(), String> {
    let base = mesh.positions.len();
    let element = || format!("{mesh_label}, primitive {}", group.first_primitive);
    let charge = |count, bytes| document.budget.charge_many(count, bytes, element);
    let used = renumber(mesh, &group.runs, charge)?;
    let reader = Reader {
        document,
        group,
        element: &element,
        used: &used,
    };
    let attributes = &group.attributes;
    let end = base + used.len();

    let positions = reader.read("POSITION", attributes.position, 3..=3, [0.0; 3])?;
    let mut positions = positions.into_iter().map(Vec3::from).collect::<Vec<_>>();
    let mut normals = match attributes.normal {
        Some(index) => {
            let normals = reader.read("NORMAL", index, 3..=3, [0.0; 3])?;
            Some(normals.into_iter().map(unit_or_zero).collect::<Vec<_>>())
        }
        None => None,
    };
    let mut tangents = match attributes.tangent {
        Some(index) => {
            let tangents = reader.read("TANGENT", index, 4..=4, [0.0; 4])?;
            tangents.into_iter().map(tangent_or_zero).collect()
        }
        None => Vec::new(),
    };
    if !pose.is_at_rest() {
        let normals = normals.as_deref_mut();
        let is_mirrored = reader.bend(pose, &mut positions, normals, &mut tangents)?;
        turn(mesh, &group.runs, base, &is_mirrored);
    }
    append(&mut mesh.positions, positions);
    if let Some(normals) = normals {
        mesh.normals.resize(base, Vec3::ZERO);
        append(&mut mesh.normals, normals);
    } else if !mesh.normals.is_empty() {
        mesh.normals.resize(end, Vec3::ZERO);
    }
    if !tangents.is_empty() {
        mesh.tangents.resize(base, Vec4::ZERO);
        append(&mut mesh.tangents, tangents);
    } else if !mesh.tangents.is_empty() {
        mesh.tangents.resize(end, Vec4::ZERO);
    }
    if let Some(index) = attributes.color {
        // The format wants integers normalised here; not all exporters say that they are.
        let colors = reader.open("COLOR_0", index, 3..=4)?.into_normalized();
        let colors = colors.read(&used, [1.0; 4]);
        mesh.colors.resize(base, Vec4::ONE);
        let colors = colors.into_iter().map(color_or_white).collect();
        append(&mut mesh.colors, colors);
    } else if !mesh.colors.is_empty() {
        mesh.colors.resize(end, Vec4::ONE);
    }
    for &(set, index) in &attributes.uvs {
        let uvs = reader.read(&format!("TEXCOORD_{set}"), index, 2..=2, [0.0; 2])?;
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

struct Reader<'a, 'file> {
    document: &'a Document<'file>,
    group: &'a Group,
    /// Names it in messages.
    element: &'a dyn Fn() -> String,
    used: &'a [u32],
}

/// Bytes of a vertex's attribute: as it is read, in double precision where it bends, and in the mesh.
const ATTRIBUTE_BYTES: usize = 64;

impl<'a> Reader<'a, '_> {
    fn open(
        &self,
        name: &str,
        index: usize,
        widths: RangeInclusive<usize>,
    ) -> Result<Accessor<'a>, String> {
        let budget = self.document.budget;
        budget.charge_many(self.used.len(), ATTRIBUTE_BYTES, self.element)?;
        let unpacked = self.group.unpacked.as_ref();
        let accessor = match unpacked.and_then(|u| u.attributes.get(name)) {
            Some(values) => Accessor::unpacked(self.document, index, values),
            None => Accessor::open(self.document, index),
        };
        let accessor = accessor.and_then(|a| a.with_width(widths));
        let vertex_count = self.group.vertex_count;
        match accessor {
            Ok(a) if a.count < vertex_count => Err(format!(
                "{name}: accessor {index} has {} elements for {vertex_count} vertices",
                a.count
            )),
            Ok(a) => Ok(a),
            Err(cause) => Err(format!("{name}: {cause}")),
        }
    }

    fn read<const N: usize>(
        &self,
        name: &str,
        index: usize,
        widths: RangeInclusive<usize>,
        fill: [f32; N],
    ) -> Result<Vec<[f32; N]>, String> {
        Ok(self.open(name, index, widths)?.read(self.used, fill))
    }

    /// Moves vertices, their normals and tangents (none, or one a vertex) as morph targets and joints have it. Tells which are turned inside out; none, if there are
    /// no joints.
    fn bend(
        &self,
        pose: &MeshPose,
        positions: &mut [Vec3],
        normals: Option<&mut [Vec3]>,
        tangents: &mut [Vec4],
    ) -> Result<Vec<bool>, String> {
        let double = |v: &[Vec3]| v.iter().map(|v| v.as_dvec3()).collect::<Vec<_>>();
        let mut points = double(positions);
        let mut directions = normals.as_deref().map_or_else(Vec::new, double);
        let along = tangents.iter().map(|t| t.truncate().as_dvec3());
        let mut along = along.collect::<Vec<_>>();
        for morph in &self.group.attributes.morphs {
            let weight = pose.weights[morph.target];
            let named = |what: &str| format!("morph target {}: {what}", morph.target);
            if let Some(index) = morph.position {
                let moves = self.read(&named("POSITION"), index, 3..=3, [0.0; 3])?;
                add(&mut points, weight, &moves);
            }
            if let Some(index) = morph.normal.filter(|_| !directions.is_empty()) {
                let moves = self.read(&named("NORMAL"), index, 3..=3, [0.0; 3])?;
                add(&mut directions, weight, &moves);
            }
            if let Some(index) = morph.tangent.filter(|_| !along.is_empty()) {
                let moves = self.read(&named("TANGENT"), index, 3..=3, [0.0; 3])?;
                add(&mut along, weight, &moves);
            }
        }
        let mut is_mirrored = Vec::new();
        if let Some(skin) = &pose.skin {
            let matrices = self.matrices(skin)?;
            is_mirrored = matrices
                .iter()
                .map(|m| m.matrix3.determinant() < 0.0)
                .collect();
            for (point, matrix) in points.iter_mut().zip(&matrices) {
                *point = matrix.transform_point3(*point);
            }
            for (i, direction) in directions.iter_mut().enumerate() {
                let side = if is_mirrored[i] { -1.0 } else { 1.0 };
                *direction = cofactors(&matrices[i].matrix3) * *direction * side;
            }
            for (i, tangent) in along.iter_mut().enumerate() {
                *tangent = matrices[i].matrix3 * *tangent;
                if is_mirrored[i] {
                    tangents[i].w = -tangents[i].w;
                }
            }
        }
        for (to, from) in positions.iter_mut().zip(points) {
            *to = from.as_vec3();
        }
        for (to, from) in normals.into_iter().flatten().zip(directions) {
            *to = from.try_normalize().map_or(Vec3::ZERO, |n| n.as_vec3());
        }
        for (to, from) in tangents.iter_mut().zip(along) {
            *to = from
                .try_normalize()
                .map_or(Vec4::ZERO, |t| t.as_vec3().extend(to.w));
        }
        Ok(is_mirrored)
    }

    /// The matrix of each vertex.
    fn matrices(&self, skin: &Skin) -> Result<Vec<DAffine3>, String> {
        let mut sets = Vec::new();
        for &(set, joints, weights) in &self.group.attributes.joints {
            let joints = self.read(&format!("JOINTS_{set}"), joints, 4..=4, [0.0; 4])?;
            let weights = self.open(&format!("WEIGHTS_{set}"), weights, 4..=4)?;
            let weights = weights.into_normalized();
            sets.push((joints, weights.read(self.used, [0.0; 4])));
        }
        let budget = self.document.budget;
        budget.charge_many(self.used.len(), size_of::<DAffine3>(), self.element)?;
        let mut influences = Vec::with_capacity(4 * sets.len());
        let mut matrices = Vec::with_capacity(self.used.len());
        for (i, vertex) in self.used.iter().enumerate() {
            influences.clear();
            for (joint, weight) in sets.iter().flat_map(|(j, w)| j[i].into_iter().zip(w[i])) {
                // Whole numbers of at most 16 bits.
                let joint = joint as usize;
                if joint < skin.len() {
                    influences.push((joint, f64::from(weight)));
                } else if weight.abs() > 0.0 {
                    let count = skin.len();
                    return Err(format!(
                        "JOINTS: vertex {vertex} names joint {joint} of {count}"
                    ));
                }
            }
            matrices.push(skin.blend(&influences));
        }
        Ok(matrices)
    }
}

fn add(values: &mut [DVec3], weight: f64, moves: &[[f32; 3]]) {
    for (value, by) in values.iter_mut().zip(moves) {
        *value += weight * Vec3::from(*by).as_dvec3();
    }
}

/// The inverse transpose times the determinant, which exists without an inverse. It takes normals along.
fn cofactors(m: &DMat3) -> DMat3 {
    DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    )
}

/// Turns the triangles of `runs` that joints mirror, so that their front stays their front. `is_mirrored` counts from vertex `base`.
fn turn(mesh: &mut TriangleMesh, runs: &[Range<usize>], base: usize, is_mirrored: &[bool]) {
    if !is_mirrored.contains(&true) {
        return;
    }
    for run in runs {
        for triangle in &mut mesh.triangles[run.clone()] {
            if is_mirrored[triangle[0] as usize - base] {
                triangle.swap(1, 2);
            }
        }
    }
}

/// Makes the triangles of `runs` name the vertices that they use in the order of the accessor, behind those that the mesh
/// already has. Gives those vertices, as the accessor counts, ascending. `charge` is asked for elements and their size.
fn renumber(
    mesh: &mut TriangleMesh,
    runs: &[Range<usize>],
    charge: impl Fn(usize, usize) -> Result<(), String>,
) -> Result<Vec<u32>, String> {
    const UNUSED: u32 = u32::MAX;
    let base = mesh.positions.len();
    let corners = |triangles: &[[u32; 3]]| {
        let low = triangles.as_flattened().iter().copied().min();
        low.zip(triangles.as_flattened().iter().copied().max())
    };
    let (low, high) = runs
        .iter()
        .filter_map(|run| corners(&mesh.triangles[run.clone()]))
        .reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
        .unwrap_or((0, 0));
    // One place for each vertex between the least and the greatest: they are there, and indices name them.
    charge((high - low) as usize + 1, 2 * size_of::<u32>())?;
    let mut place = vec![UNUSED; (high - low) as usize + 1];
    for run in runs {
        for &v in mesh.triangles[run.clone()].as_flattened() {
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
            for v in mesh.triangles[run.clone()].as_flattened_mut() {
                *v = place[(*v - low) as usize];
            }
        }
    }
    Ok(used)
}
