//! Image files as the importers read them.

use crate::scene::{Image, Pixels};

/// Reads an image file's bytes.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<Image, String> {
    let decoded = image::load_from_memory(bytes).map_err(|e| e.to_string())?;
    let rgba = decoded.into_rgba8();
    Ok(Image {
        name: name.to_owned(),
        width: rgba.width(),
        height: rgba.height(),
        pixels: Some(Pixels::Rgba8(rgba.pixels().map(|p| p.0).collect())),
    })
}
