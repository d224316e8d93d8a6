//! Meshes that the sweeps are made of, in double precision, and rays at them.

use glam::{DQuat, DVec3, Vec3};

use super::super::random::Random;
use crate::analysis::plain_scene::scene_of;
use crate::geometry::Ray;
use crate::scene::Scene;

/// Points and triangles, before they are placed and rounded.
#[derive(Clone, Default)]
pub(in super::super) struct Shape {
    pub(in super::super) positions: Vec<DVec3>,
    pub(in super::super) triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// Moves every point.
    pub(super) fn placed(mut self, place: impl Fn(DVec3) -> DVec3) -> Self {
        self.positions.iter_mut().for_each(|p| *p = place(*p));
        self
    }

    /// Both.
    pub(super) fn and(mut self, other: Self) -> Self {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.triangles
            .extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
        self
    }

    /// As a scene, each coordinate rounded once.
    pub(super) fn scene(&self) -> Scene {
        scene_of(&self.positions, &self.triangles)
    }

    /// A corner of a triangle, rounded.
    pub(in super::super) fn corner(&self, random: &mut Random) -> Vec3 {
        let triangle = random.pick(&self.triangles);
        self.positions[random.pick(&triangle) as usize].as_vec3()
    }

    /// A point of an edge, between rounded corners and rounded again.
    pub(in super::super) fn edge_point(&self, random: &mut Random) -> Vec3 {
        let [a, b, _] = random
            .pick(&self.triangles)
            .map(|i| self.positions[i as usize].as_vec3());
        a.as_dvec3().lerp(b.as_dvec3(), random.unit()).as_vec3()
    }

    /// A point of a triangle.
    pub(super) fn inner_point(&self, random: &mut Random) -> DVec3 {
        let [a, b, c] = random
            .pick(&self.triangles)
            .map(|i| self.positions[i as usize]);
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        a + (b - a) * u + (c - a) * v
    }

    /// A corner, a point of an edge or one within a triangle.
    pub(super) fn target(&self, random: &mut Random) -> Vec3 {
        match random.below(3) {
            0 => self.corner(random),
            1 => self.edge_point(random),
            _ => self.inner_point(random).as_vec3(),
        }
    }
}

/// A ray from a point through another: the direction is the rounded difference.
pub(in super::super) fn through(origin: Vec3, target: Vec3) -> Ray {
    let way = target - origin;
    Ray::new(origin, if way == Vec3::ZERO { Vec3::X } else { way })
}

/// A ray to a point from a random place at a distance from it.
pub(super) fn from_around(target: DVec3, distance: f64, random: &mut Random) -> Ray {
    let origin = target + random.direction() * distance;
    through(origin.as_vec3(), target.as_vec3())
}

/// A turn that takes no axis to another.
pub(super) fn turn() -> DQuat {
    DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1)
}

/// A closed ball of radius 1, none of whose edges is parallel to an axis.
pub(in super::super) fn ball(rows: u32, columns: u32) -> Shape {
    let at = |row: u32, column: u32| {
        let theta = std::f64::consts::PI * f64::from(row) / f64::from(rows);
        let phi = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
        let sine = libm::sin(theta);
        turn()
            * DVec3::new(
                sine * libm::cos(phi),
                libm::cos(theta),
                sine * libm::sin(phi),
            )
    };
    let mut shape = Shape {
        positions: vec![turn() * DVec3::Y, turn() * DVec3::NEG_Y],
        triangles: Vec::new(),
    };
    for row in 1..rows {
        shape
            .positions
            .extend((0..columns).map(|column| at(row, column)));
    }
    let index = |row: u32, column: u32| match row {
        0 => 0,
        r if r == rows => 1,
        r => 2 + (r - 1) * columns + column % columns,
    };
    for (r, c) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
        let [a, b] = [index(r, c), index(r, c + 1)];
        let [d, e] = [index(r + 1, c), index(r + 1, c + 1)];
        if r > 0 {
            shape.triangles.push([a, b, d]);
        }
        if r + 1 < rows {
            shape.triangles.push([b, e, d]);
        }
    }
    shape
}

/// A closed box about a middle. Faces are seen counter-clockwise from outside.
pub(super) fn cuboid(middle: DVec3, half: DVec3) -> Shape {
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        middle + half * DVec3::new(side(0), side(1), side(2))
    };
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    Shape {
        positions: (0..8).map(corner).collect(),
        triangles: quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect(),
    }
}

/// A closed tetrahedron about the origin.
pub(super) fn tetrahedron(size: f64) -> Shape {
    let corners = [
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    Shape {
        positions: corners.map(|p| turn() * DVec3::from(p) * size).to_vec(),
        triangles: vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
    }
}

/// A grid of squares in the plane y = 0, from -1/2 to 1/2.
pub(super) fn grid(cells: u32) -> Shape {
    let n = cells + 1;
    let at = |i: u32| DVec3::new(f64::from(i % n), 0.0, f64::from(i / n)) / f64::from(cells);
    let square = |i: u32| {
        let v = i / cells * n + i % cells;
        [[v, v + n, v + 1], [v + 1, v + n, v + n + 1]]
    };
    Shape {
        positions: (0..n * n)
            .map(|i| at(i) - DVec3::new(0.5, 0.0, 0.5))
            .collect(),
        triangles: (0..cells * cells).flat_map(square).collect(),
    }
}

/// Two triangles.
pub(super) fn quad([a, b, c, d]: [DVec3; 4]) -> Shape {
    Shape {
        positions: vec![a, b, c, d],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

/// Rays from around the middle of a shape at its corners, edges and insides. `place` takes points about the origin to where the shape is.
pub(super) fn from_inside(
    shape: &Shape,
    count: usize,
    random: &mut Random,
    place: impl Fn(DVec3) -> DVec3,
) -> Vec<Ray> {
    let mut ray = || {
        let origin = place(random.vector() * 0.3).as_vec3();
        through(origin, shape.target(random))
    };
    (0..count).map(|_| ray()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn closed_shapes_have_every_edge_twice_in_opposite_ways() {
        for shape in [
            ball(7, 11),
            cuboid(DVec3::X, DVec3::new(1.0, 2.0, 3.0)),
            tetrahedron(2.0),
        ] {
            let mut edges = HashMap::new();
            for [a, b, c] in shape.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    assert!(edges.insert((from, to), ()).is_none());
                }
            }
            assert!(
                edges
                    .keys()
                    .all(|&(from, to)| edges.contains_key(&(to, from)))
            );
        }
    }
}
