//! What the OBJ importer owes to materials and textures.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may panic, and compares values that are exact by construction"
)]

mod materials;
#[path = "../support/obj_files.rs"]
mod obj_files;
mod setup;
mod textures;
