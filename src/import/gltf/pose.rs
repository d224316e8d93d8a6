//! The shapes of a file's meshes: each with what bends it, morph targets and a skin. glTF 2.0 specification, sections 3.7.2.2
//! and 3.7.3.
//!
//! A mesh that several nodes show alike is one shape. A mesh with a skin has its vertices in world space, since its
//! joints place it and its node does not.

use std::collections::HashMap;

use ::gltf::json::mesh::Semantic;
use ::gltf::json::validation::Checked;
use glam::DAffine3;

use super::document::Document;
use super::nodes::{Placed, Placements};
use super::skin::{self, Skin};
use crate::import::ImportError;

/// Most vertices that skins and morph targets may make of a file's meshes, as 128 bytes a vertex fit into 16 GiB. Each node can
/// ask for its own copy of a mesh, which costs nothing in the file.
const MOST_POSED_VERTICES: u64 = 1 << 27;

/// A mesh as one or more nodes show it.
#[derive(Debug)]
pub(super) struct Shape {
    /// Index of the file's mesh, which is there.
    pub(super) mesh: usize,
    pub(super) pose: MeshPose,
}

/// What bends a mesh.
#[derive(Debug, Default)]
pub(super) struct MeshPose {
    /// How far each morph target is gone to. Targets beyond are not.
    pub(super) weights: Vec<f64>,
    pub(super) skin: Option<Skin>,
}

/// The shapes that are placed, and for each of `placements.meshes` the index of its own.
pub(super) fn shapes(
    document: &Document,
    placements: &Placements,
) -> Result<(Vec<Shape>, Vec<usize>), ImportError> {
    let count = document.root.meshes.len();
    let mut shapes = Vec::new();
    let (mut known, mut skins) = (HashMap::new(), HashMap::new());
    let mut places = Vec::with_capacity(placements.meshes.len());
    let mut vertices = 0_u64;
    for placed in &placements.meshes {
        let Placed { node, what, .. } = *placed;
        if what >= count {
            let cause = format!("mesh {what} is not there: the file has {count}");
            return Err(document.invalid(document.node_label(node), cause));
        }
        let weights = weights(document, node, what);
        // Compared with those of other nodes, bit by bit.
        let label = || document.node_label(node);
        let charged = document.budget.charge_many(weights.len(), 16, label);
        charged.map_err(|cause| document.invalid(label(), cause))?;
        let has_skin = document.root.nodes[node].skin.is_some();
        let bits: Vec<u64> = weights.iter().map(|w| w.to_bits()).collect();
        let key = (what, bits, has_skin.then_some(node));
        let shape = match known.get(&key) {
            Some(&shape) => shape,
            None => {
                if has_skin || !weights.is_empty() {
                    vertices = vertices.saturating_add(claimed_vertices(document, what));
                }
                if vertices > MOST_POSED_VERTICES {
                    let cause = format!(
                        "skins and morph targets make more than {MOST_POSED_VERTICES} vertices"
                    );
                    return Err(document.invalid(document.node_label(node), cause));
                }
                let skin = skin::read(document, node, placements, &mut skins)?;
                let pose = MeshPose { weights, skin };
                shapes.push(Shape { mesh: what, pose });
                known.insert(key, shapes.len() - 1);
                shapes.len() - 1
            }
        };
        places.push(shape);
    }
    // The shapes of one mesh one after the other, in the order of the file.
    let mut order: Vec<usize> = (0..shapes.len()).collect();
    order.sort_by_key(|&s| shapes[s].mesh);
    let mut new_place = vec![0; shapes.len()];
    for (new, &old) in order.iter().enumerate() {
        new_place[old] = new;
    }
    shapes.sort_by_key(|s: &Shape| s.mesh);
    Ok((shapes, places.into_iter().map(|s| new_place[s]).collect()))
}

/// The node's own weights, or else the mesh's, without the zeros at the end.
fn weights(document: &Document, node: usize, mesh: usize) -> Vec<f64> {
    let own = document.poses[node].weights.clone();
    let of_mesh = || {
        let weights = document.root.meshes[mesh].weights.iter().flatten();
        weights.map(|&w| f64::from(w)).collect()
    };
    let mut weights: Vec<f64> = own.unwrap_or_else(of_mesh);
    for weight in &mut weights {
        if !weight.is_finite() {
            *weight = 0.0;
        }
    }
    let targets = document.root.meshes[mesh].primitives.iter();
    let most = targets.filter_map(|p| p.targets.as_ref().map(Vec::len));
    weights.truncate(most.max().unwrap_or(0));
    // A weight of zero is exact, and has no effect.
    while weights.last().is_some_and(|&w| w == 0.0) {
        weights.pop();
    }
    weights
}

fn claimed_vertices(document: &Document, mesh: usize) -> u64 {
    let primitives = document.root.meshes[mesh].primitives.iter();
    let positions = primitives.filter_map(|p| {
        let index = p.attributes.get(&Checked::Valid(Semantic::Positions))?;
        document.root.accessors.get(index.value())
    });
    positions.map(|a| a.count.0).fold(0, u64::saturating_add)
}

impl MeshPose {
    /// Whether the vertices stay where the file has them.
    pub(super) fn is_at_rest(&self) -> bool {
        self.weights.is_empty() && self.skin.is_none()
    }

    /// The placement of the mesh under a node: none, if joints place it.
    pub(super) fn placement(&self, world_from_node: DAffine3) -> DAffine3 {
        match self.skin {
            Some(_) => DAffine3::IDENTITY,
            None => world_from_node,
        }
    }
}
