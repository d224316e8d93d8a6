//! Sweeps over numbers: triangles that coincide, shells within shells, crowds around one point. The parameter is the number of triangles.

use glam::DVec3;

use super::super::random::Random;
use super::shapes::{Shape, from_around, tetrahedron, through};
use super::{Case, PLAIN, Sweep};
use crate::geometry::Ray;

pub(super) const SWEEPS: &[Sweep] = &[
    Sweep {
        name: "coincident",
        description: "equal triangles in one place, and one beside them",
        parameter: "triangles",
        values: up_to_many,
        make: |value, count, random| stack(value, count, random, false),
        is_crowd: true,
        ..PLAIN
    },
    Sweep {
        name: "back-to-back",
        description: "the same, every second one turned over",
        parameter: "triangles",
        values: up_to_many,
        make: |value, count, random| stack(value, count, random, true),
        is_crowd: true,
        ..PLAIN
    },
    Sweep {
        name: "deep-chains",
        description: "closed shells, each within the next",
        parameter: "triangles",
        values: || (2..=14).map(|i| f64::from(1 << i)).collect(),
        make: shells,
        is_crowd: true,
        ..PLAIN
    },
    Sweep {
        name: "one-point",
        description: "triangles of all sizes with one corner in common",
        parameter: "triangles",
        values: || (2..=15).map(|i| f64::from(1 << i)).collect(),
        make: star,
        is_crowd: true,
        ..PLAIN
    },
];

fn up_to_many() -> Vec<f64> {
    vec![
        2.0, 4.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 10_000.0, 20_000.0, 50_000.0, 100_000.0,
    ]
}

fn stack(number: f64, count: usize, random: &mut Random, turns: bool) -> Case {
    let mut triangles = vec![[0, 1, 2]; number as usize - 1];
    if turns {
        triangles
            .iter_mut()
            .skip(1)
            .step_by(2)
            .for_each(|t| *t = [0, 2, 1]);
    }
    triangles.push([0, 1, 3]);
    let shape = Shape {
        positions: vec![
            DVec3::new(0.0, 0.1, 0.0),
            DVec3::new(1.0, 0.0, 0.2),
            DVec3::new(0.1, 1.0, 0.3),
            DVec3::new(0.2, -0.3, 1.0),
        ],
        triangles,
    };
    let rays = (0..count)
        .map(|_| {
            let [a, b, c] = [0, 1, 2].map(|i| shape.positions[i]);
            let (u, v) = (random.unit() * 0.5, random.unit() * 0.6);
            let target = a + (b - a) * u + (c - a) * v;
            from_around(target, 3.0, random)
        })
        .collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: false,
    }
}

fn shells(number: f64, count: usize, random: &mut Random) -> Case {
    let shells = (number / 4.0) as u32;
    let mut shape = Shape::default();
    for shell in 0..shells {
        let size = 1.0 + f64::from(shell) / f64::from(shells);
        let next = tetrahedron(size);
        let first = shape.positions.len() as u32;
        shape.positions.extend(next.positions);
        shape
            .triangles
            .extend(next.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    // From the middle, and from between the shells; inward of the outermost always.
    let mut ray = || {
        let origin = random.vector() * random.pick(&[0.1, 0.1, 0.3]);
        through(origin.as_vec3(), shape.target(random))
    };
    let rays = (0..count).map(|_| ray()).collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: true,
    }
}

fn star(number: f64, count: usize, random: &mut Random) -> Case {
    let center = DVec3::new(0.5, 0.25, -0.125);
    let mut shape = Shape {
        positions: vec![center],
        triangles: Vec::new(),
    };
    for i in 0..number as u32 {
        let size = libm::pow(10.0, -3.0 * random.unit());
        let corner = [random.direction(), random.direction()].map(|d| center + d * size);
        shape.positions.extend(corner);
        shape.triangles.push([0, 2 * i + 1, 2 * i + 2]);
    }
    let ray = |i| {
        let away = random.direction() * 2.0;
        match i % 4 {
            // Exactly through the point, where everything is hit.
            0 => {
                let way = (away * 64.0).round() / 64.0;
                Ray::new((center + way).as_vec3(), -way.as_vec3())
            }
            1 => through((center + away).as_vec3(), center.as_vec3()),
            _ => through((center + away).as_vec3(), shape.target(random)),
        }
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: false,
    }
}
