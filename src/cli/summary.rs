//! What a render took, as a line, a table, and JSON.

use std::path::{Path, PathBuf};

use bspray::accel::{AcceleratorKind, BspQuality, BuildStats};
use bspray::analysis::Needs;
use bspray::geometry::TriangleTest;
use bspray::render::{Film, RenderOptions};
use bspray::scene::Scene;
use serde_json::{Value, json};

use super::needs_report;
use super::savings_args::{Detail, NoiseReport};

/// Wall-clock times.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seconds {
    pub(super) load: f64,
    pub(super) build: f64,
    pub(super) render: f64,
    /// From the beginning of loading to the first pixels.
    pub(super) first_pixel: f64,
}

/// Everything that is told about a render.
pub(super) struct RenderSummary<'a> {
    pub(super) args_models: &'a [PathBuf],
    pub(super) scene: &'a Scene,
    pub(super) accelerator: AcceleratorKind,
    /// With how much care its wide BSPs were built, if it has any.
    pub(super) bsp_quality: Option<BspQuality>,
    pub(super) triangle_test: TriangleTest,
    pub(super) build: BuildStats,
    /// What the picture used of its scene, if that was watched.
    pub(super) needs: Option<Needs>,
    pub(super) film: &'a Film,
    /// What was simplified, if anything was to be.
    pub(super) detail: Option<&'a Detail>,
    pub(super) options: &'a RenderOptions,
    pub(super) threads: usize,
    pub(super) seconds: Seconds,
    pub(super) camera_flags: &'a str,
    pub(super) outputs: Vec<&'a Path>,
}

impl RenderSummary<'_> {
    fn rays_per_second(&self) -> f64 {
        self.film.rays().total() as f64 / self.seconds.render.max(1e-9)
    }

    /// The name of its wide BSPs' quality, if it has any.
    pub(super) fn quality(&self) -> Option<&'static str> {
        self.bsp_quality.map(BspQuality::name)
    }

    /// Mean of a count over all rays.
    fn per_ray(&self, count: u64) -> f64 {
        count as f64 / self.film.rays().total().max(1) as f64
    }

    fn output_list(&self) -> String {
        self.outputs
            .iter()
            .map(|p| p.display().to_string())
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// One line.
    pub(super) fn line(&self) -> String {
        let Seconds {
            load,
            build,
            render,
            ..
        } = self.seconds;
        let partial = if self.film.is_complete {
            ""
        } else {
            "partial: "
        };
        format!(
            "{partial}{}: {}; load {load:.2} s, build {build:.2} s, render {render:.2} s",
            self.output_list(),
            super::render::describe(self.scene)
        )
    }

    /// What was asked of the noise, and what it took, if anything was.
    fn noise(&self) -> Option<NoiseReport> {
        let area = self.film.window.area();
        self.options.noise.map(|goal| NoiseReport {
            level: goal.level,
            mean_samples: self.film.samples() as f64 / area as f64,
            uniform_samples: area * u64::from(self.options.samples),
            unreached_pixels: self.film.open_pixels(),
        })
    }

    /// Rows of a name and a value.
    pub(super) fn table(&self) -> String {
        let (rays, cost) = (self.film.rays(), self.film.cost());
        let Seconds {
            load,
            build,
            render,
            first_pixel,
        } = self.seconds;
        let rows = [
            (
                "triangles placed",
                self.scene.placed_triangles().to_string(),
            ),
            ("triangles in structure", self.build.triangles.to_string()),
            ("accelerator", self.accelerator.to_string()),
            ("triangle test", self.triangle_test.to_string()),
            ("BSP quality", self.quality().unwrap_or("-").to_owned()),
            (
                "triangles reached",
                format!(
                    "{} ({:.1} %)",
                    self.build.triangles - self.build.unbuilt_triangles,
                    100.0 * self.build.built_share()
                ),
            ),
            (
                "tree nodes",
                format!("{} (depth {})", self.build.nodes, self.build.depth),
            ),
            ("structure bytes", self.build.bytes.to_string()),
            (
                "bytes a triangle",
                format!(
                    "{:.1}",
                    self.build.bytes as f64 / self.build.triangles.max(1) as f64
                ),
            ),
            ("threads", self.threads.to_string()),
            ("load seconds", format!("{load:.4}")),
            ("build seconds", format!("{build:.4}")),
            ("render seconds", format!("{render:.4}")),
            ("first pixel after", format!("{first_pixel:.4} seconds")),
            ("samples", self.film.samples().to_string()),
            ("eye rays", rays.eye.to_string()),
            ("shadow rays", rays.shadow.to_string()),
            ("ambient rays", rays.ambient.to_string()),
            ("reflection rays", rays.reflection.to_string()),
            ("refraction rays", rays.refraction.to_string()),
            ("diffuse rays", rays.diffuse.to_string()),
            ("rays a second", format!("{:.0}", self.rays_per_second())),
            ("nodes a ray", format!("{:.2}", self.per_ray(cost.nodes))),
            ("leaves a ray", format!("{:.2}", self.per_ray(cost.leaves))),
            (
                "triangle tests a ray",
                format!("{:.2}", self.per_ray(cost.primitives)),
            ),
        ];
        let detail = self.detail.map(Detail::rows);
        let noise = self.noise().map(|noise| noise.rows());
        let rows = (rows.iter())
            .chain(detail.iter().flatten())
            .chain(noise.iter().flatten())
            .map(|(name, value)| format!("{name:<24}{value}\n"));
        let needs = self.needs.iter().map(needs_report::table);
        rows.chain(needs.map(|table| format!("\n{table}")))
            .collect()
    }

    /// Samples that every pixel got, or the most where noise decides; of a picture that a signal ended, those that it should have got.
    pub(super) fn samples_per_pixel(&self) -> u64 {
        if self.film.is_complete {
            u64::from(self.film.most_samples())
        } else {
            u64::from(self.options.samples)
        }
    }

    /// The whole report.
    pub(super) fn value(&self) -> Value {
        let (rays, cost) = (self.film.rays(), self.film.cost());
        let window = self.film.window;
        json!({
            "program": "bspray",
            "version": env!("CARGO_PKG_VERSION"),
            // A path need not be UTF-8, JSON must.
            "models": self.args_models.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>(),
            "outputs": self.outputs.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>(),
            "complete": self.film.is_complete,
            "resolution": [self.film.size.0, self.film.size.1],
            "window": { "x": window.x, "y": window.y, "width": window.width, "height": window.height },
            "integrator": self.options.integrator.name(),
            "samples_per_pixel": self.samples_per_pixel(),
            "seed": self.options.seed,
            "threads": self.threads,
            "camera": self.camera_flags,
            "scene": {
                "meshes": self.scene.meshes.len(),
                "instances": self.scene.instances.len(),
                "materials": self.scene.materials.len(),
                "triangles_placed": self.scene.placed_triangles(),
                "notes": self.scene.notes.iter().map(ToString::to_string).collect::<Vec<_>>(),
                "defects": self.scene.defects.iter().map(ToString::to_string).collect::<Vec<_>>(),
            },
            "accelerator": {
                "kind": self.accelerator.name(),
                "bsp_quality": self.quality(),
                "triangle_test": self.triangle_test.name(),
                "triangles": self.build.triangles,
                "unbuilt_triangles": self.build.unbuilt_triangles,
                "built_share": self.build.built_share(),
                "nodes": self.build.nodes,
                "depth": self.build.depth,
                "bytes": self.build.bytes,
            },
            "noise": self.noise().map(|noise| noise.value()),
            "lod": self.detail.map(Detail::value),
            "seconds": {
                "load": self.seconds.load,
                "build": self.seconds.build,
                "render": self.seconds.render,
                "first_pixel": self.seconds.first_pixel,
            },
            "needs": self.needs.as_ref().map(needs_report::value),
            "samples": self.film.samples(),
            "rays": { "eye": rays.eye, "shadow": rays.shadow, "ambient": rays.ambient,
                "reflection": rays.reflection, "refraction": rays.refraction, "diffuse": rays.diffuse, "total": rays.total() },
            "rays_per_second": self.rays_per_second(),
            "steps": { "nodes": cost.nodes, "leaves": cost.leaves, "primitives": cost.primitives, "extents": cost.extents },
        })
    }
}
