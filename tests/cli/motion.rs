//! Motion vectors of animations and turntables, and when there are any.

use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use bspray::picture::{Attribute, Picture, Samples, exr};
use glam::{Mat4, Vec2, Vec3};
use serde_json::{Value, json};

use super::run::{bspray, names, render};

const CHANNELS: [&str; 4] = ["backward.u", "backward.v", "forward.u", "forward.v"];

/// Adds an accessor of numbers to a model and gives its index.
fn add(model: &mut Value, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
    let data = BASE64_STANDARD.encode(bytes);
    let uri = format!("data:application/octet-stream;base64,{data}");
    let index = model["buffers"].as_array().expect("an array").len();
    let mut push =
        |key: &str, value: Value| model[key].as_array_mut().expect("an array").push(value);
    push("buffers", json!({"byteLength": bytes.len(), "uri": uri}));
    push(
        "bufferViews",
        json!({"buffer": index, "byteLength": bytes.len()}),
    );
    push(
        "accessors",
        json!({"bufferView": index, "componentType": component, "count": count, "type": kind}),
    );
    index
}

fn add_floats(model: &mut Value, values: &[f32], kind: &str) -> usize {
    let width = match kind {
        "SCALAR" => 1,
        "VEC3" => 3,
        _ => 4,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    add(model, &bytes, 5126, kind, values.len() / width)
}

/// Four unit squares over four seconds, seen by a camera without perspective whose picture is 8 units wide: a node that goes right by a unit a second, one that stands still, a skin whose joint rises by half a
/// unit a second, and a morph target that sinks a quarter. The camera goes with the first one if it is to.
fn squares(moves_camera: bool) -> Value {
    let mut m = json!({
        "asset": {"version": "2.0"}, "scene": 0,
        "buffers": [], "bufferViews": [], "accessors": [],
        "scenes": [{"nodes": [0, 1, 2, 3, 4, 5]}],
        "nodes": [
            {"mesh": 0},
            {"mesh": 0, "translation": [-2, 2, 0]},
            {"mesh": 1, "skin": 0},
            {},
            {"mesh": 2, "translation": [2, -1, 0]},
            {"camera": 0, "translation": [0, 0, 10]},
        ],
        "skins": [{"joints": [3]}],
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 4, "ymag": 4, "znear": 0.1, "zfar": 100}}],
    });
    let square = [
        -0.5, -0.5, 0.0, 0.5, -0.5, 0.0, 0.5, 0.5, 0.0, -0.5, -0.5, 0.0, 0.5, 0.5, 0.0, -0.5, 0.5,
        0.0,
    ];
    let position = add_floats(&mut m, &square, "VEC3");
    let sunk = add_floats(&mut m, &[0.0, -1.0, 0.0].repeat(6), "VEC3");
    let joints = add(&mut m, &[0; 24], 5121, "VEC4", 6);
    let weights = add_floats(&mut m, &[1.0, 0.0, 0.0, 0.0].repeat(6), "VEC4");
    m["meshes"] = json!([
        {"primitives": [{"attributes": {"POSITION": position}}]},
        {"primitives": [{"attributes": {"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights}}]},
        {"primitives": [{"attributes": {"POSITION": position}, "targets": [{"POSITION": sunk}]}]},
    ]);
    let times = add_floats(&mut m, &[0.0, 4.0], "SCALAR");
    let mut channels = vec![
        (0, "translation", vec![0.0, 2.0, 0.0, 4.0, 2.0, 0.0]),
        (3, "translation", vec![-2.0, -2.0, 0.0, -2.0, 0.0, 0.0]),
        (4, "weights", vec![0.0, 1.0]),
    ];
    if moves_camera {
        channels.push((5, "translation", vec![-1.0, 0.0, 10.0, 3.0, 0.0, 10.0]));
    }
    m["animations"] = json!([{"channels": [], "samplers": []}]);
    for (index, (node, path, values)) in channels.into_iter().enumerate() {
        let kind = if path == "weights" { "SCALAR" } else { "VEC3" };
        let output = add_floats(&mut m, &values, kind);
        let mut push = |key: &str, v: Value| {
            m["animations"][0][key]
                .as_array_mut()
                .expect("an array")
                .push(v)
        };
        push("samplers", json!({"input": times, "output": output}));
        push(
            "channels",
            json!({"sampler": index, "target": {"node": node, "path": path}}),
        );
    }
    m
}

/// A picture of a model, 4 pixels a unit.
fn picture(folder: &Path, model: &Value, args: &[&str]) -> Picture {
    std::fs::write(folder.join("a.gltf"), model.to_string()).expect("a model");
    let plain = [
        "render",
        "a.gltf",
        "-o",
        "a.exr",
        "--resolution=32x32",
        "--spp=1",
        "--integrator=normals",
    ];
    let ran = bspray(folder, &[&plain, args].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    exr::read(&folder.join("a.exr")).expect("a picture")
}

fn floats<'p>(picture: &'p Picture, name: &str) -> &'p [f32] {
    match picture.channel(name) {
        Some(Samples::F32(values)) => values,
        other => panic!("{name}: {other:?}"),
    }
}

/// The vector back and the vector on at a place of the model as the camera stands before its middle.
fn vectors(picture: &Picture, (x, y): (f32, f32)) -> [Vec2; 2] {
    let index = ((4.0 - y) * 4.0) as usize * 32 + ((x + 4.0) * 4.0) as usize;
    let [a, b, c, d] = CHANNELS.map(|name| floats(picture, name)[index]);
    [Vec2::new(a, b), Vec2::new(c, d)]
}

#[track_caller]
fn assert_near(found: [Vec2; 2], want: [(f32, f32); 2]) {
    for (found, (x, y)) in found.into_iter().zip(want) {
        assert!(
            (found - Vec2::new(x, y)).length() < 1e-4,
            "{found} is not {x}, {y}"
        );
    }
}

#[test]
fn nodes_skins_and_morphs_move_by_known_pixels_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    let model = squares(false);
    let at = |args: &[&str]| {
        picture(
            folder.path(),
            &model,
            &[&["--animation-index=0"], args].concat(),
        )
    };
    let seen = at(&["--animation-time=1", "--fps=1"]);
    assert_near(vectors(&seen, (1.0, 2.0)), [(-4.0, 0.0), (4.0, 0.0)]);
    assert_near(vectors(&seen, (-2.0, -1.5)), [(0.0, -2.0), (0.0, 2.0)]);
    assert_near(vectors(&seen, (2.0, -1.25)), [(0.0, 1.0), (0.0, -1.0)]);
    // What stands still, and where nothing is.
    assert_eq!(vectors(&seen, (-2.0, 2.0)), [Vec2::ZERO; 2]);
    assert_eq!(vectors(&seen, (0.0, 0.0)), [Vec2::ZERO; 2]);
    // Twice as many frames, half as far.
    let seen = at(&["--animation-time=1", "--fps=2"]);
    assert_near(vectors(&seen, (1.0, 2.0)), [(-2.0, 0.0), (2.0, 0.0)]);
    let seen = at(&["--animation-time=1"]);
    assert_near(
        vectors(&seen, (1.0, 2.0)),
        [(-4.0 / 24.0, 0.0), (4.0 / 24.0, 0.0)],
    );
    // Before its first keyframes and behind its last everything stands.
    let seen = at(&["--fps=1"]);
    assert_near(vectors(&seen, (0.0, 2.0)), [(0.0, 0.0), (4.0, 0.0)]);
}

#[test]
fn a_camera_of_the_file_moves_with_its_node() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--animation-index=0", "--animation-time=1", "--fps=1"];
    let seen = picture(folder.path(), &squares(true), &args);
    assert_near(vectors(&seen, (1.0, 2.0)), [(0.0, 0.0), (0.0, 0.0)]);
    assert_near(vectors(&seen, (-2.0, 2.0)), [(4.0, 0.0), (-4.0, 0.0)]);
    assert_near(vectors(&seen, (-2.0, -1.5)), [(4.0, -2.0), (-4.0, 2.0)]);
}

#[test]
fn a_turntables_vectors_lead_to_where_the_matrices_of_its_frames_have_the_point() {
    let folder = tempfile::tempdir().unwrap();
    let args = [
        "--turntable=16",
        "--frames=1,2,16",
        "--integrator=normals",
        "-o",
        "{frame}.exr",
    ];
    let ran = render(folder.path(), "lecture-objects.gltf", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let read = |frame: u32| exr::read(&folder.path().join(format!("{frame}.exr"))).unwrap();
    let [now, after, before] = [1, 2, 16].map(read);
    let pixel = |picture: &Picture, point: Vec3| {
        let Attribute::M44(m) = &picture.attributes["worldToNDC"] else {
            panic!("no matrix")
        };
        let place = Mat4::from_cols_array(m) * point.extend(1.0);
        Vec2::new(place.x, place.y) / place.w * Vec2::new(4.0, 3.0)
    };
    let mut seen = 0;
    for index in 0..48 {
        let [x, y, z] = ["P.X", "P.Y", "P.Z"].map(|name| floats(&now, name)[index]);
        let [bu, bv, fu, fv] = CHANNELS.map(|name| floats(&now, name)[index]);
        if floats(&now, "Z")[index].is_infinite() {
            let vectors = [Vec2::new(bu, bv), Vec2::new(fu, fv)];
            assert_eq!(vectors, [Vec2::ZERO; 2]);
            continue;
        }
        seen += 1;
        let point = Vec3::new(x, y, z);
        let here = pixel(&now, point);
        for (other, found) in [(&before, Vec2::new(bu, bv)), (&after, Vec2::new(fu, fv))] {
            let want = pixel(other, point) - here;
            assert!(
                (found - want).length() < 1e-3,
                "{index}: {found} is not {want}"
            );
        }
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn pictures_of_no_sequence_have_no_vectors() {
    let cases: [&[&str]; 2] = [&["-o", "1.exr"], &["--turntable=1", "-o", "{frame}.exr"]];
    for args in cases {
        let folder = tempfile::tempdir().unwrap();
        let ran = render(folder.path(), "lecture-block.obj", args);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let picture = exr::read(&folder.path().join("1.exr")).unwrap();
        for name in CHANNELS {
            assert!(picture.channel(name).is_none(), "{args:?}: {name}");
        }
    }
}

#[test]
fn a_frame_rate_without_use_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &str); 4] = [
        (&["--fps=24"], "--animation-index"),
        (
            &["--fps=24", "--animation-index=0"],
            "only .exr files have motion vectors",
        ),
        (
            &["--fps=24", "--animation-index=0", "--turntable=4"],
            "--turntable",
        ),
        (
            &["--fps=0", "--animation-index=0"],
            "want a positive number",
        ),
    ];
    for (args, words) in cases {
        let ran = render(folder.path(), "lecture-objects.gltf", args);
        assert_eq!(ran.code, Some(2), "{args:?}: {ran:?}");
        assert!(ran.stderr.contains(words), "{args:?}: {}", ran.stderr);
        assert!(names(folder.path()).is_empty(), "{args:?}");
    }
}
