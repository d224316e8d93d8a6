//! A courtyard in the evening sun: arcades around a fountain, a house with a stair, roofs of clay tiles, plants in pots.
//!
//! Metres, y up; x to the east, z to the south. A sun (from the south-west, low), lanterns, two cameras; no sky, which files
//! cannot hold. Parts that repeat are meshes shared by nodes.

mod arcade;
mod arch;
mod chance;
mod column;
mod floor;
mod fountain;
mod group;
mod lantern;
mod materials;
mod plan;
mod plants;
mod ranges;
mod roof;
mod solids;
mod stair;
mod textures;
mod walls;

use std::io;

use serde_json::json;

use self::group::{Group, Pose};
use self::lantern::Lanterns;
use self::materials::Materials;
use self::plan::{HALF, WALK};
use self::plants::Plants;
use self::solids::Point;
use super::gltf::{Document, Node, looking};

/// From the court towards the sun, 31 degrees above the horizon. Lower, it would not come over the west arcade to the fountain.
const SUN: Point = [-0.74, 0.50, 0.38];

/// The whole model.
pub(super) fn glb() -> io::Result<Vec<u8>> {
    let mut document = Document::new("courtyard");
    let materials = Materials::new(&mut document)?;
    floor::floor(&mut document, &materials);
    ranges::ranges(&mut document, &materials);
    fountain::fountain(&mut document, &materials);
    garden(&mut document, &materials);
    lights(&mut document, &materials);
    cameras(&mut document);
    document.finish_glb()
}

fn garden(document: &mut Document, materials: &Materials) {
    let plants = Plants::new(document, materials);
    let mut court = Group::new();
    let tree = plants.orange_tree(document, 31);
    court.add(document, "orange tree", tree, Pose::at([3.1, 0.0, 3.4]));
    for (seed, is_in_bloom, scale, at) in [
        (33, true, 1.0, [-1.1, 0.0, -4.7]),
        (34, true, 1.0, [1.1, 0.0, -4.7]),
        (35, false, 0.8, [3.6, 0.0, -4.6]),
        (36, true, 0.62, [5.15, 0.70, 2.2]),
        (37, false, 0.62, [5.15, 1.225, 1.3]),
        (38, true, 0.62, [5.15, 1.75, 0.4]),
    ] {
        let bush = plants.bush(document, is_in_bloom, scale, seed);
        court.add(document, "potted bush", bush, Pose::at(at));
    }
    for (scale, turn, at) in [
        (0.95, 0.0, [-6.0, 0.0, 4.0]),
        (0.95, 20.0, [1.75, 0.0, 4.75]),
        (0.85, 140.0, [3.95, 0.0, 1.5]),
    ] {
        let agave = plants.agave(document, scale);
        court.add(document, "agave", agave, Pose::at(at).facing(turn));
    }
    plants.jar(
        document,
        &mut court,
        true,
        Pose::at([2.5, 0.0, 4.4]).scaled(0.85),
    );
    plants.jar(
        document,
        &mut court,
        false,
        Pose::at([3.85, 0.0, 2.5]).scaled(1.05),
    );
    plants.jar(
        document,
        &mut court,
        false,
        Pose::at([-6.05, 0.0, 0.05]).scaled(0.92),
    );
    let climber = plants.climber(document, [4.2, 2.3], 100, 41);
    let pose = Pose::at([HALF - 0.08, 6.55, -3.4]).facing(-90.0);
    court.add(document, "bougainvillea", climber, pose);
    court.finish(document, "plants", Pose::at([0.0; 3]));

    let mut beyond = Group::new();
    for (seed, height, at) in [
        (51, 10.5, [-7.6, 0.0, -11.0]),
        (52, 12.0, [-9.6, 0.0, -13.5]),
    ] {
        let cypress = plants.cypress(document, height, seed);
        beyond.add(document, "cypress", cypress, Pose::at(at));
    }
    beyond.finish(document, "trees", Pose::at([0.0; 3]));
}

fn lights(document: &mut Document, materials: &Materials) {
    let sun = document.light(json!({
        "name": "sun",
        "type": "directional",
        "color": [1.0, 0.80, 0.56],
        "intensity": 4.6,
    }));
    document.root(Node {
        light: Some(sun),
        ..looking("sun", SUN.map(|v| v * 20.0), [0.0; 3])
    });
    let lanterns = Lanterns::new(document, materials);
    let wall = -HALF - WALK + 0.28;
    lanterns.put(
        document,
        "lantern left of the door",
        [-1.45, 2.35, wall],
        0.0,
    );
    lanterns.put(
        document,
        "lantern right of the door",
        [1.45, 2.35, wall],
        0.0,
    );
    for (name, x) in [
        ("lantern on the west post", -3.3),
        ("lantern on the east post", 3.3),
    ] {
        lanterns.put(document, name, [x, 3.0, HALF + WALK - 0.11 - 0.28], 180.0);
    }
    lanterns.put(
        document,
        "lantern on the stair",
        [HALF - 0.28, 4.7, -0.95],
        -90.0,
    );
}

fn cameras(document: &mut Document) {
    for (name, yfov, eye, target) in [
        (
            "through the arcade",
            0.73,
            [-9.4, 1.6, 4.3],
            [0.8, 1.83, -0.9],
        ),
        ("from the stair", 0.86, [4.9, 5.0, -2.6], [-0.8, 1.2, 1.4]),
    ] {
        let camera = document.camera(json!({
            "name": name,
            "type": "perspective",
            "perspective": { "aspectRatio": 16.0 / 9.0, "yfov": yfov, "znear": 0.05, "zfar": 200.0 },
        }));
        document.root(Node {
            camera: Some(camera),
            ..looking(name, eye, target)
        });
    }
}
