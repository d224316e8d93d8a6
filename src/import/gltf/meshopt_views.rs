//! Buffer views compressed by meshoptimizer: EXT_meshopt_compression and KHR_meshopt_compression. The only file that names the
//! crate `meshopt`.
//!
//! The decoders are made for untrusted bytes, but assert the sizes that they are given: these are checked before.

use ::gltf::json::buffer;
use bytemuck::{cast_slice, cast_slice_mut};

use super::document::Document;
use super::extensions::Extension;

/// The two names of one extension. The second has more filters and a newer form of the codec; either may hold what the other does.
const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Most bytes that a byte of compressed data can become: a block of 256 vertices of which no byte differs from the one before is
/// stored as a byte for each four of a vertex. Claims beyond are refused before anything is allocated.
const MOST_GROWTH: u64 = 1024;

/// Words of the largest vertex, of 256 bytes.
const MOST_WORDS: usize = 64;

/// What a buffer view says of its compressed data.
struct Header<'a> {
    bytes: &'a [u8],
    count: usize,
    stride: usize,
    mode: &'a str,
    filter: &'a str,
}

/// The extension of a buffer view that is compressed.
pub(super) fn extension(view: &buffer::View) -> Option<(&'static str, Extension<'_>)> {
    let others = view.extensions.as_ref().map(|e| &e.others);
    let find = |name| Extension::find(others, name).map(|e| (name, e));
    NAMES.into_iter().find_map(find)
}

/// The uncompressed bytes of a buffer view with `extension`.
pub(super) fn decode(
    document: &Document,
    index: usize,
    extension: Extension,
) -> Result<Vec<u8>, String> {
    let header = Header::read(document, extension)?;
    if header.count == 0 {
        return Ok(Vec::new());
    }
    // Vertices, their words and their bytes, in turn.
    let view = || format!("buffer view {index}");
    let bytes = header.stride.saturating_mul(3);
    document.budget.charge_many(header.count, bytes, view)?;
    let broken = || format!("its {} are broken", header.mode);
    let mut words = header.unpack()?.ok_or_else(broken)?;
    header.unfilter(&mut words)?;
    let mut bytes: Vec<u8> = cast_slice(&words).to_vec();
    bytes.truncate(header.count * header.stride);
    Ok(bytes)
}

impl<'a> Header<'a> {
    fn read(document: &'a Document, extension: Extension<'a>) -> Result<Self, String> {
        let wanted = |key: &str| extension.index(key).ok_or_else(|| format!("has no {key}"));
        let (stride, count) = (wanted("byteStride")?, wanted("count")?);
        let offset = extension.index("byteOffset").unwrap_or(0);
        let bytes = document.buffer_range(
            wanted("buffer")?,
            offset as u64,
            wanted("byteLength")? as u64,
        )?;
        let claimed = (count as u64).saturating_mul(stride as u64);
        if claimed > MOST_GROWTH * bytes.len() as u64 {
            let found = bytes.len();
            return Err(format!(
                "claims {claimed} bytes from {found} compressed ones"
            ));
        }
        let (mode, filter) = (extension.text("mode"), extension.text("filter"));
        Ok(Self {
            bytes,
            count,
            stride,
            mode: mode.unwrap_or_default(),
            filter: filter.unwrap_or("NONE"),
        })
    }

    /// The decoded elements, and zeros up to the next word. `None` where the data is broken.
    fn unpack(&self) -> Result<Option<Vec<u32>>, String> {
        let (bytes, count) = (self.bytes, self.count);
        match (self.mode, self.stride) {
            ("ATTRIBUTES", stride)
                if stride % 4 == 0 && (1..=MOST_WORDS).contains(&(stride / 4)) =>
            {
                Ok(vertices(bytes, count, stride / 4))
            }
            ("TRIANGLES", 2) if count % 3 == 0 => {
                Ok(meshopt::decode_index_buffer::<u16>(bytes, count)
                    .ok()
                    .map(widened))
            }
            ("TRIANGLES", 4) if count % 3 == 0 => {
                Ok(meshopt::decode_index_buffer(bytes, count).ok())
            }
            ("INDICES", 2) => Ok(meshopt::decode_index_sequence::<u16>(bytes, count)
                .ok()
                .map(widened)),
            ("INDICES", 4) => Ok(meshopt::decode_index_sequence(bytes, count).ok()),
            ("ATTRIBUTES" | "TRIANGLES" | "INDICES", stride) => Err(format!(
                "{count} elements of {stride} bytes are not possible in mode {}",
                self.mode
            )),
            (mode, _) => Err(format!("its mode {mode:?} is unknown")),
        }
    }

    fn unfilter(&self, words: &mut [u32]) -> Result<(), String> {
        match (self.filter, self.stride) {
            ("NONE", _) => {}
            _ if self.mode != "ATTRIBUTES" => {
                return Err(format!("mode {} has no filters", self.mode));
            }
            ("OCTAHEDRAL", 4) => meshopt::decode_filter_oct::<i8>(cast_slice_mut(words)),
            ("OCTAHEDRAL", 8) => meshopt::decode_filter_oct::<i16>(cast_slice_mut(words)),
            ("QUATERNION", 8) => meshopt::decode_filter_quat(cast_slice_mut(words)),
            ("EXPONENTIAL", _) => meshopt::decode_filter_exp::<1>(cast_slice_mut(words)),
            ("COLOR", 4) => meshopt::decode_filter_color::<u8>(cast_slice_mut(words)),
            ("COLOR", 8) => meshopt::decode_filter_color::<u16>(cast_slice_mut(words)),
            ("OCTAHEDRAL" | "QUATERNION" | "COLOR", stride) => {
                let filter = self.filter;
                return Err(format!(
                    "filter {filter} cannot be for elements of {stride} bytes"
                ));
            }
            (filter, _) => return Err(format!("its filter {filter:?} is unknown")),
        }
        Ok(())
    }
}

/// Pairs of 16 bits as words of 32, in the order of memory.
fn widened(mut indices: Vec<u16>) -> Vec<u32> {
    if indices.len() % 2 == 1 {
        indices.push(0);
    }
    let (pairs, _) = indices.as_chunks::<2>();
    pairs.iter().map(|&pair| bytemuck::cast(pair)).collect()
}

/// A vertex of `N` words; arrays of more than 32 have no default.
#[derive(Clone)]
struct Vertex<const N: usize>([u32; N]);

impl<const N: usize> Default for Vertex<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn vertices_of<const N: usize>(bytes: &[u8], count: usize) -> Option<Vec<u32>> {
    let vertices = meshopt::decode_vertex_buffer::<Vertex<N>>(bytes, count).ok()?;
    Some(vertices.into_iter().flat_map(|v| v.0).collect())
}

/// Vertices of `words` words, which the codec wants to know when it is compiled.
fn vertices(bytes: &[u8], count: usize, words: usize) -> Option<Vec<u32>> {
    macro_rules! of_size {
        ($($n:literal)*) => {
            match words {
                $($n => vertices_of::<$n>(bytes, count),)*
                _ => None,
            }
        };
    }
    of_size!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
        33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header<'a>(bytes: &'a [u8], count: usize, stride: usize, mode: &'a str) -> Header<'a> {
        Header {
            bytes,
            count,
            stride,
            mode,
            filter: "NONE",
        }
    }

    #[test]
    fn vertices_of_every_size_come_back() {
        fn check<const N: usize>() {
            let vertices: Vec<[u32; N]> = (0..300_u32)
                .map(|i| std::array::from_fn(|k| i * 977 + (k as u32) * 31 + i / 7))
                .collect();
            let packed = meshopt::encode_vertex_buffer(&vertices).expect("encodes");
            let found = header(&packed, 300, 4 * N, "ATTRIBUTES").unpack();
            assert_eq!(found, Ok(Some(vertices.into_flattened())), "{N} words");
        }
        check::<1>();
        check::<3>();
        check::<32>();
        check::<33>();
        check::<64>();
    }

    /// Each triangle from its least index on: the codec turns them.
    fn from_least(indices: &[u32]) -> Vec<[u32; 3]> {
        let turned = |t: &[u32; 3]| {
            let least = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
            [0, 1, 2].map(|k| t[(least + k) % 3])
        };
        indices.as_chunks().0.iter().map(turned).collect()
    }

    #[test]
    fn indices_come_back_in_both_modes_and_sizes() {
        // An odd number of triangles, so that pairs of 16 bits do not come out even.
        let indices: Vec<u32> = (0..99).flat_map(|i| [i, i + 1, i + 2]).collect();
        let words = |packed: &[u8], stride, mode| {
            let found = header(packed, 297, stride, mode).unpack();
            found.expect("possible").expect("whole")
        };
        let lists = meshopt::encode_index_buffer(&indices, 101).expect("encodes");
        let runs = meshopt::encode_index_sequence(&indices, 101).expect("encodes");
        for (packed, mode) in [(&lists, "TRIANGLES"), (&runs, "INDICES")] {
            let wide = words(packed, 4, mode);
            assert_eq!(from_least(&wide), from_least(&indices), "{mode}");
            let found = words(packed, 2, mode);
            let narrow = cast_slice::<u32, u16>(&found)[..297].iter();
            assert_eq!(
                narrow.map(|&i| u32::from(i)).collect::<Vec<_>>(),
                wide,
                "{mode}"
            );
        }
        assert_eq!(
            words(&runs, 4, "INDICES"),
            indices,
            "this mode keeps the order"
        );
    }

    #[test]
    fn filters_give_back_directions_rotations_numbers_and_colours() {
        let unit = glam::Vec4::new(0.48, -0.6, 0.64, 0.0).to_array();
        let unfiltered = |words: &[u32], stride: usize, filter| {
            let mut words = words.to_vec();
            let header = Header {
                filter,
                ..header(&[], 1, stride, "ATTRIBUTES")
            };
            header.unfilter(&mut words).expect("possible");
            words
        };
        let near = |found: &[f32], expected: &[f32], tolerance: f32| {
            let is_near = found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() <= tolerance);
            assert!(is_near, "{found:?} instead of {expected:?}");
        };
        let shorts = |words: &[u32]| {
            cast_slice::<u32, i16>(words)
                .iter()
                .map(|&v| f32::from(v) / 32_767.0)
                .collect::<Vec<_>>()
        };
        let bytes = |words: &[u32]| {
            cast_slice::<u32, i8>(words)
                .iter()
                .map(|&v| f32::from(v) / 127.0)
                .collect::<Vec<_>>()
        };
        let packed = meshopt::encode_filter_oct::<i16>(&[unit], 16);
        near(
            &shorts(&unfiltered(cast_slice(&packed), 8, "OCTAHEDRAL"))[..3],
            &unit[..3],
            1e-3,
        );
        let packed = meshopt::encode_filter_oct::<i8>(&[unit], 8);
        near(
            &bytes(&unfiltered(cast_slice(&packed), 4, "OCTAHEDRAL"))[..3],
            &unit[..3],
            0.02,
        );
        let rotation = [0.1, -0.7, 0.5, 0.5];
        let packed = meshopt::encode_filter_quat(&[rotation], 16);
        let found = shorts(&unfiltered(cast_slice(&packed), 8, "QUATERNION"));
        // A rotation has two quaternions.
        let side = if found[3] < 0.0 { -1.0 } else { 1.0 };
        near(
            &found.iter().map(|v| v * side).collect::<Vec<_>>(),
            &rotation,
            1e-3,
        );
        let numbers = [1.5, -1e-3, 700.25];
        let packed = meshopt::encode_filter_exp(&[numbers], 24, meshopt::EncodeExpMode::Separate);
        near(
            cast_slice(&unfiltered(cast_slice(&packed), 12, "EXPONENTIAL")),
            &numbers,
            1e-4,
        );
        let color = [0.25, 0.5, 0.75, 1.0];
        let packed = meshopt::encode_filter_color::<u8>(&[color], 8);
        let found = unfiltered(cast_slice(&packed), 4, "COLOR");
        let found: Vec<f32> = cast_slice::<u32, u8>(&found)
            .iter()
            .map(|&v| f32::from(v) / 255.0)
            .collect();
        near(&found, &color, 0.02);
    }

    #[test]
    fn sizes_that_the_codec_would_assert_are_refused() {
        for (count, stride, mode) in [
            (1, 3, "ATTRIBUTES"),
            (1, 0, "ATTRIBUTES"),
            (1, 260, "ATTRIBUTES"),
            (2, 4, "TRIANGLES"),
            (3, 1, "TRIANGLES"),
            (1, 8, "INDICES"),
        ] {
            let error = header(&[0; 64], count, stride, mode)
                .unpack()
                .expect_err("refused");
            assert!(error.contains("are not possible"), "{error}");
        }
        assert!(header(&[], 1, 4, "ODD").unpack().is_err());
        for (stride, mode, filter) in [
            (12, "ATTRIBUTES", "OCTAHEDRAL"),
            (4, "ATTRIBUTES", "QUATERNION"),
            (4, "INDICES", "EXPONENTIAL"),
            (4, "ATTRIBUTES", "ODD"),
        ] {
            let header = Header {
                filter,
                ..header(&[], 1, stride, mode)
            };
            assert!(header.unfilter(&mut [0; 3]).is_err(), "{mode} {filter}");
        }
    }

    #[test]
    fn broken_data_is_no_data() {
        let vertices: Vec<[u32; 3]> = (0..40).map(|i| [i * i, i, 7 * i]).collect();
        let packed = meshopt::encode_vertex_buffer(&vertices).expect("encodes");
        for length in 0..packed.len() {
            let found = header(&packed[..length], 40, 12, "ATTRIBUTES").unpack();
            assert_eq!(found, Ok(None), "{length}");
        }
        for mode in ["ATTRIBUTES", "TRIANGLES", "INDICES"] {
            assert_eq!(header(&[7; 90], 30, 4, mode).unpack(), Ok(None), "{mode}");
        }
    }
}
