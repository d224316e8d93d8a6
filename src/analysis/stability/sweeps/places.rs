//! Sweeps over where and how large things are: numbers that leave the range in which single precision is fine.

use glam::{DAffine3, DQuat, DVec3};

use super::super::random::Random;
use super::shapes::{Shape, ball, cuboid, from_inside, quad, through, turn};
use super::{Case, PLAIN, Sweep, powers};
use crate::analysis::plain_scene::scene_of;
use crate::scene::{Instance, Scene};

pub(super) const SWEEPS: &[Sweep] = &[
    Sweep {
        name: "distance",
        description: "a ball of radius 10 far from the origin, seen from inside",
        parameter: "distance from the origin",
        unit: "model units",
        values: || powers(0.0, 8.0, 16),
        make: |value, count, random| placed_ball(10.0, value, count, random, 1),
        ..PLAIN
    },
    Sweep {
        name: "distance-boxes",
        description: "27 turned boxes far from the origin, seen from around them",
        parameter: "distance from the origin",
        unit: "model units",
        values: || powers(0.0, 8.0, 16),
        make: boxes,
        ..PLAIN
    },
    Sweep {
        name: "large",
        description: "a ball, ever larger, seen from inside",
        parameter: "radius",
        unit: "model units",
        values: || powers(0.0, 18.0, 18),
        // The last radius itself, rounded to f32, is beyond the limit.
        make: |value, count, random| placed_ball(value * 0.99, 0.0, count, random, 1),
        ..PLAIN
    },
    Sweep {
        name: "small",
        description: "a ball, ever smaller, seen from inside",
        parameter: "radius",
        unit: "model units",
        values: || powers(0.0, -18.0, 18),
        make: |value, count, random| placed_ball(value, 0.0, count, random, 1),
        ..PLAIN
    },
    Sweep {
        name: "denormals",
        description: "a ball whose coordinates are no longer normal floats",
        parameter: "radius",
        unit: "model units",
        values: || powers(-33.0, -45.0, 24),
        make: |value, count, random| placed_ball(value, 0.0, count, random, 2),
        ..PLAIN
    },
    Sweep {
        name: "beyond",
        description: "a ball larger than the domain: coordinates above 1e18",
        parameter: "radius",
        unit: "model units",
        values: || powers(18.5, 38.0, 13),
        make: |value, count, random| placed_ball(value, 0.0, count, random, 1),
        ..PLAIN
    },
    Sweep {
        name: "mixed-scales",
        description: "a ball of radius 1 on a floor, ever larger; rays at both",
        parameter: "size of the floor over that of the ball",
        unit: "",
        values: || powers(0.0, 12.0, 12),
        make: mixed,
        ..PLAIN
    },
    Sweep {
        name: "determinant",
        description: "a ball placed three times, once ever flatter: rays are taken to its space",
        parameter: "determinant of the placement",
        unit: "",
        values: || powers(0.0, -18.0, 18),
        make: flattened,
        is_for_structures: true,
        ..PLAIN
    },
];

/// Every `unit_every`th direction has unit length, as renderers send them; the others are as long as the way to the target.
fn placed_ball(
    radius: f64,
    distance: f64,
    count: usize,
    random: &mut Random,
    unit_every: usize,
) -> Case {
    let offset = DVec3::new(2.0, -3.0, 6.0) / 7.0 * distance;
    let place = |p: DVec3| p * radius + offset;
    let shape = ball(8, 12).placed(place);
    let mut rays = from_inside(&shape, count, random, place);
    for ray in rays.iter_mut().step_by(unit_every) {
        ray.direction = ray.direction.as_dvec3().normalize().as_vec3();
    }
    Case {
        scene: shape.scene(),
        rays,
        is_inside: true,
    }
}

fn boxes(distance: f64, count: usize, random: &mut Random) -> Case {
    let offset = DVec3::new(2.0, -3.0, 6.0) / 7.0 * distance;
    let place = |p: DVec3| turn() * p * 4.0 + offset;
    let mut shape = Shape::default();
    for i in 0..27_u32 {
        let cell = DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) - 1.0;
        shape = shape.and(cuboid(cell, DVec3::new(0.25, 0.3, 0.4)));
    }
    let shape = shape.placed(place);
    let mut ray = || {
        let origin = place(random.direction() * 3.0).as_vec3();
        let mut ray = through(origin, shape.target(random));
        ray.direction = ray.direction.as_dvec3().normalize().as_vec3();
        ray
    };
    let rays = (0..count).map(|_| ray()).collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: false,
    }
}

fn mixed(ratio: f64, count: usize, random: &mut Random) -> Case {
    let corner = |x: f64, z: f64| DVec3::new(x * ratio, -1.3, z * ratio * 0.7);
    let floor = quad([
        corner(-1.0, -1.0),
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
        corner(1.0, -1.0),
    ]);
    let ball = ball(8, 12);
    let ray = |i| {
        let near = DVec3::new(
            random.signed() * 3.0,
            0.3 + random.unit(),
            random.signed() * 3.0,
        );
        match i % 3 {
            // From above the ball at either, and from afar at the ball.
            0 => through((near + DVec3::Y * 1.5).as_vec3(), ball.target(random)),
            1 => through((near + DVec3::Y * 1.5).as_vec3(), floor.target(random)),
            _ => {
                let far = near * DVec3::new(ratio, ratio, ratio).max(DVec3::splat(4.0)) * 0.3;
                through((far + DVec3::Y * 2.0).as_vec3(), ball.target(random))
            }
        }
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: ball.clone().and(floor.clone()).scene(),
        rays,
        is_inside: false,
    }
}

fn flattened(determinant: f64, count: usize, random: &mut Random) -> Case {
    let shape = ball(6, 9);
    let mut scene: Scene = scene_of(&shape.positions, &shape.triangles);
    let flat = |angle: f64, scale: DVec3, x: f64| {
        let rotation = DQuat::from_euler(glam::EulerRot::XYZ, angle, 2.0 * angle, 0.2);
        let place = DAffine3::from_rotation_translation(rotation, DVec3::new(x, 0.1, -0.2));
        Instance::new("", 0, place * DAffine3::from_scale(scale))
    };
    scene.instances = vec![
        flat(0.4, DVec3::new(1.0, 1.0, determinant), 0.0),
        flat(1.0, DVec3::splat(0.5), 1.0),
        flat(0.1, DVec3::splat(libm::cbrt(determinant)), -1.5),
    ];
    let rays = (0..count)
        .map(|_| {
            let placed = &scene.instances[random.below(3)];
            let target = placed.world_point(shape.target(random));
            through((turn() * random.direction() * 3.0).as_vec3(), target)
        })
        .collect();
    Case {
        scene,
        rays,
        is_inside: false,
    }
}
