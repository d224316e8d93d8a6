//! Motion vectors against projections worked out by hand. Pictures of 64 by 64 pixels; a perspective camera's screen is 32 pixels away.

use bspray::accel::AcceleratorKind;
use bspray::picture::{Picture, Samples};
use bspray::render::{Film, Integrator, MotionFrame, SkyMode, add_motion};
use bspray::scene::{Camera, Projection, Scene, TriangleMesh};
use glam::{DAffine3, DVec2, DVec3, Vec3};

use super::scenes::{film, options, quad, scene};
use super::setup::{matt, parallel};

const SIZE: u32 = 64;

/// A square at depth `z` behind the origin.
fn wall(half: f32, z: f32) -> TriangleMesh {
    let at = |x: f32, y: f32| Vec3::new(x * half, y * half, -z);
    quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
}

fn one(mesh: TriangleMesh, camera: Camera) -> Scene {
    let mut scene = scene([(mesh, matt(Vec3::ONE))]);
    scene.cameras.push(camera);
    scene
}

/// At the origin, looking along -z turned to the left by `angle`.
fn eye(angle: f64) -> Camera {
    let (sine, cosine) = libm::sincos(angle);
    Camera {
        name: String::new(),
        position: Vec3::ZERO,
        focal_point: DVec3::new(-sine, 0.0, -cosine).as_vec3(),
        view_up: Vec3::Y,
        projection: Projection::Perspective { view_angle: 90.0 },
    }
}

fn seen(scene: &Scene) -> Film {
    let options = options((SIZE, SIZE), 1, Integrator::Normals);
    film(scene, AcceleratorKind::Bvh2, SkyMode::Off, &options)
}

/// The vectors of `now` to `before` and `after`, each scene seen by its first camera.
fn vectors(now: &Scene, before: &Scene, after: &Scene) -> Vec<[DVec2; 2]> {
    let cameras = [now, before, after].map(|s| s.cameras[0].frame(SIZE, SIZE).expect("a camera"));
    let frames = [now, before, after];
    let frame = |i: usize| MotionFrame {
        scene: frames[i],
        camera: &cameras[i],
    };
    let picture = add_motion(Picture::default(), &seen(now), frame(0), frame(1), frame(2));
    let values = |name: &str| match picture.channel(name) {
        Some(Samples::F32(values)) => values.clone(),
        other => panic!("{name}: {other:?}"),
    };
    let names = ["backward.u", "backward.v", "forward.u", "forward.v"];
    let [bu, bv, fu, fv] = names.map(values);
    let vector = |u: &[f32], v: &[f32], i: usize| DVec2::new(u[i].into(), v[i].into());
    (0..bu.len())
        .map(|i| [vector(&bu, &bv, i), vector(&fu, &fv, i)])
        .collect()
}

/// Column and row of a pixel's centre, from the picture's middle, to the right and upwards.
fn place(index: usize) -> DVec2 {
    let (x, y) = (index as u32 % SIZE, index as u32 / SIZE);
    let half = f64::from(SIZE) / 2.0;
    DVec2::new(f64::from(x) + 0.5 - half, half - 0.5 - f64::from(y))
}

#[test]
fn what_is_moved_by_pixels_moves_by_pixels() {
    // 16 pixels a unit; the square covers the middle half of the picture.
    let at = |offset: DVec3| {
        let mut scene = one(wall(1.0, 0.0), parallel(Vec3::Z, Vec3::ZERO, Vec3::Y, 4.0));
        scene.instances[0].world_from_object = DAffine3::from_translation(offset);
        scene
    };
    // Far beyond the picture's edge, and deeper, which parallel rays do not show.
    let before = at(DVec3::new(-0.25, 0.5, -3.0));
    let after = at(DVec3::new(100.0, -2.0, 0.0));
    for (index, [backward, forward]) in vectors(&at(DVec3::ZERO), &before, &after)
        .iter()
        .enumerate()
    {
        let is_hit = place(index).abs().max_element() < 16.0;
        let share = if is_hit { 1.0 } else { 0.0 };
        assert_eq!(*backward, DVec2::new(-4.0, 8.0) * share, "{index}");
        assert_eq!(*forward, DVec2::new(1600.0, -32.0) * share, "{index}");
    }
}

#[test]
fn a_turning_camera_moves_what_stands_still_by_tangents() {
    let turn = 0.25;
    let at = |angle| one(wall(40.0, 5.0), eye(angle));
    let (sine, cosine) = libm::sincos(turn);
    for (index, found) in vectors(&at(0.0), &at(-turn), &at(turn)).iter().enumerate() {
        let here = place(index);
        for (found, sine) in found.iter().zip([-sine, sine]) {
            // What the eye turns to the left of goes to the right.
            let depth = 32.0 * cosine - here.x * sine;
            let there = DVec2::new(here.x * cosine + 32.0 * sine, here.y) * 32.0 / depth;
            let off = (*found - (there - here)).length();
            assert!(off < 1e-3, "{here}: {found} is not {}", there - here);
        }
    }
}

#[test]
fn a_moving_camera_moves_near_things_more() {
    let camera = |x: f32| Camera {
        position: Vec3::X * x,
        focal_point: Vec3::new(x, 0.0, -1.0),
        ..eye(0.0)
    };
    for depth in [4.0, 16.0] {
        let at = |x| one(wall(40.0, depth as f32), camera(x));
        for [backward, forward] in vectors(&at(0.0), &at(-0.5), &at(0.25)) {
            let want = DVec2::X * 32.0 / depth;
            assert!((backward - want * 0.5).length() < 1e-3, "{backward}");
            assert!((forward + want * 0.25).length() < 1e-3, "{forward}");
        }
    }
}

#[test]
fn what_stands_still_has_exact_zeros_and_so_has_what_goes_behind_the_eye() {
    let still = one(wall(40.0, 3.0), eye(0.0));
    let behind = one(wall(40.0, -3.0), eye(0.0));
    let zero = 0.0_f64.to_bits();
    for found in vectors(&still, &still, &behind) {
        for number in found.iter().flat_map(DVec2::to_array) {
            assert_eq!(number.to_bits(), zero);
        }
    }
}

#[test]
fn triangles_that_the_other_frame_lacks_do_not_confuse_the_others() {
    let camera = || parallel(Vec3::Z, Vec3::ZERO, Vec3::Y, 4.0);
    let now = one(wall(1.0, 0.0), camera());
    let moved = |triangles: Vec<[u32; 3]>, spare: usize| {
        let mut mesh = wall(1.0, 0.0);
        mesh.triangles = triangles;
        mesh.parts[0].triangle_count = mesh.triangles.len() as u32;
        mesh.positions.extend(vec![Vec3::ZERO; spare]);
        mesh.positions.iter_mut().for_each(|p| p.x += 0.5);
        one(mesh, camera())
    };
    // The first of its two triangles is left out; with other vertices, nothing can be said.
    let fewer = moved(vec![[0, 2, 3]], 0);
    let other = moved(vec![[0, 2, 3]], 1);
    let middle = vectors(&now, &fewer, &other)[32 * 64 + 40];
    assert_eq!(middle, [DVec2::X * 8.0, DVec2::ZERO]);
}

#[test]
fn objects_are_known_by_their_names_where_one_comes_or_goes() {
    let camera = || parallel(Vec3::Z, Vec3::ZERO, Vec3::Y, 4.0);
    let named = |names: &[&str], offset: f64| {
        let wall = || (wall(1.0, 0.0), matt(Vec3::ONE));
        let mut scene = scene(names.iter().map(|_| wall()));
        for (index, (instance, name)) in scene.instances.iter_mut().zip(names).enumerate() {
            instance.name = (*name).to_owned();
            // The last one is in front.
            let place = DVec3::new(offset, 0.0, index as f64 * 0.1);
            instance.world_from_object = DAffine3::from_translation(place);
        }
        scene.cameras.push(camera());
        scene
    };
    let now = named(&["a", "b"], 0.0);
    let found = vectors(&now, &named(&["b"], 0.25), &named(&["b", "b", "a"], 0.25));
    assert_eq!(found[32 * 64 + 32], [DVec2::X * 4.0, DVec2::ZERO]);
}
