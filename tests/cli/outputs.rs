//! Pictures and words: several files at once, the default name, crops, what an EXR tells of itself, and quiet and plain
//! standard error.

use std::fs;
use std::path::Path;

use bspray::picture::{Attribute, Picture, Samples, Window, exr, read_image};

use super::run::{bspray, model, names, render};

fn size_of_image(folder: &Path, name: &str) -> (u32, u32) {
    let bytes = fs::read(folder.join(name)).expect("it was written");
    let image = read_image(name, &bytes).expect("it can be read");
    (image.width, image.height)
}

#[test]
fn several_outputs_come_of_one_render() {
    let folder = tempfile::tempdir().unwrap();
    let outputs = ["a.png", "b.JPG", "c.jpeg", "d.exr"];
    let args: Vec<&str> = outputs.iter().flat_map(|o| ["-o", o]).collect();
    let ran = render(folder.path(), "lecture-block.obj", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    // Nothing beside them: temporary files are gone.
    assert_eq!(names(folder.path()), outputs);
    for name in &outputs[..3] {
        assert_eq!(size_of_image(folder.path(), name), (8, 6), "{name}");
    }
    for name in ["b.JPG", "c.jpeg"] {
        let bytes = fs::read(folder.path().join(name)).unwrap();
        assert!(bytes.starts_with(&[0xff, 0xd8, 0xff]), "{name} is no JPEG");
    }
    let last = ran.stderr.lines().last().unwrap();
    assert!(last.starts_with("a.png, b.JPG, c.jpeg, d.exr: "), "{last}");
}

#[test]
fn an_exr_holds_every_layer_and_how_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let args = [
        "render",
        &model("lecture-block.obj"),
        "--resolution=8x6",
        "--spp=3",
        "--seed=7",
        "--accel=cwbvh",
        "--output",
        "with space.exr",
    ];
    let ran = bspray(folder.path(), &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let picture = exr::read(&folder.path().join("with space.exr")).unwrap();
    for layer in bspray::render::LAYERS {
        for channel in layer.channels() {
            assert!(picture.channel(channel).is_some(), "{channel}");
        }
    }
    let Some(Samples::U32(samples)) = picture.channel("samples") else {
        panic!("samples")
    };
    assert!(samples.iter().all(|&n| n == 3));
    let text = |name: &str| match &picture.attributes[name] {
        Attribute::Text(text) => text.clone(),
        other => panic!("{name}: {other:?}"),
    };
    assert_eq!(
        text("software"),
        format!("bspray {}", text("bspray/version"))
    );
    assert_eq!(text("bspray/accelerator"), "cwbvh");
    assert_eq!(text("bspray/integrator"), "path");
    assert_eq!(text("bspray/seed"), "7");
    assert!(text("bspray/commandLine").ends_with("--accel=cwbvh --output 'with space.exr'"));
    assert!(
        ran.stderr
            .contains(&format!("camera: {}\n", text("bspray/camera")))
    );
    assert!(text("bspray/machine").starts_with(std::env::consts::ARCH));
    assert!(text("bspray/seconds").contains("\"render\":"));
    assert_eq!(picture.attributes["bspray/samples"], Attribute::Int(3));
    assert_eq!(picture.attributes["bspray/partial"], Attribute::Int(0));
    assert!(matches!(
        picture.attributes["worldToCamera"],
        Attribute::M44(_)
    ));
    assert!(matches!(
        picture.attributes["worldToNDC"],
        Attribute::M44(_)
    ));
}

#[test]
fn the_default_name_is_the_models_in_this_folder() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source");
    fs::create_dir(&source).unwrap();
    // A name whose last dot is no extension.
    fs::copy(model("lecture-block.obj"), source.join("scan.v2.obj")).unwrap();
    let block = model("lecture-block.obj");
    let args = [
        "render",
        "source/scan.v2.obj",
        &block,
        "--resolution=4x4",
        "--spp=1",
    ];
    assert_eq!(bspray(folder.path(), &args).code, Some(0));
    assert_eq!(names(folder.path()), ["scan.v2.png", "source"]);
    assert_eq!(names(&source), ["scan.v2.obj"]);
}

#[test]
fn a_crop_keeps_its_place_in_exr_and_is_cut_out_in_png() {
    let folder = tempfile::tempdir().unwrap();
    for (crop, window) in [
        (
            "--pixelbounds=2,7,1,4",
            Window {
                x: 2,
                y: 1,
                width: 5,
                height: 3,
            },
        ),
        (
            "--cropwindow=0.5,1,0.5,0.75",
            Window {
                x: 4,
                y: 3,
                width: 4,
                height: 2,
            },
        ),
    ] {
        let args = [crop, "-o", "c.exr", "-o", "c.png"];
        let ran = render(folder.path(), "lecture-block.obj", &args);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let picture: Picture = exr::read(&folder.path().join("c.exr")).unwrap();
        assert_eq!((picture.display, picture.window), ((8, 6), window));
        assert_eq!(
            size_of_image(folder.path(), "c.png"),
            (window.width, window.height)
        );
    }
}

#[test]
fn exposure_and_tone_map_change_the_png_but_not_the_exr() {
    let folder = tempfile::tempdir().unwrap();
    let files = |name: &str, args: &[&str]| {
        let (png, exr_name) = (format!("{name}.png"), format!("{name}.exr"));
        let all = [&["-q", "-o", &png, "-o", &exr_name], args].concat();
        assert_eq!(
            render(folder.path(), "lecture-block.obj", &all).code,
            Some(0)
        );
        let picture = exr::read(&folder.path().join(exr_name)).expect("an EXR file");
        let bytes = fs::read(folder.path().join(png)).expect("a PNG file");
        (bytes, picture.channels)
    };
    let plain = files("plain", &[]);
    for args in [&["--exposure", "-1"][..], &["--tonemap", "aces"]] {
        let other = files("other", args);
        assert!(plain.0 != other.0, "{args:?}");
        assert!(plain.1 == other.1, "{args:?}");
    }
}

#[test]
fn standard_error_is_plain_lines_when_piped_and_empty_when_quiet() {
    let folder = tempfile::tempdir().unwrap();
    // A model with a defect, which is told unless quiet.
    let ran = render(folder.path(), "malformed/nan-vertex.obj", &["-o", "a.png"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(0), ""), "{ran:?}");
    let is_plain = |c: char| c == '\n' || !c.is_control();
    assert!(ran.stderr.chars().all(is_plain), "{:?}", ran.stderr);
    for start in [
        "dropped: ",
        "camera: --camera-position ",
        "rendering: 100 %",
        "a.png: ",
    ] {
        assert!(
            ran.stderr.lines().any(|l| l.starts_with(start)),
            "want {start:?}: {ran:?}"
        );
    }
    for quiet in ["-q", "--quiet"] {
        let ran = render(
            folder.path(),
            "malformed/nan-vertex.obj",
            &[quiet, "-o", "b.png"],
        );
        assert_eq!(
            (ran.code, ran.stdout.as_str(), ran.stderr.as_str()),
            (Some(0), "", ""),
        );
    }
    assert_eq!(names(folder.path()), ["a.png", "b.png"]);
}
