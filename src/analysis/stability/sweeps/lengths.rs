//! Sweeps over proportions: slender triangles, long and short directions, boxes that are narrow for their distance.

use glam::{DVec3, Vec3};

use super::super::random::Random;
use super::shapes::{Shape, ball, cuboid, from_inside, through};
use super::{Case, PLAIN, Sweep, powers};
use crate::geometry::Ray;

pub(super) const SWEEPS: &[Sweep] = &[
    Sweep {
        name: "slenderness",
        description: "closed needles along an axis, seen from inside",
        parameter: "length over width",
        unit: "",
        values: || powers(0.0, 12.0, 12),
        make: needles,
        ..PLAIN
    },
    Sweep {
        name: "long-directions",
        description: "a ball seen from inside with ever longer directions",
        parameter: "factor on the direction",
        unit: "",
        values: || powers(0.0, 38.0, 19),
        make: scaled_directions,
        ..PLAIN
    },
    Sweep {
        name: "short-directions",
        description: "a ball seen from inside with ever shorter directions",
        parameter: "factor on the direction",
        unit: "",
        values: || powers(0.0, -45.0, 15),
        make: scaled_directions,
        ..PLAIN
    },
    Sweep {
        name: "narrow",
        description: "axis-parallel rays at triangles that are narrow for their distance",
        parameter: "distance over width",
        unit: "",
        values: || powers(0.0, 12.0, 12),
        make: narrow,
        ..PLAIN
    },
];

fn needles(slenderness: f64, count: usize, random: &mut Random) -> Case {
    let width = 1.0 / slenderness;
    let needle = cuboid(DVec3::ZERO, DVec3::new(1.0, width, width * 0.7));
    let place = |p: DVec3| p * DVec3::new(1.0, width, width);
    let rays = from_inside(&needle, count, random, place);
    Case {
        scene: needle.scene(),
        rays,
        is_inside: true,
    }
}

fn scaled_directions(factor: f64, count: usize, random: &mut Random) -> Case {
    let shape = ball(8, 12);
    let mut rays = from_inside(&shape, count, random, |p| p);
    for ray in &mut rays {
        // The greatest factor alone would be infinite for some.
        let way = ray.direction.normalize().as_dvec3();
        ray.direction = (way * factor.min(f64::from(f32::MAX))).as_vec3();
    }
    // The shortest have no direction left, which is outside of the domain and is told so. Where a few bits are left the ray stays inside the ball.
    Case {
        scene: shape.scene(),
        rays,
        is_inside: true,
    }
}

fn narrow(ratio: f64, count: usize, random: &mut Random) -> Case {
    let width = 1.0 / ratio;
    let mut shape = Shape::default();
    for (at, size) in [(0.0, width), (3.0, 0.4), (-3.0, 0.4), (7.0, 1.0)] {
        let triangle = Shape {
            positions: vec![
                DVec3::new(1.0, -size, at - size),
                DVec3::new(1.2, size, at - size * 0.5),
                DVec3::new(0.9, size * 0.3, at + size),
            ],
            triangles: vec![[0, 1, 2]],
        };
        shape = shape.and(triangle);
    }
    let ray = |i| {
        let narrow = Shape {
            triangles: vec![shape.triangles[0]],
            ..shape.clone()
        };
        let to = narrow.inner_point(random).as_vec3();
        if i % 4 == 0 {
            through(Vec3::new(-1.0, 0.3, 0.2), to)
        } else {
            Ray::new(to.with_x(0.0), Vec3::X)
        }
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: false,
    }
}
