//! Textures and images, and what becomes of materials whose images are missing.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use bspray::scene::{AlphaMode, Filter, Pixels, Wrap};
use glam::{Vec2, Vec3};
use serde_json::json;

use crate::model::*;

#[test]
fn texture_transforms_reach_every_slot() {
    let map =
        json!({"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2, 4], "texCoord": 3}});
    let info = json!({"index": 0, "texCoord": 1, "extensions": map});
    let scene = good(|m| {
        m["images"] = json!([{"uri": format!("data:image/png;base64,{PNG}")}]);
        m["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
        m["textures"] = json!([{"source": 0, "sampler": 0}]);
        m["materials"] = json!([{
            "pbrMetallicRoughness": {"baseColorTexture": info, "metallicRoughnessTexture": info},
            "normalTexture": info, "occlusionTexture": info, "emissiveTexture": {"index": 0},
            "extensions": {"KHR_materials_clearcoat": {"clearcoatNormalTexture": info}, "KHR_materials_volume": {"thicknessTexture": info}},
            "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
        }]);
        m["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    let m = &scene.materials[0];
    let slots = [
        m.base_color_texture,
        m.metallic_roughness_texture,
        m.normal_texture,
        m.occlusion_texture,
        m.clearcoat.and_then(|c| c.normal_texture),
        m.volume.and_then(|v| v.thickness_texture),
    ];
    for slot in slots {
        let slot = slot.expect("there");
        assert_eq!(slot.uv_set, 3);
        assert_eq!(slot.map(Vec2::new(0.5, 0.25)), Vec2::new(1.25, 1.5));
    }
    assert_eq!(m.emissive_texture.map(|t| t.uv_set), Some(0));
    assert_eq!(
        (m.alpha_mode, m.double_sided),
        (AlphaMode::Mask { cutoff: 0.25 }, true)
    );
    assert_eq!(
        (scene.textures[0].wrap_u, scene.textures[0].wrap_v),
        (Wrap::ClampToEdge, Wrap::MirroredRepeat)
    );
    assert_eq!((scene.images[0].width, scene.images[0].height), (1, 1));
}

#[test]
fn images_that_cannot_be_had_leave_their_materials() {
    let uris = [
        "gone.png",
        "%FF.png",
        "http://example.com/a.png",
        "data:image/png;base64,AAAA",
        "a%20b.png",
    ];
    let model = {
        let mut m = triangle();
        let images = uris.iter().map(|u| json!({"uri": u}));
        m["images"] = images
            .chain([json!({"bufferView": 77, "mimeType": "image/png"})])
            .collect();
        let textures = (0..6).map(|i| json!({"source": i}));
        m["textures"] = textures
            .chain([
                json!({"extensions": {"MSFT_texture_dds": {"source": 0}}}),
                json!({"source": 50}),
            ])
            .collect();
        m["materials"] = (0..8)
            .map(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}))
            .collect();
        let primitives = (0..8).map(|i| json!({"attributes": {"POSITION": 0}, "material": i}));
        m["meshes"][0]["primitives"] = primitives.collect();
        m
    };
    let directory = tempfile::tempdir().expect("a temporary directory");
    let png = BASE64_STANDARD.decode(PNG).expect("base64");
    std::fs::write(directory.path().join("a b.png"), png).expect("written");
    let scene =
        load_in(directory.path(), "model.gltf", model.to_string().as_bytes()).expect("loads");
    // A magenta checker, sharp, stands in for the colours of the others.
    let is_stand_in = |i: usize| {
        let texture = scene.materials[i]
            .base_color_texture
            .expect("there")
            .texture;
        let texture = &scene.textures[texture as usize];
        let image = &scene.images[texture.image as usize];
        let is_checker = image.name == "stand-in" && texture.filter == Filter::Nearest;
        let Some(Pixels::Rgba8(pixels)) = &image.pixels else {
            panic!("{image:?}")
        };
        is_checker && pixels[..2] == [[255, 0, 255, 255], [60, 0, 60, 255]]
    };
    let kept: Vec<usize> = (0..8).filter(|&i| !is_stand_in(i)).collect();
    assert_eq!(kept, [4]);
    assert_eq!(scene.images.len(), 7);
    for words in [
        "image 0: left out of its materials: cannot read",
        "image 1: left out of its materials: cannot read",
        "image 2: left out of its materials: \"http://example.com/a.png\" has a scheme",
        "image 3: left out of its materials: cannot be decoded",
        "image 5: left out of its materials: buffer view 77 is not there",
        "texture 6: left out of its materials: it has no image of a kind that is read",
        "texture 7: left out of its materials: its image is not there",
        "material \"material 0\" and 6 more: the image of its colour is left out: a magenta checker stands in",
    ] {
        assert!(
            has_note(&scene, words),
            "no {words:?} in {:#?}",
            scene.notes
        );
    }
}

#[test]
fn every_slot_that_is_shaded_is_decoded() {
    let slots = [
        "specularTexture",
        "specularColorTexture",
        "transmissionTexture",
        "thicknessTexture",
        "clearcoatTexture",
        "clearcoatRoughnessTexture",
        "clearcoatNormalTexture",
        "sheenColorTexture",
        "sheenRoughnessTexture",
        "iridescenceTexture",
    ];
    let scene = good(|m| {
        let uri = format!("data:image/png;base64,{PNG}");
        m["images"] = json!(vec![json!({"uri": uri}); 12]);
        let textures: Vec<_> = (0..12).map(|i| json!({"source": i})).collect();
        m["textures"] = json!(textures);
        let mut extensions = json!({});
        for (i, slot) in slots.iter().enumerate() {
            let name = match *slot {
                s if s.starts_with("specular") => "specular",
                s if s.starts_with("transmission") => "transmission",
                s if s.starts_with("thickness") => "volume",
                s if s.starts_with("clearcoat") => "clearcoat",
                s if s.starts_with("sheen") => "sheen",
                _ => "iridescence",
            };
            extensions[format!("KHR_materials_{name}")][*slot] = json!({"index": i});
        }
        m["materials"] = json!([{
            "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 10}}, "extensions": extensions,
        }, {
            "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 11}}, "extensions": {"KHR_materials_unlit": {}},
        }]);
        m["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    let decoded: Vec<bool> = scene.images.iter().map(|i| i.pixels.is_some()).collect();
    let expected: Vec<bool> = (0..12).map(|i| i != 9 && i != 11).collect();
    assert_eq!(decoded, expected);
    assert_eq!(scene.materials[0].texture_slots().len(), 10);
    assert!(has_note(
        &scene,
        "KHR_materials_iridescence is not supported"
    ));
}

#[test]
fn only_images_that_show_are_decoded() {
    let scene = good(|m| {
        let uri = format!("data:image/png;base64,{PNG}");
        m["images"] = json!([{"uri": uri}, {"uri": uri, "name": "bumps"}, {"uri": "nobody.png"}, {"uri": "gone.png"}, {"uri": uri}]);
        m["textures"] = json!([{"source": 0}, {"source": 1}, {"source": 3}, {"source": 4}]);
        m["materials"] = json!([
            {"emissiveTexture": {"index": 0}, "normalTexture": {"index": 1}, "occlusionTexture": {"index": 2}},
            {"emissiveTexture": {"index": 3}},
        ]);
        m["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    let decoded: Vec<bool> = scene.images.iter().map(|i| i.pixels.is_some()).collect();
    assert_eq!(decoded, [true, true, false, false, false]);
    assert_eq!(scene.images[1].name, "bumps");
    let material = &scene.materials[0];
    assert!(material.normal_texture.is_some() && material.occlusion_texture.is_none());
    assert_eq!(scene.notes.len(), 1, "{:?}", scene.notes);
    assert!(has_note(&scene, "image 3: left out"));
}

#[test]
fn an_emissive_texture_that_cannot_be_had_leaves_no_light() {
    let scene = good(|m| {
        m["images"] = json!([
            {"uri": "gone.png"}, {"uri": "data:image/png;base64,AAAA"},
            {"uri": format!("data:image/png;base64,{PNG}")},
        ]);
        m["textures"] = json!([
            {"source": 0}, {"source": 1}, {"extensions": {"MSFT_texture_dds": {"source": 0}}},
            {"extensions": {"EXT_texture_avif": {"source": 0}}}, {"source": 2},
        ]);
        m["materials"] = (0..5)
            .map(|i| json!({"emissiveFactor": [1, 0.5, 0.25], "emissiveTexture": {"index": i}}))
            .chain([json!({"emissiveFactor": [1, 0.5, 0.25]})])
            .collect();
        let primitives = (0..6).map(|i| json!({"attributes": {"POSITION": 0}, "material": i}));
        m["meshes"][0]["primitives"] = primitives.collect();
    });
    let light = Vec3::new(1.0, 0.5, 0.25);
    let emissive: Vec<Vec3> = scene.materials.iter().map(|m| m.emissive).collect();
    let dark = Vec3::ZERO;
    assert_eq!(emissive, [dark, dark, dark, dark, light, light]);
    for words in [
        "image 0: left out",
        "image 1: left out",
        "texture 2 and 1 more: left out",
    ] {
        assert!(
            has_note(&scene, words),
            "no {words:?} in {:#?}",
            scene.notes
        );
    }
}

#[test]
fn a_scene_knows_the_files_it_was_read_from() {
    let mut model = triangle();
    let uri = model["buffers"][0]["uri"].take();
    let base64 = uri
        .as_str()
        .and_then(|u| u.split_once(','))
        .expect("data")
        .1;
    model["buffers"][0]["uri"] = json!("data.bin");
    model["images"] = json!([{"uri": "a.png"}, {"uri": "bumps.png"}, {"uri": "gone.png"}]);
    model["textures"] = json!([{"source": 0}, {"source": 1}, {"source": 2}]);
    model["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "normalTexture": {"index": 1}, "occlusionTexture": {"index": 2},
    }]);
    model["meshes"][0]["primitives"][0]["material"] = json!(0);
    let folder = tempfile::tempdir().expect("a temporary directory");
    let write = |name: &str, base64: &str| {
        let bytes = BASE64_STANDARD.decode(base64).expect("base64");
        std::fs::write(folder.path().join(name), bytes).expect("written");
    };
    write("data.bin", base64);
    write("a.png", PNG);
    write("bumps.png", PNG);
    let mut scene =
        load_in(folder.path(), "model.gltf", model.to_string().as_bytes()).expect("loads");
    let files = ["model.gltf", "a.png", "bumps.png", "data.bin"].map(|n| folder.path().join(n));
    assert_eq!(scene.files, files);
    scene.append(
        load_in(folder.path(), "b.gltf", triangle().to_string().as_bytes()).expect("loads"),
    );
    assert_eq!(scene.files[4..], [folder.path().join("b.gltf")]);
}

#[test]
fn the_best_of_a_textures_images_is_shown() {
    // A lossless WebP of two pixels, and the PNG of one.
    let scene = good(|m| {
        m["images"] = json!([
            {"uri": format!("data:image/png;base64,{PNG}")},
            {"uri": format!("data:image/webp;base64,{WEBP}"), "mimeType": "image/webp"},
        ]);
        let webp = |source: usize| json!({"EXT_texture_webp": {"source": source}});
        m["textures"] = json!([
            {"source": 0}, {"source": 0, "extensions": webp(1)}, {"extensions": webp(1)}, {"source": 0, "extensions": webp(9)},
        ]);
        m["materials"] = (0..4)
            .map(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}))
            .collect();
        let primitives = (0..4).map(|i| json!({"attributes": {"POSITION": 0}, "material": i}));
        m["meshes"][0]["primitives"] = primitives.collect();
    });
    let widths: Vec<u32> = scene
        .materials
        .iter()
        .map(|m| m.base_color_texture.expect("there").texture)
        .map(|t| scene.images[scene.textures[t as usize].image as usize].width)
        .collect();
    assert_eq!(widths, [1, 2, 2, 1]);
    let Some(Pixels::Rgba8(pixels)) = &scene.images[1].pixels else {
        panic!("no pixels")
    };
    assert_eq!(pixels[..], [[10, 20, 30, 255], [200, 100, 50, 255]]);
}

#[test]
fn the_fallback_of_an_image_that_cannot_be_had_is_shown() {
    let data = |mime: &str, base64: &str| json!({"uri": format!("data:{mime};base64,{base64}")});
    let basis = |source: usize| json!({"KHR_texture_basisu": {"source": source}});
    let webp = |source: usize| json!({"EXT_texture_webp": {"source": source}});
    // The mark of a KTX 2.0 file and nothing behind it; the head of a WebP file and nothing behind it.
    let images = json!([
        data("image/png", PNG),
        data("image/ktx2", "q0tUWCAyMLsNChoK"),
        {"uri": "gone.ktx2"},
        data("image/webp", "UklGRgAAAABXRUJQ"),
        {"uri": "gone.webp"},
        {"bufferView": 99, "mimeType": "image/ktx2"},
        data("image/webp", WEBP),
        {"uri": "never looked at.png"},
    ]);
    let textures = json!([
        {"source": 0, "extensions": basis(1)},
        {"source": 0, "extensions": basis(2)},
        {"source": 0, "extensions": webp(3)},
        {"source": 0, "extensions": webp(4)},
        {"source": 0, "extensions": basis(5)},
        {"source": 0, "extensions": basis(77)},
        // Both extensions: the second choice is WebP.
        {"source": 0, "extensions": {"KHR_texture_basisu": {"source": 1}, "EXT_texture_webp": {"source": 6}}},
        // Nothing is left.
        {"source": 4, "extensions": basis(2)},
        {"source": 7, "extensions": webp(6)},
        // Not decoded, as it is a normal map: that it is broken is not seen, but that it is not there is.
        {"source": 0, "extensions": basis(1)},
        {"source": 0, "extensions": basis(2)},
    ]);
    let scene = good(|m| {
        m["images"] = images;
        m["textures"] = textures;
        m["materials"] = (0..9)
            .map(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}))
            .chain((9..11).map(|i| json!({"normalTexture": {"index": i}})))
            .collect();
        let primitives = (0..11).map(|i| json!({"attributes": {"POSITION": 0}, "material": i}));
        m["meshes"][0]["primitives"] = primitives.collect();
    });
    let image_of = |i: usize| {
        let m = &scene.materials[i];
        let texture = m.base_color_texture.or(m.normal_texture).expect("there");
        scene.textures[texture.texture as usize].image
    };
    let stand_in = 8;
    assert_eq!(scene.images[stand_in as usize].name, "stand-in");
    let shown: Vec<u32> = (0..11).map(image_of).collect();
    assert_eq!(shown, [0, 0, 0, 0, 0, 0, 6, stand_in, 6, 0, 0]);
    assert!(scene.images[0].pixels.is_some() && scene.images[6].pixels.is_some());
    for words in [
        "image 1: left out of its materials: cannot be decoded",
        "image 2: left out of its materials: cannot read",
        "image 3: left out of its materials: cannot be decoded",
        "image 4: left out of its materials: cannot read",
        "image 5: left out of its materials: buffer view 99 is not there",
        "texture 0 and 1 more: image 1 cannot be had: image 0, its fallback, is shown",
        "texture 1 and 1 more: image 2 cannot be had: image 0, its fallback, is shown",
        "texture 2: image 3 cannot be had: image 0, its fallback, is shown",
        "texture 5: image 77 cannot be had: image 0, its fallback, is shown",
        "texture 6: image 1 cannot be had: image 6, its fallback, is shown",
        "material \"material 7\": the image of its colour is left out",
    ] {
        assert!(
            has_note(&scene, words),
            "no {words:?} in {:#?}",
            scene.notes
        );
    }
    assert!(!has_note(&scene, "never looked at"));
}
