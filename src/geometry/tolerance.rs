//! Every epsilon of the crate, with its derivation, and no epsilon anywhere else.
//!
//! `u` is the unit roundoff of single precision, 2^-24: one rounded operation has a relative error of at most `u`.

/// Unit roundoff of `f32`: 2^-24.
pub const U32: f32 = f32::EPSILON / 2.0;

/// Unit roundoff of `f64`: 2^-53.
pub const U64: f64 = f64::EPSILON / 2.0;

/// Largest coordinate that an importer accepts, in model units.
///
/// Products of two coordinates stay below 1e36 and their sums below the largest `f32` (3.4e38), so that areas and edge
/// functions cannot overflow. A larger one drops its triangles as a defect.
pub const COORDINATE_LIMIT: f32 = 1e18;
