//! A piece made coarser, within its border: vertices joined within cells, and where that leaves many, edges collapsed by the crate `meshopt`, with quadric error metrics (Garland and Heckbert 1997, and 1998 for
//! attributes).
//!
//! How far the vertices that are left out are from the surface is measured ([`deviation`](super::deviation)). Where it is too far, or where normals, colours or texture coordinates there are not what they were, cells are divided, there alone.
//! What the crate calls an error is the root of a mean square over planes, not a bound: what it made is measured as well, and where it is too far its vertices are locked.

use glam::{Vec2, Vec3};
use meshopt::{SimplifyOptions, VertexDataAdapter, simplify_with_attributes_and_locks};

use super::chunks::Piece;
use super::cluster::{Clusters, Patch};
use super::deviation::{Deviation, Surface};
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

/// Edge of the cells within which vertices are joined, in shares of the distance that is allowed: a surface is nearer to its vertices than they are to one another. Where it is not, cells are divided.
const CELL: f32 = 8.0;

/// By what cells are divided, and how often before vertices stay by themselves. The last have a diagonal shorter than what is allowed.
const DIVISION: f32 = 0.4;
const DIVISIONS: usize = 3;

/// Of how many triangles one must be left when vertices have been joined for edges not to be collapsed any more: that takes longer for each than to build over it.
const ENOUGH: usize = 2;

/// What the metric is allowed, in shares of the distance that is.
const METRIC: f32 = 0.5;

/// How often edges are collapsed anew, with the vertices locked where the surface was too far.
const TRIES: usize = 3;

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

    fn patch(&self) -> Patch<'_> {
        Patch {
            positions: &self.positions,
            triangles: &self.triangles,
        }
    }

    /// The vertices joined within cells as large as the `allowed` distance permits, and how far they are from the triangles that are left.
    fn joined(&self, attributes: &Attributes, allowed: f64) -> (Clusters, f64) {
        const NOWHERE: [u32; 3] = [0; 3];
        let patch = self.patch();
        let place = |v: u32| self.positions[v as usize];
        let mut cell = allowed as f32 * CELL;
        let mut clusters = Clusters::new(patch, cell, allowed * allowed);
        let mut deviation = Deviation::none(allowed);
        // The corners of the triangle that each is near to.
        let mut near = vec![NOWHERE; self.names.len()];
        let mut unsure: Vec<u32> = (0..self.names.len() as u32).collect();
        for division in 1.. {
            let surface = Surface {
                positions: &self.positions,
                all: &|| clusters.all(patch),
                kept: &clusters.triangles,
            };
            let points = unsure.iter().map(|&v| (v, place(v), clusters.of(v)));
            deviation.measure(&surface, points, allowed, |v, corners| {
                near[v as usize] = corners;
                let moved = (place(v) - place(clusters.of(v))).as_dvec3();
                moved.length_squared() <= allowed * allowed
                    || attributes.are_alike(v, corners, self.weights(v, corners))
            });
            for &v in &deviation.far {
                near[v as usize] = NOWHERE;
            }
            deviation.far.extend(clusters.folds.iter().flatten());
            if deviation.far.is_empty() {
                break;
            }
            let mut apart = self.marked(&clusters, &deviation.far);
            let is_last = division > DIVISIONS;
            if is_last {
                // And all around, so that no triangle of theirs is lost.
                spread(&mut apart, &clusters.all(patch));
            }
            unsure.clear();
            unsure.extend((0..self.names.len() as u32).filter(|&v| {
                let corners = near[v as usize];
                corners == NOWHERE || corners.iter().any(|&c| apart[c as usize])
            }));
            cell = if is_last { 0.0 } else { cell * DIVISION };
            let has_changed = clusters.divide(patch, cell, |v| apart[v as usize]);
            if is_last && !has_changed {
                // Vertices of lines and points alone.
                break;
            }
        }
        (clusters, deviation.most)
    }

    /// What is left of joined triangles when edges collapse as well, and how far vertices are from it; `None` if they are too far.
    fn collapsed(
        &self,
        clusters: &Clusters,
        attributes: &Attributes,
        allowed: f64,
    ) -> Option<(Vec<[u32; 3]>, f64)> {
        let places: Vec<[f32; 3]> = self.positions.iter().map(Vec3::to_array).collect();
        let adapter = VertexDataAdapter::new(bytemuck::cast_slice(&places), 12, 0).ok()?;
        let error = allowed as f32 * METRIC;
        // In units of the extent, as positions are.
        let weights = vec![error / self.extent(); attributes.count];
        let mut locked = vec![false; self.names.len()];
        for _ in 0..TRIES {
            let kept = simplify_with_attributes_and_locks(
                bytemuck::cast_slice(&clusters.triangles),
                &adapter,
                &attributes.values,
                &weights,
                attributes.count * size_of::<f32>(),
                &locked,
                0,
                error,
                SimplifyOptions::LockBorder | SimplifyOptions::ErrorAbsolute,
                None,
            );
            let kept: Vec<[u32; 3]> = bytemuck::cast_slice(&kept).to_vec();
            let surface = Surface {
                positions: &self.positions,
                all: &|| clusters.all(self.patch()),
                kept: &kept,
            };
            let points = self.positions.iter().zip(0..);
            let points = points.map(|(&place, v)| (v, place, clusters.of(v)));
            let mut deviation = Deviation::none(allowed);
            deviation.measure(&surface, points, allowed, |_, _| true);
            if deviation.far.is_empty() {
                return Some((kept, deviation.most));
            }
            let mut around = self.marked(clusters, &deviation.far);
            spread(&mut around, &clusters.triangles);
            for (locked, is_near) in locked.iter_mut().zip(around) {
                *locked |= is_near;
            }
        }
        None
    }

    /// What vertices have become, marked.
    fn marked(&self, clusters: &Clusters, vertices: &[u32]) -> Vec<bool> {
        let mut marked = vec![false; self.names.len()];
        for &v in vertices {
            marked[clusters.of(v) as usize] = true;
        }
        marked
    }

    /// What each corner of a triangle weighs at the foot of a vertex.
    fn weights(&self, vertex: u32, corners: [u32; 3]) -> [f32; 3] {
        let place = |v: u32| self.positions[v as usize].as_dvec3();
        let [a, b, c] = corners.map(|v| place(v) - place(vertex));
        let normal = (b - a).cross(c - a);
        let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|n| n.dot(normal).max(0.0));
        let sum: f64 = weights.iter().sum();
        match sum > 0.0 {
            true => weights.map(|w| (w / sum) as f32),
            false => [1.0, 0.0, 0.0],
        }
    }

    /// The longest side of its box, in which `meshopt` reckons.
    fn extent(&self) -> f32 {
        let bounds: crate::geometry::Aabb = self.positions.iter().copied().collect();
        bounds.extent().max_element()
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

/// Marks all corners of triangles of which one is marked.
fn spread(marked: &mut [bool], triangles: &[[u32; 3]]) {
    let is_at = |t: &&[u32; 3]| t.iter().any(|&v| marked[v as usize]);
    let at: Vec<&[u32; 3]> = triangles.iter().filter(is_at).collect();
    for &v in at.into_iter().flatten() {
        marked[v as usize] = true;
    }
}

/// Numbers of each vertex that may not change much, each divided by the change that counts as much as the distance that is allowed.
struct Attributes {
    values: Vec<f32>,
    /// How many a vertex has.
    count: usize,
}

impl Attributes {
    fn new(mesh: &TriangleMesh, local: &Local, allowed: f32) -> Self {
        // A texture may shift as far as the surface.
        let sets = mesh.uv_sets.iter().filter(|set| !set.is_empty());
        let sets: Vec<(&[Vec2], f32)> = sets
            .take(MOST_SETS)
            .map(|set| (set.as_slice(), 1.0 / (allowed * local.uv_per_length(set))))
            .collect();
        let mut values = Vec::new();
        for &vertex in &local.names {
            let vertex = vertex as usize;
            if let Some(normal) = mesh.normals.get(vertex) {
                values.extend((*normal / NORMAL_STEP).to_array());
            }
            if let Some(color) = mesh.colors.get(vertex) {
                values.extend((*color / COLOR_STEP).to_array());
            }
            for (set, scale) in &sets {
                values.extend((set[vertex] * *scale).to_array());
            }
        }
        for value in &mut values {
            // Squares of it must stay numbers.
            let number = value.clamp(-MOST_STEPS, MOST_STEPS);
            *value = if number.is_nan() { 0.0 } else { number };
        }
        Self {
            count: values.len() / local.names.len().max(1),
            values,
        }
    }

    /// Whether a vertex's numbers are no farther than a step from those of a triangle, with weights for its corners.
    fn are_alike(&self, vertex: u32, corners: [u32; 3], weights: [f32; 3]) -> bool {
        let of = |v: u32| &self.values[v as usize * self.count..][..self.count];
        let [a, b, c] = corners.map(of);
        (0..self.count).all(|i| {
            let there = a[i] * weights[0] + b[i] * weights[1] + c[i] * weights[2];
            (there - of(vertex)[i]).abs() <= 1.0
        })
    }
}

/// The coarsest form of a piece in which no vertex is farther than `allowed` from the surface, as far as it is found; `None` if that has no fewer triangles.
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
    let attributes = Attributes::new(mesh, &local, allowed as f32);
    let (clusters, deviation) = local.joined(&attributes, allowed);
    let is_enough = clusters.triangles.len() * ENOUGH <= local.triangles.len();
    let fewer = if is_enough {
        None
    } else {
        local.collapsed(&clusters, &attributes, allowed)
    };
    let (kept, deviation) = fewer.unwrap_or((clusters.triangles, deviation));
    if kept.len() >= local.triangles.len() {
        return None;
    }
    let named = kept.iter().map(|t| t.map(|v| local.names[v as usize]));
    Some(Coarse {
        triangles: named.collect(),
        deviation,
    })
}
