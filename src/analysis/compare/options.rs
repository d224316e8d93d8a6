//! What is compared, and how.

use glam::Vec3;

use super::contestant::Contestant;
use crate::accel::{AcceleratorKind, BuildOptions};
use crate::analysis::memory::MemoryMeter;
use crate::analysis::view_rays::RaySet;

/// Rays under a name.
#[derive(Clone, Debug)]
pub struct NamedRays {
    /// What they are called in reports and names of files.
    pub name: String,
    /// The rays.
    pub set: RaySet,
}

/// What is compared, and how.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// The methods; the first is the one that the others are measured by.
    pub contestants: Vec<Contestant>,
    /// How they are built.
    pub build: BuildOptions,
    /// Rays to ask; without any, those of the view.
    pub rays: Vec<NamedRays>,
    /// Width and height of the view, in pixels.
    pub size: (u32, u32),
    /// Most rays of each purpose that a view gives.
    pub most_rays: usize,
    /// How often each method is timed.
    pub repetitions: usize,
    /// Whether the cost of every pixel of the view is looked at too.
    pub draws_costs: bool,
    /// Counts the memory that builds take.
    pub memory: Option<MemoryMeter>,
    /// Changes every random number.
    pub seed: u32,
    /// The scene's upward axis.
    pub up: Vec3,
}

impl Default for CompareOptions {
    /// All kinds but brute force, on the rays of a small picture.
    fn default() -> Self {
        let all = AcceleratorKind::ALL.into_iter();
        Self {
            contestants: all
                .filter(|k| !matches!(k, AcceleratorKind::Linear))
                .map(Contestant::structure)
                .collect(),
            build: BuildOptions::default(),
            rays: Vec::new(),
            size: (1280, 720),
            most_rays: 200_000,
            repetitions: 9,
            draws_costs: false,
            memory: None,
            seed: 0,
            up: Vec3::Y,
        }
    }
}
