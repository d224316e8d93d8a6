//! Single rays that were answered wrongly once, or nearly: the smallest scenes that show it.

use bspray::accel::AcceleratorKind;
use bspray::geometry::{Interval, Ray};
use bspray::scene::{Instance, Scene};
use glam::{DAffine3, DQuat, DVec3, Vec3};

use crate::random::Random;
use crate::scenes::{Soup, scene};
use crate::{all_choices, faults};

const EVERYWHERE: Interval = Interval::new(f32::NEG_INFINITY, f32::INFINITY);

/// All choices must answer as `linear`, which must find so many hits.
fn check(soup: &Soup, rays: &[Ray], hits: usize) {
    check_scene(&scene(soup), rays, hits);
}

fn check_scene(scene: &Scene, rays: &[Ray], hits: usize) {
    let linear = AcceleratorKind::Linear.build(scene);
    let truth: Vec<_> = rays.iter().map(|r| linear.closest_hit(r)).collect();
    assert_eq!(truth.iter().flatten().count(), hits);
    for options in all_choices() {
        let tree = AcceleratorKind::Bsp.build_with(scene, &options);
        let faults = faults(&*tree, rays, &truth);
        assert!(faults.is_empty(), "{options:?}: {faults:?}");
    }
}

#[test]
fn directions_that_underflow_in_object_space_lose_nothing() {
    // (1.6, 0, 1.9) units in the last place are rounded to (2, 0, 2) there: 45 degrees from the axis rather than 40.
    let aside = [[-0.02, -0.1, 0.0], [0.02, 0.1, 0.0], [0.02, -0.1, 0.01]];
    let middle = Vec3::new(1.0, 0.0, 1.0);
    let soup = vec![aside.map(|p| (middle + Vec3::from(p)) * 1e-26)];
    let mut scene = scene(&soup);
    let larger = |by: f64| Instance::new("larger", 0, DAffine3::from_scale(DVec3::splat(by)));
    scene.instances = (5..60).map(|i| larger(2e5 * f64::from(i))).collect();
    let direction = Vec3::new(2.2e-39, 0.0, 2.7e-39);
    let ends = [f32::INFINITY, 1e19];
    let rays = ends.map(|max| Ray::new(Vec3::ZERO, direction).within(Interval::new(0.0, max)));
    check_scene(&scene, &rays, 2);
}

#[test]
fn placements_that_flatten_lose_nothing() {
    // The inverse of so flat a placement is known to few digits, and what it moves is far away in object space.
    let mut random = Random::new(11, 0);
    for flatness in [1e-7, 1e-9, 1e-11, 1e-13, 1e-15] {
        let soup: Soup = (0..40)
            .map(|_| {
                let middle = random.vector();
                [0, 1, 2].map(|_| middle + 0.3 * random.vector())
            })
            .collect();
        let mut scene = scene(&soup);
        scene.instances = (0..3)
            .map(|_| {
                let axis = random.vector().normalize().as_dvec3();
                let place = DAffine3::from_rotation_translation(
                    DQuat::from_axis_angle(axis, f64::from(random.signed())),
                    3.0 * random.vector().as_dvec3(),
                ) * DAffine3::from_scale(DVec3::new(1.0, flatness, 1.0))
                    * DAffine3::from_quat(DQuat::from_rotation_z(0.7));
                Instance::new("flat", 0, place)
            })
            .collect();
        let rays: Vec<Ray> = (0..800)
            .map(|_| {
                let [to, from] = [(); 2].map(|()| {
                    let instance = &scene.instances[random.integer(0, 2) as usize];
                    instance.world_point(1.2 * random.vector())
                });
                let from = from + random.pick(&[0.0, 1e-6, 4.0]) * random.vector();
                Ray::new(from, to - from)
            })
            .collect();
        let linear = AcceleratorKind::Linear.build(&scene);
        let hits = rays.iter().filter(|r| linear.any_hit(r)).count();
        assert!(hits > 40, "{flatness}: {hits}");
        check_scene(&scene, &rays, hits);
    }
}

/// A triangle around the z axis, of this size, at this height.
fn around_axis(size: f32, z: f32) -> [Vec3; 3] {
    [[-1.0, -1.0], [1.0, -1.0], [0.0, 2.0]].map(|[x, y]| Vec3::new(size * x, size * y, z))
}

#[test]
fn a_hit_beyond_every_finite_t_is_none() {
    // 40 over 1e-38 is 4e39.
    let soup = vec![around_axis(1.0, 40.0)];
    let directions = [1e-38, -1e-38, 1e-41, 1e-45].map(|z| Vec3::new(0.0, 0.0, z));
    let rays = directions.map(|d| Ray::new(Vec3::ZERO, d).within(EVERYWHERE));
    check(&soup, &rays, 0);
    check(
        &soup,
        &[Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.0, 1e-36))],
        1,
    );
}

#[test]
fn a_subnormal_t_is_as_exact_as_it_can_be() {
    // 1.4e-24 over 1e20 is 1.4e-44, ten units in the last place: neighbours tie there.
    for (size, speed) in [
        (1e-24_f32, 1e20_f32),
        (1e-33, 1e12),
        (1e-14, 1e30),
        (1e-8, 1e36),
    ] {
        let heights = [1.42, 1.4, 1.41, 1.4, 1.38, 1.39];
        let mut soup: Soup = heights.map(|z| around_axis(size, size * z)).into();
        soup.extend(heights.map(|z| around_axis(size, -size * z)));
        for shift in 1..8 {
            let aside = Vec3::X * (size * 9.0 * shift as f32);
            soup.extend(heights.map(|z| around_axis(size, size * z).map(|p| p + aside)));
        }
        let linear = AcceleratorKind::Linear.build(&scene(&soup));
        let mut rays = Vec::new();
        for sign in [1.0, -1.0] {
            let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.0, sign * speed));
            let t = linear.closest_hit(&ray).unwrap().t;
            for ends in [(0.0, f32::INFINITY), (t, t), (0.0, t), (t, 1.0), (-t, -t)] {
                rays.push(ray.within(Interval::new(ends.0, ends.1)));
            }
        }
        check(&soup, &rays, rays.len());
    }
}

#[test]
fn a_surface_closer_than_any_normal_number_is_met() {
    for z in [1e-45_f32, 1e-43, 1e-42, 3e-41, 1e-40, 1e-39, -1e-45, -5e-42] {
        let corners = around_axis(1.0, z);
        // Equal t at other places in the triangle: the first of them wins.
        let soup: Soup = (0..9)
            .map(|i| {
                corners
                    .map(|p| p * (1.0 + 0.37 * i as f32) * Vec3::new(1.0, 1.0, 0.0) + z * Vec3::Z)
            })
            .rev()
            .collect();
        let mut rays = Vec::new();
        for i in 0..40 {
            let aside = Vec3::new(0.011 * i as f32 - 0.2, 0.017 * i as f32 - 0.3, 0.0);
            let ray = Ray::new(aside, Vec3::Z);
            rays.extend([ray.within(EVERYWHERE), ray.within(Interval::new(z, z))]);
        }
        check(&soup, &rays, rays.len());
    }
}

#[test]
fn equal_hits_behind_the_origin_are_all_looked_at() {
    for size in [1.0_f32, 0.7, 3.3] {
        let mut soup = Soup::new();
        for i in 0..40 {
            let turned = if i % 2 == 0 { 1.0 } else { -1.0 };
            soup.push([[-0.3, -0.3], [0.3, -0.3], [0.0, 0.4]].map(|[x, y]| {
                let reach = 1.0 - 0.02 * i as f32;
                Vec3::new(x * turned * reach, y * turned * reach, -1.0) * size
            }));
        }
        soup.reverse();
        let mut rays = Vec::new();
        for i in 0..200 {
            let height = size * (0.1 + 0.37 * i as f32);
            for speed in [1.0, 0.3, 0.1, 7.0, 1e-4] {
                let ray = Ray::new(Vec3::Z * height, Vec3::new(0.0, 0.0, speed));
                rays.push(ray.within(EVERYWHERE));
            }
        }
        check(&soup, &rays, rays.len());
    }
}

#[test]
fn coordinates_beyond_the_importers_limit_are_no_exception() {
    for size in [1e18_f32, 1.9e18, 1.999e18, 5e18, 1e19] {
        let soup = vec![
            [
                Vec3::new(-size, -size, -size),
                Vec3::new(size, -size, size),
                Vec3::new(0.0, size, 0.3 * size),
            ],
            [
                Vec3::new(-size, size, size),
                Vec3::new(size, size, -size),
                Vec3::new(0.1 * size, -size, 0.3 * size),
            ],
        ];
        let mut rays = Vec::new();
        for direction in [
            Vec3::Z,
            Vec3::new(1.0, 1.0, 1.1),
            Vec3::new(-1.0, 0.9, 1.0),
            Vec3::new(-0.9, -1.0, 1.1),
        ] {
            rays.push(Ray::new(Vec3::ZERO, direction * 1e-3).within(EVERYWHERE));
            rays.push(Ray::new(-direction * 0.3 * size, direction).within(EVERYWHERE));
        }
        check(&soup, &rays, rays.len());
    }
}
