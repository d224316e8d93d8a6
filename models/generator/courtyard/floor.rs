//! Paving: stone octagons with glazed insets in the court, clay squares in the walks. Every tile lies a little askew, as laid by hand.

use super::super::gltf::Document;
use super::super::shapes::Shape;
use super::chance::Chance;
use super::group::{Group, Pose};
use super::materials::Materials;
use super::plan::{HALF, WALK};
use super::solids::{Point, block};

/// From one octagon to the next.
const PITCH: f64 = 11.0 / 18.0;

/// From one clay tile to the next.
const CLAY_PITCH: f64 = 0.4;

/// Half the width of joints.
const JOINT: f64 = 0.004;

/// How thick tiles are; their tops are at y = 0.
const THICKNESS: f64 = 0.03;

/// A tile without underside: a convex polygon (counter-clockwise seen from above, x and z) with a rim that slopes by `bevel`.
fn tile(outline: &[[f64; 2]], bevel: f64) -> Shape {
    let mut shape = Shape::default();
    let reach = outline
        .iter()
        .map(|[x, z]| (x * x + z * z).sqrt())
        .fold(0.0, f64::max);
    let inner = 1.0 - bevel / reach;
    let ring = |scale: f64, y: f64| -> Vec<Point> {
        let place = |[x, z]: &[f64; 2]| [x * scale, y, z * scale];
        outline.iter().map(place).collect()
    };
    let (top, foot) = (ring(inner, 0.0), ring(1.0, -THICKNESS));
    shape.face(&top);
    for i in 0..outline.len() {
        let next = (i + 1) % outline.len();
        shape.face(&[foot[i], foot[next], top[next], top[i]]);
    }
    shape
}

/// A square, `half` from its middle to its sides, whose corners are cut off by `cut`.
fn octagon(half: f64, cut: f64) -> Vec<[f64; 2]> {
    let (a, b) = (half, half - cut);
    [
        [a, b],
        [a, -b],
        [b, -a],
        [-b, -a],
        [-a, -b],
        [-a, b],
        [-b, a],
        [b, a],
    ]
    .to_vec()
}

/// A pose with a little chance in height, tilt and turn.
fn laid(chance: &mut Chance, at: Point, turn: f64) -> Pose {
    let [x, y, z] = at;
    Pose::at([x, y + chance.about(0.0015), z])
        .turned([1.0, 0.0, 0.0], chance.about(0.25))
        .turned([0.0, 0.0, 1.0], chance.about(0.25))
        .facing(turn + chance.about(0.35))
}

/// The floor of the court and of the walks to the north and the south.
pub(super) fn floor(document: &mut Document, materials: &Materials) {
    let mut chance = Chance::new(1);
    let mut court = Group::new();
    let cut = 0.13;
    let stone = document.geometry(&tile(&octagon(PITCH / 2.0 - JOINT, cut - JOINT), 0.008));
    let stones = materials
        .paving
        .map(|m| document.mesh_of("paving stone", stone, m));
    let diamond = cut - 2.5 * JOINT;
    let dot = [
        [diamond, 0.0],
        [0.0, -diamond],
        [-diamond, 0.0],
        [0.0, diamond],
    ];
    let dot = document.geometry(&tile(&dot, 0.006));
    let dot = document.mesh_of("inset", dot, materials.inset);
    let count = ((2.0 * HALF) / PITCH).round() as u32;
    let line = |i: u32| f64::from(i) * PITCH - HALF;
    for row in 0..count {
        for column in 0..count {
            let at = [line(column) + PITCH / 2.0, 0.0, line(row) + PITCH / 2.0];
            if at[0] * at[0] + at[2] * at[2] < 1.2 {
                continue;
            }
            let mesh = chance.pick(&stones);
            let pose = laid(&mut chance, at, 90.0 * f64::from(row + column));
            court.put(document, "paving stone", mesh, pose);
            if row > 0 && column > 0 {
                let at = [line(column), 0.0, line(row)];
                court.put(document, "inset", dot, laid(&mut chance, at, 0.0));
            }
        }
    }
    court.finish(document, "court floor", Pose::at([0.0; 3]));
    walks(document, materials, &mut chance);

    let bed = document.geometry(&block([-40.0, -0.5, -40.0], [40.0, -0.02, 40.0], 0.0));
    let bed = document.mesh_of("ground", bed, materials.earth);
    let mut ground = Group::new();
    ground.put(document, "ground", bed, Pose::at([0.0; 3]));
    ground.finish(document, "ground", Pose::at([0.0; 3]));
}

fn walks(document: &mut Document, materials: &Materials, chance: &mut Chance) {
    let half = CLAY_PITCH / 2.0 - JOINT;
    let square = [[half, half], [half, -half], [-half, -half], [-half, half]];
    let clay = document.geometry(&tile(&square, 0.007));
    let clays = materials
        .terracotta
        .map(|m| document.mesh_of("clay tile", clay, m));
    let columns = (2.0 * HALF / CLAY_PITCH).ceil() as u32 + 1;
    let deep = (WALK / CLAY_PITCH).round() as u32;
    // Rows go away from the court; before the west arcade there is a terrace.
    for (name, rows, facing) in [
        ("north walk floor", deep, 180.0),
        ("south walk floor", deep, 0.0),
        ("west terrace", 5, -90.0),
    ] {
        let mut walk = Group::new();
        for row in 0..rows {
            for column in 0..columns {
                let x = f64::from(column) * CLAY_PITCH - HALF;
                let z = HALF + (f64::from(row) + 0.5) * CLAY_PITCH;
                let mesh = chance.pick(&clays);
                let pose = laid(chance, [x, 0.0, z], 0.0);
                walk.put(document, "clay tile", mesh, pose);
            }
        }
        walk.finish(document, name, Pose::at([0.0; 3]).facing(facing));
    }
}
