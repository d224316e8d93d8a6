//! Materials with the lobes of their extensions, and what they look up in textures.

use std::collections::BTreeSet;

use ::gltf::json;
use ::gltf::json::material::AlphaMode as JsonAlphaMode;
use ::gltf::json::validation::Checked;
use glam::{Vec3, Vec4};
use serde_json::{Map, Value};

use super::extensions::Extension;
use super::notes::Notes;
use super::texture::Textures;
use crate::import::{TextureNeeds, images};
use crate::scene::{
    AlphaMode, Clearcoat, Material, Sheen, Specular, TextureRef, Transmission, Volume,
};

/// The texture slots of the extensions that are read: those of which pixels are needed.
const LOBE_TEXTURES: [(&str, &[&str]); 5] = [
    (
        "KHR_materials_specular",
        &["specularTexture", "specularColorTexture"],
    ),
    ("KHR_materials_transmission", &["transmissionTexture"]),
    ("KHR_materials_volume", &["thicknessTexture"]),
    (
        "KHR_materials_clearcoat",
        &[
            "clearcoatTexture",
            "clearcoatRoughnessTexture",
            "clearcoatNormalTexture",
        ],
    ),
    (
        "KHR_materials_sheen",
        &["sheenColorTexture", "sheenRoughnessTexture"],
    ),
];

/// The file's textures that a material shows: those of which pixels are needed. Lobes that [`Material`] does not have, and
/// what lies under an unlit or older material's own slots, are not among them.
pub(super) fn shown_textures(
    json: &json::Material,
    needs: TextureNeeds,
    shown: &mut BTreeSet<usize>,
) {
    let find = |name| Extension::find(extensions(json), name);
    let texture = |e: Extension, key| e.object(key).and_then(|t| t.index("index"));
    let pbr = &json.pbr_metallic_roughness;
    let mode = &json.alpha_mode;
    let has_alpha = matches!(
        mode,
        Checked::Valid(JsonAlphaMode::Mask | JsonAlphaMode::Blend)
    );
    if needs == TextureNeeds::All || has_alpha {
        shown.extend(pbr.base_color_texture.as_ref().map(|t| t.index.value()));
        if let Some(e) = specular_glossiness(json) {
            shown.extend(texture(e, "diffuseTexture"));
        }
    }
    if find("KHR_materials_unlit").is_some() || needs == TextureNeeds::Alpha {
        return;
    }
    shown.extend(json.normal_texture.as_ref().map(|t| t.index.value()));
    if needs == TextureNeeds::Normals {
        let coat = find("KHR_materials_clearcoat");
        shown.extend(coat.and_then(|e| texture(e, "clearcoatNormalTexture")));
        return;
    }
    shown.extend(json.emissive_texture.as_ref().map(|t| t.index.value()));
    shown.extend(json.occlusion_texture.as_ref().map(|t| t.index.value()));
    match specular_glossiness(json) {
        Some(e) => shown.extend(texture(e, "diffuseTexture")),
        None => {
            let texture = pbr.metallic_roughness_texture.as_ref();
            shown.extend(texture.map(|t| t.index.value()));
        }
    }
    for (extension, keys) in LOBE_TEXTURES {
        let extension = find(extension);
        shown.extend(
            extension
                .into_iter()
                .flat_map(|e| keys.iter().filter_map(move |key| texture(e, key))),
        );
    }
}

/// Whether a material looks normals up in the space of tangents.
pub(super) fn shows_tangents(json: &json::Material) -> bool {
    let coat = Extension::find(extensions(json), "KHR_materials_clearcoat");
    let coat = coat.and_then(|e| e.object("clearcoatNormalTexture"));
    json.normal_texture.is_some() || coat.is_some()
}

/// What primitives without a material have (glTF 2.0 specification, section 5.19).
pub(super) fn default_material() -> Material {
    Material {
        name: "default".to_owned(),
        metallic: 1.0,
        double_sided: false,
        ..Material::default()
    }
}

pub(super) fn read(json: &json::Material, index: usize, textures: &Textures) -> Material {
    let pbr = &json.pbr_metallic_roughness;
    let name = json.name.clone().filter(|n| !n.is_empty());
    let emissive = Vec3::from(json.emissive_factor.0) * emissive_strength(json);
    let mut material = Material {
        name: name.unwrap_or_else(|| format!("material {index}")),
        base_color: finite_or(Vec4::from(pbr.base_color_factor.0), Vec4::ONE),
        base_color_texture: info(textures, pbr.base_color_texture.as_ref()),
        metallic: unit(pbr.metallic_factor.0),
        roughness: unit(pbr.roughness_factor.0),
        metallic_roughness_texture: info(textures, pbr.metallic_roughness_texture.as_ref()),
        emissive: if emissive.is_finite() {
            emissive.max(Vec3::ZERO)
        } else {
            Vec3::ZERO
        },
        emissive_texture: info(textures, json.emissive_texture.as_ref()),
        alpha_mode: match json.alpha_mode {
            Checked::Valid(JsonAlphaMode::Mask) => AlphaMode::Mask {
                cutoff: json.alpha_cutoff.map_or(0.5, |c| c.0),
            },
            Checked::Valid(JsonAlphaMode::Blend) => AlphaMode::Blend,
            Checked::Valid(JsonAlphaMode::Opaque) | Checked::Invalid => AlphaMode::Opaque,
        },
        double_sided: json.double_sided,
        ..Material::default()
    };
    if let Some(t) = &json.normal_texture {
        let extensions = t.extensions.as_ref().map(|e| &e.others);
        material.normal_texture = textures.refer(t.index.value(), t.tex_coord, extensions);
        material.normal_scale = t.scale;
    }
    if let Some(t) = &json.occlusion_texture {
        let extensions = t.extensions.as_ref().map(|e| &e.others);
        material.occlusion_texture = textures.refer(t.index.value(), t.tex_coord, extensions);
        material.occlusion_strength = unit(t.strength.0);
    }
    if json.emissive_texture.is_some() && material.emissive_texture.is_none() {
        // The texture says where the material emits: without it, all of it would be a light.
        material.emissive = Vec3::ZERO;
    }
    read_specular_glossiness(&mut material, json, textures);
    read_lobes(&mut material, json, textures);
    material
}

/// Gives a material that shows an image that cannot be had a checker for its colour instead, so that it is seen.
pub(super) fn mark_lost_color(
    material: &mut Material,
    json: &json::Material,
    textures: &Textures,
    notes: &mut Notes,
) {
    let pbr = &json.pbr_metallic_roughness;
    let is_lost = match specular_glossiness(json) {
        Some(e) => e.object("diffuseTexture").is_some(),
        None => pbr.base_color_texture.is_some(),
    };
    if !is_lost || material.base_color_texture.is_some() {
        return;
    }
    let uv_set = pbr.base_color_texture.as_ref().map_or(0, |t| t.tex_coord);
    images::show_stand_in(material, textures.stand_in(), uv_set);
    let element = format!("material {:?}", material.name);
    notes.add(element, images::STAND_IN_NOTE);
}

fn extensions(json: &json::Material) -> Option<&Map<String, Value>> {
    json.extensions.as_ref().map(|e| &e.others)
}

fn emissive_strength(json: &json::Material) -> f32 {
    Extension::find(extensions(json), "KHR_materials_emissive_strength")
        .and_then(|e| e.number("emissiveStrength"))
        .unwrap_or(1.0)
}

fn specular_glossiness(json: &json::Material) -> Option<Extension<'_>> {
    Extension::find(extensions(json), "KHR_materials_pbrSpecularGlossiness")
}

/// The older model of the archived extension, as far as metallic-roughness has words for it.
fn read_specular_glossiness(material: &mut Material, json: &json::Material, textures: &Textures) {
    let Some(e) = specular_glossiness(json) else {
        return;
    };
    material.base_color = e.numbers("diffuseFactor").map_or(Vec4::ONE, Vec4::from);
    material.base_color_texture = texture(textures, e, "diffuseTexture");
    material.metallic = 0.0;
    material.roughness = 1.0 - unit(e.number("glossinessFactor").unwrap_or(1.0));
    material.metallic_roughness_texture = None;
}

fn read_lobes(material: &mut Material, json: &json::Material, textures: &Textures) {
    let find = |name| Extension::find(extensions(json), name);
    let share = |e: Extension, key, default| unit(e.number(key).unwrap_or(default));
    material.unlit = find("KHR_materials_unlit").is_some();
    if let Some(ior) = find("KHR_materials_ior").and_then(|e| e.number("ior")) {
        material.ior = ior;
    }
    material.specular = find("KHR_materials_specular").map(|e| Specular {
        factor: share(e, "specularFactor", 1.0),
        texture: texture(textures, e, "specularTexture"),
        color: e.color("specularColorFactor", Vec3::ONE),
        color_texture: texture(textures, e, "specularColorTexture"),
    });
    material.transmission = find("KHR_materials_transmission").map(|e| Transmission {
        factor: share(e, "transmissionFactor", 0.0),
        texture: texture(textures, e, "transmissionTexture"),
    });
    material.volume = find("KHR_materials_volume").map(|e| Volume {
        thickness: e.number("thicknessFactor").unwrap_or(0.0).max(0.0),
        thickness_texture: texture(textures, e, "thicknessTexture"),
        attenuation_distance: e
            .number("attenuationDistance")
            .filter(|&d| d > 0.0)
            .unwrap_or(f32::INFINITY),
        attenuation_color: e.color("attenuationColor", Vec3::ONE),
    });
    material.clearcoat = find("KHR_materials_clearcoat").map(|e| Clearcoat {
        factor: share(e, "clearcoatFactor", 0.0),
        texture: texture(textures, e, "clearcoatTexture"),
        roughness: share(e, "clearcoatRoughnessFactor", 0.0),
        roughness_texture: texture(textures, e, "clearcoatRoughnessTexture"),
        normal_texture: texture(textures, e, "clearcoatNormalTexture"),
        normal_scale: e
            .object("clearcoatNormalTexture")
            .and_then(|t| t.number("scale"))
            .unwrap_or(1.0),
    });
    material.sheen = find("KHR_materials_sheen").map(|e| Sheen {
        color: e.color("sheenColorFactor", Vec3::ZERO),
        color_texture: texture(textures, e, "sheenColorTexture"),
        roughness: share(e, "sheenRoughnessFactor", 0.0),
        roughness_texture: texture(textures, e, "sheenRoughnessTexture"),
    });
}

/// A texture of the core format.
fn info(textures: &Textures, info: Option<&json::texture::Info>) -> Option<TextureRef> {
    let info = info?;
    let extensions = info.extensions.as_ref().map(|e| &e.others);
    textures.refer(info.index.value(), info.tex_coord, extensions)
}

/// A texture of an extension.
fn texture(textures: &Textures, extension: Extension, key: &str) -> Option<TextureRef> {
    let info = extension.object(key)?;
    let uv_set = info.index("texCoord").unwrap_or(0);
    let uv_set = u32::try_from(uv_set).unwrap_or(u32::MAX);
    textures.refer(info.index("index")?, uv_set, info.extensions())
}

/// A factor within 0 to 1; 1, the default of all core factors, where it is not a number.
fn unit(factor: f32) -> f32 {
    if factor.is_nan() {
        return 1.0;
    }
    factor.clamp(0.0, 1.0)
}

fn finite_or(value: Vec4, default: Vec4) -> Vec4 {
    if value.is_finite() { value } else { default }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn material(json: &str) -> Material {
        let json: json::Material = serde_json::from_str(json).expect("JSON");
        read(&json, 3, &Textures::default())
    }

    #[test]
    fn textures_are_shown_that_what_is_wanted_looks_at() {
        let text = |mode: &str| {
            format!(
                r#"{{"alphaMode":"{mode}","pbrMetallicRoughness":{{"baseColorTexture":{{"index":1}},"metallicRoughnessTexture":{{"index":2}}}},
                "normalTexture":{{"index":3}},"occlusionTexture":{{"index":4}},"emissiveTexture":{{"index":5}},
                "extensions":{{"KHR_materials_clearcoat":{{"clearcoatTexture":{{"index":6}},"clearcoatNormalTexture":{{"index":7}}}}}}}}"#
            )
        };
        let shown = |mode: &str, needs| {
            let json: json::Material = serde_json::from_str(&text(mode)).expect("JSON");
            let mut shown = BTreeSet::new();
            shown_textures(&json, needs, &mut shown);
            shown.into_iter().collect::<Vec<_>>()
        };
        for mode in ["OPAQUE", "MASK", "BLEND"] {
            assert_eq!(shown(mode, TextureNeeds::All), [1, 2, 3, 4, 5, 6, 7]);
        }
        assert_eq!(shown("OPAQUE", TextureNeeds::Normals), [3, 7]);
        assert_eq!(shown("MASK", TextureNeeds::Normals), [1, 3, 7]);
        assert!(shown("OPAQUE", TextureNeeds::Alpha).is_empty());
        assert_eq!(shown("BLEND", TextureNeeds::Alpha), [1]);
    }

    #[test]
    fn an_empty_material_is_the_default_one() {
        let expected = Material {
            name: "material 3".to_owned(),
            ..default_material()
        };
        assert_eq!(material("{}"), expected);
        assert_eq!((expected.metallic, expected.roughness), (1.0, 1.0));
    }

    #[test]
    fn lobes_have_the_defaults_of_their_extensions() {
        let m = material(
            r#"{"extensions":{"KHR_materials_unlit":{},"KHR_materials_ior":{"ior":1.25},
            "KHR_materials_specular":{"specularFactor":0.5},"KHR_materials_volume":{"attenuationColor":[0.25,0.5,1]},
            "KHR_materials_transmission":{"transmissionFactor":0.75},"KHR_materials_clearcoat":{},
            "KHR_materials_sheen":{"sheenColorFactor":[1,0.5,0]},
            "KHR_materials_emissive_strength":{"emissiveStrength":4}},"emissiveFactor":[1,0.5,0.25]}"#,
        );
        assert!(m.unlit);
        assert_eq!(m.ior, 1.25);
        assert_eq!(m.emissive, Vec3::new(4.0, 2.0, 1.0));
        let specular = m.specular.expect("read");
        assert_eq!((specular.factor, specular.color), (0.5, Vec3::ONE));
        let volume = m.volume.expect("read");
        assert_eq!(volume.attenuation_distance, f32::INFINITY);
        assert_eq!(volume.attenuation_color, Vec3::new(0.25, 0.5, 1.0));
        assert_eq!(m.transmission.map(|t| t.factor), Some(0.75));
        assert_eq!(
            m.clearcoat.map(|c| (c.factor, c.normal_scale)),
            Some((0.0, 1.0))
        );
        assert_eq!(m.sheen.map(|s| s.color), Some(Vec3::new(1.0, 0.5, 0.0)));
    }

    #[test]
    fn nonsense_in_extensions_has_the_defaults() {
        let m = material(
            r#"{"extensions":{"KHR_materials_ior":{"ior":"glass"},"KHR_materials_volume":7,
            "KHR_materials_sheen":{"sheenColorFactor":[1,2],"sheenColorTexture":{"index":-1}}}}"#,
        );
        assert_eq!(m.ior, 1.5);
        assert_eq!(m.volume, None);
        assert_eq!(m.sheen.map(|s| s.color), Some(Vec3::ZERO));
    }

    #[test]
    fn specular_glossiness_shows_its_diffuse_colour() {
        let m = material(
            r#"{"extensions":{"KHR_materials_pbrSpecularGlossiness":
            {"diffuseFactor":[0.25,0.5,0.75,1],"glossinessFactor":0.25}}}"#,
        );
        assert_eq!(m.base_color, Vec4::new(0.25, 0.5, 0.75, 1.0));
        assert_eq!((m.metallic, m.roughness), (0.0, 0.75));
    }
}
