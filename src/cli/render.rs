//! `bspray render`: models in, pictures and measurements out.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Instant;

use anyhow::{Context, bail};
use bspray::accel::AcceleratorKind;
use bspray::accel::bsp::polygon::SceneTrees;
use bspray::geometry::TriangleTest;
use bspray::import::{ShownImages, TextureNeeds};
use bspray::render::{
    self, Integrator, LightSearch, NoiseGoal, PixelFilter, PixelRect, RenderOptions,
};
use bspray::scene::Scene;
use clap::{Args, ValueEnum};

use super::bsp_args::{self, BspArgs};
use super::camera_args::{self, CameraArgs};
use super::display::DisplayArgs;
use super::environment_args::EnvironmentArgs;
use super::extent_args::ExtentArgs;
use super::files;
use super::frames::{FrameArgs, Shot};
use super::lens_args::LensArgs;
use super::model_args::{ModelArgs, Wants};
use super::motion::{self, Neighbors};
use super::overlay_args::OverlayArgs;
use super::savings_args::SavingsArgs;
use super::shot::{self, Studio};
use super::summary::Seconds;
use super::tev::Server;
use super::values::{self, CropWindow, PixelBounds};
use super::{Done, UsageError, output, progress};

/// Samples a pixel if nothing else is said.
const DEFAULT_SAMPLES: u32 = 16;

/// Most samples a pixel where a noise is asked for, if nothing else is said.
const MOST_ADAPTIVE_SAMPLES: u32 = 1024;

/// Arguments of `bspray render`.
#[derive(Args, Debug)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    pub(super) input: ModelArgs,
    /// Where the picture goes: .exr (all layers), .png or .jpg; can be given several times [default: the model's name with .png]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Width and height of the picture, in pixels
    #[arg(long, value_name = "WxH", value_parser = values::resolution, default_value = "1280x720")]
    pub(super) resolution: (u32, u32),
    /// Samples a pixel; with --time-limit or --noise the most of them [default: 16, with --noise 1024, with --time-limit 1048576]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=values::MOST_SAMPLES))]
    spp: Option<u32>,
    /// End with the samples that every pixel has by then; one at least
    #[arg(long, value_name = "SECONDS", value_parser = values::positive, conflicts_with = "pixel")]
    pub(super) time_limit: Option<f32>,
    /// Changes every random number
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u32,
    /// Threads that render; 0 for one a core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads)]
    threads: usize,
    /// The structure that finds what rays hit
    #[arg(long, value_name = "KIND", default_value_t = AcceleratorKind::default(), value_parser = values::accelerator,
        long_help = accelerator_help("The structure that finds what rays hit"))]
    pub(super) accel: AcceleratorKind,
    /// How it is decided what a ray hits: all but `exact` may be wrong, and `bsp` and `extents` have no other
    #[arg(long, value_name = "TEST", default_value_t = TriangleTest::default(), value_parser = triangle_test, long_help = triangle_test_help())]
    pub(super) intersect: TriangleTest,
    #[command(flatten)]
    pub(super) bsp: BspArgs,
    #[command(flatten)]
    pub(super) extents: ExtentArgs,
    /// How colours come about
    #[arg(long, value_enum, value_name = "NAME", default_value_t = IntegratorName::Path)]
    integrator: IntegratorName,
    /// Bounces of light: the greatest depth of a ray for `path` and `whitted`; eye rays are level 0, 1 is direct light alone
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=values::MOST_DEPTH))]
    max_depth: u32,
    /// How `path` finds lights that have a size; all ways have the same mean
    #[arg(long, value_enum, value_name = "WAY", default_value_t = SearchName::Both)]
    light_search: SearchName,
    /// How the emissive triangle is chosen that is asked for light: of both ways, the mean is the same
    #[arg(long, value_enum, value_name = "WAY", default_value_t = SamplerName::Tree)]
    light_sampler: SamplerName,
    /// Add the layers `fragment` and `bsp-depth` of the polygon BSP to .exr files; their integrators do so anyway
    #[arg(long)]
    bsp_layers: bool,
    /// How far an ambient-occlusion ray must get, in model units [default: a tenth of the scene's diagonal]
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    ao_distance: Option<f32>,
    /// Filter the noise out, guided by albedo and normals; .exr files keep the noisy colours as the layer `noisy`
    #[arg(long)]
    pub(super) denoise: bool,
    /// How light between pixel centres is shared out
    #[arg(long, value_enum, value_name = "NAME", default_value_t = FilterName::BlackmanHarris)]
    filter: FilterName,
    #[command(flatten)]
    pub(super) camera: CameraArgs,
    #[command(flatten)]
    pub(super) environment: EnvironmentArgs,
    #[command(flatten)]
    pub(super) lens: LensArgs,
    #[command(flatten)]
    frames: FrameArgs,
    /// Render a part of the picture, given as shares of its width and height
    #[arg(
        long,
        value_name = "X0,X1,Y0,Y1",
        conflicts_with = "pixelbounds",
        help_heading = "Crop"
    )]
    cropwindow: Option<CropWindow>,
    /// Render a part of the picture, given in pixels
    #[arg(long, value_name = "X0,X1,Y0,Y1", help_heading = "Crop")]
    pixelbounds: Option<PixelBounds>,
    #[command(flatten)]
    pub(super) display: DisplayArgs,
    #[command(flatten)]
    pub(super) overlay: OverlayArgs,
    #[command(flatten)]
    pub(super) savings: SavingsArgs,
    /// Show the picture while it is rendered, in tev, which listens on port 14158, or another program of its protocol
    #[arg(long, value_name = "HOST:PORT", value_parser = values::address, conflicts_with = "pixel", help_heading = "Display")]
    display_server: Option<String>,
    /// Print everything about one pixel's rays instead of rendering
    #[arg(long, value_name = "X,Y", value_parser = values::pixel, help_heading = "Reports")]
    pub(super) pixel: Option<(u32, u32)>,
    /// Print sizes, times, and counts of rays and steps
    #[arg(long, help_heading = "Reports")]
    pub(super) stats: bool,
    /// Print the same as one JSON object
    #[arg(long, help_heading = "Reports")]
    pub(super) json: bool,
    /// No progress and no notes
    #[arg(short, long, help_heading = "Reports")]
    pub(super) quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum IntegratorName {
    /// Path tracing: light by any number of bounces, with all lobes of the materials
    Path,
    /// The lecture's ray tracing: shadow, mirror and refraction rays down to a recursion level (--max-depth)
    Whitted,
    /// Light that reaches matt surfaces directly, with shadows
    Direct,
    /// Ambient occlusion
    Ao,
    /// Shading normals as colours
    Normals,
    /// Grey where a front faces the eye, red where a back does
    Facing,
    /// The base colour
    Albedo,
    /// Texture coordinates: their fractions as red and green
    Uv,
    /// A colour for each instance
    Id,
    /// Heat map of the steps (nodes, leaves, triangles, extents) that eye rays take: violet for 1, yellow for 1024, by the logarithm
    Cost,
    /// A colour for each fragment of the polygon BSP (--bsp-order, --bsp-merge)
    Fragment,
    /// How deep in the polygon BSP a fragment is: violet for the root, yellow for the deepest node
    BspDepth,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SearchName {
    /// Both of the others, weighed by their densities: multiple importance sampling
    Both,
    /// Rays to points of lights: next-event estimation
    Lights,
    /// The path's own rays, chosen by how the surface scatters
    Surfaces,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SamplerName {
    /// By how much light each may send to the place that asks: a light tree
    Tree,
    /// By power, wherever light is asked for
    Power,
}

impl RenderArgs {
    /// Whether emissive triangles are chosen by their power alone.
    pub(super) fn chooses_emitters_by_power(&self) -> bool {
        self.light_sampler == SamplerName::Power
    }
}

impl From<SearchName> for LightSearch {
    fn from(name: SearchName) -> Self {
        match name {
            SearchName::Both => Self::Both,
            SearchName::Lights => Self::Lights,
            SearchName::Surfaces => Self::Surfaces,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FilterName {
    Box,
    BlackmanHarris,
}

/// What the option is for, and a line about every kind.
pub(super) fn accelerator_help(purpose: &str) -> String {
    let lines = AcceleratorKind::ALL.map(|k| format!("- {}: {}", k.name(), k.description()));
    format!("{purpose}\n\n{}", lines.join("\n"))
}

fn triangle_test(text: &str) -> Result<TriangleTest, String> {
    bsp_args::one_of(TriangleTest::ALL, TriangleTest::name, text)
}

/// What the option is for, and a line about every test.
fn triangle_test_help() -> String {
    let lines = TriangleTest::ALL.map(|t| format!("- {}: {}", t.name(), t.description()));
    format!(
        "How it is decided what a ray hits, in every structure; all but `exact` are there to see what goes wrong\n\n{}",
        lines.join("\n")
    )
}

/// Renders.
pub(super) fn run(args: &RenderArgs) -> anyhow::Result<Done> {
    progress::handle_signals()?;
    let models = &args.input.models;
    let shots = args
        .frames
        .shots(&args.output, models, args.pixel.is_some())?;
    let has_layers = shots.iter().any(Shot::has_layers);
    let is_simplified = args.savings.lod.is_some();
    if args.bsp_layers && !has_layers && args.pixel.is_none() {
        let words = "--bsp-layers: only .exr files have layers: add one with --output";
        bail!(UsageError(words.to_owned()));
    }
    args.extents
        .check(&[args.accel], args.overlay.shows_extents())?;
    args.overlay.check(args.pixel.is_some())?;
    args.lens.check(args.overlay.is_wanted())?;
    let window = window(args)?;

    let address = args.display_server.as_deref();
    let display = address
        .map(|address| Server::connect(address, args.quiet))
        .transpose()?;
    let started = Instant::now();
    // The scene is read for the camera that looks at it.
    let camera_of = |scene: &Scene| {
        let camera = args.camera.choose(scene, args.resolution)?;
        anyhow::Ok(args.lens.project(camera))
    };
    let camera = OnceLock::new();
    let shown = |scene: &Scene| {
        if scene.images.is_empty() {
            return Vec::new();
        }
        // What is wrong with a camera is said when the scene is there.
        let Ok(camera) = camera.get_or_init(|| camera_of(scene)) else {
            return Vec::new();
        };
        let middle = shot::middle(scene, &shots);
        let views = shot::views(args, (camera, middle), &shots).unwrap_or_default();
        render::shown_detail(scene, &views, &options(args, scene, window, has_layers))
    };
    let wants = wants(args, has_layers, &shown);
    let (mut scene, neighbors) = motion::load(
        &args.input,
        &args.frames,
        has_layers && !is_simplified,
        wants,
    )?;
    let environment = args.environment.environment(args.camera.up())?;
    // So that it is not written over.
    scene
        .files
        .extend(args.environment.file().map(PathBuf::from));
    let load = started.elapsed().as_secs_f64();
    let begun = started;
    let outputs = shots.iter().flat_map(|shot| &shot.outputs);
    files::spare_inputs(outputs.map(|(path, _)| path.as_path()), &scene)?;
    if !args.quiet {
        output::tell_of(&scene);
    }
    let camera = match camera.into_inner() {
        Some(camera) => camera?,
        None => camera_of(&scene)?,
    };
    let neighbors = neighbors.map(|n| Neighbors::new(args, n)).transpose()?;
    let camera_flags =
        camera_args::as_flags(&camera, &scene, args.camera.up()) + &args.lens.as_flags();
    if !args.quiet {
        output::message(&format!("camera: {camera_flags}"));
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build()
        .context("cannot start threads")?;
    let options = options(args, &scene, window, has_layers);
    args.savings.check(options.integrator)?;
    let middle = shot::middle(&scene, &shots);
    let views = shot::views(args, (&camera, middle), &shots)?;
    let (scene, detail) = pool.install(|| args.savings.simplify(scene, views, args.resolution));
    if let Some(detail) = detail.as_ref().filter(|_| !args.quiet) {
        detail.tell(has_layers);
    }
    let shows_trees = options.integrator.shows_trees() || args.bsp_layers;
    let started = Instant::now();
    let trees = args.bsp.options(args.seed);
    let trees = shows_trees.then(|| SceneTrees::build(&scene, &trees));
    let build = started.elapsed().as_secs_f64();
    if let Some(trees) = &trees
        && !args.quiet
    {
        output::message(&bsp_args::describe(trees));
    }
    let studio = Studio {
        args,
        scene: &scene,
        environment,
        camera,
        middle,
        neighbors,
        detail,
        camera_flags,
        trees,
        options,
        pool,
        display,
        before: Seconds {
            load,
            build,
            render: 0.0,
            first_pixel: 0.0,
        },
        begun,
    };
    studio.take(&shots)
}

fn options(args: &RenderArgs, scene: &Scene, window: PixelRect, has_layers: bool) -> RenderOptions {
    RenderOptions {
        size: args.resolution,
        window,
        samples: args.spp.unwrap_or(match args.time_limit {
            Some(_) => values::MOST_SAMPLES as u32,
            None if args.savings.noise.is_some() => MOST_ADAPTIVE_SAMPLES,
            None => DEFAULT_SAMPLES,
        }),
        noise: args.savings.noise.map(|level| NoiseGoal {
            level,
            exposure: args.display.exposure_factor(),
        }),
        seed: args.seed,
        integrator: integrator(args, scene),
        filter: match args.filter {
            FilterName::Box => PixelFilter::Box,
            FilterName::BlackmanHarris => PixelFilter::BlackmanHarris,
        },
        counts_cost: has_layers || args.stats || args.json,
        wants_layers: has_layers || args.denoise,
    }
}

fn window(args: &RenderArgs) -> anyhow::Result<PixelRect> {
    let size = args.resolution;
    if let Some((x, y)) = args.pixel.filter(|(x, y)| *x >= size.0 || *y >= size.1) {
        let cause = format!(
            "--pixel {x},{y} is outside the picture of {}x{} pixels",
            size.0, size.1
        );
        bail!(UsageError(cause));
    }
    let window = match (args.cropwindow, args.pixelbounds) {
        (Some(crop), _) => crop.pixels(size),
        (None, Some(bounds)) => bounds.pixels(size).map_err(UsageError)?,
        (None, None) => PixelRect {
            x: 0,
            y: 0,
            width: size.0,
            height: size.1,
        },
    };
    if window.area() > values::MOST_PIXELS && args.pixel.is_none() {
        let cause = format!(
            "{} pixels are more than the {} that are rendered at once: use --pixelbounds and render the picture in parts",
            window.area(),
            values::MOST_PIXELS
        );
        bail!(UsageError(cause));
    }
    Ok(window)
}

/// What of the models the pictures need.
fn wants<'a>(args: &RenderArgs, has_layers: bool, shown: &'a ShownImages<'a>) -> Wants<'a> {
    use IntegratorName::{Ao, BspDepth, Cost, Facing, Fragment, Id, Normals, Uv};
    let keeps_copies = args.savings.exhaustive;
    // Layers, filters and reports look at colours whatever the picture shows.
    let shows_all = keeps_copies || has_layers || args.denoise || args.pixel.is_some();
    let textures = match args.integrator {
        _ if shows_all => TextureNeeds::All,
        Ao | Normals => TextureNeeds::Normals,
        Facing | Uv | Id | Cost | Fragment | BspDepth => TextureNeeds::Alpha,
        _ => TextureNeeds::All,
    };
    Wants {
        keeps_copies,
        textures,
        // Alpha wants the finest detail in any case.
        shown: (!shows_all && textures != TextureNeeds::Alpha).then_some(shown),
    }
}

fn integrator(args: &RenderArgs, scene: &Scene) -> Integrator {
    match args.integrator {
        IntegratorName::Path => Integrator::Path {
            max_depth: args.max_depth,
            search: args.light_search.into(),
        },
        IntegratorName::Whitted => Integrator::Whitted {
            max_depth: args.max_depth,
        },
        IntegratorName::Direct => Integrator::Direct,
        IntegratorName::Ao => Integrator::Ao {
            distance: args
                .ao_distance
                .unwrap_or_else(|| scene.bounds().diagonal() * 0.1),
        },
        IntegratorName::Normals => Integrator::Normals,
        IntegratorName::Facing => Integrator::Facing,
        IntegratorName::Albedo => Integrator::Albedo,
        IntegratorName::Uv => Integrator::Uv,
        IntegratorName::Id => Integrator::Id,
        IntegratorName::Cost => Integrator::Cost,
        IntegratorName::Fragment => Integrator::Fragment,
        IntegratorName::BspDepth => Integrator::BspDepth,
    }
}

/// Says what a scene holds, in one line.
pub(super) fn describe(scene: &Scene) -> String {
    format!(
        "{} triangles in {} instances",
        scene.placed_triangles(),
        scene.instances.len()
    )
}
