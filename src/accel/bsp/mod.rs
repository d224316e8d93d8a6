//! Trees of polygons split by planes, the lecture's "BSP Trees".

mod options;

pub use options::{BspOrder, BspQuality, BuildOptions};
