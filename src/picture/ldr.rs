//! PNG and JPEG out, PNG, JPEG, TGA, BMP, WebP and HDR in: the only file that names the crate `image`.
//!
//! There is no colour management: embedded profiles and gamma values are not looked at, nor is a photograph's orientation.
//!
//! ```
//! use bspray::picture::{Raster, ToneMap, ldr, read_image};
//! use bspray::scene::Pixels;
//!
//! let radiance = [[0.04, 0.05, 0.06], [40.0, 0.5, 0.0]];
//! let raster = Raster::from_rgb(2, 1, &radiance.map(|c| ToneMap::PbrNeutral.apply(c)));
//! let image = read_image("two.png", &ldr::png_bytes(&raster)?)?;
//! assert!(matches!(image.pixels, Some(Pixels::Rgba8(pixels)) if pixels[0] == [25, 39, 48, 255]));
//! # Ok::<(), bspray::picture::PictureError>(())
//! ```

use std::io::{Cursor, Error, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::error::LimitErrorKind;
use image::{
    ColorType, DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError,
    ImageFormat, ImageReader, Limits,
};

use super::error::panic_message;
use super::{PictureError, Raster, RasterPixels, replace_file};
use crate::scene::{Image, Pixels};

/// Longest side of an image that is read, in pixels.
pub const MAX_SIDE: u32 = 65_536;

/// Memory for the pixels of an image that is read: a side of 16,384 at 16 bits a channel, with alpha.
const MAX_PIXEL_BYTES: u64 = 2 << 30;

/// Memory beside the pixels that a decoder may ask for.
const DECODER_BYTES: u64 = 256 << 20;

/// Most bytes that deflate packs into one (RFC 1951: 258 bytes in two bits).
const DEFLATE_GROWTH: u64 = 1032;

/// JPEG quality. The encoder never subsamples colour (4:4:4).
const JPEG_QUALITY: u8 = 95;

/// The 8-bit formats that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LdrFormat {
    /// Lossless, with or without alpha.
    Png,
    /// Lossy, without alpha.
    Jpeg,
}

impl LdrFormat {
    /// The format that an extension names: `png`, `jpg` or `jpeg`, in any case.
    ///
    /// # Errors
    /// `Unsupported`, with the extensions that there are.
    pub fn of_path(path: &Path) -> Result<Self, PictureError> {
        match extension(path).as_str() {
            "png" => Ok(Self::Png),
            "jpg" | "jpeg" => Ok(Self::Jpeg),
            _ => Err(PictureError::unsupported(
                path,
                "no picture format of that extension; there are .png, .jpg, .jpeg and .exr",
            )),
        }
    }
}

/// Writes an 8-bit picture in the format that the extension names, complete or not at all (see [`replace_file()`]).
///
/// # Errors
/// `Unsupported` for another extension and for alpha in a JPEG, `Invalid` for a wrong number of pixels, `Io` for what the
/// system says.
pub fn write(path: &Path, raster: &Raster) -> Result<(), PictureError> {
    let bytes = encode(path, LdrFormat::of_path(path)?, raster)?;
    replace_file(path, |file| file.write_all(&bytes)).map_err(|e: Error| PictureError::io(path, e))
}

/// The bytes of a PNG file, for a page that embeds it.
///
/// # Errors
/// `Invalid` for a wrong number of pixels.
pub fn png_bytes(raster: &Raster) -> Result<Vec<u8>, PictureError> {
    encode(Path::new("picture.png"), LdrFormat::Png, raster)
}

fn encode(path: &Path, format: LdrFormat, raster: &Raster) -> Result<Vec<u8>, PictureError> {
    let Raster {
        width,
        height,
        ref pixels,
    } = *raster;
    if u64::from(width) * u64::from(height) != pixels.len() as u64 || pixels.is_empty() {
        let cause = format!(
            "{} pixels for a picture of {width} x {height}",
            pixels.len()
        );
        return Err(PictureError::invalid(path, cause));
    }
    let (bytes, color) = match pixels {
        RasterPixels::Rgb(pixels) => (pixels.as_flattened(), ExtendedColorType::Rgb8),
        RasterPixels::Rgba(pixels) => (pixels.as_flattened(), ExtendedColorType::Rgba8),
    };
    let mut file = Vec::new();
    let written = match format {
        LdrFormat::Png => {
            PngEncoder::new_with_quality(&mut file, CompressionType::Default, FilterType::Adaptive)
                .write_image(bytes, width, height, color)
        }
        LdrFormat::Jpeg if color == ExtendedColorType::Rgba8 => {
            return Err(PictureError::unsupported(
                path,
                "JPEG has no alpha; use .png",
            ));
        }
        LdrFormat::Jpeg => JpegEncoder::new_with_quality(&mut file, JPEG_QUALITY)
            .write_image(bytes, width, height, color),
    };
    written.map_err(|e| PictureError::unsupported(path, e.to_string()))?;
    Ok(file)
}

/// Decodes an image of a model as [`read_image_if`] does, whatever memory it takes.
#[cfg(test)]
fn read_image(name: &str, bytes: &[u8]) -> Result<Image, PictureError> {
    read_image_if(name, bytes, |_| Ok(()))
}

/// Decodes an image of a model, if `charge` agrees to the memory that it takes, in bytes. The format is told by the first bytes,
/// and by `name`'s extension where these say nothing (TGA).
///
/// The numbers stay the file's: 8 bits stay 8, 16 stay 16, HDR becomes floats; grey is spread over the colours and a
/// missing alpha is 1. The image's name is `name`. [`read_image`](super::read_image) knows OpenEXR as well.
///
/// # Errors
/// `Unsupported` for another format, for images beyond [`MAX_SIDE`] or 2 GiB of pixels and with what `charge` says, `Invalid` for
/// broken ones.
pub fn read_image_if(
    name: &str,
    bytes: &[u8],
    charge: impl Fn(u64) -> Result<(), String>,
) -> Result<Image, PictureError> {
    let path = Path::new(name);
    let by_extension = match extension(path).as_str() {
        "tga" => Some(ImageFormat::Tga),
        _ => None,
    };
    let format = image::guess_format(bytes).ok().or(by_extension);
    let readable = "images are read from PNG, JPEG, TGA, BMP, WebP, HDR and EXR";
    let Some(format) = format.filter(ImageFormat::reading_enabled) else {
        let cause = match format {
            Some(format) => format!("is {format:?}; {readable}"),
            None => format!("is no image that can be read; {readable}"),
        };
        return Err(PictureError::unsupported(path, cause));
    };
    let read = || match decoder(bytes, format) {
        Ok(decoder) => {
            let charged = charge(memory_of(&decoder));
            charged.map_err(|cause| PictureError::unsupported(path, cause))?;
            check_claim(&decoder, bytes, format).map_err(|c| PictureError::invalid(path, c))?;
            DynamicImage::from_decoder(decoder).map_err(|error| at(path, error))
        }
        Err(error) => Err(at(path, error)),
    };
    let decoded = catch_unwind(AssertUnwindSafe(read))
        .map_err(|panic| PictureError::invalid(path, panic_message(panic.as_ref())))??;
    let (width, height) = (decoded.width(), decoded.height());
    if width == 0 || height == 0 {
        return Err(PictureError::invalid(path, "has no pixels"));
    }
    Ok(Image {
        name: name.to_owned(),
        width,
        height,
        pixels: Some(pixels_of(decoded)),
        ..Image::default()
    })
}

/// Bytes that an image takes while it is decoded: its own pixels, then those with four channels twice.
fn memory_of(decoder: &impl ImageDecoder) -> u64 {
    let (width, height) = decoder.dimensions();
    let bytes_of_channel = match decoder.color_type() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => 1,
        ColorType::Rgb32F | ColorType::Rgba32F => 4,
        _ => 2,
    };
    let pixels = u64::from(width) * u64::from(height);
    decoder
        .total_bytes()
        .saturating_add(pixels.saturating_mul(8 * bytes_of_channel))
}

/// Refuses a PNG with fewer bytes than its pixels can be packed into, of which a decoder would find out at the end.
fn check_claim(
    decoder: &impl ImageDecoder,
    bytes: &[u8],
    format: ImageFormat,
) -> Result<(), String> {
    let least = match format {
        // Palettes have 8 pixels a byte and are spread to 3 or 4 bytes each.
        ImageFormat::Png => decoder.total_bytes() / 32 / DEFLATE_GROWTH,
        _ => 0,
    };
    let (width, height) = decoder.dimensions();
    match bytes.len() as u64 {
        found if found < least => Err(format!(
            "claims {width} x {height} pixels, for which its {found} bytes are too few"
        )),
        _ => Ok(()),
    }
}

fn decoder(bytes: &[u8], format: ImageFormat) -> Result<impl ImageDecoder, ImageError> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_PIXEL_BYTES + DECODER_BYTES);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder()?;
    limits.reserve(decoder.total_bytes())?;
    decoder.set_limits(limits)?;
    Ok(decoder)
}

fn at(path: &Path, error: ImageError) -> PictureError {
    match error {
        ImageError::IoError(source) if source.kind() == std::io::ErrorKind::UnexpectedEof => {
            PictureError::invalid(path, "the image ends too early")
        }
        ImageError::Limits(limit) => {
            let cause = match limit.kind() {
                LimitErrorKind::DimensionError => {
                    format!("the image is more than {MAX_SIDE} pixels wide or high")
                }
                _ => "the image needs more than 2 GiB for its pixels".to_owned(),
            };
            PictureError::unsupported(path, cause)
        }
        ImageError::Unsupported(error) => PictureError::unsupported(path, error.to_string()),
        error => PictureError::invalid(path, error.to_string()),
    }
}

fn pixels_of(image: DynamicImage) -> Pixels {
    use DynamicImage as D;
    match image {
        D::ImageLuma16(_) | D::ImageLumaA16(_) | D::ImageRgb16(_) | D::ImageRgba16(_) => {
            Pixels::Rgba16(image.into_rgba16().as_chunks().0.to_vec())
        }
        D::ImageRgb32F(_) | D::ImageRgba32F(_) => {
            Pixels::RgbaF32(image.into_rgba32f().as_chunks().0.to_vec())
        }
        _ => Pixels::Rgba8(image.into_rgba8().as_chunks().0.to_vec()),
    }
}

fn extension(path: &Path) -> String {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    extension.to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayAlphaImage, Luma, LumaA, Rgb, RgbImage};

    /// A picture of 3 x 2 pixels, every value another.
    fn raster(alpha: bool) -> Raster {
        let pixels = if alpha {
            RasterPixels::Rgba((0..6).map(|i| [i, 40 + i, 250 - i, 50 * i]).collect())
        } else {
            RasterPixels::Rgb((0..6).map(|i| [i, 40 + i, 250 - i]).collect())
        };
        Raster {
            width: 3,
            height: 2,
            pixels,
        }
    }

    fn file(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.into().write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn a_png_reads_back_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        for alpha in [false, true] {
            let path = folder.path().join("picture.PNG");
            write(&path, &raster(alpha)).unwrap();
            let image = read_image("x", &std::fs::read(&path).unwrap()).unwrap();
            let expected = match raster(alpha).pixels {
                RasterPixels::Rgb(p) => p.iter().map(|&[r, g, b]| [r, g, b, 255]).collect(),
                RasterPixels::Rgba(pixels) => pixels,
            };
            assert_eq!((image.width, image.height), (3, 2));
            assert_eq!(image.pixels, Some(Pixels::Rgba8(expected)));
        }
    }

    #[test]
    fn a_jpeg_keeps_the_colour_of_single_pixels() {
        // Red and blue columns: subsampled colour would make both purple.
        let columns = (0..256).map(|i| if i % 2 == 0 { [255, 0, 0] } else { [0, 0, 255] });
        let raster = Raster {
            width: 16,
            height: 16,
            pixels: RasterPixels::Rgb(columns.collect()),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.jpeg");
        write(&path, &raster).unwrap();
        let image = read_image("x", &std::fs::read(&path).unwrap()).unwrap();
        let Some(Pixels::Rgba8(pixels)) = image.pixels else {
            panic!("8 bits")
        };
        let [red, blue] = [pixels[100], pixels[101]];
        assert!(red[0] > 225 && red[2] < 30, "{red:?}");
        assert!(blue[2] > 225 && blue[0] < 30, "{blue:?}");
    }

    #[test]
    fn what_cannot_be_written_is_named_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let in_folder = |name: &str| folder.path().join(name);
        let error = write(&in_folder("a.gif"), &raster(false)).unwrap_err();
        assert!(matches!(error, PictureError::Unsupported { .. }));
        assert!(error.to_string().contains(".png, .jpg, .jpeg and .exr"));
        let error = write(&in_folder("a.jpg"), &raster(true)).unwrap_err();
        assert!(error.to_string().ends_with("JPEG has no alpha; use .png"));
        let mut short = raster(false);
        short.height = 3;
        let error = write(&in_folder("a.png"), &short).unwrap_err();
        assert!(
            error
                .to_string()
                .ends_with("6 pixels for a picture of 3 x 3")
        );
        short.height = 0;
        short.pixels = RasterPixels::Rgb(Vec::new());
        assert!(write(&in_folder("a.png"), &short).is_err());
        let error = write(&in_folder("no/a.png"), &raster(false)).unwrap_err();
        assert!(matches!(error, PictureError::Io { .. }));
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }

    #[test]
    fn a_jpeg_too_wide_for_its_format_is_an_error() {
        let raster = Raster {
            width: 65_536,
            height: 1,
            pixels: RasterPixels::Rgb(vec![[1, 2, 3]; 65_536]),
        };
        assert!(encode(Path::new("a.jpg"), LdrFormat::Jpeg, &raster).is_err());
        assert!(png_bytes(&raster).is_ok());
    }

    #[test]
    fn every_8_bit_format_is_read() {
        let rgb = RgbImage::from_fn(3, 2, |x, y| Rgb([x as u8, y as u8, 200]));
        let expected: Vec<[u8; 4]> = rgb.pixels().map(|p| [p[0], p[1], p[2], 255]).collect();
        use ImageFormat::{Bmp, Png, Tga, WebP};
        for format in [Bmp, Png, Tga, WebP] {
            let name = if format == Tga {
                "dir/x.TGA"
            } else {
                "no extension"
            };
            let image = read_image(name, &file(rgb.clone(), format)).unwrap();
            assert_eq!(
                image.pixels,
                Some(Pixels::Rgba8(expected.clone())),
                "{format:?}"
            );
            assert_eq!(image.name, name);
        }
    }

    #[test]
    fn grey_is_spread_and_16_bits_stay() {
        let grey = GrayAlphaImage::from_fn(2, 1, |x, _| LumaA([70 + x as u8, 9]));
        let image = read_image("", &file(grey, ImageFormat::Png)).unwrap();
        let expected = vec![[70, 70, 70, 9], [71, 71, 71, 9]];
        assert_eq!(image.pixels, Some(Pixels::Rgba8(expected)));
        let grey = image::ImageBuffer::from_fn(2, 1, |x, _| Luma([0x1234 + x as u16]));
        let image = read_image("", &file(grey, ImageFormat::Png)).unwrap();
        let expected = [0x1234, 0x1235].map(|v| [v, v, v, u16::MAX]).to_vec();
        assert_eq!(image.pixels, Some(Pixels::Rgba16(expected)));
    }

    #[test]
    fn hdr_becomes_floats_beyond_one() {
        let hdr = image::ImageBuffer::from_fn(1, 1, |_, _| Rgb([4.0_f32, 0.5, 0.0]));
        let image = read_image("sky.hdr", &file(hdr, ImageFormat::Hdr)).unwrap();
        assert_eq!(
            image.pixels,
            Some(Pixels::RgbaF32(vec![[4.0, 0.5, 0.0, 1.0]]))
        );
    }

    #[test]
    fn what_is_no_image_is_named() {
        let error = read_image("notes.txt", b"hello").unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("notes.txt: is no image that can be read; images")
        );
        let error = read_image("a.gif", b"GIF89a").unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("a.gif: is Gif; images are read from PNG")
        );
        assert!(matches!(error, PictureError::Unsupported { .. }));
        assert!(read_image("", b"").is_err());
    }

    /// A PNG whose header claims a size and a depth of 8 or 16 bits; the checksum is right.
    fn png_of_size(width: u32, height: u32, bits: u8) -> Vec<u8> {
        let mut bytes = png_bytes(&raster(true)).unwrap();
        bytes[24] = bits;
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        let mut crc = u32::MAX;
        for &byte in &bytes[12..29] {
            crc ^= u32::from(byte);
            for _ in 0..8 {
                crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
            }
        }
        bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
        bytes
    }

    #[test]
    fn image_bombs_are_named() {
        let error = read_image("a.png", &png_of_size(65_537, 1, 8)).unwrap_err();
        assert!(
            error.to_string().contains("more than 65536 pixels"),
            "{error}"
        );
        let error = read_image("a.png", &png_of_size(65_536, 65_536, 8)).unwrap_err();
        assert!(error.to_string().contains("more than 2 GiB"), "{error}");
    }

    #[test]
    fn the_largest_texture_passes_the_limits() {
        // It fails for its missing pixels only.
        let error = read_image("a.png", &png_of_size(16_384, 16_384, 16)).unwrap_err();
        assert!(matches!(error, PictureError::Invalid { .. }), "{error}");
        let error = read_image("a.png", &png_of_size(16_384, 32_768, 16)).unwrap_err();
        assert!(matches!(error, PictureError::Unsupported { .. }), "{error}");
    }

    #[test]
    fn broken_images_are_errors() {
        let rgb = RgbImage::from_fn(9, 7, |x, y| Rgb([x as u8, y as u8, 200]));
        use ImageFormat::{Bmp, Hdr, Jpeg, Png, Tga, WebP};
        for format in [Png, Jpeg, Bmp, Tga, WebP, Hdr] {
            let whole = if format == Hdr {
                file(DynamicImage::from(rgb.clone()).into_rgb32f(), Hdr)
            } else {
                file(rgb.clone(), format)
            };
            for length in 0..whole.len() {
                // Some decoders make do with a few missing bytes; none may panic.
                let result = read_image("x.tga", &whole[..length]);
                assert!(
                    length > whole.len() / 2 || result.is_err(),
                    "{format:?} {length}"
                );
            }
            for position in 0..whole.len() {
                let mut broken = whole.clone();
                broken[position] ^= 0xff;
                if let Err(error) = read_image("x.tga", &broken) {
                    assert!(!error.to_string().contains('\n'));
                }
            }
        }
    }
}
