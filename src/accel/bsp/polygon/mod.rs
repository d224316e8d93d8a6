//! The lecture's BSP tree of polygons, exactly.
//!
//! "BSP Trees" and "3D BSP Trees" of the lecture. Each node is a plane with the polygons that lie in it; what is in front goes to one
//! subtree, what is behind to the other, and polygons that straddle the plane are split. Sides are decided without rounding: corners that arise by splitting are kept
//! as the planes that meet in them ([`Origin`]). An idea for the plane-based form of polygons: Bernstein and Fussell 2009, "Fast, Exact, Linear Booleans".
//!
//! # Where the lecture errs
//!
//! - It says of its block that "face #7 is the only one that must be split"; its own tree has 8a and 8b too: the plane of #3 splits both caps.
//! - It builds "a hierarchical data structure for each ray". The tree depends on the scene only, and serves all rays.
//! - It finds the nearest face "always moving to the left child". That holds only for one eye; a ray goes first into the side of each plane in which it starts,
//!   and a hit there ends the search only if it lies before the plane ([`PolygonBsp::front_to_back`] has the order for an eye).
//!
//! # How rays meet it
//!
//! Fragments only steer a ray, front to back, by its interval clipped at each plane with a derived margin. What is tested is the original
//! triangles, so that the answers are those of every other structure.
//!
//! # How people see it
//!
//! [`PolygonBsp::draw_tree`] and [`PolygonBsp::draw_regions`] make drawings of it, [`SceneTrees::locate`] finds the fragment that a ray hit, which the integrators
//! `fragment` and `bsp-depth` show.

mod build;
mod drawing;
mod fragment;
mod input;
mod order;
mod scene;
mod set;
mod split;
mod text;
mod tree;
mod validate;
mod visibility;
mod walk;

pub use build::BuildLimits;
pub use drawing::{Drawing, PlanFault};
pub use fragment::{Corner, Edge, Fragment, Loop, Origin, Polygon};
pub use order::{CANDIDATES, SAMPLE};
pub use scene::{Located, PlacedTree, SceneTree, SceneTrees};
pub use split::Placing;
pub use tree::{Node, PolygonBsp, TreeStats};
pub use validate::TreeFault;
pub use visibility::Seen;

pub(in crate::accel) use scene::outlines;
pub(in crate::accel) use set::PolygonSet;
