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

/// Largest relative difference between the area of a polygon and that of its triangles which counts as rounding.
///
/// Both are sums of n products of differences in `f64`, so that rounding stays below about 4 n * 2^-53 of the polygon's
/// extent squared: 5e-12 for ten thousand corners. A polygon that crosses itself is off by the share of its area that is
/// covered twice. Larger: such crossings pass unnoticed; smaller: thin polygons lose their ears and become fans.
pub const POLYGON_AREA_TOLERANCE: f64 = 1e-9;
