//! Pictures of any format as named channels, with what their colours mean: for those who compare files.
//!
//! ```
//! use bspray::picture::{Encoding, Raster, ldr, read_picture};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("grey.png");
//! ldr::write(&path, &Raster::from_rgb(1, 1, &[[0.5; 3]]))?;
//! let (picture, encoding) = read_picture(&path)?;
//! assert_eq!(encoding, Encoding::Display);
//! assert!(picture.channel("R").is_some() && picture.channel("Z").is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::path::Path;

use super::exr::{is_exr, read as read_exr};
use super::{Channel, Picture, PictureError, Samples, ldr};
use crate::scene::Pixels;

/// What the numbers of a picture's colours are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Linear light, of any amount: EXR and HDR files.
    Linear,
    /// Codes for a display, encoded as sRGB, in [0, 1]: PNG, JPEG and all others.
    Display,
}

/// Reads a picture of any format that is read.
///
/// Of an EXR file it is all that [`read`](read_exr) gives. Others have the channels `R`, `G`, `B` and `A` (1 where the file has none), of the
/// numbers that the file holds: codes as shares of the largest one, so 255 of 8 bits and 65,535 of 16 are 1.
///
/// # Errors
/// As [`read`](read_exr) and [`read_image`](super::read_image).
pub fn read_picture(path: &Path) -> Result<(Picture, Encoding), PictureError> {
    use std::io::Read;
    let io = |error| PictureError::io(path, error);
    let mut start = Vec::new();
    let file = std::fs::File::open(path).map_err(io)?;
    file.take(4).read_to_end(&mut start).map_err(io)?;
    if is_exr(&start) {
        return Ok((read_exr(path)?, Encoding::Linear));
    }
    let bytes = std::fs::read(path).map_err(io)?;
    let image = ldr::read_image_if(&path.to_string_lossy(), &bytes, |_| Ok(()))?;
    let (values, encoding) = match image.pixels {
        Some(Pixels::Rgba8(codes)) => (shares(&codes, 255.0), Encoding::Display),
        Some(Pixels::Rgba16(codes)) => (shares(&codes, 65_535.0), Encoding::Display),
        Some(Pixels::RgbaF32(values)) => (planes(&values, |v| v), Encoding::Linear),
        None => return Err(PictureError::invalid(path, "has no pixels")),
    };
    let mut picture = Picture::new(image.width, image.height);
    for (name, plane) in ["R", "G", "B", "A"].into_iter().zip(values) {
        picture = picture.with_channel(Channel::new(name, Samples::F32(plane)));
    }
    Ok((picture, encoding))
}

/// Codes as shares of the largest one.
fn shares<T: Copy + Into<f32>>(pixels: &[[T; 4]], largest: f32) -> [Vec<f32>; 4] {
    planes(pixels, |code| code.into() / largest)
}

fn planes<T: Copy>(pixels: &[[T; 4]], value: impl Fn(T) -> f32) -> [Vec<f32>; 4] {
    std::array::from_fn(|c| pixels.iter().map(|pixel| value(pixel[c])).collect())
}

#[cfg(test)]
mod tests {
    use super::super::exr::write as write_exr;
    use super::super::{Raster, RasterPixels};
    use super::*;

    #[test]
    fn codes_become_shares_and_linear_files_keep_their_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let png = folder.path().join("a.png");
        let pixels = RasterPixels::Rgba(vec![[0, 51, 255, 102]]);
        let raster = Raster {
            width: 1,
            height: 1,
            pixels,
        };
        ldr::write(&png, &raster).unwrap();
        let (picture, encoding) = read_picture(&png).unwrap();
        assert_eq!(encoding, Encoding::Display);
        let values = ["R", "G", "B", "A"].map(|name| picture.channel(name).cloned());
        let expected = [0.0, 0.2, 1.0, 0.4].map(|v| Some(Samples::F32(vec![v])));
        assert_eq!(values, expected);

        // The name says nothing: files are told by their first bytes.
        let exr = folder.path().join("b.png");
        let written = Picture::new(1, 1).with_channel(Channel::new("Z", Samples::F16(vec![7.0])));
        write_exr(&folder.path().join("b.exr"), &written).unwrap();
        std::fs::rename(folder.path().join("b.exr"), &exr).unwrap();
        assert_eq!(read_picture(&exr).unwrap(), (written, Encoding::Linear));
    }

    #[test]
    fn what_is_no_picture_is_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let none = read_picture(&folder.path().join("none.exr")).unwrap_err();
        assert!(none.to_string().contains("none.exr: "), "{none}");
        let text = folder.path().join("text.png");
        std::fs::write(&text, "hello").unwrap();
        let error = read_picture(&text).unwrap_err().to_string();
        assert!(error.contains("text.png: "), "{error}");
        assert!(read_picture(folder.path()).is_err());
    }
}
