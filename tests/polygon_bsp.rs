//! The polygon BSP: the lecture's examples with their expected trees and orders, concave polygons, hostile input, and every order's tree checked.

#[path = "support/random.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod random;
#[path = "support/soup.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod soup;

use bspray::accel::bsp::polygon::{PolygonBsp, SceneTrees};
use bspray::accel::{AcceleratorKind, BspOrder, BuildOptions};
use bspray::geometry::{Ray, Triangle};
use bspray::scene::{Instance, Outline, Part, Scene, TriangleMesh};
use glam::{DAffine3, DVec3, Vec3};
use random::Random;
use soup::{scene_of, tangle};

fn options(order: BspOrder, merges_coplanar: bool) -> BuildOptions {
    BuildOptions {
        order,
        merges_coplanar,
        ..BuildOptions::default()
    }
}

/// A quad of two triangles.
fn quad([a, b, c, d]: [Vec3; 4]) -> [Triangle; 2] {
    [Triangle::new(a, b, c), Triangle::new(a, c, d)]
}

/// A model of this repository.
fn model(name: &str) -> Scene {
    let path = format!("{}/models/{name}.obj", env!("CARGO_MANIFEST_DIR"));
    bspray::import::load(&[path.into()]).expect("a model of this repository")
}

#[test]
fn eleven_edges_make_the_tree_of_the_lecture() {
    let trees = SceneTrees::build(&model("lecture-edges"), &options(BspOrder::File, false));
    let tree = &trees.trees()[0].bsp;
    tree.validate().unwrap();
    let lines: Vec<String> = tree.to_string().lines().map(str::to_owned).collect();
    let expected = [
        "1",
        "  back 2",
        "    back 3",
        "      back 4",
        "  front 5",
        "    back 6",
        "      back 7",
        "        front 9a",
        "          back 10",
        "    front 8",
        "      back 9b",
        "        back 11",
    ];
    assert_eq!(lines, expected);
    let dot = tree.to_dot();
    assert!(dot.contains("label=\"9a\"") && dot.matches("->").count() == 11);
}

#[test]
fn the_block_is_seen_in_the_orders_of_the_lecture() {
    let trees = SceneTrees::build(&model("lecture-block"), &options(BspOrder::File, false));
    let tree = &trees.trees()[0].bsp;
    tree.validate().unwrap();
    let stats = tree.stats();
    assert_eq!((stats.polygons, stats.fragments, stats.splits), (8, 10, 2));
    let seen = |eye: DVec3| {
        let order = tree.front_to_back(eye);
        let names = |is_wanted: &dyn Fn(bool) -> bool| {
            order
                .iter()
                .filter(|s| is_wanted(s.faces_away))
                .map(|s| tree.name(s.fragment))
                .collect::<Vec<_>>()
                .join(" ")
        };
        let mut reverse = tree.back_to_front(eye);
        reverse.reverse();
        assert_eq!(order, reverse);
        (names(&|_| true), names(&|away| away))
    };
    assert_eq!(
        seen(DVec3::new(0.5, 3.0, 2.0)),
        (
            "1 7b 8b 4 3 7a 8a 6 5 2".to_owned(),
            "8b 4 8a 6 5 2".to_owned()
        )
    );
    assert_eq!(
        seen(DVec3::new(3.0, 3.0, -1.0)),
        ("1 4 8b 7b 3 5 8a 7a 6 2".to_owned(), "7b 7a 6 2".to_owned())
    );
}

#[test]
fn every_order_makes_a_right_tree_of_a_tangle() {
    for seed in 0..3 {
        let triangles = tangle(&mut Random::new(seed, 0), 60);
        for order in BspOrder::ALL {
            for merges in [false, true] {
                let tree = PolygonBsp::build(triangles.clone(), &[], &options(order, merges));
                tree.validate()
                    .unwrap_or_else(|fault| panic!("{order}, seed {seed}: {fault}"));
                let stats = tree.stats();
                assert_eq!(stats.unsplit, 0);
                assert_eq!(stats.fragments, stats.polygons + stats.splits);
                assert_eq!(stats.triangles + stats.left_out, 60);
            }
        }
    }
}

/// A plate in the plane z = 0 of unit cells, and walls that stand on it.
fn plate(cells: &[[i32; 2]]) -> Vec<Triangle> {
    let at = |x: i32, y: i32| Vec3::new(x as f32, y as f32, 0.0);
    cells
        .iter()
        .flat_map(|&[x, y]| quad([at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]))
        .collect()
}

#[test]
fn a_comb_and_a_frame_are_cut_without_spikes() {
    // Teeth that end in the cut's plane, y = 1; and a ring with a hole.
    let comb: Vec<[i32; 2]> = (0..7)
        .map(|x| [x, 0])
        .chain((0..4).flat_map(|i| [[2 * i, 1], [2 * i, 2]]))
        .collect();
    let ring: Vec<[i32; 2]> = (0..25)
        .map(|i| [i % 5, i / 5])
        .filter(|[x, y]| !(1..4).contains(x) || !(1..4).contains(y))
        .collect();
    for (cells, corners) in [(comb, 16), (ring, 8)] {
        let area = cells.len() as f64;
        for cut_at in [1.0, 1.5, 2.0, 2.7] {
            for turn in [0, 1] {
                let mut triangles = plate(&cells);
                let wall = |s: f32, z: f32| match turn {
                    0 => Vec3::new(s, cut_at, z),
                    _ => Vec3::new(cut_at, s, z),
                };
                // First in the order: it cuts.
                triangles.insert(
                    0,
                    Triangle::new(wall(0.0, 1.0), wall(9.0, 1.0), wall(0.0, 9.0)),
                );
                let tree = PolygonBsp::build(triangles, &[], &options(BspOrder::File, true));
                tree.validate().unwrap();
                assert_eq!(tree.polygons().len(), 2);
                let plate = &tree.polygons()[1];
                assert_eq!(plate.loops.iter().map(Vec::len).sum::<usize>(), corners);
                let sum: f64 = tree.fragments()[1..].iter().map(|f| f.area()).sum();
                assert!((sum - area).abs() < 1e-9, "{sum} of {area}");
                for fragment in &tree.fragments()[1..] {
                    for corners in &fragment.loops {
                        // A spike would be a corner between two edges of opposite directions; a repeated corner one of no length.
                        for i in 0..corners.len() {
                            let [a, b, c] =
                                [0, 1, 2].map(|k| corners[(i + k) % corners.len()].position.point);
                            let (there, on) = (b - a, c - b);
                            assert!(there.length() > 0.0);
                            let is_back = there.cross(on) == DVec3::ZERO && there.dot(on) < 0.0;
                            assert!(!is_back, "a spike at {b}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn teeth_behind_a_cut_are_one_fragment_of_several_loops() {
    let mut triangles = plate(&[[0, 0], [1, 0], [2, 0], [0, 1], [2, 1]]);
    let wall = |x, z| Vec3::new(x, 1.0, z);
    triangles.insert(
        0,
        Triangle::new(wall(0.0, 1.0), wall(9.0, 1.0), wall(0.0, 9.0)),
    );
    let tree = PolygonBsp::build(triangles, &[], &options(BspOrder::File, true));
    let mut loops: Vec<(usize, f64)> = tree.fragments()[1..]
        .iter()
        .map(|f| (f.loops.len(), f.area()))
        .collect();
    loops.sort_by(|a, b| a.1.total_cmp(&b.1));
    assert_eq!(loops, [(2, 2.0), (1, 3.0)]);
}

#[test]
fn flat_n_gons_enter_whole_and_bent_ones_as_triangles() {
    for (height, polygons) in [(0.0, 1), (0.1, 2)] {
        let mesh = TriangleMesh {
            positions: vec![
                Vec3::ZERO,
                Vec3::X,
                Vec3::new(1.0, 1.0, height),
                Vec3::new(0.0, 2.0, 0.0),
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 2,
                material: 0,
            }],
            outlines: vec![Outline {
                corners: Box::new([0, 1, 2, 3]),
                first_triangle: 0,
                triangle_count: 2,
            }],
            ..TriangleMesh::default()
        };
        let place = |x| Instance::new("", 0, DAffine3::from_translation(DVec3::X * x));
        let scene = Scene {
            meshes: vec![mesh],
            instances: vec![place(0.0), place(5.0)],
            ..Scene::default()
        };
        let trees = SceneTrees::build(&scene, &BuildOptions::default());
        assert_eq!(trees.trees().len(), 1);
        assert_eq!(trees.placements().len(), 2);
        assert_eq!(trees.trees()[0].bsp.polygons().len(), polygons);
    }
}

#[test]
fn coincident_and_back_to_back_polygons_are_kept_and_flat_ones_left_out() {
    let [a, b, c] = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let triangles = vec![
        Triangle::new(a, b, c),
        Triangle::new(a, b, c),
        Triangle::new(a, c, b),
        Triangle::new(a, b, b * 3.0),
    ];
    for merges in [false, true] {
        let tree = PolygonBsp::build(triangles.clone(), &[], &options(BspOrder::File, merges));
        tree.validate().unwrap();
        assert_eq!((tree.nodes().len(), tree.fragments().len()), (1, 3));
        assert_eq!(tree.left_out(), [3]);
        let above = tree.front_to_back(DVec3::new(0.2, 0.2, 1.0));
        let away: Vec<bool> = above.iter().map(|s| s.faces_away).collect();
        assert_eq!(away, [false, false, true]);
    }
}

#[test]
fn a_chain_of_five_thousand_is_built_by_insertion() {
    let at = |i: u32| {
        let z = i as f32;
        Triangle::new(
            Vec3::new(0.0, 0.0, z),
            Vec3::new(3.0, 0.0, z),
            Vec3::new(0.0, 2.0, z),
        )
    };
    let triangles: Vec<Triangle> = (0..5000).map(at).collect();
    let tree = PolygonBsp::build(triangles.clone(), &[], &options(BspOrder::File, false));
    assert_eq!(tree.stats().depth, 5000);
    assert_eq!(tree.to_string().lines().count(), 5000);
    let order = tree.front_to_back(DVec3::new(0.0, 0.0, 2000.5));
    assert_eq!(order[0].fragment, 2001);
    let scene = scene_of(&triangles);
    let ray = Ray::new(Vec3::new(0.5, 0.5, 9000.0), Vec3::NEG_Z);
    let deep = AcceleratorKind::BspPolygon.build_with(&scene, &options(BspOrder::File, false));
    let flat = AcceleratorKind::BspPolygon.build_with(&scene, &options(BspOrder::Balanced, false));
    assert_eq!(deep.closest_hit(&ray).map(|h| h.triangle), Some(4999));
    assert_eq!(flat.closest_hit(&ray).map(|h| h.triangle), Some(4999));
    assert!(
        flat.build_stats().depth < 40,
        "{}",
        flat.build_stats().depth
    );
}

#[test]
fn hostile_polygons_end_in_undivided_cells() {
    // Each splits all others: cubic without a limit.
    let mut random = Random::new(9, 0);
    let triangles: Vec<Triangle> = (0..700)
        .map(|_| {
            let [a, b] = [random.vector(), random.vector()];
            Triangle::new(a * 9.0, b * 9.0, (a + b) * -9.0)
        })
        .collect();
    let tree = PolygonBsp::build(triangles.clone(), &[], &options(BspOrder::Random, false));
    let stats = tree.stats();
    assert!(stats.unsplit > 0, "{stats:?}");
    let scene = scene_of(&triangles);
    let linear = AcceleratorKind::Linear.build(&scene);
    let polygon = AcceleratorKind::BspPolygon.build_with(&scene, &options(BspOrder::Random, false));
    for _ in 0..300 {
        let ray = Ray::new(random.vector() * 5.0, random.vector());
        assert_eq!(polygon.closest_hit(&ray), linear.closest_hit(&ray));
        assert_eq!(polygon.any_hit(&ray), linear.any_hit(&ray));
    }
}

#[test]
fn every_order_answers_as_linear_does() {
    let mut random = Random::new(12, 0);
    let triangles = tangle(&mut random, 150);
    let scene = scene_of(&triangles);
    let linear = AcceleratorKind::Linear.build(&scene);
    for order in BspOrder::ALL {
        for merges in [false, true] {
            let tree = AcceleratorKind::BspPolygon.build_with(&scene, &options(order, merges));
            for i in 0..400 {
                let start = Vec3::from_array([0; 3].map(|_| random.integer(-3, 8) as f32));
                let end = Vec3::from_array([0; 3].map(|_| random.integer(-3, 8) as f32));
                let offset = if i % 2 == 0 {
                    Vec3::ZERO
                } else {
                    random.vector()
                };
                let ray = Ray::new(start + offset, end - start);
                assert_eq!(
                    tree.closest_hit(&ray),
                    linear.closest_hit(&ray),
                    "{order}: {ray:?}"
                );
            }
        }
    }
}
