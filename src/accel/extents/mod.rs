//! Extents: shapes around objects that tell quickly which rays cannot hit them (the lecture's "Using Extents").

mod cluster;
mod cost;
mod flat;
mod hull;
mod smallest;

pub use cluster::PointCluster;
pub use cost::speed_ratio;
