//! Speed against accuracy: what each method costs, and what it gets wrong for that.
//!
//! Two families of points. Methods on [rays](RayPoint): time of a ray against wrong answers and errors of depth, judged by exact arithmetic. Methods on
//! [pictures](PicturePoint): time to a picture against its distance from a converged one.

mod aimed;
mod coarse;
mod course;
mod method;
mod pictures;
mod rays;

pub use coarse::CoarseScene;
use course::Course;
pub use course::Doing;
pub use method::ChartMethod;
pub use pictures::{PicturePoint, PicturePoints};
pub use rays::{DepthError, RayPoint, RayPoints, Wrong};

use glam::Vec3;

use crate::accel::{BuildOptions, Embree, EmbreeError};
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
    /// Pixels by which meshes may be simplified, for further pictures with the first picture method.
    pub budgets: Vec<f32>,
    /// What else structures are built with.
    pub build: BuildOptions,
    /// For the methods that need it.
    pub embree: Option<Embree>,
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

/// All points.
#[derive(Clone, Debug, Default)]
pub struct ChartPoints {
    /// Methods on rays.
    pub rays: RayPoints,
    /// Methods on pictures.
    pub pictures: PicturePoints,
}

impl ChartPoints {
    /// Measures. `watch` hears what begins, and the share of the work that is done by then, as far as that can be told beforehand. Builds, judges and renders with the threads of the rayon pool in which it is called; rays are timed on one thread.
    ///
    /// # Errors
    /// If a foreign library cannot build its structure.
    ///
    /// # Panics
    /// If a method needs Embree and that is not there.
    pub fn of(
        scene: &Scene,
        options: &ChartOptions,
        watch: &(dyn Fn(Doing, f64) + Sync),
    ) -> Result<Self, EmbreeError> {
        let course = Course::new(options, watch);
        Ok(Self {
            rays: RayPoints::of(scene, options, &course)?,
            pictures: PicturePoints::of(scene, options, &course)?,
        })
    }

    /// Whether the reference was right wherever it was judged, and no exact method was wrong.
    pub fn is_right(&self) -> bool {
        let wrong =
            |p: &&RayPoint| p.method.is_exact() && p.view.rate.rate + p.edges.rate.rate > 0.0;
        self.rays.reference_wrong == 0 && self.rays.points.iter().find(wrong).is_none()
    }
}
