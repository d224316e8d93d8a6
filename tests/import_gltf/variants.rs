//! Variants of materials, and nodes that show their mesh many times.

use bspray::import::ImportOptions;
use glam::{DVec3, Vec4};
use serde_json::{Value, json};

use crate::model::*;

/// Two triangles: the first is grey, red in "rouge" and "sunset"; the second blue in "sunset".
fn varied() -> Value {
    let mut m = triangle();
    let color = |c: [f32; 4]| json!({"pbrMetallicRoughness": {"baseColorFactor": c}});
    m["materials"] = json!([
        color([0.5, 0.5, 0.5, 1.0]),
        color([1.0, 0.0, 0.0, 1.0]),
        color([0.0, 0.0, 1.0, 1.0]),
    ]);
    m["extensions"] =
        json!({"KHR_materials_variants": {"variants": [{"name": "rouge"}, {"name": "sunset"}]}});
    let mappings = |m: Value| json!({"KHR_materials_variants": {"mappings": m}});
    m["meshes"][0]["primitives"] = json!([
        {"attributes": {"POSITION": 0}, "material": 0, "extensions": mappings(json!([{"material": 1, "variants": [0, 1]}]))},
        {"attributes": {"POSITION": 0}, "material": 0, "extensions": mappings(json!([{"material": 2, "variants": [1]}]))},
    ]);
    m
}

fn wanting(variant: &str) -> ImportOptions {
    ImportOptions {
        variant: Some(variant.to_owned()),
        ..ImportOptions::default()
    }
}

#[test]
fn a_variant_gives_primitives_its_materials() {
    let colors = |options: &ImportOptions| {
        let scene = load_model_with(&varied(), options).expect("loads");
        [0, 1].map(|t| {
            scene.materials[scene.material_of(0, t) as usize]
                .base_color
                .truncate()
        })
    };
    let [grey, red, blue] =
        [[0.5, 0.5, 0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(glam::Vec3::from);
    assert_eq!(colors(&ImportOptions::default()), [grey, grey]);
    assert_eq!(colors(&wanting("rouge")), [red, grey]);
    assert_eq!(colors(&wanting("sunset")), [red, blue]);
    let scene = load_model(&varied()).expect("loads");
    assert!(has_note(
        &scene,
        "variants: shown with its default materials; there are: \"rouge\", \"sunset\""
    ));
}

#[test]
fn variants_that_are_not_there_are_told_with_those_that_are() {
    let error = load_model_with(&varied(), &wanting("blue")).expect_err("none");
    expect_words(
        &error,
        &["variant \"blue\": is not there; there are: \"rouge\", \"sunset\""],
    );
    let error = load_model_with(&triangle(), &wanting("blue")).expect_err("none");
    expect_words(
        &error,
        &["variant \"blue\": is not there: the file has none"],
    );
    let mut broken = varied();
    broken["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"][0]["material"] =
        json!(7);
    let error = load_model_with(&broken, &wanting("rouge")).expect_err("no such material");
    expect_words(
        &error,
        &["mesh 0, primitive 0: material 7 is not there: the file has 3"],
    );
    load_model(&broken).expect("nobody asks for it");
}

/// The triangle under a node at (100, 0, 0), twice as large, which shows it with these attributes.
fn instanced(attributes: Value) -> Value {
    let mut m = triangle();
    m["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    m["nodes"][0] = json!({"mesh": 0, "translation": [100, 0, 0], "scale": [2, 2, 2],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}});
    m
}

#[test]
fn instances_move_turn_and_scale_below_their_node() {
    let mut m = instanced(Value::Null);
    let translations = add_accessor(
        &mut m,
        &floats(&[0.0, 0.0, 0.0, 5.0, 6.0, 7.0]),
        FLOAT,
        2,
        "VEC3",
    );
    // Nothing, and half a turn about z, in bytes.
    let rotations = add_accessor(&mut m, &[0, 0, 0, 127, 0, 0, 127, 0], BYTE, 2, "VEC4");
    m["accessors"][rotations]["normalized"] = json!(true);
    let scales = add_accessor(
        &mut m,
        &floats(&[1.0, 1.0, 1.0, 1.0, 3.0, 1.0]),
        FLOAT,
        2,
        "VEC3",
    );
    m["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
        json!({"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales, "_ID": 99});
    let scene = load_model(&m).expect("loads");
    let corner = |i: usize| {
        scene.instances[i]
            .world_from_object
            .transform_point3(DVec3::new(1.0, 2.0, 3.0))
    };
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    assert!((corner(0) - DVec3::new(102.0, 4.0, 6.0)).length() < 1e-9);
    // (1, 6, 3), (-1, -6, 3), (4, 0, 10), then the node.
    assert!(
        (corner(1) - DVec3::new(108.0, 0.0, 20.0)).length() < 1e-9,
        "{}",
        corner(1)
    );
    let color = scene.materials[0].base_color;
    assert_eq!(color, Vec4::ONE);
}

#[test]
fn broken_instances_are_named_and_bounded() {
    let refused = |attributes: Value, words: &[&str]| {
        let mut m = instanced(attributes);
        push(
            &mut m,
            "accessors",
            json!({"componentType": FLOAT, "count": 2, "type": "VEC3"}),
        );
        push(
            &mut m,
            "accessors",
            json!({"componentType": FLOAT, "count": 1 << 20, "type": "VEC3"}),
        );
        expect_words(&load_model(&m).expect_err("broken"), words);
        m
    };
    let element = "node 0, EXT_mesh_gpu_instancing: ";
    refused(
        json!({"TRANSLATION": 9}),
        &[element, "TRANSLATION: accessor 9 is not there"],
    );
    refused(
        json!({"ROTATION": 0}),
        &[
            element,
            "ROTATION: accessor 0: its elements have 3 components, not 4",
        ],
    );
    refused(
        json!({"SCALE": 0, "TRANSLATION": 1}),
        &[element, "its attributes place 2 and 3 instances"],
    );
    // A million instances for a few bytes, five times.
    let mut many = instanced(json!({"TRANSLATION": 1}));
    push(
        &mut many,
        "accessors",
        json!({"componentType": FLOAT, "count": 1 << 20, "type": "VEC3"}),
    );
    many["nodes"] = (0..5).map(|_| many["nodes"][0].clone()).collect();
    many["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4]);
    expect_words(
        &load_model(&many).expect_err("too many"),
        &["node 4: the file has more than 4194304 instances"],
    );
    let alone = load_model(&instanced(json!({"_ID": 0}))).expect("loads");
    assert_eq!(alone.instances.len(), 1);
    assert!(has_note(
        &alone,
        "places nothing anywhere: the mesh is shown once"
    ));
}
