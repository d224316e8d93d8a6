//! Images in KTX 2.0 with Basis Universal data: KHR_texture_basisu. The only file that names the crate `basisu`.

use std::panic::{AssertUnwindSafe, catch_unwind};

use basisu::{DecodeFlags, Error, TargetFormat, Transcoder};

use crate::scene::{Image, Pixels};

/// The first bytes of a KTX 2.0 file.
const MARK: &[u8] = b"\xABKTX 20\xBB\r\n\x1A\n";

/// Most pixels of an image: 2^28, a gigabyte of them. Images of one colour take almost no room, so the file's size bounds nothing.
const MOST_PIXELS: u64 = 1 << 28;

/// Whether this is a KTX 2.0 file, of which other readers of images know nothing.
pub(super) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(MARK)
}

/// The largest level of an image.
///
/// # Errors
/// What is wrong with the file, in one line without its name.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<Image, String> {
    // The transcoder is young, and made for speed.
    catch_unwind(AssertUnwindSafe(|| read(name, bytes)))
        .unwrap_or_else(|_| Err("the transcoder failed on this data".to_owned()))
}

fn read(name: &str, bytes: &[u8]) -> Result<Image, String> {
    let wrong = |error| match error {
        Error::InvalidData => "is no KTX 2.0 file with Basis Universal data, or broken".to_owned(),
        Error::Truncated => "ends too early".to_owned(),
        Error::Unsupported { source, .. } => {
            format!("its data is {source:?}, which is not for glTF")
        }
        error => format!("{error:?}"),
    };
    let transcoder = Transcoder::new(bytes).map_err(wrong)?;
    let (width, height) = transcoder.base_dimensions();
    let pixels = u64::from(width) * u64::from(height);
    if !(1..=MOST_PIXELS).contains(&pixels) {
        return Err(format!(
            "has {width} x {height} pixels; at most {MOST_PIXELS} are read"
        ));
    }
    let rgba = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
    let rgba = rgba.map_err(wrong)?.as_chunks().0.to_vec();
    if rgba.len() as u64 != pixels {
        return Err(format!("gives {} of {pixels} pixels", rgba.len()));
    }
    Ok(Image {
        name: name.to_owned(),
        width,
        height,
        pixels: Some(Pixels::Rgba8(rgba)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_basis_texture_is_told() {
        assert!(is_ktx2(b"\xABKTX 20\xBB\r\n\x1A\n...") && !is_ktx2(b"\x89PNG"));
        let mut file = MARK.to_vec();
        for length in [12, 40, 80, 400] {
            file.resize(length, 0);
            assert!(decode("a.ktx2", &file).is_err(), "{length}");
            file[12..].fill(0xFF);
            assert!(decode("a.ktx2", &file).is_err(), "{length} of ones");
        }
    }
}
