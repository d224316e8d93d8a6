//! Sweeps over aim: rays at what triangles and boxes share, edges, corners and the planes of axis-aligned sides.

use glam::{DVec3, Vec3};

use super::super::random::Random;
use super::shapes::{Shape, ball, cuboid, grid, through};
use super::{Case, PLAIN, Sweep, moved, powers, shaken, ulps};
use crate::geometry::Ray;

pub(super) const SWEEPS: &[Sweep] = &[
    Sweep {
        name: "edges",
        description: "a ball seen from outside through its shared edges",
        parameter: "the aim is moved by up to",
        unit: "ulps",
        values: ulps,
        make: |value, count, random| at_ball(value, count, random, Shape::edge_point, false),
        ..PLAIN
    },
    Sweep {
        name: "edges-inside",
        description: "the same from inside, where backs are seen",
        parameter: "the aim is moved by up to",
        unit: "ulps",
        values: ulps,
        make: |value, count, random| at_ball(value, count, random, Shape::edge_point, true),
        ..PLAIN
    },
    Sweep {
        name: "vertices",
        description: "a ball seen from inside through its shared corners",
        parameter: "the aim is moved by up to",
        unit: "ulps",
        values: ulps,
        make: |value, count, random| at_ball(value, count, random, Shape::corner, true),
        ..PLAIN
    },
    Sweep {
        name: "diagonal-front",
        description: "axis-parallel rays at the diagonals of a flat grid, on its front",
        parameter: "the ray is moved by up to",
        unit: "ulps",
        values: ulps,
        make: |value, count, random| at_diagonals(value, count, random, 1.0),
        ..PLAIN
    },
    Sweep {
        name: "diagonal-back",
        description: "axis-parallel rays at the diagonals of a flat grid, on its back",
        parameter: "the ray is moved by up to",
        unit: "ulps",
        values: ulps,
        make: |value, count, random| at_diagonals(value, count, random, -1.0),
        ..PLAIN
    },
    Sweep {
        name: "face-planes",
        description: "axis-parallel rays in the planes of box sides: at the corners of a flat grid",
        parameter: "the ray is moved by up to",
        unit: "ulps",
        values: ulps,
        make: in_face_planes,
        ..PLAIN
    },
    Sweep {
        name: "splitting-planes",
        description: "axis-parallel rays in the planes between and along small boxes, where trees split",
        parameter: "the ray is moved by up to",
        unit: "ulps",
        values: ulps,
        make: in_splitting_planes,
        ..PLAIN
    },
    Sweep {
        name: "tilt",
        description: "rays down on a grid, ever closer to an axis, at last with 0 and with -0",
        parameter: "smaller components of the direction",
        unit: "",
        values: || {
            let mut values = powers(-1.0, -45.0, 22);
            values.extend([0.0, -0.0]);
            values
        },
        make: tilted,
        ..PLAIN
    },
];

fn at_ball(
    ulps: f64,
    count: usize,
    random: &mut Random,
    target: fn(&Shape, &mut Random) -> Vec3,
    is_inside: bool,
) -> Case {
    let shape = ball(8, 12);
    let mut ray = || {
        let target = target(&shape, random);
        let origin = if is_inside {
            random.vector() * 0.3
        } else {
            target.as_dvec3() * 3.0 + random.vector()
        };
        through(origin.as_vec3(), shaken(target, ulps, random))
    };
    let rays = (0..count).map(|_| ray()).collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside,
    }
}

/// A grid whose squares have corners that are not round numbers, seen along the y axis. Its front is up.
fn at_diagonals(ulps: f64, count: usize, random: &mut Random, side: f32) -> Case {
    let shape = grid(6).placed(|p| p * 0.7 + DVec3::new(0.13, 0.29, -0.07));
    let ray = |_| {
        // The second edge of a square's first triangle is its diagonal.
        let even = 2 * random.below(shape.triangles.len() / 2);
        let [_, b, c] = shape.triangles[even].map(|i| shape.positions[i as usize].as_vec3());
        let target = b.as_dvec3().lerp(c.as_dvec3(), random.unit()).as_vec3();
        let target = shaken(target, ulps, random);
        // Written out, since a product would have negative zeros, which are another sweep.
        Ray::new(target.with_y(target.y + side), Vec3::new(0.0, -side, 0.0))
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: false,
    }
}

fn in_face_planes(ulps: f64, count: usize, random: &mut Random) -> Case {
    let floor = grid(16);
    let mut ray = || {
        let mut target = shaken(floor.corner(random), ulps, random);
        if random.below(3) == 0 {
            target.x = random.signed() as f32 * 0.5;
        }
        Ray::new(target.with_y(random.pick(&[1.0, -1.0, 3.0])), Vec3::ZERO)
    };
    let rays: Vec<Ray> = (0..count).map(|_| ray()).collect();
    let down = |ray: Ray| Ray {
        direction: Vec3::new(0.0, -ray.origin.y.signum(), 0.0),
        ..ray
    };
    Case {
        scene: floor.scene(),
        rays: rays.into_iter().map(down).collect(),
        is_inside: false,
    }
}

fn in_splitting_planes(ulps: f64, count: usize, random: &mut Random) -> Case {
    let mut shape = Shape::default();
    for i in 0..27_u32 {
        let cell = DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9));
        shape = shape.and(cuboid(cell, DVec3::new(0.25, 0.3, 0.2)));
    }
    let ray = |_| {
        // Along one axis, in the plane of a side (or between boxes) of another, somewhere on the third.
        let axis = random.below(3);
        let (plane, other) = ((axis + 1) % 3, (axis + 2) % 3);
        let corner = shape.corner(random);
        let mut origin = corner;
        if random.below(4) == 0 {
            origin[plane] = random.pick(&[0.5, 1.5]);
        }
        origin[plane] = moved(origin[plane], (random.signed() * ulps).round());
        let anywhere = (2.2 * random.unit()) as f32;
        origin[other] = random.pick(&[corner[other], anywhere]);
        let side = random.pick(&[1.0, -1.0]);
        origin[axis] = -5.0 * side;
        let mut direction = Vec3::ZERO;
        direction[axis] = side;
        Ray::new(origin, direction)
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: false,
    }
}

fn tilted(tilt: f64, count: usize, random: &mut Random) -> Case {
    let floor = grid(8);
    let ray = |_| {
        let target = floor.inner_point(random) + DVec3::Y * 0.5;
        let way = DVec3::new(tilt, -1.0, tilt);
        let way = if tilt.abs() > 0.0 {
            way * DVec3::new(random.pick(&[1.0, -1.0]), 1.0, random.pick(&[1.0, -0.7]))
        } else {
            way
        };
        Ray::new(target.as_vec3(), way.as_vec3())
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: floor.scene(),
        rays,
        is_inside: false,
    }
}
