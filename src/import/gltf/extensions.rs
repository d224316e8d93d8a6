//! The gate for extensions, and the reading of their JSON.
//!
//! The crate `gltf` accepts or refuses *required* extensions by a list of its own, which has little to do with what
//! we do, so the list here decides.

use std::collections::BTreeSet;

use ::gltf::json::Root;
use glam::Vec3;
use serde_json::{Map, Value};

use super::document::Document;
use super::notes::Notes;
use crate::import::ImportError;

/// Extensions that are read.
const SUPPORTED: [&str; 19] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
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
];

/// An extension that is read in part, so that files may require it.
const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// What is lost without an extension, for those that are common, and what to do where it is required.
const KNOWN: [(&str, &str); 6] = [
    ("EXT_texture_avif", "the textures' other images are used"),
    ("KHR_animation_pointer", "what it animates stays at rest"),
    ("MSFT_texture_dds", "the textures' other images are used"),
    ("KHR_xmp", "it describes the file, not the picture"),
    ("KHR_xmp_json_ld", "it describes the file, not the picture"),
    (
        SPECULAR_GLOSSINESS,
        "the diffuse colour and the glossiness are shown, the specular colour is not",
    ),
];

/// Refuses files that require what is not supported, and notes what else the file uses without effect.
pub(super) fn gate(document: &Document, notes: &mut Notes) -> Result<(), ImportError> {
    let root = &document.root;
    let is_supported = |name: &&str| SUPPORTED.contains(name);
    let missing: BTreeSet<&str> = root
        .extensions_required
        .iter()
        .map(String::as_str)
        .filter(|name| !is_supported(name) && *name != SPECULAR_GLOSSINESS)
        .collect();
    if !missing.is_empty() {
        let names: Vec<&str> = missing.iter().copied().collect();
        let cause = format!(
            "not supported: {}; export the file without",
            names.join(", ")
        );
        return Err(ImportError::unsupported(
            document.file,
            "extensionsRequired",
            cause,
        ));
    }
    let listed = root.extensions_used.iter().map(String::as_str);
    let used: BTreeSet<&str> = listed.chain(material_extensions(root)).collect();
    for name in used.iter().filter(|name| !is_supported(name)) {
        let known = KNOWN.iter().find(|(n, _)| n == name);
        let text = match known {
            Some((_, loss)) => format!("{name} is not supported: {loss}"),
            None => format!("{name} is not supported and has no effect"),
        };
        notes.add("extensionsUsed", text);
    }
    Ok(())
}

/// Names of the extensions in materials, which not all files list.
fn material_extensions(root: &Root) -> impl Iterator<Item = &str> {
    let maps = root.materials.iter().filter_map(|m| m.extensions.as_ref());
    maps.flat_map(|e| e.others.keys().map(String::as_str))
}

/// An extension's JSON object. Members that are missing, or of another type, have their defaults.
#[derive(Clone, Copy)]
pub(super) struct Extension<'a>(&'a Map<String, Value>);

impl<'a> Extension<'a> {
    /// The extension `name` of an element.
    pub(super) fn find(extensions: Option<&'a Map<String, Value>>, name: &str) -> Option<Self> {
        extensions?.get(name)?.as_object().map(Self)
    }

    pub(super) fn object(self, key: &str) -> Option<Self> {
        self.0.get(key)?.as_object().map(Self)
    }

    /// The objects of an array; `None` for items that are none.
    pub(super) fn objects(self, key: &str) -> Vec<Option<Self>> {
        let items = self.0.get(key).and_then(Value::as_array);
        items
            .into_iter()
            .flatten()
            .map(|v| v.as_object().map(Self))
            .collect()
    }

    /// Whether an array holds `index`.
    pub(super) fn lists(self, key: &str, index: usize) -> bool {
        let items = self.0.get(key).and_then(Value::as_array);
        items.is_some_and(|i| i.iter().any(|v| v.as_u64() == Some(index as u64)))
    }

    pub(super) fn text(self, key: &str) -> Option<&'a str> {
        self.0.get(key)?.as_str()
    }

    /// An index; one beyond 32 bits is as wrong as any that is too large, and stays so.
    pub(super) fn index(self, key: &str) -> Option<usize> {
        let index = self.0.get(key)?.as_u64()?;
        Some(usize::try_from(index).unwrap_or(usize::MAX))
    }

    /// The members that are indices.
    pub(super) fn indices(self) -> impl Iterator<Item = (&'a String, usize)> {
        let index = |v: &Value| Some(usize::try_from(v.as_u64()?).unwrap_or(usize::MAX));
        self.0.iter().filter_map(move |(k, v)| Some((k, index(v)?)))
    }

    pub(super) fn flag(self, key: &str) -> Option<bool> {
        self.0.get(key)?.as_bool()
    }

    pub(super) fn number(self, key: &str) -> Option<f32> {
        finite(self.0.get(key)?)
    }

    pub(super) fn numbers<const N: usize>(self, key: &str) -> Option<[f32; N]> {
        let items = self.0.get(key)?.as_array()?;
        let numbers: Vec<f32> = items.iter().map_while(finite).collect();
        numbers.try_into().ok()
    }

    pub(super) fn color(self, key: &str, default: Vec3) -> Vec3 {
        self.numbers(key).map_or(default, Vec3::from)
    }

    /// The object's own extensions.
    pub(super) fn extensions(self) -> Option<&'a Map<String, Value>> {
        self.0.get("extensions")?.as_object()
    }
}

fn finite(value: &Value) -> Option<f32> {
    let number = value.as_f64()? as f32;
    number.is_finite().then_some(number)
}
