//! Values and functions of geometry: rays, boxes, triangles, and the predicates that decide about them.
//!
//! Positions are in model units. Nothing here knows of meshes, files or pictures.

pub mod exact;

mod aabb;
mod bounding_sphere;
mod facet;
mod interval;
mod nearest;
mod ray;
mod ray_frame;
pub mod tolerance;
mod triangle;
mod triangle_tests;

/// Values that loops work on at once which are compiled for several sets of instructions: as many `f32` as the widest vectors have.
pub const LANES: usize = 16;

pub use aabb::Aabb;
pub use bounding_sphere::BoundingSphere;
pub(crate) use facet::Facet;
pub use interval::Interval;
pub use ray::{Ray, RayOrigin};
pub use ray_frame::{RayFrame, Verdict};
pub(crate) use ray_frame::{is_beside, rounded};
pub use triangle::{Barycentric, Triangle};
pub use triangle_tests::TriangleTest;
pub(crate) use triangle_tests::{Double, Fast, TestedRay, Watertight, moller_trumbore};
