//! Reports on standard output: one JSON object or one table, and nothing beside it.

use serde_json::Value;

use super::run::{bspray, model, names, render};

fn object(text: &str) -> Value {
    let value: Value = serde_json::from_str(text).expect("exactly one JSON value");
    assert!(value.is_object(), "{value}");
    value
}

#[test]
fn render_tells_times_triangles_rays_and_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let block = model("lecture-block.obj");
    let args = [
        "render",
        &block,
        "--json",
        "--resolution",
        "8x6",
        "--spp",
        "3",
        "--integrator",
        "ao",
        "--seed",
        "5",
        "--threads",
        "2",
        // A tree of twenty triangles that has inner nodes.
        "--accel",
        "bvh2",
        "-o",
        "a.png",
    ];
    let ran = bspray(folder.path(), &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let value = object(&ran.stdout);
    let number = |pointer: &str| {
        value
            .pointer(pointer)
            .and_then(Value::as_f64)
            .unwrap_or_else(|| panic!("{pointer} in {value}"))
    };
    for time in ["load", "build", "render"] {
        assert!(number(&format!("/seconds/{time}")) >= 0.0);
    }
    for (pointer, want) in [
        ("/scene/triangles_placed", 20.0),
        ("/scene/instances", 1.0),
        ("/accelerator/triangles", 20.0),
        ("/samples", 144.0),
        ("/samples_per_pixel", 3.0),
        ("/rays/eye", 144.0),
        ("/rays/shadow", 0.0),
        ("/threads", 2.0),
        ("/seed", 5.0),
        ("/window/width", 8.0),
    ] {
        assert!((number(pointer) - want).abs() < 0.5, "{pointer}: {value}");
    }
    assert!(number("/rays/ambient") > 0.0 && number("/rays/ambient") <= 144.0);
    assert!((number("/rays/total") - number("/rays/eye") - number("/rays/ambient")).abs() < 0.5);
    assert!(number("/accelerator/bytes") > 0.0 && number("/rays_per_second") > 0.0);
    assert!(number("/steps/primitives") > 0.0 && number("/steps/nodes") > 0.0);
    assert_eq!(value["complete"], true);
    assert_eq!(value["integrator"], "ao");
    assert_eq!(value["accelerator"]["kind"], "bvh2");
    assert_eq!(value["accelerator"]["bsp_quality"], Value::Null);
    assert_eq!(value["outputs"], serde_json::json!(["a.png"]));
    assert_eq!(value["models"], serde_json::json!([block]));
    assert!(ran.stderr.contains(value["camera"].as_str().unwrap()));
}

#[test]
fn inspect_tells_what_the_file_holds() {
    let folder = tempfile::tempdir().unwrap();
    let ran = bspray(
        folder.path(),
        &["inspect", "--json", &model("lecture-objects.gltf")],
    );
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    let value = object(&ran.stdout);
    for (key, count) in [
        ("meshes", 7),
        ("instances", 14),
        ("materials", 7),
        ("images", 0),
        ("lights", 0),
        ("cameras", 2),
        ("defects", 0),
        ("notes", 0),
    ] {
        assert_eq!(value[key].as_array().map(Vec::len), Some(count), "{key}");
    }
    let placed: u64 = value["meshes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|m| m["triangles"].as_u64().unwrap() * m["instances"].as_u64().unwrap())
        .sum();
    assert_eq!(value["triangles_placed"], placed);
    assert_eq!(value["textures"], 0);
    assert_eq!(
        value["cameras"][1]["projection"]["orthographic"]["height"],
        6.0
    );
    assert!(value["bounds"]["diagonal"].as_f64().unwrap() > 80.0);
}

#[test]
fn inspect_counts_polygons_and_defects_and_joins_files() {
    let folder = tempfile::tempdir().unwrap();
    let (block, broken) = (
        model("lecture-block.obj"),
        model("malformed/nan-vertex.obj"),
    );
    let ran = bspray(folder.path(), &["inspect", "--json", &block, &broken]);
    let value = object(&ran.stdout);
    assert_eq!(value["models"], serde_json::json!([block, broken]));
    assert_eq!(value["meshes"][0]["polygons"], 8);
    assert_eq!(value["triangles"], 21);
    assert_eq!(value["defects"].as_array().map(Vec::len), Some(1));

    let text = bspray(folder.path(), &["inspect", &block, &broken]);
    assert_eq!((text.code, text.stderr.as_str()), (Some(0), ""));
    for words in [
        "triangles   21 (21 placed)",
        "8 polygons",
        "not a finite number",
    ] {
        assert!(
            text.stdout.contains(words),
            "want {words:?}: {}",
            text.stdout
        );
    }
}

#[test]
fn a_bsp_is_as_careful_as_its_rays_are_worth_unless_a_quality_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let block = model("lecture-block.obj");
    let quality = |args: &str| {
        let words = format!("render MODEL -o a.png --json {args}");
        let word = |w| if w == "MODEL" { block.as_str() } else { w };
        let words: Vec<_> = words.split(' ').map(word).collect();
        let ran = bspray(folder.path(), &words);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        object(&ran.stdout)["accelerator"]["bsp_quality"].clone()
    };
    // Twenty triangles: a ray for some of them, and six a sample of many.
    let (few, many) = ("--spp 1 --resolution 8x6 ", "--spp 16 --resolution 12x9 ");
    let quality = |rays: &str, args: &str| quality(&format!("{rays}{args}"));
    assert_eq!(quality(few, "--integrator facing"), "fast");
    assert_eq!(quality(many, "--integrator path"), "default");
    assert_eq!(quality(few, "--bsp-quality best"), "best");
    assert_eq!(quality(many, "--bsp-quality fast"), "fast");
    assert_eq!(quality(few, "--accel extents"), "fast");
    assert_eq!(
        quality(few, "--accel extents --mesh-accel bvh2"),
        Value::Null
    );
}

#[test]
fn stats_are_a_table_of_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let ran = render(folder.path(), "lecture-block.obj", &["--stats"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    for (name, value) in [
        ("triangles placed", "20"),
        ("accelerator", "bsp"),
        ("triangle test", "exact"),
        ("BSP quality", "fast"),
        ("samples", "48"),
        ("eye rays", "48"),
        ("ambient rays", "0"),
    ] {
        let row = ran.stdout.lines().find(|l| l.starts_with(name));
        assert!(
            row.is_some_and(|r| r.split_whitespace().last() == Some(value)),
            "{name}: {}",
            ran.stdout
        );
    }
    let is_row = |l: &str| l.len() > 24 && !l.starts_with(' ');
    // What the picture needed follows as a table of its own.
    let tables: Vec<&str> = ran.stdout.split("\n\n").collect();
    assert_eq!(tables.len(), 2, "{}", ran.stdout);
    assert!(tables[1].starts_with("needs  ") && tables[1].contains("\ntriangles  "));
    assert!(
        tables.iter().all(|table| table.lines().all(is_row)),
        "{}",
        ran.stdout
    );
}

#[test]
fn one_pixel_is_told_and_nothing_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let ran = render(
        folder.path(),
        "lecture-block.obj",
        &["--pixel", "3,2", "--json"],
    );
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let value = object(&ran.stdout);
    assert_eq!(value["pixel"], serde_json::json!([3, 2]));
    let center = &value["center"][0];
    assert_eq!(
        (&center["kind"], &center["depth"]),
        (&"eye".into(), &0.into())
    );
    let hit = &center["hit"];
    assert_eq!(hit["exact"]["hits"], true, "{hit}");
    assert_eq!(hit["exact"]["ulps_off"], 0, "{hit}");
    for key in [
        "t",
        "instance",
        "triangle",
        "position",
        "geometric_normal",
        "material_name",
        "alpha",
    ] {
        assert!(!hit[key].is_null(), "{key} in {hit}");
    }
    // The path goes on from what the eye sees.
    let rays = value["samples"][0]["rays"].as_array().unwrap();
    let is_next = |r: &Value| r["kind"] == "diffuse" && r["depth"] == 1;
    assert!(rays.iter().any(is_next), "{rays:?}");

    let text = render(folder.path(), "lecture-block.obj", &["--pixel", "3,2"]);
    assert_eq!(text.code, Some(0), "{text:?}");
    assert!(text.stdout.starts_with("pixel 3,2\n"), "{}", text.stdout);
    assert!(
        text.stdout.contains("diffuse ray, depth 1"),
        "{}",
        text.stdout
    );
    assert!(names(folder.path()).is_empty());
}

#[test]
#[cfg(target_os = "linux")]
fn paths_that_are_not_utf_8_are_told_as_well_as_can_be() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let folder = tempfile::tempdir().unwrap();
    let obj = OsStr::from_bytes(b"block\xff.obj");
    let png = OsStr::from_bytes(b"a\xff.png");
    std::fs::copy(model("lecture-block.obj"), folder.path().join(obj)).unwrap();
    let report = |args: &[&OsStr]| {
        let mut program = assert_cmd::cargo::cargo_bin_cmd!("bspray");
        let output = program.current_dir(folder.path()).args(args).output();
        let output = output.expect("the program starts");
        assert!(output.status.success(), "{output:?}");
        object(&String::from_utf8(output.stdout).expect("UTF-8 on standard output"))
    };
    let [inspect, render, json, to, spp, one] =
        ["inspect", "render", "--json", "-o", "--spp", "1"].map(OsStr::new);
    let [resolution, tiny] = ["--resolution", "8x6"].map(OsStr::new);
    let told = report(&[inspect, obj, json]);
    assert_eq!(told["models"][0], "block\u{fffd}.obj");
    assert_eq!(told["meshes"][0]["instances"], 1);
    let told = report(&[render, obj, json, resolution, tiny, spp, one, to, png]);
    assert_eq!(told["models"][0], "block\u{fffd}.obj");
    assert_eq!(told["outputs"][0], "a\u{fffd}.png");
}
