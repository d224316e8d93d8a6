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
