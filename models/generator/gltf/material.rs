//! Materials as glTF and its extensions write them. Colours are linear, of Rec. 709 primaries.

use serde::Serialize;
use serde_json::{Map, Value, json};

/// A material, ready to be written.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(in super::super) struct Material {
    name: &'static str,
    pbr_metallic_roughness: PbrMetallicRoughness,
    #[serde(skip_serializing_if = "Option::is_none")]
    emissive_factor: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    double_sided: bool,
    #[serde(skip_serializing_if = "Map::is_empty")]
    extensions: Map<String, Value>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct PbrMetallicRoughness {
    base_color_factor: [f32; 4],
    #[serde(skip_serializing_if = "Option::is_none")]
    base_color_texture: Option<TextureInfo>,
    metallic_factor: f32,
    roughness_factor: f32,
}

#[derive(Serialize)]
struct TextureInfo {
    index: usize,
}

impl Material {
    /// A dielectric.
    pub(in super::super) fn new(name: &'static str, color: [f32; 3], roughness: f32) -> Self {
        let [red, green, blue] = color;
        Self {
            name,
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: [red, green, blue, 1.0],
                base_color_texture: None,
                metallic_factor: 0.0,
                roughness_factor: roughness,
            },
            emissive_factor: None,
            double_sided: false,
            extensions: Map::new(),
        }
    }

    /// With a texture, by its number, that multiplies the colour.
    pub(in super::super) fn textured(mut self, texture: usize) -> Self {
        self.pbr_metallic_roughness.base_color_texture = Some(TextureInfo { index: texture });
        self
    }

    /// As a metal, whose colour is that of its reflections.
    pub(in super::super) fn metal(mut self) -> Self {
        self.pbr_metallic_roughness.metallic_factor = 1.0;
        self
    }

    /// Shaded on both sides, for what has no inside.
    pub(in super::super) fn two_sided(mut self, is_two_sided: bool) -> Self {
        self.double_sided = is_two_sided;
        self
    }

    /// Sends light: a colour up to 1, times a strength.
    pub(in super::super) fn emissive(self, color: [f32; 3], strength: f32) -> Self {
        Self {
            emissive_factor: Some(color),
            ..self
        }
        .extended(
            "KHR_materials_emissive_strength",
            json!({ "emissiveStrength": strength }),
        )
    }

    /// Glass that lets all light through which it does not reflect. `thickness` and `distance` are in metres: how deep the
    /// body is, and how far white light goes in it until it has the colour `tint`.
    pub(in super::super) fn glass(
        self,
        ior: f32,
        thickness: f32,
        tint: [f32; 3],
        distance: f32,
    ) -> Self {
        self.extended(
            "KHR_materials_transmission",
            json!({ "transmissionFactor": 1.0 }),
        )
        .extended("KHR_materials_ior", json!({ "ior": ior }))
        .extended(
            "KHR_materials_volume",
            json!({
                "thicknessFactor": thickness,
                "attenuationColor": tint,
                "attenuationDistance": distance,
            }),
        )
    }

    fn extended(mut self, name: &str, values: Value) -> Self {
        self.extensions.insert(name.to_owned(), values);
        self
    }

    /// The extensions that it uses.
    pub(super) fn extension_names(&self) -> impl Iterator<Item = &String> {
        self.extensions.keys()
    }
}
