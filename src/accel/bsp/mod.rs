//! Trees of polygons split by planes, the lecture's "BSP Trees".

mod options;
pub mod polygon;
pub(super) mod wide;

pub use options::{BspAxes, BspInstructions, BspOrder, BspQuality, BuildOptions, BuildTime};
