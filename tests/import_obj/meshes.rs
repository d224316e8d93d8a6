//! Vertices with what they carry, and the meshes that objects become.

use bspray::scene::{DefectCause, TriangleMesh};
use glam::{Vec2, Vec3, Vec4};

use crate::setup::*;

#[test]
fn corners_with_and_without_texture_coordinates_stay_aligned() {
    // tobj gives shorter lists without a word, and the coordinates slide to other vertices.
    let faces = [
        "f 1 2 3\nf 1/1 3/2 4/3\n",
        "f 1/1 3/2 4/3\nf 1//1 2//1 3//1\n",
        "f 1/1//1 2 3\nf 1/1 3/2 4/3/1\n",
    ];
    for faces in faces {
        let scene = load(format!(
            "{V}vt 0.1 0.2\nvt 0.3 0.4\nvt 0.5 0.6\nvn 0 0 2\n{faces}"
        ))
        .unwrap();
        let mesh = &scene.meshes[0];
        let uvs = &mesh.uv_sets[0];
        let [a, b, c] = *mesh
            .triangles
            .iter()
            .find(|t| {
                let corners = t.map(|v| mesh.positions[v as usize]);
                corners.contains(&Vec3::new(0.0, 1.0, 0.0))
            })
            .unwrap();
        let found = [a, b, c].map(|v| uvs[v as usize]);
        assert_eq!(
            found,
            [
                Vec2::new(0.1, 1.0 - 0.2),
                Vec2::new(0.3, 1.0 - 0.4),
                Vec2::new(0.5, 1.0 - 0.6)
            ],
            "{faces}"
        );
        let lengths: Vec<f32> = mesh.normals.iter().map(|n| n.length()).collect();
        assert!(
            lengths.iter().all(|l| *l == 0.0 || *l == 1.0),
            "{lengths:?}"
        );
    }
}

#[test]
fn only_some_objects_may_have_attributes() {
    let scene = load(format!(
        "{V}o a\nf 1 2 3\nvt 0 0\nvn 0 0 1\no b\nf 1/1/1 2/1/1 3/1/1\no c\nf 1//1 2//1 3/1/1\n"
    ))
    .unwrap();
    let sizes = |m: &TriangleMesh| (m.positions.len(), m.uv_sets.len(), m.normals.len());
    assert_eq!(
        scene.meshes.iter().map(sizes).collect::<Vec<_>>(),
        [(3, 0, 0), (3, 1, 3), (3, 1, 3)]
    );
}

#[test]
fn vertices_are_those_used_each_once() {
    let scene = load(format!(
        "v 7 7 7\n{V}vt 0 0\nvt 1 0\nf 2/1 3/1 4/1\nf 2/1 4/1 5/1\nf 2/2 4/1 5/1\n"
    ))
    .unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 2, 3]]);
    assert_eq!(mesh.positions[4], mesh.positions[0]);
}

#[test]
fn objects_are_meshes_and_groups_are_parts_of_them() {
    let names = |text: &str| {
        let scene = load(format!("{V}{text}")).unwrap();
        let placed: Vec<String> = scene.instances.iter().map(|i| i.name.clone()).collect();
        assert_eq!(
            placed,
            scene
                .meshes
                .iter()
                .map(|m| m.name.clone())
                .collect::<Vec<_>>()
        );
        (
            placed,
            scene
                .meshes
                .iter()
                .map(|m| m.triangles.len())
                .collect::<Vec<_>>(),
        )
    };
    let is = |names: &[&str], counts: &[usize]| {
        (
            names.iter().map(|n| (*n).to_owned()).collect(),
            counts.to_vec(),
        )
    };
    assert_eq!(names("f 1 2 3\n"), is(&["model"], &[1]));
    // tobj calls this one "B".
    assert_eq!(
        names("o A\ng B\nf 1 2 3\ng C\nf 1 3 4\no D x\nf 1 2 4\n"),
        is(&["A", "D x"], &[2, 1])
    );
    assert_eq!(
        names("g B c\nf 1 2 3\ng B c\nf 1 3 4\ng\nf 1 2 4\n"),
        is(&["B c", "default"], &[2, 1])
    );
    assert_eq!(
        names("f 1 2 3\no A\no B\nf 1 3 4\n"),
        is(&["model", "B"], &[1, 1])
    );
    assert_eq!(
        names("o A\nf 1 2 3\no A\nf 1 3 4\n"),
        is(&["A", "A"], &[1, 1])
    );
}

#[test]
fn vertex_colours_become_linear_and_complete() {
    // tobj fails when only some vertices have one.
    let scene = load("v 0 0 0 1 0 0\nv 4 2 0 2\nv 2 0 0 0.5 1 0\nf 1 2 3\n").unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions[1], Vec3::new(2.0, 1.0, 0.0));
    assert_eq!(mesh.colors[..2], [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::ONE]);
    assert!((mesh.colors[2].x - 0.214_041).abs() < 1e-5);
    assert!(
        notes(&scene)[0].contains("1 of 3 vertices"),
        "{:?}",
        notes(&scene)
    );
    let bytes = load("v 0 0 0 255 0 0\nv 2 0 0 0 255 0\nv 2 1 0\nf 1 2 3\n").unwrap();
    let expected = [
        Vec4::new(1.0, 0.0, 0.0, 1.0),
        Vec4::new(0.0, 1.0, 0.0, 1.0),
        Vec4::ONE,
    ];
    assert!(
        bytes.meshes[0]
            .colors
            .iter()
            .zip(expected)
            .all(|(c, e)| (*c - e).length() < 1e-6)
    );
}

#[test]
fn broken_vertices_drop_their_faces_whole() {
    for (bad, cause) in [
        ("nan 0 0", DefectCause::NotFinite),
        ("0 inf 0", DefectCause::NotFinite),
        ("0 1.#QNAN 0", DefectCause::NotFinite),
        ("0 3.1+e2 0", DefectCause::NotFinite),
        ("0 0", DefectCause::NotFinite),
        ("0 0 1 0", DefectCause::NotFinite),
        ("0 1e19 0", DefectCause::TooLarge),
        ("0 1e99 0", DefectCause::NotFinite),
    ] {
        let scene = load(format!("{V}v {bad}\nv 0 3 0\nf 1 2 3 6 5\nf 1 2 3\n")).unwrap();
        assert_eq!(scene.placed_triangles(), 1, "{bad}");
        assert_eq!(
            scene
                .defects
                .iter()
                .map(|d| (d.cause, d.count))
                .collect::<Vec<_>>(),
            [(cause, 3)],
            "{bad}"
        );
        assert!(scene.meshes[0].outlines.is_empty());
        assert!(scene.bounds().max == Vec3::new(2.0, 1.0, 0.0));
    }
}
