//! Skins: what moves the vertices of a mesh with joints. glTF 2.0 specification, section 3.7.3.3.
//!
//! A joint's matrix is `world_from_joint * joint_from_mesh` (the inverse bind matrix), composed in double precision. A vertex has
//! the weighted mean of its joints' matrices. The transform of the node that shows the mesh does not count.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::accessor::Accessor;
use super::document::{Document, label};
use super::nodes::Placements;
use crate::import::ImportError;

/// The joints of a skin, as they stand.
#[derive(Debug)]
pub(super) struct Skin {
    /// For each joint.
    world_from_mesh: Arc<[DAffine3]>,
    /// For vertices that no joint moves.
    pub(super) world_from_node: DAffine3,
}

/// The skin of a node, if it has one. `known` keeps the joints of each, which many nodes may name.
pub(super) fn read(
    document: &Document,
    node: usize,
    placements: &Placements,
    known: &mut HashMap<usize, Arc<[DAffine3]>>,
) -> Result<Option<Skin>, ImportError> {
    let Some(index) = &document.root.nodes[node].skin else {
        return Ok(None);
    };
    let index = index.value();
    let world_from_mesh = match known.get(&index) {
        Some(joints) => Arc::clone(joints),
        None => Arc::from(joints(document, node, index, placements)?),
    };
    known.insert(index, Arc::clone(&world_from_mesh));
    Ok(Some(Skin {
        world_from_mesh,
        world_from_node: placements
            .world_from_node(node)
            .unwrap_or(DAffine3::IDENTITY),
    }))
}

/// The matrices of the joints of skin `index`, which `node` names.
fn joints(
    document: &Document,
    node: usize,
    index: usize,
    placements: &Placements,
) -> Result<Vec<DAffine3>, ImportError> {
    let skins = &document.root.skins;
    let Some(json) = skins.get(index) else {
        let cause = format!("skin {index} is not there: the file has {}", skins.len());
        return Err(document.invalid(document.node_label(node), cause));
    };
    let element = label("skin", index, json.name.as_ref());
    let invalid = |cause: String| document.invalid(&element, cause);
    let binds = match &json.inverse_bind_matrices {
        Some(accessor) => {
            Some(binds(document, accessor.value(), json.joints.len()).map_err(invalid)?)
        }
        None => None,
    };
    let mut world_from_mesh = Vec::with_capacity(json.joints.len());
    for (i, joint) in json.joints.iter().enumerate() {
        let node = joint.value();
        let count = document.root.nodes.len();
        if node >= count {
            let cause = format!("joint {i}: node {node} is not there: the file has {count}");
            return Err(invalid(cause));
        }
        let Some(world_from_joint) = placements.world_from_node(node) else {
            let cause = format!(
                "joint {i}: {} has no place in the world",
                document.node_label(node)
            );
            return Err(invalid(cause));
        };
        let joint_from_mesh = binds.as_ref().map_or(DAffine3::IDENTITY, |b| b[i]);
        let matrix = world_from_joint * joint_from_mesh;
        if !matrix.is_finite() {
            return Err(invalid(format!("joint {i}: its transform is not finite")));
        }
        world_from_mesh.push(matrix);
    }
    Ok(world_from_mesh)
}

/// The first `count` inverse bind matrices. Their last rows, which must be 0 0 0 1, are not looked at.
fn binds(document: &Document, accessor: usize, count: usize) -> Result<Vec<DAffine3>, String> {
    let accessor = Accessor::open(document, accessor)?.with_width(16..=16)?;
    if accessor.count < count {
        let found = accessor.count;
        return Err(format!(
            "has {found} inverse bind matrices for {count} joints"
        ));
    }
    // Fits: the count of an accessor has 32 bits.
    let wanted: Vec<u32> = (0..count as u32).collect();
    let matrices = accessor.read(&wanted, [0.0_f32; 16]);
    let affine = |m: [f32; 16]| {
        let column = |c: usize| DVec3::from([m[4 * c], m[4 * c + 1], m[4 * c + 2]].map(f64::from));
        DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        }
    };
    Ok(matrices.into_iter().map(affine).collect())
}

impl Skin {
    /// Number of joints.
    pub(super) fn len(&self) -> usize {
        self.world_from_mesh.len()
    }

    /// The mean of the matrices of joints (which are there) by weight: that of the first where all weights are zero.
    ///
    /// The weights need not sum to 1: quantised ones, and those of careless exporters, do not.
    pub(super) fn blend(&self, influences: &[(usize, f64)]) -> DAffine3 {
        let sum: f64 = influences.iter().map(|(_, w)| w).sum();
        let first = influences
            .first()
            .and_then(|(j, _)| self.world_from_mesh.get(*j));
        if !(sum > 0.0 && sum.is_finite()) {
            return first.copied().unwrap_or(self.world_from_node);
        }
        let mut blended = DAffine3::ZERO;
        for (joint, weight) in influences {
            let (matrix, share) = (&self.world_from_mesh[*joint], weight / sum);
            blended.matrix3 += matrix.matrix3 * share;
            blended.translation += matrix.translation * share;
        }
        blended
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_go_with_the_weighted_mean_of_their_joints() {
        let skin = Skin {
            world_from_mesh: Arc::from(vec![
                DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0)),
                DAffine3::from_scale(DVec3::new(2.0, 3.0, 5.0)),
            ]),
            world_from_node: DAffine3::from_translation(DVec3::splat(9.0)),
        };
        let point = DVec3::new(1.0, 10.0, 100.0);
        let at = |influences: &[(usize, f64)]| skin.blend(influences).transform_point3(point);
        // A quarter of (2, 12, 103) and three of (2, 30, 500); the weights count by their shares.
        let mean = DVec3::new(2.0, 25.5, 400.75);
        assert_eq!(at(&[(0, 0.25), (1, 0.75)]), mean);
        assert_eq!(at(&[(0, 0.5), (1, 1.5)]), mean);
        assert_eq!(at(&[(1, 0.0), (0, 0.0)]), DVec3::new(2.0, 30.0, 500.0));
        assert_eq!(at(&[]), DVec3::new(10.0, 19.0, 109.0));
        assert_eq!(at(&[(1, f64::NAN)]), DVec3::new(2.0, 30.0, 500.0));
    }
}
