//! Extents: shapes around objects that tell quickly which rays cannot hit them (the lecture's "Using Extents").
//!
//! Five tests can be had, each alone or with others ([`ExtentTest`]), in the lecture's order: the pixel of an eye ray against the [`ScreenExtent`], the ray against a
//! sphere and a box in world space, and the inverse-transformed ray against a sphere and a box in object space. All of them follow from the object's [`PointCluster`].
//! None changes an answer: they are conservative. [`ExtentsLoop`] is the lecture's loop over all objects with them; [`ObjectStudy`] tells what each combination costs.

mod bounds;
mod choice;
mod cluster;
mod cost;
mod entry;
mod flat;
mod hull;
mod object;
mod probe;
mod projection;
mod ray;
mod screen;
mod set;
mod smallest;
mod study;
mod tally;
mod trace;
mod viewed;

pub use bounds::{BoxExtent, SphereExtent};
pub use choice::{ExtentChoice, ExtentSet, ExtentSphere, ExtentTest, MeshAccelerator};
pub use cluster::PointCluster;
pub use cost::{CostTable, speed_ratio};
pub use entry::ExtentObject;
pub use object::{ExtentShapes, ObjectExtents, WorldRay};
pub use projection::projected_area;
pub use ray::ExtentRay;
pub use screen::{ScreenExtent, View};
pub use study::ObjectStudy;
pub use tally::{ExtentTally, ObjectTally, TestTally};
pub use trace::ExtentsLoop;
pub use viewed::viewed_extents;
