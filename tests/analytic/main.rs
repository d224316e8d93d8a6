//! Pictures whose values are known without rendering them.

mod coverage;
mod light;
#[path = "../support/scenes.rs"]
mod scenes;
mod setup;
