//! What the cases change in the sound triangle.

use serde_json::{Value, json};

use crate::model::*;

pub(super) fn bounds(m: &mut Value) -> &mut serde_json::Map<String, Value> {
    m["accessors"][0].as_object_mut().expect("an accessor")
}

pub(super) fn quantise(m: &mut Value) {
    let corners = [0, 0, 3, 0, 1, 0, 3, 0, 0, 2, 3, 0];
    let accessor = set_attribute(m, "POSITION", &corners, UNSIGNED_BYTE, 3, "VEC3");
    let view = m["accessors"][accessor]["bufferView"]
        .as_u64()
        .expect("there") as usize;
    m["bufferViews"][view]["byteStride"] = json!(4);
    m["accessors"][accessor]["min"] = json!([0, 0, 3]);
    m["accessors"][accessor]["max"] = json!([1, 2, 3]);
}

pub(super) fn sparse(m: &mut Value, places: &[u8]) {
    let indices = add_view(m, places);
    let values = add_view(m, &floats(&[0.0, 0.0, 3.0, 0.0, 2.0, 3.0]));
    m["accessors"][0]["sparse"] = json!({"count": 2,
        "indices": {"bufferView": indices, "componentType": UNSIGNED_BYTE}, "values": {"bufferView": values}});
}

pub(super) fn textured(m: &mut Value, image: Value) {
    m["images"] = json!([image]);
    m["textures"] = json!([{"source": 0}]);
    m["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    m["meshes"][0]["primitives"][0]["material"] = json!(0);
    set_attribute(
        m,
        "TEXCOORD_0",
        &floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        FLOAT,
        3,
        "VEC2",
    );
}

pub(super) fn skinned(m: &mut Value) {
    let identity = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let binds = add_accessor(m, &floats(&identity), FLOAT, 1, "MAT4");
    push(m, "nodes", json!({"translation": [1, 0, 0]}));
    m["scenes"][0]["nodes"] = json!([0, 1]);
    m["skins"] = json!([{"joints": [1], "inverseBindMatrices": binds}]);
    m["nodes"][0]["skin"] = json!(0);
    set_attribute(m, "JOINTS_0", &[0; 12], UNSIGNED_BYTE, 3, "VEC4");
    set_attribute(
        m,
        "WEIGHTS_0",
        &floats(&[1.0, 0.0, 0.0, 0.0].repeat(3)),
        FLOAT,
        3,
        "VEC4",
    );
}

pub(super) fn morphing(m: &mut Value, count: u64) {
    let up = add_accessor(m, &floats(&[0.0, 0.0, 8.0].repeat(3)), FLOAT, count, "VEC3");
    m["accessors"][up]["min"] = json!([0, 0, 8]);
    m["accessors"][up]["max"] = json!([0, 0, 8]);
    m["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": up}]);
    m["meshes"][0]["weights"] = json!([1]);
}
