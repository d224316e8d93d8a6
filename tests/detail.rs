//! Meshes as coarse as pictures allow: within the budget by brute force, shared by instances alike, and left alone where they should be.

use std::collections::{HashMap, HashSet};
use std::f32::consts::{PI, TAU};

use bspray::geometry::Triangle;
use bspray::scene::{
    AlphaMode, Camera, CameraFrame, DetailOptions, DetailReport, Instance, Material, Part,
    Projection, Scene, Transmission, TriangleMesh,
};
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};

const SIZE: (u32, u32) = (400, 300);

/// A mesh of one part, without its vertices.
fn of_triangles(triangles: Vec<[u32; 3]>) -> TriangleMesh {
    TriangleMesh {
        parts: vec![Part {
            first_triangle: 0,
            triangle_count: triangles.len() as u32,
            material: 0,
        }],
        triangles,
        ..TriangleMesh::default()
    }
}

/// A wavy ball of radius about 1, 192 triangles around and 96 down, with normals and texture coordinates: 36,480 triangles.
fn ball() -> TriangleMesh {
    let (around, down) = (192_u32, 96_u32);
    let place = |i: u32, j: u32| {
        let (turn, tilt) = (TAU * i as f32 / around as f32, PI * j as f32 / down as f32);
        // At the poles all columns are one point.
        let level = if j.is_multiple_of(down) {
            0.0
        } else {
            libm::sinf(tilt)
        };
        let radius = 1.0
            + 0.1 * libm::sinf(3.0 * turn) * level * level * level
            + 0.05 * libm::cosf(5.0 * tilt);
        radius
            * Vec3::new(
                level * libm::cosf(turn),
                libm::cosf(tilt),
                level * libm::sinf(turn),
            )
            + Vec3::ZERO
    };
    let columns = around + 1;
    let grid = || (0..=down).flat_map(move |j| (0..columns).map(move |i| (i, j)));
    let corner = |i: u32, j: u32| j * columns + i;
    let cells = (0..down).flat_map(|j| (0..around).map(move |i| (i, j)));
    let quads = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [
            corner(i, j),
            corner(i + 1, j),
            corner(i + 1, j + 1),
            corner(i, j + 1),
        ];
        // At the poles one of the two has no area.
        let halves = [[a, b, c], [a, c, d]];
        let kept = [j > 0, j + 1 < down];
        halves.into_iter().zip(kept).filter(|h| h.1).map(|h| h.0)
    });
    let triangles: Vec<_> = quads.collect();
    TriangleMesh {
        positions: grid().map(|(i, j)| place(i % around, j)).collect(),
        normals: grid()
            .map(|(i, j)| place(i % around, j).normalize())
            .collect(),
        uv_sets: vec![
            grid()
                .map(|(i, j)| Vec2::new(i as f32 / around as f32, j as f32 / down as f32))
                .collect(),
        ],
        ..of_triangles(triangles)
    }
}

fn scene(mesh: TriangleMesh, placements: &[DAffine3], material: Material) -> Scene {
    Scene {
        meshes: vec![mesh],
        instances: placements
            .iter()
            .map(|p| Instance::new("", 0, *p))
            .collect(),
        materials: vec![material],
        ..Scene::default()
    }
}

/// From the origin along -z, 40 degrees high.
fn view() -> CameraFrame {
    let camera = Camera {
        name: String::new(),
        position: Vec3::ZERO,
        focal_point: Vec3::NEG_Z,
        view_up: Vec3::Y,
        projection: Projection::Perspective { view_angle: 40.0 },
    };
    camera.frame(SIZE.0, SIZE.1).expect("valid")
}

fn simplified(scene: Scene, budget: f64) -> (Scene, DetailReport) {
    let options = DetailOptions {
        views: vec![view()],
        size: SIZE,
        budget,
    };
    scene.simplified(&options)
}

fn at(distance: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(0.3, -0.2, -distance))
}

fn placed(scene: &Scene) -> Vec<Triangle> {
    let mesh = scene.mesh_of(0);
    let corner = |v: u32| scene.instances[0].world_point(mesh.positions[v as usize]);
    let triangle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(corner);
        Triangle::new(a, b, c)
    };
    mesh.triangles.iter().map(triangle).collect()
}

/// Greatest distance of the points from the nearest of the triangles.
fn farthest(points: impl Iterator<Item = Vec3>, surface: &[Triangle]) -> f64 {
    let distance = |p: Vec3| {
        let squared = surface.iter().map(|t| t.squared_distance(p.as_dvec3()));
        squared.fold(f64::INFINITY, f64::min)
    };
    points.map(distance).fold(0.0, f64::max).sqrt()
}

#[test]
fn no_point_is_farther_from_the_other_surface_than_the_budget() {
    let turn = DMat3::from_rotation_x(0.4) * DMat3::from_diagonal(DVec3::new(1.0, 1.5, 0.5));
    let placement = DAffine3::from_mat3_translation(turn, DVec3::new(0.5, 0.2, -30.0));
    let before = scene(ball(), &[placement], Material::default());
    let full = placed(&before);
    // A pixel's least width: 40 degrees in 300 rows, at the distance of what is nearest.
    let tan = libm::tan(20.0_f64.to_radians());
    let corner = 1.0 + tan * tan * (1.0 + 16.0 / 9.0);
    let nearest = full
        .iter()
        .map(|t| t.squared_distance(DVec3::ZERO))
        .fold(f64::INFINITY, f64::min)
        .sqrt();
    let pixel = nearest * 2.0 * tan / 300.0 / corner;
    let budget = 0.5;
    let (after, report) = simplified(before, budget);
    let coarse = placed(&after);
    println!("{} of {} triangles", coarse.len(), full.len());
    assert!(coarse.len() * 5 < full.len());
    assert_eq!(
        (report.triangles(), report.kept()),
        (full.len() as u64, coarse.len() as u64)
    );
    assert!(
        report.error() <= budget && report.error() > 0.1,
        "{}",
        report.error()
    );
    let vertices = full.iter().step_by(29).flat_map(|t| *t.corners());
    let from_vertices = farthest(vertices, &coarse);
    assert!(
        from_vertices <= report.error() * pixel * 1.000_001,
        "{from_vertices}"
    );
    // Points between the vertices, of either surface.
    let inner = |t: &Triangle| {
        let [a, b, c] = *t.corners();
        [
            (a + b + c) / 3.0,
            a.lerp(b, 0.5),
            b.lerp(c, 0.5),
            a.lerp(c, 0.4).lerp(b, 0.2),
        ]
    };
    let from_full = farthest(full.iter().step_by(61).flat_map(inner), &coarse);
    let from_coarse = farthest(coarse.iter().step_by(11).flat_map(inner), &full);
    println!(
        "{from_vertices} {from_full} {from_coarse} of {}",
        budget * pixel
    );
    assert!(from_full <= budget * pixel * 1.05, "{from_full}");
    assert!(from_coarse <= budget * pixel * 1.05, "{from_coarse}");
}

#[test]
fn instances_at_like_distances_share_a_level_and_near_ones_keep_the_mesh() {
    let distances = [1.6, 40.0, 41.0, 45.0, 300.0, 310.0, 9000.0];
    let placements = distances.map(at);
    let (scene, report) = simplified(scene(ball(), &placements, Material::default()), 0.5);
    let kept: Vec<u64> = report.instances.iter().map(|i| i.kept).collect();
    println!("{kept:?}");
    assert_eq!(kept[0], 36_480, "the eye is at its surface");
    let mesh = |i: usize| scene.instances[i].mesh;
    assert!(mesh(1) == mesh(2) && mesh(4) == mesh(5));
    assert!(kept.windows(2).all(|k| k[0] >= k[1]) && kept[6] < kept[4] && kept[4] < kept[1]);
    assert!(report.levels == scene.meshes.len() - 1 && scene.meshes.len() <= 5);
    assert!(
        report
            .instances
            .iter()
            .all(|i| i.error <= 0.5 && i.triangles == 36_480)
    );
    assert!(scene.meshes.iter().all(|m| m.validate().is_ok()));
}

/// A sheet of 300 by 300 cells of edge 1 at 1,000 before the eye, where pixels are 2.4 wide. Its vertices are put where `place` says, the eye in z.
fn sheet(place: impl Fn(f32, f32) -> Vec3) -> TriangleMesh {
    let side = 301_u32;
    let places = (0..side * side).map(|i| ((i % side) as f32 - 150.0, (i / side) as f32 - 150.0));
    let corners = (0..300 * 300_u32).map(|i| i % 300 + i / 300 * side);
    let triangles: Vec<_> = corners
        .flat_map(|v| [[v, v + 1, v + side], [v + 1, v + 1 + side, v + side]])
        .collect();
    TriangleMesh {
        positions: places
            .map(|(x, y)| place(x, y) - 1000.0 * Vec3::Z)
            .collect(),
        ..of_triangles(triangles)
    }
}

#[test]
fn no_part_of_a_surface_is_folded_over() {
    // Of cells that differ, vertices are chosen that lie in another order.
    let bumps = |x: f32, y: f32| {
        let off = |n: f32| 0.2 * libm::sinf(n * (x + 0.37 * y) * (y - 0.21 * x));
        let height = libm::sinf(x * 0.21) * libm::sinf(y * 0.17 + x * 0.05);
        Vec3::new(x + off(1.7), y + off(2.3), height)
    };
    let mesh = scene(sheet(bumps), &[DAffine3::IDENTITY], Material::default());
    let (after, report) = simplified(mesh, 0.5);
    assert!(report.kept() * 8 < report.triangles(), "{}", report.kept());
    for triangle in placed(&after) {
        let [a, b, c] = triangle.corners();
        let normal = (b - a).cross(c - a);
        // Of half the area of a pixel, no one sees which way it faces.
        assert!(
            normal.z > 0.0 || normal.length() < 1.2 * 1.2,
            "{triangle:?}"
        );
    }
}

#[test]
fn colours_stay_where_they_are() {
    let mut mesh = sheet(|x, y| Vec3::new(x, y, 0.0));
    let color = |p: &Vec3| Vec3::splat(if p.x < 20.5 { 0.0 } else { 1.0 }).extend(1.0);
    mesh.colors = mesh.positions.iter().map(color).collect();
    let mesh = scene(mesh, &[DAffine3::IDENTITY], Material::default());
    let (after, report) = simplified(mesh, 0.5);
    assert!(report.kept() * 10 < report.triangles(), "{}", report.kept());
    let mesh = after.mesh_of(0);
    let mut mixed = 0;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].x);
        let [least, most] = [a.min(b).min(c), a.max(b).max(c)];
        let bright = triangle.map(|v| mesh.colors[v as usize].x > 0.5);
        if bright.contains(&true) && bright.contains(&false) {
            mixed += 1;
            // Within half a pixel, on either side.
            assert!(19.0 <= least && most <= 22.0, "{least} to {most}");
        }
    }
    assert!(mixed > 100);
}

#[test]
fn any_number_of_threads_makes_the_same_meshes() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let scene = scene(ball(), &[20.0, 25.0, 90.0].map(at), Material::default());
        let (scene, report) = pool.expect("threads").install(|| simplified(scene, 0.7));
        let meshes = scene
            .meshes
            .into_iter()
            .map(|m| (m.positions, m.normals, m.triangles));
        (meshes.collect::<Vec<_>>(), report)
    };
    assert!(on(1) == on(3));
}

#[test]
fn what_shines_or_lets_light_pass_is_left_alone() {
    let glow = Material {
        emissive: Vec3::ONE,
        ..Material::default()
    };
    let leaf = Material {
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::default()
    };
    let pane = Material {
        transmission: Some(Transmission {
            factor: 0.5,
            texture: None,
        }),
        ..Material::default()
    };
    let kept = |material: Material| {
        let (_, report) = simplified(scene(ball(), &[at(50.0)], material), 1.0);
        report.kept()
    };
    for material in [glow.clone(), leaf, pane] {
        assert_eq!(kept(material), 36_480);
    }
    assert!(kept(Material::default()) < 9_000);
    // One of two parts.
    let mut mesh = ball();
    mesh.parts = [(0, 10_000, 0), (10_000, 26_480, 1)]
        .map(|(first_triangle, triangle_count, material)| Part {
            first_triangle,
            triangle_count,
            material,
        })
        .to_vec();
    let mut scene = scene(mesh, &[at(50.0)], Material::default());
    scene.materials.push(glow);
    let corners = |scene: &Scene, part: usize| -> Vec<Triangle> {
        let mesh = &scene.meshes[0];
        let Part {
            first_triangle,
            triangle_count,
            ..
        } = mesh.parts[part];
        (first_triangle..first_triangle + triangle_count)
            .map(|t| mesh.triangle(t))
            .collect()
    };
    let before = corners(&scene, 1);
    let (scene, _) = simplified(scene, 1.0);
    assert!(corners(&scene, 1) == before && corners(&scene, 0).len() < 3_000);
}

/// The edges of one triangle alone, by places.
fn border(mesh: &TriangleMesh) -> HashSet<[[u32; 3]; 2]> {
    let place = |v: u32| mesh.positions[v as usize].to_array().map(f32::to_bits);
    let mut uses: HashMap<[[u32; 3]; 2], u32> = HashMap::new();
    for t in &mesh.triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            let mut edge = [place(a), place(b)];
            edge.sort_unstable();
            *uses.entry(edge).or_default() += 1;
        }
    }
    uses.into_iter()
        .filter(|(_, n)| *n == 1)
        .map(|(edge, _)| edge)
        .collect()
}

#[test]
fn borders_and_seams_hold() {
    // Half of the ball: an open bowl, whose seam of texture coordinates runs down its side.
    let mut bowl = ball();
    bowl.triangles.drain(..18_240);
    bowl.parts[0].triangle_count = 18_240;
    let before = border(&bowl);
    assert_eq!(before.len(), 192);
    let (scene, report) = simplified(scene(bowl, &[at(60.0)], Material::default()), 1.0);
    assert!(report.kept() < 6_000, "{}", report.kept());
    // No crack has opened along the seam, whose two sides have vertices of their own.
    assert!(border(&scene.meshes[0]) == before);
}

#[test]
fn an_eye_on_the_surface_and_an_empty_scene_change_nothing() {
    let scene = scene(ball(), &[at(0.9)], Material::default());
    let (scene, report) = simplified(scene, 0.5);
    assert_eq!((report.levels, report.error()), (0, 0.0));
    assert_eq!(scene.meshes[0].triangles.len(), 36_480);
    let (scene, report) = simplified(Scene::default(), 0.5);
    assert_eq!((scene.meshes.len(), report.instances.len()), (0, 0));
}
