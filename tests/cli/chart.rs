//! `bspray chart`: a folder with charts, whose rows hold the commands that make them again.

use serde_json::Value;

use super::run::{Ran, bspray, model};

fn chart(folder: &std::path::Path, args: &str) -> Ran {
    let words = args.split(' ').map(str::to_owned);
    let all: Vec<String> = ["chart".to_owned(), model("lecture-objects.gltf")]
        .into_iter()
        .chain(words)
        .collect();
    bspray(folder, &all)
}

const SMALL: &str = "--resolution 24x16 --repetitions 1 --method bsp,bvh2,bsp:fast,extents:double --samples 4,1,4 --lod 3 --max-depth 2";

#[test]
fn points_have_numbers_and_commands_that_make_them_again() {
    let folder = tempfile::tempdir().unwrap();
    let ran = chart(
        folder.path(),
        &format!("{SMALL} --report page --json --quiet"),
    );
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let report: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
    assert_eq!(report["words"][0]["tone"], "good");
    let rows = |table: &str| report["tables"][table]["rows"].as_array().unwrap().clone();
    let rays = rows("rays");
    let names: Vec<_> = rays.iter().map(|r| r["method"].as_str().unwrap()).collect();
    assert_eq!(names, ["bsp", "bvh2", "bsp:fast", "extents:double"]);
    for row in &rays[..2] {
        for value in ["wrong at edges", "wrong in view", "depth error, greatest"] {
            assert_eq!(row[value].as_f64(), Some(0.0), "{row}");
        }
    }
    // Depths in single precision are not exact.
    assert!(rays[2]["depth error, greatest"].as_f64().unwrap() > 0.0);
    let pictures = rows("pictures");
    let samples: Vec<_> = pictures
        .iter()
        .map(|r| r["samples"].as_u64().unwrap())
        .collect();
    assert_eq!(samples, [1, 4, 1, 4, 1, 4, 1, 4]);
    assert_eq!(pictures[7]["method"], "bsp, lod 3");
    // Meshes simplified by pixels make another picture.
    assert_ne!(pictures[1]["relMSE"], pictures[7]["relMSE"]);
    let simplified = &rows("simplified")[0];
    let number = |name: &str| simplified[name].as_f64().unwrap();
    assert!(number("kept") < number("triangles") && number("error (pixels)") <= 3.0);
    assert!(number("pixels in both") > 10.0);
    let greatest = number("depth error, greatest");
    assert!(0.0 < number("depth error, rms") && number("depth error, rms") < greatest);
    // Exact structures make the same picture; more samples are nearer to the reference.
    assert_eq!(pictures[0]["relMSE"], pictures[2]["relMSE"]);
    let error = |row: usize| pictures[row]["RMSE"].as_f64().unwrap();
    assert!(error(1) < error(0));
    for file in [
        "report.html",
        "wrong-at-edges.svg",
        "picture-relmse.png",
        "rays.csv",
        "reference.png",
    ] {
        assert!(folder.path().join("page").join(file).is_file(), "{file}");
    }
    for row in [&rays[2], &pictures[5], &pictures[7]] {
        let command = row["command"].as_str().unwrap();
        let words: Vec<_> = command.split(' ').skip(1).collect();
        let again = bspray(folder.path(), &words);
        assert_eq!(again.code, Some(0), "{command}: {again:?}");
    }
    assert!(folder.path().join("picture.exr").is_file());
}

#[test]
fn what_cannot_be_charted_is_said_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    for (args, words) in [
        ("--method bsp:quick", "no method"),
        (
            "--method embree-robust",
            "--method embree-robust needs --embree FILE",
        ),
        (
            "--method bvh2,bvh2:exact",
            "error: --method names bvh2 twice",
        ),
        ("--quick --thorough", "cannot be used with"),
        ("--samples x", "--samples"),
    ] {
        let ran = chart(folder.path(), args);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
        assert!(ran.stderr.contains(words), "{words}: {}", ran.stderr);
    }
    assert_eq!(super::run::names(folder.path()), [""; 0]);
}

/// Only where the environment names a library.
#[test]
fn embree_is_charted_and_its_commands_measure_it_again() {
    let library = std::env::var("BSPRAY_EMBREE").unwrap_or_default();
    if library.is_empty() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let words = "--resolution 24x16 --repetitions 1 --method bsp,embree,embree-robust --samples 1 --max-depth 2";
    let ran = chart(
        folder.path(),
        &format!("{words} --report page --json --quiet --embree {library}"),
    );
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let report: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
    for table in ["rays", "pictures"] {
        let rows = report["tables"][table]["rows"].as_array().unwrap();
        assert_eq!(rows.len(), 3, "{rows:?}");
        let command = rows[2]["command"].as_str().unwrap();
        assert!(command.contains("--method embree-robust"), "{command}");
        let words: Vec<_> = command.split(' ').skip(1).collect();
        let again = bspray(folder.path(), &words);
        assert_eq!(again.code, Some(0), "{command}: {again:?}");
    }
}
