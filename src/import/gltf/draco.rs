//! Primitives compressed by Draco: KHR_draco_mesh_compression. The only file that names the crate `draco-core`.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use ::gltf::json::accessor::ComponentType;
use ::gltf::json::mesh::{Primitive, Semantic};
use ::gltf::json::validation::Checked;
use draco_core::geometry_attribute::PointAttribute;
use draco_core::geometry_indices::PointIndex;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};

use super::document::Document;
use super::extensions::Extension;

const NAME: &str = "KHR_draco_mesh_compression";

/// Most points, and most faces, of one primitive. Constant attributes take no room in a stream, so its size bounds nothing; the
/// largest primitives that were seen have a tenth of this.
const MOST_ELEMENTS: u64 = 1 << 27;

/// Points and faces that a primitive may have though its accessors claim fewer. The format wants the same numbers, but other readers do not look.
const UNCLAIMED_ELEMENTS: u64 = 1 << 20;

/// Bytes of a point beside its attributes, and of a face: their indices here and in the decoder's tables.
const ELEMENT_BYTES: u64 = 160;

/// Bytes of a value at most, with what it is made from.
const VALUE_BYTES: u64 = 32;

/// Most bytes of the attributes of one primitive: 4 GiB.
const MOST_BYTES: u64 = 1 << 32;

/// A primitive's triangles and vertices, uncompressed.
#[derive(Debug)]
pub(super) struct Unpacked {
    /// Vertex indices, all below `vertex_count`, three a triangle.
    pub(super) indices: Vec<u32>,
    pub(super) vertex_count: usize,
    /// By the name that they have in the primitive, such as `POSITION`.
    pub(super) attributes: BTreeMap<String, Values>,
}

/// An attribute's values, without gaps, one for each vertex.
#[derive(Debug)]
pub(super) struct Values {
    pub(super) component: ComponentType,
    /// Components of a value.
    pub(super) width: usize,
    pub(super) bytes: Vec<u8>,
}

/// The extension of a primitive of which the accessors have no data. Where they have, they are as good, and not rounded.
pub(super) fn extension<'a>(document: &Document, json: &'a Primitive) -> Option<Extension<'a>> {
    let extension = Extension::find(json.extensions.as_ref().map(|e| &e.others), NAME)?;
    let has_data = |a: usize| {
        let accessor = document.root.accessors.get(a);
        accessor.is_some_and(|a| a.buffer_view.is_some() || a.sparse.is_some())
    };
    let positions = json.attributes.get(&Checked::Valid(Semantic::Positions));
    let has_data = positions.is_some_and(|a| has_data(a.value()));
    (!has_data).then_some(extension)
}

/// What a primitive with `extension` holds.
pub(super) fn unpack(
    document: &Document,
    json: &Primitive,
    element: &str,
    extension: Extension,
) -> Result<Unpacked, String> {
    let named = |cause: String| format!("{NAME}: {cause}");
    let view = extension.index("bufferView");
    let view = view.ok_or_else(|| named("has no bufferView".to_owned()))?;
    let (bytes, _) = document.view(view).map_err(named)?;
    let names = extension.object("attributes");
    let names: Vec<(&String, usize)> = names.map(|a| a.indices().collect()).unwrap_or_default();
    let claimed = claimed_elements(document, json);
    let charge = |elements: u64| {
        let bytes = ELEMENT_BYTES + VALUE_BYTES * names.len() as u64;
        let bytes = elements.saturating_mul(bytes);
        document.budget.charge(bytes, || element.to_owned())
    };
    charge(claimed.min(MOST_ELEMENTS))?;
    let most = claimed.clamp(UNCLAIMED_ELEMENTS, MOST_ELEMENTS);
    let read = || decode(bytes, &names, most);
    // The decoder is made for broken data, but large, and was seen by few.
    let decoded = catch_unwind(AssertUnwindSafe(read));
    let unpacked = decoded
        .unwrap_or_else(|_| Err("the decoder failed on this data".to_owned()))
        .map_err(named)?;
    let found = unpacked.vertex_count.max(unpacked.indices.len() / 3);
    charge((found as u64).saturating_sub(claimed))?;
    Ok(unpacked)
}

/// The larger of the numbers of points and of faces that a primitive's accessors claim.
fn claimed_elements(document: &Document, json: &Primitive) -> u64 {
    let count = |accessor: usize| {
        let accessor = document.root.accessors.get(accessor);
        accessor.map_or(0, |a| a.count.0)
    };
    let positions = json.attributes.get(&Checked::Valid(Semantic::Positions));
    let points = positions.map_or(0, |a| count(a.value()));
    let faces = json.indices.map_or(0, |a| count(a.value()) / 3);
    points.max(faces)
}

/// Decodes a stream of at most `most` points and as many faces.
fn decode(bytes: &[u8], names: &[(&String, usize)], most: u64) -> Result<Unpacked, String> {
    let limits = DecodeLimits::default()
        .with_max_points(most)
        .with_max_faces(most)
        .with_max_decoded_bytes(MOST_BYTES);
    let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
    let mut mesh = Mesh::new();
    let decoded = MeshDecoder::new().decode(&mut buffer, &mut mesh);
    decoded.map_err(|e| one_line(&e.to_string()))?;
    let vertex_count = mesh.num_points();
    let corners = mesh.faces().iter().flatten();
    let indices: Vec<u32> = corners.map(|p| p.0).collect();
    if let Some(wrong) = indices.iter().find(|&&i| i as usize >= vertex_count) {
        return Err(format!("a triangle names vertex {wrong} of {vertex_count}"));
    }
    let mut attributes = BTreeMap::new();
    for &(name, id) in names {
        let attribute = u32::try_from(id)
            .ok()
            .and_then(|id| mesh.attribute_by_unique_id(id));
        let Some(attribute) = attribute else {
            return Err(format!("{name}: attribute {id} is not there"));
        };
        let values = values(attribute, vertex_count).map_err(|cause| format!("{name}: {cause}"))?;
        attributes.insert(name.clone(), values);
    }
    Ok(Unpacked {
        indices,
        vertex_count,
        attributes,
    })
}

/// The value of each vertex; vertices share them in the mesh.
fn values(attribute: &PointAttribute, vertex_count: usize) -> Result<Values, String> {
    let component = match attribute.data_type() {
        DataType::Int8 => ComponentType::I8,
        DataType::Uint8 | DataType::Bool => ComponentType::U8,
        DataType::Int16 => ComponentType::I16,
        DataType::Uint16 => ComponentType::U16,
        DataType::Uint32 => ComponentType::U32,
        DataType::Float32 => ComponentType::F32,
        other => return Err(format!("its values are {other:?}, which glTF has not")),
    };
    let width = usize::from(attribute.num_components());
    let size = component.size() * width;
    let stride = usize::try_from(attribute.byte_stride())
        .unwrap_or(0)
        .max(size);
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(size * vertex_count);
    // Fits: points have 32 bits.
    for point in 0..vertex_count as u32 {
        let start = attribute.mapped_index(PointIndex(point)).0 as usize * stride;
        let value = data.get(start..start.saturating_add(size));
        let value = value.ok_or_else(|| format!("vertex {point} has no value"))?;
        bytes.extend_from_slice(value);
    }
    Ok(Values {
        component,
        width,
        bytes,
    })
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
