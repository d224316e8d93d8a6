//! Extents: shapes around objects that tell quickly which rays cannot hit them (the lecture's "Using Extents").

mod bounds;
mod cluster;
mod cost;
mod flat;
mod hull;
mod ray;
mod screen;
mod smallest;

pub use bounds::{BoxExtent, SphereExtent};
pub use cluster::PointCluster;
pub use cost::speed_ratio;
pub use ray::ExtentRay;
pub use screen::{ScreenExtent, View};
