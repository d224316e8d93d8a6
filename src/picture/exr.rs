//! OpenEXR: the only file that names the crate `exr`.
//!
//! Files are written as one part of scan lines with ZIP compression in blocks of 16 rows, which is lossless and what every
//! program reads. Equal pictures give equal files, whatever the number of threads. Colours carry no `chromaticities`:
//! by the standard that means Rec. 709.
//!
//! ```
//! use bspray::picture::{Attribute, Channel, Picture, Samples, Window, attribute, exr};
//!
//! let crop = Window { x: 100, y: 50, width: 1, height: 2 };
//! let picture = Picture::new(640, 480)
//!     .with_window(crop)
//!     .with_channel(Channel::new("N.X", Samples::F16(vec![0.5, -1.0])))
//!     .with_attribute(attribute::SOFTWARE, Attribute::Text("an example".into()));
//! let folder = tempfile::tempdir()?;
//! exr::write(&folder.path().join("crop.exr"), &picture)?;
//! assert_eq!(exr::read(&folder.path().join("crop.exr"))?.window, crop);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Cursor, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::block::writer::ChunksWriter;
use exr::block::{BlockIndex, UncompressedBlock};
use exr::error::{Error, Result, UnitResult};
use exr::math::Vec2;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, Compression, IntegerBounds, LineOrder, SampleType, Text,
};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::f16;
use rayon::prelude::*;

use super::channel_names::{joined_channels, sorted_channels};
use super::error::panic_message;
use super::header_order::sort_attributes;
use super::plausible::{PartSize, common_window};
use super::safe_text::{ascii, from_bytes};
use super::{Attribute, Channel, Picture, PictureError, Samples, Window, attribute, replace_file};

/// Blocks that are packed or unpacked at once: enough for many threads, few enough to hold in memory.
const BLOCKS_AT_ONCE: usize = 64;

/// Largest finite 16-bit float.
const F16_MAX: f32 = 65_504.0;

/// Writes a picture to `path`, complete or not at all (see [`replace_file()`]). Blocks are packed on rayon's current threads.
///
/// # Errors
/// `Invalid` for no or equal channels, a wrong number of values, an empty window, or an attribute that has a reserved name;
/// `Io` for what the system says.
pub fn write(path: &Path, picture: &Picture) -> std::result::Result<(), PictureError> {
    let (header, channels) =
        header_of(picture).map_err(|cause| PictureError::invalid(path, cause))?;
    replace_file(path, |file| {
        let output = BufWriter::with_capacity(1 << 20, &mut *file);
        exr::block::write(
            output,
            [header].into_iter().collect(),
            true,
            |meta, chunks| {
                let blocks: Vec<_> = meta.enumerate_ordered_header_block_indices().collect();
                for batch in blocks.chunks(BLOCKS_AT_ONCE) {
                    let packed = batch
                        .par_iter()
                        .map(|&(index, block)| Ok((index, pack(block, &channels, &meta)?)))
                        .collect::<Result<Vec<_>>>()?;
                    for (index, chunk) in packed {
                        chunks.write_chunk(index, chunk)?;
                    }
                }
                Ok(())
            },
        )?;
        Ok(sort_attributes(file)?)
    })
    .map_err(|error| at(path, error))
}

/// Reads any flat EXR file: scan lines or tiles (of which the largest level is taken), one part or several.
///
/// With several parts, channels are named `part.channel`, unless their name already starts so, and cover the union of the
/// data windows, 0 where their part has nothing. Attributes of a type that [`Attribute`] does not know are left out; where
/// parts differ, the first one's count.
///
/// # Errors
/// `Unsupported` for deep data, subsampled channels and unreasonable sizes, `Invalid` for broken files, `Io` for what
/// the system says.
pub fn read(path: &Path) -> std::result::Result<Picture, PictureError> {
    let open = || -> io::Result<(File, u64)> {
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        if metadata.is_dir() {
            return Err(io::Error::new(
                io::ErrorKind::IsADirectory,
                "is a directory",
            ));
        }
        Ok((file, metadata.len()))
    };
    let (file, length) = open().map_err(|error| PictureError::io(path, error))?;
    decode(path, BufReader::new(file), length, |_| Ok(()))
}

/// Whether bytes begin as an EXR file does.
pub(super) fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&exr::meta::magic_number::BYTES)
}

/// Reads a file's bytes as [`read`] does, if `charge` agrees to the memory that the channels take, in bytes. `name` stands in
/// messages.
///
/// # Errors
/// As [`read`], and `Unsupported` with what `charge` says.
pub(super) fn read_bytes(
    name: &str,
    bytes: &[u8],
    charge: impl FnOnce(u64) -> std::result::Result<(), String>,
) -> std::result::Result<Picture, PictureError> {
    decode(
        Path::new(name),
        Cursor::new(bytes),
        bytes.len() as u64,
        charge,
    )
}

fn decode(
    path: &Path,
    input: impl BufRead + Seek,
    length: u64,
    charge: impl FnOnce(u64) -> std::result::Result<(), String>,
) -> std::result::Result<Picture, PictureError> {
    let charge = |bytes| charge(bytes).map_err(|cause| Error::NotSupported(cause.into()));
    // The crate indexes and divides by what headers say, and a panic is no way to report a broken file. It is safe to go on:
    // nothing of the panicked call is used again.
    catch_unwind(AssertUnwindSafe(|| decode_charged(input, length, charge)))
        .unwrap_or_else(|panic| Err(Error::Invalid(panic_message(panic.as_ref()).into())))
        .map_err(|error| at(path, error))
}

fn at(path: &Path, error: Error) -> PictureError {
    match error {
        Error::Io(source) => PictureError::io(path, source),
        Error::NotSupported(cause) => {
            PictureError::unsupported(path, format!("this EXR is not supported: {cause}"))
        }
        Error::Invalid(cause) if cause == "reference to missing bytes" => {
            PictureError::invalid(path, "the file ends too early")
        }
        Error::Invalid(cause) => PictureError::invalid(path, format!("invalid EXR: {cause}")),
        Error::Aborted => PictureError::invalid(path, "aborted"),
    }
}

/// The header of a picture, and its channels in the header's order.
fn header_of(picture: &Picture) -> std::result::Result<(Header, Vec<&Samples>), String> {
    let channels = sorted_channels(picture)?;
    let list = channels.iter().map(|(name, samples)| {
        let kind = match samples {
            Samples::F16(_) => SampleType::F16,
            Samples::F32(_) => SampleType::F32,
            Samples::U32(_) => SampleType::U32,
        };
        ChannelDescription::named(name.as_str(), kind)
    });
    let window = picture.window;
    let size = Vec2(window.width as usize, window.height as usize);
    let display = Vec2(picture.display.0 as usize, picture.display.1 as usize);
    let header = Header::new(Text::default(), size, list.collect())
        .with_encoding(
            Compression::ZIP16,
            BlockDescription::ScanLines,
            LineOrder::Increasing,
        )
        .with_shared_attributes(ImageAttributes::new(IntegerBounds::from_dimensions(
            display,
        )))
        .with_attributes(LayerAttributes {
            layer_position: Vec2(window.x, window.y),
            ..layer_attributes(picture)
        });
    Ok((
        header,
        channels.into_iter().map(|(_, samples)| samples).collect(),
    ))
}

/// Attributes that the crate has a field for must be in it: it takes the name to be reserved otherwise.
fn layer_attributes(picture: &Picture) -> LayerAttributes {
    let mut attributes = LayerAttributes::default();
    for (name, value) in &picture.attributes {
        let text = |text: &String| Some(Text::from(ascii(text).as_str()));
        match (name.as_str(), value) {
            (attribute::SOFTWARE, Attribute::Text(t)) => attributes.software_name = text(t),
            (attribute::COMMENTS, Attribute::Text(t)) => attributes.comments = text(t),
            (attribute::OWNER, Attribute::Text(t)) => attributes.owner = text(t),
            (attribute::WORLD_TO_CAMERA, Attribute::M44(m)) => {
                attributes.world_to_camera = Some(*m);
            }
            (attribute::WORLD_TO_NDC, Attribute::M44(m)) => {
                attributes.world_to_normalized_device = Some(*m);
            }
            _ => {
                let value = match value {
                    Attribute::Text(text) => AttributeValue::Text(ascii(text).as_str().into()),
                    Attribute::Int(number) => AttributeValue::I32(*number),
                    Attribute::Float(number) => AttributeValue::F32(*number),
                    Attribute::M44(matrix) => AttributeValue::Matrix4x4(*matrix),
                };
                attributes.other.insert(ascii(name).as_str().into(), value);
            }
        }
    }
    attributes
}

fn pack(index: BlockIndex, channels: &[&Samples], meta: &MetaData) -> Result<Chunk> {
    let header = &meta.headers[index.layer];
    let width = header.layer_size.width();
    let block = UncompressedBlock::from_lines(&header.channels, index, |line| {
        let start = line.location.position.y() * width + line.location.position.x();
        let range = start..start + line.location.sample_count;
        match channels[line.location.channel] {
            Samples::F16(values) => {
                fill(line.value, &values[range], |v| half_bits(v).to_ne_bytes())
            }
            Samples::F32(values) => fill(line.value, &values[range], f32::to_ne_bytes),
            Samples::U32(values) => fill(line.value, &values[range], u32::to_ne_bytes),
        }
    });
    block.compress_to_chunk(&meta.headers)
}

fn half_bits(value: f32) -> u16 {
    let stored = if value.is_finite() {
        value.clamp(-F16_MAX, F16_MAX)
    } else {
        value
    };
    f16::from_f32(stored).to_bits()
}

fn fill<T: Copy, const N: usize>(bytes: &mut [u8], values: &[T], encode: fn(T) -> [u8; N]) {
    for (bytes, &value) in bytes.chunks_exact_mut(N).zip(values) {
        bytes.copy_from_slice(&encode(value));
    }
}

fn decode_charged(
    input: impl BufRead + Seek,
    file_length: u64,
    charge: impl FnOnce(u64) -> UnitResult,
) -> Result<Picture> {
    let reader = exr::block::read(input, false)?;
    let meta = reader.meta_data().clone();
    let sizes: Vec<PartSize> = meta.headers.iter().map(part_size).collect();
    let window = common_window(&sizes, file_length).ok_or_else(|| {
        Error::NotSupported("its sizes are out of all proportion to the file's length".into())
    })?;
    let channels: u64 = sizes.iter().map(|s| s.channels).sum();
    charge(
        window
            .pixels()
            .saturating_mul(channels * size_of::<f32>() as u64),
    )?;
    let mut parts: Vec<Vec<Samples>> = Vec::new();
    for header in &meta.headers {
        let samples = header.channels.list.iter();
        parts.push(
            samples
                .map(|c| empty(c.sample_type, window.pixels() as usize))
                .collect::<Result<_>>()?,
        );
    }
    // Not the crate's own parallel reader: a panic in the threads that it starts ends the program.
    let mut chunks = reader.all_chunks(false)?.peekable();
    let mut seen = BTreeSet::new();
    while chunks.peek().is_some() {
        let batch: Vec<Chunk> = chunks
            .by_ref()
            .take(BLOCKS_AT_ONCE)
            .collect::<Result<_>>()?;
        let blocks = batch
            .into_par_iter()
            .filter(is_largest_level)
            .map(|chunk| UncompressedBlock::decompress_chunk(chunk, &meta, false))
            .collect::<Result<Vec<_>>>()?;
        for block in blocks {
            let Vec2(x, y) = block.index.pixel_position;
            if !seen.insert((block.index.layer, y, x)) {
                return Err(Error::Invalid("a block is there twice".into()));
            }
            let part = block.index.layer;
            let own = sizes[part].window;
            let top_left = (own.x.abs_diff(window.x), own.y.abs_diff(window.y));
            unpack(
                &block,
                &meta.headers[part],
                window.width,
                top_left,
                &mut parts[part],
            )?;
        }
    }
    let display = meta.headers[0].shared_attributes.display_window.size;
    let mut picture = Picture {
        display: (display.0 as u32, display.1 as u32),
        window,
        ..Picture::default()
    };
    let mut named = Vec::new();
    for (header, samples) in meta.headers.iter().zip(parts) {
        collect_attributes(header, &mut picture);
        let part = &header.own_attributes.layer_name;
        let channels = header.channels.list.iter().zip(samples);
        let channels = channels.map(|(c, s)| Channel::new(from_bytes(c.name.as_slice()), s));
        named.push((
            part.as_ref().map(|name| from_bytes(name.as_slice())),
            channels.collect(),
        ));
    }
    picture.channels = joined_channels(named).map_err(|cause| Error::Invalid(cause.into()))?;
    Ok(picture)
}

fn part_size(header: &Header) -> PartSize {
    let display = header.shared_attributes.display_window.position;
    let offset = header.own_attributes.layer_position;
    let block = header.max_block_pixel_size();
    PartSize {
        // The crate reads no coordinates beyond half of what `i32` can hold: no overflow.
        window: Window {
            x: offset.0 - display.0,
            y: offset.1 - display.1,
            width: header.layer_size.0 as u32,
            height: header.layer_size.1 as u32,
        },
        block: (block.0 as u64, block.1 as u64),
        channels: header.channels.list.len() as u64,
        bytes_per_pixel: header.channels.bytes_per_pixel as u64,
        // Deflate packs at most 1,032 : 1, and PXR24 drops a byte of four before it; the DWA codecs keep one of 64 values.
        packing: match header.compression {
            Compression::DWAA(_) | Compression::DWAB(_) => 1 << 17,
            _ => 1 << 11,
        },
    }
}

/// Zeroes; an error instead of an abort where there is no memory for them.
fn empty(kind: SampleType, length: usize) -> Result<Samples> {
    fn zeroes<T: Clone + Default>(length: usize) -> Result<Vec<T>> {
        let mut values = Vec::new();
        values
            .try_reserve_exact(length)
            .map_err(|_| Error::NotSupported("there is not enough memory for it".into()))?;
        values.resize(length, T::default());
        Ok(values)
    }
    Ok(match kind {
        SampleType::F16 => Samples::F16(zeroes(length)?),
        SampleType::F32 => Samples::F32(zeroes(length)?),
        SampleType::U32 => Samples::U32(zeroes(length)?),
    })
}

fn is_largest_level(chunk: &Chunk) -> bool {
    match &chunk.compressed_block {
        CompressedBlock::Tile(tile) => tile.coordinates.level_index == Vec2(0, 0),
        _ => true,
    }
}

/// Copies a block to where it belongs, in rows of `width` values; `top_left` is where its part begins.
fn unpack(
    block: &UncompressedBlock,
    header: &Header,
    width: u32,
    top_left: (u32, u32),
    part: &mut [Samples],
) -> UnitResult {
    for line in block.lines(&header.channels) {
        let Vec2(x, y) = line.location.position;
        let start = (top_left.1 as usize + y) * width as usize + top_left.0 as usize + x;
        let range = start..start + line.location.sample_count;
        match &mut part[line.location.channel] {
            Samples::F16(values) => take(line.value, values.get_mut(range), |bytes| {
                f16::from_ne_bytes(bytes).to_f32()
            }),
            Samples::F32(values) => take(line.value, values.get_mut(range), f32::from_ne_bytes),
            Samples::U32(values) => take(line.value, values.get_mut(range), u32::from_ne_bytes),
        }
        .ok_or_else(|| Error::Invalid("a block lies outside of the picture".into()))?;
    }
    Ok(())
}

fn take<T, const N: usize>(
    bytes: &[u8],
    values: Option<&mut [T]>,
    decode: fn([u8; N]) -> T,
) -> Option<()> {
    let (pieces, rest) = bytes.as_chunks::<N>();
    let values = values.filter(|values| values.len() == pieces.len() && rest.is_empty())?;
    for (value, piece) in values.iter_mut().zip(pieces) {
        *value = decode(*piece);
    }
    Some(())
}

fn collect_attributes(header: &Header, picture: &mut Picture) {
    let own = &header.own_attributes;
    let texts = [
        (attribute::SOFTWARE, &own.software_name),
        (attribute::COMMENTS, &own.comments),
        (attribute::OWNER, &own.owner),
    ];
    let matrices = [
        (attribute::WORLD_TO_CAMERA, own.world_to_camera),
        (attribute::WORLD_TO_NDC, own.world_to_normalized_device),
    ];
    let known = texts
        .into_iter()
        .filter_map(|(name, text)| {
            Some((
                name.to_owned(),
                Attribute::Text(from_bytes(text.as_ref()?.as_slice())),
            ))
        })
        .chain(
            matrices
                .into_iter()
                .filter_map(|(name, matrix)| Some((name.to_owned(), Attribute::M44(matrix?)))),
        );
    let other = own.other.iter().filter_map(|(name, value)| {
        let value = match value {
            AttributeValue::Text(text) => Attribute::Text(from_bytes(text.as_slice())),
            AttributeValue::I32(number) => Attribute::Int(*number),
            AttributeValue::F32(number) => Attribute::Float(*number),
            AttributeValue::Matrix4x4(matrix) => Attribute::M44(*matrix),
            _ => return None,
        };
        Some((from_bytes(name.as_slice()), value))
    });
    for (name, value) in known.chain(other) {
        picture.attributes.entry(name).or_insert(value);
    }
}
