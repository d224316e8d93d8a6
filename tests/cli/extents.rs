//! Extents on the command line: the same picture with all of them, their reports, and what is refused.

use serde_json::Value;

use super::run::{bspray, model, picture, render};

#[test]
fn pictures_are_the_same_with_every_choice_of_extents() {
    let want = picture(&[]);
    for extents in [
        "none",
        "auto",
        "screen",
        "screen,sphere-world,box-world,sphere-object,box-object",
    ] {
        for mesh in ["linear", "bsp", "bvh2", "cwbvh"] {
            for filter in ["box", "blackman-harris"] {
                let args = [
                    "--accel",
                    "extents",
                    "--extents",
                    extents,
                    "--mesh-accel",
                    mesh,
                ];
                let filter = ["--filter", filter];
                let found = picture(&[&args[..], &filter].concat());
                assert!(found == picture(&filter), "{extents} {mesh} {filter:?}");
            }
        }
    }
    let lecture = [
        "--accel",
        "extents",
        "--extent-sphere",
        "centroid",
        "--extents",
        "sphere-world",
    ];
    assert!(picture(&lecture) == want);
}

#[test]
fn steps_tell_of_tests_of_extents() {
    let folder = tempfile::tempdir().unwrap();
    let args = [
        "--accel",
        "extents",
        "--extents",
        "box-world",
        "--json",
        "--integrator",
        "normals",
    ];
    let ran = render(folder.path(), "lecture-objects.gltf", &args);
    let value: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    // Each of 14 objects for each eye ray.
    assert_eq!(value["steps"]["extents"], 14 * 48, "{value}");
}

#[test]
fn the_table_tells_every_object_and_that_auto_is_as_good_as_the_best() {
    let folder = tempfile::tempdir().unwrap();
    let objects = model("lecture-objects.gltf");
    let args = [
        "inspect",
        &objects,
        "--extent-table",
        "--json",
        "--rays",
        "1000",
    ];
    let ran = bspray(folder.path(), &args);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    let value: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let rows = value["objects"].as_array().unwrap();
    assert_eq!(rows.len(), 14);
    let mut all = Vec::new();
    for row in rows {
        let tests = row["tests"].as_array().unwrap();
        assert_eq!(tests.len(), 5, "{row}");
        assert!(row["hull"].as_u64() <= row["cluster"].as_u64());
        all.extend(tests.iter().map(|test| {
            let [predicted, counted] = ["predicted", "counted"].map(|k| test[k].as_f64().unwrap());
            (predicted / counted - 1.0).abs()
        }));
    }
    // In front of `linear`, whose full test costs all rays the same but shadow rays that hit, the lecture's formula holds for most.
    let close = all.iter().filter(|error| **error < 0.1).count();
    assert!(4 * close > 3 * all.len(), "{close} of {}", all.len());
    let cost = |key: &str| value["cost"][key].as_f64().unwrap();
    let same = value["cost"]["best_same_for_all"]["cost"].as_f64().unwrap();
    assert!(cost("auto") <= 1.05 * same, "{}", value["cost"]);
    assert!(cost("auto") < 0.1 * cost("none"));

    // A ball's box has 6/pi of its surface and volume, its sphere nearly the same, in any size.
    let ball = rows.iter().find(|row| row["name"] == "ball").unwrap();
    let real = |path: &str| ball.pointer(path).and_then(Value::as_f64).unwrap();
    let six_over_pi = 6.0 / std::f64::consts::PI;
    for space in ["/object_space", "/world_space"] {
        for key in ["surface", "volume"] {
            let of_box = real(&format!("{space}/box/{key}_over_object"));
            assert!((of_box / six_over_pi - 1.0).abs() < 0.02, "{of_box}");
            let of_sphere = real(&format!("{space}/sphere/{key}_over_object"));
            assert!((1.0..1.02).contains(&of_sphere), "{of_sphere}");
        }
    }
    let growth = real("/world_space/volume") / real("/object_space/volume");
    assert!((growth - 1.6 * 1.6 * 1.6).abs() < 1e-3, "{growth}");
    // A rectangle around a round shape has 4/pi of its area, and some pixels at its rim.
    let in_extent = real("/screen/pixels") / real("/hull_pixels");
    assert!((1.27..1.32).contains(&in_extent), "{in_extent}");
    assert!(
        rows[0]["object_space"]["volume"].is_null(),
        "an open ground has no volume"
    );

    let text = bspray(folder.path(), &args[..3]);
    for words in ["predicted", "auto: ", "counted cost of a ray"] {
        assert!(text.stdout.contains(words), "{words}: {}", text.stdout);
    }
}

#[test]
fn the_ladder_has_all_steps_for_three_kinds_of_rays() {
    let folder = tempfile::tempdir().unwrap();
    let objects = model("lecture-objects.gltf");
    let args = [
        "ladder",
        &objects,
        "--mesh-accel",
        "bsp",
        "--rays",
        "200",
        "--repetitions",
        "1",
    ];
    let ran = bspray(folder.path(), &[&args[..], &["--json"]].concat());
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    let value: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let steps = value["steps"].as_array().unwrap();
    assert_eq!(steps[0]["name"], "no extents, bsp in objects");
    assert_eq!(steps.last().unwrap()["name"], "bsp alone");
    for step in steps {
        let rays = step["rays"].as_array().unwrap();
        assert_eq!(rays.len(), 3);
        assert!(
            rays.iter()
                .all(|r| r["counted_cost"].as_f64().unwrap() > 0.0)
        );
    }
    let text = bspray(folder.path(), &args);
    assert!(text.stdout.contains("mirror rays") && text.stdout.contains("bvh2 alone"));
}

#[test]
fn options_that_nobody_would_look_at_and_unknown_extents_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |args: &[&str], words: &str| {
        let ran = render(folder.path(), "lecture-block.obj", args);
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    };
    refused(&["--extents", "none"], "--extents: only --accel extents");
    refused(
        &["--mesh-accel", "linear"],
        "--mesh-accel: only --accel extents",
    );
    refused(
        &["--accel", "extents", "--extents", "box"],
        "\"box\" is no extent",
    );
    refused(
        &["--accel", "extents", "--extents", "screen,screen"],
        "twice",
    );
    refused(
        &["--accel", "extents", "--mesh-accel", "extents"],
        "want one of",
    );
    let block = model("lecture-block.obj");
    let ran = bspray(folder.path(), &["inspect", &block, "--rays", "5"]);
    assert!(
        ran.code == Some(2) && ran.stderr.contains("--extent-table"),
        "{ran:?}"
    );
    let args = ["inspect", &block, "--camera-index", "0"];
    let ran = bspray(folder.path(), &args);
    assert!(
        ran.code == Some(2) && ran.stderr.contains("--extent-table"),
        "{ran:?}"
    );
    let ran = bspray(folder.path(), &["ladder", "nothing.obj"]);
    assert!(
        ran.code == Some(1) && ran.stderr.contains("nothing.obj"),
        "{ran:?}"
    );
}
