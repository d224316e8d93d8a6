//! Triangle meshes of simple shapes: y up, centred, one unit across where nothing else is said.
//!
//! Triangles are counter-clockwise seen from outside. Round surfaces have smooth normals; vertices are doubled where a
//! surface has an edge.

use std::f64::consts::TAU;

/// Vertices with unit normals, and triangles between them. Texture coordinates are there for all vertices or for none.
#[derive(Clone, Default)]
pub(super) struct Shape {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub triangles: Vec<[u16; 3]>,
}

impl Shape {
    /// Adds a vertex; the normal need not be unit.
    pub(super) fn vertex(&mut self, position: [f64; 3], normal: [f64; 3]) -> u16 {
        let [x, y, z] = normal;
        let length = (x * x + y * y + z * z).sqrt();
        // `+ 0.0` turns -0 into 0, which reads better in a file.
        self.positions.push(position.map(|v| v as f32 + 0.0));
        self.normals.push(normal.map(|v| (v / length) as f32 + 0.0));
        (self.positions.len() - 1) as u16
    }

    /// Adds a grid of `columns` by `rows` cells over `point(u, v)`, u and v in [0, 1], whose normal is on the side from which u
    /// goes right and v goes up. Cells with two equal corners, as at a pole, become one triangle.
    fn grid(&mut self, columns: u16, rows: u16, point: impl Fn(f64, f64) -> ([f64; 3], [f64; 3])) {
        let first = self.positions.len() as u16;
        for row in 0..=rows {
            for column in 0..=columns {
                let u = f64::from(column) / f64::from(columns);
                let v = f64::from(row) / f64::from(rows);
                let (position, normal) = point(u, v);
                self.vertex(position, normal);
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let a = first + row * (columns + 1) + column;
                self.cell([a, a + 1, a + columns + 2, a + columns + 1]);
            }
        }
    }

    /// Adds a cell of a grid, counter-clockwise, without the triangles of which two corners are equal.
    pub(super) fn cell(&mut self, [a, b, c, d]: [u16; 4]) {
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|v| self.positions[usize::from(v)].map(f32::to_bits));
            if p != q && q != r && r != p {
                self.triangles.push(triangle);
            }
        }
    }

    /// Adds a disc around the y axis that looks up or down.
    fn disc(&mut self, y: f64, radius: f64, segments: u16, up: bool) {
        let normal = [0.0, if up { 1.0 } else { -1.0 }, 0.0];
        let centre = self.vertex([0.0, y, 0.0], normal);
        for segment in 0..segments {
            let (sin, cos) = turn(f64::from(segment) / f64::from(segments));
            self.vertex([radius * sin, y, radius * cos], normal);
        }
        for segment in 0..segments {
            let a = centre + 1 + segment;
            let b = centre + 1 + (segment + 1) % segments;
            self.triangles
                .push(if up { [centre, a, b] } else { [centre, b, a] });
        }
    }
}

/// Sine and cosine of a part of a full turn; exactly those of 0 at 1, so that seams close.
pub(super) fn turn(part: f64) -> (f64, f64) {
    let angle = TAU * (part % 1.0);
    (libm::sin(angle), libm::cos(angle))
}

/// A square in the xz plane that looks up.
pub(super) fn square() -> Shape {
    let mut shape = Shape::default();
    shape.grid(1, 1, |u, v| ([u - 0.5, 0.0, 0.5 - v], [0.0, 1.0, 0.0]));
    shape
}

/// A cube.
pub(super) fn cube() -> Shape {
    let mut shape = Shape::default();
    // Each face by its right and its up; the normal is their cross product.
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for axis in 0..3 {
        let (next, last) = (axes[(axis + 1) % 3], axes[(axis + 2) % 3]);
        for (right, up, sign) in [(next, last, 1.0), (last, next, -1.0)] {
            let normal = axes[axis].map(|n| n * sign);
            shape.grid(1, 1, |u, v| {
                let at = |i: usize| 0.5 * normal[i] + (u - 0.5) * right[i] + (v - 0.5) * up[i];
                ([at(0), at(1), at(2)], normal)
            });
        }
    }
    shape
}

/// A sphere of diameter 1, from meridians and parallels.
pub(super) fn sphere(meridians: u16, parallels: u16) -> Shape {
    let mut shape = Shape::default();
    shape.grid(meridians, parallels, |u, v| {
        let (sin, cos) = turn(u);
        // From the south pole up; the poles' sine must be 0 for their triangles to be told.
        let (ring, height) = match v {
            0.0 => (0.0, -1.0),
            1.0 => (0.0, 1.0),
            _ => {
                let (ring, height) = turn(v / 2.0);
                (ring, -height)
            }
        };
        let normal = [ring * sin, height, ring * cos];
        (normal.map(|n| n / 2.0), normal)
    });
    shape
}

/// A torus around the y axis: `minor` is the radius of the tube, `major` that of its centre line.
pub(super) fn torus(major: f64, minor: f64, around: u16, across: u16) -> Shape {
    let mut shape = Shape::default();
    shape.grid(around, across, |u, v| {
        let (sin, cos) = turn(u);
        let (up, out) = turn(v);
        let ring = major + minor * out;
        let position = [ring * sin, minor * up, ring * cos];
        (position, [out * sin, up, out * cos])
    });
    shape
}

/// A closed cylinder around the y axis, tapered where the radii differ.
pub(super) fn cylinder(bottom: f64, top: f64, height: f64, segments: u16) -> Shape {
    let mut shape = Shape::default();
    shape.grid(segments, 1, |u, v| {
        let (sin, cos) = turn(u);
        let radius = bottom + (top - bottom) * v;
        let position = [radius * sin, (v - 0.5) * height, radius * cos];
        (position, [height * sin, bottom - top, height * cos])
    });
    shape.disc(-height / 2.0, bottom, segments, false);
    shape.disc(height / 2.0, top, segments, true);
    shape
}
