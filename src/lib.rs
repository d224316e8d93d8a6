//! **bspray** renders meshes that somebody else made, and proves what it shows.
//!
//! Data flows one way: a file becomes a [`scene::Scene`] by [`import`], an [`accel::Accelerator`] finds what rays hit in it,
//! [`render`] turns hits into a film of layers, and [`picture`] writes these as EXR, PNG or JPEG. Modules stand on floors: a file uses
//! its own floor or a lower one.
//!
//! | floor | modules |
//! |---|---|
//! | 1 | [`geometry`]: values and functions, exact predicates |
//! | 2 | [`scene`]: what a file describes; [`picture`]: files of pixels |
//! | 3 | [`import`] and [`accel`], which do not know each other |
//! | 4 | [`render`] |
//! | 5 | [`analysis`]: what is measured of accelerators and of pictures |
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//!
//! use bspray::accel::AcceleratorKind;
//! use bspray::render::{
//!     CameraWishes, Integrator, PixelFilter, PixelRect, RenderOptions, SkyMode, Stage, frame_scene, layers, render,
//! };
//! use glam::Vec3;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = bspray::import::load(&["models/lecture-block.obj".into()])?;
//! let accelerator = AcceleratorKind::default().build(&scene);
//! let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Auto);
//! let camera = frame_scene(&scene, &CameraWishes::default(), Vec3::Y, 1.0);
//! let frame = camera.frame(64, 64).ok_or("the camera sees nothing")?;
//! let options = RenderOptions {
//!     size: (64, 64),
//!     window: PixelRect { x: 0, y: 0, width: 64, height: 64 },
//!     samples: 4,
//!     noise: None,
//!     seed: 0,
//!     integrator: Integrator::Direct,
//!     filter: PixelFilter::Box,
//!     counts_cost: true,
//!     wants_layers: true,
//! };
//! let film = render(&stage, &frame, &options, &AtomicBool::new(false));
//! assert!(film.is_complete);
//! let picture = layers(&film, &frame);
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("block.exr");
//! bspray::picture::exr::write(&path, &picture)?;
//! # Ok(())
//! # }
//! ```
//!
//! # Vocabulary
//!
//! The field's words, as pbrt has them. Where the lecture that this project follows has another: its *generic* and *world* coordinates
//! are object and world space, its *recursion level* is a ray's depth (eye rays: 0), its *outside* and *inside* of a
//! face are front and back, its *projection extent* is a screen extent. `any_hit` is an occlusion query that stops at the first hit (in DXR
//! and obvhs that name visits all hits). `t` is in units of the ray direction's length.
#![cfg_attr(
    test,
    allow(
        clippy::float_cmp,
        reason = "tests compare values that are exact by construction"
    )
)]

pub mod accel;
pub mod analysis;
pub mod geometry;
pub mod import;
pub mod picture;
pub mod render;
pub mod scene;
