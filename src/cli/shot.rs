//! One picture after the other: a camera, its eye rays' structure, the film, its files.

use std::sync::Arc;
use std::time::Instant;

use bspray::accel::bsp::polygon::SceneTrees;
use bspray::accel::extents::{ExtentSphere, MeshAccelerator, View};
use bspray::accel::{Accelerator, AcceleratorKind, BspQuality, BuildOptions, BuildTime};
use bspray::analysis::{Needs, Used, Watched};
use bspray::picture;
use bspray::render::{self, Environment, Film, RenderOptions, Stage};
use bspray::scene::{Camera, CameraFrame, Scene};
use glam::DVec3;
use serde_json::{Value, json};

use super::display::light;
use super::files::OutputKind;
use super::frames::{Shot, Turn};
use super::motion::{Around, Neighbors};
use super::render::RenderArgs;
use super::savings_args::Detail;
use super::summary::{RenderSummary, Seconds};
use super::tev::Server;
use super::{Done, camera_args, metadata, output, pixel, progress};

/// Samples that a pixel is expected to get where noise decides: what a structure is worth depends on it.
const EXPECTED_SAMPLES: u32 = 64;

/// Everything that all pictures of a run share.
pub(super) struct Studio<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) scene: &'a Scene,
    /// Light in place of our own sky.
    pub(super) environment: Option<Arc<Environment>>,
    /// Where the first picture is taken from.
    pub(super) camera: Camera,
    /// What a turntable goes around.
    pub(super) middle: DVec3,
    /// The moments of an animation beside this one, for motion vectors.
    pub(super) neighbors: Option<Neighbors>,
    /// What was simplified, if anything was to be.
    pub(super) detail: Option<Detail>,
    pub(super) camera_flags: String,
    pub(super) trees: Option<SceneTrees>,
    pub(super) options: RenderOptions,
    pub(super) pool: rayon::ThreadPool,
    /// Shows pictures while they are rendered.
    pub(super) display: Option<Server>,
    /// What loading the scene and building its trees took.
    pub(super) before: Seconds,
    /// When loading began.
    pub(super) begun: Instant,
}

/// What became of one picture.
enum Taken {
    /// It is written, wholly or in part, with its report.
    Written(Value, Done),
    /// A signal came before there was anything to write.
    Nothing,
    /// There was a report about a pixel instead.
    Reported(Done),
}

/// A structure.
struct Built {
    accelerator: Box<dyn Accelerator>,
    /// Which of the spheres it asks, and an overlay draws.
    sphere: ExtentSphere,
    /// Of its wide BSPs, if it has any.
    quality: Option<BspQuality>,
    /// What its rays hit, if anybody wants to know.
    used: Option<Arc<Used>>,
    seconds: f64,
}

/// A stage, and what it and everything before it took but loading.
struct Staged<'s> {
    stage: Stage<'s>,
    sphere: ExtentSphere,
    quality: Option<BspQuality>,
    used: Option<&'s Used>,
    seconds: f64,
}

impl Shot {
    /// What it is called while it is made.
    fn name(&self) -> String {
        match self.outputs.first() {
            Some((path, _)) => path.display().to_string(),
            None => "bspray".to_owned(),
        }
    }

    /// Whether a file of it has layers.
    pub(super) fn has_layers(&self) -> bool {
        self.outputs
            .iter()
            .any(|(_, kind)| *kind == OutputKind::Exr)
    }
}

/// What a turntable goes around: the middle of the scene. No picture asks for it where there is no turntable.
pub(super) fn middle(scene: &Scene, shots: &[Shot]) -> DVec3 {
    match shots.iter().any(|shot| shot.turn.is_some()) {
        true => scene.bounds().center().as_dvec3(),
        false => DVec3::ZERO,
    }
}

/// Where pictures of a camera are taken from, or those of a turntable around a middle.
///
/// # Errors
/// The camera is impossible.
pub(super) fn views(
    args: &RenderArgs,
    (camera, middle): (&Camera, DVec3),
    shots: &[Shot],
) -> anyhow::Result<Vec<CameraFrame>> {
    let axis = args.camera.up().as_dvec3();
    let view = |shot: &Shot| {
        let turned = shot.turn;
        let turned = turned.map(|turn| camera.turned_around(middle, axis, turn.angle(0.0)));
        let view = camera_args::view(turned.as_ref().unwrap_or(camera), args.resolution, 0.0)?;
        Ok(args.lens.add_to(view.camera, camera))
    };
    shots.iter().map(view).collect()
}

impl Studio<'_> {
    /// Takes all pictures, and ends early with one that a signal left partial.
    pub(super) fn take(&self, shots: &[Shot]) -> anyhow::Result<Done> {
        // Extents know the pixels of one camera; other structures know no camera, and serve all pictures.
        let is_shared = self.args.accel != AcceleratorKind::Extents;
        let first = shots.first().filter(|_| is_shared);
        let pictures = if is_shared { shots.len() } else { 1 };
        let built = first.map(|shot| self.build(shot, pictures)).transpose()?;
        let staged = built.as_ref().map(|built| self.stage(built));
        let mut reports = Vec::new();
        let mut done = Done::Completely;
        for shot in shots {
            let taken = match &staged {
                Some(staged) => self.shoot(shot, staged),
                None => self.shoot(shot, &self.stage(&self.build(shot, pictures)?)),
            };
            match taken? {
                Taken::Written(report, of_shot) => {
                    reports.push(report);
                    done = of_shot;
                }
                Taken::Nothing => done = Done::Partially,
                Taken::Reported(of_shot) => return Ok(of_shot),
            }
            if matches!(done, Done::Partially) {
                break;
            }
        }
        if self.args.json {
            let report = match shots {
                [Shot { turn: None, .. }] => reports.pop(),
                _ => Some(json!({ "frames": reports })),
            };
            if let Some(report) = report {
                output::result(&format!("{report:#}"))?;
            }
        }
        Ok(done)
    }

    /// The camera of a picture, with the arguments that give it.
    fn camera(&self, shot: &Shot) -> (Camera, String) {
        let flags = self.camera_flags.clone();
        let Some(turn) = shot.turn else {
            return (self.camera.clone(), flags);
        };
        (self.turned(turn, 0.0), format!("{flags} {turn}"))
    }

    /// The camera of a turntable, `later` frames after a place on it.
    fn turned(&self, turn: Turn, later: f64) -> Camera {
        let axis = self.args.camera.up().as_dvec3();
        self.camera
            .turned_around(self.middle, axis, turn.angle(later))
    }

    /// The frames beside a picture, if it is one of several.
    fn around(&self, shot: &Shot) -> anyhow::Result<Option<Around<'_>>> {
        let (scenes, cameras) = match (shot.turn, &self.neighbors) {
            _ if self.detail.is_some() => return Ok(None),
            (Some(turn), _) if turn.moves() => {
                let cameras = [-1.0, 1.0].map(|later| self.turned(turn, later));
                ([self.scene; 2], cameras)
            }
            (None, Some(neighbors)) => (neighbors.scenes.each_ref(), neighbors.cameras.clone()),
            _ => return Ok(None),
        };
        Around::new(scenes, &cameras, self.options.size).map(Some)
    }

    /// What a picture's camera sees, with the arguments that give it.
    fn view(&self, shot: &Shot) -> anyhow::Result<(View, String)> {
        let (camera, flags) = self.camera(shot);
        let radius = self.options.filter.radius();
        let view = camera_args::view(&camera, self.options.size, radius)?;
        let view = View {
            camera: self.args.lens.add_to(view.camera, &camera),
            ..view
        };
        Ok((view, flags))
    }

    /// The structure for a picture, or several of its kind.
    fn build(&self, shot: &Shot, pictures: usize) -> anyhow::Result<Built> {
        let (view, _) = self.view(shot)?;
        let started = Instant::now();
        let samples = match self.options.noise {
            // Few pixels get the most.
            Some(_) => self.options.samples.min(EXPECTED_SAMPLES),
            None => self.options.samples,
        };
        let samples = self.options.window.area() * u64::from(samples);
        let rays = samples.saturating_mul(u64::from(self.options.integrator.rays_a_sample()));
        let triangles = self
            .scene
            .meshes
            .iter()
            .map(|m| m.triangles.len() as u64)
            .sum();
        let rays = rays.saturating_mul(pictures as u64);
        let quality = BspQuality::for_rays(rays, triangles);
        // A picture of the steps shows the tree of which nothing is left out.
        let time = if self.args.savings.exhaustive || self.options.integrator.shows_steps() {
            BuildTime::Ahead
        } else {
            let is_whole = self.scene.is_seen_whole(&view.camera, self.options.size);
            BuildTime::for_rays(rays, triangles, is_whole)
        };
        let options = self.args.bsp.options_for(self.args.seed, quality, time);
        let options = BuildOptions {
            test: self.args.intersect,
            // Only behind a surface with alpha does a ray go on to the next in the same place.
            drops_copies: !self.args.savings.exhaustive
                && !self.scene.materials.iter().any(|m| m.has_alpha()),
            ..self.args.extents.add_to(options, view)
        };
        let has_wide = match self.args.accel {
            AcceleratorKind::Bsp => true,
            AcceleratorKind::Extents => options.mesh == MeshAccelerator::Bsp,
            _ => false,
        };
        let build = || self.args.accel.build_with(self.scene, &options);
        let (mut accelerator, mut used) = (self.pool.install(build), None);
        if self.args.stats || self.args.json {
            let watched = Watched::new(accelerator, self.scene);
            (accelerator, used) = (Box::new(watched.0), Some(watched.1));
        }
        Ok(Built {
            accelerator,
            used,
            sphere: options.sphere,
            quality: has_wide.then_some(options.quality),
            seconds: started.elapsed().as_secs_f64(),
        })
    }

    /// The scene made ready for shading.
    fn stage<'s>(&'s self, built: &'s Built) -> Staged<'s> {
        let args = self.args;
        let started = Instant::now();
        let sky = args.environment.sky_mode();
        let new = || Stage::new(self.scene, &*built.accelerator, args.camera.up(), sky);
        let mut stage = self.pool.install(new).with_trees(self.trees.as_ref());
        if let Some(environment) = &self.environment {
            stage = stage.with_environment(Arc::clone(environment));
        }
        if args.environment.is_transparent() {
            stage = stage.without_backdrop();
        }
        if args.chooses_emitters_by_power() {
            stage = stage.with_emitters_by_power();
        }
        if args.savings.exhaustive {
            self.pool.install(|| stage.textures.build_all(self.scene));
            stage = stage.exhaustively();
        }
        Staged {
            stage,
            sphere: built.sphere,
            quality: built.quality,
            used: built.used.as_deref(),
            seconds: self.before.build + built.seconds + started.elapsed().as_secs_f64(),
        }
    }

    /// Renders a picture.
    fn shoot(&self, shot: &Shot, staged: &Staged) -> anyhow::Result<Taken> {
        let (args, stage) = (self.args, &staged.stage);
        let (view, camera_flags) = self.view(shot)?;
        if let Some(place) = args.pixel {
            let done = pixel::run(stage, &view.camera, &self.options, place, args.json)?;
            return Ok(Taken::Reported(done));
        }

        let window = self.options.window;
        let samples = window.area() * u64::from(self.options.samples);
        let name = shot.name();
        if let Some(server) = &self.display {
            server.create(&name, self.options.size);
        }
        let display = self.display.as_ref().map(|server| (server, name.as_str()));
        let watch = progress::begin(samples, args.time_limit, display, args.quiet);
        let started = Instant::now();
        let film = self
            .pool
            .install(|| render::render(stage, &view.camera, &self.options, &watch));
        let seconds = Seconds {
            build: staged.seconds,
            render: started.elapsed().as_secs_f64(),
            first_pixel: watch.first_pixel(self.begun),
            ..self.before
        };
        watch.end();
        let build = stage.accelerator.build_stats();
        let needs = |used| Needs::of(self.scene, used, &stage.textures, &build);

        let summary = RenderSummary {
            args_models: &args.input.models,
            scene: self.scene,
            accelerator: args.accel,
            bsp_quality: staged.quality,
            triangle_test: args.intersect,
            build,
            needs: staged.used.map(needs),
            film: &film,
            detail: self.detail.as_ref(),
            options: &self.options,
            threads: self.pool.current_num_threads(),
            seconds,
            camera_flags: &camera_flags,
            outputs: shot
                .outputs
                .iter()
                .map(|(path, _)| path.as_path())
                .collect(),
        };
        if film.samples() == 0 {
            output::message("interrupted before there was a picture; nothing is written");
            return Ok(Taken::Nothing);
        }
        self.write(shot, staged, &view, &film, &summary)?;
        if !args.quiet {
            output::message(&summary.line());
        }
        if args.stats && !args.json {
            output::result(&summary.table())?;
        }
        let done = if film.is_complete {
            Done::Completely
        } else {
            Done::Partially
        };
        Ok(Taken::Written(summary.value(), done))
    }

    /// Writes a picture's files, and shows it whole.
    fn write(
        &self,
        shot: &Shot,
        staged: &Staged,
        view: &View,
        film: &Film,
        summary: &RenderSummary,
    ) -> anyhow::Result<()> {
        let args = self.args;
        let overlay = self.pool.install(|| {
            args.overlay
                .draw(&staged.stage, view, film.window, staged.sphere)
        });
        let note = overlay.as_ref().and_then(|o| args.overlay.note(&o.report));
        if let Some(note) = note.filter(|_| !args.quiet) {
            output::message(&note);
        }
        let denoised = args
            .denoise
            .then(|| self.pool.install(|| render::denoise(film)));
        if let Some(server) = &self.display {
            server.finish(&shot.name(), film.window, light(film, denoised.as_deref()));
        }
        let around = self.around(shot)?;
        // One output that cannot be written does not take the others with it.
        let mut failures = shot.outputs.iter().filter_map(|(path, kind)| {
            let written = self.pool.install(|| match kind {
                OutputKind::Exr => {
                    let layers = render::layers(film, &view.camera);
                    let layers = match &self.detail {
                        Some(_) => render::without_triangles(layers),
                        None => layers,
                    };
                    let layers = render::add_mattes(layers, film, self.scene);
                    let layers = match &around {
                        Some(around) => around.add_to(layers, film, self.scene, &view.camera),
                        None => layers,
                    };
                    let layers = match &denoised {
                        Some(colors) => render::with_denoised(layers, colors),
                        None => layers,
                    };
                    let layers = overlay.iter().fold(layers, |layers, o| o.add_to(layers));
                    picture::exr::write(path, &metadata::add(layers, summary))
                }
                OutputKind::Display => {
                    let integrator = self.options.integrator;
                    let is_cut_out = args.environment.is_transparent() && overlay.is_none();
                    let denoised = denoised.as_deref();
                    let raster = match picture::ldr::LdrFormat::of_path(path) {
                        Ok(picture::ldr::LdrFormat::Png) if is_cut_out => {
                            args.display.cut_out(film, denoised, integrator)
                        }
                        _ => args
                            .display
                            .raster(film, denoised, integrator, overlay.as_ref()),
                    };
                    picture::ldr::write(path, &raster)
                }
            });
            written.err()
        });
        let failure = failures.next();
        failures.for_each(|e| output::error(&e.into()));
        failure.map_or(Ok(()), |failure| Err(failure.into()))
    }
}
