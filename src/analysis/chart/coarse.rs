//! Meshes simplified by pixels: what is left of them, and how far away what is seen is from where it was.

use rayon::prelude::*;

use super::ChartOptions;
use super::rays::DepthError;
use crate::accel::{Accelerator, AcceleratorKind};
use crate::scene::{DetailOptions, DetailReport, Scene};

/// A scene whose meshes were simplified, against the one that it stands for, as the rays through the pixels' middles see both.
#[derive(Clone, Debug)]
pub struct CoarseScene {
    /// Pixels by which meshes were simplified.
    pub budget: f32,
    /// What became of the triangles.
    pub detail: DetailReport,
    /// How far depths are from those of the whole scene, in shares of these, where both have one.
    pub depth: DepthError,
    /// Pixels that have a depth in both.
    pub in_both: u64,
    /// Pixels that have one in either alone: at outlines.
    pub in_one: u64,
}

impl CoarseScene {
    /// One for each budget.
    pub(super) fn of_budgets(scene: &Scene, options: &ChartOptions) -> Vec<Self> {
        if options.budgets.is_empty() {
            return Vec::new();
        }
        let depths = |scene: &Scene| depths(&*AcceleratorKind::Bsp.build(scene), options);
        let whole = depths(scene);
        let budgets = options.budgets.iter();
        let of = |&budget: &f32| {
            let coarse = scene.clone().simplified(&DetailOptions {
                views: vec![options.camera],
                size: options.size,
                budget: f64::from(budget),
            });
            let mut found = Self {
                budget,
                detail: coarse.1,
                depth: DepthError::default(),
                in_both: 0,
                in_one: 0,
            };
            found.compare(&whole, &depths(&coarse.0));
            found
        };
        budgets.map(of).collect()
    }

    fn compare(&mut self, whole: &[Option<f32>], coarse: &[Option<f32>]) {
        let mut squares = 0.0;
        for pair in whole.iter().zip(coarse) {
            match pair {
                (Some(whole), Some(coarse)) => {
                    let [whole, coarse] = [whole, coarse].map(|t| f64::from(*t));
                    let error = (coarse - whole).abs() / whole;
                    squares += error * error;
                    self.depth.greatest = self.depth.greatest.max(error);
                    self.in_both += 1;
                }
                (None, None) => {}
                _ => self.in_one += 1,
            }
        }
        self.depth.rms = (squares / self.in_both.max(1) as f64).sqrt();
    }
}

/// The distance that each pixel's middle sees, row by row.
fn depths(accelerator: &dyn Accelerator, options: &ChartOptions) -> Vec<Option<f32>> {
    let (width, height) = options.size;
    let pixels = (0..height).into_par_iter();
    let row = |y: u32| {
        (0..width).map(move |x| {
            let ray = options
                .camera
                .ray(f64::from(x) + 0.5, f64::from(y) + 0.5, None);
            accelerator.closest_hit(&ray).map(|hit| hit.t)
        })
    };
    pixels.flat_map_iter(row).collect()
}
