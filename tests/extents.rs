//! Extents change no answer: no test rejects a ray that exact arithmetic says hits, and every combination of tests gives what `linear` gives, bit for bit.

#[path = "support/random.rs"]
mod random;
#[path = "support/soup.rs"]
mod soup;

use bspray::accel::extents::{
    ExtentChoice, ExtentRay, ExtentSet, ExtentSphere, ExtentTest, ExtentsLoop, MeshAccelerator,
    PointCluster, View, WorldRay,
};
use bspray::accel::{Accelerator, AcceleratorKind, BuildOptions, TestSpaces};
use bspray::geometry::{Interval, Ray, Triangle, exact};
use bspray::scene::{Camera, Instance, Projection, Scene};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use proptest::prelude::*;
use random::Random;

/// A placement that turns, shears, mirrors, and scales from 1e-6 to 1e6, the axes unevenly, up to 1e7 times its size from the origin.
fn placement(random: &mut Random) -> DAffine3 {
    let turn = |random: &mut Random| {
        let angles = random.vector().as_dvec3() * 3.0;
        DMat3::from_quat(DQuat::from_euler(
            glam::EulerRot::XYZ,
            angles.x,
            angles.y,
            angles.z,
        ))
    };
    let power = |random: &mut Random, most: f64| libm::exp2(most * (2.0 * random.unit() - 1.0));
    let size = power(random, 20.0);
    let uneven = random.pick(&[0.0, 1.0, 4.0, 8.0]);
    let scale = DVec3::new(
        power(random, uneven),
        -power(random, uneven),
        power(random, uneven),
    );
    let shear = DMat3::from_cols(
        DVec3::X,
        DVec3::new(f64::from(random.signed()), 1.0, 0.0),
        DVec3::new(0.0, f64::from(random.signed()), 1.0),
    );
    let matrix = turn(random) * shear * DMat3::from_diagonal(scale * size) * turn(random);
    let offset = random.pick(&[0.0, 1.0, 1e3, 1e7]);
    DAffine3 {
        matrix3: matrix,
        translation: random.vector().as_dvec3() * (size * offset),
    }
}

/// Loose triangles placed once (tested in world space) or twice (tested in object space).
fn scene(random: &mut Random) -> Scene {
    let count = random.integer(1, 12) as usize;
    let triangles: Vec<Triangle> = if random.integer(0, 2) == 0 {
        soup::tangle(random, count)
    } else {
        let corner = |random: &mut Random| random.vector() * Vec3::new(1.0, 2.0, 3.0);
        let three = |random: &mut Random| [0; 3].map(|_| corner(random));
        let triangle = |_| {
            let [a, b, c] = three(random);
            Triangle::new(a, b, c)
        };
        (0..count).map(triangle).collect()
    };
    let mut scene = soup::scene_of(&triangles);
    let first = placement(random);
    scene.instances[0].world_from_object = first;
    if random.integer(0, 1) == 0 {
        let mut second = placement(random);
        if random.integer(0, 1) == 0 {
            second = first * DAffine3::from_rotation_y(0.5);
        }
        scene.instances.push(Instance::new("", 0, second));
    }
    scene
}

/// Rays that start near and far, end where they should, and go just past corners and through edges.
fn rays(scene: &Scene, random: &mut Random) -> Vec<Ray> {
    let clusters = scene.clusters();
    let corners: Vec<Vec3> = scene.world_points(&clusters).collect();
    let size = scene.bounds().diagonal().max(1e-30);
    (0..40)
        .map(|_| {
            let target = match random.integer(0, 2) {
                0 => random.pick(&corners),
                1 => random
                    .pick(&corners)
                    .lerp(random.pick(&corners), random.unit() as f32),
                _ => random.pick(&corners) + random.vector() * size * 1e-3,
            };
            let distance = random.pick(&[0.0, 1e-3, 1.0, 50.0, 1e3, 1e6]);
            let origin = target + random.vector() * (size * distance);
            let mut direction = target - origin;
            if random.integer(0, 3) == 0 {
                direction[random.integer(0, 2) as usize] = 0.0;
            }
            if direction == Vec3::ZERO {
                direction = random.vector();
            }
            direction *= random.pick(&[1.0, 1e-6, 1e6, -1.0]);
            let ray = Ray::new(origin, direction);
            match random.integer(0, 4) {
                0 => ray.within(Interval::new(-2.0, 2.0)),
                1 => ray.within(Interval::new(0.0, 1.0)),
                _ => ray,
            }
        })
        .collect()
}

/// Every test of every object, judged by exact arithmetic. Returns hits, and rejections.
fn judge(scene: &Scene, rays: &[Ray], options: &BuildOptions) -> (usize, usize) {
    let spaces = TestSpaces::of(scene);
    let objects = ExtentsLoop::build(scene, options);
    let (mut hits, mut rejections) = (0, 0);
    for ray in rays.iter().filter(|r| r.is_traceable()) {
        let world = objects.world_ray(ray);
        for object in objects.objects() {
            let mesh = scene.mesh_of(object.instance);
            let is_hit = (0..mesh.triangles.len() as u32).any(|t| {
                let (ray, triangle) = spaces.test(scene, ray, object.instance, t);
                exact::hits(&ray, &triangle)
            });
            hits += usize::from(is_hit);
            let in_object = object.extents.object_ray(ray).map(|r| ExtentRay::new(&r));
            for test in ExtentTest::ALL {
                let admits = admits(object, test, ray, &world, in_object.as_ref());
                assert!(
                    admits || !is_hit,
                    "{} rejects {ray:?}, which hits {:?}",
                    test.name(),
                    scene.instances[object.instance as usize]
                );
                rejections += usize::from(!admits);
            }
        }
    }
    (hits, rejections)
}

fn admits(
    object: &bspray::accel::extents::ExtentObject,
    test: ExtentTest,
    ray: &Ray,
    world: &WorldRay,
    in_object: Option<&ExtentRay>,
) -> bool {
    object.extents.admits(test, ray, world, in_object, &mut 0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn no_extent_rejects_a_ray_that_hits(seed in any::<u64>()) {
        let mut random = Random::new(seed, 0);
        let scene = scene(&mut random);
        let rays = rays(&scene, &mut random);
        for sphere in ExtentSphere::ALL {
            judge(&scene, &rays, &BuildOptions { sphere, ..BuildOptions::default() });
        }
    }
}

#[test]
fn the_judged_rays_hit_and_are_rejected_often() {
    let (mut hits, mut rejections) = (0, 0);
    for seed in 0..100 {
        let mut random = Random::new(seed, 1);
        let scene = scene(&mut random);
        let rays = rays(&scene, &mut random);
        let found = judge(&scene, &rays, &BuildOptions::default());
        (hits, rejections) = (hits + found.0, rejections + found.1);
    }
    assert!(hits > 800 && rejections > 2000, "{hits} {rejections}");
}

fn view(projection: Projection, position: Vec3, focal_point: Vec3) -> View {
    let camera = Camera {
        name: String::new(),
        position,
        focal_point,
        view_up: Vec3::new(0.1, 1.0, 0.2),
        projection,
    };
    let size = (24, 16);
    View {
        camera: camera.frame(size.0, size.1).expect("a camera that sees"),
        size,
        filter_radius: 1.5,
    }
}

/// Rays as the renderer sends them: through the corners of every pixel's filter, and within it.
fn eye_rays(view: &View, random: &mut Random) -> Vec<Ray> {
    let mut rays = Vec::new();
    for y in 0..view.size.1 {
        for x in 0..view.size.0 {
            for k in 0..6 {
                let offset = |random: &mut Random, bit: i32| match k {
                    0..4 => f64::from(2 * (k >> bit & 1) - 1),
                    _ => f64::from(random.signed()),
                };
                let at = |pixel: u32, offset: f64| f64::from(pixel) + 0.5 + 1.5 * offset;
                let (dx, dy) = (offset(random, 0), offset(random, 1));
                rays.push(view.camera.ray(at(x, dx), at(y, dy), Some((x, y))));
            }
        }
    }
    rays
}

#[test]
fn no_screen_extent_rejects_an_eye_ray_that_hits() {
    let (mut hits, mut rejections) = (0, 0);
    for seed in 0..60 {
        let mut random = Random::new(seed, 2);
        let scene = scene(&mut random);
        let (bounds, corners) = (scene.bounds(), scene.clusters());
        let corners: Vec<Vec3> = scene.world_points(&corners).collect();
        let target = random.pick(&corners);
        // Also from within, with much behind the eye.
        let distance = random.pick(&[0.2, 1.0, 3.0]);
        let eye = bounds.center() + random.vector() * bounds.diagonal() * distance;
        let projection = if random.integer(0, 2) == 0 {
            Projection::Orthographic {
                height: bounds.diagonal() * 0.7,
            }
        } else {
            Projection::Perspective {
                view_angle: random.pick(&[10.0, 60.0, 120.0]),
            }
        };
        if eye == target {
            continue;
        }
        let view = view(projection, eye, target);
        let options = BuildOptions {
            view: Some(view),
            ..BuildOptions::default()
        };
        let found = judge(&scene, &eye_rays(&view, &mut random), &options);
        (hits, rejections) = (hits + found.0, rejections + found.1);
    }
    assert!(hits > 3000 && rejections > 100_000, "{hits} {rejections}");
}

#[test]
fn every_combination_of_extents_gives_the_answers_of_linear() {
    let mut hits = 0;
    for seed in 0..12 {
        let mut random = Random::new(seed, 3);
        let scene = scene(&mut random);
        let bounds = scene.bounds();
        let eye = bounds.center() + Vec3::new(0.3, 0.5, 2.0) * bounds.diagonal();
        let projection = Projection::Perspective { view_angle: 40.0 };
        let view = view(projection, eye, bounds.center());
        let mut rays = rays(&scene, &mut random);
        rays.extend(eye_rays(&view, &mut random).iter().step_by(7));
        let linear = AcceleratorKind::Linear.build(&scene);
        for mesh in MeshAccelerator::ALL {
            let options = BuildOptions {
                mesh,
                view: Some(view),
                ..BuildOptions::default()
            };
            let mut objects = ExtentsLoop::build(&scene, &options);
            let auto: Vec<ExtentSet> = objects.objects().iter().map(|o| o.tests).collect();
            let fixed = ExtentSet::all().map(|set| vec![set; auto.len()]);
            for tests in std::iter::once(auto.clone()).chain(fixed) {
                objects.choose(|object| tests[object]);
                for ray in &rays {
                    let want = linear.closest_hit(ray);
                    hits += usize::from(want.is_some());
                    assert_eq!(objects.closest_hit(ray), want, "{mesh} {tests:?} {ray:?}");
                    assert_eq!(
                        objects.any_hit(ray),
                        want.is_some(),
                        "{mesh} {tests:?} {ray:?}"
                    );
                }
            }
        }
    }
    assert!(hits > 5000, "{hits}");
}

#[test]
fn clusters_of_an_instance_are_those_of_its_transformed_vertices() {
    let mut random = Random::new(5, 4);
    for _ in 0..50 {
        let points: Vec<Vec3> = (0..40).map(|_| random.vector()).collect();
        let map = placement(&mut random);
        let cluster = PointCluster::new(&points).expect("finite points");
        let Some(placed) = cluster.transformed(&map) else {
            continue;
        };
        let all = points
            .iter()
            .map(|p| map.transform_point3(p.as_dvec3()).as_vec3());
        let all: Vec<Vec3> = all.collect();
        let [hull, full] = [placed.bounds(), all.iter().copied().collect()];
        // The same box but for roundings in double precision, which may tip one to single precision.
        let slack = 1e-6 * full.diagonal()
            + f32::EPSILON * full.max.abs().max(full.min.abs()).max_element();
        assert!((hull.min - full.min).abs().max_element() <= slack);
        assert!((hull.max - full.max).abs().max_element() <= slack);
        let sphere = placed.smallest_sphere().expect("in range");
        let farthest = all
            .iter()
            .map(|p| p.distance(sphere.center))
            .fold(0.0, f32::max);
        assert!(farthest <= sphere.radius + slack);
    }
}

#[test]
fn the_plan_is_the_same_every_time() {
    let scene = bspray::import::load(&["models/lecture-objects.gltf".into()]).expect("a model");
    let frame = scene.cameras[0].frame(160, 90).expect("it sees");
    let view = View {
        camera: frame,
        size: (160, 90),
        filter_radius: 1.5,
    };
    let plan = |mesh| {
        let options = BuildOptions {
            mesh,
            extents: ExtentChoice::Auto,
            view: Some(view),
            ..BuildOptions::default()
        };
        let objects = ExtentsLoop::build(&scene, &options);
        objects
            .objects()
            .iter()
            .map(|o| o.tests)
            .collect::<Vec<_>>()
    };
    for mesh in MeshAccelerator::ALL {
        assert_eq!(plan(mesh), plan(mesh), "{mesh}");
    }
    assert!(
        plan(MeshAccelerator::Linear)
            .iter()
            .any(|set| set.has(ExtentTest::Screen))
    );
}
