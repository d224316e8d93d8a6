//! Accessors in all their forms, and the meshes made of them.

use bspray::scene::DefectCause;
use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use crate::model::*;

#[test]
fn quantised_positions_of_every_component_type() {
    // The corners (0, 0, 3), (100, 0, 3) and (0, 50, 3), as they are and as fractions of the largest.
    let corners = [0, 0, 3, 100, 0, 3, 0, 50, 3];
    let bytes: Vec<u8> = corners.to_vec();
    let words: Vec<u8> = corners
        .iter()
        .flat_map(|&c| u16::from(c).to_le_bytes())
        .collect();
    let longs: Vec<u8> = corners
        .iter()
        .flat_map(|&c| u32::from(c).to_le_bytes())
        .collect();
    for (component, bytes, most) in [
        (BYTE, &bytes, 127.0),
        (UNSIGNED_BYTE, &bytes, 255.0),
        (SHORT, &words, 32_767.0),
        (UNSIGNED_SHORT, &words, 65_535.0),
        (UNSIGNED_INT, &longs, 4_294_967_295.0_f32),
    ] {
        for (is_normalized, unit) in [(false, 1.0), (true, most)] {
            let scene = good(|m| {
                let accessor = set_attribute(m, "POSITION", bytes, component, 3, "VEC3");
                m["accessors"][accessor]["normalized"] = json!(is_normalized);
            });
            let found = scene.meshes[0].positions[1];
            let expected = Vec3::new(100.0, 0.0, 3.0) / unit;
            assert!(
                (found - expected).length() <= 1e-7 * expected.length(),
                "{component}: {found} instead of {expected}"
            );
        }
    }
}

#[test]
fn normals_colours_and_texture_coordinates_of_integers() {
    let scene = good(|m| {
        // -128 and -127 both mean -1; the fourth byte of each is padding.
        let normals = [0x80, 0, 0, 9, 0, 0x81, 0, 9, 0, 0, 0, 9];
        let accessor = set_attribute(m, "NORMAL", &normals, BYTE, 3, "VEC3");
        m["accessors"][accessor]["normalized"] = json!(true);
        let view = m["accessors"][accessor]["bufferView"]
            .as_u64()
            .expect("there") as usize;
        m["bufferViews"][view]["byteStride"] = json!(4);
        set_attribute(
            m,
            "COLOR_0",
            &[255, 0, 51, 0, 255, 0, 1, 2, 3],
            UNSIGNED_BYTE,
            3,
            "VEC3",
        );
        let uvs = shorts(&[32_767, 0, -32_768, 16_384, 0, 0]);
        let accessor = set_attribute(m, "TEXCOORD_1", &uvs, SHORT, 3, "VEC2");
        m["accessors"][accessor]["normalized"] = json!(true);
    });
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.normals, [Vec3::NEG_X, Vec3::NEG_Y, Vec3::ZERO]);
    assert_eq!(mesh.colors[0], Vec4::new(1.0, 0.0, 0.2, 1.0));
    assert_eq!(mesh.uv_sets.len(), 2);
    assert!(mesh.uv_sets[0].is_empty());
    assert_eq!(mesh.uv_sets[1][1], Vec2::new(-1.0, 16_384.0 / 32_767.0));
}

#[test]
fn strided_and_shared_accessors() {
    // Two triangles of a quad in one primitive each, over one interleaved buffer with two vertices that nobody uses.
    let mut model = triangle();
    let vertex = |x: f32, y: f32| [x, y, 0.5, 0.0, 0.0, 2.0];
    let vertices = [
        vertex(9.0, 9.0),
        vertex(0.0, 0.0),
        vertex(1.0, 0.0),
        vertex(1.0, 2.0),
        vertex(0.0, 2.0),
        vertex(8.0, 8.0),
    ];
    let view = add_view(&mut model, &floats(vertices.as_flattened()));
    model["bufferViews"][view]["byteStride"] = json!(24);
    let accessor = |offset| json!({"bufferView": view, "byteOffset": offset, "componentType": FLOAT, "count": 6, "type": "VEC3"});
    let position = push(&mut model, "accessors", accessor(0));
    let normal = push(&mut model, "accessors", accessor(12));
    let first = add_accessor(&mut model, &[1, 2, 3], UNSIGNED_BYTE, 3, "SCALAR");
    let second = add_accessor(&mut model, &[1, 0, 3, 0, 4, 0], UNSIGNED_SHORT, 3, "SCALAR");
    let primitive = |indices, material| json!({"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices, "material": material});
    model["meshes"] = json!([{"name": "quad", "primitives": [primitive(first, 1), primitive(second, 1), primitive(first, 0)]}]);
    model["materials"] = json!([{"name": "a"}, {"name": "b"}]);
    let scene = load_model(&model).expect("loads");
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions.len(), 4, "shared, and without the unused");
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(mesh.positions[3], Vec3::new(0.0, 2.0, 0.5));
    assert_eq!(mesh.normals, [Vec3::Z; 4]);
    let parts: Vec<_> = mesh
        .parts
        .iter()
        .map(|p| (p.first_triangle, p.triangle_count, p.material))
        .collect();
    assert_eq!(parts, [(0, 2, 1), (2, 1, 0)]);
    assert_eq!(scene.materials.len(), 2, "no default material");
}

#[test]
fn primitives_with_other_attributes_keep_their_own_vertices() {
    let scene = good(|m| {
        let with_normals = set_attribute(
            m,
            "NORMAL",
            &floats(&[0.0, 0.0, 9.0, 0.0, f32::NAN, 1.0, 0.0, 0.0, -1e-30]),
            FLOAT,
            3,
            "VEC3",
        );
        let plain = json!({"attributes": {"POSITION": 0}});
        let colors = add_accessor(m, &floats(&[0.5; 12]), FLOAT, 3, "VEC4");
        let colored = json!({"attributes": {"POSITION": 0, "COLOR_0": colors}});
        assert_eq!(with_normals, 1);
        let primitives = m["meshes"][0]["primitives"].as_array_mut().expect("there");
        primitives.insert(0, plain);
        primitives.push(colored);
    });
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
    assert_eq!(mesh.normals[..3], [Vec3::ZERO; 3]);
    assert_eq!(mesh.normals[3..6], [Vec3::Z, Vec3::ZERO, Vec3::NEG_Z]);
    assert_eq!(mesh.normals[6..], [Vec3::ZERO; 3]);
    assert_eq!(mesh.colors[5], Vec4::ONE);
    assert_eq!(mesh.colors[6], Vec4::splat(0.5));
    assert_eq!(mesh.parts.len(), 1);
}

#[test]
fn sparse_and_bufferless_accessors() {
    let sparse = |m: &mut Value, has_base: bool| {
        let indices = add_view(m, &[1, 2]);
        let values = add_view(m, &floats(&[5.0, 0.0, 0.0, 0.0, 7.0, 0.0]));
        m["accessors"][0]["sparse"] = json!({"count": 2,
            "indices": {"bufferView": indices, "componentType": UNSIGNED_BYTE}, "values": {"bufferView": values}});
        if !has_base {
            m["accessors"][0]
                .as_object_mut()
                .expect("there")
                .remove("bufferView");
        }
    };
    for (has_base, z) in [(true, 3.0), (false, 0.0)] {
        let scene = good(|m| sparse(m, has_base));
        let expected = [
            Vec3::new(0.0, 0.0, z),
            Vec3::new(5.0, 0.0, 0.0),
            Vec3::new(0.0, 7.0, 0.0),
        ];
        assert_eq!(scene.meshes[0].positions, expected);
    }
    let scene = good(|m| {
        set_attribute(m, "NORMAL", &[], FLOAT, 3, "VEC3");
        m["accessors"][1]
            .as_object_mut()
            .expect("there")
            .remove("bufferView");
    });
    assert_eq!(scene.meshes[0].normals, [Vec3::ZERO; 3]);
    refused(
        &[
            "mesh 0, primitive 0",
            "accessor 0: sparse: replaces element 2 of 2",
        ],
        |m| {
            sparse(m, false);
            m["accessors"][0]["count"] = json!(2);
        },
    );
    refused(
        &["accessor 0: sparse: reads bytes 0..4294967296 of buffer view 1"],
        |m| {
            sparse(m, true);
            m["accessors"][0]["sparse"]["count"] = json!(4_294_967_296_u64);
        },
    );
}

#[test]
fn sparse_accessors_may_be_of_integers_with_a_stride() {
    let scene = good(|m| {
        // (0, 0, 0), (127, 0, 0) and (0, 127, 0), each with padding; what replaces them has none.
        let base = [0, 0, 0, 9, 127, 0, 0, 9, 0, 127, 0, 9];
        let position = set_attribute(m, "POSITION", &base, BYTE, 3, "VEC3");
        let view = m["accessors"][position]["bufferView"].as_u64();
        m["bufferViews"][view.expect("there") as usize]["byteStride"] = json!(4);
        let indices = add_view(m, &[0, 0, 2, 0]);
        let values = add_view(m, &[0, 0, 127, 127, 0x80, 0]);
        m["accessors"][position]["normalized"] = json!(true);
        m["accessors"][position]["sparse"] = json!({"count": 2,
            "indices": {"bufferView": indices, "componentType": UNSIGNED_SHORT}, "values": {"bufferView": values}});
    });
    assert_eq!(
        scene.meshes[0].positions,
        [Vec3::Z, Vec3::X, Vec3::new(1.0, -1.0, 0.0)]
    );
}

#[test]
fn strips_and_fans_face_the_same_way() {
    // A unit quad as strip and as fan: all normals must point to +z.
    for (mode, corners) in [
        (5, [0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 1.0, 2.0]),
        (6, [0.0, 0.0, 1.0, 0.0, 1.0, 2.0, 0.0, 2.0]),
    ] {
        let scene = good(|m| {
            let positions: Vec<f32> = corners
                .as_chunks::<2>()
                .0
                .iter()
                .flat_map(|&[x, y]| [x, y, 0.0])
                .collect();
            set_attribute(m, "POSITION", &floats(&positions), FLOAT, 4, "VEC3");
            m["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        });
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.triangles.len(), 2);
        for &[a, b, c] in &mesh.triangles {
            let [a, b, c] = [a, b, c].map(|v| mesh.positions[v as usize]);
            assert_eq!(
                (b - a).cross(c - a),
                Vec3::new(0.0, 0.0, 2.0),
                "mode {mode}"
            );
        }
    }
}

#[test]
fn what_has_no_triangles_is_noted_once() {
    let scene = good(|m| {
        set_attribute(
            m,
            "POSITION",
            &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0]),
            FLOAT,
            3,
            "VEC3",
        );
        let empty = add_accessor(m, &[], UNSIGNED_BYTE, 0, "SCALAR");
        let primitives = m["meshes"][0]["primitives"].as_array_mut().expect("there");
        for mode in 0..4 {
            primitives.push(json!({"attributes": {"POSITION": 0}, "mode": mode}));
        }
        primitives.push(json!({"attributes": {"NORMAL": 0}}));
        primitives.push(json!({"attributes": {"POSITION": 0}, "indices": empty}));
    });
    let notes: Vec<String> = scene
        .notes
        .iter()
        .map(|n| format!("{}: {}", n.element, n.text))
        .collect();
    assert_eq!(
        notes,
        [
            "mesh 0, primitive 1 and 3 more: points and lines are left out",
            "mesh 0, primitive 5: left out: it has no positions",
            "mesh 0, primitive 6: left out: it has no triangles",
        ]
    );
    refused(&["nothing to render"], |m| {
        m["accessors"][0]["count"] = json!(0)
    });
    refused(&["nothing to render"], |m| {
        m["meshes"][0]["primitives"][0]["mode"] = json!(1)
    });
    refused(&["nothing to render"], |m| m["nodes"][0] = json!({}));
}

#[test]
fn broken_vertices_are_defects() {
    let scene = good(|m| {
        let positions = [
            0.0,
            0.0,
            3.0,
            1.0,
            0.0,
            3.0,
            0.0,
            2.0,
            3.0,
            f32::NAN,
            0.0,
            0.0,
            1e19,
            0.0,
            0.0,
        ];
        set_attribute(m, "POSITION", &floats(&positions), FLOAT, 5, "VEC3");
        set_indices(m, &[0, 1, 3, 0, 1, 2, 4, 1, 2]);
    });
    let defects: Vec<_> = scene
        .defects
        .iter()
        .map(|d| (d.cause, d.count, d.first))
        .collect();
    assert_eq!(
        defects,
        [
            (DefectCause::NotFinite, 1, 0),
            (DefectCause::TooLarge, 1, 2)
        ]
    );
    assert_eq!(scene.placed_triangles(), 1);
    refused(&["nothing left to render"], |m| {
        set_attribute(m, "POSITION", &floats(&[f32::NAN; 9]), FLOAT, 3, "VEC3");
    });
    refused(&["nothing left to render", "beyond 1e18"], |m| {
        m["nodes"][0]["scale"] = json!([1e18, 1, 1e18])
    });
}
