//! Parts of the scene: nodes with a common parent.

use super::super::gltf::{Document, Node, rotation, turns};
use super::solids::Point;

/// Where a mesh stands: turned, stretched, then moved.
#[derive(Clone, Copy)]
pub(super) struct Pose {
    at: Point,
    rotation: [f32; 4],
    scale: [f64; 3],
}

const UNTURNED: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

impl Pose {
    /// At a place, as it was modelled.
    pub(super) fn at(at: Point) -> Self {
        Self {
            at,
            rotation: UNTURNED,
            scale: [1.0; 3],
        }
    }

    /// Turned, after what was said before, around a unit axis, counter-clockwise seen from its tip.
    pub(super) fn turned(mut self, axis: Point, degrees: f64) -> Self {
        self.rotation = turns(self.rotation, rotation(axis, degrees));
        self
    }

    /// Turned around the vertical.
    pub(super) fn facing(self, degrees: f64) -> Self {
        self.turned([0.0, 1.0, 0.0], degrees)
    }

    /// Stretched along its own axes.
    pub(super) fn stretched(mut self, scale: [f64; 3]) -> Self {
        self.scale = scale;
        self
    }

    /// Larger or smaller.
    pub(super) fn scaled(self, scale: f64) -> Self {
        self.stretched([scale; 3])
    }

    /// A node with this pose. Numbers are rounded, to tenths of a millimetre and the like, for a small file.
    fn node(self, name: &'static str) -> Node {
        let short = |v: f64| ((v * 1e4).round() / 1e4) as f32 + 0.0;
        Node {
            name,
            translation: (self.at != [0.0; 3]).then(|| self.at.map(short)),
            rotation: (self.rotation != UNTURNED)
                .then(|| self.rotation.map(|v| short(f64::from(v)))),
            scale: (self.scale != [1.0; 3]).then(|| self.scale.map(short)),
            ..Node::default()
        }
    }
}

/// Nodes that hang from one.
pub(super) struct Group {
    children: Vec<usize>,
}

impl Group {
    pub(super) fn new() -> Self {
        Self {
            children: Vec::new(),
        }
    }

    /// Places a mesh.
    pub(super) fn put(
        &mut self,
        document: &mut Document,
        name: &'static str,
        mesh: usize,
        pose: Pose,
    ) {
        self.children.push(document.child(Node {
            mesh: Some(mesh),
            ..pose.node(name)
        }));
    }

    /// Places what is no mesh.
    pub(super) fn hang(&mut self, document: &mut Document, node: Node) {
        self.children.push(document.child(node));
    }

    /// Hangs another group into this one.
    pub(super) fn add(
        &mut self,
        document: &mut Document,
        name: &'static str,
        group: Self,
        pose: Pose,
    ) {
        self.children.push(document.child(Node {
            children: group.children,
            ..pose.node(name)
        }));
    }

    /// Hangs the group into the scene.
    pub(super) fn finish(self, document: &mut Document, name: &'static str, pose: Pose) {
        document.root(Node {
            children: self.children,
            ..pose.node(name)
        });
    }
}
