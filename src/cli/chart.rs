//! `bspray chart`: speed against accuracy.

use std::path::PathBuf;

use anyhow::{Context, bail};
use bspray::analysis::chart::{ChartMethod, ChartOptions, ChartPoints, Doing};
use bspray::render::{Integrator, LightSearch};
use clap::Args;

use super::bsp_args::BspArgs;
use super::camera_args::{self, CameraArgs};
use super::chart_page::ChartPage;
use super::model_args::ModelArgs;
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
    /// Samples a pixel of the pictures, with commas between; 0 for none
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(0..=4096))]
    samples: Vec<u32>,
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
        "Only these methods, with commas between [default: all that end soon for the model]. After the colon stands, for `bsp`, the quality of its build, for \
        `extents` the extents that are tested, and for all others the triangle test. There are {}",
        names.join(", ")
    )
}

/// Measures and writes the report.
pub(super) fn run(args: &ChartArgs) -> anyhow::Result<Done> {
    let profile = match (args.quick, args.thorough) {
        (true, _) => QUICK,
        (_, true) => THOROUGH,
        _ => USUAL,
    };
    for (index, method) in args.method.iter().enumerate() {
        if args.method[..index].contains(method) {
            bail!(UsageError(format!("--method names {method} twice")));
        }
    }
    let folder = args.report.clone();
    let folder = folder.unwrap_or_else(|| files::default_output(&args.input.models, "-chart"));
    files::check_folder(&folder)?;
    let scene = args.input.load()?;
    if !args.quiet {
        output::tell_of(&scene);
    }
    let size = args.resolution.unwrap_or(profile.0);
    let camera = args.camera.choose(&scene, size)?;
    let view = camera_args::view(&camera, size, 0.0)?;
    let camera_flags = camera_args::as_flags(&camera, &scene, args.camera.up());
    let methods = if args.method.is_empty() {
        ChartMethod::suited(scene.placed_triangles(), scene.instances.len())
    } else {
        args.method.clone()
    };
    let mut samples = if args.samples.is_empty() {
        profile.3.to_vec()
    } else {
        args.samples.clone()
    };
    samples.retain(|&n| n > 0);
    samples.sort_unstable();
    samples.dedup();
    let options = ChartOptions {
        picture_methods: ChartMethod::for_pictures(&methods),
        methods,
        samples,
        build: args.bsp.options(args.seed),
        camera: view.camera,
        size,
        integrator: Integrator::Path {
            max_depth: args.max_depth,
            search: LightSearch::Both,
        },
        most_rays: args.max_rays.unwrap_or(profile.1) as usize,
        repetitions: args.repetitions.unwrap_or(profile.2) as usize,
        seed: args.seed,
        up: args.camera.up(),
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build()
        .context("cannot start threads")?;
    let watch = |doing: Doing| {
        if !args.quiet {
            output::message(&tell(doing));
        }
    };
    let points = pool.install(|| ChartPoints::of(&scene, &options, &watch));
    let page = ChartPage {
        models: &args.input.models,
        scene: &scene,
        camera_flags: &camera_flags,
        max_depth: args.max_depth,
        options: &options,
        threads: pool.current_num_threads(),
        points: &points,
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

fn tell(doing: Doing) -> String {
    match doing {
        Doing::Reference => "asking the reference, and judging it".to_owned(),
        Doing::Build(method) => format!("building {method}"),
        Doing::Trace => "timing rays".to_owned(),
        Doing::Judge => "judging answers".to_owned(),
        Doing::Converge(samples) => format!("rendering the reference, {samples} samples a pixel"),
        Doing::Picture(method, samples) => {
            format!("rendering with {method}, {samples} samples a pixel")
        }
    }
}
