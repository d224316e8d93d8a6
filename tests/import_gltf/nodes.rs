//! What the node hierarchy places: meshes, cameras and lights.

use bspray::scene::{LightKind, Projection};
use glam::{DVec3, Vec3};
use serde_json::json;

use crate::model::*;

#[test]
fn nodes_compose_in_double_precision() {
    let scene = good(|m| {
        m["nodes"] = json!([
            {"name": "root", "children": [1, 2], "translation": [16_777_217.0, 0, 0]},
            {"mesh": 0, "name": "turned", "rotation": [0, 0, 2, 2], "scale": [2, 1, 1]},
            {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, -16_777_216.0, 0, 5, 1]},
        ]);
        m["meshes"][0]["name"] = json!("part");
    });
    assert_eq!(scene.meshes.len(), 1);
    let names: Vec<_> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["turned", "part"]);
    let point = |i: usize| {
        scene.instances[i]
            .world_from_object
            .transform_point3(DVec3::new(1.0, 2.0, 3.0))
    };
    // Twice along x, then a quarter turn about z.
    assert!((point(0) - DVec3::new(16_777_215.0, 2.0, 3.0)).length() < 1e-8);
    assert_eq!(
        point(1),
        DVec3::new(2.0, -3.0, 7.0),
        "16,777,217 is no float"
    );
}

#[test]
fn odd_transforms_are_noted_or_refused() {
    let row = good(|m| {
        m["nodes"][0]["matrix"] = json!([1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    });
    assert!(has_note(&row, "node 0: the last row of its matrix"));
    let rotation = good(|m| m["nodes"][0]["rotation"] = json!([0, 0, 0, 0]));
    assert!(has_note(&rotation, "node 0: its rotation has no direction"));
    refused(&["node 1 \"far\": its transform is not finite"], |m| {
        m["nodes"] = json!([{"scale": [1e200, 1, 1], "children": [1]}, {"name": "far", "scale": [1e200, 1, 1]}]);
    });
}

#[test]
fn graphs_that_are_no_trees_are_refused() {
    refused(
        &["node 0 \"a\": hangs from itself: node 1 \"b\" names it"],
        |m| {
            m["nodes"] =
                json!([{"name": "a", "children": [1]}, {"name": "b", "mesh": 0, "children": [0]}]);
        },
    );
    refused(&["node 0: hangs from itself"], |m| {
        m["nodes"][0]["children"] = json!([0])
    });
    refused(&["node 2: hangs twice: from node 0 and from node 1"], |m| {
        m["scenes"][0]["nodes"] = json!([0, 1]);
        m["nodes"] = json!([{"children": [2]}, {"children": [2]}, {"mesh": 0}]);
    });
    refused(
        &["node 0: hangs twice: from the scene and from the scene"],
        |m| m["scenes"][0]["nodes"] = json!([0, 0]),
    );
    refused(
        &["node 0: names node 8, which is not there: the file has 1"],
        |m| m["nodes"][0]["children"] = json!([8]),
    );
    refused(&["the scene: names node 3"], |m| {
        m["scenes"][0]["nodes"] = json!([3])
    });
    refused(&["scene 4: is not there: the file has 1"], |m| {
        m["scene"] = json!(4)
    });
    refused(&["the graph has a cycle and no beginning"], |m| {
        m.as_object_mut()
            .expect("there")
            .retain(|k, _| !k.starts_with("scene"));
        m["nodes"] = json!([{"children": [1]}, {"children": [0]}]);
    });
    let scene = good(|m| {
        m.as_object_mut()
            .expect("there")
            .retain(|k, _| !k.starts_with("scene"))
    });
    assert!(has_note(
        &scene,
        "the file has none: all of its nodes are shown"
    ));
    let scene = good(|m| {
        push(m, "scenes", json!({}));
    });
    assert!(has_note(
        &scene,
        "only scene 0 is shown; others left out: 1"
    ));
}

#[test]
fn a_hundred_thousand_nodes_deep() {
    const DEPTH: usize = 100_000;
    let scene = good(|m| {
        let nodes = (0..DEPTH).map(|i| json!({"children": [i + 1], "translation": [1, 0, 0.5]}));
        m["nodes"] = nodes.chain([json!({"mesh": 0})]).collect();
    });
    let world = scene.instances[0].world_from_object;
    assert_eq!(world.translation, DVec3::new(100_000.0, 0.0, 50_000.0));
    refused(&["node 0: hangs from itself: node 99999"], |m| {
        m["nodes"] = (0..DEPTH)
            .map(|i| json!({"children": [(i + 1) % DEPTH]}))
            .collect();
    });
}

#[test]
fn hidden_nodes_hide_what_hangs_from_them() {
    let scene = good(|m| {
        m["extensionsRequired"] = json!(["KHR_node_visibility"]);
        let visible = |shows: bool| json!({"KHR_node_visibility": {"visible": shows}});
        m["scenes"][0]["nodes"] = json!([0, 2]);
        m["nodes"] = json!([
            {"mesh": 0, "name": "hidden", "extensions": visible(false), "children": [1]},
            {"mesh": 0, "name": "below", "extensions": visible(true)},
            {"mesh": 0, "name": "shown", "extensions": visible(true)},
        ]);
    });
    let names: Vec<_> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["shown"]);
}

#[test]
fn cameras_stand_in_the_world() {
    let scene = good(|m| {
        m["scenes"][0]["nodes"] = json!([0, 1]);
        m["cameras"] = json!([
            {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}, "name": "eye"},
            {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 1.5, "znear": 0, "zfar": 9}},
            {"type": "perspective", "perspective": {"yfov": 4, "znear": 0.1}},
        ]);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        push(
            m,
            "nodes",
            json!({"camera": 0, "translation": [10, 1, 3], "rotation": [0, half, 0, half], "scale": [3, 3, 3], "children": [2, 3, 4]}),
        );
        push(m, "nodes", json!({"camera": 1, "name": "plan"}));
        push(m, "nodes", json!({"camera": 2}));
        push(m, "nodes", json!({"camera": 7}));
    });
    let [eye, plan] = &scene.cameras[..] else {
        panic!("{:?}", scene.cameras)
    };
    assert_eq!((eye.name.as_str(), plan.name.as_str()), ("eye", "plan"));
    // A quarter turn about y: looking along -x at the triangle's middle, (0.5, 1, 3).
    assert!((eye.position - Vec3::new(10.0, 1.0, 3.0)).length() < 1e-5);
    assert!(
        (eye.focal_point - Vec3::new(0.5, 1.0, 3.0)).length() < 1e-4,
        "{}",
        eye.focal_point
    );
    assert!((eye.view_up - Vec3::Y).length() < 1e-6);
    let Projection::Perspective { view_angle } = eye.projection else {
        panic!("{:?}", eye.projection)
    };
    assert!((view_angle - 28.647_89).abs() < 1e-4);
    assert_eq!(plan.projection, Projection::Orthographic { height: 3.0 });
    assert!(has_note(&scene, "camera 2: left out"));
    assert!(has_note(&scene, "node 4: camera 7 is not there"));
}

#[test]
fn lights_shine_in_the_world() {
    let scene = good(|m| {
        m["extensionsRequired"] = json!(["KHR_lights_punctual"]);
        m["extensions"] = json!({"KHR_lights_punctual": {"lights": [
            {"type": "directional", "color": [1, 0.5, 0], "intensity": 4},
            {"type": "spot", "range": 20, "spot": {"innerConeAngle": 0.25}, "name": "lamp"},
            {"type": "beam"},
        ]}});
        let light = |i| json!({"KHR_lights_punctual": {"light": i}});
        let half = std::f64::consts::FRAC_1_SQRT_2;
        m["nodes"] = json!([
            {"mesh": 0, "children": [1, 2, 3, 4]},
            {"extensions": light(0), "name": "sun", "rotation": [-half, 0, 0, half], "scale": [5, 5, 5]},
            {"extensions": light(1), "translation": [1, 2, 3]},
            {"extensions": light(2)},
            {"extensions": light(3)},
        ]);
    });
    let [sun, lamp] = &scene.lights[..] else {
        panic!("{:?}", scene.lights)
    };
    assert_eq!((sun.name.as_str(), lamp.name.as_str()), ("sun", "lamp"));
    assert_eq!(sun.intensity, Vec3::new(4.0, 2.0, 0.0));
    assert!((sun.direction - Vec3::NEG_Y).length() < 1e-6);
    assert_eq!(lamp.position, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!((lamp.intensity, lamp.range), (Vec3::ONE, Some(20.0)));
    let cone = LightKind::Spot {
        inner_angle: 0.25,
        outer_angle: std::f32::consts::FRAC_PI_4,
    };
    assert_eq!(lamp.kind, cone);
    assert!(has_note(&scene, "light 2: left out: its type is unknown"));
    assert!(has_note(&scene, "node 4: light 3 is not there"));
}
