//! Rays that make trouble: through corners and along planes, from anywhere, of every length, ending just where a hit is.

use bspray::accel::{Accelerator, Hit};
use bspray::geometry::{Interval, Ray};
use glam::Vec3;

use crate::random::Random;
use crate::scenes::Soup;

/// Rays in tiles of 64, most of which go about the same way.
pub(crate) fn tiles(
    random: &mut Random,
    soup: &Soup,
    linear: &dyn Accelerator,
    count: usize,
) -> Vec<Ray> {
    let mut rays = Vec::new();
    for _ in 0..count {
        let start = rays.len();
        tile(random, soup, &mut rays);
        let mode = random.integer(0, 3);
        for ray in &mut rays[start..] {
            if mode == 0 {
                continue;
            }
            let hit = linear.closest_hit(ray);
            end_at(random, ray, hit);
        }
        if random.integer(0, 3) == 0 {
            for ray in &mut rays[start..] {
                spoil(random, ray);
            }
        }
    }
    rays
}

fn tile(random: &mut Random, soup: &Soup, rays: &mut Vec<Ray>) {
    let points: Vec<Vec3> = soup.iter().flatten().copied().collect();
    let (low, high) = points
        .iter()
        .fold((points[0], points[0]), |(l, h), p| (l.min(*p), h.max(*p)));
    let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
    let size = half.max_element().max(1e-44);
    let any = |random: &mut Random| middle + size * random.vector();
    // From afar everything is in doubt, and slow.
    let distance = match random.integer(0, 7) {
        0 => random.pick(&[1e4, 1e7, 1e12]),
        _ => random.pick(&[0.0, 0.3, 1.0, 3.0, 30.0, 300.0]),
    };
    let spread = random.pick(&[0.0, 1e-5, 0.03, 0.3, 2.0]);
    let speed = random.pick(&[
        1.0, 1.0, 1.0, 1.0, 1e-5, 1e-9, 1e-20, 1e-38, 1e-41, 1e4, 1e6, 3e7, 1e12, 1e20, 1e30, 1e38,
    ]);
    let eye = middle + distance * (any(random) - middle);
    let axis = random.pick(&Vec3::AXES) * random.pick(&[1.0, -1.0]);
    let way = random.integer(0, 4);
    let on_grid = random.integer(0, 3) == 0;
    let is_parallel = random.integer(0, 2) == 0;
    let base = target(random, soup);
    for _ in 0..64 {
        let mut to = if spread < 1.0 {
            base + spread * size * random.vector()
        } else {
            target(random, soup)
        };
        if random.integer(0, 2) == 0 {
            to = target(random, soup);
        }
        if on_grid {
            to = ((to - middle) / size * 8.0).round() / 8.0 * size + middle;
        }
        let mut from = if is_parallel { eye + (to - base) } else { eye };
        let mut direction = to - from;
        match way {
            0 => {
                direction = axis * random.pick(&[1.0, 1.0, 0.7]);
                from = to - axis * (size * distance.min(1e6));
            }
            1 => {
                // On the surface itself.
                from = to;
                direction = base - eye + 0.1 * size * random.vector();
            }
            _ => {}
        }
        let longest = direction.abs().max_element();
        if longest > 0.0 && random.integer(0, 1) == 0 {
            direction /= longest;
        }
        direction *= speed;
        let interval = random.pick(&[
            Interval::FORWARD,
            Interval::FORWARD,
            Interval::new(f32::NEG_INFINITY, f32::INFINITY),
            Interval::new(f32::NEG_INFINITY, 0.0),
            Interval::new(0.0, 1.0),
        ]);
        rays.push(Ray::new(from, direction).within(interval));
    }
}

/// A corner, a point of an edge, or one within a triangle.
fn target(random: &mut Random, soup: &Soup) -> Vec3 {
    let [a, b, c] = soup[random.integer(0, soup.len() as i64 - 1) as usize];
    match random.integer(0, 4) {
        0 => a,
        1 => 0.5 * a + 0.5 * b,
        2 => b.lerp(c, random.unit() as f32),
        _ => {
            let p = b.lerp(c, random.unit() as f32);
            a.lerp(p, random.unit() as f32)
        }
    }
}

/// Moves the interval's ends to the hit, or next to it.
fn end_at(random: &mut Random, ray: &mut Ray, hit: Option<Hit>) {
    let Some(Hit {
        t,
        instance,
        triangle,
    }) = hit
    else {
        return;
    };
    let Interval { min, max } = ray.interval;
    let ends = match random.integer(0, 9) {
        0 => (t, t),
        1 => (min, t),
        2 => (t, max),
        3 => (f32::NEG_INFINITY, t),
        4 => (t, f32::INFINITY),
        5 => (t.next_down(), t.next_up()),
        6 => (t.next_up(), max),
        7 => (min, t.next_down()),
        8 => {
            *ray = ray.behind(t, (instance, triangle));
            return;
        }
        _ => return,
    };
    ray.interval = Interval::new(ends.0, ends.1);
}

/// Values that are not numbers, or no rays.
fn spoil(random: &mut Random, ray: &mut Ray) {
    let axis = random.integer(0, 2) as usize;
    match random.integer(0, 29) {
        0 => ray.origin[axis] = f32::NAN,
        1 => ray.origin[axis] = f32::INFINITY,
        2 => ray.direction[axis] = f32::NAN,
        3 => ray.direction[axis] = f32::NEG_INFINITY,
        4 => ray.direction[axis] = 0.0,
        5 => ray.direction[axis] = -0.0,
        6 => ray.direction[axis] = 1e-45,
        7 => ray.direction = Vec3::ZERO,
        8 => ray.interval.min = f32::NAN,
        9 => ray.interval.max = f32::NAN,
        10 => ray.interval = Interval::new(1.0, -1.0),
        11 => ray.interval = Interval::new(f32::INFINITY, f32::INFINITY),
        12 => ray.interval = Interval::new(f32::NEG_INFINITY, f32::NEG_INFINITY),
        13 => ray.direction *= -1.0,
        14 => ray.origin *= 1e20,
        15 => ray.direction = Vec3::splat(f32::MAX),
        16 => ray.direction[axis] = f32::MAX,
        17 => ray.interval = Interval::new(-0.0, 0.0),
        _ => {}
    }
}
