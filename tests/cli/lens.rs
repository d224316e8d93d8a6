//! Lenses and projections, and renders that end by the clock.

use std::path::Path;

use bspray::picture::{Picture, Samples, exr};

use super::run::{bspray, model};

/// What the arguments make of `lecture-objects`, without counts of steps.
fn picture(folder: &Path, args: &[&str]) -> Picture {
    let path = model("lecture-objects.gltf");
    let first = ["render", &path, "-o", "a.exr", "--resolution=48x32"];
    let ran = bspray(folder, &[&first[..], args].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let mut picture = exr::read(&folder.join("a.exr")).expect("an EXR file");
    picture.channels.retain(|c| !c.name.starts_with("cost."));
    picture
}

#[test]
fn extents_give_the_picture_of_brute_force_through_a_lens_and_all_around() {
    let folder = tempfile::tempdir().unwrap();
    let panorama = ["--projection=panoramic", "--camera-position=0.3,1.1,0.2"];
    for camera in [
        &["--aperture=0.8", "--focus-distance=3"][..],
        &["--projection=orthographic", "--aperture=0.5"],
        &["--projection=orthographic", "--ortho-height=2.5"],
        &panorama,
    ] {
        let of = |accel: &[&str]| picture(folder.path(), &[&["--spp=4"], camera, accel].concat());
        let want = of(&["--accel=linear"]);
        for extents in ["screen", "auto", "screen,sphere-world,box-world"] {
            let extents = format!("--extents={extents}");
            let found = of(&["--accel=extents", &extents]);
            assert!(found.channels == want.channels, "{camera:?} {extents}");
        }
    }
}

#[test]
fn a_lens_blurs_what_is_out_of_focus_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    // How often neighbours differ in coverage by less than all: the softness of the objects' outlines.
    let soft = |args: &[&str]| {
        let picture = picture(
            folder.path(),
            &[&["--spp=64", "--integrator=normals"], args].concat(),
        );
        let Some(Samples::F32(values)) = picture.channel("CryptoObject00.G") else {
            panic!("coverage");
        };
        values.iter().filter(|v| **v < 0.9).count()
    };
    let sharp = soft(&[]);
    let focused = soft(&["--aperture=0.02"]);
    let blurred = soft(&["--aperture=0.6", "--focus-distance=100"]);
    assert!(
        focused < sharp * 3 / 2 && blurred > sharp * 3 / 2,
        "{sharp} {focused} {blurred}"
    );
}

#[test]
fn a_time_limit_ends_with_whole_samples() {
    let folder = tempfile::tempdir().unwrap();
    let samples = |picture: &Picture| match picture.channel("samples") {
        Some(Samples::U32(samples)) => {
            assert!(samples.windows(2).all(|s| s[0] == s[1]));
            samples[0]
        }
        other => panic!("{other:?}"),
    };
    let hurried = picture(folder.path(), &["--time-limit=1e-9"]);
    assert_eq!(samples(&hurried), 1);
    // Time enough for a second sample on a machine that has much else to do.
    let one = picture(folder.path(), &["--time-limit=2"]);
    assert!(samples(&one) > 1);
    let in_time = picture(folder.path(), &["--spp=5", "--time-limit=1000"]);
    let unlimited = picture(folder.path(), &["--spp=5"]);
    assert!(in_time.channels == unlimited.channels && samples(&in_time) == 5);
}

#[test]
fn what_does_not_go_together_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (args, words) in [
        (&["--projection=panoramic", "--aperture=1"][..], "no lens"),
        (&["--projection=panoramic", "--overlay=edges"], "no screen"),
        (
            &["--projection=perspective", "--ortho-height=1"],
            "--ortho-height",
        ),
        (&["--ortho-height=1"], "--projection"),
        (&["--focus-distance=1"], "--aperture"),
        (&["--time-limit=0"], "positive"),
    ] {
        let path = model("lecture-objects.gltf");
        let ran = bspray(folder.path(), &[&["render", &path], args].concat());
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stderr.contains(words), "{ran:?}");
    }
}
