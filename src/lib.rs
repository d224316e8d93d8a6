//! **bspray** renders meshes that somebody else made, and proves what it shows.
#![cfg_attr(
    test,
    allow(
        clippy::float_cmp,
        reason = "tests compare values that are exact by construction"
    )
)]

pub mod accel;
pub mod geometry;
pub mod import;
pub mod picture;
pub mod render;
pub mod scene;
