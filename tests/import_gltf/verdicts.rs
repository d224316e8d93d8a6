//! Broken and odd files, judged by us and by the validator of Khronos, whose verdicts are recorded in `verdicts/khronos.txt`.
//!
//! Record them again with `BSPRAY_VERDICTS=/tmp/v cargo test --test import_gltf verdicts`, which writes the cases, and, in a folder
//! with the npm package `gltf-validator`, `node .../verdicts/record.mjs /tmp/v > .../verdicts/khronos.txt`.

mod changes;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use self::changes::*;
use crate::model::*;

/// What we make of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ours {
    /// It loads, without a word.
    Loads,
    /// It loads without the broken part, which a note or defect names.
    Notes,
    /// It does not load.
    Refuses,
}

/// A change of the triangle, by name, and our verdict.
type Case = (&'static str, fn(&mut Value), Ours);

/// Cases on which we and the validator differ, and why.
const DIFFER: &[(&str, &str)] = &[
    (
        "position-without-bounds",
        "many exporters leave them out, and nobody needs them",
    ),
    (
        "positions-of-bytes-unlisted",
        "KHR_mesh_quantization is used without being named: what is meant is clear",
    ),
    (
        "required-extension-unknown",
        "it is legal to require what we cannot read",
    ),
    (
        "texture-without-image",
        "legal, and yet there is nothing to show",
    ),
    (
        "normal-not-unit",
        "direction is all that counts: made unit without a word",
    ),
    ("no-scene", "legal: all nodes are shown, which a note tells"),
    (
        "broken-part-unused",
        "what the scene does not show is not looked at",
    ),
];

const CASES: &[Case] = &[
    ("sound", |_| {}, Ours::Loads),
    ("sound-indexed", |m| set_indices(m, &[0, 1, 2]), Ours::Loads),
    (
        "position-without-bounds",
        |m| {
            bounds(m).remove("min");
            bounds(m).remove("max");
        },
        Ours::Loads,
    ),
    (
        "accessor-not-there",
        |m| m["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(7),
        Ours::Refuses,
    ),
    (
        "accessor-beyond-its-view",
        |m| m["accessors"][0]["count"] = json!(4),
        Ours::Refuses,
    ),
    (
        "accessor-of-no-elements",
        |m| m["accessors"][0]["count"] = json!(0),
        Ours::Refuses,
    ),
    (
        "accessor-component-unknown",
        |m| m["accessors"][0]["componentType"] = json!(5130),
        Ours::Refuses,
    ),
    (
        "accessor-of-pairs",
        |m| m["accessors"][0]["type"] = json!("VEC2"),
        Ours::Refuses,
    ),
    (
        "view-not-there",
        |m| m["accessors"][0]["bufferView"] = json!(9),
        Ours::Refuses,
    ),
    (
        "view-beyond-its-buffer",
        |m| m["bufferViews"][0]["byteOffset"] = json!(40),
        Ours::Refuses,
    ),
    (
        "view-stride-too-small",
        |m| m["bufferViews"][0]["byteStride"] = json!(8),
        Ours::Refuses,
    ),
    (
        "buffer-not-there",
        |m| m["bufferViews"][0]["buffer"] = json!(9),
        Ours::Refuses,
    ),
    (
        "buffer-too-short",
        |m| m["buffers"][0]["byteLength"] = json!(48),
        Ours::Refuses,
    ),
    (
        "buffer-file-gone",
        |m| m["buffers"][0]["uri"] = json!("gone.bin"),
        Ours::Refuses,
    ),
    (
        "index-beyond-the-vertices",
        |m| set_indices(m, &[0, 1, 3]),
        Ours::Refuses,
    ),
    (
        "normals-too-few",
        |m| {
            set_attribute(
                m,
                "NORMAL",
                &floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
                FLOAT,
                2,
                "VEC3",
            );
        },
        Ours::Refuses,
    ),
    (
        "normal-not-unit",
        |m| {
            set_attribute(
                m,
                "NORMAL",
                &floats(&[0.0, 0.0, 9.0].repeat(3)),
                FLOAT,
                3,
                "VEC3",
            );
        },
        Ours::Loads,
    ),
    (
        "material-not-there",
        |m| m["meshes"][0]["primitives"][0]["material"] = json!(2),
        Ours::Refuses,
    ),
    (
        "mode-unknown",
        |m| m["meshes"][0]["primitives"][0]["mode"] = json!(9),
        Ours::Refuses,
    ),
    (
        "mesh-not-there",
        |m| m["nodes"][0]["mesh"] = json!(5),
        Ours::Refuses,
    ),
    (
        "node-not-there",
        |m| m["nodes"][0]["children"] = json!([8]),
        Ours::Refuses,
    ),
    (
        "node-below-itself",
        |m| m["nodes"][0]["children"] = json!([0]),
        Ours::Refuses,
    ),
    (
        "node-below-two",
        |m| {
            m["scenes"][0]["nodes"] = json!([0, 1]);
            m["nodes"] = json!([{"children": [2]}, {"children": [2]}, {"mesh": 0}]);
        },
        Ours::Refuses,
    ),
    (
        "node-with-matrix-of-a-projection",
        |m| m["nodes"][0]["matrix"] = json!([1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
        Ours::Notes,
    ),
    (
        "node-with-rotation-of-zero",
        |m| m["nodes"][0]["rotation"] = json!([0, 0, 0, 0]),
        Ours::Notes,
    ),
    (
        "no-scene",
        |m| {
            m.as_object_mut()
                .expect("there")
                .retain(|k, _| !k.starts_with("scene"));
        },
        Ours::Notes,
    ),
    ("scene-not-there", |m| m["scene"] = json!(4), Ours::Refuses),
    (
        "version-1",
        |m| m["asset"]["version"] = json!("1.0"),
        Ours::Refuses,
    ),
    (
        "required-extension-unknown",
        |m| {
            m["extensionsUsed"] = json!(["KHR_gaussian_splatting"]);
            m["extensionsRequired"] = json!(["KHR_gaussian_splatting"]);
        },
        Ours::Refuses,
    ),
    ("positions-of-bytes-unlisted", |m| quantise(m), Ours::Loads),
    (
        "positions-of-bytes",
        |m| {
            quantise(m);
            m["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
            m["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        },
        Ours::Loads,
    ),
    (
        "position-not-a-number",
        |m| {
            set_attribute(m, "POSITION", &floats(&[f32::NAN; 9]), FLOAT, 3, "VEC3");
        },
        Ours::Refuses,
    ),
    ("sparse-index-beyond", |m| sparse(m, &[0, 9]), Ours::Refuses),
    ("sparse", |m| sparse(m, &[0, 2]), Ours::Loads),
    (
        "image-file-gone",
        |m| textured(m, json!({"uri": "gone.png"})),
        Ours::Notes,
    ),
    (
        "image-of-no-known-kind",
        |m| {
            textured(
                m,
                json!({"uri": "data:image/png;base64,AAAAAAAAAAAAAAAAAAAA"}),
            )
        },
        Ours::Notes,
    ),
    (
        "image-view-not-there",
        |m| textured(m, json!({"bufferView": 77, "mimeType": "image/png"})),
        Ours::Notes,
    ),
    (
        "image",
        |m| textured(m, json!({"uri": format!("data:image/png;base64,{PNG}")})),
        Ours::Loads,
    ),
    (
        "texture-without-image",
        |m| {
            textured(m, json!({"uri": format!("data:image/png;base64,{PNG}")}));
            m["textures"] = json!([{}]);
        },
        Ours::Notes,
    ),
    (
        "texture-image-not-there",
        |m| {
            textured(m, json!({"uri": format!("data:image/png;base64,{PNG}")}));
            m["textures"] = json!([{"source": 50}]);
        },
        Ours::Notes,
    ),
    (
        "skin-not-there",
        |m| m["nodes"][0]["skin"] = json!(4),
        Ours::Refuses,
    ),
    (
        "skin-joint-not-there",
        |m| {
            skinned(m);
            m["skins"][0]["joints"] = json!([9]);
        },
        Ours::Refuses,
    ),
    (
        "skin-binds-too-few",
        |m| {
            skinned(m);
            m["skins"][0]["joints"] = json!([0, 1]);
            push(m, "nodes", json!({}));
            m["scenes"][0]["nodes"] = json!([0, 1]);
        },
        Ours::Refuses,
    ),
    (
        "skin-joint-index-beyond",
        |m| {
            skinned(m);
            set_attribute(
                m,
                "JOINTS_0",
                &[9, 0, 0, 0].repeat(3),
                UNSIGNED_BYTE,
                3,
                "VEC4",
            );
        },
        Ours::Refuses,
    ),
    ("skin", skinned, Ours::Loads),
    ("morph-target-too-short", |m| morphing(m, 2), Ours::Refuses),
    ("morph-target", |m| morphing(m, 3), Ours::Loads),
    (
        "broken-part-unused",
        |m| {
            push(
                m,
                "meshes",
                json!({"primitives": [{"attributes": {"POSITION": 99}}]}),
            );
        },
        Ours::Loads,
    ),
];

fn case(change: fn(&mut Value)) -> Value {
    let mut m = triangle();
    m["accessors"][0]["min"] = json!([0, 0, 3]);
    m["accessors"][0]["max"] = json!([1, 2, 3]);
    change(&mut m);
    m
}

/// The recorded errors of the validator by case: its codes, without warnings.
fn recorded() -> BTreeMap<String, String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/import_gltf/verdicts/khronos.txt");
    let text = std::fs::read_to_string(file).expect("a record");
    let rows = text.lines().filter_map(|l| l.split_once(':'));
    rows.map(|(name, codes)| (name.to_owned(), codes.trim().to_owned()))
        .collect()
}

#[test]
fn we_and_the_validator_agree() {
    if let Some(folder) = std::env::var_os("BSPRAY_VERDICTS").map(PathBuf::from) {
        std::fs::create_dir_all(&folder).expect("a folder");
        for &(name, change, _) in CASES {
            let text = format!("{:#}", case(change));
            std::fs::write(folder.join(format!("{name}.gltf")), text).expect("written");
        }
    }
    let recorded = recorded();
    let mut complaints = Vec::new();
    for &(name, change, expected) in CASES {
        let loaded = load_model(&case(change));
        let found = match &loaded {
            Ok(scene) if scene.notes.is_empty() && scene.defects.is_empty() => Ours::Loads,
            Ok(_) => Ours::Notes,
            Err(error) => {
                expect_words(error, &[]);
                Ours::Refuses
            }
        };
        if found != expected {
            complaints.push(format!(
                "{name}: {found:?}, not {expected:?}: {:?}",
                loaded.map(|s| s.notes)
            ));
        }
        let Some(codes) = recorded.get(name) else {
            complaints.push(format!("{name}: no record"));
            continue;
        };
        let agree = (found == Ours::Loads) == codes.is_empty();
        let may_differ = DIFFER.iter().any(|(n, _)| *n == name);
        if agree == may_differ {
            complaints.push(format!(
                "{name}: {found:?}, the validator {codes:?}, listed to differ: {may_differ}"
            ));
        }
    }
    for (name, _) in DIFFER {
        if !CASES.iter().any(|(n, ..)| n == name) {
            complaints.push(format!("{name}: listed to differ, but no case"));
        }
    }
    assert_eq!(recorded.len(), CASES.len(), "records of other cases");
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}
