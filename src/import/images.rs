//! The images that model files name or carry, decoded, and what stands in for those that cannot be had.

use glam::Vec4;

use crate::picture::{PictureError, mend_texels, read_image_if};
use crate::scene::{Filter, Image, Material, Pixels, Texture, TextureRef};

/// Squares of the stand-in along each side.
const STAND_IN_SQUARES: u32 = 8;

/// Reads an image file's bytes. `name` is the image's name in the scene; its extension helps with formats that have no
/// mark of their own.
///
/// `charge` is asked for the image's bytes before it is decoded.
///
/// # Errors
/// What is wrong with the file, in one line without its name.
pub(super) fn decode(
    name: &str,
    bytes: &[u8],
    charge: impl Fn(u64) -> Result<(), String>,
) -> Result<Image, String> {
    let image = read_image_if(name, bytes, charge).map_err(|e| match e {
        PictureError::Io { source, .. } => source.to_string(),
        PictureError::Unsupported { cause, .. } | PictureError::Invalid { cause, .. } => cause,
    })?;
    Ok(Image {
        name: name.to_owned(),
        ..image
    })
}

/// Mends texels that are no colours, as [`mend_texels`] does, and says so.
pub(super) fn mend(image: &mut Image) -> Option<String> {
    match mend_texels(image) {
        0 => None,
        count => Some(format!(
            "{count} texels are negative, infinite or no numbers: taken as 0, or as {MOST} where they are infinite",
            MOST = crate::picture::MOST_RADIANCE,
        )),
    }
}

/// What is to be said of a material for which [`show_stand_in`] was called.
pub(super) const STAND_IN_NOTE: &str =
    "the image of its colour is left out: a magenta checker stands in for it";

/// Adds the stand-in to a scene's images and textures. Gives the number of its texture.
pub(super) fn add_stand_in(images: &mut Vec<Image>, textures: &mut Vec<Texture>) -> u32 {
    let image = images.len() as u32;
    images.push(stand_in());
    textures.push(Texture {
        image,
        filter: Filter::Nearest,
        ..Texture::default()
    });
    textures.len() as u32 - 1
}

/// Gives a material the texture of the stand-in for its colour, undimmed, so that it is seen. Its alpha stays.
pub(super) fn show_stand_in(material: &mut Material, texture: u32, uv_set: u32) {
    material.base_color = Vec4::ONE.with_w(material.base_color.w);
    material.base_color_texture = Some(TextureRef {
        texture,
        uv_set,
        ..TextureRef::default()
    });
}

/// A magenta checker, for images of colours that cannot be had.
fn stand_in() -> Image {
    let side = STAND_IN_SQUARES;
    let square = |i: u32| match (i % side + i / side) % 2 {
        0 => [255, 0, 255, 255],
        _ => [60, 0, 60, 255],
    };
    Image {
        name: "stand-in".to_owned(),
        width: side,
        height: side,
        pixels: Some(Pixels::Rgba8((0..side * side).map(square).collect())),
        ..Image::default()
    }
}
