//! `bspray compare`: structures beside one another on the rays of one view.

use std::path::PathBuf;

use anyhow::{Context, bail};
use bspray::accel::AcceleratorKind;
use bspray::analysis::{CompareOptions, Comparison, Phase};
use clap::Args;

use super::bsp_args::BspArgs;
use super::camera_args::{self, CameraArgs};
use super::compare_report::CompareReport;
use super::extent_args::ExtentArgs;
use super::model_args::ModelArgs;
use super::{Done, UsageError, compare_page, files, output, render, values};

/// Arguments of `bspray compare`.
#[derive(Args, Debug)]
#[command(
    after_help = "Exit code 5 says that the first structure gave an answer that exact arithmetic \
    found to be wrong; the report is printed all the same."
)]
pub(super) struct CompareArgs {
    #[command(flatten)]
    input: ModelArgs,
    /// The structures, with commas between; the others are measured by the first [default: all but extents and linear]
    #[arg(long, value_name = "KIND,...", value_delimiter = ',', value_parser = values::accelerator,
        long_help = render::accelerator_help("The structures, with commas between; the others are measured by the first [default: all but extents and linear]"))]
    accel: Vec<AcceleratorKind>,
    #[command(flatten)]
    bsp: BspArgs,
    #[command(flatten)]
    extents: ExtentArgs,
    /// Width and height of the view, in pixels
    #[arg(long, value_name = "WxH", value_parser = values::resolution, default_value = "1280x720")]
    resolution: (u32, u32),
    /// Most rays of each kind; of a view with more pixels, tiles are chosen by chance
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u32).range(1..=values::MOST_RAYS))]
    rays: u32,
    /// How often each structure is timed on the same rays
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repetitions: u32,
    /// Changes every random number
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Threads that build and judge; 0 for one a core. Rays are timed on one thread
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads)]
    threads: usize,
    #[command(flatten)]
    camera: CameraArgs,
    /// Print one JSON object
    #[arg(long, help_heading = "Reports")]
    json: bool,
    /// Also write a page with tables and charts, report.html, and all numbers as CSV and JSON, into this folder
    #[arg(long, value_name = "FOLDER", help_heading = "Reports")]
    report: Option<PathBuf>,
    /// No progress and no notes
    #[arg(short, long, help_heading = "Reports")]
    quiet: bool,
}

/// Compares and tells.
pub(super) fn run(args: &CompareArgs) -> anyhow::Result<Done> {
    let mut options = options(args)?;
    if let Some(folder) = &args.report {
        files::check_folder(folder)?;
    }
    let scene = args.input.load()?;
    if !args.quiet {
        output::tell_of(&scene);
    }
    let camera = args.camera.choose(&scene, args.resolution)?;
    let view = camera_args::view(&camera, args.resolution, 0.0)?;
    options.build = args.extents.add_to(options.build, view);
    let camera_flags = camera_args::as_flags(&camera, &scene, args.camera.up());
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build()
        .context("cannot start threads")?;
    let watch = |phase: Phase| {
        if !args.quiet {
            output::message(&match phase {
                Phase::Build(kind) => format!("building {kind}"),
                Phase::Trace(purpose) => format!("tracing and judging {} rays", purpose.name()),
            });
        }
    };
    let comparison = pool.install(|| Comparison::of(&scene, &view.camera, &options, &watch));
    let report = CompareReport {
        models: &args.input.models,
        scene: &scene,
        camera_flags: &camera_flags,
        options: &options,
        threads: pool.current_num_threads(),
        comparison: &comparison,
    };
    if let Some(folder) = &args.report {
        compare_page::page(&report).write(folder)?;
        if !args.quiet {
            output::message(&format!("{}", folder.join("report.html").display()));
        }
    }
    output::result(&if args.json {
        report.json()
    } else {
        report.table()
    })?;
    Ok(verdict(&comparison))
}

fn options(args: &CompareArgs) -> anyhow::Result<CompareOptions> {
    let defaults = CompareOptions::default();
    for (index, kind) in args.accel.iter().enumerate() {
        if args.accel[..index].contains(kind) {
            bail!(UsageError(format!("--accel names {kind} twice")));
        }
    }
    let kinds = if args.accel.is_empty() {
        defaults.kinds
    } else {
        args.accel.clone()
    };
    args.extents.check(&kinds, false)?;
    Ok(CompareOptions {
        kinds,
        build: args.bsp.options(args.seed),
        size: args.resolution,
        most_rays: args.rays as usize,
        repetitions: args.repetitions as usize,
        seed: args.seed,
        up: args.camera.up(),
    })
}

fn verdict(comparison: &Comparison) -> Done {
    if comparison.is_first_right() {
        Done::Completely
    } else {
        Done::FirstIsWrong
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bspray::analysis::Fault;
    use bspray::render::{CameraWishes, frame_scene};
    use glam::Vec3;

    #[test]
    fn a_wrong_answer_of_the_first_structure_ends_with_5() {
        let scene = bspray::import::load(&["models/lecture-block.obj".into()]).unwrap();
        let camera = frame_scene(&scene, &CameraWishes::default(), Vec3::Y, 1.0);
        let options = CompareOptions {
            size: (8, 8),
            repetitions: 1,
            ..CompareOptions::default()
        };
        let frame = camera.frame(8, 8).unwrap();
        let mut comparison = Comparison::of(&scene, &frame, &options, &|_| ());
        assert_eq!(verdict(&comparison).code(), 0);
        comparison.sets[3].methods[1].faults.add(Fault::Ghost);
        assert_eq!(verdict(&comparison).code(), 0);
        comparison.sets[3].methods[0].faults.add(Fault::WrongName);
        assert_eq!(verdict(&comparison).code(), 5);
    }
}
