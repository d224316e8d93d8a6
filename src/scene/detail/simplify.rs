//! A piece made coarser: vertices joined within cells, then edges collapsed by the crate `meshopt`, with quadric error metrics (Garland and Heckbert 1997, and 1998 for attributes), within the piece's border.
//!
//! What the crate calls an error is the root of a mean square over planes, not a bound. So the distance that counts is measured afterwards ([`deviation`](super::deviation)), and a piece that has
//! become too coarse is made anew, finer.

use glam::Vec3;
use meshopt::{SimplifyOptions, VertexDataAdapter, simplify_with_attributes_and_locks};

use super::chunks::Piece;
use super::cluster;
use super::deviation::{Surface, deviation};
use crate::scene::TriangleMesh;

/// Change of a unit normal that counts as much as the greatest distance: 14 degrees. Smaller: more triangles for bumps that are no more than shading; larger: bumps lose their shading. On
/// smooth balls 0.1 to 5 made no difference.
const NORMAL_STEP: f32 = 0.25;

/// Change of a linear colour that does so.
const COLOR_STEP: f32 = 0.04;

/// Steps beyond which values of attributes are not told apart.
const MOST_STEPS: f32 = 1e9;

/// Sets of texture coordinates that are looked at: `meshopt` takes 32 numbers a vertex.
const MOST_SETS: usize = 8;

/// Tries, until one is near enough: the edge of the cells within which vertices are joined first, and what the metric is allowed then, both in shares of the distance that is. A metric that is far below the
/// truth, and features that are smaller than cells, need several.
const TRIES: [(f32, f32); 4] = [(3.0, 0.5), (1.2, 0.4), (0.4, 0.25), (0.0, 0.05)];

/// Of how many triangles one must be left when vertices have been joined for edges not to be collapsed any more: that takes two or three times as long for each as to build over it.
const ENOUGH: usize = 8;

/// A piece that has become coarser.
pub(super) struct Coarse {
    /// Its triangles, by vertices of the mesh.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The greatest distance of a vertex that was left out from the surface, in object space.
    pub(super) deviation: f64,
}

/// A piece with vertices of its own.
struct Local {
    /// For each vertex, that of the mesh.
    names: Vec<u32>,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// Room for the local names of a mesh's vertices.
pub(super) struct Names(Vec<u32>);

impl Names {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        Self(vec![u32::MAX; mesh.positions.len()])
    }
}

impl Local {
    fn new(mesh: &TriangleMesh, piece: &Piece, Names(names): &mut Names) -> Self {
        let mut local = Self {
            names: Vec::new(),
            positions: Vec::new(),
            triangles: Vec::with_capacity(piece.len()),
        };
        for triangle in piece.triangles() {
            let corners = mesh.triangles[triangle as usize].map(|vertex| {
                let name = &mut names[vertex as usize];
                if *name == u32::MAX {
                    *name = local.names.len() as u32;
                    local.names.push(vertex);
                    local.positions.push(mesh.positions[vertex as usize]);
                }
                *name
            });
            local.triangles.push(corners);
        }
        // So that the room can be used again.
        for &vertex in &local.names {
            names[vertex as usize] = u32::MAX;
        }
        local
    }

    /// The piece with vertices joined within cells, and for each vertex the one that it has become.
    fn joined(&self, cell: f32) -> Option<(Self, Vec<u32>)> {
        let clusters = cluster::join(&self.positions, &self.triangles, cell)?;
        let mut new_names = vec![u32::MAX; self.names.len()];
        let mut joined = Self {
            names: Vec::new(),
            positions: Vec::new(),
            triangles: clusters.triangles,
        };
        let mut named = |vertex: u32| {
            let name = &mut new_names[vertex as usize];
            if *name == u32::MAX {
                *name = joined.names.len() as u32;
                joined.names.push(self.names[vertex as usize]);
                joined.positions.push(self.positions[vertex as usize]);
            }
            *name
        };
        let become_of = clusters.become_of.into_iter().map(&mut named).collect();
        joined
            .triangles
            .iter_mut()
            .flatten()
            .for_each(|v| *v = named(*v));
        Some((joined, become_of))
    }

    /// The triangles that are left when edges have collapsed by an `error` of the metric, in units of the positions.
    fn collapsed(&self, mesh: &TriangleMesh, error: f32) -> Vec<[u32; 3]> {
        let places: Vec<[f32; 3]> = self.positions.iter().map(Vec3::to_array).collect();
        let extent = self.extent();
        let Ok(adapter) = VertexDataAdapter::new(bytemuck::cast_slice(&places), 12, 0) else {
            return self.triangles.clone();
        };
        let (attributes, count) = self.attributes(mesh, error);
        // In units of the extent, as positions are.
        let weights = vec![error / extent; count];
        let kept = simplify_with_attributes_and_locks(
            bytemuck::cast_slice(&self.triangles),
            &adapter,
            &attributes,
            &weights,
            count * size_of::<f32>(),
            &vec![false; self.names.len()],
            0,
            error,
            SimplifyOptions::LockBorder | SimplifyOptions::ErrorAbsolute,
            None,
        );
        bytemuck::cast_slice(&kept).to_vec()
    }

    /// The longest side of its box, in which `meshopt` reckons.
    fn extent(&self) -> f32 {
        let bounds: crate::geometry::Aabb = self.positions.iter().copied().collect();
        bounds.extent().max_element()
    }

    /// Numbers of each vertex that may not change much, each divided by the change that counts as much as a distance of `error`; and how many a vertex has.
    fn attributes(&self, mesh: &TriangleMesh, error: f32) -> (Vec<f32>, usize) {
        let mut columns: Vec<(f32, Vec<f32>)> = Vec::new();
        let mut add = |step: f32, value: &dyn Fn(usize) -> f32| {
            let column = self.names.iter().map(|&v| value(v as usize)).collect();
            columns.push((step, column));
        };
        if !mesh.normals.is_empty() {
            (0..3).for_each(|axis| add(NORMAL_STEP, &|v| mesh.normals[v][axis]));
        }
        if !mesh.colors.is_empty() {
            (0..4).for_each(|channel| add(COLOR_STEP, &|v| mesh.colors[v][channel]));
        }
        for set in mesh
            .uv_sets
            .iter()
            .take(MOST_SETS)
            .filter(|set| !set.is_empty())
        {
            // A texture may shift as far as the surface.
            let step = error * self.uv_per_length(set);
            (0..2).for_each(|axis| add(step, &|v| set[v][axis]));
        }
        let mut values = Vec::with_capacity(columns.len() * self.names.len());
        for vertex in 0..self.names.len() {
            for (step, column) in &columns {
                // Squares of it must stay numbers.
                let value = (column[vertex] / step).clamp(-MOST_STEPS, MOST_STEPS);
                values.push(if value.is_nan() { 0.0 } else { value });
            }
        }
        (values, columns.len())
    }

    /// How many units of texture coordinates one of length is, in the mean.
    fn uv_per_length(&self, set: &[glam::Vec2]) -> f32 {
        let (mut of_uv, mut of_surface) = (0.0, 0.0);
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|v| self.positions[v as usize].as_dvec3());
            of_surface += (b - a).cross(c - a).length();
            let [a, b, c] = corners.map(|v| set[self.names[v as usize] as usize].as_dvec2());
            of_uv += (b - a).perp_dot(c - a).abs();
        }
        (of_uv / of_surface).sqrt() as f32
    }
}

/// The coarsest form of a piece in which no vertex is farther than `allowed` from the surface, as far as the metric finds it; `None` if that has no fewer triangles.
pub(super) fn simplify(
    mesh: &TriangleMesh,
    piece: &Piece,
    allowed: f64,
    names: &mut Names,
) -> Option<Coarse> {
    let local = Local::new(mesh, piece, names);
    let extent = local.extent();
    let usable = allowed > 0.0 && extent > 0.0 && extent.is_finite();
    if !usable {
        return None;
    }
    // More would ask for nothing to be left.
    let allowed = allowed.min(f64::from(extent));
    for (cell, share) in TRIES {
        let joined = local.joined(allowed as f32 * cell);
        let (coarse, become_of) = match &joined {
            Some((coarse, become_of)) => (coarse, become_of.as_slice()),
            None => (&local, &[][..]),
        };
        let is_enough = coarse.triangles.len() * ENOUGH <= local.triangles.len();
        let kept = if is_enough {
            coarse.triangles.clone()
        } else {
            coarse.collapsed(mesh, allowed as f32 * share)
        };
        if kept.len() >= local.triangles.len() {
            return None;
        }
        let surface = Surface {
            positions: &coarse.positions,
            all: &coarse.triangles,
            kept: &kept,
        };
        let vertex = |v: usize| become_of.get(v).copied().unwrap_or(v as u32);
        let points = local.positions.iter().enumerate();
        let points = points.map(|(v, &place)| (place, vertex(v)));
        if let Some(deviation) = deviation(&surface, points, allowed) {
            let named = kept.iter().map(|t| t.map(|v| coarse.names[v as usize]));
            return Some(Coarse {
                triangles: named.collect(),
                deviation,
            });
        }
    }
    None
}
