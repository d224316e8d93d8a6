//! What the parts of the courtyard are cut from: flat faces, bevelled blocks, bodies of revolution. Metres, y up.
//!
//! Texture coordinates count repetitions of a texture, which covers [`TEXTURE_SIZE`] metres.

use super::super::shapes::{Shape, turn};

/// How many metres of a surface a texture covers.
pub(super) const TEXTURE_SIZE: f64 = 2.0;

/// Two neighbouring pieces of a profile meet in an edge, and not in a round, where the cosine between them is below this: 37 degrees.
const CREASE: f64 = 0.8;

/// A place or a direction.
pub(super) type Point = [f64; 3];

pub(super) fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

impl Shape {
    /// Adds a vertex with texture coordinates.
    pub(super) fn corner(&mut self, position: Point, normal: Point, uv: [f64; 2]) -> u16 {
        self.uvs.push(uv.map(|v| v as f32 + 0.0));
        self.vertex(position, normal)
    }

    /// Adds a flat convex polygon, counter-clockwise seen from its front.
    pub(super) fn face(&mut self, corners: &[Point]) {
        let mut normal = [0.0; 3];
        for pair in corners[1..].windows(2) {
            let own = cross(minus(pair[0], corners[0]), minus(pair[1], corners[0]));
            normal = std::array::from_fn(|i| normal[i] + own[i]);
        }
        let [x, y, z] = normal.map(f64::abs);
        let flat = |p: &Point| match () {
            () if y >= x && y >= z => [p[0], p[2]],
            () if x >= z => [p[2], -p[1]],
            () => [p[0], -p[1]],
        };
        let vertices: Vec<u16> = corners
            .iter()
            .map(|p| self.corner(*p, normal, flat(p).map(|v| v / TEXTURE_SIZE)))
            .collect();
        for pair in vertices[1..].windows(2) {
            self.triangles.push([vertices[0], pair[0], pair[1]]);
        }
    }

    /// Adds another shape, moved.
    pub(super) fn join(&mut self, other: &Self, by: Point) {
        let first = self.positions.len() as u16;
        let moved = |p: &[f32; 3]| std::array::from_fn(|i| (f64::from(p[i]) + by[i]) as f32);
        self.positions.extend(other.positions.iter().map(moved));
        self.normals.extend(&other.normals);
        self.uvs.extend(&other.uvs);
        self.triangles
            .extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    }

    /// The shape with its y axis along z: what went up comes towards the viewer, what came forwards goes down.
    pub(super) fn laid(mut self) -> Self {
        for v in self.positions.iter_mut().chain(&mut self.normals) {
            let [x, y, z] = *v;
            *v = [x, 0.0 - z, y];
        }
        self
    }
}

/// A block from `low` to `high` whose edges are cut at 45 degrees, `bevel` from each.
pub(super) fn block(low: Point, high: Point, bevel: f64) -> Shape {
    let mut shape = Shape::default();
    // A corner of the face across `axis`: signs say which end of each axis.
    let at = |axis: usize, signs: [bool; 3]| -> Point {
        std::array::from_fn(|i| {
            let inset = if i == axis { 0.0 } else { bevel };
            if signs[i] {
                high[i] - inset
            } else {
                low[i] + inset
            }
        })
    };
    let signs = |axis: usize, along: bool, next: bool, last: bool| {
        let mut signs = [along; 3];
        signs[(axis + 1) % 3] = next;
        signs[(axis + 2) % 3] = last;
        signs
    };
    let mut add = |corners: &[Point], is_turned: bool| {
        let mut corners = corners.to_vec();
        if is_turned {
            corners.reverse();
        }
        shape.face(&corners);
    };
    for axis in 0..3 {
        let next = (axis + 1) % 3;
        for end in [false, true] {
            let corner = |n, l| at(axis, signs(axis, end, n, l));
            let ring = [
                corner(false, false),
                corner(true, false),
                corner(true, true),
                corner(false, true),
            ];
            add(&ring, !end);
            if bevel <= 0.0 {
                continue;
            }
            // The edge that this face shares with that across the next axis.
            for side in [false, true] {
                let own = |l| at(axis, signs(axis, end, side, l));
                let other = |l| at(next, signs(axis, end, side, l));
                add(
                    &[own(false), other(false), other(true), own(true)],
                    end != side,
                );
            }
        }
    }
    if bevel > 0.0 {
        for corner in 0..8 {
            let signs = [corner & 1 != 0, corner & 2 != 0, corner & 4 != 0];
            let is_turned = signs.iter().filter(|s| **s).count() % 2 == 0;
            add(&[0, 1, 2].map(|axis| at(axis, signs)), is_turned);
        }
    }
    shape
}

/// A body of revolution around the y axis. The profile is radius and height, the outside on the right of its way (so it goes up on
/// the outside, and down inside a bowl); `part` of a full turn is made, from +z over +x.
pub(super) fn revolve(profile: &[[f64; 2]], segments: u16, part: f64) -> Shape {
    let mut shape = Shape::default();
    let normal_of = |a: [f64; 2], b: [f64; 2]| {
        let (dr, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = (dr * dr + dy * dy).sqrt();
        [dy / length, -dr / length]
    };
    let pieces: Vec<[f64; 2]> = profile.windows(2).map(|p| normal_of(p[0], p[1])).collect();
    let widest = profile.iter().fold(0.0_f64, |w, p| w.max(p[0]));
    // Repetitions of the texture around, in whole numbers so that the seam fits.
    let around = (std::f64::consts::TAU * widest * part / TEXTURE_SIZE)
        .round()
        .max(1.0);
    let mut start = 0;
    let mut travelled = 0.0;
    while start < pieces.len() {
        let smooth = pieces[start..]
            .windows(2)
            .take_while(|n| n[0][0] * n[1][0] + n[0][1] * n[1][1] >= CREASE)
            .count();
        let end = start + smooth + 1;
        let first = shape.positions.len() as u16;
        for row in start..=end {
            if row > start {
                let [a, b] = [profile[row - 1], profile[row]];
                let (dr, dy) = (b[0] - a[0], b[1] - a[1]);
                travelled += (dr * dr + dy * dy).sqrt();
            }
            let below = pieces[row.max(start + 1) - 1];
            let above = pieces[row.min(end - 1)];
            let normal = [below[0] + above[0], below[1] + above[1]];
            for column in 0..=segments {
                let share = f64::from(column) / f64::from(segments);
                let (sin, cos) = turn(share * part);
                let [r, y] = profile[row];
                shape.corner(
                    [r * sin, y, r * cos],
                    [normal[0] * sin, normal[1], normal[0] * cos],
                    [share * around, -travelled / TEXTURE_SIZE],
                );
            }
        }
        let columns = segments + 1;
        for row in 0..(end - start) as u16 {
            for column in 0..segments {
                let a = first + row * columns + column;
                shape.cell([a, a + 1, a + columns + 1, a + columns]);
            }
        }
        start = end;
    }
    shape
}

/// A whole body of revolution.
pub(super) fn lathe(profile: &[[f64; 2]], segments: u16) -> Shape {
    revolve(profile, segments, 1.0)
}

/// A ball, from the south pole up.
pub(super) fn ball(radius: f64, segments: u16) -> Shape {
    let rows = segments / 2;
    let profile: Vec<[f64; 2]> = (0..=rows)
        .map(|row| {
            let (sin, cos) = turn(f64::from(row) / f64::from(rows) / 2.0);
            let is_pole = row == 0 || row == rows;
            [if is_pole { 0.0 } else { radius * sin }, -radius * cos]
        })
        .collect();
    lathe(&profile, segments)
}
