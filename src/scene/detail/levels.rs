//! Which levels of a mesh are asked for, and the meshes that they become.

use std::collections::BTreeMap;
use std::sync::Mutex;

use rayon::prelude::*;

use super::budget::Budget;
use super::chunks::{self, Piece};
use super::simplify::{Coarse, Names, simplify};
use crate::scene::{Instance, Part, TriangleMesh};

/// Share of a mesh's triangles above which a level of it is not worth the while, and the mesh itself is shown.
const WORTHWHILE: f64 = 0.9;

/// A mesh, and the instances that show it.
pub(super) struct Level {
    pub(super) mesh: TriangleMesh,
    /// Triangles that it had.
    pub(super) full: u64,
    /// The instances, each with its error in pixels.
    pub(super) instances: Vec<(usize, f64)>,
}

impl Level {
    /// A mesh as it is.
    pub(super) fn whole(mesh: TriangleMesh, instances: &[usize]) -> Self {
        Self {
            full: mesh.triangles.len() as u64,
            instances: instances.iter().map(|&i| (i, 0.0)).collect(),
            mesh,
        }
    }

    /// Whether it has fewer triangles than the file's mesh.
    pub(super) fn is_simplified(&self) -> bool {
        (self.mesh.triangles.len() as u64) < self.full
    }
}

/// The mesh of a single instance: every piece as coarse as it may be by itself. `protected`: the parts that stay as they are.
pub(super) fn of_one(
    mesh: TriangleMesh,
    (index, instance): (usize, &Instance),
    budget: &Budget,
    protected: &[bool],
) -> Level {
    let error = |piece: &Piece| budget.error(piece, &mesh, instance, 1);
    let Some((coarse, ratio)) = coarser(&mesh, protected, error) else {
        return Level::whole(mesh, &[index]);
    };
    Level {
        mesh: coarse,
        full: mesh.triangles.len() as u64,
        instances: vec![(index, ratio * budget.pixels)],
    }
}

/// The meshes of several instances: one for each octave of the errors that they allow, as exact as the one that allows least.
pub(super) fn of_several(
    mesh: TriangleMesh,
    shown_by: &[usize],
    instances: &[Instance],
    budget: &Budget,
    protected: &[bool],
) -> Vec<Level> {
    let all = Piece::all(&mesh);
    let allowed = |&index: &usize| {
        let error = budget.error(&all, &mesh, &instances[index], shown_by.len());
        (index, error)
    };
    let allowed: Vec<(usize, f64)> = shown_by.par_iter().map(allowed).collect();
    let mut octaves: BTreeMap<i32, Vec<(usize, f64)>> = BTreeMap::new();
    for (index, error) in allowed {
        // The exponent of zero and of what is below all numbers is the least.
        let octave = libm::ilogb(error);
        octaves.entry(octave).or_default().push((index, error));
    }
    let level = |members: &Vec<(usize, f64)>| {
        let least = members.iter().map(|m| m.1).fold(f64::INFINITY, f64::min);
        let (coarse, ratio) = coarser(&mesh, protected, |_| least)?;
        let pixels = |error: f64| ratio * least / error * budget.pixels;
        Some(Level {
            mesh: coarse,
            full: mesh.triangles.len() as u64,
            instances: members
                .iter()
                .map(|&(index, error)| (index, pixels(error)))
                .collect(),
        })
    };
    let octaves: Vec<Vec<(usize, f64)>> = octaves.into_values().collect();
    let found: Vec<Option<Level>> = octaves.par_iter().with_max_len(1).map(level).collect();
    let mut levels = Vec::new();
    let mut others = Vec::new();
    for (members, level) in octaves.iter().zip(found) {
        match level {
            Some(level) => levels.push(level),
            None => others.extend(members.iter().map(|m| m.0)),
        }
    }
    if !others.is_empty() {
        levels.push(Level::whole(mesh, &others));
    }
    levels
}

/// The mesh with pieces as coarse as `allowed` says, and the greatest share that any has used of what it was allowed; `None` if too little is gained.
fn coarser(
    mesh: &TriangleMesh,
    protected: &[bool],
    allowed: impl Fn(&Piece) -> f64 + Sync,
) -> Option<(TriangleMesh, f64)> {
    let pieces = chunks::of(mesh);
    // As many as threads work at it.
    let rooms = Mutex::new(Vec::new());
    let coarsest = |(part, piece): &(usize, Piece)| {
        if protected[*part] {
            return None;
        }
        let allowed = allowed(piece);
        let room = rooms.lock().ok().and_then(|mut rooms| rooms.pop());
        let mut names = room.unwrap_or_else(|| Names::new(mesh));
        let coarse = simplify(mesh, piece, allowed, &mut names);
        if let Ok(mut rooms) = rooms.lock() {
            rooms.push(names);
        }
        coarse.map(|coarse| {
            let share = coarse.deviation / allowed;
            (coarse, share)
        })
    };
    let simplified: Vec<Option<(Coarse, f64)>> =
        pieces.par_iter().with_max_len(1).map(coarsest).collect();
    let mut parts: Vec<Part> = mesh
        .parts
        .iter()
        .map(|part| Part {
            triangle_count: 0,
            ..*part
        })
        .collect();
    let mut triangles = Vec::new();
    let mut most = 0.0_f64;
    for ((part, piece), coarse) in pieces.iter().zip(simplified) {
        let before = triangles.len();
        if let Some((coarse, share)) = coarse {
            triangles.extend(coarse.triangles);
            most = most.max(share);
        } else {
            triangles.extend(piece.triangles().map(|t| mesh.triangles[t as usize]));
        }
        parts[*part].triangle_count += (triangles.len() - before) as u32;
    }
    if triangles.len() as f64 > mesh.triangles.len() as f64 * WORTHWHILE {
        return None;
    }
    let mut first = 0;
    for part in &mut parts {
        part.first_triangle = first;
        first += part.triangle_count;
    }
    Some((with_triangles(mesh, triangles, parts), most))
}

/// A mesh of some of another's vertices. The file's polygons are gone.
fn with_triangles(
    mesh: &TriangleMesh,
    mut triangles: Vec<[u32; 3]>,
    parts: Vec<Part>,
) -> TriangleMesh {
    const UNUSED: u32 = u32::MAX;
    let mut new_names = vec![UNUSED; mesh.positions.len()];
    let mut used = Vec::new();
    for vertex in triangles.iter_mut().flatten() {
        let name = &mut new_names[*vertex as usize];
        if *name == UNUSED {
            *name = used.len() as u32;
            used.push(*vertex);
        }
        *vertex = *name;
    }
    TriangleMesh {
        triangles,
        parts,
        ..mesh.with_vertices(&used)
    }
}
