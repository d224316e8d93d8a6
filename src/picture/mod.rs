//! Pictures: layers of channels to and from EXR, colours to PNG and JPEG through a tone map, images of models to pixels.
//!
//! Rows go from the top, pixels from the left. Colours are linear RGB of Rec. 709 primaries until [`srgb`] encodes them.
//! No type of the crates `exr` and `image` leaves [`mod@exr`] and [`ldr`].
//!
//! ```
//! use bspray::picture::{Channel, Picture, Samples, exr};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("depth.exr");
//! let picture = Picture::new(2, 1)
//!     .with_channel(Channel::new("Z", Samples::F32(vec![1.5, f32::INFINITY])))
//!     .with_channel(Channel::new("id", Samples::U32(vec![7, u32::MAX])));
//! exr::write(&path, &picture)?;
//! assert_eq!(exr::read(&path)?, picture);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod any_file;
mod channel_names;
mod channels;
mod error;
pub mod exr;
pub mod glyphs;
mod header_order;
mod image_file;
pub mod ldr;
pub mod palette;
mod plausible;
mod raster;
mod replace_file;
mod safe_text;
pub mod srgb;
mod tonemap;

pub use any_file::{Encoding, read_picture};
pub use channels::{Attribute, Channel, Picture, Samples, Window, attribute};
pub use error::PictureError;
pub use image_file::{MOST_RADIANCE, mend_texels, read_image, read_image_if};
pub use raster::{Raster, RasterPixels};
pub use replace_file::replace_file;
pub use tonemap::{ToneMap, UnknownToneMap, exposure_factor};
