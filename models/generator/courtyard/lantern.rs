//! Lanterns of iron and glass on brackets, each with a point light.

use serde_json::json;

use super::super::gltf::{Document, Node};
use super::super::shapes::Shape;
use super::group::{Group, Pose};
use super::materials::Materials;
use super::solids::{Point, block, lathe};

/// The meshes of lanterns, and their light.
pub(super) struct Lanterns {
    frame: usize,
    glass: usize,
    light: usize,
}

impl Lanterns {
    pub(super) fn new(document: &mut Document, materials: &Materials) -> Self {
        let mut frame = Shape::default();
        let half = 0.09;
        for (x, z) in [(-half, -half), (half, -half), (half, half), (-half, half)] {
            let post = block(
                [x - 0.009, -0.15, z - 0.009],
                [x + 0.009, 0.15, z + 0.009],
                0.0,
            );
            frame.join(&post, [0.0; 3]);
        }
        let foot = block([-0.11, -0.175, -0.11], [0.11, -0.15, 0.11], 0.006);
        frame.join(&foot, [0.0; 3]);
        let roof = [
            [0.0, 0.15],
            [0.165, 0.15],
            [0.165, 0.165],
            [0.07, 0.25],
            [0.05, 0.27],
            [0.05, 0.30],
            [0.0, 0.31],
        ];
        frame.join(&lathe(&roof, 4).quarter_straight(), [0.0; 3]);
        // The bracket: an arm from the wall, 0.28 behind, and a plate on the wall.
        let arm = block([-0.012, 0.33, -0.28], [0.012, 0.355, 0.02], 0.0);
        frame.join(&arm, [0.0; 3]);
        let hook = block([-0.008, 0.29, -0.008], [0.008, 0.34, 0.008], 0.0);
        frame.join(&hook, [0.0; 3]);
        let plate = block([-0.04, 0.22, -0.28], [0.04, 0.42, -0.265], 0.0);
        frame.join(&plate, [0.0; 3]);
        let glass = block([-0.075, -0.145, -0.075], [0.075, 0.145, 0.075], 0.0);
        let mut mesh = |name, shape: &Shape, material| {
            let geometry = document.geometry(shape);
            document.mesh_of(name, geometry, material)
        };
        Self {
            frame: mesh("lantern frame", &frame, materials.iron),
            glass: mesh("lantern glass", &glass, materials.lamp),
            light: document.light(json!({
                "name": "lantern",
                "type": "point",
                "color": [1.0, 0.62, 0.28],
                "intensity": 3.0,
                "range": 5.5,
            })),
        }
    }

    /// A lantern 0.28 m before a wall that looks along +z, turned by `facing` degrees.
    pub(super) fn put(&self, document: &mut Document, name: &'static str, at: Point, facing: f64) {
        let mut group = Group::new();
        group.put(document, "lantern frame", self.frame, Pose::at([0.0; 3]));
        group.put(document, "lantern glass", self.glass, Pose::at([0.0; 3]));
        // Below the foot, lest the lantern hide its own light.
        group.hang(
            document,
            Node {
                name,
                translation: Some([0.0, -0.24, 0.0]),
                light: Some(self.light),
                ..Node::default()
            },
        );
        group.finish(document, name, Pose::at(at).facing(facing));
    }
}

impl Shape {
    /// A lathe of four sides turned so that its sides look along x and z, with flat faces.
    fn quarter_straight(&self) -> Self {
        let mut shape = Self::default();
        let turned = |v: u16| {
            let [x, y, z] = self.positions[usize::from(v)].map(f64::from);
            let half = std::f64::consts::FRAC_1_SQRT_2;
            [(x + z) * half, y, (z - x) * half]
        };
        for triangle in &self.triangles {
            shape.face(&triangle.map(turned));
        }
        shape
    }
}
