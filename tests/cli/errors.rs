//! What cannot be done is told in one line that names file, element and cause, and leaves nothing behind.

use std::fs;
use std::path::Path;

use super::run::{TINY, bspray, model, names, render};

/// Words that the program must say of a malformed model, on standard error of `render`. Files without a row here must
/// still be named with an element and a cause.
const MALFORMED: &[(&str, &str)] = &[
    ("cyclic-nodes.gltf", "hangs from itself"),
    ("degenerate-triangle.obj", "triangle without area"),
    ("empty-mesh.gltf", "no triangles"),
    ("empty.obj", "is empty"),
    ("huge-claim.glb", "claims 4294967295 bytes"),
    ("huge-coordinate.obj", "beyond 1e18"),
    ("index-out-of-range.gltf", "names vertex"),
    ("index-out-of-range.obj", "face names vertex"),
    ("malformed-number.obj", "no number"),
    ("missing-buffer.gltf", "cannot read"),
    ("missing-mtl.obj", "is not there"),
    ("missing-texture.obj", "is not there"),
    ("nan-vertex.obj", "not a finite number"),
    ("no-faces.obj", "no faces"),
    ("no-such-normal.obj", "normal that is not there"),
    ("repeated-corner.obj", "three different corners"),
    ("required-extension.gltf", "KHR_gaussian_splatting"),
    ("truncated.glb", "truncated"),
    ("zero-index.obj", "vertex 0"),
];

#[test]
fn malformed_models_are_named_with_element_and_cause() {
    let mut checked = 0;
    for name in names(Path::new(&model("malformed"))) {
        let path = Path::new(&name);
        let is_model = |e: &str| path.extension().is_some_and(|x| x == e);
        if !["obj", "gltf", "glb"].into_iter().any(is_model) {
            continue;
        }
        checked += 1;
        let folder = tempfile::tempdir().unwrap();
        let ran = render(folder.path(), &format!("malformed/{name}"), &[]);
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let told: Vec<&str> = ran
            .stderr
            .lines()
            .filter(|line| line.contains(&format!("malformed/{stem}.")))
            .collect();
        match ran.code {
            Some(1) => {
                assert_eq!(ran.stderr.lines().count(), 1, "{name}: {ran:?}");
                assert!(ran.stderr.starts_with("error: "), "{name}: {ran:?}");
                assert!(
                    names(folder.path()).is_empty(),
                    "{name}: a picture of nothing"
                );
            }
            // The sound part is rendered, and what was wrong is told.
            Some(0) => assert_eq!(names(folder.path()), [format!("{stem}.png")], "{name}"),
            code => panic!("{name}: exit code {code:?}: {ran:?}"),
        }
        // `error: FILE: ELEMENT: CAUSE`, and the same behind `dropped:` and `note:`.
        assert!(
            told.iter().any(|line| line.split(": ").count() >= 4),
            "{name}: {ran:?}"
        );
        assert!(ran.stdout.is_empty(), "{name}: {ran:?}");
        if let Some((_, words)) = MALFORMED.iter().find(|(n, _)| *n == name) {
            assert!(
                told.iter().any(|line| line.contains(words)),
                "{name}: want {words:?}: {ran:?}"
            );
        }
    }
    assert!(checked >= 3, "only {checked} malformed models");
}

/// Arguments of a failing run, in a folder with the empty files `empty.obj`, `empty.glb`, the text file `model.xyz` and the
/// folders `folder` and `taken.png`, and words that its one line must have.
const FAILURES: &[(&[&str], &[&str])] = &[
    (&["inspect", "no.obj"], &["no.obj: ", "No such file"]),
    (&["render", "no.gltf"], &["no.gltf: ", "No such file"]),
    (&["render", "BLOCK", "no.obj"], &["no.obj: "]),
    (&["inspect", "folder"], &["folder: ", "directory"]),
    (&["render", "folder"], &["folder: ", "directory"]),
    (&["inspect", "empty.obj"], &["empty.obj: ", "is empty"]),
    (&["inspect", "empty.glb"], &["empty.glb: ", "is empty"]),
    (
        &["inspect", "model.xyz"],
        &["model.xyz: ", "OBJ, glTF, GLB"],
    ),
    (
        &["render", "BLOCK", "-o", "no/such.exr"],
        &["no/such.exr: ", "no folder no"],
    ),
    (
        &["render", "BLOCK", "-o", "taken.png"],
        &["taken.png: ", "is a directory"],
    ),
    (
        &["render", "BLOCK", "--camera-index", "0"],
        &["--camera-index 0", "no camera"],
    ),
    (
        &["render", "OBJECTS", "--camera-index", "back"],
        &["--camera-index back", "0 \"front\", 1 \"drawing\""],
    ),
    (
        &[
            "render",
            "BLOCK",
            "--camera-position",
            "1,2,3",
            "--camera-focal-point",
            "1,2,3",
        ],
        &["the camera sees nothing"],
    ),
];

/// The same for arguments that make no sense together or for the picture.
const MISUSES: &[(&[&str], &[&str])] = &[
    (
        &["render", "BLOCK", "-o", "a.tiff"],
        &["a.tiff: ", ".png, .jpg, .jpeg and .exr"],
    ),
    (&["render", "BLOCK", "-o", "name"], &["name: ", ".png"]),
    // The first output is good, and must not be written for all that.
    (
        &["render", "BLOCK", "-o", "good.png", "-o", "a.gif"],
        &["a.gif: "],
    ),
    (
        &["render", "BLOCK", "--pixel", "8,0"],
        &["--pixel 8,0", "8x6"],
    ),
    (
        &["render", "BLOCK", "--pixel", "0,6"],
        &["--pixel 0,6", "8x6"],
    ),
    (
        &["render", "BLOCK", "--pixelbounds", "0,9,0,6"],
        &["--pixelbounds", "8x6"],
    ),
    (
        &["render", "BLOCK", "-o", "a.png", "-o", "a.png"],
        &["a.png: ", "twice"],
    ),
    (
        &["render", "BLOCK", "-o", "a.png", "--pixel", "0,0"],
        &["--pixel", "--output"],
    ),
    (
        &["render", "textured.obj"],
        &["textured.png: would replace an input"],
    ),
    (
        &["render", "BLOCK", "--resolution=65536x65536"],
        &["4294967296 pixels", "--pixelbounds"],
    ),
];

fn folder_for_failures() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["empty.obj", "empty.glb"] {
        fs::write(path(name), "").expect("a file");
    }
    fs::write(path("model.xyz"), "0 0 0\n").expect("a file");
    let textured = "mtllib textured.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    fs::write(path("textured.obj"), textured).expect("a file");
    fs::write(path("textured.mtl"), "newmtl m\nmap_Kd textured.png\n").expect("a file");
    fs::write(path("textured.png"), "an image, or not").expect("a file");
    for name in ["folder", "taken.png"] {
        fs::create_dir(path(name)).expect("a folder");
    }
    folder
}

fn with_models(args: &[&str]) -> Vec<String> {
    let mut args: Vec<String> = args
        .iter()
        .map(|arg| match *arg {
            "BLOCK" => model("lecture-block.obj"),
            "OBJECTS" => model("lecture-objects.gltf"),
            other => other.to_owned(),
        })
        .collect();
    let is_sized = args.iter().any(|a| a.starts_with("--resolution"));
    if args.first().is_some_and(|a| a == "render") && !is_sized {
        args.extend(TINY.map(str::to_owned));
    }
    args
}

#[test]
fn what_cannot_be_done_is_one_line_and_leaves_nothing() {
    let folder = folder_for_failures();
    let before = names(folder.path());
    let coded = |list: &'static [(_, _)], code: i32| list.iter().map(move |case| (case, code));
    for ((args, words), code) in coded(FAILURES, 1).chain(coded(MISUSES, 2)) {
        let ran = bspray(folder.path(), &with_models(args));
        assert_eq!(ran.code, Some(code), "{args:?}: {ran:?}");
        assert_eq!(ran.stderr.lines().count(), 1, "{args:?}: {ran:?}");
        assert!(ran.stderr.starts_with("error: "), "{args:?}: {ran:?}");
        for word in *words {
            assert!(
                ran.stderr.contains(word),
                "{args:?}: want {word:?}: {ran:?}"
            );
        }
        assert!(ran.stdout.is_empty(), "{args:?}: {ran:?}");
        assert_eq!(names(folder.path()), before, "{args:?}");
    }
}

#[test]
fn a_cause_is_told_once() {
    let folder = folder_for_failures();
    for args in [
        &["inspect", "no.obj"][..],
        &["render", "BLOCK", "-o", "taken.png"],
    ] {
        let ran = bspray(folder.path(), &with_models(args));
        let cause = ran.stderr.trim_end().rsplit(": ").next().unwrap();
        assert_eq!(ran.stderr.matches(cause).count(), 1, "{ran:?}");
    }
}

#[test]
fn a_failure_keeps_the_picture_that_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("kept.png");
    fs::write(&picture, "of yesterday").unwrap();
    let args = ["-o", "kept.png", "--camera-index", "7"];
    assert_eq!(
        render(folder.path(), "lecture-block.obj", &args).code,
        Some(1)
    );
    assert_eq!(fs::read(&picture).unwrap(), b"of yesterday");
}

/// Wrong usage, and the argument that the message must name.
const USAGE: &[(&[&str], &str)] = &[
    (&[], "Usage"),
    (&["paint", "BLOCK"], "paint"),
    (&["render"], "<MODEL>"),
    (&["inspect"], "<MODEL>"),
    (&["completions", "cmd.exe"], "cmd.exe"),
    (&["render", "BLOCK", "--no-such"], "--no-such"),
    (&["render", "BLOCK", "--resolution=0x5"], "--resolution"),
    (&["render", "BLOCK", "--resolution=70000x5"], "--resolution"),
    (&["render", "BLOCK", "--spp=0"], "--spp"),
    (&["render", "BLOCK", "--spp=-1"], "--spp"),
    (&["render", "BLOCK", "--seed=x"], "--seed"),
    (&["render", "BLOCK", "--threads=100000"], "--threads"),
    (
        &["render", "BLOCK", "--accel=octree"],
        "bvh2, cwbvh, extents, linear",
    ),
    (
        &["render", "BLOCK", "--integrator=bidirectional"],
        "--integrator",
    ),
    (&["render", "BLOCK", "--ao-distance=0"], "--ao-distance"),
    (&["render", "BLOCK", "--filter=gauss"], "--filter"),
    (&["render", "BLOCK", "--tonemap=filmic"], "--tonemap"),
    (&["render", "BLOCK", "--exposure=nan"], "--exposure"),
    (&["render", "BLOCK", "--exposure=inf"], "--exposure"),
    (&["render", "BLOCK", "--pixel=-1,0"], "--pixel"),
    (
        &["render", "BLOCK", "--pixelbounds=4,4,0,6"],
        "--pixelbounds",
    ),
    (
        &["render", "BLOCK", "--cropwindow=0,1.1,0,1"],
        "--cropwindow",
    ),
    (
        &[
            "render",
            "BLOCK",
            "--cropwindow=0,1,0,1",
            "--pixelbounds=0,1,0,1",
        ],
        "--pixelbounds",
    ),
    (
        &["render", "BLOCK", "--camera-position=1,2"],
        "--camera-position",
    ),
    (
        &["render", "BLOCK", "--camera-position=1,2,nan"],
        "--camera-position",
    ),
    (
        &["render", "BLOCK", "--camera-direction=0,0,0"],
        "--camera-direction",
    ),
    (
        &["render", "BLOCK", "--camera-view-angle=180"],
        "--camera-view-angle",
    ),
    (
        &[
            "render",
            "OBJECTS",
            "--camera-index=0",
            "--camera-view-angle=20",
        ],
        "--camera-index",
    ),
    (&["render", "BLOCK", "--up=Q"], "--up"),
];

#[test]
fn wrong_usage_is_told_apart_from_failure() {
    let folder = tempfile::tempdir().unwrap();
    for (args, words) in USAGE {
        let ran = bspray(folder.path(), &with_models(args));
        assert_eq!(ran.code, Some(2), "{args:?}: {ran:?}");
        assert!(ran.stderr.contains(words), "{args:?}: {ran:?}");
        assert!(ran.stdout.is_empty(), "{args:?}: {ran:?}");
        assert!(names(folder.path()).is_empty(), "{args:?}");
    }
}
