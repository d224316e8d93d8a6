//! The node hierarchy: what the scene places, and where. Transforms are composed in double precision.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use super::document::{Document, Pose};
use super::extensions::Extension;
use super::notes::Notes;
use crate::import::ImportError;

/// Something (a mesh, a camera, a light) that a node places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) node: usize,
    /// Index of what is placed, as the file counts; not checked.
    pub(super) what: usize,
    pub(super) world_from_node: DAffine3,
}

/// All that a scene places, in the order of a walk through its nodes.
#[derive(Debug, Default)]
pub(super) struct Placements {
    pub(super) meshes: Vec<Placed>,
    pub(super) cameras: Vec<Placed>,
    pub(super) lights: Vec<Placed>,
}

/// Where a node hangs.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Parent {
    Unseen,
    Scene,
    Node(usize),
}

/// Walks the scene that the file shows first. The walk keeps its own stack: files nest deeper than ours is.
pub(super) fn walk(document: &Document, notes: &mut Notes) -> Result<Placements, ImportError> {
    let nodes = &document.root.nodes;
    let mut parents = vec![Parent::Unseen; nodes.len()];
    let mut placements = Placements::default();
    // Nodes with the transform of what they hang from, the next one last.
    let mut stack: Vec<(usize, DAffine3)> = Vec::new();
    for root in roots(document, notes)?.into_iter().rev() {
        claim(document, &mut parents, root, Parent::Scene)?;
        stack.push((root, DAffine3::IDENTITY));
    }
    while let Some((node, world_from_parent)) = stack.pop() {
        let json = &nodes[node];
        let pose = &document.poses[node];
        let parent_from_node = transform(pose, || document.node_label(node), notes);
        let world_from_node = world_from_parent * parent_from_node;
        if !world_from_node.is_finite() {
            let cause = "its transform is not finite";
            return Err(document.invalid(document.node_label(node), cause));
        }
        let placed = |what| Placed {
            node,
            what,
            world_from_node,
        };
        placements
            .meshes
            .extend(json.mesh.map(|m| placed(m.value())));
        placements
            .cameras
            .extend(json.camera.map(|c| placed(c.value())));
        let extensions = json.extensions.as_ref().map(|e| &e.others);
        let light = Extension::find(extensions, "KHR_lights_punctual");
        placements
            .lights
            .extend(light.and_then(|l| l.index("light")).map(placed));
        if json.skin.is_some() {
            let text = "its skin is left out: shown in its bind pose";
            notes.add(document.node_label(node), text);
        }
        let children = json.children.as_deref().unwrap_or_default();
        for child in children.iter().rev() {
            claim(document, &mut parents, child.value(), Parent::Node(node))?;
            stack.push((child.value(), world_from_node));
        }
    }
    if document.has_animations {
        let text = "left out: nodes stay where the file places them";
        notes.add("animations", text);
    }
    Ok(placements)
}

/// The nodes at which the walk begins.
fn roots(document: &Document, notes: &mut Notes) -> Result<Vec<usize>, ImportError> {
    let root = &document.root;
    let shown = root.scene.map_or(0, |s| s.value());
    if let Some(scene) = root.scenes.get(shown) {
        if root.scenes.len() > 1 {
            let others = root.scenes.len() - 1;
            let text = format!("only scene {shown} is shown; others left out: {others}");
            notes.add("scenes", text);
        }
        return Ok(scene.nodes.iter().map(|n| n.value()).collect());
    }
    if !root.scenes.is_empty() || root.scene.is_some() {
        let cause = format!("is not there: the file has {}", root.scenes.len());
        return Err(document.invalid(format!("scene {shown}"), cause));
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root
        .nodes
        .iter()
        .filter_map(|n| n.children.as_ref())
        .flatten()
    {
        if let Some(c) = is_child.get_mut(child.value()) {
            *c = true;
        }
    }
    let roots: Vec<usize> = (0..root.nodes.len()).filter(|&n| !is_child[n]).collect();
    if roots.is_empty() && !root.nodes.is_empty() {
        let cause = "each is the child of another: the graph has a cycle and no beginning";
        return Err(document.invalid("nodes", cause));
    }
    notes.add("scenes", "the file has none: all of its nodes are shown");
    Ok(roots)
}

/// Notes where `node` hangs, and refuses a second place.
fn claim(
    document: &Document,
    parents: &mut [Parent],
    node: usize,
    parent: Parent,
) -> Result<(), ImportError> {
    let name = |p| match p {
        Parent::Node(n) => document.node_label(n),
        Parent::Scene | Parent::Unseen => "the scene".to_owned(),
    };
    let Some(&first) = parents.get(node) else {
        let cause = format!(
            "names node {node}, which is not there: the file has {}",
            parents.len()
        );
        return Err(document.invalid(name(parent), cause));
    };
    if first == Parent::Unseen {
        parents[node] = parent;
        return Ok(());
    }
    let mut above = parent;
    while let Parent::Node(n) = above {
        if n == node {
            let cause = format!(
                "hangs from itself: {} names it as a child and is below it",
                name(parent)
            );
            return Err(document.invalid(document.node_label(node), cause));
        }
        above = parents[n];
    }
    let cause = format!(
        "hangs twice: from {} and from {}",
        name(first),
        name(parent)
    );
    Err(document.invalid(document.node_label(node), cause))
}

/// A node's own transform.
fn transform(pose: &Pose, label: impl Fn() -> String, notes: &mut Notes) -> DAffine3 {
    if let Some(m) = pose.matrix {
        let column = |c: usize| DVec3::new(m[4 * c], m[4 * c + 1], m[4 * c + 2]);
        let last_row = DVec4::new(m[3], m[7], m[11], m[15]);
        if last_row != DVec4::W {
            let text = "the last row of its matrix is not 0 0 0 1; it is ignored";
            notes.add(label(), text);
        }
        return DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        };
    }
    let rotation = pose.rotation.map_or(DQuat::IDENTITY, |[x, y, z, w]| {
        let unit = DVec4::new(x, y, z, w).try_normalize();
        unit.map_or_else(
            || {
                notes.add(label(), "its rotation has no direction; it is ignored");
                DQuat::IDENTITY
            },
            DQuat::from_vec4,
        )
    });
    let scale = pose.scale.map_or(DVec3::ONE, DVec3::from);
    let translation = pose.translation.map_or(DVec3::ZERO, DVec3::from);
    DAffine3::from_scale_rotation_translation(scale, rotation, translation)
}
