//! The node hierarchy: what the scene places, and where. Transforms are composed in double precision.
//!
//! What KHR_node_visibility hides is not placed, nor is what hangs from it.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};
use serde_json::{Map, Value};

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
    /// Of each node that the scene shows, and, where joints are needed, of all that hang from somewhere.
    worlds: Vec<Option<DAffine3>>,
}

impl Placements {
    pub(super) fn world_from_node(&self, node: usize) -> Option<DAffine3> {
        self.worlds.get(node).copied().flatten()
    }
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
    let mut placements = Placements {
        worlds: vec![None; nodes.len()],
        ..Placements::default()
    };
    // Nodes with the transform of what they hang from and whether that shows, the next one last.
    let mut stack: Vec<(usize, DAffine3, bool)> = Vec::new();
    let mut has_skins = false;
    for root in roots(document, notes)?.into_iter().rev() {
        claim(document, &mut parents, root, Parent::Scene)?;
        stack.push((root, DAffine3::IDENTITY, true));
    }
    while let Some((node, world_from_parent, parent_shows)) = stack.pop() {
        let json = &nodes[node];
        let pose = &document.poses[node];
        let note = |text: &str| notes.add(document.node_label(node), text);
        let parent_from_node = local_transform(pose, note);
        let world_from_node = world_from_parent * parent_from_node;
        if !world_from_node.is_finite() {
            let cause = "its transform is not finite";
            return Err(document.invalid(document.node_label(node), cause));
        }
        placements.worlds[node] = Some(world_from_node);
        let extensions = json.extensions.as_ref().map(|e| &e.others);
        let shows = parent_shows && is_visible(extensions);
        let placed = |what| Placed {
            node,
            what,
            world_from_node,
        };
        placements
            .cameras
            .extend(json.camera.map(|c| placed(c.value())));
        if shows {
            let mesh = json.mesh.map(|m| placed(m.value()));
            placements.meshes.extend(mesh);
            has_skins |= mesh.is_some() && json.skin.is_some();
            let light = Extension::find(extensions, "KHR_lights_punctual");
            let light = light.and_then(|l| l.index("light"));
            placements.lights.extend(light.map(placed));
        }
        let children = json.children.as_deref().unwrap_or_default();
        for child in children.iter().rev() {
            claim(document, &mut parents, child.value(), Parent::Node(node))?;
            stack.push((child.value(), world_from_node, shows));
        }
    }
    if has_skins {
        place_the_others(document, &mut placements.worlds, notes);
    }
    Ok(placements)
}

fn is_visible(extensions: Option<&Map<String, Value>>) -> bool {
    let extension = Extension::find(extensions, "KHR_node_visibility");
    extension.and_then(|e| e.flag("visible")) != Some(false)
}

/// Finds the places of nodes outside the scene: against the specification, some files keep their joints there.
fn place_the_others(document: &Document, worlds: &mut [Option<DAffine3>], notes: &mut Notes) {
    let unseen = |node: &usize| worlds[*node].is_none();
    let tops: Vec<usize> = tops(document).into_iter().filter(unseen).collect();
    let mut stack: Vec<(usize, DAffine3)> =
        tops.into_iter().map(|n| (n, DAffine3::IDENTITY)).collect();
    while let Some((node, world_from_parent)) = stack.pop() {
        // A node that is not there, or one with a place already.
        if worlds.get(node).is_none_or(Option::is_some) {
            continue;
        }
        let note = |text: &str| notes.add(document.node_label(node), text);
        let world_from_node = world_from_parent * local_transform(&document.poses[node], note);
        worlds[node] = Some(world_from_node);
        let children = document.root.nodes[node].children.iter().flatten();
        stack.extend(children.map(|c| (c.value(), world_from_node)));
    }
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
    let roots = tops(document);
    if roots.is_empty() && !root.nodes.is_empty() {
        let cause = "each is the child of another: the graph has a cycle and no beginning";
        return Err(document.invalid("nodes", cause));
    }
    notes.add("scenes", "the file has none: all of its nodes are shown");
    Ok(roots)
}

/// The nodes that are nobody's children.
fn tops(document: &Document) -> Vec<usize> {
    let nodes = &document.root.nodes;
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().filter_map(|n| n.children.as_ref()).flatten() {
        if let Some(c) = is_child.get_mut(child.value()) {
            *c = true;
        }
    }
    (0..nodes.len()).filter(|&n| !is_child[n]).collect()
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

/// A node's own transform: `parent_from_node`. `note` is told what is odd about it.
pub(super) fn local_transform(pose: &Pose, mut note: impl FnMut(&str)) -> DAffine3 {
    if let Some(m) = pose.matrix {
        let column = |c: usize| DVec3::new(m[4 * c], m[4 * c + 1], m[4 * c + 2]);
        let last_row = DVec4::new(m[3], m[7], m[11], m[15]);
        if last_row != DVec4::W {
            let text = "the last row of its matrix is not 0 0 0 1; it is ignored";
            note(text);
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
                note("its rotation has no direction; it is ignored");
                DQuat::IDENTITY
            },
            DQuat::from_vec4,
        )
    });
    let scale = pose.scale.map_or(DVec3::ONE, DVec3::from);
    let translation = pose.translation.map_or(DVec3::ZERO, DVec3::from);
    DAffine3::from_scale_rotation_translation(scale, rotation, translation)
}
