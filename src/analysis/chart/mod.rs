//! Speed against accuracy: what each method costs, and what it gets wrong for that.
//!
//! Two families of points. Methods on [rays](RayPoint): time of a ray against wrong answers and errors of depth, judged by exact arithmetic. Methods on
//! [pictures](PicturePoint): time to a picture against its distance from a converged one.

mod aimed;
mod method;
mod pictures;
mod rays;

pub use method::ChartMethod;
pub use pictures::{PicturePoint, PicturePoints};
pub use rays::{DepthError, RayPoint, RayPoints, Wrong};

use glam::Vec3;

use crate::accel::BuildOptions;
use crate::render::Integrator;
use crate::scene::{CameraFrame, Scene};

/// What is measured, and how.
#[derive(Clone, Debug)]
pub struct ChartOptions {
    /// The methods whose rays are looked at; ratios are to the first.
    pub methods: Vec<ChartMethod>,
    /// The methods that pictures are made with.
    pub picture_methods: Vec<ChartMethod>,
    /// Samples a pixel of the pictures.
    pub samples: Vec<u32>,
    /// What else structures are built with.
    pub build: BuildOptions,
    /// The camera, for pictures of [`size`](Self::size).
    pub camera: CameraFrame,
    /// Width and height of the view, in pixels.
    pub size: (u32, u32),
    /// How the pictures' colours come about.
    pub integrator: Integrator,
    /// Most rays of each kind.
    pub most_rays: usize,
    /// How often each method is timed.
    pub repetitions: usize,
    /// Changes every random number.
    pub seed: u32,
    /// The scene's upward axis.
    pub up: Vec3,
}

/// What a chart is at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doing {
    /// Asks the reference, and judges it.
    Reference,
    /// Builds a method's structure.
    Build(ChartMethod),
    /// Times rays.
    Trace,
    /// Judges answers.
    Judge,
    /// Renders the reference with so many samples a pixel.
    Converge(u32),
    /// Renders a picture of so many samples a pixel.
    Picture(ChartMethod, u32),
}

/// All points.
#[derive(Clone, Debug, Default)]
pub struct ChartPoints {
    /// Methods on rays.
    pub rays: RayPoints,
    /// Methods on pictures.
    pub pictures: PicturePoints,
}

impl ChartPoints {
    /// Measures. Builds, judges and renders with the threads of the rayon pool in which it is called; rays are timed on one thread.
    pub fn of(scene: &Scene, options: &ChartOptions, watch: &(dyn Fn(Doing) + Sync)) -> Self {
        Self {
            rays: RayPoints::of(scene, options, watch),
            pictures: PicturePoints::of(scene, options, watch),
        }
    }

    /// Whether the reference was right wherever it was judged, and no exact method was wrong.
    pub fn is_right(&self) -> bool {
        let wrong =
            |p: &&RayPoint| p.method.is_exact() && p.view.rate.rate + p.edges.rate.rate > 0.0;
        self.rays.reference_wrong == 0 && self.rays.points.iter().find(wrong).is_none()
    }
}
