//! Small glTF files that claim much, or ask for the same thing again and again.

use serde_json::{Value, json};

use crate::import_contract::load_checked;
use crate::setup::{MEMORY, add, expect, load, load_within, options, refused, triangle};

const HOW_TO_RAISE: &str = "--memory-limit raises the limit";

fn repeated(item: &Value, count: usize) -> Value {
    Value::Array(vec![item.clone(); count])
}

#[test]
fn counts_beyond_the_bytes_are_told() {
    for (path, value, words) in [
        (
            "/accessors/0/count",
            json!(1_u64 << 40),
            "count of 1099511627776",
        ),
        ("/accessors/0/count", json!(u64::MAX), "accessor 0"),
        ("/accessors/0/count", json!(1e300), "JSON"),
        (
            "/buffers/0/byteLength",
            json!(1_u64 << 50),
            "truncated: has 36 bytes",
        ),
        (
            "/bufferViews/0/byteLength",
            json!(u64::MAX),
            "buffer view 0 claims bytes",
        ),
        ("/accessors/0/byteOffset", json!(u64::MAX), "reads bytes"),
        (
            "/buffers/0/uri",
            json!("data:;base64,AAAA*"),
            "is not base64",
        ),
        ("/buffers/0/uri", json!("data:;base64"), "no comma"),
        ("/buffers/0/uri", json!("data:"), "no comma"),
    ] {
        let mut model = triangle();
        match model.pointer_mut(path) {
            Some(place) => *place = value,
            None => model["accessors"][0]["byteOffset"] = value,
        }
        refused(&model, &[words]);
    }
}

#[test]
fn many_instances_of_no_bytes_are_refused_before_they_are_made() {
    let mut model = triangle();
    add(
        &mut model,
        "accessors",
        json!({"componentType": 5126, "count": 1 << 20, "type": "VEC3"}),
    );
    let attributes = json!({"attributes": {"TRANSLATION": 1}});
    let node = json!({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": attributes}});
    model["nodes"] = repeated(&node, 1000);
    model["scenes"] = json!([{"nodes": (0..1000).collect::<Vec<_>>()}]);
    refused(&model, &["node 0", "would take", HOW_TO_RAISE]);
    // With all the memory that there is the format's reader has a limit of its own.
    let text = model.to_string();
    let within = options(u64::MAX, false);
    let error = load_within("model.gltf", text.as_bytes(), &within).expect_err("too many");
    expect(&error, &["more than 4194304 instances"]);
}

#[test]
fn names_are_charged_for_every_instance() {
    let mut model = triangle();
    add(
        &mut model,
        "accessors",
        json!({"componentType": 5126, "count": 5000, "type": "VEC3"}),
    );
    let attributes = json!({"attributes": {"TRANSLATION": 1}});
    model["nodes"][0] = json!({
        "mesh": 0, "name": "n".repeat(1 << 20),
        "extensions": {"EXT_mesh_gpu_instancing": attributes},
    });
    refused(&model, &["node 0 \"nnn", " ... ", HOW_TO_RAISE]);
}

#[test]
fn primitives_that_share_an_accessor_are_charged_each() {
    let mut model = triangle();
    // No bytes, and an element that is replaced.
    add(
        &mut model,
        "accessors",
        json!({
            "componentType": 5126, "count": 1 << 20, "type": "VEC3",
            "sparse": {
                "count": 1,
                "indices": {"bufferView": 0, "componentType": 5121},
                "values": {"bufferView": 0},
            },
        }),
    );
    let primitive = |set: usize| json!({"attributes": {"POSITION": 1}, "material": set % 2});
    model["materials"] = json!([{}, {}]);
    model["meshes"][0]["primitives"] = (0..5000).map(primitive).collect();
    refused(&model, &["mesh 0, primitive", HOW_TO_RAISE]);
}

#[test]
fn primitives_of_many_kinds_take_no_time_to_tell_apart() {
    let mut model = triangle();
    // Each names another accessor.
    model["accessors"] = repeated(&model["accessors"][0], 20_000);
    let primitive = |n: usize| json!({"attributes": {"POSITION": n}});
    model["meshes"][0]["primitives"] = (0..20_000).map(primitive).collect();
    let text = model.to_string();
    let scene = load_within("model.gltf", text.as_bytes(), &options(1 << 30, false));
    assert_eq!(scene.expect("loads").meshes[0].triangles.len(), 20_000);
}

#[test]
fn weights_of_many_nodes_are_charged() {
    let mut model = triangle();
    let primitive = &mut model["meshes"][0]["primitives"][0];
    primitive["targets"] = repeated(&json!({"POSITION": 0}), 2000);
    model["meshes"][0]["weights"] = repeated(&json!(1), 2000);
    model["nodes"] = repeated(&json!({"mesh": 0}), 5000);
    model["scenes"] = json!([{"nodes": (0..5000).collect::<Vec<_>>()}]);
    refused(&model, &["would take", HOW_TO_RAISE]);
}

#[test]
fn keyframes_that_many_channels_share_are_read_once() {
    let mut model = triangle();
    // Without bytes all times are zero, which ascends.
    add(
        &mut model,
        "accessors",
        json!({"componentType": 5126, "count": 1 << 18, "type": "SCALAR"}),
    );
    add(
        &mut model,
        "accessors",
        json!({"componentType": 5126, "count": 1 << 18, "type": "VEC3"}),
    );
    let channel = json!({"sampler": 0, "target": {"node": 0, "path": "translation"}});
    model["animations"] = json!([{
        "samplers": [{"input": 1, "output": 2}],
        "channels": repeated(&channel, 20_000),
    }]);
    let text = model.to_string();
    let loaded = load_within("model.gltf", text.as_bytes(), &options(512 << 20, true));
    assert!(loaded.is_ok(), "{loaded:?}");
}

#[test]
fn chains_of_100_000_nodes_are_walked() {
    let count = 100_000;
    let mut model = triangle();
    let node = |n: usize| json!({"children": [n + 1]});
    let mut nodes: Vec<Value> = (0..count).map(node).collect();
    nodes.push(json!({"mesh": 0}));
    model["nodes"] = Value::Array(nodes);
    let text = model.to_string();
    let within = options(1 << 30, false);
    let scene = load_within("model.gltf", text.as_bytes(), &within).expect("loads");
    assert_eq!(scene.instances.len(), 1);
    model["nodes"][count]["children"] = json!([0]);
    let text = model.to_string();
    let error = load_within("model.gltf", text.as_bytes(), &within).expect_err("a cycle");
    expect(&error, &["node 0"]);
}

#[test]
fn nests_of_json_are_refused() {
    let asset = r#"{"asset":{"version":"2.0"},"extras":"#;
    for open in ["[", "{\"a\":"] {
        let text = format!("{asset}{}", open.repeat(100_000));
        let within = options(1 << 30, false);
        let error = load_within("model.gltf", text.as_bytes(), &within).expect_err("deep");
        expect(&error, &["model.gltf: JSON: ", "line 1 column"]);
    }
}

#[test]
fn empty_objects_are_charged_before_they_are_parsed() {
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{}{{}}]}}"#,
        "{},".repeat(1 << 20)
    );
    let error = load("model.gltf", text.as_bytes()).expect_err("too many");
    expect(&error, &["model.gltf: JSON: would take 1.", HOW_TO_RAISE]);
}

#[test]
fn meshopt_and_draco_claims_are_charged() {
    let mut model = triangle();
    // A valid claim of 1024 bytes for one, on 1 MiB that is not compressed data.
    let bytes = vec![0x41_u8; 1 << 20];
    let text = format!("data:,{}", String::from_utf8(bytes).expect("text"));
    add(
        &mut model,
        "buffers",
        json!({"byteLength": 1 << 20, "uri": text}),
    );
    model["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": {
        "buffer": 1, "byteLength": 1 << 20, "byteStride": 256, "count": 1 << 22, "mode": "ATTRIBUTES",
    }});
    refused(
        &model,
        &["buffer view 0", "would take 3.0 GiB", HOW_TO_RAISE],
    );

    let mut model = triangle();
    model["accessors"][0] = json!({"componentType": 5126, "count": u32::MAX, "type": "VEC3"});
    model["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    refused(&model, &["mesh 0, primitive 0", HOW_TO_RAISE]);
}

#[test]
fn the_element_that_is_refused_does_not_depend_on_threads() {
    let mut model = triangle();
    let mesh = |n: usize| json!({"primitives": [{"attributes": {"POSITION": n}}]});
    for accessor in 1..40 {
        let count = 3000 * (1 + (accessor * 7) % 11);
        add(
            &mut model,
            "accessors",
            json!({"componentType": 5126, "count": count, "type": "VEC3"}),
        );
    }
    model["meshes"] = (0..40).map(mesh).collect();
    model["nodes"] = (0..40).map(|n| json!({"mesh": n})).collect();
    model["scenes"] = json!([{"nodes": (0..40).collect::<Vec<_>>()}]);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("model.gltf");
    std::fs::write(&file, model.to_string()).expect("written");
    let within = options(12 << 20, false);
    let first = load_checked(&file, &within).expect_err("too much");
    for threads in [1, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let error = pool
            .expect("a pool")
            .install(|| load_checked(&file, &within));
        assert_eq!(error.expect_err("too much"), first);
    }
}

#[test]
fn files_of_one_import_share_the_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("model.obj");
    let text = format!(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n#{}\n",
        "x".repeat(1 << 20)
    );
    std::fs::write(&file, text).expect("written");
    let load = |count: usize| {
        bspray::import::load_with(&vec![file.clone(); count], &options(MEMORY / 8, false))
    };
    assert!(load(2).is_ok());
    let error = load(9).expect_err("too much");
    expect(
        &error.to_string(),
        &[
            "model.obj: file: would take 1.0 MiB more memory",
            HOW_TO_RAISE,
        ],
    );
}
