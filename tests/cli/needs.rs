//! What is not spent on a picture that cannot show it: what is built, read and shared, and the reports on it.

use serde_json::Value;

use super::run::{bspray, model, picture};

fn json(args: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let ran = bspray(folder.path(), args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    serde_json::from_str(&ran.stdout).expect("JSON")
}

fn used(value: &Value, name: &str) -> (u64, u64) {
    let row = &value["needs"][name];
    let number = |key: &str| {
        row[key]
            .as_u64()
            .unwrap_or_else(|| panic!("{name}: {value}"))
    };
    (number("held"), number("used"))
}

#[test]
fn needs_tells_what_a_picture_uses_of_the_models() {
    let objects = model("lecture-objects.gltf");
    let args = [
        "inspect",
        &objects,
        "--needs",
        "--json",
        "--resolution",
        "64x36",
    ];
    let value = json(&args);
    let (triangles, used_triangles) = used(&value, "triangles");
    let (_, used_instances) = used(&value, "instances");
    assert!(0 < used_triangles && used_triangles < triangles, "{value}");
    assert!(used_instances > 3, "{value}");
    for (name, row) in value["needs"].as_object().unwrap() {
        if let (Some(held), Some(used)) = (row["held"].as_u64(), row["used"].as_u64()) {
            assert!(used <= held, "{name}: {value}");
        }
    }
    let meshes = value["meshes"].as_array().unwrap();
    let sum = |key: &str| meshes.iter().map(|m| m[key].as_u64().unwrap()).sum::<u64>();
    assert_eq!(sum("triangles"), triangles);
    assert_eq!(sum("triangles_used"), used_triangles);
    assert_eq!(value["samples"], 64 * 36);

    // From far off, looking away.
    let away = [
        "--camera-position",
        "0,0,500",
        "--camera-focal-point",
        "0,0,900",
    ];
    let value = json(&[&args[..], &away].concat());
    assert_eq!(used(&value, "triangles"), (triangles, 0));
    assert_eq!(value["pixels"]["used"], 0);
}

#[test]
fn needs_is_a_table_too() {
    let folder = tempfile::tempdir().unwrap();
    let block = model("lecture-block.obj");
    let args = ["inspect", &block, "--needs", "--resolution", "16x9"];
    let ran = bspray(folder.path(), &args);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    for row in [
        "triangles  ",
        "pixels  ",
        "mesh bytes  ",
        "repeated triangles  ",
        "load ",
    ] {
        assert!(ran.stdout.contains(row), "{row}: {}", ran.stdout);
    }
    // It belongs to nothing else.
    for other in [["--bsp"], ["--extent-table"]] {
        let args = [&["inspect", &block, "--needs"][..], &other].concat();
        assert_eq!(bspray(folder.path(), &args).code, Some(2));
    }
    assert_eq!(
        bspray(folder.path(), &["inspect", &block, "--spp", "4"]).code,
        Some(2)
    );
}

#[test]
fn pictures_do_not_depend_on_when_what_is_built() {
    for accel in ["bsp", "bvh2", "cwbvh"] {
        let at = |time| picture(&["--accel", accel, "--build", time, "--threads", "2"]);
        let ahead = at("ahead");
        assert!(ahead == at("reached") && ahead == at("auto"), "{accel}");
    }
    // Of paths, shadow rays are saved besides.
    let direct = |more: &[&str]| picture(&[&["--integrator", "direct"], more].concat());
    let exhaustive = direct(&["--exhaustive"]);
    assert!(exhaustive == direct(&[]) && exhaustive == direct(&["--exhaustive", "--threads", "1"]));
}

#[test]
fn render_tells_what_its_picture_used() {
    let objects = model("lecture-objects.gltf");
    let args = [
        "render",
        &objects,
        "--json",
        "--resolution",
        "32x18",
        "--spp",
        "1",
        "-o",
        "a.png",
    ];
    let reached = json(&[&args[..], &["--build", "reached"]].concat());
    let ahead = json(&[&args[..], &["--exhaustive"]].concat());
    assert_eq!(reached["needs"]["triangles"], ahead["needs"]["triangles"]);
    let share = |value: &Value| value["accelerator"]["built_share"].as_f64().unwrap();
    assert!(share(&ahead) >= 1.0 && share(&reached) > 0.0, "{reached}");
    let (held, built) = used(&reached, "triangles_in_built_cells");
    assert_eq!(reached["accelerator"]["unbuilt_triangles"], held - built);
    assert!(reached["seconds"]["first_pixel"].as_f64().unwrap() > 0.0);
}

#[test]
fn images_that_a_picture_cannot_show_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let courtyard = model("courtyard.glb");
    let render = |integrator: &str, more: &[&str]| {
        let name = format!("{integrator}{}.png", more.len());
        let args = [
            "render",
            &courtyard,
            "--json",
            "--resolution",
            "32x18",
            "--spp",
            "2",
            "--integrator",
            integrator,
            "-o",
            &name,
        ];
        let ran = bspray(folder.path(), &[&args[..], more].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let value: Value = serde_json::from_str(&ran.stdout).expect("JSON");
        let picture = std::fs::read(folder.path().join(name)).unwrap();
        (
            used(&value, "decoded_images").0,
            used(&value, "images").0,
            picture,
        )
    };
    for integrator in ["normals", "ao", "id", "facing", "uv", "cost"] {
        let (decoded, images, picture) = render(integrator, &[]);
        let (all, _, whole) = render(integrator, &["--exhaustive"]);
        assert!(picture == whole, "{integrator}");
        assert!(
            decoded < all && all <= images,
            "{integrator}: {decoded} of {all}"
        );
    }
    // What is read, and levels that are built when they are wanted, are what they would be.
    assert!(render("whitted", &[]).2 == render("whitted", &["--exhaustive"]).2);
    let (decoded, _, _) = render("albedo", &[]);
    assert_eq!(decoded, render("albedo", &["--exhaustive"]).0);
    // Layers show colours.
    let (decoded, _, _) = render("id", &["-o", "a.exr"]);
    assert_eq!(decoded, render("albedo", &[]).0);
}

/// A glTF file of three meshes with the same bumpy sheet of 1,152 triangles: red, shining, and green.
fn sheets(folder: &std::path::Path) -> String {
    let side = 25_u16;
    let mut bytes = Vec::new();
    for i in 0..side * side {
        let (x, y) = (f32::from(i % side) / 24.0, f32::from(i / side) / 24.0);
        let bump = (x * 9.0 + y * 5.0) % 1.0;
        [x - 0.5, y - 0.5, 0.05 * bump]
            .iter()
            .for_each(|c| bytes.extend(c.to_le_bytes()));
    }
    let positions = bytes.len();
    for i in 0..24 * 24 {
        let v = i % 24 + i / 24 * side;
        [v, v + 1, v + side, v + 1, v + 1 + side, v + side]
            .iter()
            .for_each(|c| bytes.extend(c.to_le_bytes()));
    }
    std::fs::write(folder.join("sheets.bin"), &bytes).expect("it can be written");
    let mesh = |material: u32| serde_json::json!({ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": material }] });
    let node = |mesh: u32| serde_json::json!({ "mesh": mesh, "translation": [1.2 * f64::from(mesh), 0.0, 0.0] });
    let plain = |color: [f32; 4]| serde_json::json!({ "pbrMetallicRoughness": { "baseColorFactor": color, "metallicFactor": 0.0 } });
    let document = serde_json::json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0, 1, 2] }],
        "nodes": [node(0), node(1), node(2)],
        "meshes": [mesh(0), mesh(1), mesh(2)],
        "materials": [
            plain([1.0, 0.0, 0.0, 1.0]),
            { "emissiveFactor": [1.0, 1.0, 1.0] },
            plain([0.0, 1.0, 0.0, 1.0]),
        ],
        "buffers": [{ "uri": "sheets.bin", "byteLength": bytes.len() }],
        "bufferViews": [
            { "buffer": 0, "byteLength": positions },
            { "buffer": 0, "byteOffset": positions, "byteLength": bytes.len() - positions },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": side * side, "type": "VEC3", "min": [-0.5, -0.5, 0.0], "max": [0.5, 0.5, 0.05] },
            { "bufferView": 1, "componentType": 5123, "count": 24 * 24 * 6, "type": "SCALAR" },
        ],
    });
    let file = folder.join("sheets.gltf");
    std::fs::write(&file, document.to_string()).expect("it can be written");
    file.to_str().expect("UTF-8").to_owned()
}

#[test]
fn copies_of_a_mesh_share_it_and_show_their_own_materials() {
    let folder = tempfile::tempdir().unwrap();
    let model = sheets(folder.path());
    let inspected = json(&["inspect", &model, "--json"]);
    assert_eq!(
        inspected["meshes"].as_array().unwrap().len(),
        1,
        "{inspected}"
    );
    let own: Vec<&Value> = (0..3)
        .map(|i| &inspected["instances"][i]["materials"])
        .collect();
    assert_eq!(
        own,
        [
            &Value::Null,
            &serde_json::json!([1]),
            &serde_json::json!([2])
        ]
    );
    let args = [
        "render",
        &model,
        "--resolution=96x32",
        "--spp=64",
        // No ray of this one is left to chance, so that all differences are of the meshes.
        "--integrator=whitted",
        "-q",
        "-o",
    ];
    for (name, more) in [
        ("shared.exr", &[][..]),
        ("whole.exr", &["--exhaustive"]),
        ("coarse.exr", &["--lod=0.3"]),
    ] {
        let ran = bspray(folder.path(), &[&args[..], &[name], more].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
    }
    // The light of the second falls on its neighbours.
    for (name, most) in [("shared.exr", 1e-4), ("coarse.exr", 0.02)] {
        let found = json(&[
            "diff",
            &folder.path().join(name).to_string_lossy(),
            &folder.path().join("whole.exr").to_string_lossy(),
            "--only=R,G,B",
            "--json",
            "--warn=inf",
            "--fail=inf",
        ]);
        let flip = found["color"]["flip"].as_f64().unwrap();
        assert!(flip < most, "{name}: {flip}");
    }
    // Each is what it was.
    for (x, name) in [(20, 0), (48, 1), (76, 2)] {
        let pixel = format!("--pixel={x},16");
        let found = json(&[
            "render",
            &model,
            "--resolution=96x32",
            "--spp=1",
            "--json",
            &pixel,
        ]);
        assert_eq!(found["center"][0]["hit"]["material"], name, "{found}");
    }
}

#[test]
fn images_are_kept_as_finely_as_they_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let courtyard = model("courtyard.glb");
    let args = [
        "render",
        &courtyard,
        "--integrator",
        "albedo",
        "--spp",
        "1",
        "--quiet",
        "--json",
    ];
    let run = |size: &str, more: &[&str], output: &str| {
        let own = ["--resolution", size, "-o", output];
        let ran = bspray(folder.path(), &[&args[..], &own, more].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let value: Value = serde_json::from_str(&ran.stdout).unwrap();
        let pixels = std::fs::read(folder.path().join(output)).unwrap();
        (used(&value, "decoded_image_bytes"), pixels)
    };
    let ((held, kept), small) = run("64x36", &[], "small.png");
    assert!(0 < kept && kept < held / 2, "{kept} of {held}");
    let (all, exhaustive) = run("64x36", &["--exhaustive"], "exhaustive.png");
    assert_eq!(all, (held, held));
    assert_eq!(small, exhaustive);
    // It is told beforehand.
    let before = [
        "inspect",
        &courtyard,
        "--needs",
        "--json",
        "--resolution",
        "64x36",
    ];
    let (told, foretold) = used(&json(&before), "decoded_image_bytes");
    assert!(told == held && 0 < foretold && foretold < held / 2);
    // A larger picture shows more, and layers want all.
    let ((_, finer), _) = run("640x360", &[], "large.png");
    assert!(kept < finer, "{kept} {finer}");
    let layers = ["-o", "layers.exr"];
    assert_eq!(run("64x36", &layers, "beside.png").0, (held, held));
}
