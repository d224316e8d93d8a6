//! The contract of accelerators, over every kind in the registry: what `linear` answers, all answer, bit for bit.

#[path = "support/random.rs"]
mod random;

use bspray::accel::{
    Accelerator, AcceleratorKind, BuildOptions, BuildTime, Hit, TestSpaces, TraceCounters,
};
use bspray::geometry::{Interval, Ray, exact};
use bspray::scene::{Instance, Part, Scene, TriangleMesh};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use random::Random;
use rayon::prelude::*;

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> TriangleMesh {
    let triangle_count = triangles.len() as u32;
    TriangleMesh {
        positions,
        triangles,
        parts: vec![Part {
            first_triangle: 0,
            triangle_count,
            material: 0,
        }],
        ..TriangleMesh::default()
    }
}

/// A closed ball of 2 * rows * columns triangles, none of whose edges is parallel to an axis.
fn ball(rows: u32, columns: u32) -> TriangleMesh {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1);
    let at = |row: u32, column: u32| {
        let theta = std::f64::consts::PI * f64::from(row) / f64::from(rows);
        let phi = std::f64::consts::TAU * f64::from(column % columns) / f64::from(columns);
        let (st, ct) = (libm::sin(theta), libm::cos(theta));
        (turn * DVec3::new(st * libm::cos(phi), ct, st * libm::sin(phi))).as_vec3()
    };
    let positions = (0..=rows)
        .flat_map(|r| (0..columns).map(move |c| (r, c)))
        .map(|(r, c)| at(r, c))
        .collect();
    let index = |r: u32, c: u32| r * columns + c % columns;
    let quad = |(r, c)| {
        [
            [index(r, c), index(r, c + 1), index(r + 1, c)],
            [index(r, c + 1), index(r + 1, c + 1), index(r + 1, c)],
        ]
    };
    let triangles = (0..rows)
        .flat_map(|r| (0..columns).map(move |c| (r, c)))
        .flat_map(quad)
        .collect();
    mesh(positions, triangles)
}

/// A flat grid in the plane y = 0: every ray down an axis meets edges and vertices.
fn grid(cells: u32) -> TriangleMesh {
    let n = cells + 1;
    let positions = (0..n * n)
        .map(|i| Vec3::new((i % n) as f32, 0.0, (i / n) as f32) / cells as f32 - 0.5)
        .collect();
    let cell = |i: u32| {
        let v = i / cells * n + i % cells;
        [[v, v + n, v + 1], [v + 1, v + n, v + n + 1]]
    };
    mesh(positions, (0..cells * cells).flat_map(cell).collect())
}

/// Needles of every length and thickness, many through one point.
fn slivers(random: &mut Random, count: u32) -> TriangleMesh {
    let mut positions = Vec::new();
    for i in 0..count {
        let a = if i % 3 == 0 {
            Vec3::splat(0.1)
        } else {
            random.vector()
        };
        let along = random.vector();
        let thickness = libm::exp2f(-(random.integer(0, 23) as f32));
        positions.extend([a, a + along, a + along * 0.5 + random.vector() * thickness]);
    }
    mesh(
        positions,
        (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    )
}

fn place(mesh: u32, matrix: DMat3, translation: DVec3) -> Instance {
    Instance::new(
        "",
        mesh,
        DAffine3 {
            matrix3: matrix,
            translation,
        },
    )
}

fn lone(mesh: TriangleMesh, scale: f64, offset: f64) -> Scene {
    let matrix = DMat3::from_diagonal(DVec3::splat(scale));
    Scene {
        meshes: vec![mesh],
        instances: vec![place(0, matrix, DVec3::splat(offset))],
        ..Scene::default()
    }
}

/// Meshes used once and several times, under rotations, uneven and negative scales and shears, one squashed flat.
fn instances() -> Scene {
    let turn = |a: f64, b: f64| DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, a, b, 0.2));
    let scale = |x, y, z| DMat3::from_diagonal(DVec3::new(x, y, z));
    let shear = DMat3::from_cols(
        DVec3::X,
        DVec3::new(0.8, 1.0, 0.0),
        DVec3::new(0.0, -0.3, 1.0),
    );
    let instances = vec![
        place(0, DMat3::IDENTITY, DVec3::ZERO),
        place(
            0,
            turn(0.4, 1.0) * scale(0.2, 1.5, 0.7),
            DVec3::new(2.5, 0.0, 0.0),
        ),
        place(0, scale(-1.0, 1.0, 1.0), DVec3::new(-2.5, 0.5, 0.0)),
        // At the place of the first: all hits tie, and the lesser instance must win.
        place(0, DMat3::IDENTITY, DVec3::ZERO),
        place(0, scale(1.0, 0.0, 1.0), DVec3::new(0.0, -1.5, 0.0)),
        place(
            0,
            turn(2.0, 0.1) * shear * scale(1e-3, 1e-3, 1e-3),
            DVec3::new(0.0, 2.0, 0.0),
        ),
        place(0, scale(1e4, 1e-2, 1.0), DVec3::new(0.0, -3.0, 0.0)),
        place(1, scale(8.0, 1.0, 8.0), DVec3::new(0.0, -2.0, 0.0)),
    ];
    Scene {
        meshes: vec![ball(9, 14), grid(16)],
        instances,
        ..Scene::default()
    }
}

/// The corners of all triangles, in world space.
fn corners(scene: &Scene) -> Vec<Vec3> {
    let placed = |i: &Instance| {
        let mesh = &scene.meshes[i.mesh as usize];
        mesh.triangles
            .iter()
            .flatten()
            .map(|&v| i.world_point(mesh.positions[v as usize]))
            .collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(placed).collect()
}

/// Rays of every kind at a scene: at random, at vertices, edges, along axes with both zeros, from afar, with bounds on hits.
fn rays(scene: &Scene, random: &mut Random, count: usize) -> Vec<Ray> {
    let bounds = scene.bounds();
    let (center, radius) = (bounds.center(), bounds.diagonal() * 0.5);
    let vertices = corners(scene);
    let mut rays = Vec::new();
    for i in 0..count {
        let target = match i % 4 {
            0 => center + random.vector() * radius,
            1 => random.pick(&vertices),
            _ => {
                let corner = 3 * random.integer(0, vertices.len() as i64 / 3 - 1) as usize;
                vertices[corner].lerp(vertices[corner + 1], random.unit() as f32)
            }
        };
        let distance = random.pick(&[0.0, 0.5, 3.0, 100.0, 1e6]);
        let origin = center + random.vector() * radius * distance;
        let speed = random.pick(&[1.0, 1.0, 1e-3, 1e6]);
        let direction = match random.integer(0, 5) {
            0 => {
                let axis = random.pick(&Vec3::AXES) * random.pick(&[1.0, -1.0]);
                rays.push(Ray::new(
                    target - axis * radius * distance.min(100.0),
                    axis * speed,
                ));
                -axis
            }
            1 => (target - origin) * Vec3::new(1.0, 1.0, 0.0),
            _ => (target - origin) * speed,
        };
        rays.push(Ray::new(origin, direction));
        // Starting on the target itself, and ending there.
        rays.push(Ray::new(target, random.vector()));
        rays.push(Ray::new(origin, target - origin).within(Interval::new(0.0, 1.0)));
        rays.push(Ray::new(origin, target - origin).within(Interval::new(-2.0, f32::INFINITY)));
    }
    rays
}

struct Judged {
    hits: usize,
}

fn check(name: &str, scene: &Scene, rays: &[Ray]) -> Judged {
    let linear = AcceleratorKind::Linear.build(scene);
    let truth: Vec<Option<Hit>> = rays.iter().map(|r| linear.closest_hit(r)).collect();
    for (kind, accelerator) in all(scene) {
        for (ray, want) in rays.iter().zip(&truth) {
            one_ray(&*accelerator, ray, *want, &format!("{name}, {kind}"));
        }
        many_rays(&*accelerator, rays, &truth, &format!("{name}, {kind}"));
        if kind == "linear" {
            continue;
        }
        // Groups of rays that go the same way, and what remains of one.
        let part = rays.len().min(16);
        let repeated: Vec<Ray> = rays[..part].iter().flat_map(|&r| [r; 70]).collect();
        let wanted: Vec<Option<Hit>> = truth[..part].iter().flat_map(|&h| [h; 70]).collect();
        many_rays(
            &*accelerator,
            &repeated,
            &wanted,
            &format!("{name}, {kind}, repeated"),
        );
    }
    Judged {
        hits: truth.iter().flatten().count(),
    }
}

/// What waits for rays to build what they reach.
fn waiting() -> BuildOptions {
    BuildOptions {
        time: BuildTime::Reached,
        ..BuildOptions::default()
    }
}

/// The kinds that can.
const LAZY: [AcceleratorKind; 3] = [
    AcceleratorKind::Bsp,
    AcceleratorKind::Bvh2,
    AcceleratorKind::Cwbvh,
];

/// Every kind, built at once, and built as rays come where that makes a difference.
fn all(scene: &Scene) -> impl Iterator<Item = (String, Box<dyn Accelerator>)> + '_ {
    let whole = AcceleratorKind::ALL.into_iter();
    let whole = whole.map(|kind| (kind.to_string(), kind.build(scene)));
    let lazy = LAZY.into_iter();
    let lazy = lazy.map(|kind| (format!("lazy {kind}"), kind.build_with(scene, &waiting())));
    whole.chain(lazy)
}

fn many_rays(accelerator: &dyn Accelerator, rays: &[Ray], want: &[Option<Hit>], context: &str) {
    let bits = |h: Option<Hit>| h.map(|h| (h.t.to_bits(), h.instance, h.triangle));
    let mut hits = vec![None; rays.len()];
    accelerator.closest_hits(rays, &mut hits);
    let mut flags = vec![false; rays.len()];
    accelerator.any_hits(rays, &mut flags);
    for (i, ray) in rays.iter().enumerate() {
        assert_eq!(
            bits(hits[i]),
            bits(want[i]),
            "{context}: ray {i} of many: {ray:?}"
        );
        assert_eq!(
            flags[i],
            want[i].is_some(),
            "{context}: ray {i} of many, any hit: {ray:?}"
        );
    }
}

fn one_ray(accelerator: &dyn Accelerator, ray: &Ray, want: Option<Hit>, context: &str) {
    let got = accelerator.closest_hit(ray);
    let bits = |h: Option<Hit>| h.map(|h| (h.t.to_bits(), h.instance, h.triangle));
    assert_eq!(
        bits(got),
        bits(want),
        "{context}: {ray:?}: {got:?}, linear {want:?}"
    );
    assert_eq!(
        accelerator.any_hit(ray),
        want.is_some(),
        "{context}: any hit of {ray:?}"
    );
    let mut counters = TraceCounters::default();
    assert_eq!(
        bits(accelerator.closest_hit_counted(ray, &mut counters)),
        bits(want),
        "{context}: counted"
    );
    assert_eq!(
        accelerator.any_hit_counted(ray, &mut counters),
        want.is_some(),
        "{context}: any hit, counted"
    );
    if let Some(hit) = want {
        assert!(
            ray.interval.contains(hit.t),
            "{context}: {hit:?} outside of {ray:?}"
        );
        // The ends of the interval belong to it.
        let at = ray.within(Interval::new(hit.t, hit.t));
        assert_eq!(
            bits(accelerator.closest_hit(&at)),
            bits(want),
            "{context}: {at:?}"
        );
        assert!(accelerator.any_hit(&at), "{context}: {at:?}");
    }
}

#[test]
fn a_ball_at_every_scale_and_distance() {
    let mut random = Random::new(1, 0);
    for scale in [1e-12, 1e-5, 1.0, 1e5, 1e12] {
        for offset in [0.0, 1e4] {
            let scene = lone(ball(12, 20), scale, scale * offset);
            let judged = check(
                &format!("scale {scale} offset {offset}"),
                &scene,
                &rays(&scene, &mut random, 150),
            );
            assert!(judged.hits > 300, "{}", judged.hits);
        }
    }
}

#[test]
fn a_flat_grid_met_on_its_edges() {
    let mut random = Random::new(2, 0);
    let scene = lone(grid(24), 3.0, 0.0);
    assert!(check("grid", &scene, &rays(&scene, &mut random, 600)).hits > 600);
    // Down every vertex and along the plane itself.
    let down: Vec<_> = corners(&scene)
        .into_iter()
        .map(|v| Ray::new(v + Vec3::Y, -Vec3::Y))
        .collect();
    assert_eq!(check("grid from above", &scene, &down).hits, down.len());
    let along: Vec<_> = corners(&scene)
        .into_iter()
        .map(|v| Ray::new(v.with_x(-9.0), Vec3::X))
        .collect();
    assert_eq!(check("grid along", &scene, &along).hits, 0);
}

#[test]
fn slivers_and_fans_through_one_point() {
    let mut random = Random::new(3, 0);
    for seed in 0..4 {
        let scene = lone(slivers(&mut Random::new(seed, 0), 300), 1.0, 0.0);
        assert!(check("slivers", &scene, &rays(&scene, &mut random, 300)).hits > 100);
    }
}

#[test]
fn instances_under_every_kind_of_placement() {
    let mut random = Random::new(4, 0);
    let scene = instances();
    let judged = check("instances", &scene, &rays(&scene, &mut random, 2000));
    assert!(judged.hits > 3000, "{}", judged.hits);
}

#[test]
fn thousands_of_coincident_triangles() {
    // obvhs alone builds a chain of them, and overflows its stack at 100,000.
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let mut triangles = vec![[0, 1, 2]; 100_000];
    triangles.push([0, 1, 3]);
    let scene = lone(mesh(positions, triangles), 1.0, 0.0);
    let ray = Ray::new(Vec3::new(0.2, 0.2, 3.0), Vec3::NEG_Z);
    for (kind, accelerator) in all(&scene) {
        let hit = accelerator.closest_hit(&ray);
        assert_eq!(
            hit,
            Some(Hit {
                t: 3.0,
                instance: 0,
                triangle: 0
            }),
            "{kind}"
        );
    }
}

#[test]
fn triangles_around_one_point() {
    // One centre for all boxes: what a builder that sorts by centres cannot tell apart.
    let mut positions = Vec::new();
    for i in 0..20_000 {
        let size = 1.0 + i as f32 * 1e-4;
        positions.extend([
            Vec3::new(-size, -size, 0.0),
            Vec3::new(size, -size, 0.0),
            Vec3::new(0.0, size, 0.0),
        ]);
    }
    let triangles = (0..20_000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let scene = lone(mesh(positions, triangles), 1.0, 0.0);
    let mut random = Random::new(5, 0);
    assert!(check("one point", &scene, &rays(&scene, &mut random, 12)).hits > 10);
}

#[test]
fn rows_ribbons_and_fans_of_equal_triangles() {
    // With boxes as they are, obvhs takes quadratic time for each of them: minutes at this size.
    const COUNT: u32 = 50_000;
    let along = |i: u32| i as f32;
    let row = (0..COUNT)
        .flat_map(|i| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[y, z]| Vec3::new(along(i), y, z)));
    let row = mesh(
        row.collect(),
        (0..COUNT).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    );
    let rails = (0..COUNT + 2)
        .map(|i| Vec3::new(along(i / 2), 0.0, (i % 2) as f32))
        .collect();
    let ribbon = mesh(rails, (0..COUNT).map(|i| [i, i + 1, i + 2]).collect());
    let rim = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(COUNT);
        glam::DVec3::new(libm::cos(angle), libm::sin(angle), 0.0).as_vec3()
    };
    let fan = std::iter::once(Vec3::ZERO)
        .chain((0..COUNT).map(rim))
        .collect();
    let fan = mesh(
        fan,
        (0..COUNT)
            .map(|i| [0, 1 + i, 1 + (i + 1) % COUNT])
            .collect(),
    );
    for (name, mesh) in [("row", row), ("ribbon", ribbon), ("fan", fan)] {
        let scene = lone(mesh, 1.0, 0.0);
        let mut random = Random::new(7, 0);
        assert!(
            check(name, &scene, &rays(&scene, &mut random, 8)).hits > 5,
            "{name}"
        );
    }
}

#[test]
fn a_ray_continues_behind_a_hit_in_the_order_of_names() {
    // Three equal triangles in one place, then one behind them.
    let positions = vec![
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::NEG_Z,
        Vec3::new(1.0, 0.0, -1.0),
        Vec3::new(0.0, 1.0, -1.0),
    ];
    let scene = lone(
        mesh(positions, vec![[0, 1, 2], [0, 1, 2], [3, 4, 5], [1, 2, 0]]),
        1.0,
        0.0,
    );
    for (kind, accelerator) in all(&scene) {
        let mut ray = Ray::new(Vec3::new(0.2, 0.3, 1.0), Vec3::NEG_Z);
        let mut met = Vec::new();
        while let Some(hit) = accelerator.closest_hit(&ray) {
            met.push((hit.t, hit.triangle));
            ray = ray.behind(hit.t, (hit.instance, hit.triangle));
            let is_last = met.len() == 4;
            assert_eq!(accelerator.any_hit(&ray), !is_last, "{kind}: {met:?}");
        }
        assert_eq!(met, [(1.0, 0), (1.0, 1), (1.0, 3), (2.0, 2)], "{kind}");
    }
}

#[test]
fn nothing_is_hit_in_an_empty_scene_or_by_a_broken_ray() {
    let empty = Scene::default();
    let ball = lone(ball(4, 6), 1.0, 0.0);
    let nan = f32::NAN;
    let broken = [
        Ray::new(Vec3::splat(nan), Vec3::X),
        Ray::new(Vec3::ZERO, Vec3::new(1.0, nan, 0.0)),
        Ray::new(Vec3::ZERO, Vec3::ZERO),
        Ray::new(Vec3::ZERO, Vec3::new(-0.0, 0.0, -0.0)),
        Ray::new(Vec3::ZERO, Vec3::INFINITY),
        Ray::new(Vec3::ZERO, Vec3::X).within(Interval::new(nan, nan)),
        Ray::new(Vec3::ZERO, Vec3::X).within(Interval::new(5.0, 4.0)),
    ];
    for ((_, empty), (_, ball)) in all(&empty).zip(all(&ball)) {
        assert!(ball.closest_hit(&Ray::new(Vec3::ZERO, Vec3::X)).is_some());
        one_ray(&*empty, &Ray::new(Vec3::ZERO, Vec3::X), None, "empty");
        for ray in &broken {
            one_ray(&*ball, ray, None, "broken ray");
        }
    }
}

#[test]
fn linear_is_what_exact_arithmetic_says() {
    let mut random = Random::new(6, 0);
    let scene = instances();
    let spaces = TestSpaces::of(&scene);
    let linear = AcceleratorKind::Linear.build(&scene);
    let mut hits = 0;
    for ray in rays(&scene, &mut random, 60) {
        let mut best: Option<Hit> = None;
        for (instance, placed) in scene.instances.iter().enumerate() {
            let instance = instance as u32;
            for triangle in 0..scene.meshes[placed.mesh as usize].triangles.len() as u32 {
                let (ray, corners) = spaces.test(&scene, &ray, instance, triangle);
                if !ray.is_traceable() {
                    continue;
                }
                let Some(depth) = exact::depth(&ray, &corners) else {
                    continue;
                };
                let t = depth.to_f32();
                if ray.interval.contains(t) && t.is_finite() && best.is_none_or(|b| t < b.t) {
                    best = Some(Hit {
                        t,
                        instance,
                        triangle,
                    });
                }
            }
        }
        hits += usize::from(best.is_some());
        assert_eq!(linear.closest_hit(&ray), best, "{ray:?}");
    }
    assert!(hits > 60, "{hits}");
}

/// A ball with a hundred times the triangles that a tree's parts have, a shared one beside it four times, and rays from all sides.
fn race() -> (Scene, Vec<Ray>) {
    let (many, shared) = (ball(390, 400), ball(50, 60));
    let aside = |x| place(1, DMat3::IDENTITY, DVec3::new(x, 0.0, 0.0));
    let scene = Scene {
        meshes: vec![many, shared],
        instances: vec![
            place(0, DMat3::IDENTITY, DVec3::ZERO),
            aside(2.5),
            aside(-2.5),
            aside(5.0),
            aside(-5.0),
        ],
        ..Scene::default()
    };
    let mut random = Random::new(8, 0);
    let rays = (0..4096).map(|_| {
        let from = 8.0 * random.vector();
        Ray::new(from, 3.0 * random.vector() - from)
    });
    let rays = rays.collect();
    (scene, rays)
}

#[test]
fn threads_that_race_for_what_is_not_built_get_the_same_answers() {
    let (scene, rays) = race();
    let eager = AcceleratorKind::Bsp.build(&scene);
    let truth: Vec<Option<Hit>> = rays.iter().map(|r| eager.closest_hit(r)).collect();
    assert!(truth.iter().flatten().count() > 1000);
    // By threads of their own, and by workers of a pool, which take up each other's work while they wait.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(4)
        .build()
        .unwrap();
    for kind in LAZY {
        for turn in 0..4 {
            let accelerator = kind.build_with(&scene, &waiting());
            let before = accelerator.build_stats();
            assert!(before.unbuilt_triangles > 0, "{kind}");
            let task = |thread: usize| {
                let context = format!("lazy {kind}, thread {thread}");
                // All begin with the same rays, then go their own ways.
                let (same, own) = rays.split_at(64);
                let starts = (own.len() * thread / 8, truth.len());
                let (rays, truth) = (
                    [same, &own[starts.0..], &own[..starts.0]].concat(),
                    [
                        &truth[..64],
                        &truth[64 + starts.0..],
                        &truth[64..64 + starts.0],
                    ]
                    .concat(),
                );
                match turn % 2 {
                    0 => many_rays(&*accelerator, &rays, &truth, &context),
                    _ => {
                        for (ray, want) in rays.iter().zip(&truth).take(1500) {
                            one_ray(&*accelerator, ray, *want, &context);
                        }
                    }
                }
            };
            if turn < 2 {
                std::thread::scope(|scope| {
                    for thread in 0..8 {
                        scope.spawn(move || task(thread));
                    }
                });
            } else {
                pool.install(|| (0..8).into_par_iter().for_each(task));
            }
            let after = accelerator.build_stats();
            assert!(after.unbuilt_triangles < before.unbuilt_triangles, "{kind}");
            assert_eq!(after.triangles, eager.build_stats().triangles);
        }
    }
}

#[test]
fn what_is_built_does_not_depend_on_who_comes_first() {
    let (scene, rays) = race();
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let accelerator = AcceleratorKind::Bsp.build_with(&scene, &waiting());
        pool.install(|| {
            rays.par_iter().for_each(|ray| {
                accelerator.closest_hit(ray);
            })
        });
        let mut counters = TraceCounters::default();
        for ray in &rays {
            accelerator.closest_hit_counted(ray, &mut counters);
        }
        (accelerator.build_stats(), counters)
    };
    assert_eq!(build(1), build(4));
}

#[test]
fn meshes_that_no_ray_enters_are_not_built() {
    let (scene, _) = race();
    let left = Ray::new(Vec3::new(-9.0, 0.1, 0.1), Vec3::Y);
    let right = Ray::new(Vec3::new(2.6, 0.1, 3.0), Vec3::NEG_Z);
    for kind in LAZY {
        let accelerator = kind.build_with(&scene, &waiting());
        let unbuilt = || accelerator.build_stats().unbuilt_triangles;
        let before = unbuilt();
        assert!(!accelerator.any_hit(&left) && before >= 6000);
        assert_eq!(unbuilt(), before, "{kind}");
        assert!(accelerator.any_hit(&right));
        assert!(unbuilt() < before, "{kind}");
    }
}
