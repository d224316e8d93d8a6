//! glTF 2.0 as far as the models need it, in one file with an embedded buffer.

use std::io;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

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
    scene: u32,
    scenes: [SceneNodes; 1],
    nodes: Vec<Node>,
    cameras: Vec<serde_json::Value>,
    materials: Vec<Material>,
    meshes: Vec<Mesh>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    buffers: Vec<Buffer>,
    #[serde(skip)]
    bytes: Vec<u8>,
}

#[derive(Serialize)]
struct Asset {
    version: &'static str,
    generator: &'static str,
}

#[derive(Serialize)]
struct SceneNodes {
    name: &'static str,
    nodes: Vec<usize>,
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
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Material {
    name: &'static str,
    pbr_metallic_roughness: PbrMetallicRoughness,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    double_sided: bool,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct PbrMetallicRoughness {
    base_color_factor: [f32; 4],
    metallic_factor: f32,
    roughness_factor: f32,
}

#[derive(Serialize)]
struct Mesh {
    name: &'static str,
    primitives: [Primitive; 1],
}

#[derive(Serialize)]
struct Primitive {
    attributes: Attributes,
    indices: usize,
    material: usize,
}

#[derive(Serialize)]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: usize,
    #[serde(rename = "NORMAL")]
    normal: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<[f32; 3]>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    target: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    byte_length: usize,
    uri: String,
}

impl Document {
    /// A document with an empty scene.
    pub(super) fn new(scene: &'static str) -> Self {
        Self {
            asset: Asset {
                version: "2.0",
                generator: "bspray models/generate.rs",
            },
            scene: 0,
            scenes: [SceneNodes {
                name: scene,
                nodes: Vec::new(),
            }],
            nodes: Vec::new(),
            cameras: Vec::new(),
            materials: Vec::new(),
            meshes: Vec::new(),
            accessors: Vec::new(),
            buffer_views: Vec::new(),
            buffers: Vec::new(),
            bytes: Vec::new(),
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
        let [red, green, blue] = color;
        self.materials.push(Material {
            name,
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: [red, green, blue, 1.0],
                metallic_factor: 0.0,
                roughness_factor: roughness,
            },
            // The two sides of what has no inside.
            double_sided: shape.triangles.len() == 2,
        });
        let attributes = Attributes {
            position: self.vectors(&shape.positions, true),
            normal: self.vectors(&shape.normals, false),
        };
        let indices = shape.triangles.as_flattened();
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let buffer_view = self.view(&bytes, ELEMENT_ARRAY_BUFFER);
        self.accessors.push(Accessor {
            buffer_view,
            component_type: UNSIGNED_SHORT,
            count: indices.len(),
            kind: "SCALAR",
            min: None,
            max: None,
        });
        self.meshes.push(Mesh {
            name,
            primitives: [Primitive {
                attributes,
                indices: self.accessors.len() - 1,
                material: self.materials.len() - 1,
            }],
        });
        self.meshes.len() - 1
    }

    /// Adds a camera; returns its number.
    pub(super) fn camera(&mut self, camera: serde_json::Value) -> usize {
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

    /// The file's bytes.
    pub(super) fn finish(mut self) -> io::Result<Vec<u8>> {
        let encoded = STANDARD.encode(&self.bytes);
        self.buffers.push(Buffer {
            byte_length: self.bytes.len(),
            uri: format!("data:application/octet-stream;base64,{encoded}"),
        });
        let mut file = serde_json::to_vec_pretty(&self)?;
        file.push(b'\n');
        Ok(file)
    }

    fn vectors(&mut self, vectors: &[[f32; 3]], with_bounds: bool) -> usize {
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
            corner.filter(|_| with_bounds)
        };
        let accessor = Accessor {
            buffer_view: self.view(&bytes, ARRAY_BUFFER),
            component_type: FLOAT,
            count: vectors.len(),
            kind: "VEC3",
            min: bound(f32::min),
            max: bound(f32::max),
        };
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8], target: u32) -> usize {
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
