//! Images in KTX 2.0 with Basis Universal data: KHR_texture_basisu. The only file that names the crate `basisu`.
//!
//! The transcoder (0.1.0) allocates what a level claims to be, and a claim too large ends the process. So what the header says
//! is checked here first (KTX 2.0 specification, section 3; places are in bytes from the file's beginning).

use std::panic::{AssertUnwindSafe, catch_unwind};

use basisu::{DecodeFlags, Error, TargetFormat, Transcoder};

use crate::scene::{Image, Pixels};

/// The first bytes of a KTX 2.0 file.
const MARK: &[u8] = b"\xABKTX 20\xBB\r\n\x1A\n";

/// Most pixels of an image: 2^28, a gigabyte of them. Images of one colour take almost no room, so the file's size bounds nothing.
const MOST_PIXELS: u64 = 1 << 28;

/// Bytes of a pixel while it is decoded: as data, as the transcoder gives it, and in the image.
const PIXEL_BYTES: u64 = 10;

/// Bytes before the list of levels.
const HEADER_LENGTH: usize = 80;

/// Bytes of a level in the list: where it begins, its length, its length uncompressed.
const LEVEL_LENGTH: usize = 24;

/// The two kinds of data that glTF allows, ETC1S and UASTC, as the data format descriptor numbers them.
const COLOR_MODELS: [u8; 2] = [163, 166];

/// Whether this is a KTX 2.0 file, of which other readers of images know nothing.
pub(super) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(MARK)
}

/// The largest level of an image.
///
/// `charge` is asked for its bytes before.
///
/// # Errors
/// What is wrong with the file, in one line without its name.
pub(super) fn decode(
    name: &str,
    bytes: &[u8],
    charge: impl Fn(u64) -> Result<(), String>,
) -> Result<Image, String> {
    let pixels = check_header(bytes)?;
    charge(pixels * PIXEL_BYTES)?;
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
        ..Image::default()
    })
}

/// Refuses what glTF does not allow, and levels larger than the picture. Gives the number of pixels.
fn check_header(bytes: &[u8]) -> Result<u64, String> {
    let word = |at: usize| {
        let word = bytes.get(at..)?.first_chunk::<4>()?;
        Some(u64::from(u32::from_le_bytes(*word)))
    };
    let long = |at: usize| Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk::<8>()?));
    let cut = || "ends too early".to_owned();
    let read = |at| word(at).ok_or_else(cut);
    let (width, height) = (read(20)?, read(24)?);
    let pixels = width * height;
    if !(1..=MOST_PIXELS).contains(&pixels) {
        return Err(format!(
            "has {width} x {height} pixels; at most {MOST_PIXELS} are read"
        ));
    }
    let (depth, layers, faces) = (read(28)?, read(32)?, read(36)?);
    if depth > 1 || layers > 1 || faces != 1 {
        return Err("is a volume, an array or a cube; glTF has pictures".to_owned());
    }
    let model_at = usize::try_from(read(48)?)
        .ok()
        .and_then(|at| at.checked_add(12));
    let model = model_at.and_then(|at| bytes.get(at));
    if !model.is_some_and(|m| COLOR_MODELS.contains(m)) || read(44)? > 2 {
        return Err("its data is neither ETC1S nor UASTC, which glTF has".to_owned());
    }
    // UASTC has 16 bytes for 4 x 4 pixels; ETC1S has no such size.
    let most = width.div_ceil(4) * height.div_ceil(4) * 16;
    for level in 0..read(40)?.clamp(1, 32) as usize {
        let claimed = long(HEADER_LENGTH + level * LEVEL_LENGTH + 16).ok_or_else(cut)?;
        if claimed > most {
            return Err(format!(
                "level {level} claims {claimed} bytes, of which {width} x {height} pixels need {most}"
            ));
        }
    }
    Ok(pixels)
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
            assert!(decode("a.ktx2", &file, |_| Ok(())).is_err(), "{length}");
            file[12..].fill(0xFF);
            assert!(
                decode("a.ktx2", &file, |_| Ok(())).is_err(),
                "{length} of ones"
            );
        }
    }

    #[test]
    fn claims_of_levels_are_bounded_by_the_picture() {
        let mut file = MARK.to_vec();
        file.resize(HEADER_LENGTH + LEVEL_LENGTH + 16, 0);
        // 8 x 5 pixels, one face, one level, its descriptor behind the list.
        for (at, value) in [(20, 8), (24, 5), (36, 1), (40, 1), (48, 104), (116, 166)] {
            file[at] = value;
        }
        file[96] = 64;
        assert_eq!(check_header(&file), Ok(40));
        file[96] = 65;
        let error = check_header(&file).expect_err("too large");
        assert_eq!(
            error,
            "level 0 claims 65 bytes, of which 8 x 5 pixels need 64"
        );
        file[96] = 64;
        for (at, words) in [
            (27, "at most"),
            (28, "a volume"),
            (36, "a cube"),
            (44, "neither"),
            (116, "neither"),
            (40, "too early"),
        ] {
            let mut broken = file.clone();
            broken[at] = 3;
            let error = check_header(&broken).expect_err(words);
            assert!(error.contains(words), "{at}: {error}");
        }
    }
}
