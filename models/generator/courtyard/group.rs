//! Parts of the scene: nodes with a common parent.

use super::super::gltf::{Document, Node, rotation, turns};
use super::solids::Point;

/// Where a mesh stands: turned, stretched, then moved.
#[derive(Clone, Copy)]
pub(super) struct Pose {
    at: Point,
    rotation: Option<[f32; 4]>,
    scale: Option<[f64; 3]>,
}

impl Pose {
    /// At a place, as it was modelled.
    pub(super) fn at(at: Point) -> Self {
        Self {
            at,
            rotation: None,
            scale: None,
        }
    }

    /// Turned, after what was said before, around a unit axis, counter-clockwise seen from its tip.
    pub(super) fn turned(mut self, axis: Point, degrees: f64) -> Self {
        let turn = rotation(axis, degrees);
        self.rotation = Some(self.rotation.map_or(turn, |first| turns(first, turn)));
        self
    }

    /// Turned around the vertical.
    pub(super) fn facing(self, degrees: f64) -> Self {
        self.turned([0.0, 1.0, 0.0], degrees)
    }

    /// Stretched along its own axes, before it is turned.
    pub(super) fn stretched(mut self, scale: [f64; 3]) -> Self {
        self.scale = Some(scale);
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
            translation: Some(self.at.map(short)),
            rotation: self.rotation.map(|r| r.map(|v| short(f64::from(v)))),
            scale: self.scale.map(|s| s.map(short)),
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
