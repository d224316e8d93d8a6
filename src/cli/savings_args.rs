//! Arguments that say what may be left out because the picture cannot show it.

use std::time::Instant;

use anyhow::bail;
use bspray::render::{Integrator, LAYERS};
use bspray::scene::{CameraFrame, DetailOptions, DetailReport, Scene};
use clap::Args;
use serde_json::{Value, json};

use super::{UsageError, output, values};

/// What a render may save. Every saving that is on by default changes a picture by less than its noise.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Savings")]
pub(super) struct SavingsArgs {
    /// Save nothing: all that is on by default is off
    #[arg(long)]
    pub(super) exhaustive: bool,
    /// Simplify meshes as far as no vertex is more than PIXELS from the surface that stands for it, where eye rays, mirrors and shadows show it.
    /// Layers of .exr files that tell of triangles are left out
    #[arg(long, value_name = "PIXELS", value_parser = values::positive, conflicts_with_all = ["pixel", "bsp_layers"])]
    pub(super) lod: Option<f32>,
    /// Give pixels no more samples once these gain little: when the standard error over the light (after --exposure, as in relMSE) is LEVEL at 256 samples, and the root of their number
    /// otherwise; such as 0.05. --spp is the most
    #[arg(long, value_name = "LEVEL", value_parser = values::positive, conflicts_with = "pixel")]
    pub(super) noise: Option<f32>,
}

/// What was simplified.
pub(super) struct Detail {
    budget: f32,
    report: DetailReport,
    seconds: f64,
}

impl SavingsArgs {
    /// Refuses pictures of the structure of meshes that would be other ones.
    ///
    /// # Errors
    /// `--lod` beside such an integrator.
    pub(super) fn check(&self, integrator: Integrator) -> anyhow::Result<()> {
        let shows_structure = integrator.shows_trees() || integrator == Integrator::Cost;
        if self.lod.is_some() && shows_structure {
            let name = integrator.name();
            bail!(UsageError(format!(
                "--lod: --integrator {name} shows what is built over the meshes: it would show that of simplified ones"
            )));
        }
        Ok(())
    }

    /// The scene as coarse as pictures from these places allow, if that is wanted, and what became of it.
    pub(super) fn simplify(
        &self,
        scene: Scene,
        views: Vec<CameraFrame>,
        size: (u32, u32),
    ) -> (Scene, Option<Detail>) {
        let Some(budget) = self.lod else {
            return (scene, None);
        };
        let started = Instant::now();
        let options = DetailOptions {
            views,
            size,
            budget: f64::from(budget),
        };
        let (scene, report) = scene.simplified(&options);
        let seconds = started.elapsed().as_secs_f64();
        let detail = Detail {
            budget,
            report,
            seconds,
        };
        (scene, Some(detail))
    }
}

impl Detail {
    /// In a line, with the layers that are left out of files.
    pub(super) fn tell(&self, has_layers: bool) {
        let (before, after) = (self.report.triangles(), self.report.kept());
        let error = self.report.error();
        output::message(&format!(
            "lod: {after} of {before} triangles kept, error {error:.3} pixels at most, {:.2} s",
            self.seconds
        ));
        if has_layers {
            let layers = LAYERS.iter().filter(|layer| layer.is_of_triangles);
            let names: Vec<_> = layers.map(|layer| layer.name).collect();
            output::message(&format!(
                "lod: .exr files are without layers that tell of triangles: {}, and motion",
                names.join(", ")
            ));
        }
    }

    /// Rows of a name and a value.
    pub(super) fn rows(&self) -> Vec<(&'static str, String)> {
        vec![
            ("lod budget, pixels", self.budget.to_string()),
            ("lod error, pixels", format!("{:.4}", self.report.error())),
            ("lod triangles before", self.report.triangles().to_string()),
            ("lod levels made", self.report.levels.to_string()),
            ("lod seconds", format!("{:.4}", self.seconds)),
        ]
    }

    /// The whole report.
    pub(super) fn value(&self) -> Value {
        let instances =
            self.report.instances.iter().map(
                |i| json!({ "triangles": i.triangles, "kept": i.kept, "error_pixels": i.error }),
            );
        json!({
            "budget_pixels": self.budget,
            "error_pixels": self.report.error(),
            "triangles": self.report.triangles(),
            "kept": self.report.kept(),
            "levels": self.report.levels,
            "seconds": self.seconds,
            "instances": instances.collect::<Vec<_>>(),
        })
    }
}

/// What was asked of the noise, and what it took.
pub(super) struct NoiseReport {
    pub(super) level: f32,
    /// Of a pixel.
    pub(super) mean_samples: f64,
    /// What as many samples everywhere as the noisiest pixels may have would have been.
    pub(super) uniform_samples: u64,
    /// Pixels that are noisier, or may be.
    pub(super) unreached_pixels: u64,
}

impl NoiseReport {
    /// Rows of a name and a value.
    pub(super) fn rows(&self) -> Vec<(&'static str, String)> {
        vec![
            ("noise level", self.level.to_string()),
            ("mean samples a pixel", format!("{:.2}", self.mean_samples)),
            ("uniform samples", self.uniform_samples.to_string()),
            ("pixels above the level", self.unreached_pixels.to_string()),
        ]
    }

    /// The whole report.
    pub(super) fn value(&self) -> Value {
        json!({
            "level": self.level,
            "mean_samples_per_pixel": self.mean_samples,
            "uniform_samples": self.uniform_samples,
            "unreached_pixels": self.unreached_pixels,
        })
    }
}
