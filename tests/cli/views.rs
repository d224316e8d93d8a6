//! Views of the polygon BSP: figures, drawings, and pictures with their layers.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use bspray::picture::{Picture, Samples, exr};
use serde_json::Value;

use super::run::{Ran, bspray, model, names, render};

#[test]
fn inspect_tells_of_the_polygon_tree_in_every_order() {
    let folder = tempfile::tempdir().unwrap();
    let block = model("lecture-block.obj");
    let args = [
        "inspect",
        &block,
        "--bsp",
        "--bsp-order",
        "file",
        "--dot",
        "tree.dot",
    ];
    let ran = bspray(folder.path(), &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    // The lecture's tree: ten fragments of eight faces, since the plane of #3 splits both caps.
    let file = ran.stdout.lines().find(|l| l.starts_with("file ")).unwrap();
    let cells: Vec<_> = file.split_whitespace().collect();
    assert_eq!(cells[1..], ["8", "10", "7", "6.50", "2", "10", "1.25"]);
    assert!(ran.stdout.contains("back 7a\n") && ran.stdout.contains("back 8b\n"));
    let dot = std::fs::read_to_string(folder.path().join("tree.dot")).unwrap();
    assert!(dot.starts_with("digraph bsp {") && dot.contains("label=\"7b\""));

    let json = bspray(folder.path(), &["inspect", &block, "--bsp", "--json"]);
    let value: Value = serde_json::from_str(&json.stdout).unwrap();
    let orders = value["orders"].as_array().unwrap();
    assert_eq!(orders.len(), 6);
    for row in orders {
        assert_eq!(row["polygons"], 8);
        assert!(row["fragments"].as_u64().unwrap() >= 8, "{row}");
    }
    for option in ["--dot", "--svg", "--regions"] {
        let alone = bspray(folder.path(), &["inspect", &block, option, "alone"]);
        assert_eq!(alone.code, Some(2), "{alone:?}");
        assert!(!folder.path().join("alone").exists());
    }
}

/// `inspect --bsp` in the file's order, with more arguments behind.
fn inspect(folder: &Path, model: &str, args: &[&str]) -> Ran {
    let all = [&["inspect", model, "--bsp", "--bsp-order", "file"], args].concat();
    bspray(folder, &all)
}

fn texts(svg: &str) -> Vec<&str> {
    let ends = svg.split("</text>").filter(|part| part.contains("<text"));
    ends.filter_map(|part| part.rsplit('>').next()).collect()
}

#[test]
fn the_lectures_trees_are_drawn_with_their_names() {
    let folder = tempfile::tempdir().unwrap();
    for (name, fragments, cells) in [
        ("lecture-block", "1 2 3 4 5 6 7a 7b 8a 8b", 11),
        ("lecture-edges", "1 2 3 4 5 6 7 8 9a 9b 10 11", 13),
    ] {
        let file = model(&format!("{name}.obj"));
        let ran = inspect(folder.path(), &file, &["--svg", "tree.svg"]);
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
        let svg = fs::read_to_string(folder.path().join("tree.svg")).unwrap();
        assert!(svg.starts_with("<svg xmlns=") && svg.ends_with("</svg>\n"));
        let texts = texts(&svg);
        for fragment in fragments.split(' ') {
            let count = texts.iter().filter(|t| **t == fragment).count();
            assert_eq!(count, 1, "{name}: {fragment}");
        }
        let boxes = fragments.split(' ').count();
        assert_eq!(svg.matches("class=\"node\"").count(), boxes);
        // One more cell than nodes; an edge to each of both but the root, and one in the legend for either side.
        assert_eq!(svg.matches("<rect class=\"cell\"").count(), cells + 1);
        let edges = svg.matches("<line class=\"").count();
        assert_eq!(edges, boxes + cells - 1 + 2, "{name}");
        assert!(texts[0].starts_with(&format!("{name}.obj: ")) && texts[0].contains("order file"));
    }
}

#[test]
fn the_regions_of_the_eleven_edges_are_drawn_with_walls_and_letters() {
    let folder = tempfile::tempdir().unwrap();
    let edges = model("lecture-edges.obj");
    let args = ["--svg", "tree.svg", "--regions", "plane.svg"];
    let ran = inspect(folder.path(), &edges, &args);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    assert_eq!(names(folder.path()), ["plane.svg", "tree.svg"]);
    let svg = fs::read_to_string(folder.path().join("plane.svg")).unwrap();
    let texts = texts(&svg);
    for name in "1 2 3 4 5 6 7 8 9a 9b 10 11 A B C D E F G H I J K L M".split(' ') {
        let count = texts.iter().filter(|t| **t == name).count();
        assert_eq!(count, 1, "{name}");
    }
    assert_eq!(svg.matches("<polygon class=\"region\"").count(), 13);
    assert_eq!(svg.matches("<line class=\"wall\"").count(), 12);
    // Region E is the triangle of #5, #6 and #7, inside of all of them; the tree has it in the same colour.
    let tint = |svg: &str, before: &str| {
        let from = svg
            .split(before)
            .nth(1)
            .and_then(|s| s.split("fill=\"").nth(1));
        from.and_then(|s| s.split('"').next()).map(str::to_owned)
    };
    let region = svg.split("<polygon").find(|p| {
        p.contains("class=\"region\"") && p.split(' ').filter(|w| w.contains(',')).count() == 3
    });
    let fill = tint(region.unwrap(), "points").unwrap();
    let tree = fs::read_to_string(folder.path().join("tree.svg")).unwrap();
    let cell = tree
        .split("<rect class=\"cell\"")
        .find(|c| c.contains(">E</text>"));
    assert!(cell.unwrap().contains(&fill));
}

#[test]
fn drawings_that_make_no_sense_are_refused_in_one_line_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("taken.svg")).unwrap();
    fs::copy(model("lecture-edges.obj"), folder.path().join("own.obj")).unwrap();
    let before = names(folder.path());
    let (block, objects) = (model("lecture-block.obj"), model("lecture-objects.gltf"));
    let cases: [(&str, &[&str], i32, &[&str]); 7] = [
        (
            &block,
            // The tree could be drawn, and is not either.
            &["--svg", "a.svg", "--regions", "b.svg"],
            1,
            &["lecture-block.obj: ", "polygon 7 of \"block\": ", "z axis"],
        ),
        (&objects, &["--svg", "a.svg"], 2, &["--svg", "several"]),
        (
            &objects,
            &["--regions", "a.svg"],
            2,
            &["--regions", "several"],
        ),
        (
            &block,
            &["--svg", "taken.svg"],
            1,
            &["taken.svg: is a directory"],
        ),
        (
            &block,
            &["--regions", "no/b.svg"],
            1,
            &["no/b.svg: ", "no folder no"],
        ),
        (
            &block,
            // One place under two names.
            &["--svg", "a.svg", "--regions", "./a.svg"],
            2,
            &["./a.svg: is named twice as an output"],
        ),
        (
            "own.obj",
            &["--svg", "own.obj"],
            2,
            &["own.obj: would replace an input"],
        ),
    ];
    for (file, args, code, words) in cases {
        let ran = inspect(folder.path(), file, args);
        assert_eq!(ran.code, Some(code), "{args:?}: {ran:?}");
        assert_eq!(ran.stderr.lines().count(), 1, "{args:?}: {ran:?}");
        for word in words {
            assert!(
                ran.stderr.contains(word),
                "{args:?}: want {word:?}: {ran:?}"
            );
        }
        assert!(
            ran.stdout.is_empty() && names(folder.path()) == before,
            "{args:?}: {ran:?}"
        );
    }
}

#[test]
fn of_a_large_tree_the_upper_levels_are_drawn_and_its_regions_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut obj = String::new();
    for i in 0..500 {
        writeln!(obj, "v {i} 0 0\nv {i} 3 0\nv {i} 0 2\nf -3 -2 -1").unwrap();
    }
    fs::write(folder.path().join("rows.obj"), obj).unwrap();
    let ran = inspect(folder.path(), "rows.obj", &["--svg", "tree.svg"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let note = "tree.svg: The upper 60 of 500 levels are drawn, 60 of 500 nodes.\n";
    assert_eq!(ran.stderr, note);
    assert!(fs::metadata(folder.path().join("tree.svg")).unwrap().len() < 100_000);
    let ran = inspect(folder.path(), "rows.obj", &["--regions", "plane.svg"]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(
        ran.stderr
            .contains("rows.obj: --regions: the tree has 500 nodes"),
        "{ran:?}"
    );
    assert_eq!(names(folder.path()), ["rows.obj", "tree.svg"]);
}

/// Numbers of fragments, and depths in the tree.
fn partition(picture: &Picture) -> (Vec<u32>, Vec<f32>) {
    match (picture.channel("fragment.id"), picture.channel("bsp-depth")) {
        (Some(Samples::U32(ids)), Some(Samples::F32(depths))) => (ids.clone(), depths.clone()),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_partition_is_the_same_picture_for_every_structure_that_traces_it() {
    let folder = tempfile::tempdir().unwrap();
    let of = |args: &[&str]| {
        let all = [&["--resolution=40x30", "-q", "-o", "a.exr"], args].concat();
        let file = model("lecture-objects.gltf");
        let ran = bspray(
            folder.path(),
            &[&["render", &file, "--spp=1"][..], &all].concat(),
        );
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
        let mut picture = exr::read(&folder.path().join("a.exr")).expect("an EXR file");
        picture.channels.retain(|c| !c.name.starts_with("cost"));
        picture
    };
    let first = of(&["--integrator=fragment"]);
    let (ids, depths) = partition(&first);
    for (id, depth) in ids.iter().zip(&depths) {
        assert_eq!(*id == u32::MAX, depth.is_infinite());
    }
    assert!(ids.iter().collect::<std::collections::BTreeSet<_>>().len() > 40);
    for kind in ["bsp-polygon", "bvh2", "cwbvh", "linear"] {
        let other = of(&["--integrator=fragment", &format!("--accel={kind}")]);
        assert!(other.channels == first.channels, "{kind}");
    }
    // The other ways to the same layers.
    for args in [&["--integrator=bsp-depth"][..], &["--bsp-layers"]] {
        assert_eq!(
            partition(&of(args)),
            (ids.clone(), depths.clone()),
            "{args:?}"
        );
    }
    for args in [
        ["--bsp-layers", "--bsp-order=file"],
        ["--bsp-layers", "--bsp-merge"],
    ] {
        assert_ne!(partition(&of(&args)).0, ids, "{args:?}");
    }
    assert!(of(&[]).channel("fragment.id").is_none());
}

#[test]
fn a_pixel_tells_the_name_of_its_fragment_and_layers_need_a_file_of_layers() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--bsp-layers", "--bsp-order=file", "--pixel=3,2", "--json"];
    let ran = render(folder.path(), "lecture-block.obj", &args);
    let value: Value = serde_json::from_str(&ran.stdout).unwrap();
    let fragment = &value["center"][0]["hit"]["fragment"];
    let faces = ["1", "3", "4", "5", "7a", "7b"];
    assert!(faces.iter().any(|f| fragment["name"] == *f), "{fragment}");
    let ran = render(folder.path(), "lecture-block.obj", &["--bsp-layers"]);
    assert_eq!(ran.code, Some(2), "{ran:?}");
    assert!(
        ran.stderr
            .starts_with("error: --bsp-layers: only .exr files"),
        "{ran:?}"
    );
    assert!(names(folder.path()).is_empty());
}
