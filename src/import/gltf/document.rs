//! The JSON text as the structs of the crate `gltf`, where it accepts it, and with what it gets wrong mended.
//!
//! What `gltf-json` 1.4.1 was found to do with legal files, and what is done about it: it refuses `extras` that are not objects,
//! scenes without `nodes`, animation channels without a node and whole numbers written `3.0` (mended by [`mended`]);
//! it cuts indices to 32 bits (found by [`has_large_integer`]); it rounds node transforms to single
//! precision (read once more, as [`Pose`]). Animations are kept as JSON until one is asked for.

use std::path::Path;
use std::sync::OnceLock;

use ::gltf::json::{Root, accessor, buffer};
use serde::Deserialize;
use serde_json::Value;

use super::accessor::SparseIndices;
use super::buffers::Buffers;
use super::container::Container;
use super::mend::{has_large_integer, mended};
use super::meshopt_views;
use super::uri::Files;
use crate::import::ImportError;
use crate::import::budget::Budget;

/// Bytes that a `{` of the JSON becomes at most, with the largest of the structs it is read into and the node of a map.
const OBJECT_BYTES: usize = 1024;

/// Bytes that an item of an array or object becomes at most.
const ITEM_BYTES: usize = 64;

/// A file's JSON with its buffers.
pub(super) struct Document<'a> {
    pub(super) file: &'a Path,
    pub(super) root: Root,
    /// The transform of each node, in double precision.
    pub(super) poses: Vec<Pose>,
    pub(super) animations: Vec<Value>,
    pub(super) buffers: Buffers<'a>,
    /// Buffer views that were compressed.
    unpacked: Vec<OnceLock<Result<Vec<u8>, String>>>,
    /// The sparse elements of accessors.
    pub(super) sparse: Vec<OnceLock<Result<SparseIndices, String>>>,
    /// What all that is read takes its memory from.
    pub(super) budget: &'a Budget,
    /// The files beside it that were read.
    pub(super) files: Files,
}

/// What of a node can move: its transform as the file has it, a matrix (columns), or translation, rotation (x, y, z, w) and
/// scale, and how far it moves its mesh towards each morph target.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Pose {
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) weights: Option<Vec<f64>>,
}

#[derive(Deserialize)]
struct Versions {
    asset: Option<Asset>,
}

#[derive(Deserialize)]
struct Asset {
    version: Option<Version>,
    #[serde(rename = "minVersion")]
    min_version: Option<Version>,
}

/// A version as files write it: a text, as it should be, or a number, which was usual before 2.0.
#[derive(Deserialize)]
#[serde(untagged)]
enum Version {
    Text(String),
    Number(serde_json::Number),
}

impl Version {
    fn text(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => number.to_string(),
        }
    }
}

#[derive(Deserialize)]
struct Moving {
    #[serde(default)]
    nodes: Vec<Pose>,
    #[serde(default)]
    animations: Value,
}

impl<'a> Document<'a> {
    pub(super) fn read(
        file: &'a Path,
        container: &Container<'a>,
        budget: &'a Budget,
    ) -> Result<Self, ImportError> {
        let json = container.json;
        let count = |mark: u8| json.iter().filter(|&&b| b == mark).count();
        let bytes = [(b'{', OBJECT_BYTES), (b'[', ITEM_BYTES), (b',', ITEM_BYTES)];
        let bytes: usize = bytes.map(|(mark, bytes)| count(mark) * bytes).iter().sum();
        let charged = budget.charge(bytes as u64, || "JSON".to_owned());
        charged.map_err(|cause| ImportError::invalid(file, "JSON", cause))?;
        let wrong = |e: &dyn std::fmt::Display| ImportError::invalid(file, "JSON", e.to_string());
        check_version(file, serde_json::from_slice(json).map_err(|e| wrong(&e))?)?;
        let strict: Result<Root, _> = serde_json::from_slice(json);
        let root = match strict {
            Ok(root) if !has_large_integer(json) => root,
            strict => {
                let value = mended(json).map_err(|e| wrong(&e))?;
                match (Root::deserialize(value), strict) {
                    (Ok(root), _) => root,
                    // The error of the first reading: it knows its line.
                    (Err(_), Err(e)) | (Err(e), Ok(_)) => return Err(wrong(&e)),
                }
            }
        };
        let moving: Moving = serde_json::from_slice(json).map_err(|e| wrong(&e))?;
        let mut poses = moving.nodes;
        poses.resize(root.nodes.len(), Pose::default());
        let animations = match moving.animations {
            Value::Array(animations) => animations,
            _ => Vec::new(),
        };
        let buffers = Buffers::new(file, &root, container.binary);
        let unpacked = root.buffer_views.iter().map(|_| OnceLock::new()).collect();
        let sparse = root.accessors.iter().map(|_| OnceLock::new()).collect();
        Ok(Self {
            file,
            root,
            poses,
            animations,
            buffers,
            unpacked,
            sparse,
            budget,
            files: Files::default(),
        })
    }

    pub(super) fn invalid(
        &self,
        element: impl Into<String>,
        cause: impl Into<String>,
    ) -> ImportError {
        ImportError::invalid(self.file, element, cause)
    }

    /// `node 3 "wheel"`, as messages name it.
    pub(super) fn node_label(&self, node: usize) -> String {
        label(
            "node",
            node,
            self.root.nodes.get(node).and_then(|n| n.name.as_ref()),
        )
    }

    /// `mesh 3 "wheel"`, as messages name it.
    pub(super) fn mesh_label(&self, mesh: usize) -> String {
        label(
            "mesh",
            mesh,
            self.root.meshes.get(mesh).and_then(|m| m.name.as_ref()),
        )
    }

    pub(super) fn accessor(&self, index: usize) -> Result<&accessor::Accessor, String> {
        let count = self.root.accessors.len();
        let accessor = self.root.accessors.get(index);
        accessor.ok_or_else(|| format!("accessor {index} is not there: the file has {count}"))
    }

    /// The bytes of a buffer view, and the view itself.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], &buffer::View), String> {
        let count = self.root.buffer_views.len();
        let Some(view) = self.root.buffer_views.get(index) else {
            return Err(format!(
                "buffer view {index} is not there: the file has {count}"
            ));
        };
        let named = |cause: String| format!("buffer view {index} {cause}");
        if let Some((name, extension)) = meshopt_views::extension(view) {
            let decoded =
                self.unpacked[index].get_or_init(|| meshopt_views::decode(self, index, extension));
            let bytes = decoded
                .as_deref()
                .map_err(|cause| named(format!("({name}): {cause}")))?;
            let claimed = usize::try_from(view.byte_length.0).unwrap_or(usize::MAX);
            let within = bytes.get(..claimed).ok_or_else(|| {
                let found = bytes.len();
                named(format!(
                    "({name}): holds {found} bytes, its byteLength claims {claimed}"
                ))
            })?;
            return Ok((within, view));
        }
        let offset = view.byte_offset.map_or(0, |o| o.0);
        let range = self.buffer_range(view.buffer.value(), offset, view.byte_length.0);
        Ok((range.map_err(named)?, view))
    }

    /// Some bytes of a buffer.
    pub(super) fn buffer_range(
        &self,
        buffer: usize,
        offset: u64,
        length: u64,
    ) -> Result<&[u8], String> {
        let bytes = self
            .buffers
            .get(&self.root, &self.files, self.budget, buffer);
        let bytes = bytes.map_err(|cause| format!("cannot be had: {cause}"))?;
        let end = offset.saturating_add(length);
        // A range that does not fit in usize is no part of a slice either.
        let range = usize::try_from(offset).unwrap_or(usize::MAX)
            ..usize::try_from(end).unwrap_or(usize::MAX);
        bytes.get(range).ok_or_else(|| {
            format!(
                "claims bytes {offset}..{end} of buffer {buffer}, which has {}",
                bytes.len()
            )
        })
    }
}

/// `kind index "name"`, or without the name where there is none.
pub(super) fn label(kind: &str, index: usize, name: Option<&String>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {index} {name:?}"),
        _ => format!("{kind} {index}"),
    }
}

fn check_version(file: &Path, versions: Versions) -> Result<(), ImportError> {
    let asset = versions.asset.as_ref();
    let text = |version: &Option<Version>| version.as_ref().map(Version::text);
    let Some(version) = asset.and_then(|a| text(&a.version)) else {
        let cause = "asset.version is missing: this is not glTF 2.0";
        return Err(ImportError::invalid(file, "JSON", cause));
    };
    let least = asset.and_then(|a| text(&a.min_version));
    let major = version.split('.').next();
    if major == Some("2") && least.as_ref().is_none_or(|v| v == "2.0") {
        return Ok(());
    }
    let cause = format!(
        "version {} is not supported, only 2.0: convert the file, for example with gltf-pipeline",
        least.unwrap_or(version)
    );
    Err(ImportError::unsupported(file, "JSON", cause))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(json: &str) -> Result<Root, String> {
        let container = Container {
            json: json.as_bytes(),
            binary: None,
        };
        Document::read(Path::new("a.gltf"), &container, &Budget::new(u64::MAX, 0))
            .map(|d| d.root)
            .map_err(|e| e.to_string())
    }

    #[test]
    fn legal_files_that_the_crate_refuses_are_mended() {
        let root = read(
            r#"{"asset":{"version":"2.0","extras":"text"},"scene":0.0,"scenes":[{}],
                "nodes":[{"name":null,"extras":[1,2],"translation":[1,2.5,4294967297]}],
                "animations":[{"channels":[{"sampler":0,"target":{"path":"pointer"}}],"samplers":[]}],
                "accessors":[{"componentType":5126,"count":3.0,"type":"VEC3"}]}"#,
        )
        .expect("legal");
        assert_eq!(root.accessors[0].count.0, 3);
        assert_eq!(root.scenes[0].nodes.len(), 0);
        assert_eq!(root.nodes[0].translation, Some([1.0, 2.5, 4_294_967_297.0]));
    }

    #[test]
    fn an_index_beyond_32_bits_does_not_become_a_small_one() {
        for broken in [
            r#""nodes":[{"mesh":4294967296}]"#,
            r#""scenes":[{"nodes":[4294967296]}]"#,
            r#""meshes":[{"primitives":[{"attributes":{"POSITION":4294967296}}]}]"#,
        ] {
            let error = read(&format!(r#"{{"asset":{{"version":"2.0"}},{broken}}}"#));
            let error = error.expect_err("too large");
            assert!(error.contains("index 4294967296 is beyond"), "{error}");
        }
    }

    #[test]
    fn errors_name_line_and_column() {
        let error = read("{\"asset\":{\"version\":\"2.0\"},\n \"nodes\": 7}").expect_err("type");
        assert!(error.contains("line 2 column 11"), "{error}");
        let error = read("{\"asset\":\n{\"version\":}").expect_err("syntax");
        assert!(error.contains("line 2 column"), "{error}");
        let deep = format!("{{\"asset\":{}", "[".repeat(5000));
        assert!(read(&deep).expect_err("deep").contains("line 1 column"));
    }

    #[test]
    fn only_version_2_is_read() {
        let version = |asset: &str| read(&format!("{{{asset}}}"));
        assert!(version(r#""asset":{"version":"2.1"}"#).is_ok());
        assert!(
            version("")
                .expect_err("none")
                .contains("asset.version is missing")
        );
        assert!(
            version(r#""asset":{}"#)
                .expect_err("none")
                .contains("asset.version is missing")
        );
        let old = version(r#""asset":{"version":"1.0"},"nodes":{"a":{}}"#).expect_err("old");
        assert!(old.contains("version 1.0 is not supported"), "{old}");
        let new = version(r#""asset":{"version":"2.1","minVersion":"2.1"}"#).expect_err("new");
        assert!(new.contains("version 2.1 is not supported"), "{new}");
    }
}
