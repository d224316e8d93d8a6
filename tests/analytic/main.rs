//! Pictures whose values are known without rendering them.

mod coverage;
mod light;
mod motion;
mod paths;
#[path = "../support/scenes.rs"]
mod scenes;
mod setup;
