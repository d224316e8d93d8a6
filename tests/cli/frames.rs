//! Turntables: their frames, names and reports.

use serde_json::Value;

use super::run::{names, picture, render};

#[test]
fn a_turntable_writes_its_frames_and_the_first_is_the_plain_picture() {
    let folder = tempfile::tempdir().unwrap();
    let args = [
        "--turntable",
        "12",
        "--frames",
        "1-4:3,2",
        "-o",
        "f{frame:3}.png",
        "--json",
    ];
    let ran = render(folder.path(), "lecture-objects.gltf", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert_eq!(names(folder.path()), ["f001.png", "f002.png", "f004.png"]);
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("f001.png"), picture(&[]));
    let report: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
    let frames = report["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 3);
    // The report's arguments give the picture again, with another structure, whose extents know one camera each.
    let flags = frames[1]["camera"].as_str().unwrap();
    assert!(flags.ends_with(" --turntable 12 --frames 4"), "{flags}");
    let again = tempfile::tempdir().unwrap();
    let args: Vec<&str> = flags
        .split(' ')
        .chain(["--accel", "extents", "-o", "{frame}.png"])
        .collect();
    let ran = render(again.path(), "lecture-objects.gltf", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert_eq!(
        std::fs::read(again.path().join("4.png")).unwrap(),
        read("f004.png")
    );
    assert_ne!(read("f002.png"), read("f004.png"));
}

#[test]
fn extents_are_made_for_the_camera_of_each_frame() {
    let frames = |more: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        let args = [&["--turntable", "4", "--integrator", "normals"], more].concat();
        let ran = render(folder.path(), "lecture-objects.gltf", &args);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let expected = [1, 2, 3, 4].map(|n| format!("lecture-objects.000{n}.png"));
        assert_eq!(names(folder.path()), expected);
        expected.map(|name| std::fs::read(folder.path().join(name)).unwrap())
    };
    assert!(frames(&[]) == frames(&["--accel", "extents", "--extents", "screen"]));
}

#[test]
fn turntables_that_make_no_sense_are_refused_in_one_line_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &str); 7] = [
        (
            &["--turntable", "3", "-o", "a.png"],
            "a.png: one file for all frames",
        ),
        (
            &["-o", "a{frame}.png"],
            "a{frame}.png: only the frames of a --turntable",
        ),
        (
            &["--turntable", "3", "--frames", "2-5"],
            "--frames: there is no frame 4 of 3",
        ),
        (
            &["--turntable", "3", "--frames", "3-1"],
            "want frames such as",
        ),
        (&["--frames", "1"], "--turntable"),
        (&["--turntable", "0"], "--turntable"),
        (
            &["--turntable", "3", "--pixel", "1,1"],
            "--pixel reports on one picture",
        ),
    ];
    for (args, words) in cases {
        let ran = render(folder.path(), "lecture-block.obj", args);
        assert_eq!(ran.code, Some(2), "{args:?}: {ran:?}");
        assert!(ran.stderr.contains(words), "{args:?}: {}", ran.stderr);
        assert!(names(folder.path()).is_empty(), "{args:?}");
    }
    let args = ["--turntable", "3", "--frames", "2", "--pixel", "1,1"];
    let ran = render(folder.path(), "lecture-block.obj", &args);
    assert!(ran.code == Some(0) && !ran.stdout.is_empty(), "{ran:?}");
}
