//! How two pictures differ: in each channel, and to the eye.
//!
//! The second picture of a pair is the reference, where a measure asks for one.
//!
//! ```
//! use bspray::analysis::images::{Diff, DiffOptions, Side, Verdict};
//! use bspray::picture::{Raster, ldr, read_picture};
//!
//! let folder = tempfile::tempdir()?;
//! let side = |name: &str, light: f32| -> Result<Side, bspray::picture::PictureError> {
//!     let path = folder.path().join(name);
//!     ldr::write(&path, &Raster::from_rgb(16, 12, &[[light; 3]; 192]))?;
//!     let (picture, encoding) = read_picture(&path)?;
//!     Ok(Side { picture, encoding })
//! };
//! let diff = Diff::of(&side("a.png", 0.2)?, &side("b.png", 0.21)?, &DiffOptions::default())?;
//! assert_eq!(diff.verdict, Verdict::Different);
//! let color = diff.color.ok_or("PNG files have colours")?;
//! assert!(color.flip > 0.01 && color.flip < 0.2 && color.ssim > Some(0.99));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod colors;
mod diff;
mod errors;
mod flip;
mod maps;
mod pair;
mod ssim;
mod thresholds;

pub use colors::Colors;
pub use diff::{ColorDiff, Diff, DiffOptions};
pub use errors::{ChannelErrors, ColorErrors, NonFinite, Worst};
pub use flip::{Exposures, PIXELS_PER_DEGREE, flip_hdr, flip_ldr};
pub use maps::{DifferenceScale, difference_layers, difference_raster, heat_map};
pub use pair::{Incomparable, Selection, Side};
pub use ssim::ssim;
pub use thresholds::{DEFAULT_THRESHOLD, Limits, Verdict};
