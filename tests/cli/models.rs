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

#[test]
fn models_beyond_the_memory_limit_are_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let objects = model("lecture-objects.gltf");
    for command in ["render", "inspect", "compare", "ladder"] {
        let ran = bspray(
            folder.path(),
            &[command, &objects, "--memory-limit", "10KiB"],
        );
        assert_eq!(ran.code, Some(1), "{command}: {ran:?}");
        assert_eq!(ran.stderr.lines().count(), 1, "{command}: {ran:?}");
        assert!(
            ran.stderr
                .contains("lecture-objects.gltf: file: would take"),
            "{ran:?}"
        );
        assert!(
            ran.stderr.contains("--memory-limit raises the limit"),
            "{ran:?}"
        );
    }
    let ran = bspray(
        folder.path(),
        &["inspect", &objects, "--memory-limit", "1GiB"],
    );
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let ran = bspray(
        folder.path(),
        &["inspect", &objects, "--memory-limit", "much"],
    );
    assert_eq!(ran.code, Some(2), "{ran:?}");
}

/// The program in an address space of 2 GiB: an allocation beyond ends it.
#[cfg(target_os = "linux")]
#[test]
fn what_is_charged_is_what_is_allocated() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("written");
    };
    let json = |nodes: &str, scene: &str, rest: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[{scene}0]}}],"nodes":[{nodes}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}},{{"primitives":[{{"attributes":{{"POSITION":1}}}}]}}],{rest}
            "buffers":[{{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],
            "accessors":[{{"componentType":5126,"count":1048576,"type":"VEC3"}},
                {{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}]}}"#
        )
    };
    let instances =
        r#"{"mesh":1,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}}"#;
    write("instances.gltf", &json(instances, "", ""));
    let skinned = r#"{"mesh":0,"skin":0},"#.repeat(99) + r#"{"mesh":0,"skin":0}"#;
    let scene: String = (1..100).map(|n| format!("{n},")).collect();
    write(
        "skins.gltf",
        &json(&skinned, &scene, r#""skins":[{"joints":[0]}],"#),
    );
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    write(
        "objects.obj",
        &format!("{corners}{}", "o\nf 1 2 3\n".repeat(1 << 20)),
    );
    write(
        "corners.obj",
        &format!("{corners}f {}\n", "1 2 3 ".repeat(4 << 20)),
    );
    for name in ["instances.gltf", "skins.gltf", "objects.obj", "corners.obj"] {
        let program = assert_cmd::cargo::cargo_bin!("bspray");
        let output = std::process::Command::new("sh")
            .current_dir(folder.path())
            .env("MALLOC_ARENA_MAX", "2")
            .env("RAYON_NUM_THREADS", "2")
            .args([
                "-c",
                r#"ulimit -v 2097152; exec "$0" inspect "$1" --memory-limit 256MiB"#,
            ])
            .arg(program)
            .arg(name)
            .output()
            .expect("the program starts");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(1), "{name}: {stderr}");
        assert!(
            stderr.contains("--memory-limit raises the limit"),
            "{name}: {stderr}"
        );
    }
}
