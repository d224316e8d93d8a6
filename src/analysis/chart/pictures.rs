//! Methods on pictures: how long one takes to a picture of so many samples, and how far that is from a converged one.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::Vec3;

use super::ChartOptions;
use super::coarse::CoarseScene;
use super::course::{Course, Doing};
use super::method::ChartMethod;
use crate::accel::EmbreeError;
use crate::analysis::Estimate;
use crate::analysis::images::{ColorErrors, Colors, PIXELS_PER_DEGREE, flip_hdr};
use crate::picture::Encoding;
use crate::render::{self, PixelFilter, PixelRect, RenderOptions, SkyMode, Stage};
use crate::scene::{DetailOptions, Scene};

/// The reference has as many samples a pixel for each of the most careful picture's: a quarter of the error's root is its own at most.
pub(super) const REFERENCE_SAMPLES: u32 = 16;

/// A picture as a point.
#[derive(Clone, Debug)]
pub struct PicturePoint {
    /// With what it was traced.
    pub method: ChartMethod,
    /// Pixels by which meshes were simplified, if they were.
    pub budget: Option<f32>,
    /// Samples a pixel.
    pub samples: u32,
    /// Wall-clock seconds of simplification, build and render, over the repetitions.
    pub seconds: Estimate,
    /// Root of the mean square difference to the reference, in linear light.
    pub rmse: f64,
    /// Mean of the square difference over the square of the reference (Rousselle et al. 2011).
    pub rel_mse: f64,
    /// Mean of HDR-FLIP.
    pub flip: f64,
}

/// All pictures.
#[derive(Clone, Debug, Default)]
pub struct PicturePoints {
    /// By method, and then by samples.
    pub points: Vec<PicturePoint>,
    /// Samples a pixel of the reference.
    pub reference_samples: u32,
    /// The reference, in linear light.
    pub reference: Vec<Vec3>,
    /// What simplifying by each budget leaves.
    pub coarse: Vec<CoarseScene>,
}

impl PicturePoint {
    /// The method's name, and the budget behind it.
    pub fn name(&self) -> String {
        match self.budget {
            Some(pixels) => format!("{}, lod {pixels}", self.method),
            None => self.method.name(),
        }
    }
}

impl PicturePoints {
    pub(super) fn of(
        scene: &Scene,
        options: &ChartOptions,
        course: &Course,
    ) -> Result<Self, EmbreeError> {
        let Some(&most) = options.samples.iter().max() else {
            return Ok(Self::default());
        };
        let reference_samples = most * REFERENCE_SAMPLES;
        let usual: ChartMethod = "bsp".parse().expect("the default structure is a method");
        course.begin(Doing::Converge(reference_samples));
        // Other random numbers than those of any picture.
        let seed = options.seed.wrapping_add(1);
        let (reference, _) = picture(scene, options, (&usual, None), reference_samples, seed)?;
        course.samples(reference_samples);
        let mut points = Vec::new();
        let whole = options.picture_methods.iter().map(|method| (method, None));
        let first = options.picture_methods.first();
        let coarse = options.budgets.iter().map(|&pixels| Some(pixels));
        let coarse = first
            .into_iter()
            .flat_map(|m| coarse.clone().map(move |b| (m, b)));
        for (method, budget) in whole.chain(coarse) {
            for &samples in &options.samples {
                course.begin(Doing::Picture(*method, samples));
                let (mut colors, mut seconds) = (Vec::new(), Vec::new());
                for _ in 0..options.repetitions.max(1) {
                    let found = picture(scene, options, (method, budget), samples, options.seed)?;
                    colors = found.0;
                    seconds.push(found.1);
                    course.samples(samples);
                }
                let Some(seconds) = Estimate::of(seconds, u64::from(options.seed)) else {
                    continue;
                };
                let [test, truth] = [&colors, &reference].map(|c| Colors {
                    width: options.size.0 as usize,
                    pixels: c.iter().map(Vec3::to_array).collect(),
                });
                let errors = ColorErrors::of(&test, &truth, Encoding::Linear);
                let (map, _) = flip_hdr(&test, &truth, PIXELS_PER_DEGREE, None);
                points.push(PicturePoint {
                    method: *method,
                    budget,
                    samples,
                    seconds,
                    rmse: errors.mse.sqrt(),
                    rel_mse: errors.rel_mse,
                    flip: map.iter().map(|&v| f64::from(v)).sum::<f64>() / map.len() as f64,
                });
            }
        }
        Ok(Self {
            points,
            reference_samples,
            reference,
            coarse: CoarseScene::of_budgets(scene, options),
        })
    }
}

/// Simplifies within a budget, if there is one, builds and renders: the colours, and the seconds that it took.
fn picture(
    scene: &Scene,
    options: &ChartOptions,
    (method, budget): (&ChartMethod, Option<f32>),
    samples: u32,
    seed: u32,
) -> Result<(Vec<Vec3>, f64), EmbreeError> {
    let (width, height) = options.size;
    let render = RenderOptions {
        size: options.size,
        window: PixelRect {
            x: 0,
            y: 0,
            width,
            height,
        },
        samples,
        noise: None,
        seed,
        integrator: options.integrator,
        filter: PixelFilter::BlackmanHarris,
        counts_cost: false,
        wants_layers: false,
    };
    // A copy, which is not timed: `render` simplifies what it has loaded.
    let copy = budget.map(|pixels| (scene.clone(), f64::from(pixels)));
    let started = Instant::now();
    let coarse = copy.map(|(scene, budget)| {
        let detail = DetailOptions {
            views: vec![options.camera],
            size: options.size,
            budget,
        };
        scene.simplified(&detail).0
    });
    let scene = coarse.as_ref().unwrap_or(scene);
    let accelerator = method.build(scene, &options.build, options.embree.as_ref())?;
    let stage = Stage::new(scene, &*accelerator, options.up, SkyMode::Auto);
    let film = render::render(&stage, &options.camera, &render, &AtomicBool::new(false));
    let seconds = started.elapsed().as_secs_f64();
    let colors = film.map(|pixel| {
        let mean = pixel.sum.mean();
        mean.color + mean.backdrop
    });
    Ok((colors, seconds))
}
