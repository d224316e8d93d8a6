//! `--denoise`: less noise by an independent reference, the same for any number of threads, and nothing lost.

use std::path::Path;

use bspray::picture::{Picture, Samples, exr};

use super::run::{bspray, model};

fn picture(folder: &Path, args: &[&str]) -> Picture {
    let path = model("cornell-box.obj");
    let first = [
        "render",
        &path,
        "-o",
        "a.exr",
        "-o",
        "a.png",
        "--resolution=48x40",
    ];
    let ran = bspray(folder, &[&first[..], args].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let mut picture = exr::read(&folder.join("a.exr")).expect("an EXR file");
    picture.channels.retain(|c| !c.name.starts_with("cost."));
    picture
}

fn floats<'a>(picture: &'a Picture, name: &str) -> &'a [f32] {
    match picture.channel(name) {
        Some(Samples::F32(values)) => values,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn it_takes_noise_away_and_keeps_the_noisy_picture() {
    let folder = tempfile::tempdir().unwrap();
    let png = || std::fs::read(folder.path().join("a.png")).unwrap();
    let noisy = picture(folder.path(), &["--spp=8"]);
    let noisy_png = png();
    let one = picture(folder.path(), &["--spp=8", "--denoise", "--threads=1"]);
    let one_png = png();
    let three = picture(folder.path(), &["--spp=8", "--denoise", "--threads=3"]);
    assert!(one.channels == three.channels && one_png == png());
    assert!(noisy_png != one_png);
    let reference = picture(folder.path(), &["--spp=512", "--seed=9"]);
    for channel in ["R", "G", "B"] {
        let before = format!("noisy.{channel}");
        assert_eq!(floats(&one, &before), floats(&noisy, channel));
        let error = |values: &[f32]| {
            let pairs = values.iter().zip(floats(&reference, channel));
            pairs
                .map(|(a, b)| (a - b) * (a - b) / (b * b + 0.01))
                .sum::<f32>()
        };
        let (before, after) = (error(floats(&one, &before)), error(floats(&one, channel)));
        assert!(after < 0.6 * before, "{channel}: {before} {after}");
    }
}
