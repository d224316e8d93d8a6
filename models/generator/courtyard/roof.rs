//! Roofs of clay: rows of half-round tiles, each a little askew, over a slab of their colour.

use super::super::gltf::Document;
use super::super::shapes::{Shape, turn};
use super::chance::Chance;
use super::group::{Group, Pose};
use super::materials::Materials;
use super::solids::{Point, TEXTURE_SIZE, block};

/// From one row of tiles to the next, along the eaves.
const PITCH: f64 = 0.27;

/// How much of a tile is not covered by the next one above.
const EXPOSED: f64 = 0.41;

/// Pieces of a tile's half circle.
const PIECES: u32 = 5;

/// A half-round tile that lies on y = 0, its wide end at z = 0 and its narrow end under the next tile, at z < 0. It is hollow, as one
/// sees at the eaves, or filled with mortar.
fn tile(is_hollow: bool) -> Shape {
    let mut shape = Shape::default();
    let length = EXPOSED + 0.08;
    let (wide, narrow, thickness) = (0.128, 0.106, 0.017);
    let ring = |radius: f64, z: f64| -> Vec<(Point, Point)> {
        (0..=PIECES)
            .map(|i| {
                let (sin, cos) = turn(f64::from(i) / f64::from(PIECES) / 2.0);
                ([radius * cos, radius * sin, z], [cos, sin, 0.0])
            })
            .collect()
    };
    let mut skin = |near: &[(Point, Point)], far: &[(Point, Point)], is_outer: bool| {
        let first = shape.positions.len() as u16;
        for ends in near.iter().zip(far) {
            for (position, normal) in [ends.0, ends.1] {
                let normal = if is_outer {
                    *normal
                } else {
                    normal.map(|v| -v)
                };
                let uv = [position[0], position[2]].map(|v| v / TEXTURE_SIZE);
                shape.corner(*position, normal, uv);
            }
        }
        for i in 0..PIECES as u16 {
            let a = first + 2 * i;
            let (b, c, d) = (a + 2, a + 3, a + 1);
            shape.cell(if is_outer { [a, d, c, b] } else { [a, b, c, d] });
        }
    };
    let (outer, outer_far) = (ring(wide, 0.0), ring(narrow, -length));
    let (inner, inner_far) = (
        ring(wide - thickness, 0.0),
        ring(narrow - thickness, -length),
    );
    skin(&outer, &outer_far, true);
    if !is_hollow {
        let end: Vec<Point> = outer.iter().map(|(p, _)| *p).collect();
        shape.face(&end);
        return shape;
    }
    skin(&inner, &inner_far, false);
    for i in 0..PIECES as usize {
        let [a, b, c, d] = [inner[i], outer[i], outer[i + 1], inner[i + 1]].map(|(p, _)| p);
        shape.face(&[a, b, c, d]);
    }
    shape
}

/// The meshes of roofs.
pub(super) struct Roofing {
    tiles: [usize; 4],
    hollow: [usize; 4],
}

impl Roofing {
    pub(super) fn new(document: &mut Document, materials: &Materials) -> Self {
        let mut tiles = |name, is_hollow| {
            let geometry = document.geometry(&tile(is_hollow));
            materials.clay.map(|m| document.mesh_of(name, geometry, m))
        };
        Self {
            tiles: tiles("roof tile", false),
            hollow: tiles("eaves tile", true),
        }
    }

    /// A slope of tiles: the eaves along x, `width` long with its middle at the origin, rising towards -z over `run` to `rise`.
    pub(super) fn slope(
        &self,
        document: &mut Document,
        materials: &Materials,
        [width, run, rise]: [f64; 3],
        seed: u64,
    ) -> Group {
        let mut chance = Chance::new(seed);
        let mut group = Group::new();
        let length = (run * run + rise * rise).sqrt();
        let angle = libm::atan2(rise, run) * 180.0 / std::f64::consts::PI;
        // In the plane of the slope; the group is tilted as a whole.
        let rows = (length / EXPOSED).round().max(1.0) as u32;
        let columns = (width / PITCH).round() as u32;
        let start = -f64::from(columns - 1) * PITCH / 2.0;
        for row in 0..rows {
            for column in 0..columns {
                let at = [
                    start + f64::from(column) * PITCH + chance.about(0.006),
                    0.018,
                    0.06 - f64::from(row) * EXPOSED + chance.about(0.012),
                ];
                // The wide end lies on the tile below.
                let pose = Pose::at(at)
                    .turned([1.0, 0.0, 0.0], -2.2 + chance.about(0.5))
                    .facing(chance.about(1.1));
                let weights = [0, 0, 0, 1, 1, 2, 2, 3];
                // Through a hollow tile of a single row one would see the sky.
                let is_hollow = row == 0 && rows > 1;
                let tiles = if is_hollow { self.hollow } else { self.tiles };
                let mesh = tiles[chance.pick(&weights)];
                group.put(document, "roof tile", mesh, pose);
            }
        }
        let slab = block(
            [-width / 2.0, -0.09, -length],
            [width / 2.0, 0.0, 0.03],
            0.0,
        );
        let slab = document.geometry(&slab);
        let slab = document.mesh_of("roof slab", slab, materials.clay[2]);
        group.put(document, "roof slab", slab, Pose::at([0.0; 3]));
        let mut tilted = Group::new();
        let pose = Pose::at([0.0; 3]).turned([1.0, 0.0, 0.0], angle);
        tilted.add(document, "roof slope", group, pose);
        tilted
    }
}
