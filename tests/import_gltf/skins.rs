//! Meshes that joints and morph targets bend, against matrices multiplied by hand.

use glam::{DAffine3, DMat3, DVec3, Vec3, Vec4};
use serde_json::{Value, json};

use crate::model::*;

/// The triangle with two joints: "hip" at (10, 0, 0), turned a quarter about z, "knee" 5 further along its x, twice as large. Its
/// corners go with the hip, with the knee, and with a quarter of the hip and three of the knee.
fn rigged() -> Value {
    let mut m = triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    m["scenes"][0]["nodes"] = json!([0, 1]);
    m["nodes"] = json!([
        {"mesh": 0, "skin": 0, "name": "body", "translation": [1000, 2000, 3000]},
        {"name": "hip", "translation": [10, 0, 0], "rotation": [0, 0, half, half], "children": [2]},
        {"name": "knee", "translation": [5, 0, 0], "scale": [2, 2, 2]},
    ]);
    let column = |x: f32, y: f32, z: f32, w: f32| [x, y, z, w];
    // The mesh was bound with the hip at (0, 0, 1) and the knee at (-1, 0, 0).
    let binds = [
        [
            column(1.0, 0.0, 0.0, 0.0),
            column(0.0, 1.0, 0.0, 0.0),
            column(0.0, 0.0, 1.0, 0.0),
            column(0.0, 0.0, -1.0, 1.0),
        ],
        [
            column(1.0, 0.0, 0.0, 0.0),
            column(0.0, 1.0, 0.0, 0.0),
            column(0.0, 0.0, 1.0, 0.0),
            column(1.0, 0.0, 0.0, 1.0),
        ],
    ];
    let bytes = floats(binds.as_flattened().as_flattened());
    let binds = add_accessor(&mut m, &bytes, FLOAT, 2, "MAT4");
    m["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": binds, "name": "rig"}]);
    let joints = [0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0];
    set_attribute(&mut m, "JOINTS_0", &joints, UNSIGNED_BYTE, 3, "VEC4");
    let weights = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.25, 0.75, 0.0, 0.0];
    set_attribute(&mut m, "WEIGHTS_0", &floats(&weights), FLOAT, 3, "VEC4");
    m
}

fn close(found: Vec3, expected: [f32; 3]) {
    assert!(
        (found - Vec3::from(expected)).length() < 1e-4,
        "{found} instead of {expected:?}"
    );
}

#[test]
fn joints_place_vertices_and_the_node_does_not() {
    let scene = load_model(&rigged()).expect("loads");
    let [mesh] = &scene.meshes[..] else {
        panic!("{}", scene.meshes.len())
    };
    assert_eq!(scene.instances[0].world_from_object, DAffine3::IDENTITY);
    assert_eq!(scene.instances[0].name, "body");
    // (x, y, z) by the hip: bound to (x, y, z - 1), turned to (-y, x, z - 1), moved to (10 - y, x, z - 1).
    // By the knee: (x + 1, y, z), twice as large, 5 along x, then as by the hip: (10 - 2 y, 2 (x + 1) + 5, 2 z).
    close(mesh.positions[0], [10.0, 0.0, 2.0]);
    close(mesh.positions[1], [10.0, 9.0, 6.0]);
    // A quarter of (8, 0, 2) and three of (6, 7, 6).
    close(mesh.positions[2], [6.5, 5.25, 5.0]);
}

#[test]
fn normals_turn_with_their_joints() {
    let mut m = rigged();
    // Squashed to a third along x: normals lean the other way than vertices.
    m["nodes"][1]["scale"] = json!([1.0 / 3.0, 1, 1]);
    let normals = [3.0, 4.0, 0.0, 3.0, 4.0, 0.0, 0.0, 0.0, 7.0];
    set_attribute(&mut m, "NORMAL", &floats(&normals), FLOAT, 3, "VEC3");
    let scene = load_model(&m).expect("loads");
    let normals = &scene.meshes[0].normals;
    // Inverse transpose: x times 3, y times 1, then a quarter turn: (9, 4) becomes (-4, 9).
    let expected = Vec3::new(-4.0, 9.0, 0.0).normalize();
    close(normals[0], expected.to_array());
    close(normals[1], expected.to_array());
    close(normals[2], [0.0, 0.0, 1.0]);
}

/// Gives the model normals, tangents along (3, 4, 0), and a material that shows them.
fn add_tangents(m: &mut Value) {
    let normals = floats(&[0.0, 0.0, 1.0].repeat(3));
    set_attribute(m, "NORMAL", &normals, FLOAT, 3, "VEC3");
    let tangents = floats(&[0.6, 0.8, 0.0, -1.0].repeat(3));
    set_attribute(m, "TANGENT", &tangents, FLOAT, 3, "VEC4");
    m["images"] = json!([{"uri": format!("data:image/png;base64,{PNG}")}]);
    m["textures"] = json!([{"source": 0}]);
    m["materials"] = json!([{"normalTexture": {"index": 0}}]);
    m["meshes"][0]["primitives"][0]["material"] = json!(0);
}

#[test]
fn tangents_are_read_where_they_show_and_go_with_joints_and_morphs() {
    let mut m = triangle();
    add_tangents(&mut m);
    let read = |m: &Value| load_model(m).expect("loads").meshes[0].tangents.clone();
    assert_eq!(read(&m), [Vec4::new(0.6, 0.8, 0.0, -1.0); 3]);
    m["materials"] = json!([{}]);
    assert!(read(&m).is_empty());

    let mut m = rigged();
    add_tangents(&mut m);
    // As vertices go, not as normals do: x squashed to a third, then a quarter turn.
    m["nodes"][1]["scale"] = json!([1.0 / 3.0, 1, 1]);
    let tangent = read(&m)[0];
    close(
        tangent.truncate(),
        Vec3::new(-4.0, 1.0, 0.0).normalize().to_array(),
    );
    assert!(tangent.w < 0.0);
    // A mirror turns the bitangent.
    m["nodes"][1]["scale"] = json!([1, 1, -1]);
    assert!(read(&m)[0].w > 0.0);

    let mut m = morphing();
    add_tangents(&mut m);
    let aside = floats(&[-0.6, 0.0, 0.0].repeat(3));
    let aside = add_accessor(&mut m, &aside, FLOAT, 3, "VEC3");
    m["meshes"][0]["primitives"][0]["targets"][0]["TANGENT"] = json!(aside);
    m["meshes"][0]["weights"] = json!([1.0, 0.0]);
    let tangent = read(&m)[2];
    close(tangent.truncate(), [0.0, 1.0, 0.0]);
    assert!(tangent.w < 0.0);
}

#[test]
fn weights_and_joints_of_integers_and_of_two_sets() {
    let plain = load_model(&rigged()).expect("loads").meshes[0]
        .positions
        .clone();
    let mut m = rigged();
    // 64 : 191 is not quite 1 : 3, and the sum is 255; in two sets of 16 bits it is exact, and the sum is 4.
    let weights = [255, 0, 0, 0, 255, 0, 0, 0, 64, 191, 0, 0];
    let bytes = set_attribute(&mut m, "WEIGHTS_0", &weights, UNSIGNED_BYTE, 3, "VEC4");
    m["accessors"][bytes]["normalized"] = json!(true);
    let scene = load_model(&m).expect("loads");
    assert!((scene.meshes[0].positions[2] - plain[2]).length() < 0.02);
    let joints = shorts(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
    set_attribute(&mut m, "JOINTS_0", &joints, UNSIGNED_SHORT, 3, "VEC4");
    set_attribute(
        &mut m,
        "WEIGHTS_0",
        &floats(&[1.0, 0.0, 0.0, 0.0].repeat(3)),
        FLOAT,
        3,
        "VEC4",
    );
    let joints = [1, 1, 1, 1].repeat(3);
    set_attribute(&mut m, "JOINTS_1", &joints, UNSIGNED_BYTE, 3, "VEC4");
    let weights = [0.0; 8]
        .iter()
        .chain(&[1.0, 1.0, 0.5, 0.5])
        .copied()
        .collect::<Vec<f32>>();
    set_attribute(&mut m, "WEIGHTS_1", &floats(&weights), FLOAT, 3, "VEC4");
    let scene = load_model(&m).expect("loads");
    for (found, expected) in scene.meshes[0].positions.iter().zip(plain) {
        close(*found, expected.to_array());
    }
}

#[test]
fn what_joints_mirror_keeps_its_front() {
    let mut m = rigged();
    m["nodes"][1]["scale"] = json!([1, 1, -1]);
    let normals = floats(&[0.0, 0.0, 1.0].repeat(3));
    set_attribute(&mut m, "NORMAL", &normals, FLOAT, 3, "VEC3");
    let mesh = load_model(&m).expect("loads").meshes.remove(0);
    assert_eq!(mesh.triangles, [[0, 2, 1]]);
    let [a, b, c] = mesh.triangles[0].map(|v| mesh.positions[v as usize]);
    let front = (b - a).cross(c - a);
    assert!(
        front.dot(mesh.normals[0]) > 0.0,
        "{front} {}",
        mesh.normals[0]
    );
}

#[test]
fn joints_may_lie_outside_the_scene_and_meshes_may_have_none() {
    let plain = load_model(&rigged()).expect("loads").meshes[0]
        .positions
        .clone();
    let mut m = rigged();
    m["scenes"][0]["nodes"] = json!([0]);
    assert_eq!(load_model(&m).expect("loads").meshes[0].positions, plain);
    // Without inverse bind matrices, joints move the mesh as nodes would.
    m["skins"][0]
        .as_object_mut()
        .expect("there")
        .remove("inverseBindMatrices");
    let scene = load_model(&m).expect("loads");
    close(scene.meshes[0].positions[0], [10.0, 0.0, 3.0]);
    // Without joints, the node places it.
    m["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    let scene = load_model(&m).expect("loads");
    close(scene.meshes[0].positions[1], [1001.0, 2000.0, 3003.0]);
    assert!(has_note(&scene, "has no joints for its skin"));
}

#[test]
fn broken_skins_are_named() {
    let refused = |words: &[&str], change: &dyn Fn(&mut Value)| {
        let mut m = rigged();
        change(&mut m);
        expect_words(&load_model(&m).expect_err("broken"), words);
    };
    refused(
        &["node 0 \"body\": skin 4 is not there: the file has 1"],
        &|m| m["nodes"][0]["skin"] = json!(4),
    );
    refused(
        &["skin 0 \"rig\": joint 1: node 9 is not there: the file has 3"],
        &|m| m["skins"][0]["joints"] = json!([1, 9]),
    );
    refused(
        &["skin 0 \"rig\": has 2 inverse bind matrices for 3 joints"],
        &|m| m["skins"][0]["joints"] = json!([1, 2, 1]),
    );
    refused(
        &["skin 0 \"rig\": accessor 0: its elements have 3 components, not 16"],
        &|m| m["skins"][0]["inverseBindMatrices"] = json!(0),
    );
    refused(
        &["mesh 0, primitive 0: JOINTS: vertex 1 names joint 1 of 1"],
        &|m| m["skins"][0]["joints"] = json!([1]),
    );
    refused(&["joint 0: its transform is not finite"], &|m| {
        m["nodes"][1]["scale"] = json!([1e300, 1, 1]);
        let (hip, knee) = (
            m["nodes"][1].clone(),
            json!({"children": [1], "scale": [1e300, 1, 1]}),
        );
        m["nodes"] = json!([m["nodes"][0], hip, m["nodes"][2], knee]);
        m["scenes"][0]["nodes"] = json!([0]);
    });
    refused(
        &["joint 0: node 1 \"hip\" has no place in the world"],
        &|m| {
            m["scenes"][0]["nodes"] = json!([0]);
            m["nodes"][2]["children"] = json!([1]);
        },
    );
    // A joint without weight may be anything.
    let mut m = rigged();
    let joints = [0, 77, 0, 0, 1, 0, 0, 99, 0, 1, 0, 0];
    set_attribute(&mut m, "JOINTS_0", &joints, UNSIGNED_BYTE, 3, "VEC4");
    load_model(&m).expect("loads");
}

/// The triangle with two morph targets: by (0, 0, 8) at all corners, and by (4, 0, 0) at the last.
fn morphing() -> Value {
    let mut m = triangle();
    let up = add_accessor(
        &mut m,
        &floats(&[0.0, 0.0, 8.0].repeat(3)),
        FLOAT,
        3,
        "VEC3",
    );
    // The other as sparse values over zeros, as exporters write them, as integers.
    let indices = add_view(&mut m, &[2]);
    let values = add_view(&mut m, &shorts(&[4, 0, 0]));
    let aside = push(
        &mut m,
        "accessors",
        json!({"componentType": SHORT, "count": 3, "type": "VEC3", "sparse": {
        "count": 1, "indices": {"bufferView": indices, "componentType": UNSIGNED_BYTE}, "values": {"bufferView": values}}}),
    );
    m["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": up}, {"POSITION": aside}]);
    m
}

#[test]
fn morph_targets_add_up_by_weight() {
    let corners = |m: &Value| load_model(m).expect("loads").meshes[0].positions.clone();
    let mut m = morphing();
    let rest = [[0.0, 0.0, 3.0], [1.0, 0.0, 3.0], [0.0, 2.0, 3.0]].map(Vec3::from);
    assert_eq!(corners(&m), rest);
    m["meshes"][0]["weights"] = json!([0.25, -0.5]);
    let moved = [[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [-2.0, 2.0, 5.0]].map(Vec3::from);
    assert_eq!(corners(&m), moved);
    // The node's own weights come first; too many, too few and broken ones do no harm.
    m["nodes"][0]["weights"] = json!([0, 1, 99]);
    assert_eq!(corners(&m)[2], Vec3::new(4.0, 2.0, 3.0));
    m["nodes"][0]["weights"] = json!([]);
    assert_eq!(corners(&m), rest);
}

#[test]
fn nodes_that_morph_alike_share_a_mesh() {
    let mut m = morphing();
    m["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    m["nodes"] = json!([
        {"mesh": 0, "weights": [1, 0]}, {"mesh": 0, "weights": [0, 1]},
        {"mesh": 0, "weights": [1]}, {"mesh": 0, "translation": [7, 0, 0]},
    ]);
    let scene = load_model(&m).expect("loads");
    let meshes: Vec<u32> = scene.instances.iter().map(|i| i.mesh).collect();
    assert_eq!((scene.meshes.len(), meshes), (3, vec![0, 1, 0, 2]));
    assert_eq!(scene.meshes[2].positions[0], Vec3::new(0.0, 0.0, 3.0));
}

#[test]
fn morphed_normals_are_unit_again_and_skins_come_after() {
    let mut m = rigged();
    set_attribute(
        &mut m,
        "NORMAL",
        &floats(&[0.0, 0.0, 1.0].repeat(3)),
        FLOAT,
        3,
        "VEC3",
    );
    let up = add_accessor(
        &mut m,
        &floats(&[0.0, 0.0, 8.0].repeat(3)),
        FLOAT,
        3,
        "VEC3",
    );
    let lean = add_accessor(
        &mut m,
        &floats(&[3.0, 0.0, 3.0].repeat(3)),
        FLOAT,
        3,
        "VEC3",
    );
    m["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": up, "NORMAL": lean}]);
    m["meshes"][0]["weights"] = json!([0.5]);
    let mesh = load_model(&m).expect("loads").meshes.remove(0);
    // As in `joints_place_vertices`, with z larger by 4.
    close(mesh.positions[0], [10.0, 0.0, 6.0]);
    close(mesh.positions[1], [10.0, 9.0, 14.0]);
    // (1.5, 0, 2.5), a quarter turn about z.
    let expected = Vec3::new(0.0, 1.5, 2.5).normalize();
    close(mesh.normals[1], expected.to_array());
    let mut broken = morphing();
    broken["meshes"][0]["weights"] = json!([1, 1]);
    broken["accessors"][1]["count"] = json!(2);
    expect_words(
        &load_model(&broken).expect_err("short"),
        &["morph target 0: POSITION: accessor 1 has 2 elements for 3 vertices"],
    );
}

#[test]
fn claims_of_many_shapes_cost_nothing() {
    let mut m = morphing();
    m["accessors"][0]["count"] = json!(1_u64 << 27);
    m["scenes"][0]["nodes"] = json!([0, 1]);
    m["nodes"] = json!([{"mesh": 0, "weights": [1]}, {"mesh": 0, "weights": [0.5]}]);
    expect_words(
        &load_model(&m).expect_err("too many"),
        &["node 1: skins and morph targets make more than 134217728 vertices"],
    );
}

#[test]
fn the_matrices_of_the_rig_are_those_of_the_specification() {
    // world_from_joint * joint_from_mesh, by general matrices instead of by hand.
    let quarter = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
    let hip = DAffine3::from_mat3_translation(quarter, DVec3::new(10.0, 0.0, 0.0));
    let knee = hip
        * DAffine3::from_scale_rotation_translation(
            DVec3::splat(2.0),
            glam::DQuat::IDENTITY,
            DVec3::new(5.0, 0.0, 0.0),
        );
    let binds =
        [DVec3::new(0.0, 0.0, -1.0), DVec3::new(1.0, 0.0, 0.0)].map(DAffine3::from_translation);
    let at = |p: DVec3| {
        let [a, b] = [hip * binds[0], knee * binds[1]].map(|m| m.transform_point3(p));
        (a * 0.25 + b * 0.75).as_vec3()
    };
    let scene = load_model(&rigged()).expect("loads");
    close(
        scene.meshes[0].positions[2],
        at(DVec3::new(0.0, 2.0, 3.0)).to_array(),
    );
}
