//! From a scene, an accelerator and a camera to a [`Film`].
//!
//! Lengths are in model units, colours linear radiance of Rec. 709 primaries. Every random number is a function of pixel, sample,
//! dimension and seed, and the samples of a pixel are added in their order, so that thread count, tile order and
//! crop do not change a bit of the picture.

mod adaptive;
mod aov;
pub mod bsdf;
mod cryptomatte;
mod denoise;
mod environment;
mod eye_rays;
mod facets;
mod film;
mod filter;
mod framing;
mod integrator;
mod layered;
mod lights;
mod lobes;
mod mikktspace;
mod motion;
mod overlay;
mod partition;
mod ray_cone;
mod sampler;
mod secondary;
mod shown;
mod stage;
mod surface;
mod tangents;
mod texture;
mod thrift;
mod together;
mod tracer;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

pub use adaptive::NoiseGoal;
pub use aov::{LAYERS, Layer, NOTHING, PARTITION_LAYERS};
pub use cryptomatte::{MatteKind, add_mattes, matte_id};
pub use denoise::{denoise, with_denoised};
pub use environment::{Daylight, Environment, EnvironmentSample};
pub use film::{Film, FirstHit, LayerSum, Pixel, PixelRect, PixelSum};
pub use filter::PixelFilter;
pub use framing::{CameraWishes, DEFAULT_VIEW_ANGLE, frame_scene};
pub use integrator::{Integrator, LightSearch, MOST_STEPS, Sample};
pub use layered::{layers, without_triangles};
pub use lights::Lights;
pub use motion::{MotionFrame, add_motion};
pub use overlay::{Overlay, OverlayOptions, OverlayReport};
pub use partition::FragmentPoint;
pub use ray_cone::{RayCone, uv_per_length, uv_width_per_length};
pub use sampler::Sampler;
pub use secondary::{hemisphere_ray, shadow_ray};
pub use shown::shown_detail;
pub use stage::{SkyMode, Stage};
pub use surface::{MaterialPoint, Surface};
pub use texture::Textures;
pub use tracer::{Answer, Covered, RayCounts, RayKind, TracedRay, Tracer};

use crate::geometry::Ray;
use crate::scene::CameraFrame;
use adaptive::{Adaptive, LEAST_SAMPLES};
use cryptomatte::{MatteIds, TileMattes};
use together::{BLOCK, TOGETHER, Together};

/// What to render, and how.
#[derive(Clone, Copy, Debug)]
pub struct RenderOptions {
    /// Width and height of the full picture, in pixels.
    pub size: (u32, u32),
    /// The part of it that is rendered.
    pub window: PixelRect,
    /// Samples a pixel. Their places depend on it: with 8 in place of 16, a pixel does not have the first 8 of these.
    pub samples: u32,
    /// Where fewer samples are enough; `None` for as many everywhere.
    pub noise: Option<NoiseGoal>,
    /// Changes every random number.
    pub seed: u32,
    /// How colours come about.
    pub integrator: Integrator,
    /// How light between pixel centres is shared out.
    pub filter: PixelFilter,
    /// Whether steps of traversal are counted.
    pub counts_cost: bool,
    /// Whether the film is for a file of layers: the first hits of pixel centres are looked up, and the parts of colours and their variance summed.
    pub wants_layers: bool,
}

/// How a render is watched and ended.
pub trait Observer: Sync {
    /// Called before every pass with the samples that each pixel has and those that the pass would add; how many it shall add, 0 to end the render,
    /// which is complete then. The first pass always adds one.
    fn next_pass(&self, done: u32, planned: u32) -> u32 {
        let _ = done;
        planned
    }
    /// Called after every pass that was not stopped, with the picture so far.
    fn pass_done(&self, film: &Film) {
        let _ = film;
    }
    /// Called after every tile, from any thread, with the number of samples it added.
    fn samples_done(&self, samples: u64);
    /// Whether to end now, with the picture so far. Asked after every sample.
    fn should_stop(&self) -> bool;
}

impl Observer for AtomicBool {
    fn samples_done(&self, _samples: u64) {}

    fn should_stop(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}

/// Renders with the threads of the rayon pool in which it is called.
///
/// The picture comes in passes of 1, 15, 16, 32 and more samples a pixel, so that one that is stopped shows everything, and few go alone. The observer may
/// make them smaller. Where a noise is asked for, passes after the second are smaller, and pixels that have reached it are left out of them.
pub fn render(
    stage: &Stage,
    camera: &CameraFrame,
    options: &RenderOptions,
    observer: &impl Observer,
) -> Film {
    let mut film = Film::new(options.size, options.window);
    film.has_fragments = stage.trees.is_some();
    let pixel = PixelRenderer {
        stage,
        camera,
        options,
    };
    if options.wants_layers {
        // These rays are none of the samples', and are counted nowhere.
        film.tiles_apart().for_each(|tile| {
            let mut tracer = Tracer::new(stage.accelerator, false);
            tile.first_hits = vec![None; tile.sums.len()];
            tile.layers = vec![LayerSum::default(); tile.sums.len()];
            tile.mattes = TileMattes::new(tile.sums.len());
            for ((x, y), first) in tile.rect.pixels().zip(&mut tile.first_hits) {
                if observer.should_stop() {
                    break;
                }
                *first = pixel.first_hit(&mut tracer, x, y);
            }
        });
    }
    let ids = options.wants_layers.then(|| MatteIds::of(stage.scene));
    if options.noise.is_some() {
        film.tiles
            .iter_mut()
            .for_each(|tile| tile.adaptive = Adaptive::new(&tile.rect));
    }
    let (mut done, mut wanted, mut owed) = (0, options.samples, 0);
    while done < wanted && !observer.should_stop() {
        let planned = match done {
            0 => 1,
            // Completes what is traced together.
            1 => TOGETHER - 1,
            done if options.noise.is_some() => adaptive::pass(done, TOGETHER),
            done => done,
        };
        let planned = planned.min(wanted - done);
        let pass = observer.next_pass(done, planned).min(planned);
        if done > 0 && pass == 0 {
            wanted = done;
            break;
        }
        let end = done + pass.max(1);
        owed += film.open_pixels() * u64::from(end - done);
        film.tiles_apart().for_each(|tile| {
            let mut tracer = Tracer::new(stage.accelerator, options.counts_cost);
            tracer.covered = options.wants_layers.then(Vec::new);
            let mut together = Together::default();
            let mut added = 0;
            'tile: for (number, block) in tile.rect.tiles(BLOCK).iter().enumerate() {
                let share = tile.adaptive.share(number);
                if share.is_empty() {
                    continue;
                }
                for first in (done..end).step_by(TOGETHER as usize) {
                    if observer.should_stop() {
                        break 'tile;
                    }
                    let samples = first..end.min(first + TOGETHER);
                    together.trace(&pixel, &mut tracer, (block, share), samples);
                    let go_on = together.finish(&pixel, &mut tracer, |tracer, (x, y), sample| {
                        let index = tile.rect.index(x, y);
                        let sum = &mut tile.sums[index];
                        sum.add(&sample);
                        let seen = sample.color + sample.backdrop;
                        tile.adaptive.add(index, seen, sum.samples);
                        if let Some(layers) = tile.layers.get_mut(index) {
                            layers.add(&sample, sum.samples);
                        }
                        if let (Some(ids), Some(covered)) = (&ids, &mut tracer.covered) {
                            tile.mattes.add(index, ids, covered, sample.alpha);
                        }
                        if let Some(cost) = &mut tracer.cost {
                            sum.cost += std::mem::take(cost);
                        }
                        added += 1;
                        if observer.should_stop() {
                            ControlFlow::Break(())
                        } else {
                            ControlFlow::Continue(())
                        }
                    });
                    if go_on.is_break() {
                        break 'tile;
                    }
                }
            }
            tile.rays += tracer.rays;
            if let Some(goal) = options.noise.filter(|_| end >= LEAST_SAMPLES) {
                tile.adaptive.decide(&tile.rect, &tile.sums, end, goal);
            }
            observer.samples_done(added);
        });
        done = end;
        if !observer.should_stop() {
            observer.pass_done(&film);
        }
        if film.tiles.iter().all(|tile| tile.adaptive.is_done()) {
            wanted = done;
        }
    }
    film.is_complete = done >= wanted && film.samples() == owed;
    film
}

/// The cone of a sample. The samples of a pixel share it, so each stands for less than the whole; how much less is bounded, since
/// texels are not finer for it (as in pbrt-v4, section 10.1.4).
fn eye_cone(camera: &CameraFrame, options: &RenderOptions) -> RayCone {
    let rows = f64::from(options.size.1);
    let pixel = (2.0 * camera.half_size().1 / rows) as f32;
    let share = (1.0 / (options.samples as f32).sqrt()).max(0.125);
    if camera.is_perspective() {
        RayCone::of_pixel(pixel * share)
    } else {
        RayCone {
            width: pixel * share,
            spread: 0.0,
        }
    }
}

/// Renders single samples of single pixels.
pub struct PixelRenderer<'a> {
    /// The scene.
    pub stage: &'a Stage<'a>,
    /// The camera.
    pub camera: &'a CameraFrame,
    /// What to render.
    pub options: &'a RenderOptions,
}

impl PixelRenderer<'_> {
    /// One sample of a pixel.
    pub fn sample(&self, tracer: &mut Tracer, x: u32, y: u32, sample: u32) -> Sample {
        let (ray, sampler) = self.begin(x, y, sample);
        self.finish(tracer, &ray, sampler, eye_cone(self.camera, self.options))
    }

    /// What the eye sees along the ray of a sample.
    fn finish(&self, tracer: &mut Tracer, ray: &Ray, mut rest: Sampler, cone: RayCone) -> Sample {
        let hit = tracer.closest(ray, RayKind::Eye);
        let integrator = &self.options.integrator;
        integrator.sample(self.stage, tracer, (*ray, hit), cone, &mut rest)
    }

    /// What the ray through a pixel's centre, and the middle of the lens, meets first. Places where a material's alpha is zero do not count.
    pub fn first_hit(&self, tracer: &mut Tracer, x: u32, y: u32) -> Option<FirstHit> {
        let (x_center, y_center) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let mut ray = self.camera.ray(x_center, y_center, Some((x, y)));
        let (surface, material) = integrator::first_visible(
            self.stage,
            tracer,
            &mut ray,
            RayCone::default(),
            RayKind::Eye,
        )?;
        Some(FirstHit {
            hit: surface.hit,
            material: surface.material,
            depth: self.camera.depth(surface.position),
            distance: surface.hit.t * ray.direction.length(),
            position: surface.position,
            shading_normal: surface.shading_normal,
            geometric_normal: surface.geometric_normal,
            barycentric: surface.barycentric,
            uv: surface.uv,
            albedo: material.base_color,
            fragment: FragmentPoint::at(self.stage, &surface),
        })
    }
}
