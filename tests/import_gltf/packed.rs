//! One model of ours as optimisers pack it (`packed/make.mjs` made the files, with encoders that are not ours): what is read is the
//! plain model, within what its quantisation allows.

use std::path::{Path, PathBuf};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use bspray::import::load;
use bspray::scene::{Pixels, Scene};
use glam::{DVec3, Vec2};
use serde_json::json;

use crate::model::*;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/import_gltf/packed")
        .join(name)
}

fn scene(name: &str) -> Scene {
    load(&[file(name)]).unwrap_or_else(|e| panic!("{e}"))
}

/// A corner in the world, with its normal there and its texture coordinates, if it has some.
#[derive(Clone, Copy)]
struct Corner {
    position: DVec3,
    normal: DVec3,
    uv: Option<Vec2>,
}

/// The triangles of all instances.
fn triangles(scene: &Scene) -> Vec<[Corner; 3]> {
    let mut found = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh as usize];
        let corner = |v: u32| {
            let v = v as usize;
            let normal = instance.cofactors() * mesh.normals[v].as_dvec3();
            Corner {
                position: instance
                    .world_from_object
                    .transform_point3(mesh.positions[v].as_dvec3()),
                normal: normal.normalize(),
                uv: mesh.uv_sets.first().map(|set| set[v]),
            }
        };
        found.extend(mesh.triangles.iter().map(|t| t.map(corner)));
    }
    found
}

/// How far two triangles lie apart, whichever corner comes first: positions, normals, texture coordinates.
fn distance(a: &[Corner; 3], b: &[Corner; 3]) -> [f64; 3] {
    let turned = (0..3).map(|turn| {
        let mut most = [0.0_f64; 3];
        for k in 0..3 {
            let (a, b) = (&a[k], &b[(k + turn) % 3]);
            let uvs =
                a.uv.zip(b.uv)
                    .map_or(0.0, |(a, b)| f64::from((a - b).length()));
            let apart = [
                (a.position - b.position).length(),
                (a.normal - b.normal).length(),
                uvs,
            ];
            most = std::array::from_fn(|i| most[i].max(apart[i]));
        }
        most
    });
    turned.min_by(|a, b| a[0].total_cmp(&b[0])).expect("three")
}

#[test]
fn packed_models_are_the_plain_one() {
    let plain = scene("plain.glb");
    let expected = triangles(&plain);
    assert_eq!((expected.len(), plain.meshes[0].positions.len()), (360, 77));
    // The model is 6 units long, and twice that far away. Least bits: 14 for positions (6 / 2^14), 8 for normals, 16 for where
    // instances stand. Draco's defaults are 14, 10 and 12.
    for (name, meshes, tolerance) in [
        ("quantised.glb", 1, [6e-4, 0.02, 0.0]),
        ("meshopt-c.glb", 1, [6e-4, 0.02, 0.0]),
        ("meshopt-cc-floats.glb", 1, [6e-4, 0.02, 0.0]),
        ("meshopt-cf.glb", 1, [6e-4, 0.02, 0.0]),
        ("meshopt-cz-khr.glb", 1, [6e-4, 0.02, 0.0]),
        ("meshopt-mi.glb", 1, [4e-3, 2e-3, 0.0]),
        ("draco-edgebreaker.glb", 1, [6e-4, 0.01, 5e-4]),
        ("draco-sequential.glb", 1, [2e-4, 1e-3, 1e-4]),
    ] {
        let packed = scene(name);
        assert_eq!(
            (packed.meshes.len(), packed.instances.len()),
            (meshes, 3),
            "{name}"
        );
        let mut found = triangles(&packed);
        assert_eq!(found.len(), expected.len(), "{name}");
        let mut worst = [0.0_f64; 3];
        for triangle in &expected {
            let apart: Vec<[f64; 3]> = found.iter().map(|f| distance(triangle, f)).collect();
            let nearest = (0..found.len()).min_by(|&i, &j| apart[i][0].total_cmp(&apart[j][0]));
            let nearest = nearest.expect("one each");
            worst = std::array::from_fn(|i| worst[i].max(apart[nearest][i]));
            found.swap_remove(nearest);
        }
        let is_near = worst.iter().zip(tolerance).all(|(w, t)| *w <= t);
        assert!(is_near, "{name}: {worst:?}, at most {tolerance:?}");
        if name.starts_with("draco") {
            assert_eq!(packed.meshes[0].uv_sets.len(), 1, "{name}");
        }
    }
}

#[test]
fn the_fallback_of_compressed_buffers_is_not_needed() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let bytes = std::fs::read(file("meshopt-cf.glb")).expect("read");
    let scene = load_in(folder.path(), "model.glb", &bytes).expect("loads");
    assert_eq!(scene.placed_triangles(), 360);
    refused(&["buffer 0: has no data: it stands for what"], |m| {
        m["buffers"][0] = json!({"byteLength": 36, "extensions": {"EXT_meshopt_compression": {"fallback": true}}});
    });
}

#[test]
fn packed_files_with_any_byte_changed_do_not_panic() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    for (name, step) in [
        ("meshopt-c.glb", 13),
        ("meshopt-cz-khr.glb", 11),
        ("draco-edgebreaker.glb", 3),
        ("draco-sequential.glb", 5),
    ] {
        let whole = std::fs::read(file(name)).expect("read");
        // The JSON comes first: what follows it is compressed.
        let json = u32::from_le_bytes([whole[12], whole[13], whole[14], whole[15]]) as usize;
        for place in (28 + json..whole.len()).step_by(step) {
            let mut changed = whole.clone();
            changed[place] ^= 0x55;
            if let Err(error) = load_in(folder.path(), "model.glb", &changed) {
                expect_words(&error, &[]);
            }
        }
    }
}

#[test]
fn draco_and_meshopt_say_what_is_wrong() {
    let draco = |extension: serde_json::Value| {
        move |m: &mut serde_json::Value| {
            let view = add_view(m, b"DRACO\x02\x02\x01\x01\0\0");
            let mut extension = extension;
            if extension["bufferView"].is_null() {
                extension["bufferView"] = json!(view);
            }
            m["accessors"][0]
                .as_object_mut()
                .expect("there")
                .remove("bufferView");
            m["meshes"][0]["primitives"][0]["extensions"] =
                json!({"KHR_draco_mesh_compression": extension});
        }
    };
    let element = "mesh 0, primitive 0: KHR_draco_mesh_compression: ";
    refused(
        &[element, "buffer view 9 is not there"],
        draco(json!({"bufferView": 9})),
    );
    refused(&[element], draco(json!({"attributes": {"POSITION": 0}})));
    let meshopt = |extension: serde_json::Value| {
        move |m: &mut serde_json::Value| {
            m["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": extension})
        }
    };
    let element = "buffer view 0 (EXT_meshopt_compression): ";
    refused(
        &[element, "has no byteStride"],
        meshopt(json!({"buffer": 0})),
    );
    refused(
        &[element, "claims bytes 0..99 of buffer 0, which has 36"],
        meshopt(
            json!({"buffer": 0, "byteLength": 99, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"}),
        ),
    );
    refused(
        &[element, "claims 51539607540 bytes from 36 compressed ones"],
        meshopt(
            json!({"buffer": 0, "byteLength": 36, "byteStride": 12, "count": u32::MAX, "mode": "ATTRIBUTES"}),
        ),
    );
    refused(
        &[element, "its ATTRIBUTES are broken"],
        meshopt(
            json!({"buffer": 0, "byteLength": 36, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"}),
        ),
    );
    refused(
        &[element, "holds 0 bytes, its byteLength claims 36"],
        meshopt(
            json!({"buffer": 0, "byteLength": 36, "byteStride": 12, "count": 0, "mode": "ATTRIBUTES"}),
        ),
    );
    // With uncompressed accessors beside them, compressed ones are not looked at.
    good(|m| {
        m["meshes"][0]["primitives"][0]["extensions"] =
            json!({"KHR_draco_mesh_compression": {"bufferView": 77, "attributes": {}}});
    });
}

#[test]
fn basis_textures_are_decoded() {
    for (name, tolerance) in [("etc1s.ktx2", 8), ("uastc.ktx2", 10)] {
        let bytes = std::fs::read(file(name)).expect("read");
        let uri = format!("data:image/ktx2;base64,{}", BASE64_STANDARD.encode(&bytes));
        let scene = good(|m| {
            m["extensionsRequired"] = json!(["KHR_texture_basisu"]);
            m["images"] = json!([{"uri": uri, "mimeType": "image/ktx2"}]);
            m["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
            m["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
            m["meshes"][0]["primitives"][0]["material"] = json!(0);
        });
        let image = &scene.images[0];
        assert_eq!((image.width, image.height), (8, 4), "{name}");
        let Some(Pixels::Rgba8(pixels)) = &image.pixels else {
            panic!("{name}: {:?}", scene.notes)
        };
        for (i, pixel) in (0_i32..).zip(pixels) {
            // As `make.mjs` drew it.
            let expected = match (name, i % 8) {
                ("uastc.ktx2", x) => [x * 30, (i / 8) * 60, 51, 255],
                (_, 0..4) => [200, 100, 50, 255],
                _ => [10, 20, 220, 255],
            };
            let apart = pixel
                .iter()
                .zip(expected)
                .map(|(&p, e)| (i32::from(p) - e).abs());
            assert!(
                apart.max() <= Some(tolerance),
                "{name}, pixel {i}: {pixel:?} for {expected:?}"
            );
        }
        // Changed bytes make another picture, or a note and the stand-in.
        for place in (0..bytes.len()).step_by(3) {
            let mut changed = bytes.clone();
            changed[place] ^= 0x55;
            let uri = format!(
                "data:image/ktx2;base64,{}",
                BASE64_STANDARD.encode(&changed)
            );
            good(|m| {
                m["images"] = json!([{"uri": uri}]);
                m["textures"] = json!([{"source": 0}]);
                m["materials"] =
                    json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
                m["meshes"][0]["primitives"][0]["material"] = json!(0);
            });
        }
    }
}
