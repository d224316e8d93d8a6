//! What the OBJ importer owes: every trap that was found in `tobj` 4.0.5 or in files of other programs, one case each.
//!
//! Most cases are a text and what must come of it. The table says what `tobj` alone makes of each.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may panic, and compares values that are exact by construction"
)]

mod meshes;
#[path = "../support/obj_files.rs"]
mod obj_files;
mod polygons;
mod setup;
mod texts;
