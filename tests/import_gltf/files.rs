//! Containers and ranges: what is read, and how each kind of broken file is told.

use std::path::Path;

use bspray::import;
use glam::Vec3;
use serde_json::json;

use crate::model::*;

#[test]
fn a_triangle_without_indices_and_bounds() {
    let scene = good(|_| {});
    let mesh = &scene.meshes[0];
    assert_eq!(
        mesh.positions,
        [[0.0, 0.0, 3.0], [1.0, 0.0, 3.0], [0.0, 2.0, 3.0]].map(Vec3::from)
    );
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert!(mesh.normals.is_empty() && mesh.colors.is_empty() && mesh.uv_sets.is_empty());
    assert_eq!(mesh.name, "mesh 0");
    let material = &scene.materials[0];
    assert_eq!((material.metallic, material.double_sided), (1.0, false));
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    let same = load_bytes("model.glb", &triangle_glb()).expect("loads");
    assert_eq!(same.meshes[0].positions, mesh.positions);
}

#[test]
fn files_that_are_no_gltf_say_so() {
    let error = |name, bytes: &[u8]| load_bytes(name, bytes).expect_err("broken");
    expect_words(
        &error("model.glb", b"PK\x03\x04"),
        &["begins neither with `glTF` (GLB) nor with `{` (JSON)"],
    );
    expect_words(&error("model.gltf", b""), &["is empty"]);
    expect_words(
        &error(
            "model.gltf",
            b"{\n\"asset\": {\"version\": \"2.0\"},\n\"nodes\": [}",
        ),
        &["JSON: ", "line 3 column 11"],
    );
    expect_words(&error("model.gltf", b"{}"), &["asset.version is missing"]);
    expect_words(
        &error("model.gltf", br#"{"asset":{"version":"1.0"}}"#),
        &["version 1.0 is not supported"],
    );
    expect_words(
        &error(
            "model.gltf",
            br#"{"asset":{"version":1},"meshes":{"a":{}}}"#,
        ),
        &["version 1 is not supported, only 2.0"],
    );
    let mut old = triangle_glb();
    old[4] = 1;
    expect_words(&error("model.glb", &old), &["version 1 is not supported"]);
}

#[test]
fn ranges_are_checked() {
    refused(
        &[
            "mesh 0, primitive 0",
            "accessor 7 is not there: the file has 1",
        ],
        |m| {
            m["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(7);
        },
    );
    refused(
        &["accessor 0: reads bytes 0..48 of buffer view 0, which has 36"],
        |m| m["accessors"][0]["count"] = json!(4),
    );
    refused(
        &["accessor 0: reads bytes 18446744073709551615..18446744073709551615"],
        |m| {
            m["accessors"][0]["byteOffset"] = json!(u64::MAX);
        },
    );
    refused(&["buffer view 9 is not there: the file has 1"], |m| {
        m["accessors"][0]["bufferView"] = json!(9)
    });
    refused(&["buffer 9 is not there: the file has 1"], |m| {
        m["bufferViews"][0]["buffer"] = json!(9)
    });
    refused(
        &["buffer view 0 claims bytes 40..76 of buffer 0, which has 36"],
        |m| m["bufferViews"][0]["byteOffset"] = json!(40),
    );
    refused(
        &["the stride of buffer view 0 is 8 bytes, an element has 12"],
        |m| m["bufferViews"][0]["byteStride"] = json!(8),
    );
    refused(
        &["accessor 0: its elements have 2 components, not 3"],
        |m| m["accessors"][0]["type"] = json!("VEC2"),
    );
    refused(&["accessor 0: its componentType is unknown"], |m| {
        m["accessors"][0]["componentType"] = json!(5130)
    });
    refused(&["mesh 0, primitive 0: index 2 names vertex 3 of 3"], |m| {
        set_indices(m, &[0, 1, 3])
    });
    refused(&["indices must be unsigned integers"], |m| {
        m["meshes"][0]["primitives"][0]["indices"] = json!(0)
    });
    refused(&["NORMAL: accessor 1 has 2 elements for 3 vertices"], |m| {
        set_attribute(m, "NORMAL", &floats(&[1.0; 6]), FLOAT, 2, "VEC3");
    });
    refused(&["material 2 is not there"], |m| {
        m["meshes"][0]["primitives"][0]["material"] = json!(2)
    });
    refused(&["its mode is unknown"], |m| {
        m["meshes"][0]["primitives"][0]["mode"] = json!(9)
    });
    refused(&["node 0: mesh 5 is not there: the file has 1"], |m| {
        m["nodes"][0]["mesh"] = json!(5)
    });
    // The scene does not use these.
    good(|m| {
        push(
            m,
            "meshes",
            json!({"primitives": [{"attributes": {"POSITION": 99}}]}),
        );
        push(
            m,
            "buffers",
            json!({"byteLength": 10, "uri": "missing.bin"}),
        );
        push(m, "nodes", json!({"mesh": 1, "children": [1]}));
    });
}

#[test]
fn claims_of_4_gib_cost_nothing() {
    refused(
        &["buffer 0: truncated: has 36 bytes, its byteLength claims 4294967295"],
        |m| {
            m["buffers"][0]["byteLength"] = json!(u32::MAX);
        },
    );
    refused(
        &["accessor 0: reads bytes 0..51539607540 of buffer view 0"],
        |m| m["accessors"][0]["count"] = json!(u32::MAX),
    );
    refused(
        &["accessor 0: its count of 4294967296 is beyond 32 bits"],
        |m| m["accessors"][0]["count"] = json!(1_u64 << 32),
    );
    refused(
        &["claims 4294967295 elements without a buffer view; at most 1048576"],
        |m| {
            m["accessors"][0] = json!({"componentType": FLOAT, "count": u32::MAX, "type": "VEC3"});
        },
    );
    let mut header = triangle_glb();
    header[8..12].fill(0xFF);
    expect_words(
        &load_bytes("model.glb", &header).expect_err("broken"),
        &["GLB header", "claims 4294967295 bytes"],
    );
    let mut chunk = triangle_glb();
    chunk[12..16].fill(0xFF);
    expect_words(
        &load_bytes("model.glb", &chunk).expect_err("broken"),
        &["GLB chunk 0", "claims 4294967295 bytes"],
    );
}

#[test]
fn a_glb_cut_anywhere_is_an_error() {
    let whole = triangle_glb();
    let directory = tempfile::tempdir().expect("a temporary directory");
    for length in 0..whole.len() {
        let mut cut = whole[..length].to_vec();
        let error = load_in(directory.path(), "model.glb", &cut).expect_err("cut");
        assert!(error.contains("model.glb: "), "{error}");
        // The same with a header that says the truth.
        if length >= 12 {
            cut[8..12].copy_from_slice(&(length as u32).to_le_bytes());
            let error = load_in(directory.path(), "model.glb", &cut).expect_err("cut");
            assert!(error.contains("model.glb: "), "{error}");
        }
    }
    let mut longer = whole.clone();
    longer.extend([0; 5]);
    let scene = load_in(directory.path(), "model.glb", &longer).expect("loads");
    assert!(has_note(&scene, "5 bytes after the end are ignored"));
}

#[test]
fn a_glb_with_any_byte_changed_does_not_panic() {
    let whole = triangle_glb();
    let directory = tempfile::tempdir().expect("a temporary directory");
    for place in 0..whole.len() {
        for change in [0x01, 0xFF] {
            let mut changed = whole.clone();
            changed[place] ^= change;
            // Either is fine; what loads keeps its promises (checked in `load_in`).
            let _ = load_in(directory.path(), "model.glb", &changed);
        }
    }
}

#[test]
fn buffers_come_from_where_the_file_says() {
    let binary = floats(&[0.0, 0.0, 3.0, 1.0, 0.0, 3.0, 0.0, 2.0, 3.0]);
    let directory = tempfile::tempdir().expect("a temporary directory");
    let inner = directory.path().join("inner");
    std::fs::create_dir(&inner).expect("made");
    std::fs::write(directory.path().join("with space.bin"), &binary).expect("written");
    std::fs::write(inner.join("per%20cent.bin"), &binary).expect("written");
    let with_uri = |uri: &str| {
        let mut model = triangle();
        model["buffers"][0]["uri"] = json!(uri);
        load_in(&inner, "model.gltf", model.to_string().as_bytes())
    };
    for uri in [
        "../with%20space.bin",
        "../with space.bin",
        "per%2520cent.bin",
        "per%20cent.bin",
        "..\\with space.bin",
    ] {
        assert!(with_uri(uri).is_ok(), "{uri}");
    }
    expect_words(
        &with_uri("gone.bin").expect_err("missing"),
        &["mesh 0, primitive 0", "buffer 0: cannot read", "gone.bin"],
    );
    expect_words(
        &with_uri("https://example.com/x.bin").expect_err("remote"),
        &["buffer 0: ", "has a scheme"],
    );
    expect_words(
        &with_uri("/x.bin").expect_err("absolute"),
        &["buffer 0: ", "absolute path"],
    );
    expect_words(
        &with_uri("data:;base64,AAAA").expect_err("short"),
        &["has 3 bytes, its byteLength claims 36"],
    );
    expect_words(&with_uri("..").expect_err("directory"), &["is not a file"]);
    refused(&["buffer 0: has no URI"], |m| {
        m["buffers"][0] = json!({"byteLength": 36})
    });
}

#[test]
fn the_malformed_models_say_what_is_wrong() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/malformed");
    for (name, words) in [
        (
            "truncated.glb",
            "GLB header: truncated: claims 552 bytes, the file has 300",
        ),
        (
            "huge-claim.glb",
            "GLB header: truncated: claims 4294967295 bytes",
        ),
        (
            "cyclic-nodes.gltf",
            "node 1 \"arm\": hangs from itself: node 2 \"hand\" names it as a child",
        ),
        (
            "index-out-of-range.gltf",
            "mesh 0 \"quad\", primitive 0: index 4 names vertex 9 of 4",
        ),
        (
            "required-extension.gltf",
            "not supported: KHR_gaussian_splatting; export",
        ),
        ("empty-mesh.gltf", "nothing to render: no triangles"),
        ("missing-buffer.gltf", "buffer 0: cannot read"),
    ] {
        let file = folder.join(name);
        assert!(file.is_file(), "{name}");
        let error = bspray::import::load(&[file]).expect_err(name).to_string();
        assert!(error.contains(words) && error.contains(name), "{error}");
    }
}

#[test]
fn a_file_may_bring_lights_alone_to_the_models_of_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let lights = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 7 }] } },
        "nodes": [{ "translation": [1, 2, 3], "extensions": { "KHR_lights_punctual": { "light": 0 } } }],
        "scenes": [{ "nodes": [0] }], "scene": 0
    });
    let [lit, model, empty] =
        ["lights.gltf", "model.glb", "empty.gltf"].map(|name| folder.path().join(name));
    std::fs::write(&lit, lights.to_string()).expect("written");
    std::fs::write(&model, triangle_glb()).expect("written");
    std::fs::write(&empty, r#"{"asset":{"version":"2.0"}}"#).expect("written");
    for files in [[&lit, &model], [&model, &lit]] {
        let scene = import::load(&files.map(Clone::clone)).expect("loads");
        assert_eq!((scene.lights.len(), scene.placed_triangles()), (1, 1));
    }
    for (files, at_fault) in [
        (vec![&lit], &lit),
        (vec![&model, &empty], &empty),
        (vec![&lit, &lit], &lit),
    ] {
        let files: Vec<_> = files.into_iter().cloned().collect();
        let error = import::load(&files).expect_err("no triangles").to_string();
        assert!(error.starts_with(&*at_fault.to_string_lossy()), "{error}");
        assert!(error.contains("nothing to render: no triangles"), "{error}");
    }
}
