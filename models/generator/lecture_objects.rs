//! The objects of the lecture as a still life: every shape of its object list, on a ground plane, none touching another.
//!
//! Metres, y up. Meshes are shared between nodes that turn and stretch them, in hierarchies of up to three nodes. No light:
//! a renderer's default sky suits it.

use std::io;

use serde_json::json;

use super::gltf::{Document, Node, looking, rotation, sin_cos};
use super::shapes;

/// Air below each object and between stacked ones, so that no two surfaces coincide after rounding.
const GAP: f32 = 0.001;

/// Dimensions of the torus and the thin cylinder, which nodes need to put them on the ground.
const MAJOR: f32 = 0.55;
const MINOR: f32 = 0.2;
const ROD_RADIUS: f32 = 0.06;
const ROD_LENGTH: f32 = 3.2;

pub(super) fn gltf() -> io::Result<Vec<u8>> {
    let mut document = Document::new("lecture objects");
    let torus = shapes::torus(f64::from(MAJOR), f64::from(MINOR), 48, 20);
    let rod = shapes::cylinder(
        f64::from(ROD_RADIUS),
        f64::from(ROD_RADIUS),
        f64::from(ROD_LENGTH),
        32,
    );
    let tapered = shapes::cylinder(0.45, 0.2, 1.1, 40);
    let meshes = Meshes {
        plane: document.mesh("plane", &shapes::square(), [0.46, 0.45, 0.42], 0.9),
        square: document.mesh("square", &shapes::square(), [0.36, 0.22, 0.34], 0.8),
        cube: document.mesh("cube", &shapes::cube(), [0.83, 0.51, 0.13], 0.6),
        sphere: document.mesh("sphere", &shapes::sphere(40, 20), [0.05, 0.36, 0.4], 0.3),
        torus: document.mesh("torus", &torus, [0.74, 0.16, 0.1], 0.4),
        rod: document.mesh("thin cylinder", &rod, [0.13, 0.2, 0.46], 0.5),
        tapered: document.mesh("tapered cylinder", &tapered, [0.3, 0.43, 0.16], 0.7),
    };
    document.root(Node {
        name: "ground",
        mesh: Some(meshes.plane),
        scale: Some([60.0, 1.0, 60.0]),
        ..Node::default()
    });
    tower(&mut document, &meshes);
    round_things(&mut document, &meshes);
    flat_and_long_things(&mut document, &meshes);
    cameras(&mut document);
    document.finish()
}

/// The numbers of the meshes.
struct Meshes {
    plane: usize,
    square: usize,
    cube: usize,
    sphere: usize,
    torus: usize,
    rod: usize,
    tapered: usize,
}

/// Two cubes and a sphere, each standing on the one before and turned with it.
fn tower(document: &mut Document, meshes: &Meshes) {
    let ball = document.child(Node {
        name: "tower: ball",
        mesh: Some(meshes.sphere),
        translation: Some([0.1, 0.6 + 0.3 + GAP, -0.05]),
        scale: Some([0.6; 3]),
        ..Node::default()
    });
    let slab = document.child(Node {
        name: "tower: slab",
        mesh: Some(meshes.cube),
        translation: Some([0.0, 0.3, 0.0]),
        scale: Some([0.9, 0.6, 0.75]),
        ..Node::default()
    });
    let upper = document.child(Node {
        name: "tower: upper storey",
        translation: Some([0.05, 1.2 + GAP, 0.0]),
        rotation: Some(rotation([0.0, 1.0, 0.0], -35.0)),
        children: vec![slab, ball],
        ..Node::default()
    });
    let block = document.child(Node {
        name: "tower: block",
        mesh: Some(meshes.cube),
        translation: Some([0.0, 0.6, 0.0]),
        scale: Some([1.2; 3]),
        ..Node::default()
    });
    document.root(Node {
        name: "tower",
        translation: Some([-1.75, GAP, -0.5]),
        rotation: Some(rotation([0.0, 1.0, 0.0], 25.0)),
        children: vec![block, upper],
        ..Node::default()
    });
}

fn round_things(document: &mut Document, meshes: &Meshes) {
    document.root(Node {
        name: "ball",
        mesh: Some(meshes.sphere),
        translation: Some([0.2, 0.8 + GAP, -0.7]),
        scale: Some([1.6; 3]),
        ..Node::default()
    });
    document.root(Node {
        name: "pebble",
        mesh: Some(meshes.sphere),
        translation: Some([1.25, 0.2 + GAP, 1.35]),
        rotation: Some(rotation([0.0, 1.0, 0.0], 20.0)),
        scale: Some([0.9, 0.4, 0.55]),
        ..Node::default()
    });
    document.root(Node {
        name: "lying ring",
        mesh: Some(meshes.torus),
        translation: Some([-0.15, MINOR + GAP, 1.15]),
        ..Node::default()
    });
    // The mesh's axis is y: stretched along it, then laid on its side and turned.
    let ring = document.child(Node {
        name: "standing ring: ring",
        mesh: Some(meshes.torus),
        rotation: Some(rotation([1.0, 0.0, 0.0], 90.0)),
        scale: Some([1.0, 1.4, 1.0]),
        ..Node::default()
    });
    document.root(Node {
        name: "standing ring",
        translation: Some([1.95, MAJOR + MINOR + GAP, -0.35]),
        rotation: Some(rotation([0.0, 1.0, 0.0], -30.0)),
        children: vec![ring],
        ..Node::default()
    });
    document.root(Node {
        name: "cone",
        mesh: Some(meshes.tapered),
        translation: Some([-2.5, 0.55 + GAP, 1.2]),
        ..Node::default()
    });
    document.root(Node {
        name: "goblet",
        mesh: Some(meshes.tapered),
        translation: Some([2.75, 0.33 + GAP, 0.9]),
        rotation: Some(rotation([0.0, 0.0, 1.0], 180.0)),
        scale: Some([0.7, 0.6, 0.7]),
        ..Node::default()
    });
}

fn flat_and_long_things(document: &mut Document, meshes: &Meshes) {
    document.root(Node {
        name: "panel",
        mesh: Some(meshes.square),
        translation: Some([0.35, 1.0 + GAP, -2.1]),
        rotation: Some(rotation([1.0, 0.0, 0.0], 90.0)),
        scale: Some([2.6, 1.0, 2.0]),
        ..Node::default()
    });
    document.root(Node {
        name: "rod along y",
        mesh: Some(meshes.rod),
        translation: Some([-3.1, ROD_LENGTH / 2.0 + GAP, -1.4]),
        ..Node::default()
    });
    document.root(Node {
        name: "rod along x",
        mesh: Some(meshes.rod),
        translation: Some([0.1, ROD_RADIUS + GAP, 2.3]),
        rotation: Some(rotation([0.0, 0.0, 1.0], 90.0)),
        ..Node::default()
    });
    // A box around this rod is nearly all air. It leans, and its lower rim is just above the ground.
    let lean = 40.0;
    let (sin, cos) = sin_cos(lean);
    let height = f64::from(ROD_LENGTH) / 2.0 * cos + f64::from(ROD_RADIUS) * sin;
    let leaning = document.child(Node {
        name: "leaning rod: rod",
        mesh: Some(meshes.rod),
        rotation: Some(rotation([0.0, 0.0, 1.0], -lean)),
        ..Node::default()
    });
    document.root(Node {
        name: "leaning rod",
        translation: Some([3.0, height as f32 + GAP, -1.5]),
        rotation: Some(rotation([0.0, 1.0, 0.0], 30.0)),
        children: vec![leaning],
        ..Node::default()
    });
}

fn cameras(document: &mut Document) {
    let front = document.camera(json!({
        "name": "front",
        "type": "perspective",
        "perspective": { "yfov": 0.56, "znear": 0.1, "zfar": 200.0 },
    }));
    document.root(Node {
        camera: Some(front),
        ..looking("front", [0.6, 3.0, 9.2], [0.1, 1.05, -0.2])
    });
    let drawing = document.camera(json!({
        "name": "drawing",
        "type": "orthographic",
        "orthographic": { "xmag": 4.8, "ymag": 3.0, "znear": 0.1, "zfar": 200.0 },
    }));
    document.root(Node {
        camera: Some(drawing),
        ..looking("drawing", [-7.0, 6.5, 8.0], [0.3, 1.5, 0.0])
    });
}
