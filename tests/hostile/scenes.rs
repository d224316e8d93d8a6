//! Scenes that make trouble: much that coincides, lies in one plane or is thin, of every size and at every distance.

use bspray::geometry::Triangle;
use bspray::scene::{Instance, Scene};
use glam::{DAffine3, DQuat, Quat, Vec3};

use crate::random::Random;
use crate::soup::{scene_of, tangle};

/// Triangles, three corners each.
pub(crate) type Soup = Vec<[Vec3; 3]>;

/// A scene of one mesh in world space.
pub(crate) fn scene(soup: &Soup) -> Scene {
    let triangles: Vec<_> = soup
        .iter()
        .map(|&[a, b, c]| Triangle::new(a, b, c))
        .collect();
    scene_of(&triangles)
}

/// The soup placed several times, in ways of all kinds, and its triangles in their places.
pub(crate) fn placed(random: &mut Random, soup: &Soup) -> (Scene, Soup) {
    let mut scene = scene(soup);
    let points = || soup.iter().flatten();
    let low = points().fold(Vec3::INFINITY, |l, p| l.min(*p));
    let high = points().fold(Vec3::NEG_INFINITY, |h, p| h.max(*p));
    let size = (0.5 * high - 0.5 * low).max_element().max(1e-30);
    scene.instances.clear();
    let mut all = Soup::new();
    for _ in 0..random.integer(2, 5) {
        let axis = (random.vector() + Vec3::splat(1e-3)).normalize();
        let turn = random.pick(&[0.0, 1.0]) * random.signed();
        let scale = random.pick(&[
            Vec3::ONE,
            Vec3::ONE,
            Vec3::splat(0.1),
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::new(1.0, 1e-3, 20.0),
            Vec3::new(1.0, 0.0, 1.0),
            Vec3::splat(1e-12),
            Vec3::splat(1e6),
        ]);
        let away = random.pick(&[0.0, 0.0, 1.0, 3.0, 1e4]) * size * random.vector();
        let place = DAffine3::from_scale_rotation_translation(
            scale.as_dvec3(),
            DQuat::from_axis_angle(axis.as_dvec3(), f64::from(turn)),
            away.as_dvec3(),
        );
        let instance = Instance::new("soup", 0, place);
        all.extend(soup.iter().map(|t| t.map(|p| instance.world_point(p))));
        scene.instances.push(instance);
    }
    (scene, all)
}

/// Shapes within a few units, turned by chance.
fn shapes(random: &mut Random, count: usize) -> Soup {
    let mut soup = match random.integer(0, 8) {
        0 => scattered(random, count, 0.3),
        1 => grid(random, 2 + count / 20),
        // Every ray meets all of them, and all depths must be exact.
        2 => stack(random, count.min(50)),
        3 => slivers(random, count),
        4 => bricks(random, 1 + count / 12),
        5 => fan(random, count),
        6 => layers(random, count.min(50)),
        7 => {
            let triangles = tangle(random, count.min(100));
            triangles.iter().map(|t| *t.corners()).collect()
        }
        _ => {
            let mut soup = grid(random, 2 + count / 40);
            soup.extend(bricks(random, 1 + count / 24));
            soup.extend(slivers(random, count / 2));
            soup
        }
    };
    if random.integer(0, 2) == 0 {
        let axis = (random.vector() + Vec3::splat(1e-3)).normalize();
        let turn = Quat::from_axis_angle(axis, 3.0 * random.signed());
        soup.iter_mut().flatten().for_each(|p| *p = turn * *p);
    }
    soup
}

/// Many triangles of usual size.
pub(crate) fn usual(random: &mut Random) -> Soup {
    let count = random.pick(&[200, 400, 1000]);
    shapes(random, count)
}

/// Of every size, flattened, and far from the origin.
pub(crate) fn extreme(random: &mut Random) -> Soup {
    let scale = match random.integer(0, 4) {
        0 => random.pick(&[1e-19, 1e-25, 1e-33, 1e-38, 1e-41]),
        1 => random.pick(&[1e-15, 1e-8, 1e-3, 1e5, 1e9, 1e12, 3e17, 1e18]),
        _ => 1.0,
    };
    // Below, everything is in doubt, and exact arithmetic is slow.
    let count = if scale < 1e-16 {
        random.pick(&[1, 3, 9, 20, 40])
    } else {
        random.pick(&[1, 3, 9, 20, 60, 60, 150, 400])
    };
    let mut soup = shapes(random, count);
    let flat = random.pick(&[
        Vec3::ONE,
        Vec3::ONE,
        Vec3::ONE,
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(1.0, 1e-5, 1.0),
        Vec3::new(1e-30, 1.0, 1.0),
        Vec3::new(1.0, 1.0, 1e-40),
    ]);
    let away = random.pick(&[0.0, 0.0, 0.0, 1.0, 30.0, 1e4, 1e6]) * random.vector();
    for p in soup.iter_mut().flatten() {
        let placed = (*p * flat + away) * scale;
        *p = placed.clamp(Vec3::splat(-1e18), Vec3::splat(1e18));
    }
    soup
}

fn scattered(random: &mut Random, count: usize, size: f32) -> Soup {
    (0..count)
        .map(|_| {
            let middle = random.vector();
            [0; 3].map(|_| middle + size * random.vector())
        })
        .collect()
}

/// Squares in one plane or several, halved; some of them twice.
fn grid(random: &mut Random, cells: usize) -> Soup {
    let mut soup = Soup::new();
    let axis = random.integer(0, 2) as usize;
    let heights = random.pick(&[1, 1, 2]);
    let cells = cells.min(12);
    for height in 0..heights {
        let at = |i: usize, j: usize| {
            let p = [
                i as f32 / cells as f32 * 2.0 - 1.0,
                j as f32 / cells as f32 * 2.0 - 1.0,
                height as f32 - 1.0,
            ];
            Vec3::new(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3])
        };
        for i in 0..cells {
            for j in 0..cells {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                soup.extend([[a, b, c], [a, c, d]]);
                if random.integer(0, 3) == 0 {
                    soup.extend([[b, c, a], [d, b, a]]);
                }
            }
        }
    }
    shuffle(random, &mut soup);
    soup
}

fn shuffle(random: &mut Random, soup: &mut Soup) {
    for i in (1..soup.len()).rev() {
        soup.swap(i, random.integer(0, i as i64) as usize);
    }
}

/// Triangles upon each other, equal or nearly.
fn stack(random: &mut Random, count: usize) -> Soup {
    let base = [0; 3].map(|_| random.vector());
    let near = random.pick(&[0.0, 0.0, 1e-7, 1e-6]);
    (0..count)
        .map(|i| {
            let grown = random.pick(&[1.0, 1.0, 0.5, 2.0]);
            let mut corners = base.map(|p| p * grown + near * random.vector());
            corners.rotate_left(i % 3);
            corners
        })
        .collect()
}

/// Needles of every length and thickness, many through one point.
fn slivers(random: &mut Random, count: usize) -> Soup {
    (0..count)
        .map(|i| {
            let a = if i % 3 == 0 {
                Vec3::splat(0.1)
            } else {
                random.vector()
            };
            let along = random.vector();
            let thickness = libm::exp2f(-(random.integer(0, 26) as f32));
            [a, a + along, a + along * 0.5 + random.vector() * thickness]
        })
        .collect()
}

/// Boxes, all turned alike.
fn bricks(random: &mut Random, count: usize) -> Soup {
    let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), random.signed());
    let mut soup = Soup::new();
    for _ in 0..count {
        let (middle, size) = (0.7 * random.vector(), 0.4 * random.vector().abs());
        let corner = |i: usize| {
            let bit = |k: usize| if i >> k & 1 == 0 { -1.0 } else { 1.0 };
            turn * (middle + size * Vec3::new(bit(0), bit(1), bit(2)))
        };
        let quads = [
            [0, 1, 3, 2],
            [4, 6, 7, 5],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 5, 7, 3],
        ];
        for [a, b, c, d] in quads.map(|quad| quad.map(corner)) {
            soup.extend([[a, b, c], [a, c, d]]);
        }
    }
    soup
}

/// Around one point.
fn fan(random: &mut Random, count: usize) -> Soup {
    let middle = 0.3 * random.vector();
    let mut last = random.vector();
    (0..count)
        .map(|_| {
            let next = random.vector();
            let triangle = [middle, last, next];
            last = next;
            triangle
        })
        .collect()
}

/// Large triangles at neighbouring heights.
fn layers(random: &mut Random, count: usize) -> Soup {
    let axis = random.integer(0, 2) as usize;
    let base = random.pick(&[0.0_f32, 1.0, -1.0, 1e-40, -3e-42, 0.37]);
    (0..count)
        .map(|_| {
            let mut corners = [0; 3].map(|_| random.vector());
            let steps = random.integer(0, 3);
            for corner in &mut corners {
                corner[axis] = (0..steps).fold(base, |x, _| x.next_up());
            }
            corners
        })
        .collect()
}
