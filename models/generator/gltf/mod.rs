//! glTF 2.0 as far as the models need it: one file, as text with an embedded buffer or as GLB.

mod glb;
mod material;
mod parts;
mod pose;

use std::collections::BTreeSet;
use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

pub(super) use self::glb::glb;
pub(super) use self::material::Material;
use self::parts::{Accessor, Asset, Attributes, Buffer, BufferView, Mesh, Primitive, SceneNodes};
pub(super) use self::pose::{looking, rotation, sin_cos, turns};
use super::shapes::Shape;

/// Component types and targets by their numbers in OpenGL.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A document that grows as meshes, nodes and cameras are added.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    extensions_used: BTreeSet<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extensions: Option<Value>,
    scene: u32,
    scenes: [SceneNodes; 1],
    nodes: Vec<Node>,
    cameras: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    textures: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    images: Vec<Value>,
    materials: Vec<Material>,
    meshes: Vec<Mesh>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    buffers: Vec<Buffer>,
    #[serde(skip)]
    bytes: Vec<u8>,
    #[serde(skip)]
    lights: Vec<Value>,
}

/// A node: translation, rotation (a unit quaternion, x y z w) and scale place what hangs below it.
#[derive(Default, Serialize)]
pub(super) struct Node {
    pub name: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f32; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<usize>,
    /// A light of KHR_lights_punctual, which shines along -z.
    #[serde(
        rename = "extensions",
        skip_serializing_if = "Option::is_none",
        serialize_with = "light_extension"
    )]
    pub light: Option<usize>,
}

/// How a node names its light.
fn light_extension<S: Serializer>(light: &Option<usize>, to: S) -> Result<S::Ok, S::Error> {
    json!({ "KHR_lights_punctual": { "light": light } }).serialize(to)
}

/// A shape in the document's buffer, to be used by meshes.
#[derive(Clone, Copy)]
pub(super) struct Geometry {
    attributes: Attributes,
    indices: usize,
}

impl Document {
    /// A document with an empty scene.
    pub(super) fn new(scene: &'static str) -> Self {
        Self {
            asset: Asset {
                version: "2.0",
                generator: "bspray models/generate.rs",
            },
            extensions_used: BTreeSet::new(),
            extensions: None,
            scene: 0,
            scenes: [SceneNodes {
                name: scene,
                nodes: Vec::new(),
            }],
            nodes: Vec::new(),
            cameras: Vec::new(),
            textures: Vec::new(),
            images: Vec::new(),
            materials: Vec::new(),
            meshes: Vec::new(),
            accessors: Vec::new(),
            buffer_views: Vec::new(),
            buffers: Vec::new(),
            bytes: Vec::new(),
            lights: Vec::new(),
        }
    }

    /// Adds a dielectric of a linear colour and a mesh that wears it; returns the mesh.
    pub(super) fn mesh(
        &mut self,
        name: &'static str,
        shape: &Shape,
        color: [f32; 3],
        roughness: f32,
    ) -> usize {
        // The two sides of what has no inside.
        let is_flat = shape.triangles.len() == 2;
        let material = self.material(Material::new(name, color, roughness).two_sided(is_flat));
        let geometry = self.geometry(shape);
        self.mesh_of(name, geometry, material)
    }

    /// Adds a material; returns its number.
    pub(super) fn material(&mut self, material: Material) -> usize {
        self.extensions_used
            .extend(material.extension_names().cloned());
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds a texture that repeats a PNG; returns its number.
    pub(super) fn texture(&mut self, name: &'static str, png: &[u8]) -> usize {
        let view = self.view(png, None);
        self.images
            .push(json!({ "name": name, "mimeType": "image/png", "bufferView": view }));
        self.textures
            .push(json!({ "name": name, "source": self.images.len() - 1 }));
        self.textures.len() - 1
    }

    /// Adds a shape's vertices and triangles.
    pub(super) fn geometry(&mut self, shape: &Shape) -> Geometry {
        let attributes = Attributes {
            position: self.vectors(&shape.positions, "VEC3", true),
            normal: self.vectors(&shape.normals, "VEC3", false),
            uv: (!shape.uvs.is_empty()).then(|| self.vectors(&shape.uvs, "VEC2", false)),
        };
        let indices = shape.triangles.as_flattened();
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let buffer_view = self.view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        self.accessors.push(Accessor {
            buffer_view,
            component_type: UNSIGNED_SHORT,
            count: indices.len(),
            kind: "SCALAR",
            min: None,
            max: None,
        });
        Geometry {
            attributes,
            indices: self.accessors.len() - 1,
        }
    }

    /// Adds a mesh: a geometry, which meshes may share, of one material. Returns its number.
    pub(super) fn mesh_of(
        &mut self,
        name: &'static str,
        geometry: Geometry,
        material: usize,
    ) -> usize {
        self.meshes.push(Mesh {
            name,
            primitives: [Primitive {
                attributes: geometry.attributes,
                indices: geometry.indices,
                material,
            }],
        });
        self.meshes.len() - 1
    }

    /// Adds a light of KHR_lights_punctual; returns its number.
    pub(super) fn light(&mut self, light: Value) -> usize {
        self.extensions_used
            .insert("KHR_lights_punctual".to_owned());
        self.lights.push(light);
        self.lights.len() - 1
    }

    /// Adds a camera; returns its number.
    pub(super) fn camera(&mut self, camera: Value) -> usize {
        self.cameras.push(camera);
        self.cameras.len() - 1
    }

    /// Adds a node that is some other node's child; returns its number.
    pub(super) fn child(&mut self, node: Node) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Adds a node to the scene.
    pub(super) fn root(&mut self, node: Node) {
        let number = self.child(node);
        self.scenes[0].nodes.push(number);
    }

    /// The file's bytes as a GLB.
    pub(super) fn finish_glb(mut self) -> io::Result<Vec<u8>> {
        if !self.lights.is_empty() {
            let lights = std::mem::take(&mut self.lights);
            self.extensions = Some(json!({ "KHR_lights_punctual": { "lights": lights } }));
        }
        let bytes = std::mem::take(&mut self.bytes);
        self.buffers.push(Buffer {
            byte_length: bytes.len(),
            uri: None,
        });
        Ok(glb(&serde_json::to_string(&self)?, bytes))
    }

    /// The file's bytes as text, of a document without lights.
    pub(super) fn finish(mut self) -> io::Result<Vec<u8>> {
        let encoded = STANDARD.encode(&self.bytes);
        self.buffers.push(Buffer {
            byte_length: self.bytes.len(),
            uri: Some(format!("data:application/octet-stream;base64,{encoded}")),
        });
        let mut file = serde_json::to_vec_pretty(&self)?;
        file.push(b'\n');
        Ok(file)
    }

    fn vectors<const N: usize>(
        &mut self,
        vectors: &[[f32; N]],
        kind: &'static str,
        with_bounds: bool,
    ) -> usize {
        let bytes: Vec<u8> = vectors
            .as_flattened()
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let bound = |choose: fn(f32, f32) -> f32| {
            let corner = vectors
                .iter()
                .copied()
                .reduce(|a, b| std::array::from_fn(|axis| choose(a[axis], b[axis])));
            corner.filter(|_| with_bounds).map(Vec::from)
        };
        let accessor = Accessor {
            buffer_view: self.view(&bytes, Some(ARRAY_BUFFER)),
            component_type: FLOAT,
            count: vectors.len(),
            kind,
            min: bound(f32::min),
            max: bound(f32::max),
        };
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.buffer_views.push(BufferView {
            buffer: 0,
            byte_offset: self.bytes.len(),
            byte_length: bytes.len(),
            target,
        });
        self.bytes.extend(bytes);
        // Accessors begin at multiples of their component's size.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.buffer_views.len() - 1
    }
}
