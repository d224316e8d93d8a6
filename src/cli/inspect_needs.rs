//! `bspray inspect --needs`: what the files hold against what a picture of them uses, found by a path-traced picture that is not kept.

use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use bspray::accel::{AcceleratorKind, BspQuality, BuildOptions, BuildTime};
use bspray::analysis::{MeshRepeats, Needs, Repeats, Watched};
use bspray::render::{
    self, Integrator, LightSearch, PixelFilter, PixelRect, RenderOptions, SkyMode, Stage,
};
use bspray::scene::Scene;
use clap::Args;
use serde_json::{Value, json};

use super::camera_args::{self, CameraArgs};
use super::{Done, needs_report, output, values};

/// Arguments for what a picture needs.
#[derive(Args, Debug)]
pub(super) struct InspectNeedsArgs {
    /// Tell what a picture of the models uses of them instead: triangles, meshes, materials, textures, bytes. It is path-traced as `render` does it, and thrown away
    #[arg(long, conflicts_with_all = ["bsp", "extent_table"])]
    pub(super) needs: bool,
    /// With --needs: samples a pixel
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=values::MOST_SAMPLES), requires = "needs")]
    spp: u32,
    /// With --needs: bounces of light
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=values::MOST_DEPTH), requires = "needs")]
    max_depth: u32,
}

/// Tells what a picture uses. Loading took so many seconds.
pub(super) fn run(
    mut scene: Scene,
    args: &InspectNeedsArgs,
    camera: &CameraArgs,
    size: (u32, u32),
    load: f64,
    as_json: bool,
) -> anyhow::Result<Done> {
    let chosen = camera.choose(&scene, size)?;
    let view = camera_args::view(&chosen, size, 0.0)?;
    let (width, height) = size;
    let options = RenderOptions {
        size,
        window: PixelRect {
            x: 0,
            y: 0,
            width,
            height,
        },
        samples: args.spp,
        seed: 0,
        integrator: Integrator::Path {
            max_depth: args.max_depth,
            search: LightSearch::Both,
        },
        filter: PixelFilter::BlackmanHarris,
        counts_cost: false,
        wants_layers: false,
        noise: None,
    };
    let shown = render::shown_detail(&scene, &[view.camera], &options);
    scene.keep_shown(&shown);
    let scene = &scene;
    let started = Instant::now();
    let build = BuildOptions {
        quality: BspQuality::Fast,
        time: BuildTime::Reached,
        ..BuildOptions::default()
    };
    let accelerator = AcceleratorKind::Bsp.build_with(scene, &build);
    let (watched, used) = Watched::new(accelerator, scene);
    let stage = Stage::new(scene, &watched, camera.up(), SkyMode::Auto);
    let build = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let film = render::render(&stage, &view.camera, &options, &AtomicBool::new(false));
    let seconds = started.elapsed().as_secs_f64();
    let stats = stage.accelerator.build_stats();
    let needs = Needs::of(scene, &used, &stage.textures, &stats);
    let repeats = Repeats::of(scene);
    let seen = film.map(|pixel| pixel.sum.alpha > 0.0);
    let report = Report {
        scene,
        needs: &needs,
        repeats: &repeats,
        camera: camera_args::as_flags(&chosen, scene, camera.up()),
        samples: film.samples(),
        rays: film.rays().total(),
        pixels: [seen.len(), seen.iter().filter(|seen| **seen).count()],
        seconds: [load, build, seconds],
    };
    output::result(&if as_json {
        format!("{:#}", report.value())
    } else {
        report.text()
    })?;
    Ok(Done::Completely)
}

struct Report<'a> {
    scene: &'a Scene,
    needs: &'a Needs,
    repeats: &'a Repeats,
    camera: String,
    samples: u64,
    rays: u64,
    /// All, and those in which there is something.
    pixels: [usize; 2],
    /// To load, build and render.
    seconds: [f64; 3],
}

impl Report<'_> {
    fn value(&self) -> Value {
        let [load, build, render] = self.seconds;
        let meshes = self.scene.meshes.iter().zip(&self.repeats.meshes);
        let meshes = meshes.zip(&self.needs.triangles_of_mesh);
        let meshes = meshes.map(|((mesh, repeats), used)| {
            json!({
                "name": mesh.name,
                "triangles": mesh.triangles.len(),
                "triangles_used": used,
                "vertices": mesh.positions.len(),
                "repeated_vertices": repeats.vertices,
                "unused_vertices": repeats.unused_vertices,
                "repeated_triangles": repeats.triangles,
                "same_as": repeats.same_as,
            })
        });
        json!({
            "camera": self.camera,
            "needs": needs_report::value(self.needs),
            "meshes": meshes.collect::<Vec<_>>(),
            "pixels": { "held": self.pixels[0], "used": self.pixels[1] },
            "samples": self.samples,
            "rays": self.rays,
            "seconds": { "load": load, "build": build, "render": render },
            "defects": self.scene.defects.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })
    }

    fn text(&self) -> String {
        let mut out = format!("camera: {}\n\n", self.camera);
        out += &needs_report::table(self.needs);
        let [pixels, seen] = self.pixels;
        let _ = writeln!(
            out,
            "{:<24}{pixels:>14}{seen:>14}{:>8}",
            "pixels",
            format!("{:.1} %", 100.0 * seen as f64 / pixels.max(1) as f64)
        );
        let [load, build, render] = self.seconds;
        let _ = write!(
            out,
            "\n{} samples, {} rays; structure {} bytes; load {load:.2} s, build {build:.2} s, render {render:.2} s\n\n",
            self.samples, self.rays, self.needs.structure_bytes
        );
        out += &needs_report::meshes(self.needs, self.scene);
        let sum = |of: fn(&MeshRepeats) -> u64| self.repeats.meshes.iter().map(of).sum::<u64>();
        let copies = sum(|m| u64::from(m.same_as.is_some()));
        let rows = [
            ("repeated vertices", sum(|m| m.vertices)),
            ("unused vertices", sum(|m| m.unused_vertices)),
            ("repeated triangles", sum(|m| m.triangles)),
            ("copies of meshes", copies),
            (
                "dropped triangles",
                self.scene.defects.iter().map(|d| d.count).sum(),
            ),
        ];
        out.push('\n');
        for (name, count) in rows {
            let _ = writeln!(out, "{name:<24}{count:>14}");
        }
        out
    }
}
