//! What the OBJ importer owes to materials and textures.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may panic, and compares values that are exact by construction"
)]

mod materials;
mod setup;
mod textures;
