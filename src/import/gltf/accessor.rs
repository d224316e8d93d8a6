//! Accessors: typed views of buffers, in every form the format knows. glTF 2.0 specification, section 3.6.2.
//!
//! All ranges are checked when an [`Accessor`] is opened; what it claims is then there, and reading cannot fail. Nothing is
//! allocated before.

use std::ops::RangeInclusive;

use ::gltf::json::accessor::{ComponentType, Type};
use ::gltf::json::validation::Checked;

use super::document::Document;
use super::draco;

/// Most elements that an accessor without bytes (all zeros, but for its sparse values) may claim: 2^20.
///
/// Such a claim costs nothing in the file. A larger number lets a small file cost more memory before it turns out that
/// all its triangles lie in the origin.
const BYTELESS_LIMIT: usize = 1 << 20;

/// An accessor whose every element is known to be there.
#[derive(Debug)]
pub(super) struct Accessor<'a> {
    index: usize,
    /// Number of elements.
    pub(super) count: usize,
    component: ComponentType,
    /// Components of an element.
    width: usize,
    normalized: bool,
    /// `None`: zeros.
    base: Option<Elements<'a>>,
    sparse: Option<Sparse<'a>>,
}

#[derive(Clone, Copy, Debug)]
struct Elements<'a> {
    /// From the first element on, at least to the end of the last.
    bytes: &'a [u8],
    /// From one element to the next, in bytes; not less than an element.
    stride: usize,
}

#[derive(Debug)]
struct Sparse<'a> {
    indices: &'a SparseIndices,
    values: Elements<'a>,
}

/// The elements that the values of a sparse accessor replace, all below its count, ascending, with the places of these values.
///
/// They are read once, since any number of primitives may name the accessor.
#[derive(Debug)]
pub(super) struct SparseIndices(Vec<(u32, u32)>);

impl SparseIndices {
    /// Of several values for one element the last one counts.
    fn new(indices: &[u32]) -> Self {
        let mut pairs: Vec<(u32, u32)> = indices.iter().copied().zip(0..).collect();
        pairs.sort_unstable_by_key(|&(element, place)| (element, std::cmp::Reverse(place)));
        pairs.dedup_by_key(|(element, _)| *element);
        Self(pairs)
    }

    /// Calls `visit` with the places in `wanted`, which ascend, of elements that are replaced, and the places of their values.
    fn of(&self, wanted: &[u32], mut visit: impl FnMut(usize, usize)) {
        if wanted.len() < self.0.len() {
            for (at, element) in wanted.iter().enumerate() {
                if let Ok(found) = self.0.binary_search_by_key(element, |(e, _)| *e) {
                    visit(at, self.0[found].1 as usize);
                }
            }
        } else {
            for &(element, place) in &self.0 {
                if let Ok(at) = wanted.binary_search(&element) {
                    visit(at, place as usize);
                }
            }
        }
    }
}

impl<'a> Accessor<'a> {
    /// Opens accessor `index`.
    pub(super) fn open(document: &'a Document, index: usize) -> Result<Self, String> {
        let named = |cause: String| format!("accessor {index}: {cause}");
        let json = document.accessor(index)?;
        let Checked::Valid(component) = json.component_type else {
            return Err(named("its componentType is unknown".to_owned()));
        };
        let component = component.0;
        let width = match json.type_ {
            Checked::Valid(Type::Scalar) => 1,
            Checked::Valid(Type::Vec2) => 2,
            Checked::Valid(Type::Vec3) => 3,
            Checked::Valid(Type::Vec4) => 4,
            // Columns of floats have no padding between them.
            Checked::Valid(Type::Mat4) if component == ComponentType::F32 => 16,
            Checked::Valid(_) => return Err(named("holds matrices".to_owned())),
            Checked::Invalid => return Err(named("its type is unknown".to_owned())),
        };
        let claimed = json.count.0;
        let too_many = || named(format!("its count of {claimed} is beyond 32 bits"));
        // Vertex indices have 32 bits.
        let count = u32::try_from(claimed).map_err(|_| too_many())? as usize;
        let size = component.size() * width;
        let base = match json.buffer_view {
            None if count > BYTELESS_LIMIT => {
                return Err(named(format!(
                    "claims {count} elements without a buffer view; at most {BYTELESS_LIMIT} are read"
                )));
            }
            None => None,
            Some(view) => {
                let offset = json.byte_offset.map_or(0, |o| o.0);
                Some(elements(document, view.value(), offset, count, size).map_err(named)?)
            }
        };
        let sparse = match &json.sparse {
            None => None,
            Some(sparse) => {
                let in_sparse = |cause: String| named(format!("sparse: {cause}"));
                let Checked::Valid(index_component) = sparse.indices.component_type else {
                    return Err(in_sparse("its componentType is unknown".to_owned()));
                };
                let replaced = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
                let at = &sparse.indices;
                let size_of_index = index_component.0.size();
                let (view, offset) = (at.buffer_view.value(), at.byte_offset.0);
                let indices =
                    elements(document, view, offset, replaced, size_of_index).map_err(in_sparse)?;
                let (view, offset) = (
                    sparse.values.buffer_view.value(),
                    sparse.values.byte_offset.0,
                );
                let values = elements(document, view, offset, replaced, size).map_err(in_sparse)?;
                let read = || {
                    let element = || format!("accessor {index}: sparse");
                    let pair = size_of::<(u32, u32)>() + size_of::<u32>();
                    document.budget.charge_many(replaced, pair, element)?;
                    let indices = integers(indices, index_component.0, replaced);
                    match indices.iter().find(|&&i| i as usize >= count) {
                        Some(wrong) => Err(format!("replaces element {wrong} of {count}")),
                        None => Ok(SparseIndices::new(&indices)),
                    }
                };
                let indices = document.sparse[index].get_or_init(read).as_ref();
                let indices = indices.map_err(|cause| in_sparse(cause.clone()))?;
                Some(Sparse { indices, values })
            }
        };
        Ok(Self {
            index,
            count,
            component,
            width,
            normalized: json.normalized,
            base,
            sparse,
        })
    }

    /// An accessor of which the data was compressed: `values` stand for the bytes of accessor `index`.
    pub(super) fn unpacked(
        document: &Document,
        index: usize,
        values: &'a draco::Values,
    ) -> Result<Self, String> {
        let size = values.component.size() * values.width;
        Ok(Self {
            index,
            count: values.bytes.len().checked_div(size).unwrap_or(0),
            component: values.component,
            width: values.width,
            normalized: document.accessor(index)?.normalized,
            base: Some(Elements {
                bytes: &values.bytes,
                stride: size,
            }),
            sparse: None,
        })
    }

    /// The accessor, if its elements have as many components as `widths` says.
    pub(super) fn with_width(self, widths: RangeInclusive<usize>) -> Result<Self, String> {
        if widths.contains(&self.width) {
            return Ok(self);
        }
        Err(format!(
            "accessor {}: its elements have {} components, not {}",
            self.index,
            self.width,
            widths.start()
        ))
    }

    /// Components of an element.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// Integers are fractions of the largest, whether the file says so or not.
    pub(super) fn into_normalized(self) -> Self {
        Self {
            normalized: true,
            ..self
        }
    }

    /// All elements as vertex indices.
    pub(super) fn indices(&self) -> Result<Vec<u32>, String> {
        use ComponentType::{U8, U16, U32};
        if self.width != 1 || !matches!(self.component, U8 | U16 | U32) {
            return Err(format!(
                "accessor {}: indices must be unsigned integers, one an element",
                self.index
            ));
        }
        let mut indices = match self.base {
            Some(base) => integers(base, self.component, self.count),
            None => vec![0; self.count],
        };
        if let Some(sparse) = &self.sparse {
            let pairs = &sparse.indices.0;
            let most = pairs.iter().map(|(_, place)| *place as usize + 1).max();
            let values = integers(sparse.values, self.component, most.unwrap_or(0));
            for &(element, place) in pairs {
                indices[element as usize] = values[place as usize];
            }
        }
        Ok(indices)
    }

    /// The elements `wanted`, which ascend and are below the count. Components beyond the accessor's own come
    /// from `fill`.
    pub(super) fn read<const N: usize>(&self, wanted: &[u32], fill: [f32; N]) -> Vec<[f32; N]> {
        use ComponentType::{F32, I8, I16, U8, U16, U32};
        let is_normalized = self.normalized;
        // Section 3.6.2.2: both -127 and -128 are -1.
        let signed = |value: f32, most: f32| (value / most).max(-1.0);
        match (self.component, is_normalized) {
            (F32, _) => self.gather(wanted, fill, f32::from_le_bytes),
            (I8, false) => self.gather(wanted, fill, |[b]| f32::from(b as i8)),
            (I8, true) => self.gather(wanted, fill, |[b]| signed(f32::from(b as i8), 127.0)),
            (U8, false) => self.gather(wanted, fill, |[b]| f32::from(b)),
            (U8, true) => self.gather(wanted, fill, |[b]| f32::from(b) / 255.0),
            (I16, false) => self.gather(wanted, fill, |b| f32::from(i16::from_le_bytes(b))),
            (I16, true) => self.gather(wanted, fill, |b| {
                signed(f32::from(i16::from_le_bytes(b)), 32_767.0)
            }),
            (U16, false) => self.gather(wanted, fill, |b| f32::from(u16::from_le_bytes(b))),
            (U16, true) => self.gather(wanted, fill, |b| {
                f32::from(u16::from_le_bytes(b)) / 65_535.0
            }),
            // Not allowed in vertex attributes, but clear.
            (U32, false) => self.gather(wanted, fill, |b| u32::from_le_bytes(b) as f32),
            (U32, true) => self.gather(wanted, fill, |b| {
                (f64::from(u32::from_le_bytes(b)) / f64::from(u32::MAX)) as f32
            }),
        }
    }

    fn gather<const N: usize, const SIZE: usize>(
        &self,
        wanted: &[u32],
        fill: [f32; N],
        decode: impl Fn([u8; SIZE]) -> f32,
    ) -> Vec<[f32; N]> {
        let width = self.width.min(N);
        let element = |bytes: &[u8]| {
            let mut value = fill;
            let (components, _) = bytes.as_chunks::<SIZE>();
            for (to, from) in value[..width].iter_mut().zip(components) {
                *to = decode(*from);
            }
            value
        };
        let size = SIZE * self.width;
        let is_run = |first: u32, last: u32| (last - first) as usize + 1 == wanted.len();
        let mut values: Vec<[f32; N]> = match (self.base, wanted) {
            (None, _) => {
                let mut zero = fill;
                zero[..width].fill(0.0);
                vec![zero; wanted.len()]
            }
            // The usual case, and four times as fast: the elements in one piece, without gaps.
            (Some(base), &[first, .., last])
                if base.stride == size && self.width == N && is_run(first, last) =>
            {
                let run = &base.bytes[first as usize * size..(last as usize + 1) * size];
                let (components, _) = run.as_chunks::<SIZE>();
                let (elements, _) = components.as_chunks::<N>();
                elements.iter().map(|e| e.map(&decode)).collect()
            }
            (Some(base), _) => wanted
                .iter()
                .map(|&i| {
                    let start = i as usize * base.stride;
                    element(&base.bytes[start..start + size])
                })
                .collect(),
        };
        if let Some(sparse) = &self.sparse {
            sparse.indices.of(wanted, |at, place| {
                let start = place * sparse.values.stride;
                values[at] = element(&sparse.values.bytes[start..start + size]);
            });
        }
        values
    }
}

/// `count` elements of `size` bytes in a buffer view, from `offset` on. That they are there has been checked.
fn elements<'a>(
    document: &'a Document,
    view: usize,
    offset: u64,
    count: usize,
    size: usize,
) -> Result<Elements<'a>, String> {
    let (bytes, json) = document.view(view)?;
    // 0 is not allowed, but written by some for "without gaps".
    let stride = json.byte_stride.map_or(0, |s| s.0);
    let stride = if stride == 0 { size } else { stride };
    if stride < size {
        return Err(format!(
            "the stride of buffer view {view} is {stride} bytes, an element has {size}"
        ));
    }
    let length = match count {
        0 => 0,
        n => (n as u64 - 1)
            .saturating_mul(stride as u64)
            .saturating_add(size as u64),
    };
    let end = offset.saturating_add(length);
    if end > bytes.len() as u64 {
        return Err(format!(
            "reads bytes {offset}..{end} of buffer view {view}, which has {}",
            bytes.len()
        ));
    }
    // Both are at most the length of the bytes.
    let bytes = &bytes[offset as usize..end as usize];
    Ok(Elements { bytes, stride })
}

/// The first `count` elements, of one unsigned component each. Other component types, which the callers refuse, give none.
fn integers(elements: Elements, component: ComponentType, count: usize) -> Vec<u32> {
    fn all<const SIZE: usize>(
        elements: Elements,
        count: usize,
        decode: impl Fn([u8; SIZE]) -> u32,
    ) -> Vec<u32> {
        if elements.stride == SIZE {
            let (values, _) = elements.bytes.as_chunks::<SIZE>();
            return values.iter().take(count).map(|v| decode(*v)).collect();
        }
        elements
            .bytes
            .chunks(elements.stride)
            .take(count)
            .filter_map(|c| c.first_chunk::<SIZE>())
            .map(|v| decode(*v))
            .collect()
    }
    match component {
        ComponentType::U8 => all(elements, count, |[b]| u32::from(b)),
        ComponentType::U16 => all(elements, count, |b| u32::from(u16::from_le_bytes(b))),
        ComponentType::U32 => all(elements, count, u32::from_le_bytes),
        ComponentType::I8 | ComponentType::I16 | ComponentType::F32 => Vec::new(),
    }
}
