//! `bspray chart`: speed against accuracy.

mod commands;
mod page;
mod pictures;
mod rays;
mod text;

use std::path::PathBuf;

use anyhow::{Context, bail};
use bspray::accel::Embree;
use bspray::analysis::Work;
use bspray::analysis::chart::{ChartMethod, ChartOptions, ChartPoints, Doing};
use bspray::render::{Integrator, LightSearch};
use bspray::scene::{CameraFrame, Scene};
use clap::Args;

use self::page::ChartPage;
use super::bsp_args::BspArgs;
use super::camera_args::{self, CameraArgs};
use super::embree_args::EmbreeArgs;
use super::model_args::ModelArgs;
use super::work_bar::WorkBar;
use super::{Done, UsageError, files, output, values};

/// How much is done: width and height, rays of each kind, repetitions, samples a pixel of the pictures.
struct Profile((u32, u32), u32, u32, &'static [u32]);

const QUICK: Profile = Profile((320, 180), 57_600, 5, &[1, 4, 16]);
const USUAL: Profile = Profile((640, 360), 230_400, 9, &[1, 2, 4, 8, 16, 32]);
const THOROUGH: Profile = Profile(
    (1280, 720),
    921_600,
    15,
    &[1, 2, 4, 8, 16, 32, 64, 128, 256],
);

/// Arguments of `bspray chart`.
#[derive(Args, Debug)]
#[command(
    after_help = "Exit code 5 says that an exact method gave a wrong answer; the report is written all the same."
)]
pub(super) struct ChartArgs {
    #[command(flatten)]
    input: ModelArgs,
    /// The folder of the report: report.html, the charts as SVG and PNG, all numbers as CSV and JSON [default: the model's name with -chart]
    #[arg(long, value_name = "FOLDER")]
    report: Option<PathBuf>,
    /// A small view, few rays and samples
    #[arg(long, conflicts_with = "thorough")]
    quick: bool,
    /// A large view, many rays and samples
    #[arg(long)]
    thorough: bool,
    /// Only these methods, with commas between: KIND, or KIND:CHOICE [default: all that end soon for the model]
    #[arg(long, value_name = "METHOD,...", value_delimiter = ',', long_help = method_help())]
    method: Vec<ChartMethod>,
    #[command(flatten)]
    embree: EmbreeArgs,
    /// Samples a pixel of the pictures, with commas between; 0 for none
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(0..=4096))]
    samples: Vec<u32>,
    /// Pixels by which meshes may be simplified (`--lod` of `render`), with commas between, for further pictures with the first method
    #[arg(long, value_name = "PIXELS,...", value_delimiter = ',', default_values_t = [0.5, 2.0], value_parser = values::positive)]
    lod: Vec<f32>,
    /// Width and height of the view, in pixels, in place of those of --quick and --thorough
    #[arg(long, value_name = "WxH", value_parser = values::resolution)]
    resolution: Option<(u32, u32)>,
    /// Most rays of each kind
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=values::MOST_RAYS))]
    max_rays: Option<u32>,
    /// How often each method is timed
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    repetitions: Option<u32>,
    /// Bounces of light in the pictures, which are path-traced
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=values::MOST_DEPTH))]
    max_depth: u32,
    #[command(flatten)]
    bsp: BspArgs,
    /// Changes every random number
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Threads that build, render and judge; 0 for one a core. Rays are timed on one thread
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads)]
    threads: usize,
    #[command(flatten)]
    camera: CameraArgs,
    /// Print one JSON object
    #[arg(long, help_heading = "Reports")]
    json: bool,
    /// No progress and no notes
    #[arg(short, long, help_heading = "Reports")]
    quiet: bool,
}

/// Lists the methods.
fn method_help() -> String {
    let names: Vec<_> = ChartMethod::all().iter().map(ChartMethod::name).collect();
    format!(
        "Only these methods, with commas between [default: all that end soon for the model]. After the colon stands the triangle test, \
        for `bsp` also the quality of its build, and for `extents` the extents that are tested. There are {}",
        names.join(", ")
    )
}

/// Measures and writes the report.
pub(super) fn run(args: &ChartArgs) -> anyhow::Result<Done> {
    for (index, method) in args.method.iter().enumerate() {
        if args.method[..index].contains(method) {
            bail!(UsageError(format!("--method names {method} twice")));
        }
    }
    let folder = args.report.clone();
    let folder = folder.unwrap_or_else(|| files::default_output(&args.input.models, "-chart"));
    files::check_folder(&folder)?;
    let embree = embree(args)?;
    let scene = args.input.load()?;
    if !args.quiet {
        output::tell_of(&scene);
    }
    let size = args.resolution.unwrap_or(args.profile().0);
    let camera = args.camera.choose(&scene, size)?;
    let view = camera_args::view(&camera, size, 0.0)?;
    let camera_flags = camera_args::as_flags(&camera, &scene, args.camera.up());
    let (options, left_out) = options(args, &scene, (view.camera, size), embree);
    if !args.quiet {
        let notes = left_out.iter().map(|words| format!("note: {words}"));
        notes.for_each(|note| output::message(&note));
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build()
        .context("cannot start threads")?;
    let bar = WorkBar::begin("chart", args.quiet);
    let watch = |doing: Doing, done: f64| bar.reach(done, doing.to_string());
    let points = pool.install(|| ChartPoints::of(&scene, &options, &watch));
    bar.end();
    let points = points?;
    let page = ChartPage {
        models: &args.input.models,
        scene: &scene,
        camera_flags: &camera_flags,
        max_depth: args.max_depth,
        options: &options,
        embree: args.embree.embree.as_deref(),
        threads: pool.current_num_threads(),
        points: &points,
        left_out: &left_out,
    };
    page.report().write(&folder)?;
    if !args.quiet {
        output::message(&format!("{}", folder.join("report.html").display()));
    }
    output::result(&if args.json {
        format!("{:#}", page.report().json())
    } else {
        page.text()
    })?;
    Ok(if points.is_right() {
        Done::Completely
    } else {
        Done::FirstIsWrong
    })
}

impl ChartArgs {
    fn profile(&self) -> Profile {
        match (self.quick, self.thorough) {
            (true, _) => QUICK,
            (_, true) => THOROUGH,
            _ => USUAL,
        }
    }
}

/// Embree, if its library is named; all cores build.
fn embree(args: &ChartArgs) -> anyhow::Result<Option<Embree>> {
    let modes = args.method.iter().filter_map(ChartMethod::needs_embree);
    let modes: Vec<_> = modes.collect();
    let named = (!args.method.is_empty()).then_some(&*modes);
    args.embree.load(args.threads, "--method", named)
}

/// What is measured, and notes about what is not.
fn options(
    args: &ChartArgs,
    scene: &Scene,
    (camera, size): (CameraFrame, (u32, u32)),
    embree: Option<Embree>,
) -> (ChartOptions, Vec<String>) {
    let profile = args.profile();
    let mut samples = if args.samples.is_empty() {
        profile.3.to_vec()
    } else {
        args.samples.clone()
    };
    samples.retain(|&n| n > 0);
    samples.sort_unstable();
    samples.dedup();
    let most_rays = args.max_rays.unwrap_or(profile.1) as usize;
    let repetitions = args.repetitions.unwrap_or(profile.2) as usize;
    let (methods, left_out) = if args.method.is_empty() {
        let pixels = size.0 as usize * size.1 as usize;
        let builds = ChartMethod::BUILDS + samples.len() * repetitions;
        let work = Work::of(scene, most_rays.min(pixels), builds);
        ChartMethod::suited(&work, embree.is_some())
    } else {
        (args.method.clone(), Vec::new())
    };
    let options = ChartOptions {
        picture_methods: ChartMethod::for_pictures(&methods),
        methods,
        samples,
        budgets: args.lod.clone(),
        build: args.bsp.options(args.seed),
        embree,
        camera,
        size,
        integrator: Integrator::Path {
            max_depth: args.max_depth,
            search: LightSearch::Both,
        },
        most_rays,
        repetitions,
        seed: args.seed,
        up: args.camera.up(),
    };
    (options, left_out)
}
