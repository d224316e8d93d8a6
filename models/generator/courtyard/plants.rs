//! Plants: leaves as folded blades on sprays, which are placed by the hundred; pots for them from the lathe.

use super::super::gltf::Document;
use super::super::shapes::{Shape, turn};
use super::chance::Chance;
use super::group::{Group, Pose};
use super::materials::Materials;
use super::solids::{Point, ball, cross, lathe, minus};

/// Adds a leaf: from `stem` along `along`, folded along its rib, `width` wide. `up` is roughly its upper side.
fn blade(shape: &mut Shape, stem: Point, along: Point, up: Point, width: f64) {
    let side = cross(along, up);
    let length = side.iter().map(|v| v * v).sum::<f64>().sqrt();
    let at = |forward: f64, aside: f64, lift: f64| -> Point {
        std::array::from_fn(|i| {
            stem[i] + along[i] * forward + side[i] / length * width * aside + up[i] * width * lift
        })
    };
    let (foot, rib, tip) = (at(0.0, 0.0, 0.0), at(0.5, 0.0, 0.0), at(1.0, 0.0, -0.25));
    for aside in [-0.5, 0.5] {
        let edge = at(0.42, aside, 0.28);
        for [a, b, c] in [[foot, edge, rib], [rib, edge, tip]] {
            let corners = if aside < 0.0 { [a, c, b] } else { [a, b, c] };
            shape.face(&corners);
        }
    }
}

fn unit(v: Point) -> Point {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

/// A spray of leaves about a twig from the origin upwards, one metre tall.
fn spray(leaves: u32, length: f64, width: f64, seed: u64) -> Shape {
    let mut chance = Chance::new(seed);
    let mut shape = Shape::default();
    for i in 0..leaves {
        let share = f64::from(i) / f64::from(leaves);
        // The golden angle, as many plants have it.
        let (sin, cos) = turn(share * f64::from(leaves) * 0.381_966 + chance.about(0.03));
        let rise = chance.between(0.25, 0.9) + share * 0.5;
        let direction = unit([sin, rise, cos]);
        let stem = [sin * 0.03, share * 0.8, cos * 0.03];
        let size = length * chance.between(0.75, 1.1) * (1.15 - 0.5 * share);
        let up = unit(minus([0.0, 1.0, 0.0], direction.map(|v| v * direction[1])));
        blade(
            &mut shape,
            stem,
            direction.map(|v| v * size),
            up,
            width * size / length,
        );
    }
    shape
}

/// A rosette of thick blades, as of an agave, one metre across.
fn rosette(seed: u64) -> Shape {
    let mut chance = Chance::new(seed);
    let mut shape = Shape::default();
    for i in 0..26_u32 {
        let share = f64::from(i) / 26.0;
        let (sin, cos) = turn(f64::from(i) * 0.381_966);
        let direction = unit([sin, 0.35 + 2.2 * share + chance.about(0.1), cos]);
        let up = unit(minus([0.0, 1.0, 0.0], direction.map(|v| v * direction[1])));
        let size = 0.55 - 0.12 * share;
        blade(
            &mut shape,
            [sin * 0.03, 0.0, cos * 0.03],
            direction.map(|v| v * size),
            up,
            0.12,
        );
    }
    shape
}

/// A garden pot: height 0.5, a rim with a roll, earth in it.
fn pot_profile() -> Vec<[f64; 2]> {
    vec![
        [0.0, 0.0],
        [0.17, 0.0],
        [0.20, 0.12],
        [0.235, 0.26],
        [0.265, 0.41],
        [0.285, 0.42],
        [0.30, 0.44],
        [0.30, 0.47],
        [0.285, 0.495],
        [0.26, 0.50],
        [0.24, 0.45],
        [0.0, 0.45],
    ]
}

/// An oil jar: height 1, a belly and a narrow neck.
fn jar_profile() -> Vec<[f64; 2]> {
    vec![
        [0.0, 0.0],
        [0.15, 0.0],
        [0.16, 0.02],
        [0.20, 0.12],
        [0.275, 0.30],
        [0.32, 0.47],
        [0.33, 0.58],
        [0.31, 0.70],
        [0.25, 0.81],
        [0.19, 0.87],
        [0.165, 0.90],
        [0.165, 0.93],
        [0.195, 0.96],
        [0.205, 0.98],
        [0.19, 1.0],
        [0.155, 0.99],
        [0.14, 0.93],
        [0.14, 0.80],
        [0.0, 0.78],
    ]
}

/// The meshes of plants and pots.
pub(super) struct Plants {
    pot: usize,
    jar: usize,
    glazed_jar: usize,
    trunk: usize,
    orange: usize,
    citrus: usize,
    bush: usize,
    blossom: usize,
    cypress: usize,
    agave: usize,
}

impl Plants {
    pub(super) fn new(document: &mut Document, materials: &Materials) -> Self {
        let mut mesh = |name, shape: &Shape, material| {
            let geometry = document.geometry(shape);
            document.mesh_of(name, geometry, material)
        };
        let jar = lathe(&jar_profile(), 24);
        let trunk = lathe(
            &[
                [0.0, 0.0],
                [0.05, 0.0],
                [0.036, 0.25],
                [0.033, 0.7],
                [0.028, 1.0],
                [0.0, 1.02],
            ],
            10,
        );
        let leaves = spray(11, 0.44, 0.22, 11);
        let needles = spray(9, 0.40, 0.15, 12);
        Self {
            pot: mesh("pot", &lathe(&pot_profile(), 20), materials.pot),
            jar: mesh("jar", &jar, materials.pot),
            glazed_jar: mesh("glazed jar", &jar, materials.glazed),
            trunk: mesh("trunk", &trunk, materials.bark),
            orange: mesh("orange", &ball(0.04, 8), materials.fruit),
            citrus: mesh("citrus spray", &leaves, materials.dark_leaf),
            bush: mesh("leaf spray", &leaves, materials.leaf),
            blossom: mesh("blossom spray", &leaves, materials.blossom),
            cypress: mesh("cypress spray", &needles, materials.cypress),
            agave: mesh("agave", &rosette(13), materials.agave),
        }
    }

    /// A jar without plant.
    pub(super) fn jar(
        &self,
        document: &mut Document,
        group: &mut Group,
        is_glazed: bool,
        pose: Pose,
    ) {
        let mesh = if is_glazed { self.glazed_jar } else { self.jar };
        group.put(document, "jar", mesh, pose);
    }

    /// An agave in a pot.
    pub(super) fn agave(&self, document: &mut Document, scale: f64) -> Group {
        let mut group = Group::new();
        group.put(document, "pot", self.pot, Pose::at([0.0; 3]).scaled(scale));
        let pose = Pose::at([0.0, 0.43 * scale, 0.0]).scaled(scale * 1.35);
        group.put(document, "agave", self.agave, pose);
        group
    }

    /// A bush of leaves, or of leaves and blossoms, in a pot.
    pub(super) fn bush(
        &self,
        document: &mut Document,
        is_in_bloom: bool,
        scale: f64,
        seed: u64,
    ) -> Group {
        let mut chance = Chance::new(seed);
        let mut group = Group::new();
        group.put(document, "pot", self.pot, Pose::at([0.0; 3]).scaled(scale));
        for i in 0..11 {
            let bloom = is_in_bloom && i % 2 == 0;
            let mesh = if bloom { self.blossom } else { self.bush };
            let at = [chance.about(0.1), 0.43, chance.about(0.1)].map(|v| v * scale);
            let pose = Pose::at(at)
                .scaled(scale * chance.between(0.3, 0.55))
                .turned([1.0, 0.0, 0.0], chance.between(5.0, 62.0))
                .facing(chance.between(0.0, 360.0));
            group.put(document, "leaf spray", mesh, pose);
        }
        group
    }

    /// A small orange tree in a large pot, about 2.4 m tall.
    pub(super) fn orange_tree(&self, document: &mut Document, seed: u64) -> Group {
        let mut chance = Chance::new(seed);
        let mut group = Group::new();
        group.put(document, "pot", self.pot, Pose::at([0.0; 3]).scaled(1.35));
        let pose = Pose::at([0.0, 0.58, 0.0]).stretched([1.0, 0.95, 1.0]);
        group.put(document, "trunk", self.trunk, pose);
        let centre = [0.0, 1.78, 0.0];
        for i in 0..84_u32 {
            // Evenly over a ball, from pole to pole by the golden angle.
            let height = 1.0 - 2.0 * (f64::from(i) + 0.5) / 84.0;
            let ring = (1.0 - height * height).sqrt();
            let azimuth = f64::from(i) * 0.381_966;
            let (sin, cos) = turn(azimuth);
            let out = chance.between(0.12, 0.42);
            let at = [
                centre[0] + ring * sin * out,
                centre[1] + height * out * 0.9,
                centre[2] + ring * cos * out,
            ];
            let lean = libm::acos(height) * 180.0 / std::f64::consts::PI;
            let pose = Pose::at(at)
                .scaled(chance.between(0.26, 0.36))
                .facing(chance.between(0.0, 360.0))
                .turned([1.0, 0.0, 0.0], lean * 0.85)
                .facing(azimuth % 1.0 * 360.0);
            group.put(document, "citrus spray", self.citrus, pose);
            if i % 7 == 3 {
                let reach = 0.56;
                let at = [
                    ring * sin * reach,
                    centre[1] + height * reach * 0.85,
                    ring * cos * reach,
                ];
                group.put(document, "orange", self.orange, Pose::at(at));
            }
        }
        group
    }

    /// A cypress as tall as `height`: sprays around a spindle.
    pub(super) fn cypress(&self, document: &mut Document, height: f64, seed: u64) -> Group {
        let mut chance = Chance::new(seed);
        let mut group = Group::new();
        let pose = Pose::at([0.0; 3]).stretched([2.5, height * 0.8, 2.5]);
        group.put(document, "trunk", self.trunk, pose);
        const SPRAYS: u32 = 50;
        for i in 0..SPRAYS {
            let share = f64::from(i) / f64::from(SPRAYS);
            let (sin, cos) = turn(f64::from(i) * 0.381_966);
            // A spindle: widest at a third of the height.
            let girth =
                height * 0.085 * libm::sin(std::f64::consts::PI * libm::sqrt(share * 0.96 + 0.03));
            let at = [
                sin * girth * 0.6,
                height * (0.04 + 0.84 * share),
                cos * girth * 0.6,
            ];
            let pose = Pose::at(at)
                .stretched([1.5, 1.2, 1.5].map(|v| v * height * 0.12 * chance.between(0.85, 1.2)))
                .turned([1.0, 0.0, 0.0], chance.between(8.0, 22.0))
                .facing(f64::from(i) * 0.381_966 % 1.0 * 360.0);
            group.put(document, "cypress spray", self.cypress, pose);
        }
        group
    }

    /// A climber that hangs over the edge of a wall along x, from `length` by `drop`, its wall at z = 0.
    pub(super) fn climber(
        &self,
        document: &mut Document,
        [length, drop]: [f64; 2],
        sprays: u32,
        seed: u64,
    ) -> Group {
        let mut chance = Chance::new(seed);
        let mut group = Group::new();
        for _ in 0..sprays {
            let along = chance.unit();
            // Longer in the middle, denser above.
            let bound = drop * (0.35 + 0.65 * libm::sin(std::f64::consts::PI * along));
            let down = chance.unit() * chance.unit();
            let at = [
                length * (along - 0.5),
                -bound * down,
                chance.between(0.0, 0.16),
            ];
            let mesh = if chance.unit() < 0.62 {
                self.blossom
            } else {
                self.bush
            };
            let pose = Pose::at(at)
                .scaled(chance.between(0.28, 0.48))
                .turned([1.0, 0.0, 0.0], chance.between(35.0, 150.0))
                .facing(chance.about(60.0));
            group.put(document, "climber spray", mesh, pose);
        }
        group
    }
}
