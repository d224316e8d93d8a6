//! Moments of animations: channels, interpolations and what is wrong with some.

use bspray::import::{ImportOptions, Moment, load_with, load_with_neighbors};
use bspray::scene::Scene;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use crate::model::*;

/// The triangle with an animation "go" of its node: from 1 s to 3 s by the values in `output`.
fn animated(path: &str, interpolation: &str, output: &[f32], kind: &str) -> Value {
    let mut m = triangle();
    let width = match kind {
        "SCALAR" => 1,
        "VEC3" => 3,
        _ => 4,
    };
    let input = add_accessor(&mut m, &floats(&[1.0, 3.0]), FLOAT, 2, "SCALAR");
    let count = (output.len() / width) as u64;
    let output = add_accessor(&mut m, &floats(output), FLOAT, count, kind);
    m["animations"] = json!([{"name": "go",
        "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}]}]);
    m
}

fn options(animation: usize, seconds: f64) -> ImportOptions {
    let moment = Some(Moment { animation, seconds });
    ImportOptions {
        moment,
        ..ImportOptions::default()
    }
}

fn at(m: &Value, seconds: f64) -> Scene {
    load_model_with(m, &options(0, seconds)).expect("loads")
}

/// Where the node is.
fn place(m: &Value, seconds: f64) -> DVec3 {
    at(m, seconds).instances[0].world_from_object.translation
}

#[test]
fn translations_step_go_on_lines_and_on_curves() {
    let ends = [0.0, 2.0, 0.0, 8.0, 2.0, -4.0];
    let linear = animated("translation", "LINEAR", &ends, "VEC3");
    let step = animated("translation", "STEP", &ends, "VEC3");
    // Both ends at rest: the smooth step.
    let flat = [0.0; 3];
    let spline: Vec<f32> = [&flat, &ends[..3], &flat, &flat, &ends[3..], &flat].concat();
    let spline = animated("translation", "CUBICSPLINE", &spline, "VEC3");
    let on = |share: f64| DVec3::new(8.0 * share, 2.0, -4.0 * share);
    for (seconds, [straight, stepped, curved]) in [
        (-5.0, [0.0, 0.0, 0.0]),
        (1.0, [0.0, 0.0, 0.0]),
        (1.5, [0.25, 0.0, 0.156_25]),
        (2.0, [0.5, 0.0, 0.5]),
        (3.0, [1.0, 1.0, 1.0]),
        (70.0, [1.0, 1.0, 1.0]),
    ] {
        assert_eq!(place(&linear, seconds), on(straight), "{seconds}");
        assert_eq!(place(&step, seconds), on(stepped), "{seconds}");
        assert_eq!(place(&spline, seconds), on(curved), "{seconds}");
    }
    assert!(has_note(
        &at(&linear, 70.0),
        "animation 0 \"go\": ends at 3 s: its end is shown"
    ));
}

#[test]
fn rotations_take_the_short_arc_also_as_integers() {
    // From nothing to a turn by 120 degrees about z, given the long way round; a quarter of it is 30 degrees.
    let (sin, cos) = (0.75_f32.sqrt(), 0.5_f32);
    let mut m = animated(
        "rotation",
        "LINEAR",
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -sin, -cos],
        "VEC4",
    );
    let x = |m: &Value| at(m, 1.5).instances[0].world_from_object.matrix3.x_axis;
    let expected = DVec3::new(0.75_f64.sqrt(), 0.5, 0.0);
    assert!((x(&m) - expected).length() < 1e-6, "{}", x(&m));
    let short = |v: f32| (v * 32_767.0).round() as i16;
    let values = shorts(&[0, 0, 0, 32_767, 0, 0, short(-sin), short(-cos)]);
    let output = add_accessor(&mut m, &values, SHORT, 2, "VEC4");
    m["accessors"][output]["normalized"] = json!(true);
    m["animations"][0]["samplers"][0]["output"] = json!(output);
    assert!((x(&m) - expected).length() < 1e-4, "{}", x(&m));
}

#[test]
fn scales_and_weights_move_too() {
    let m = animated("scale", "LINEAR", &[1.0, 1.0, 1.0, 3.0, 5.0, 9.0], "VEC3");
    let matrix = at(&m, 2.0).instances[0].world_from_object.matrix3;
    let expected = glam::DMat3::from_diagonal(DVec3::new(2.0, 3.0, 5.0));
    assert_eq!(matrix, expected);
    // Two targets: their weights follow each other within a keyframe, and on curves within a row of one.
    let morphing = |interpolation, weights: &[f32]| {
        let mut m = animated("weights", interpolation, weights, "SCALAR");
        let up = add_accessor(
            &mut m,
            &floats(&[0.0, 0.0, 8.0].repeat(3)),
            FLOAT,
            3,
            "VEC3",
        );
        let aside = add_accessor(
            &mut m,
            &floats(&[16.0, 0.0, 0.0].repeat(3)),
            FLOAT,
            3,
            "VEC3",
        );
        m["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": up}, {"POSITION": aside}]);
        m
    };
    let linear = morphing("LINEAR", &[0.0, 1.0, 1.0, 0.5]);
    assert_eq!(
        at(&linear, 1.5).meshes[0].positions[0],
        Vec3::new(14.0, 0.0, 5.0)
    );
    let spline = morphing(
        "CUBICSPLINE",
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0],
    );
    assert_eq!(
        at(&spline, 1.5).meshes[0].positions[0],
        Vec3::new(14.75, 0.0, 4.25)
    );
}

#[test]
fn joints_carry_their_skins_along() {
    let mut m = animated(
        "translation",
        "LINEAR",
        &[0.0, 0.0, 0.0, 0.0, 6.0, 0.0],
        "VEC3",
    );
    m["scenes"][0]["nodes"] = json!([0, 1]);
    m["nodes"] = json!([{"mesh": 0, "skin": 0}, {"translation": [5, 0, 0]}]);
    m["skins"] = json!([{"joints": [1]}]);
    m["animations"][0]["channels"][0]["target"]["node"] = json!(1);
    set_attribute(&mut m, "JOINTS_0", &[0; 12], UNSIGNED_BYTE, 3, "VEC4");
    set_attribute(
        &mut m,
        "WEIGHTS_0",
        &floats(&[1.0, 0.0, 0.0, 0.0].repeat(3)),
        FLOAT,
        3,
        "VEC4",
    );
    assert_eq!(at(&m, 2.0).meshes[0].positions[1], Vec3::new(1.0, 3.0, 3.0));
    assert_eq!(
        load_model(&m).expect("loads").meshes[0].positions[1],
        Vec3::new(6.0, 0.0, 3.0)
    );
}

#[test]
fn a_matrix_gives_way_and_the_rest_of_it_stays() {
    let mut m = animated(
        "translation",
        "STEP",
        &[7.0, 8.0, 9.0, 7.0, 8.0, 9.0],
        "VEC3",
    );
    m["nodes"][0]["matrix"] = json!([0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1]);
    let world = at(&m, 0.0).instances[0].world_from_object;
    assert_eq!(world.translation, DVec3::new(7.0, 8.0, 9.0));
    assert!((world.matrix3.x_axis - DVec3::new(0.0, 2.0, 0.0)).length() < 1e-12);
}

#[test]
fn without_a_moment_nothing_moves_and_a_note_says_what_could() {
    let mut m = animated("translation", "LINEAR", &[5.0; 6], "VEC3");
    push(&mut m, "animations", json!({"channels": [{"nonsense": 1}]}));
    let scene = load_model(&m).expect("loads");
    assert_eq!(
        scene.instances[0].world_from_object.translation,
        DVec3::ZERO
    );
    assert!(has_note(
        &scene,
        "animations: shown at rest; there are: 0 \"go\", 1"
    ));
}

#[test]
fn broken_animations_are_named() {
    let refused = |words: &[&str], animation: usize, change: &dyn Fn(&mut Value)| {
        let mut m = animated("translation", "LINEAR", &[5.0; 6], "VEC3");
        change(&mut m);
        expect_words(
            &load_model_with(&m, &options(animation, 2.0)).expect_err("broken"),
            words,
        );
    };
    let channel =
        |m: &mut Value, key: &str, value: Value| m["animations"][0]["channels"][0][key] = value;
    let sampler =
        |m: &mut Value, key: &str, value: Value| m["animations"][0]["samplers"][0][key] = value;
    refused(
        &["animation 4: is not there; there are: 0 \"go\""],
        4,
        &|_| {},
    );
    refused(
        &["animation 0 \"go\", channel 0: sampler 3 is not there: the animation has 1"],
        0,
        &|m| channel(m, "sampler", json!(3)),
    );
    refused(
        &["channel 0: node 9 is not there: the file has 1"],
        0,
        &|m| m["animations"][0]["channels"][0]["target"]["node"] = json!(9),
    );
    refused(
        &["sampler 0: accessor 0: its elements have 3 components, not 1"],
        0,
        &|m| sampler(m, "input", json!(0)),
    );
    refused(&["sampler 0: accessor 99 is not there"], 0, &|m| {
        sampler(m, "output", json!(99))
    });
    refused(&["sampler 0: its interpolation is unknown"], 0, &|m| {
        sampler(m, "interpolation", json!("JUMP"))
    });
    refused(
        &["sampler 0: has 2 values for 6 rows of keyframes"],
        0,
        &|m| sampler(m, "interpolation", json!("CUBICSPLINE")),
    );
    refused(
        &["sampler 0: the times of its keyframes do not ascend"],
        0,
        &|m| {
            let input = add_accessor(m, &floats(&[3.0, 1.0]), FLOAT, 2, "SCALAR");
            sampler(m, "input", json!(input));
        },
    );
    refused(&["sampler 0: has no keyframes"], 0, &|m| {
        m["accessors"][1]["count"] = json!(0)
    });
    refused(&["animation 0 \"go\": missing field `target`"], 0, &|m| {
        m["animations"][0]["channels"] = json!([{"sampler": 0}])
    });
    refused(&["rotation has no direction"], 0, &|m| {
        let zeros = add_accessor(m, &[0; 32], FLOAT, 2, "VEC4");
        sampler(m, "output", json!(zeros));
        m["animations"][0]["channels"][0]["target"]["path"] = json!("rotation");
    });
    let mut m = animated("pointer", "LINEAR", &[5.0; 6], "VEC3");
    m["animations"][0]["channels"][0]["target"]
        .as_object_mut()
        .expect("there")
        .remove("node");
    assert!(has_note(
        &at(&m, 2.0),
        "channel 0: left out: it moves no node"
    ));
}

#[test]
fn of_several_files_those_with_animations_move() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let write = |name: &str, m: &Value| {
        let path = folder.path().join(name);
        std::fs::write(&path, m.to_string()).expect("written");
        path
    };
    let still = write("still.gltf", &triangle());
    let moving = write(
        "moving.gltf",
        &animated("translation", "LINEAR", &[5.0; 6], "VEC3"),
    );
    let scene = load_with(&[still.clone(), moving], &options(0, 2.0)).expect("loads");
    let x: Vec<f64> = scene
        .instances
        .iter()
        .map(|i| i.world_from_object.translation.x)
        .collect();
    assert_eq!(x, [0.0, 5.0]);
    let error = load_with(&[still], &options(1, 0.0))
        .expect_err("none")
        .to_string();
    assert!(
        error.ends_with("still.gltf: animation 1: is not there: the file has none"),
        "{error}"
    );
}

#[test]
fn moments_beside_have_the_same_triangles_also_where_they_are_squashed() {
    // At 3 s the morph target has taken all vertices to one place.
    let mut m = animated("weights", "LINEAR", &[0.0, 1.0], "SCALAR");
    let squashed = [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -2.0, 0.0];
    let target = add_accessor(&mut m, &floats(&squashed), FLOAT, 3, "VEC3");
    m["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": target}]);
    m["images"] = json!([{"uri": format!("data:image/png;base64,{PNG}")}]);
    m["textures"] = json!([{"source": 0}]);
    m["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    m["meshes"][0]["primitives"][0]["material"] = json!(0);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.gltf");
    std::fs::write(&file, m.to_string()).unwrap();
    let moment = Moment {
        animation: 0,
        seconds: 2.0,
    };
    let files = [file];
    let load = |limit| {
        let options = ImportOptions {
            memory_limit: limit,
            ..ImportOptions::default()
        };
        load_with_neighbors(&files, &options, moment, 1.0)
    };
    let (now, [before, after]) = load(None).expect("loads");
    for (scene, x) in [(&before, 1.0), (&now, 0.5), (&after, 0.0)] {
        assert_eq!(scene.meshes[0].positions[1], Vec3::new(x, 0.0, 3.0));
    }
    for scene in [&before, &after] {
        assert_eq!(scene.meshes[0].triangles, now.meshes[0].triangles);
        assert!(scene.images.is_empty() && scene.defects.is_empty());
        assert!(scene.materials[0].base_color_texture.is_none());
    }
    assert_eq!(now.images.len(), 1);
    // One limit for all: what is enough for the first alone is not enough.
    let alone = |limit| {
        let options = ImportOptions {
            moment: Some(moment),
            memory_limit: Some(limit),
            ..ImportOptions::default()
        };
        load_with(&files, &options).is_ok()
    };
    let enough = (0..24).map(|bits| 1 << bits).find(|&limit| alone(limit));
    assert!(load(enough).is_err_and(|e| e.to_string().contains("memory")));
}
