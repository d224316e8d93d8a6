//! The contract of accelerators, over every kind in the registry: what `linear` answers, all answer, bit for bit.

#[path = "support/random.rs"]
mod random;

use bspray::accel::{Accelerator, AcceleratorKind, Hit, TestSpaces, TraceCounters};
use bspray::geometry::{Interval, Ray, exact};
use bspray::scene::{Instance, Part, Scene, TriangleMesh};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use random::Random;

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
    for kind in AcceleratorKind::ALL {
        let accelerator = kind.build(scene);
        for (ray, want) in rays.iter().zip(&truth) {
            one_ray(&*accelerator, ray, *want, &format!("{name}, {kind}"));
        }
        many_rays(&*accelerator, rays, &truth, &format!("{name}, {kind}"));
        if kind == AcceleratorKind::Linear {
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
    for kind in AcceleratorKind::ALL {
        let hit = kind.build(&scene).closest_hit(&ray);
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
    for kind in AcceleratorKind::ALL {
        let accelerator = kind.build(&scene);
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
    for kind in AcceleratorKind::ALL {
        let (empty, ball) = (kind.build(&empty), kind.build(&ball));
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
