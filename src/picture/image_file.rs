//! Images of models, and environments, from any format that is read: OpenEXR through [`mod@exr`], all others through [`ldr`].
//!
//! ```
//! use bspray::picture::{Channel, Picture, Samples, exr, read_image};
//! use bspray::scene::Pixels;
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("grey.exr");
//! exr::write(&path, &Picture::new(1, 1).with_channel(Channel::new("Y", Samples::F16(vec![4.0]))))?;
//! let image = read_image("grey.exr", &std::fs::read(&path)?)?;
//! assert_eq!(image.pixels, Some(Pixels::RgbaF32(vec![[4.0, 4.0, 4.0, 1.0]])));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::path::Path;

use super::exr::{is_exr, read_bytes};
use super::{Channel, Picture, PictureError, Samples, ldr};
use crate::scene::{Image, Pixels};

/// What an infinite texel becomes: the largest 16-bit float, which no picture of a light exceeds that was stored as such.
pub const MOST_RADIANCE: f32 = 65_504.0;

/// Decodes an image. The format is told by the first bytes, and by `name`'s extension where these say nothing (TGA).
///
/// The numbers stay the file's: 8 bits stay 8, 16 stay 16, HDR and EXR become linear floats; grey is spread over the colours
/// and a missing alpha is 1. The image's name is `name`. Of an EXR the channels R, G, B and A count, or Y, or those of its first
/// layer that has them.
///
/// # Errors
/// `Unsupported` for another format and for images beyond [`ldr::MAX_SIDE`] or 2 GiB of pixels, `Invalid` for broken ones.
pub fn read_image(name: &str, bytes: &[u8]) -> Result<Image, PictureError> {
    read_image_if(name, bytes, |_| Ok(()))
}

/// Decodes an image of a model as [`read_image`] does, if `charge` agrees to the memory that it takes, in bytes. It is asked once
/// the size of the image is known, and before anything is allocated for its pixels.
///
/// # Errors
/// As [`read_image`], and `Unsupported` with what `charge` says.
pub fn read_image_if(
    name: &str,
    bytes: &[u8],
    charge: impl Fn(u64) -> Result<(), String>,
) -> Result<Image, PictureError> {
    if !is_exr(bytes) {
        return ldr::read_image_if(name, bytes, charge);
    }
    let picture = read_bytes(name, bytes, &charge)?;
    let (width, height) = (picture.window.width, picture.window.height);
    let pixels = picture.window.pixels().saturating_mul(16);
    charge(pixels).map_err(|cause| PictureError::unsupported(Path::new(name), cause))?;
    let pixels = colors(&picture).ok_or_else(|| {
        let cause = "has no channels R, G and B, nor Y";
        PictureError::unsupported(Path::new(name), cause)
    })?;
    Ok(Image {
        name: name.to_owned(),
        width,
        height,
        pixels: Some(Pixels::RgbaF32(pixels)),
        ..Image::default()
    })
}

/// Makes colours of texels that are none, and counts them: negative ones and NaN become 0, infinite ones [`MOST_RADIANCE`].
pub fn mend_texels(image: &mut Image) -> usize {
    let Some(Pixels::RgbaF32(pixels)) = &mut image.pixels else {
        return 0;
    };
    let is_sound = |v: f32| (0.0..=f32::MAX).contains(&v);
    let mut count = 0;
    for pixel in pixels
        .iter_mut()
        .filter(|p| !p.iter().all(|&v| is_sound(v)))
    {
        count += 1;
        // NaN is not greater than 0.
        *pixel = pixel.map(|v| match v {
            v if is_sound(v) => v,
            v if v > 0.0 => MOST_RADIANCE,
            _ => 0.0,
        });
    }
    count
}

/// The colour channels of a picture, of the file itself or else of the first layer that has them.
fn colors(picture: &Picture) -> Option<Vec<[f32; 4]>> {
    let layers = picture.channels.iter().map(|c| match c.name.rfind('.') {
        Some(dot) => &c.name[..=dot],
        None => "",
    });
    let mut prefixes: Vec<&str> = [""].into_iter().chain(layers).collect();
    prefixes.dedup();
    let find = |prefix: &str, name: &str| {
        let mut channels = picture.channels.iter();
        channels.find(|c| c.name.strip_prefix(prefix) == Some(name))
    };
    prefixes.into_iter().find_map(|prefix| {
        let rgb = ["R", "G", "B"].map(|name| find(prefix, name));
        let rgb = match rgb {
            [Some(r), Some(g), Some(b)] => [r, g, b],
            _ => [find(prefix, "Y")?; 3],
        };
        Some(interleaved(rgb, find(prefix, "A")))
    })
}

fn interleaved(rgb: [&Channel; 3], alpha: Option<&Channel>) -> Vec<[f32; 4]> {
    let value = |channel: &Channel, i: usize| match &channel.samples {
        Samples::F16(values) | Samples::F32(values) => values[i],
        Samples::U32(values) => values[i] as f32,
    };
    let count = match &rgb[0].samples {
        Samples::F16(values) | Samples::F32(values) => values.len(),
        Samples::U32(values) => values.len(),
    };
    let pixel = |i| {
        let [r, g, b] = rgb.map(|channel| value(channel, i));
        [r, g, b, alpha.map_or(1.0, |channel| value(channel, i))]
    };
    (0..count).map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::super::exr::write;
    use super::*;

    fn file(picture: &Picture) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write(&path, picture).unwrap();
        std::fs::read(path).unwrap()
    }

    fn channel(name: &str, values: [f32; 2]) -> Channel {
        Channel::new(name, Samples::F32(values.to_vec()))
    }

    #[test]
    fn exr_channels_become_pixels_and_layers_are_found() {
        for prefix in ["", "beauty."] {
            let name = |c: &str| format!("{prefix}{c}");
            let picture = Picture::new(2, 1)
                .with_channel(channel("Z", [7.0, 8.0]))
                .with_channel(channel(&name("R"), [1.0, 2.0]))
                .with_channel(channel(&name("G"), [3.0, 4.0]))
                .with_channel(channel(&name("B"), [5.0, 600.0]))
                .with_channel(channel(&name("A"), [0.5, 1.0]));
            let image = read_image("x", &file(&picture)).unwrap();
            assert_eq!((image.width, image.height), (2, 1));
            let expected = vec![[1.0, 3.0, 5.0, 0.5], [2.0, 4.0, 600.0, 1.0]];
            assert_eq!(image.pixels, Some(Pixels::RgbaF32(expected)));
        }
    }

    #[test]
    fn an_exr_without_colours_and_broken_ones_are_errors() {
        let bytes = file(&Picture::new(2, 1).with_channel(channel("Z", [7.0, 8.0])));
        let error = read_image("depth.exr", &bytes).unwrap_err().to_string();
        assert_eq!(error, "depth.exr: has no channels R, G and B, nor Y");
        for length in 4..bytes.len() {
            assert!(read_image("x.exr", &bytes[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn memory_is_asked_for_before_it_is_taken() {
        let bytes = file(&Picture::new(2, 1).with_channel(channel("Y", [7.0, 8.0])));
        let refuse = |bytes: u64| Err(format!("{bytes} bytes are too many"));
        let error = read_image_if("a.exr", &bytes, refuse).unwrap_err();
        assert!(
            error.to_string().ends_with("8 bytes are too many"),
            "{error}"
        );
    }

    #[test]
    fn texels_that_are_no_colours_are_mended_and_counted() {
        let pixels = vec![
            [0.5, 0.0, 1e6, 1.0],
            [f32::NAN, -0.5, f32::INFINITY, 1.0],
            [f32::NEG_INFINITY, 2.0, 3.0, f32::NAN],
        ];
        let mut image = Image {
            pixels: Some(Pixels::RgbaF32(pixels)),
            ..Image::default()
        };
        assert_eq!(mend_texels(&mut image), 2);
        let expected = vec![
            [0.5, 0.0, 1e6, 1.0],
            [0.0, 0.0, MOST_RADIANCE, 1.0],
            [0.0, 2.0, 3.0, 0.0],
        ];
        assert_eq!(image.pixels, Some(Pixels::RgbaF32(expected)));
        assert_eq!(mend_texels(&mut image), 0);
    }
}
