//! The images that model files name or carry, decoded.

use crate::picture::{PictureError, read_image};
use crate::scene::Image;

/// Reads an image file's bytes. `name` is the image's name in the scene; its extension helps with formats that have no
/// mark of their own.
///
/// # Errors
/// What is wrong with the file, in one line without its name.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<Image, String> {
    let image = read_image(name, bytes).map_err(|e| match e {
        PictureError::Io { source, .. } => source.to_string(),
        PictureError::Unsupported { cause, .. } | PictureError::Invalid { cause, .. } => cause,
    })?;
    Ok(Image {
        name: name.to_owned(),
        ..image
    })
}
