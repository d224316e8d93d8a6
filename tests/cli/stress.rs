//! `bspray stress`: a row a method, a JSON object that says all, what runs away in a process of its own, and clear words for what cannot be.

use serde_json::Value;

use super::run::{Ran, bspray, names};

fn stress(args: &[&str]) -> Ran {
    let folder = tempfile::tempdir().expect("a folder");
    let all = [&["stress", "--quick", "--rays", "16"], args].concat();
    let ran = bspray(folder.path(), &all);
    assert_eq!(names(folder.path()), [""; 0]);
    ran
}

#[test]
fn the_table_has_a_row_a_method_in_110_columns_and_ends_with_0() {
    let ran = stress(&["--sweep", "edges-inside,small", "--threads", "2"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let lines: Vec<&str> = ran.stdout.lines().collect();
    assert!(
        lines.iter().all(|l| l.chars().count() <= 130),
        "{}",
        ran.stdout
    );
    for name in [
        "bsp",
        "linear",
        "moller-trumbore",
        "epsilon-bsp",
        "obvhs-cwbvh-boxes",
    ] {
        let rows = lines
            .iter()
            .filter(|l| l.split_whitespace().next() == Some(name));
        // Two sweeps and the leaks.
        assert_eq!(rows.count(), 3, "{name}: {}", ran.stdout);
    }
    assert!(ran.stdout.contains("bsp: nothing wrong inside its domain"));
    assert!(
        ran.stdout
            .contains("Aabb::surface_area is wrong for all boxes but cubes: 28 instead of 22")
    );
    assert!(
        ran.stderr.contains("100 %") && ran.stderr.contains("s left"),
        "{}",
        ran.stderr
    );
}

#[test]
fn json_says_all_and_does_not_depend_on_threads() {
    let args = [
        "--sweep",
        "distance,tilt",
        "--method",
        "woop,obvhs-cwbvh",
        "--json",
        "-q",
        "--seed",
        "9",
    ];
    let one = stress(&[&args[..], &["--threads", "1"]].concat());
    assert_eq!((one.code, &*one.stderr), (Some(0), ""), "{one:?}");
    assert_eq!(
        one.stdout,
        stress(&[&args[..], &["--threads", "3"]].concat()).stdout
    );
    let value: Value = serde_json::from_str(&one.stdout).expect("one JSON value");
    assert_eq!(value["seed"], 9);
    let sweep = &value["sweeps"][1];
    assert_eq!(
        (&sweep["name"], &sweep["unit"]),
        (&"tilt".into(), &"".into())
    );
    let steps = sweep["steps"].as_array().expect("steps").len();
    let methods: Vec<_> = sweep["methods"]
        .as_array()
        .expect("methods")
        .iter()
        .collect();
    let names: Vec<_> = methods
        .iter()
        .map(|m| m["method"].as_str().expect("a name"))
        .collect();
    assert_eq!(names, ["bsp", "woop", "obvhs-cwbvh"]);
    for method in &methods {
        assert_eq!(method["cells"].as_array().expect("cells").len(), steps);
    }
    let wrong = &methods[2]["first_failure"]["wrong"];
    assert_eq!(
        (&wrong["kind"], &wrong["blame"]),
        (&"hole".into(), &"traversal".into())
    );
    assert_eq!(
        wrong["ray"]["direction"]
            .as_array()
            .expect("a direction")
            .len(),
        3
    );
    assert!(wrong["ray"]["max"].is_null() && wrong["truth"]["t"].is_number());
}

#[test]
fn obvhs_on_very_many_coincident_triangles_is_ended_and_named() {
    let args = [
        "--sweep",
        "coincident",
        "--method",
        "obvhs-bvh2",
        "--time-limit",
        "1",
        "--json",
        "-q",
    ];
    let ran = stress(&args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let value: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
    let cells = value["sweeps"][0]["methods"][1]["cells"]
        .as_array()
        .expect("cells");
    assert_eq!(cells[0]["ending"], "answered");
    let last = &cells[cells.len() - 1]["ending"];
    assert!(
        last["did-not-end"]["seconds"] == 1 || last["died"]["how"].is_string(),
        "{last}"
    );
    let defects = value["defects"].as_array().expect("defects");
    let found = |d: &&Value| {
        d["name"]
            .as_str()
            .is_some_and(|n| n.starts_with("Bvh2 does not survive"))
    };
    assert!(defects.iter().find(found).expect("the defect")["evidence"].is_string());
}

#[test]
fn what_is_not_embree_is_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("words.so"), "words").expect("a file");
    for (file, words) in [
        ("nothing.so", "nothing.so: "),
        ("words.so", "words.so is not a library that can be loaded: "),
    ] {
        let ran = bspray(folder.path(), &["stress", "--quick", "--embree", file]);
        assert_eq!((ran.code, &*ran.stdout), (Some(1), ""), "{ran:?}");
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
        assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    }
}

/// Only where the environment names a library.
#[test]
fn embree_joins_also_in_children_and_its_version_is_told() {
    let library = std::env::var("BSPRAY_EMBREE").unwrap_or_default();
    if library.is_empty() {
        return;
    }
    let words = "--sweep edges-inside,coincident --method embree,embree-robust --json -q --embree";
    let args: Vec<&str> = words.split(' ').chain([&*library]).collect();
    let ran = stress(&args);
    assert_eq!((ran.code, &*ran.stderr), (Some(0), ""), "{ran:?}");
    let value: Value = serde_json::from_str(&ran.stdout).expect("one JSON value");
    assert!(
        value["embree"]
            .as_str()
            .expect("a version")
            .starts_with("4.")
    );
    for sweep in value["sweeps"].as_array().expect("sweeps") {
        let methods = sweep["methods"].as_array().expect("methods");
        assert_eq!(methods.len(), 3, "{}", sweep["name"]);
        for method in methods {
            for cell in method["cells"].as_array().expect("cells") {
                assert_eq!(cell["ending"], "answered", "{cell}");
                assert!(cell["rays"].as_u64() > Some(0), "{cell}");
            }
        }
    }
}

#[test]
fn the_sign_map_is_a_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let args = [
        "stress", "--quick", "--rays", "4", "--sweep", "layers", "--method", "linear", "-q",
    ];
    let ran = bspray(
        folder.path(),
        &[&args[..], &["--sign-map", "signs.png"]].concat(),
    );
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(
        std::fs::metadata(folder.path().join("signs.png"))
            .expect("a picture")
            .len()
            > 500
    );
}

#[test]
fn a_sign_map_that_cannot_be_written_is_refused_before_any_work() {
    let folder = tempfile::tempdir().expect("a folder");
    for (path, code, words) in [
        ("no/signs.png", 1, "no/signs.png: there is no folder no"),
        ("signs.gif", 2, "there are .png"),
    ] {
        let ran = bspray(folder.path(), &["stress", "--sign-map", path]);
        assert_eq!((ran.code, &*ran.stdout), (Some(code), ""), "{ran:?}");
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
        assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    }
}

#[test]
fn what_there_is_not_is_named_with_what_there_is() {
    for (args, words) in [
        (["--sweep", "nothing"], "there are distance"),
        (["--method", "embryo"], "obvhs-cwbvh-boxes"),
        (
            ["--method", "embree"],
            "--method embree needs --embree FILE",
        ),
        (["--sweep", "layers,layers"], "--sweep names layers twice"),
        (["--method", "woop,woop"], "--method names woop twice"),
        (["--rays", "0"], "0"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let ran = bspray(folder.path(), &[&["stress"], &args[..]].concat());
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
    let help = bspray(std::path::Path::new("."), &["--help"]);
    assert!(help.stdout.contains("stress ") && !help.stdout.contains("stress-cell"));
}

#[test]
fn a_report_has_the_rates_and_outcomes_of_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = "stress --quick --rays 16 --sweep small,edges-inside --method moller-trumbore --json --report r";
    let ran = bspray(folder.path(), &words.split(' ').collect::<Vec<_>>());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.stderr.ends_with("report.html\n"), "{}", ran.stderr);
    let printed: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let read = |name: &str| {
        let path = folder.path().join("r").join(name);
        std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    let report: Value = serde_json::from_str(&read("report.json")).expect("JSON");
    assert_eq!(report["words"][0]["tone"], "good");
    let verdict = report["words"][0]["verdict"].as_str().unwrap();
    assert!(
        verdict.contains("bsp gave no wrong answer inside its domain")
            && verdict.contains("Somewhere fail: moller-trumbore."),
        "{verdict}"
    );
    // Every rate of the sweep is in the chart's numbers, and each method has a row.
    for sweep in printed["sweeps"].as_array().unwrap() {
        let name = sweep["name"].as_str().unwrap();
        let method = &sweep["methods"][1];
        assert_eq!(method["method"], "moller-trumbore");
        let rates = read(&format!("rates-{name}.csv"));
        let rows = rates.lines().filter(|l| l.starts_with("moller-trumbore,"));
        let asked = method["cells"].as_array().unwrap();
        let asked = asked.iter().filter(|c| c["rays"].as_u64() > Some(0));
        assert_eq!(rows.count(), asked.count(), "{rates}");
        let outcomes = read(&format!("outcomes-{name}.csv"));
        let wrong = |c: &Value| -> u64 {
            c["faults"]
                .as_array()
                .unwrap()
                .iter()
                .map(|n| n.as_u64().unwrap())
                .sum()
        };
        let wrong: u64 = method["cells"].as_array().unwrap().iter().map(wrong).sum();
        let row = outcomes
            .lines()
            .find(|l| l.starts_with("moller-trumbore,"))
            .unwrap();
        assert!(
            wrong > 0 && row.split(',').any(|cell| cell == wrong.to_string()),
            "{row}"
        );
    }
    let page = read("report.html");
    assert!(page.contains("Where methods fail") && page.contains("<svg"));
}
