//! Polygons to triangles: each is covered, in bounded time.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::time::{Duration, Instant};

use bspray::scene::{DefectCause, Scene};

use crate::setup::*;

#[test]
fn faces_with_too_few_corners_are_defects() {
    let scene = load(format!(
        "{V}o A\nf 1 2 3\nf 1 1 2\nf 1 2\nf 1\nf 1 2 2 1\no B\nf 1 2 3\n"
    ))
    .unwrap();
    let [defect] = &scene.defects[..] else {
        panic!("{:?}", scene.defects)
    };
    assert_eq!(
        (defect.cause, defect.count, defect.first),
        (DefectCause::TooFewCorners, 4, 1)
    );
    assert_eq!(defect.element, "mesh \"A\" (line 7)");
    assert_eq!(scene.placed_triangles(), 2);
}

#[test]
fn concave_polygons_are_not_fanned() {
    let scene = load_model("concave.obj").unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(
        (
            mesh.triangles.len(),
            mesh.outlines.len(),
            mesh.outlines[0].corners.len()
        ),
        (6, 1, 8)
    );
    assert!((area(mesh) - 7.0).abs() < 1e-5);
}

#[test]
fn long_polygons_are_read() {
    // A circle of 20,000 corners and a star with as many: no time that grows with the square.
    for inner in [1.0, 0.25] {
        let corners = 20_000;
        let mut text = String::new();
        for i in 0..corners {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(corners);
            let radius = if i % 2 == 0 { 100.0 } else { 100.0 * inner };
            text += &format!(
                "v {} {} 5\n",
                radius * libm::cos(angle),
                radius * libm::sin(angle)
            );
        }
        text += "f";
        (1..=corners).for_each(|i| text += &format!(" {i}"));
        let scene = load(text).unwrap();
        assert_eq!(scene.placed_triangles(), corners as u64 - 2);
    }
}

/// A polygon of any corners, in a plane that is no axis's.
fn tilted(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for [x, y] in points {
        writeln!(text, "v {} {} {}", x - 0.5 * y, 2.0 * y, 3.0 * x + y).unwrap();
    }
    text += "f";
    (1..=points.len()).for_each(|i| write!(text, " {i}").unwrap());
    text + "\n"
}

/// Whether the triangles of a [`tilted`] polygon cover it, with as many as there must be and no note.
fn is_covered(scene: &Scene, points: &[[f64; 2]]) -> bool {
    is_area_covered(scene, points)
        && scene.placed_triangles() == points.len() as u64 - 2
        && scene.notes.is_empty()
}

/// Whether the triangles of a [`tilted`] polygon have its area.
fn is_area_covered(scene: &Scene, points: &[[f64; 2]]) -> bool {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let around = points.iter().cycle().skip(1);
    let twice: f64 = points.iter().zip(around).map(|(&a, &b)| cross(a, b)).sum();
    // The plane's axes are (1, 0, 3) and (-1/2, 2, 1); the length of their product, (-6, -2.5, 2), is the scale of areas.
    let expected = twice.abs() / 2.0 * f64::sqrt(36.0 + 6.25 + 4.0);
    let mesh = &scene.meshes[0];
    let area = |t: u32| {
        let [a, b, c] = mesh.triangle(t).corners().map(|p| p.as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    };
    let covered: f64 = (0..mesh.triangles.len() as u32).map(area).sum();
    (covered - expected).abs() < 1e-4 * expected
}

#[test]
fn combs_of_100_000_corners_take_seconds_at_most() {
    // Ears alone take 14 s for a zigzag of 8,000 corners, and minutes for one of 32,000.
    let half = 50_000;
    let zigzag = |height: f64, top: f64| {
        (0..half).map(move |i| [f64::from(i), if i % 2 == 0 { top } else { height }])
    };
    let zigzag: Vec<[f64; 2]> = zigzag(0.0, 990.0)
        .chain(zigzag(10.0, 1000.0).rev())
        .collect();
    let teeth = (1..=2 * half)
        .rev()
        .map(|i| [f64::from(i), if i % 4 < 2 { 1000.0 } else { 0.0 }]);
    let comb: Vec<[f64; 2]> = [[0.0, -5.0], [f64::from(2 * half), -5.0]]
        .into_iter()
        .chain(teeth)
        .collect();
    for (name, points) in [("zigzag", zigzag), ("comb", comb)] {
        let text = tilted(&points);
        let start = Instant::now();
        let scene = load(text).unwrap();
        assert!(
            start.elapsed() < Duration::from_secs(20),
            "{name}: {:?}",
            start.elapsed()
        );
        assert_eq!(scene.defects, [], "{name}");
        assert!(is_covered(&scene, &points), "{name}: {:?}", notes(&scene));
    }
}

#[test]
fn triangles_are_made_less_thin_in_bounded_time() {
    // Between two curves that bend towards one another: each polygon would take 13 s.
    let half = 50_000;
    let curve = |sign: f64| {
        (-half / 2..half / 2).map(move |i| {
            let x = f64::from(i);
            [x, sign * (1.0 + x * x / 5e4)]
        })
    };
    let waist: Vec<[f64; 2]> = curve(-1.0).chain(curve(1.0).rev()).collect();
    let one = tilted(&waist);
    let (vertices, face) = one.split_at(one.find('f').unwrap());
    let text = format!("{vertices}{}", face.repeat(4));
    let start = Instant::now();
    let scene = load(text).unwrap();
    assert!(
        start.elapsed() < Duration::from_secs(30),
        "{:?}",
        start.elapsed()
    );
    // Corners are so near to lines that, rounded, some triangles have no area. All the area is there, four times.
    assert!(notes(&scene).is_empty(), "{:?}", notes(&scene));
    let two: Vec<[f64; 2]> = waist.iter().map(|p| p.map(|c| 2.0 * c)).collect();
    assert!(is_area_covered(&scene, &two));
}

#[test]
fn very_many_polygons_that_cross_themselves_take_bounded_time() {
    // Points of a small grid, at random: the worst that was found for ears.
    let mut state = 1_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        state >> 33
    };
    let mut text = String::new();
    (0..64).for_each(|i| writeln!(text, "v {} {} 0", i % 8, i / 8).unwrap());
    for _ in 0..200 {
        text += "f";
        (0..2000).for_each(|_| write!(text, " {}", random() % 64 + 1).unwrap());
        text += "\n";
    }
    let start = Instant::now();
    let scene = load(text).unwrap();
    assert!(
        start.elapsed() < Duration::from_secs(60),
        "{:?}",
        start.elapsed()
    );
    assert!(scene.placed_triangles() > 0);
    assert!(
        notes(&scene)[0].contains("cut as fans"),
        "{:?}",
        notes(&scene)
    );
}

/// A plate with `rows` times `rows` holes of `sides` sides. Those of a row are joined to one another and to the outline.
fn plate_with_holes(rows: u32, sides: u32) -> Vec<[f64; 2]> {
    let middle = |i: u32| f64::from(3 * i + 2);
    let hole = |column: u32, row: u32, turn: u32| {
        // The other way round than the outline, from the left.
        let angle = TAU * (0.5 - f64::from(turn % sides) / f64::from(sides));
        let radius = 0.7 + 0.1 * f64::from((column + 2 * row) % 4);
        [
            middle(column) + radius * libm::cos(angle),
            middle(row) + radius * libm::sin(angle),
        ]
    };
    let length = f64::from(3 * rows + 1);
    let mut points = vec![[0.0, 0.0], [length, 0.0], [length, length], [0.0, length]];
    for row in (0..rows).rev() {
        points.push([0.0, middle(row)]);
        // There above all holes, back below them.
        for column in 0..rows {
            points.extend((0..=sides / 2).map(|turn| hole(column, row, turn)));
        }
        for column in (0..rows).rev() {
            points.extend((sides / 2..=sides).map(|turn| hole(column, row, turn)));
        }
        points.push([0.0, middle(row)]);
    }
    // The hole at the end is entered and left at one corner.
    points.dedup();
    points
}

#[test]
fn holes_that_are_joined_to_the_outline_stay_open() {
    for sides in [4, 5, 8, 23] {
        for rows in [1, 2, 7] {
            let points = plate_with_holes(rows, sides);
            for turn in 0..12 {
                // Quarter turns are exact; of the others, corners as files have them.
                let (sin, cos) = match turn {
                    0 => (0.0, 1.0),
                    1 => (1.0, 0.0),
                    2 => (0.0, -1.0),
                    3 => (-1.0, 0.0),
                    _ => (libm::sin(f64::from(turn)), libm::cos(f64::from(turn))),
                };
                let points: Vec<[f64; 2]> = points
                    .iter()
                    .map(|&[x, y]| [x * cos - y * sin, x * sin + y * cos])
                    .collect();
                let scene = load(tilted(&points)).unwrap();
                assert!(
                    is_covered(&scene, &points),
                    "{rows}, {sides}, {turn}: {:?}",
                    notes(&scene)
                );
            }
        }
    }
}
