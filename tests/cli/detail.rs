//! `render --lod` and `--noise`: what they say, what they refuse, and what their files hold.

use bspray::picture::{Samples, exr};
use bspray::render::LAYERS;
use serde_json::Value;

use super::run::{Ran, bspray, model, render};

fn refused(ran: &Ran, words: &[&str]) {
    assert_eq!(ran.code, Some(2), "{ran:?}");
    for word in words {
        assert!(ran.stderr.contains(word), "{word}: {}", ran.stderr);
    }
}

/// A picture of the still life from very far, with these arguments more; and its report.
fn from_afar(folder: &std::path::Path, args: &[&str]) -> (Ran, Value) {
    let far = [
        "--camera-position=0,40,90",
        "--camera-focal-point=0,0,0",
        "--json",
        "--resolution=64x48",
        "--spp=2",
    ];
    let objects = model("lecture-objects.gltf");
    let all = [&["render", objects.as_str()], &far[..], args].concat();
    let ran = bspray(folder, &all);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let report = serde_json::from_str(&ran.stdout).expect("JSON");
    (ran, report)
}

#[test]
fn what_is_simplified_is_told_and_layers_of_triangles_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let (ran, report) = from_afar(folder.path(), &["--lod=1", "-o", "a.exr", "-o", "a.png"]);
    let lod = &report["lod"];
    let number = |name: &str| lod[name].as_f64().expect(name);
    assert!(number("kept") < number("triangles") / 2.0, "{lod}");
    assert!(number("error_pixels") <= 1.0 && number("error_pixels") > 0.0);
    assert_eq!(report["scene"]["triangles_placed"], lod["kept"]);
    let instances = lod["instances"].as_array().expect("a list");
    let sum = |name: &str| {
        instances
            .iter()
            .map(|i| i[name].as_f64().expect(name))
            .sum::<f64>()
    };
    assert_eq!(
        (sum("kept"), sum("triangles")),
        (number("kept"), number("triangles"))
    );
    assert!(
        ran.stderr.contains("lod: ") && ran.stderr.contains("Z, distance, N, "),
        "{}",
        ran.stderr
    );
    let picture = exr::read(&folder.path().join("a.exr")).unwrap();
    for layer in LAYERS {
        for channel in layer.channels() {
            assert_eq!(
                picture.channel(channel).is_none(),
                layer.is_of_triangles,
                "{channel}"
            );
        }
    }
    assert!(picture.channel("CryptoObject00.R").is_some());
    let (_, whole) = from_afar(folder.path(), &["-o", "b.png"]);
    assert!(whole["lod"].is_null() && whole["scene"]["triangles_placed"] == lod["triangles"]);
}

#[test]
fn pictures_of_what_is_no_longer_there_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| render(folder.path(), "lecture-block.obj", args);
    refused(&run(&["--lod=0.5", "--pixel=1,1"]), &["--lod", "--pixel"]);
    refused(
        &run(&["--lod=0.5", "--bsp-layers", "-o", "a.exr"]),
        &["--lod", "--bsp-layers"],
    );
    for integrator in ["cost", "fragment", "bsp-depth"] {
        refused(
            &run(&["--lod=0.5", "--integrator", integrator]),
            &["--lod", integrator],
        );
    }
    for wrong in ["0", "-1", "nan", "x"] {
        refused(&run(&[&format!("--lod={wrong}")]), &["--lod"]);
        refused(&run(&[&format!("--noise={wrong}")]), &["--noise"]);
    }
    refused(
        &run(&["--noise=0.01", "--pixel=1,1"]),
        &["--noise", "--pixel"],
    );
}

#[test]
fn samples_go_where_the_noise_is_and_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| {
        let base = ["--json", "--resolution=32x32", "--noise=0.1", "-o", "a.exr"];
        let cornell = model("cornell-box.obj");
        let all = [&["render", cornell.as_str()], &base[..], args].concat();
        let ran = bspray(folder.path(), &all);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let picture = exr::read(&folder.path().join("a.exr")).unwrap();
        let Some(Samples::U32(samples)) = picture.channel("samples") else {
            panic!("samples")
        };
        let report: Value = serde_json::from_str(&ran.stdout).expect("JSON");
        (samples.clone(), report)
    };
    let (samples, report) = run(&["--spp=128"]);
    let (least, most) = (samples.iter().min().unwrap(), samples.iter().max().unwrap());
    assert!(
        *least >= 16 && *most <= 128 && least < most,
        "{least} {most}"
    );
    let spent: u64 = samples.iter().map(|&n| u64::from(n)).sum();
    let noise = &report["noise"];
    assert_eq!(
        (&report["samples"], &noise["uniform_samples"]),
        (&spent.into(), &(1024 * 128).into())
    );
    assert_eq!(
        (&report["complete"], &report["samples_per_pixel"]),
        (&true.into(), &(*most).into())
    );
    let open = noise["unreached_pixels"].as_u64().expect("a number");
    assert!(open <= samples.iter().filter(|&&n| n == 128).count() as u64);
    // Fewer than the least are not decided about.
    let (samples, _) = run(&["--spp=8"]);
    assert!(samples.iter().all(|&n| n == 8));
}
