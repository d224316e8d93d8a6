//! Light from infinitely far: pictures, colours, the physical sky, and cut-outs.

use std::path::Path;

use bspray::picture::{Channel, Picture, Samples, exr, read_image};
use bspray::scene::Pixels;

use super::run::render;

/// A picture of the light: black but for one quarter of the horizon, around `middle` (a share of the width).
fn write_light(path: &Path, middle: f32) {
    let (w, h) = (64_u32, 32_u32);
    let value = |i: u32| {
        let (x, y) = ((i % w) as f32 / w as f32, (i / w) as f32 / h as f32);
        let off = (x - middle + 0.5).rem_euclid(1.0) - 0.5;
        if off.abs() < 0.125 && (y - 0.5).abs() < 0.3 {
            4.0
        } else {
            0.0
        }
    };
    let values: Vec<f32> = (0..w * h).map(value).collect();
    let channels = ["R", "G", "B"].map(|name| Channel::new(name, Samples::F16(values.clone())));
    let [r, g, b] = channels;
    let picture = Picture::new(w, h)
        .with_channel(r)
        .with_channel(g)
        .with_channel(b);
    exr::write(path, &picture).expect("it can be written");
}

/// Pixels of a PNG that a render wrote.
fn pixels(folder: &Path, args: &[&str]) -> Vec<[u8; 4]> {
    let args = [&["-o", "a.png"], args].concat();
    let ran = render(folder, "lecture-block.obj", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let bytes = std::fs::read(folder.join("a.png")).expect("it was written");
    let image = read_image("a.png", &bytes).expect("it can be read");
    let Some(Pixels::Rgba8(pixels)) = image.pixels else {
        panic!("8 bits")
    };
    pixels
}

fn brightness(pixels: &[[u8; 4]]) -> u32 {
    pixels.iter().map(|p| u32::from(p[1])).sum()
}

#[test]
fn pictures_light_what_faces_them_and_turn() {
    let folder = tempfile::tempdir().unwrap();
    // The light comes from +Z, three quarters of the width; the eye looks at the side that faces it.
    write_light(&folder.path().join("light.exr"), 0.75);
    let camera = ["--camera-direction=0,0,-1", "--no-background"];
    let lit = |rotation: &str| {
        let more = ["--hdri-file", "light.exr", rotation];
        brightness(&pixels(folder.path(), &[&camera[..], &more].concat()))
    };
    let front = lit("--hdri-rotation=0");
    assert!(front > 20 * lit("--hdri-rotation=180").max(1));
    assert!(front > lit("--hdri-rotation=90"));
    let strong = ["--hdri-file", "light.exr", "--hdri-strength", "2"];
    assert!(brightness(&pixels(folder.path(), &[&camera[..], &strong].concat())) > front);
}

#[test]
fn a_colour_lights_and_shows_and_cut_outs_are_transparent() {
    let folder = tempfile::tempdir().unwrap();
    let red = pixels(
        folder.path(),
        &["--background-color=#ff0000", "--tonemap=clip"],
    );
    assert_eq!(red[0], [255, 0, 0, 255]);
    assert!(red.iter().all(|p| p[1] == 0), "nothing but red light");
    let cut = pixels(
        folder.path(),
        &["--background-color=1,0,0", "--no-background"],
    );
    assert_eq!(cut[0], [0, 0, 0, 0]);
    assert!(cut.iter().any(|p| p[0] > 100 && p[3] == 255));
}

#[test]
fn the_physical_sky_follows_its_sun() {
    let folder = tempfile::tempdir().unwrap();
    let noon = pixels(folder.path(), &["--sun-elevation=60"]);
    let evening = pixels(folder.path(), &["--sun-elevation=-2"]);
    assert!(brightness(&noon) > 2 * brightness(&evening));
    assert_ne!(noon, pixels(folder.path(), &["--sun-direction=1,1,0"]));
    assert_ne!(
        noon,
        pixels(folder.path(), &["--sun-elevation=60", "--turbidity=8"])
    );
}

#[test]
fn wrong_wishes_are_told() {
    let folder = tempfile::tempdir().unwrap();
    for (args, words) in [
        (&["--hdri-file=no.exr"][..], "no.exr"),
        (&["--hdri-rotation=3"], "--hdri-file"),
        (
            &["--hdri-file=a.exr", "--background-color=1,1,1"],
            "cannot be used with",
        ),
        (&["--background-color=red"], "#RRGGBB"),
        (&["--sun-elevation=91"], "-18 to 90"),
    ] {
        let ran = render(folder.path(), "lecture-block.obj", args);
        assert_ne!(ran.code, Some(0));
        assert!(ran.stderr.contains(words), "{args:?}: {}", ran.stderr);
    }
    // The picture of the light is no output.
    write_light(&folder.path().join("light.exr"), 0.5);
    let args = ["--hdri-file=light.exr", "-o", "light.exr"];
    let ran = render(folder.path(), "lecture-block.obj", &args);
    assert_ne!(ran.code, Some(0), "{ran:?}");
}
