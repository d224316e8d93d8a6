//! The gate: which extensions a file may require, and what is said of the others.

use serde_json::json;

use crate::model::*;

#[test]
fn required_extensions_pass_the_gate_or_are_all_named() {
    let supported = [
        "KHR_materials_specular",
        "KHR_materials_volume",
        "KHR_mesh_quantization",
        "KHR_lights_punctual",
    ];
    good(|m| m["extensionsRequired"] = json!(supported));
    refused(
        &["not supported: EXT_texture_avif, KHR_gaussian_splatting; "],
        |m| {
            m["extensionsRequired"] = json!([
                "KHR_gaussian_splatting",
                "KHR_materials_ior",
                "EXT_texture_avif"
            ]);
        },
    );
    let scene = good(|m| {
        m["extensionsUsed"] = json!(["EXT_odd", "KHR_materials_unlit", "KHR_animation_pointer"]);
        m["materials"] = json!([{"extensions": {"KHR_materials_iridescence": {}}}, {"extensions": {"KHR_materials_iridescence": {}}}]);
    });
    let notes: Vec<&str> = scene.notes.iter().map(|n| n.text.as_str()).collect();
    assert_eq!(
        notes,
        [
            "EXT_odd is not supported and has no effect",
            "KHR_animation_pointer is not supported: what it animates stays at rest",
            "KHR_materials_iridescence is not supported and has no effect"
        ]
    );
}

#[test]
fn every_extension_of_the_list_may_be_required() {
    for name in [
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "EXT_texture_webp",
        "KHR_draco_mesh_compression",
        "KHR_lights_punctual",
        "KHR_materials_clearcoat",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_sheen",
        "KHR_materials_specular",
        "KHR_materials_transmission",
        "KHR_materials_unlit",
        "KHR_materials_variants",
        "KHR_materials_volume",
        "KHR_mesh_quantization",
        "KHR_meshopt_compression",
        "KHR_node_visibility",
        "KHR_texture_basisu",
        "KHR_texture_transform",
    ] {
        good(|m| m["extensionsRequired"] = json!([name]));
    }
    // The others of the survey.
    for name in [
        "EXT_texture_avif",
        "KHR_animation_pointer",
        "KHR_materials_anisotropy",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_dispersion",
        "KHR_materials_iridescence",
        "KHR_xmp_json_ld",
        "MSFT_texture_dds",
    ] {
        refused(&["extensionsRequired: not supported: ", name], |m| {
            m["extensionsRequired"] = json!([name]);
        });
        let scene = good(|m| m["extensionsUsed"] = json!([name]));
        assert!(has_note(&scene, name), "{name}");
    }
}
