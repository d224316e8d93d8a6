//! The camera that is printed makes the same picture again, bit for bit.

use std::path::Path;

use bspray::picture::{Channel, exr};

use super::run::{bspray, model, render};

/// The layers that `args` give for a model, and the camera that was printed.
fn picture(folder: &Path, path: &str, args: &[&str]) -> (Vec<Channel>, Vec<String>) {
    let all = [
        &[
            "render",
            path,
            "--resolution=24x17",
            "--spp=2",
            "-o",
            "camera.exr",
        ],
        args,
    ]
    .concat();
    let ran = bspray(folder, &all);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let flags = ran
        .stderr
        .lines()
        .find_map(|l| l.strip_prefix("camera: "))
        .expect("the camera is printed")
        .split(' ')
        .map(str::to_owned)
        .collect();
    let file = folder.join("camera.exr");
    let channels = exr::read(&file).expect("an EXR file").channels;
    std::fs::remove_file(file).expect("it was there");
    (channels, flags)
}

#[test]
fn printed_flags_give_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    for (name, args) in [
        ("lecture-objects.gltf", &[][..]),
        ("lecture-objects.gltf", &["--camera-index", "drawing"]),
        ("lecture-objects.gltf", &["--camera-index", "auto"]),
        ("lecture-objects.gltf", &["--projection", "orthographic"]),
        ("lecture-objects.gltf", &["--projection", "panoramic"]),
        (
            "lecture-objects.gltf",
            &["--aperture", "0.3", "--focus-distance", "7.1"],
        ),
        ("cornell-box.obj", &[]),
        ("lecture-block.obj", &["--up", "-z"]),
        ("lecture-block.obj", &["--camera-direction", "-0.3,-1,0.1"]),
        (
            "lecture-block.obj",
            &[
                "--camera-position",
                "-1.1,0.7,2.3",
                "--camera-view-angle",
                "61.7",
            ],
        ),
    ] {
        let path = model(name);
        let (first, flags) = picture(folder.path(), &path, args);
        let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
        let (second, again) = picture(folder.path(), &path, &flags);
        assert_eq!(flags, again, "{name} {args:?}");
        assert!(first == second, "{name} {args:?}: another picture");
        let other = picture(folder.path(), &path, &["--camera-direction", "0.3,0.2,-1"]);
        assert!(first != other.0, "{name} {args:?}: every camera gives this");
    }
}

#[test]
fn cameras_are_chosen_by_number_and_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = model("lecture-objects.gltf");
    let of = |index: &str| picture(folder.path(), &path, &["--camera-index", index]).0;
    assert!(of("1") == of("drawing") && of("0") == of("front"));
    assert!(of("0") == picture(folder.path(), &path, &[]).0 && of("0") != of("1"));
}

/// Two parallel cameras of one name, as two exporters make them of "Camera".
const TWINS: &str = r#"{
"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
"nodes": [
  {"mesh": 0},
  {"name": "my \"$HOME\"", "camera": 0, "translation": [0.3, 0.3, 2]},
  {"name": "my \"$HOME\"", "camera": 0, "translation": [0.6, 0.2, 2]}
],
"cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]
}"#;

#[test]
fn cameras_of_one_name_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("twins.gltf"), TWINS).unwrap();
    let of = |index: &str| picture(folder.path(), "twins.gltf", &["--camera-index", index]);
    let (second, flags) = of("1");
    let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
    assert!(of("0").0 != second);
    assert!(
        picture(folder.path(), "twins.gltf", &flags).0 == second,
        "{flags:?}"
    );
}

#[test]
fn a_file_camera_and_wishes_do_not_mix() {
    let folder = tempfile::tempdir().unwrap();
    // A wish makes a camera of our own, also where the file has one.
    let wished = render(
        folder.path(),
        "lecture-objects.gltf",
        &["--camera-view-angle", "20", "-o", "a.png"],
    );
    assert!(
        wished.stderr.contains("--camera-view-angle 20\n"),
        "{wished:?}"
    );
    assert!(
        !wished.stderr.contains("--camera-position 0.6,3,9.2"),
        "{wished:?}"
    );
}
