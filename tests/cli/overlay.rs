//! Extents and edges over a picture: layers, crops, every integrator, notes, and what is refused.

use std::fs;

use bspray::picture::{Picture, Samples, exr};
use bspray::render::Overlay;

use super::run::{bspray, model, names, picture, render};

/// A picture as EXR, and what was said.
fn layers(args: &[&str]) -> (Picture, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let all = [&["-o", "a.exr"], args].concat();
    let ran = render(folder.path(), "lecture-objects.gltf", &all);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let picture = exr::read(&folder.path().join("a.exr")).expect("an EXR file");
    (picture, ran.stderr)
}

fn halves<'a>(picture: &'a Picture, name: &str) -> &'a [f32] {
    match picture.channel(name) {
        Some(Samples::F16(values)) => values,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn an_overlay_is_a_layer_beside_an_untouched_beauty() {
    let (plain, words) = layers(&[]);
    assert!(!words.contains("overlay"));
    for overlay in ["extents", "edges", "extents,edges", "edges,extents"] {
        let (drawn, words) = layers(&["--overlay", overlay]);
        let is_own = |name: &str| Overlay::CHANNELS.contains(&name);
        let (own, others): (Vec<_>, Vec<_>) = drawn.channels.iter().partition(|c| is_own(&c.name));
        assert_eq!(own.len(), 4);
        assert!(others.into_iter().eq(&plain.channels), "{overlay}");
        let alpha = halves(&drawn, "overlay.A");
        assert!(alpha.iter().any(|a| *a > 0.3), "{overlay}");
        for name in ["overlay.R", "overlay.G", "overlay.B"] {
            let values = halves(&drawn, name).iter().zip(alpha);
            assert!(values.into_iter().all(|(c, a)| c <= a), "{overlay} {name}");
        }
        let note = "overlay: extents of 14 objects, 14 of them in the picture, ";
        assert_eq!(words.contains(note), overlay.contains("extents"), "{words}");
    }
    let both = layers(&["--overlay", "extents,edges"]).0;
    assert_eq!(
        both.channels,
        layers(&["--overlay=edges", "--overlay=extents"]).0.channels
    );
}

#[test]
fn every_integrator_can_be_drawn_over_and_nothing_else_changes() {
    for integrator in [
        "path",
        "whitted",
        "direct",
        "ao",
        "normals",
        "facing",
        "albedo",
        "uv",
        "id",
        "cost",
        "fragment",
        "bsp-depth",
    ] {
        let args = ["--integrator", integrator];
        let plain = picture(&args);
        assert!(
            plain != picture(&["--overlay=edges", args[0], args[1]]),
            "{integrator}"
        );
        let threads =
            |n: &str| picture(&["--overlay=extents,edges", "--threads", n, args[0], args[1]]);
        assert!(threads("1") == threads("3"), "{integrator}");
    }
}

#[test]
fn a_crop_shows_a_part_of_the_same_drawing() {
    let all = [
        "--overlay=extents,edges",
        "--resolution=160x120",
        "--spp=1",
        "-q",
    ];
    let folder = tempfile::tempdir().unwrap();
    let objects = model("lecture-objects.gltf");
    let picture = |name: &str, crop: &[&str]| {
        let args = [&["render", &objects, "-o", name][..], &all, crop].concat();
        let ran = bspray(folder.path(), &args);
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
        exr::read(&folder.path().join(name)).unwrap()
    };
    let whole = picture("whole.exr", &[]);
    let crop = picture("crop.exr", &["--pixelbounds=21,90,13,75"]);
    for name in Overlay::CHANNELS {
        let rows = halves(&whole, name).chunks(160).skip(13).take(62);
        let cut: Vec<f32> = rows.flat_map(|row| &row[21..90]).copied().collect();
        assert!(halves(&crop, name) == cut, "{name}");
    }
}

#[test]
fn the_sphere_that_was_asked_for_is_drawn_under_any_structure() {
    let folder = tempfile::tempdir().unwrap();
    // Vertices that crowd at one end, where they pull the centroid.
    let text = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0.1 0.1 0\nv 3 2 0\nf 1 2 3\nf 2 4 3\nf 2 5 4\n";
    fs::write(folder.path().join("crowd.obj"), text).unwrap();
    let picture = |more: &[&str]| {
        let args = ["render", "crowd.obj", "--overlay=extents", "--spp=1"];
        let args = [&args[..], &["--resolution=160x120", "-o", "a.png"], more].concat();
        assert_eq!(bspray(folder.path(), &args).code, Some(0), "{more:?}");
        fs::read(folder.path().join("a.png")).unwrap()
    };
    let smallest = picture(&[]);
    assert!(smallest != picture(&["--extent-sphere=centroid"]));
    assert!(smallest == picture(&["--accel=extents"]));
    let both = picture(&["--accel=extents", "--extent-sphere=centroid"]);
    assert!(both == picture(&["--extent-sphere=centroid"]));
}

#[test]
fn names_beyond_ascii_and_pictures_of_one_pixel_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n";
    let text =
        format!("o K\u{f6}rper \u{6905}\u{5b50}\u{301} with a name that has no end\n{triangle}");
    fs::write(folder.path().join("names.obj"), text).unwrap();
    for size in ["1x1", "7x500", "300x200"] {
        let args = [
            "render",
            "names.obj",
            "--overlay=extents,edges",
            "--spp=1",
            "--resolution",
            size,
            "-o",
            "a.png",
            "-o",
            "a.jpg",
        ];
        let ran = bspray(folder.path(), &args);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let note = ran.stderr.lines().find(|l| l.starts_with("overlay: "));
        let is_named = note.is_some_and(|n| n.ends_with("1 of them in the picture, all named"));
        assert_eq!(is_named, size == "300x200", "{ran:?}");
    }
}

#[test]
fn senseless_overlays_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for value in ["boxes", "extents,boxes", ""] {
        let ran = render(folder.path(), "lecture-block.obj", &["--overlay", value]);
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stderr.contains("extents, edges"), "{ran:?}");
    }
    let args = ["--overlay=edges", "--pixel=1,2"];
    let ran = render(folder.path(), "lecture-block.obj", &args);
    let want = "error: --pixel prints a report and writes no picture: leave --overlay out\n";
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(2), want));
    // A sphere that is neither drawn nor tested.
    let args = ["--overlay=edges", "--extent-sphere=centroid"];
    let ran = render(folder.path(), "lecture-block.obj", &args);
    assert_eq!(ran.code, Some(2), "{ran:?}");
    assert!(names(folder.path()).is_empty());
}
