//! Closed meshes do not leak: of ten million rays that start inside a mesh and aim at its corners and edges, none
//! escapes.
//!
//! A ray first meets the triangles around its target, where it nearly always ends; only if they all let it through is
//! it tested against the whole mesh. What then has no hit is a leak. The triangles are tested one by one: the boxes and
//! planes of the accelerators have tests of their own.

#[path = "support/random.rs"]
mod random;

use std::collections::HashMap;

use bspray::geometry::{Ray, RayFrame, Triangle};
use glam::{DVec3, Vec3};
use random::Random;
use rayon::prelude::*;

const RAYS: u64 = 10_000_000;
const SEED: u64 = 3;

/// A closed surface in double precision, and points from which every direction leads through it.
struct Solid {
    name: &'static str,
    positions: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
    inside: fn(&mut Random) -> DVec3,
}

/// A box of three different edges, each face of two triangles.
fn cuboid(name: &'static str, half: DVec3, inside: fn(&mut Random) -> DVec3) -> Solid {
    let positions = (0..8)
        .map(|i| half * DVec3::from_array([0, 1, 2].map(|axis| f64::from(2 * (i >> axis & 1) - 1))))
        .collect();
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Solid {
        name,
        positions,
        triangles,
        inside,
    }
}

/// An octahedron whose triangles are halved twice along each edge, with its corners on the unit sphere.
fn sphere() -> Solid {
    let mut positions = vec![
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ];
    let mut triangles: Vec<[usize; 3]> = (0..8)
        .map(|i| {
            let corner = |axis: usize| axis + 3 * (i >> axis & 1);
            [corner(0), corner(1), corner(2)]
        })
        .collect();
    // Turned, so that no corner has round coordinates.
    let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    for p in &mut positions {
        *p = turn * *p;
    }
    for _ in 0..3 {
        let mut middles = HashMap::new();
        let mut middle = |a: usize, b: usize, positions: &mut Vec<DVec3>| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a] + positions[b]).normalize());
                positions.len() - 1
            })
        };
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let ab = middle(a, b, &mut positions);
                let bc = middle(b, c, &mut positions);
                let ca = middle(c, a, &mut positions);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    Solid {
        name: "sphere",
        positions,
        triangles,
        // The polyhedron holds the ball of radius 0.9.
        inside: |r| r.vector().as_dvec3() * 0.5,
    }
}

/// A torus of 24 times 16 quadrilaterals: rays inside it graze the inner side of the hole.
fn torus() -> Solid {
    let (around, across) = (24, 16);
    let at = |i: usize, j: usize| (i % around) * across + j % across;
    let positions = (0..around * across)
        .map(|n| {
            let (i, j) = (n / across, n % across);
            let phi = std::f64::consts::TAU * i as f64 / around as f64;
            let psi = std::f64::consts::TAU * j as f64 / across as f64;
            let radius = 1.0 + 0.4 * libm::cos(psi);
            DVec3::new(
                radius * libm::cos(phi),
                radius * libm::sin(phi),
                0.4 * libm::sin(psi),
            )
        })
        .collect();
    let triangles = (0..around * across)
        .flat_map(|n| {
            let (i, j) = (n / across, n % across);
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Solid {
        name: "torus",
        positions,
        triangles,
        // Near the circle in the middle of the tube.
        inside: |r| {
            let phi = std::f64::consts::TAU * r.unit();
            let circle = DVec3::new(libm::cos(phi), libm::sin(phi), 0.0);
            circle + r.vector().as_dvec3() * 0.1
        },
    }
}

fn solids() -> [Solid; 4] {
    [
        // The middle too, from where the directions to the corners are exact.
        cuboid("box", DVec3::new(1.0, 2.0, 3.0), |r| {
            let spread = r.pick(&[0.0, 0.5, 0.9]);
            r.vector().as_dvec3() * spread
        }),
        cuboid("long thin box", DVec3::new(1e-3, 0.3, 50.0), |r| {
            r.vector().as_dvec3() * DVec3::new(9e-4, 0.2, 45.0)
        }),
        sphere(),
        torus(),
    ]
}

/// A solid after scaling and shifting, in single precision.
struct Mesh {
    triangles: Vec<Triangle>,
    /// The two ends of each edge and the triangles at either.
    edges: Vec<([Vec3; 2], Vec<u32>)>,
    place: (f64, f64),
}

impl Mesh {
    fn new(solid: &Solid, place: (f64, f64)) -> Self {
        let positions: Vec<Vec3> = solid.positions.iter().map(|&p| placed(p, place)).collect();
        let triangles = solid.triangles.iter();
        let mut at_corner = vec![Vec::new(); positions.len()];
        for (i, corners) in triangles.clone().enumerate() {
            corners.iter().for_each(|&c| at_corner[c].push(i as u32));
        }
        let edges = triangles
            .clone()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .filter(|[a, b]| a < b)
            .map(|[a, b]| {
                let mut around: Vec<u32> = [&at_corner[a][..], &at_corner[b]].concat();
                around.sort_unstable();
                around.dedup();
                ([positions[a], positions[b]], around)
            })
            .collect();
        Self {
            triangles: triangles
                .map(|&[a, b, c]| Triangle::new(positions[a], positions[b], positions[c]))
                .collect(),
            edges,
            place,
        }
    }

    /// A ray from inside to a corner or to a point of an edge, and the triangles around its target.
    fn aimed(&self, solid: &Solid, r: &mut Random) -> (Ray, &[u32]) {
        let ([from, to], around) = &self.edges[r.integer(0, self.edges.len() as i64 - 1) as usize];
        let target = match r.integer(0, 2) {
            0 => *from,
            1 => *to,
            _ => *from + (*to - *from) * r.unit() as f32,
        };
        let origin = placed((solid.inside)(r), self.place);
        let length = r.pick(&[1.0, 1.0, 0.37]);
        (Ray::new(origin, (target - origin) * length), around)
    }
}

fn placed(p: DVec3, (scale, offset): (f64, f64)) -> Vec3 {
    (p * scale + offset * DVec3::new(1.0, -0.7, 0.3)).as_vec3()
}

#[test]
fn no_ray_leaves_a_closed_mesh_through_its_corners_and_edges() {
    // The long thin box is thinner than the floats are apart at an offset of 1e4.
    let places = [
        (1.0, 0.0),
        (1e-6, 0.0),
        (1e6, 0.0),
        (1.0, 1e4),
        (300.0, 1e4),
    ];
    let solids = solids();
    let meshes: Vec<(&Solid, Mesh)> = solids
        .iter()
        .flat_map(|solid| places.map(|place| (solid, Mesh::new(solid, place))))
        .filter(|(solid, mesh)| solid.name != "long thin box" || mesh.place.1 < 1.0)
        .collect();
    let each = RAYS.div_ceil(meshes.len() as u64);
    let mut leaks = 0;
    for (solid, mesh) in &meshes {
        let count = |r: &mut Random| -> [u64; 2] {
            let (ray, around) = mesh.aimed(solid, r);
            let frame = RayFrame::new(&ray);
            let is_hit = |&t: &u32| frame.intersect(&mesh.triangles[t as usize]).is_some();
            if around.iter().any(is_hit) {
                return [0, 0];
            }
            let is_stopped = (0..mesh.triangles.len() as u32).any(|t| is_hit(&t));
            [1, u64::from(!is_stopped)]
        };
        let [elsewhere, leaked] = (0..each)
            .into_par_iter()
            .map(|i| count(&mut Random::new(SEED, i)))
            .reduce(|| [0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
        let (scale, offset) = mesh.place;
        println!(
            "{} at scale {scale} and offset {offset}: {leaked} leaks, {elsewhere} of {each} hit beside the target",
            solid.name
        );
        leaks += leaked;
    }
    assert_eq!(leaks, 0, "leaks, seed {SEED}");
}
