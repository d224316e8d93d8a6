//! `bspray compare`: structures beside one another on the same rays, those of one view or those that a user brings.

mod contestants;
mod page;
mod page_tables;
mod profile;
mod ray_files;
mod replay;
mod report;
mod table;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use bspray::accel::{AcceleratorKind, Embree};
use bspray::analysis::{
    CompareOptions, Comparison, Contestant, NamedRays, Phase, Work, rays_of_view, write_rays,
};
use bspray::picture::exr::write as write_exr;
use bspray::scene::Scene;
use clap::Args;

use self::contestants::ContestantArgs;
use self::profile::ProfileArgs;
use self::report::CompareReport;
use super::bsp_args::BspArgs;
use super::camera_args::{self, CameraArgs};
use super::extent_args::ExtentArgs;
use super::model_args::ModelArgs;
use super::work_bar::WorkBar;
use super::{Done, UsageError, files, memory, output, values};

/// Most pixels whose costs are counted: some hundred bytes each.
const MOST_COST_PIXELS: u64 = 1 << 24;

/// Arguments of `bspray compare`.
#[derive(Args, Debug)]
#[command(
    after_help = "Exit code 5 says that the first structure gave an answer that exact arithmetic \
    found to be wrong; the report is printed all the same.\n\nFiles of rays (little-endian): BRAY, u32 version 1, u32 count, u32 kind \
    (0 eye, 1 shadow, 2 ambient occlusion, 3 bounce, 4 mirror, 5 refraction), then 8 f32 a ray: origin, direction, least and greatest t (1e30: no end)."
)]
pub(super) struct CompareArgs {
    #[command(flatten)]
    input: ModelArgs,
    #[command(flatten)]
    contestants: ContestantArgs,
    #[command(flatten)]
    bsp: BspArgs,
    #[command(flatten)]
    extents: ExtentArgs,
    #[command(flatten)]
    profile: ProfileArgs,
    /// Changes every random number
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Threads that build and judge; 0 for one a core. Rays are timed on one thread
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads)]
    threads: usize,
    #[command(flatten)]
    camera: CameraArgs,
    /// Ask the rays of a file instead of those of the view; may be given several times
    #[arg(long, value_name = "FILE", help_heading = "Rays")]
    rays: Vec<PathBuf>,
    /// Also write the rays of each kind into this folder, such as eye.ray
    #[arg(
        long,
        value_name = "FOLDER",
        help_heading = "Rays",
        conflicts_with = "rays"
    )]
    write_rays: Option<PathBuf>,
    /// Measure nothing: print what each structure and exact arithmetic say of each ray of a file
    #[arg(long, value_name = "FILE", help_heading = "Rays",
        conflicts_with_all = ["rays", "write_rays", "exr", "report", "quick", "thorough", "max_rays", "repetitions", "resolution"])]
    replay: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long, help_heading = "Reports")]
    json: bool,
    /// Also write a page with tables, charts and pictures, report.html, all numbers as CSV and JSON, and wrong rays for --replay, into this folder
    #[arg(long, value_name = "FOLDER", help_heading = "Reports")]
    report: Option<PathBuf>,
    /// Also write what each structure spends on each pixel of the view, the differences, and where answers disagree, as layers (EXR)
    #[arg(long, value_name = "FILE", help_heading = "Reports")]
    exr: Option<PathBuf>,
    /// No progress and no notes
    #[arg(short, long, help_heading = "Reports")]
    quiet: bool,
}

/// Compares and tells.
pub(super) fn run(args: &CompareArgs) -> anyhow::Result<Done> {
    check(args)?;
    let embree = args.contestants.embree(args.threads)?;
    let paths: Vec<PathBuf> = args.rays.iter().chain(&args.replay).cloned().collect();
    let rays = ray_files::read(&paths)?;
    let scene = args.input.load()?;
    files::spare_inputs(args.exr.iter().map(PathBuf::as_path), &scene)?;
    ray_files::check(&paths, &rays, &scene)?;
    if !args.quiet {
        output::tell_of(&scene);
    }
    let size = args.profile.profile().size;
    let camera = args.camera.choose(&scene, size)?;
    let view = camera_args::view(&camera, size, 0.0)?;
    let (mut options, left_out) = options(args, &scene, rays, embree.as_ref())?;
    options.build = args.extents.add_to(options.build, view);
    if !args.quiet {
        left_out
            .iter()
            .for_each(|note| output::message(&format!("note: {note}")));
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build()
        .context("cannot start threads")?;
    if let (Some(path), [rays]) = (&args.replay, &options.rays[..]) {
        let file = (path.as_path(), rays);
        return pool.install(|| {
            replay::run(
                &scene,
                &options.contestants,
                &options.build,
                file,
                args.json,
            )
        });
    }
    if let Some(folder) = &args.write_rays {
        options.rays = pool.install(|| {
            let accelerator = AcceleratorKind::default().build_with(&scene, &options.build);
            rays_of_view(&scene, &*accelerator, &view.camera, &options)
        });
        ray_files::write(folder, &options.rays)?;
    }
    let bar = WorkBar::begin("compare", args.quiet);
    let watch = |phase: Phase, done: f64| bar.reach(done, phase.to_string());
    let comparison = pool.install(|| Comparison::of(&scene, &view.camera, &options, &watch));
    bar.end();
    let comparison = comparison?;
    let report = CompareReport {
        models: &args.input.models,
        scene: &scene,
        camera_flags: &camera_args::as_flags(&camera, &scene, args.camera.up()),
        options: &options,
        threads: pool.current_num_threads(),
        comparison: &comparison,
        left_out: &left_out,
    };
    write_files(args, &report)?;
    output::result(&if args.json {
        report.json()
    } else {
        report.table()
    })?;
    Ok(verdict(&comparison))
}

/// Refuses what cannot be, before any work.
fn check(args: &CompareArgs) -> anyhow::Result<()> {
    args.contestants.check()?;
    for folder in args.report.iter().chain(&args.write_rays) {
        files::check_folder(folder)?;
    }
    if let Some(path) = &args.exr {
        if !path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("exr"))
        {
            let words = format!("--exr {}: its name must end with .exr", path.display());
            bail!(UsageError(words));
        }
        files::check_writable(path, std::iter::empty())?;
    }
    let (width, height) = args.profile.profile().size;
    if draws_costs(args) && u64::from(width) * u64::from(height) > MOST_COST_PIXELS {
        bail!(UsageError(format!(
            "--resolution {width}x{height}: --exr and --report draw at most {MOST_COST_PIXELS} pixels"
        )));
    }
    Ok(())
}

fn draws_costs(args: &CompareArgs) -> bool {
    args.exr.is_some() || args.report.is_some()
}

/// What is compared, and notes about what is not.
fn options(
    args: &CompareArgs,
    scene: &Scene,
    rays: Vec<NamedRays>,
    embree: Option<&Embree>,
) -> anyhow::Result<(CompareOptions, Vec<String>)> {
    let profile = args.profile.profile();
    let brought = rays.iter().map(|r| r.set.rays.len()).max();
    let most = brought.unwrap_or_else(|| profile.most_rays());
    let work = Work::of(scene, most, 1);
    let (contestants, left_out) = args.contestants.choose(embree, &work);
    let kinds: Vec<_> = contestants.iter().filter_map(Contestant::kind).collect();
    args.extents.check(&kinds, false)?;
    let options = CompareOptions {
        contestants,
        build: args.bsp.options(args.seed),
        rays,
        size: profile.size,
        most_rays: profile.rays as usize,
        repetitions: profile.repetitions as usize,
        draws_costs: draws_costs(args),
        memory: Some(memory::METER),
        seed: args.seed,
        up: args.camera.up(),
    };
    Ok((options, left_out))
}

/// The picture of costs, and the report with the wrong rays.
fn write_files(args: &CompareArgs, report: &CompareReport) -> anyhow::Result<()> {
    if let (Some(path), Some(costs)) = (&args.exr, &report.comparison.costs) {
        write_exr(path, &costs.picture())?;
    }
    let wrong = ray_files::wrong(report.comparison);
    let Some(folder) = &args.report else {
        if !wrong.is_empty() && !args.quiet {
            output::message("note: --report FOLDER saves the wrong rays for --replay");
        }
        return Ok(());
    };
    page::page(report, &wrong).write(folder)?;
    for rays in &wrong {
        write_rays(&wrong_path(folder, rays), &rays.set)?;
    }
    if !args.quiet {
        output::message(&format!("{}", folder.join("report.html").display()));
    }
    Ok(())
}

fn wrong_path(folder: &Path, rays: &NamedRays) -> PathBuf {
    folder.join(format!("{}.ray", rays.name))
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
        let mut comparison = Comparison::of(&scene, &frame, &options, &|_, _| ()).unwrap();
        assert_eq!(verdict(&comparison).code(), 0);
        let wrong = |c: &mut Comparison, m: usize| {
            c.sets[3].methods[m].mistakes.faults.add(Fault::Ghost);
        };
        wrong(&mut comparison, 1);
        assert_eq!(verdict(&comparison).code(), 0);
        wrong(&mut comparison, 0);
        assert_eq!(verdict(&comparison).code(), 5);
    }
}
