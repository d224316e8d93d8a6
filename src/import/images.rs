//! The images that model files name or carry, decoded.

use crate::scene::{Image, Pixels};

/// Reads an image file's bytes; the format is told by its first bytes. `name` is the image's name in the scene.
///
/// # Errors
/// What is wrong with the file, in one line without its name.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<Image, String> {
    let decoded = image::load_from_memory(bytes).map_err(|e| e.to_string())?;
    let (width, height) = (decoded.width(), decoded.height());
    let pixels = Pixels::Rgba8(decoded.into_rgba8().pixels().map(|p| p.0).collect());
    Ok(Image {
        name: name.to_owned(),
        width,
        height,
        pixels: Some(pixels),
    })
}
