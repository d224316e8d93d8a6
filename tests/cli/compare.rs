//! `bspray compare`: every structure in the table, a JSON object that says all, and clear words for what cannot be.

use serde_json::Value;

use super::run::{Ran, bspray, model, picture};

/// Compares on a view of a few hundred rays, with more arguments behind.
fn compare(name: &str, args: &[&str]) -> Ran {
    let folder = tempfile::tempdir().expect("a folder");
    let model = model(name);
    let small = [
        "compare",
        &model,
        "--resolution",
        "24x16",
        "--repetitions",
        "2",
    ];
    let all: Vec<&str> = small.into_iter().chain(args.iter().copied()).collect();
    let ran = bspray(folder.path(), &all);
    assert_eq!(super::run::names(folder.path()), [""; 0]);
    ran
}

#[test]
fn the_table_has_every_structure_for_every_kind_of_rays_in_100_columns() {
    let ran = compare("lecture-objects.gltf", &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let lines: Vec<&str> = ran.stdout.lines().collect();
    assert!(
        lines
            .iter()
            .all(|l| l.chars().count() <= 100 || l.starts_with("camera:")),
        "{}",
        ran.stdout
    );
    // So few rays that no structure is left out.
    for name in ["bsp", "bsp-polygon", "bvh2", "cwbvh", "extents", "linear"] {
        let rows: Vec<_> = lines
            .iter()
            .filter(|l| l.split_whitespace().next() == Some(name))
            .collect();
        // The build, six kinds of rays, the verdict.
        assert_eq!(rows.len(), 8, "{}", ran.stdout);
        assert!(rows[7].contains("nothing wrong"));
    }
    for kind in ["eye", "shadow", "mirror", "refraction", "ambient", "bounce"] {
        let head = |l: &&str| l.starts_with(&format!("{kind}: ")) && l.contains(" rays, ");
        assert!(lines.iter().any(head), "{kind}: {}", ran.stdout);
    }
    for words in [
        "building bsp",
        "camera: --camera-position 0.6,3,9.2 ",
        "0 of ",
    ] {
        let said = format!("{}{}", ran.stderr, ran.stdout);
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[test]
fn json_says_all_with_units_in_its_names() {
    let args = [
        "--accel",
        "cwbvh,linear,bsp",
        "--json",
        "--quiet",
        "--seed",
        "7",
    ];
    let more = [
        "--max-rays",
        "100",
        "--bsp-quality",
        "fast",
        "--threads",
        "1",
    ];
    let ran = compare("lecture-block.obj", &[&args[..], &more].concat());
    assert_eq!((ran.code, &*ran.stderr), (Some(0), ""), "{ran:?}");
    let value: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
    let names = |list: &Value| -> Vec<String> {
        let list = list.as_array().expect("a list").iter();
        list.map(|m| m["kind"].as_str().expect("a name").to_owned())
            .collect()
    };
    assert_eq!(names(&value["structures"]), ["cwbvh", "linear", "bsp"]);
    assert_eq!(
        names(&value["rays"]),
        ["eye", "shadow", "mirror", "refraction", "ambient", "bounce"]
    );
    for (key, want) in [
        ("seed", 7),
        ("repetitions", 2),
        ("build_threads", 1),
        ("trace_threads", 1),
        ("triangles_placed", 20),
    ] {
        assert_eq!(value[key], want, "{key}");
    }
    assert_eq!(value["bsp_quality"], "fast");
    assert_eq!(value["bsp_order"], "sah");
    assert_eq!(value["first_is_right"], true);
    let above_zero = |v: &Value| assert!(v.as_f64().is_some_and(|x| x > 0.0), "{v}");
    for structure in value["structures"].as_array().unwrap() {
        above_zero(&structure["build_seconds"]);
        above_zero(&structure["bytes"]);
        above_zero(&structure["bytes_per_triangle"]);
    }
    for set in value["rays"].as_array().unwrap() {
        assert_eq!(set["disputed"], 0);
        assert_eq!(set["others_checked_against_every_triangle"], set["rays"]);
        assert_eq!(set["wrong_rays"], serde_json::json!([]));
        assert_eq!(names(&set["structures"]), ["cwbvh", "linear", "bsp"]);
        for structure in set["structures"].as_array().unwrap() {
            for value in ["rays_per_second", "speed_ratio_to_first"] {
                above_zero(&structure[value]["median"]);
                above_zero(&structure[value]["interval_95"][0]);
                above_zero(&structure[value]["interval_95"][1]);
            }
            above_zero(&structure["triangle_tests_per_ray"]);
            assert!(structure["nodes_per_ray"].is_number());
            assert!(structure["leaves_per_ray"].is_number());
            assert_eq!(structure["wrong"]["total"], 0);
        }
        assert_eq!(set["structures"][0]["speed_ratio_to_first"]["median"], 1.0);
    }
    assert_eq!(value["rays"][0]["rays"], 100);
}

#[test]
fn rays_and_answers_repeat_with_the_seed() {
    let counts = |seed: &str| {
        let ran = compare(
            "cornell-box.obj",
            &["--json", "--seed", seed, "--max-rays", "128"],
        );
        let value: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
        let sets = value["rays"].as_array().unwrap().iter();
        sets.map(|s| {
            let steps = &s["structures"][1]["triangle_tests_per_ray"];
            format!("{} {} {steps}", s["rays"], s["hits"])
        })
        .collect::<Vec<_>>()
    };
    assert_eq!(counts("3"), counts("3"));
    assert_ne!(counts("3"), counts("4"));
}

#[test]
fn a_view_that_meets_nothing_has_no_other_rays() {
    let away = [
        "--camera-position",
        "9,9,9",
        "--camera-focal-point",
        "99,99,99",
    ];
    let ran = compare("lecture-block.obj", &away);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.stdout.contains("0 % hit"), "{}", ran.stdout);
    assert!(ran.stdout.contains("bounce: no rays"), "{}", ran.stdout);
}

#[test]
fn what_cannot_be_compared_is_said_in_a_line() {
    for (args, code, words) in [
        (&["--accel", "bsp,octree"][..], 2, "want one of bsp"),
        (
            &["--accel", "bvh2,bvh2"],
            2,
            "error: --accel names bvh2 twice",
        ),
        (
            &["--accel", "bsp,embree"],
            2,
            "error: --accel embree needs --embree FILE",
        ),
        (
            &["--accel", "bsp", "--embree", "nothing.so"],
            2,
            "--accel names neither embree nor embree-robust",
        ),
        (&["--embree", "nothing.so"], 1, "nothing.so: "),
        (&["--max-rays", "0"], 2, "--max-rays"),
        (&["--repetitions", "0"], 2, "--repetitions"),
        (
            &["--bsp-quality", "ultra"],
            2,
            "want one of fast, default, best",
        ),
        (&["--bsp-axes", "polar"], 2, "want one of auto, space"),
        (
            &["--bsp-instructions", "mmx"],
            2,
            "want one of auto, avx512, avx2, portable",
        ),
        (&["--camera-index", "5"], 1, "the models have no camera"),
    ] {
        let ran = compare("lecture-block.obj", args);
        assert_eq!(ran.code, Some(code), "{ran:?}");
        assert!(ran.stderr.contains(words), "{words}: {}", ran.stderr);
        assert_eq!(ran.stdout, "");
    }
    let ran = compare("no-such-model.obj", &[]);
    assert_eq!((ran.code, ran.stderr.lines().count()), (Some(1), 1));
    assert!(ran.stderr.starts_with("error: "), "{}", ran.stderr);
}

#[test]
fn the_help_tells_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let ran = bspray(folder.path(), &["compare", "--help"]);
    assert_eq!(ran.code, Some(0));
    let words = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("Exit code 5"), "{words}");
}

#[test]
fn how_a_tree_is_built_and_walked_does_not_change_a_picture() {
    let usual = picture(&[]);
    for (option, value) in [
        ("--bsp-quality", "fast"),
        ("--bsp-quality", "best"),
        ("--bsp-axes", "auto"),
        ("--bsp-axes", "space"),
        ("--bsp-instructions", "auto"),
        ("--bsp-instructions", "portable"),
    ] {
        assert!(picture(&[option, value]) == usual, "{option} {value}");
    }
}

#[test]
fn instructions_that_the_machine_has_not_are_refused() {
    for name in ["avx512", "avx2"] {
        let ran = compare("lecture-block.obj", &["--bsp-instructions", name]);
        match ran.code {
            Some(0) => {}
            Some(2) => {
                let words = format!("this machine has no {name}");
                assert!(ran.stderr.contains(&words), "{}", ran.stderr);
            }
            _ => panic!("{ran:?}"),
        }
    }
}

#[test]
fn a_report_is_a_folder_with_every_number() {
    let folder = tempfile::tempdir().unwrap();
    let model = model("lecture-block.obj");
    let args = |report: &'static str| {
        let words = "--resolution 16x12 --repetitions 2 --accel bsp,bvh2 --seed 5 --json --report";
        let mut args = vec!["compare".to_owned(), model.clone()];
        args.extend(words.split(' ').map(str::to_owned));
        args.push(report.to_owned());
        args
    };
    let ran = bspray(folder.path(), &args("page"));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.stderr.ends_with("report.html\n"), "{}", ran.stderr);
    let printed: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
    let read = |name: &str| {
        std::fs::read_to_string(folder.path().join("page").join(name)).expect("it was written")
    };
    let report: Value = serde_json::from_str(&read("report.json")).expect("JSON");
    assert_eq!(report["words"][0]["tone"], "good");
    assert_eq!(report["provenance"]["seed"], "5");
    assert_eq!(report["provenance"]["camera"], printed["camera"]);
    let command = report["provenance"]["command line"].as_str().unwrap();
    assert!(command.ends_with("--json --report page"), "{command}");
    assert!(report["provenance"]["instructions of bsp"].is_string());
    // The same numbers as on standard output, in JSON and in CSV.
    let speed = &printed["rays"][1]["structures"][1]["rays_per_second"];
    let row = &report["tables"]["rays"]["rows"][3];
    assert_eq!(
        (&row["rays"], &row["structure"]),
        (&"shadow".into(), &"bvh2".into())
    );
    let of_report = row["million rays/s, median"].as_f64().unwrap() * 1e6;
    let printed = speed["median"].as_f64().unwrap();
    assert!(
        (of_report - printed).abs() < 1e-9 * printed,
        "{of_report} {printed}"
    );
    let csv = read("rays.csv");
    let line = csv.lines().find(|l| l.starts_with("shadow,bvh2,"));
    let median: f64 = line.unwrap().split(',').nth(2).unwrap().parse().unwrap();
    assert!(
        (median * 1e6 - printed).abs() < 1e-9 * printed,
        "{median} {printed}"
    );
    let html = read("report.html");
    assert!(html.contains("<p class=\"verdict good\">All structures are right"));
    assert_eq!(html.matches("<svg ").count(), 2);

    std::fs::write(folder.path().join("file"), "").unwrap();
    for (report, words) in [
        ("file", "is no folder"),
        ("no/page", "there is no folder no"),
    ] {
        let ran = bspray(folder.path(), &args(report));
        assert_eq!(ran.code, Some(1), "{ran:?}");
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
    assert_eq!(super::run::names(folder.path()), ["file", "page"]);
}

/// Runs in a folder that stays.
fn compare_in(folder: &std::path::Path, args: &str) -> Ran {
    let block = model("lecture-block.obj");
    let words = args.split(' ').map(str::to_owned);
    let all: Vec<String> = ["compare".to_owned(), block]
        .into_iter()
        .chain(words)
        .collect();
    bspray(folder, &all)
}

#[test]
fn rays_are_written_read_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let small = "--resolution 12x8 --repetitions 1 --accel bsp,bvh2 --quiet";
    let written = compare_in(folder.path(), &format!("{small} --json --write-rays rays"));
    assert_eq!(written.code, Some(0), "{written:?}");
    let read = compare_in(
        folder.path(),
        &format!("{small} --json --rays rays/mirror.ray --rays rays/eye.ray"),
    );
    assert_eq!(read.code, Some(0), "{read:?}");
    let [written, read] = [written, read]
        .map(|ran| serde_json::from_str::<Value>(&ran.stdout).expect("one JSON value"));
    // The same rays have the same answers.
    for (kind, at) in [("eye", 0), ("mirror", 2)] {
        let sets = read["rays"].as_array().unwrap().iter();
        let mut same = sets.filter(|s| s["kind"] == kind);
        let same = same.next().expect("the kind is in the file");
        for value in ["rays", "hits", "query"] {
            assert_eq!(same[value], written["rays"][at][value], "{kind} {value}");
        }
    }
    let replayed = compare_in(folder.path(), "--replay rays/eye.ray --quiet");
    assert_eq!(replayed.code, Some(0), "{replayed:?}");
    for words in [
        "rays/eye.ray: 96 eye rays, closest hit",
        "ray 95: from ",
        "linear",
        "wrong about 0 of 96",
    ] {
        assert!(
            replayed.stdout.contains(words),
            "{words}: {}",
            replayed.stdout
        );
    }
    assert!(!replayed.stdout.contains("WRONG"));
}

#[test]
fn files_of_rays_that_are_none_are_refused_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let header = |count: u32, kind: u32| {
        let mut bytes = b"BRAY".to_vec();
        bytes.extend([1, count, kind].iter().flat_map(|n| n.to_le_bytes()));
        bytes
    };
    let ray = |numbers: [f32; 8]| {
        numbers
            .iter()
            .flat_map(|n| n.to_le_bytes())
            .collect::<Vec<_>>()
    };
    let good = ray([0.0, 9.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1e30]);
    let lame = ray([0.0, 9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e30]);
    for (name, bytes, words) in [
        ("text.ray", b"v 1 2 3\nv 1 2 3\n".to_vec(), "text.ray: "),
        (
            "short.ray",
            [header(2, 0), good.clone()].concat(),
            "ends within ray 1 of the 2",
        ),
        ("huge.ray", header(u32::MAX, 0), "are more than the"),
        ("kind.ray", [header(1, 99), good.clone()].concat(), "99"),
        (
            "lame.ray",
            [header(2, 0), good.clone(), lame].concat(),
            "lame.ray: ray 1: ",
        ),
        (
            "long.ray",
            [header(1, 0), good.clone(), good].concat(),
            "long.ray: ",
        ),
    ] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
        for option in ["--rays", "--replay"] {
            let ran = compare_in(folder.path(), &format!("{option} {name}"));
            assert_eq!(ran.code, Some(1), "{name}: {ran:?}");
            assert_eq!(
                (ran.stdout.as_str(), ran.stderr.lines().count()),
                ("", 1),
                "{ran:?}"
            );
            assert!(ran.stderr.contains(words), "{words}: {}", ran.stderr);
        }
    }
}

#[test]
fn costs_of_pixels_are_layers_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let args = "--resolution 12x8 --repetitions 1 --accel bsp,bvh2 --quiet --exr";
    let ran = compare_in(folder.path(), &format!("{args} costs.exr"));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let picture = bspray::picture::exr::read(&folder.path().join("costs.exr")).expect("it is one");
    let names: Vec<_> = picture.channels.iter().map(|c| c.name.clone()).collect();
    for name in ["bsp", "bvh2", "disagreement"] {
        assert!(names.iter().any(|n| n.contains(name)), "{name}: {names:?}");
    }
    let ran = compare_in(folder.path(), &format!("{args} costs.png"));
    assert_eq!(ran.code, Some(2), "{ran:?}");
    assert!(ran.stderr.contains("must end with .exr"), "{}", ran.stderr);
}

/// Only where the environment names a library.
#[test]
fn embree_joins_by_its_own_standard() {
    let library = std::env::var("BSPRAY_EMBREE").unwrap_or_default();
    if library.is_empty() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let small = "--resolution 48x32 --repetitions 2 --json --quiet --report page";
    let ran = compare_in(folder.path(), &format!("{small} --embree {library}"));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let value: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
    let structures = value["structures"].as_array().unwrap();
    let robust = structures.last().unwrap();
    assert_eq!(
        (&robust["kind"], &robust["owes_exact"]),
        (&"embree-robust".into(), &false.into())
    );
    assert!(robust["bytes"].as_u64() > Some(40 * 20), "{robust}");
    assert!(
        robust["build_peak_bytes"].as_u64() > robust["bytes"].as_u64(),
        "{robust}"
    );
    assert!(robust["nodes"].is_null() && structures[0]["nodes"].is_number());
    for set in value["rays"].as_array().unwrap() {
        let methods = set["structures"].as_array().unwrap();
        assert_eq!(methods.len(), structures.len());
        let robust = methods.last().unwrap();
        assert!(robust["rays_per_second"]["median"].as_f64() > Some(0.0));
        assert!(robust["nodes_per_ray"].is_null(), "{robust}");
        // Rays of a view meet no edges but by chance.
        assert!(robust["wrong"]["total"].as_u64() < Some(4), "{robust}");
    }
    // The depths of single precision are others, and neither wrong nor disputed for that.
    let eye = &value["rays"][0];
    let pairs = eye["pairs"].as_array().unwrap().iter();
    let pair = pairs
        .clone()
        .find(|p| p["kinds"] == serde_json::json!(["bsp", "embree"]));
    let others = pair.unwrap()["other_depths"].as_u64().unwrap();
    assert!(
        others > 5 && eye["disputed"].as_u64() < Some(others),
        "{eye}"
    );
    let report = std::fs::read_to_string(folder.path().join("page/report.json")).unwrap();
    let report: Value = serde_json::from_str(&report).expect("JSON");
    let words = report["provenance"]["instructions of embree"].as_str();
    assert!(words.unwrap().contains("Embree 4."), "{words:?}");
    // Structures that always agree are one row.
    let rows = report["tables"]["pairs"]["rows"].as_array().unwrap();
    assert_eq!(
        (&rows[0]["rays"], &rows[0]["structure"]),
        (&"all".into(), &"bsp".into())
    );
    // And Embree's two modes are another, if they do here.
    assert!(rows.len() == 1 + 6 * 3 || rows.len() == 2 + 6, "{rows:?}");
    let named = "--resolution 12x8 --repetitions 1 --quiet --accel bvh2,embree --json --embree";
    let named = compare_in(folder.path(), &format!("{named} {library}"));
    let value: Value = serde_json::from_str(&named.stdout).expect("one JSON value");
    assert_eq!(value["structures"].as_array().unwrap().len(), 2);
}
