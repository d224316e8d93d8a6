//! Walls with windows and doors, and what closes those: frames, shutters, planks, iron.

use super::super::gltf::Document;
use super::super::shapes::Shape;
use super::arch::{arch_wall, archivolt};
use super::group::{Group, Pose};
use super::materials::Materials;
use super::solids::{Point, ball, block, lathe};

/// An opening of a wall, from its lower left to its upper right corner.
#[derive(Clone, Copy)]
pub(super) struct Opening {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

/// A wall from x = 0 to `width` and y = 0 to `height` that looks along +z, its face at z = 0, with rectangular openings. The cells
/// between all edges of openings are made one by one, so that corners meet corners.
pub(super) fn wall(width: f64, height: f64, depth: f64, openings: &[Opening]) -> Shape {
    let mut shape = Shape::default();
    let lines = |axis: usize, end: f64| {
        let edges = openings.iter().flat_map(|o| [o.low[axis], o.high[axis]]);
        let mut lines: Vec<f64> = edges.chain([0.0, end]).collect();
        lines.sort_by(f64::total_cmp);
        lines.dedup();
        lines
    };
    let (columns, rows) = (lines(0, width), lines(1, height));
    let is_open = |x: f64, y: f64| {
        let within = |o: &Opening| o.low[0] < x && x < o.high[0] && o.low[1] < y && y < o.high[1];
        !(0.0..width).contains(&x) || !(0.0..height).contains(&y) || openings.iter().any(within)
    };
    for x in columns.windows(2) {
        for y in rows.windows(2) {
            let (l, r, b, t) = (x[0], x[1], y[0], y[1]);
            let (middle_x, middle_y) = ((l + r) / 2.0, (b + t) / 2.0);
            if is_open(middle_x, middle_y) {
                continue;
            }
            let front = |x: f64, y: f64| -> Point { [x, y, 0.0] };
            let back = |x: f64, y: f64| -> Point { [x, y, -depth] };
            shape.face(&[front(l, b), front(r, b), front(r, t), front(l, t)]);
            shape.face(&[back(r, b), back(l, b), back(l, t), back(r, t)]);
            // Sides where the next cell is open or beyond the wall.
            const BESIDE: f64 = 1e-3;
            for (is_free, [p, q]) in [
                (is_open(l - BESIDE, middle_y), [[l, t], [l, b]]),
                (is_open(r + BESIDE, middle_y), [[r, b], [r, t]]),
                (is_open(middle_x, b - BESIDE), [[l, b], [r, b]]),
                (is_open(middle_x, t + BESIDE), [[r, t], [l, t]]),
            ] {
                if is_free {
                    let ([a, b], [c, d]) = (p, q);
                    shape.face(&[back(a, b), back(c, d), front(c, d), front(a, b)]);
                }
            }
        }
    }
    shape
}

/// A leaf of planks, `width` by `height`, from the origin to the right and up, its face at z = 0, with two battens across.
fn planks(width: f64, height: f64, count: u32) -> Shape {
    let mut shape = Shape::default();
    let step = width / f64::from(count);
    for i in 0..count {
        let x = step * f64::from(i);
        let plank = block(
            [x + 0.002, 0.0, -0.05],
            [x + step - 0.002, height, 0.0],
            0.007,
        );
        shape.join(&plank, [0.0; 3]);
    }
    for y in [height * 0.16, height * 0.78] {
        let batten = block([0.02, y, 0.0], [width - 0.02, y + 0.11, 0.028], 0.0);
        shape.join(&batten, [0.0; 3]);
    }
    shape
}

/// A window: frame, sill, and two shutters opened by `angle` degrees. Its middle is at the origin, the wall's face at z = 0.
pub(super) struct Windows {
    frame: usize,
    sill: usize,
    shutter: usize,
    dark: usize,
    half: [f64; 2],
}

impl Windows {
    pub(super) fn new(document: &mut Document, materials: &Materials, half: [f64; 2]) -> Self {
        let [w, h] = half;
        let mut frame = Shape::default();
        for side in [-1.0, 1.0] {
            let (l, r) = (side * w, side * (w + 0.10));
            let jamb = block([l.min(r), -h, -0.05], [l.max(r), h, 0.035], 0.012);
            frame.join(&jamb, [0.0; 3]);
        }
        let lintel = block([-w - 0.14, h, -0.05], [w + 0.14, h + 0.16, 0.05], 0.015);
        frame.join(&lintel, [0.0; 3]);
        let sill = block([-w - 0.16, -h - 0.09, -0.2], [w + 0.16, -h, 0.11], 0.02);
        let leaf = planks(w, 2.0 * h - 0.03, 3);
        let dark = block([-w, -h, -0.3], [w, h, -0.27], 0.0);
        let mut mesh = |name, shape: &Shape, material| {
            let geometry = document.geometry(shape);
            document.mesh_of(name, geometry, material)
        };
        Self {
            frame: mesh("window frame", &frame, materials.stone),
            sill: mesh("window sill", &sill, materials.stone),
            shutter: mesh("shutter", &leaf, materials.shutter),
            dark: mesh("window pane", &dark, materials.iron),
            half,
        }
    }

    /// The opening that a window at a place of a wall needs.
    pub(super) fn opening(&self, [x, y]: [f64; 2]) -> Opening {
        let [w, h] = self.half;
        Opening {
            low: [x - w, y - h],
            high: [x + w, y + h],
        }
    }

    /// A window at a place of a wall.
    pub(super) fn put(
        &self,
        document: &mut Document,
        group: &mut Group,
        [x, y]: [f64; 2],
        [left, right]: [f64; 2],
    ) {
        let at = Pose::at([x, y, 0.0]);
        group.put(document, "window frame", self.frame, at);
        group.put(document, "window sill", self.sill, at);
        group.put(document, "window pane", self.dark, at);
        let [w, h] = self.half;
        // Shutters turn around the outer edges; the right one is the left one upside down.
        let hinge = |side: f64| [x + side * (w + 0.02), y + side * (h - 0.015), 0.055];
        let pose = Pose::at(hinge(-1.0)).facing(-left);
        group.put(document, "left shutter", self.shutter, pose);
        let pose = Pose::at(hinge(1.0))
            .turned([0.0, 0.0, 1.0], 180.0)
            .facing(right);
        group.put(document, "right shutter", self.shutter, pose);
    }
}

/// A door under a round arch: two leaves, a stone surround, a wooden tympanum. Origin in the middle of the threshold, the wall's
/// face at z = 0.
pub(super) fn arched_door(
    document: &mut Document,
    materials: &Materials,
    half: f64,
    spring: f64,
) -> Group {
    let mut group = Group::new();
    let mut put = |name, shape: &Shape, material, pose| {
        let geometry = document.geometry(shape);
        let mesh = document.mesh_of(name, geometry, material);
        group.put(document, name, mesh, pose);
    };
    let depth = 0.3;
    let infill = arch_wall(half + 0.02, half + 0.05, half, depth);
    put(
        "door arch",
        &infill,
        materials.plaster,
        Pose::at([0.0, spring, -depth / 2.0]),
    );
    let ring = archivolt(half, 0.06);
    put(
        "door surround",
        &ring,
        materials.stone,
        Pose::at([0.0, spring, 0.0]),
    );
    let mut jambs = Shape::default();
    for side in [-1.0, 1.0] {
        let (l, r) = (side * (half - 0.015), side * (half + 0.165));
        let jamb = block([l.min(r), 0.0, -0.1], [l.max(r), spring, 0.055], 0.015);
        jambs.join(&jamb, [0.0; 3]);
    }
    let threshold = block(
        [-half - 0.25, -0.05, -0.3],
        [half + 0.25, 0.06, 0.28],
        0.015,
    );
    jambs.join(&threshold, [0.0; 3]);
    put("door jambs", &jambs, materials.stone, Pose::at([0.0; 3]));
    let leaf = planks(half - 0.012, spring - 0.08, 5);
    put(
        "door leaf, left",
        &leaf,
        materials.oak,
        Pose::at([-half, 0.07, -0.14]),
    );
    put(
        "door leaf, right",
        &leaf,
        materials.oak,
        Pose::at([0.012, 0.07, -0.14]),
    );
    let transom = block(
        [-half, spring - 0.01, -0.2],
        [half, spring + 0.09, -0.08],
        0.015,
    );
    put("door transom", &transom, materials.oak, Pose::at([0.0; 3]));
    // Behind the arch, where its wall covers the corners.
    let tympanum = block([-half, spring, -0.2], [half, spring + half, -0.15], 0.0);
    put(
        "door tympanum",
        &tympanum,
        materials.oak,
        Pose::at([0.0; 3]),
    );
    let ring = lathe(
        &[
            [0.0, 0.0],
            [0.05, 0.0],
            [0.05, 0.012],
            [0.03, 0.02],
            [0.0, 0.02],
        ],
        16,
    )
    .laid();
    for x in [-0.09, 0.09] {
        put(
            "door plate",
            &ring,
            materials.iron,
            Pose::at([x, 1.08, -0.14]),
        );
        put(
            "door knob",
            &ball(0.035, 12),
            materials.bronze,
            Pose::at([x, 1.08, -0.085]),
        );
    }
    group
}
