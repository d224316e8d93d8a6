//! Sweeps over planes: rays that graze them, layers that nearly coincide, triangles that cross, rays that start on a surface.

use glam::DVec3;

use super::super::random::Random;
use super::shapes::{Shape, ball, from_around, grid, quad};
use super::{Case, PLAIN, Sweep, moved, powers, shaken, ulps};
use crate::geometry::Ray;

pub(super) const SWEEPS: &[Sweep] = &[
    Sweep {
        name: "grazing",
        description: "a flat grid met ever more flatly",
        parameter: "angle to the plane",
        unit: "radians",
        values: || powers(0.0, -9.0, 18),
        make: grazing,
        ..PLAIN
    },
    Sweep {
        name: "layers",
        description: "three walls, one behind the other, ever closer: which is first?",
        parameter: "gap",
        unit: "ulps",
        values: || {
            (0..=12)
                .rev()
                .map(|i| f64::from(1 << (i * 22 / 12)))
                .collect()
        },
        make: layers,
        ..PLAIN
    },
    Sweep {
        name: "crossing",
        description: "triangles that intersect at an ever smaller angle, met beside the line they share",
        parameter: "angle between the planes",
        unit: "radians",
        values: || powers(0.0, -9.0, 18),
        make: crossing,
        ..PLAIN
    },
    Sweep {
        name: "on-surface",
        description: "rays that start ever closer to the surface, on either side",
        parameter: "coordinates are moved by up to",
        unit: "ulps",
        values: ulps,
        make: on_surface,
        ..PLAIN
    },
    Sweep {
        name: "t-junctions",
        description: "an edge met by the corner of its neighbours, ever closer to it",
        parameter: "the corner is moved by",
        unit: "ulps",
        values: ulps,
        make: t_junction,
        ..PLAIN
    },
];

fn grazing(angle: f64, count: usize, random: &mut Random) -> Case {
    let floor = grid(12);
    let ray = |_| {
        let target = floor.target(random).as_dvec3();
        let heading = std::f64::consts::TAU * random.unit();
        let flat = DVec3::new(libm::cos(heading), 0.0, libm::sin(heading)) * libm::cos(angle);
        let way = flat + DVec3::Y * libm::sin(angle) * random.pick(&[1.0, -1.0]);
        Ray::new((target - way * 2.0).as_vec3(), way.as_vec3())
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: floor.scene(),
        rays,
        is_inside: false,
    }
}

fn layers(gap: f64, count: usize, random: &mut Random) -> Case {
    let mut walls = Shape::default();
    for layer in [1.0, 0.0, 2.0] {
        // Tilted, so that no test cancels what the layers have in common.
        let at = |x: f64, y: f64| {
            let z = (1.5 + 0.3 * x - 0.2 * y) as f32;
            DVec3::new(x, y, f64::from(moved(z, gap * layer)))
        };
        walls = walls.and(quad([
            at(-1.0, -0.9),
            at(1.1, -1.0),
            at(1.0, 1.2),
            at(-0.8, 1.0),
        ]));
    }
    let ray = |_| {
        let way = DVec3::new(random.signed() * 0.3, random.signed() * 0.3, 1.0);
        let target = DVec3::new(random.signed() * 0.7, random.signed() * 0.7, 1.5);
        let side = random.pick(&[1.0, -1.0]);
        Ray::new((target - way * side).as_vec3(), (way * side).as_vec3())
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: walls.scene(),
        rays,
        is_inside: false,
    }
}

fn crossing(angle: f64, count: usize, random: &mut Random) -> Case {
    let wall = |rise: f64| {
        let at = |x: f64, y: f64| DVec3::new(x, y, 1.0 + 0.1 * x + rise * y);
        quad([at(-1.0, -1.0), at(1.0, -0.9), at(1.1, 1.0), at(-0.9, 1.2)])
    };
    let walls = wall(0.3)
        .and(wall(0.3 + libm::tan(angle.min(1.0))))
        .and(wall(-0.2));
    let ray = |_| {
        // Beside the line y = 0 that they share, by all magnitudes.
        let y = random.signed() * libm::pow(10.0, -6.0 * random.unit());
        let x = random.signed() * 0.8;
        let target = DVec3::new(x, y, 1.0 + 0.1 * x + 0.3 * y);
        from_around(target, 2.0, random)
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: walls.scene(),
        rays,
        is_inside: false,
    }
}

fn on_surface(ulps: f64, count: usize, random: &mut Random) -> Case {
    let shape = ball(8, 12).and(grid(8).placed(|p| p * 4.0 + DVec3::NEG_Y));
    let ray = |_| {
        let point = shape.target(random);
        let origin = shaken(point, ulps, random);
        Ray::new(origin, random.direction().as_vec3())
    };
    let rays = (0..count).map(ray).collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: false,
    }
}

fn t_junction(ulps: f64, count: usize, random: &mut Random) -> Case {
    let [top, bottom] = [DVec3::new(0.31, 1.1, 0.2), DVec3::new(0.1, -1.0, -0.1)];
    let mut middle = bottom.lerp(top, 0.37).as_vec3();
    middle.x = moved(middle.x, ulps);
    let middle = middle.as_dvec3();
    // One triangle at the left of the edge, two at its right.
    let shape = Shape {
        positions: vec![
            top,
            bottom,
            DVec3::new(-1.4, 0.1, 0.3),
            middle,
            DVec3::new(1.3, 0.2, 0.0),
        ],
        triangles: vec![[0, 2, 1], [0, 3, 4], [3, 1, 4]],
    };
    let rays = (0..count)
        .map(|_| {
            let target = bottom.lerp(top, random.unit());
            from_around(target, 2.0, random)
        })
        .collect();
    Case {
        scene: shape.scene(),
        rays,
        is_inside: false,
    }
}
