//! Options of what to show of models: every command that loads has them.

use super::run::{bspray, model};

#[test]
fn moments_and_variants_that_are_not_there_are_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let objects = model("lecture-objects.gltf");
    for command in ["render", "inspect", "compare", "ladder"] {
        for (options, code, words) in [
            (&["--animation-time", "1"][..], 2, "add --animation-index N"),
            (
                &["--animation-index", "3", "--animation-time", "-0.5"],
                1,
                "animation 3: is not there: the file has none",
            ),
            (
                &["--variant", "red"],
                1,
                "variant \"red\": is not there: the file has none",
            ),
        ] {
            let ran = bspray(folder.path(), &[&[command, &objects], options].concat());
            assert_eq!(ran.code, Some(code), "{command}: {ran:?}");
            assert_eq!(ran.stderr.lines().count(), 1, "{command}: {ran:?}");
            assert!(
                ran.stderr.to_lowercase().contains(&words.to_lowercase()),
                "{command}: {ran:?}"
            );
        }
    }
}

#[test]
fn a_moment_poses_what_is_rendered() {
    let folder = tempfile::tempdir().expect("a folder");
    // A triangle that goes from x = 0 to x = 8 in two seconds, in one buffer.
    let floats = [
        0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 8.0, 0.0, 0.0,
    ];
    let bytes: Vec<u8> = floats.iter().flat_map(|f| f.to_le_bytes()).collect();
    std::fs::write(folder.path().join("a.bin"), bytes).expect("written");
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":68,"uri":"a.bin"}],
        "bufferViews":[{"buffer":0,"byteLength":68}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
            {"bufferView":0,"byteOffset":36,"componentType":5126,"count":2,"type":"SCALAR"},
            {"bufferView":0,"byteOffset":44,"componentType":5126,"count":2,"type":"VEC3"}],
        "animations":[{"samplers":[{"input":1,"output":2}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}]}"#;
    std::fs::write(folder.path().join("a.gltf"), json).expect("written");
    let args = [
        "inspect",
        "a.gltf",
        "--json",
        "--animation-index",
        "0",
        "--animation-time",
        "1.5",
    ];
    let ran = bspray(folder.path(), &args);
    let report: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    assert_eq!(
        report["bounds"]["min"],
        serde_json::json!([6.0, 0.0, 0.0]),
        "{ran:?}"
    );
}
