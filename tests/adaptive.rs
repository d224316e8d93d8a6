//! Samples and rays where they gain most: which pixels get them, that nothing but the block has a part in it, and that means stay what they are.

#[path = "support/scenes.rs"]
mod scenes;

use bspray::accel::AcceleratorKind;
use bspray::render::{
    Film, Integrator, LightSearch, NoiseGoal, PixelRect, PixelRenderer, RenderOptions, SkyMode,
    Stage, Tracer, render,
};
use bspray::scene::{Camera, Material, Projection, Scene};
use glam::{DVec3, Vec3};
use scenes::{film, level, options, point_light, quad};

const SIZE: (u32, u32) = (75, 41);

const PATH: Integrator = Integrator::Path {
    max_depth: 4,
    search: LightSearch::Both,
};

/// A floor under a small lamp, half of it behind a wall: a soft shadow, and a part that gets light from the wall alone.
fn yard() -> Scene {
    let lamp = Material {
        emissive: Vec3::new(20.0, 16.0, 9.0),
        ..Material::default()
    };
    let grey = Material {
        base_color: Vec3::splat(0.6).extend(1.0),
        ..Material::default()
    };
    let wall = quad([
        Vec3::new(0.2, 0.0, -2.0),
        Vec3::new(0.2, 0.0, 2.0),
        Vec3::new(0.2, 0.8, 2.0),
        Vec3::new(0.2, 0.8, -2.0),
    ]);
    let mut scene = scenes::scene([
        (level(0.0, [-3.0, 3.0], [-3.0, 3.0]), grey.clone()),
        (wall, grey),
        (level(2.0, [-1.5, -1.0], [-0.3, 0.2]), lamp),
    ]);
    let fill = point_light(Vec3::new(2.0, 3.0, 2.0), Vec3::splat(0.3));
    scene.lights.push(fill);
    scene.cameras.push(Camera {
        name: String::new(),
        position: Vec3::new(0.5, 3.0, 5.0),
        focal_point: Vec3::new(0.0, 0.2, 0.0),
        view_up: Vec3::Y,
        projection: Projection::Perspective { view_angle: 45.0 },
    });
    scene
}

fn adaptive(level: f32, samples: u32) -> RenderOptions {
    RenderOptions {
        noise: Some(NoiseGoal {
            level,
            exposure: 1.0,
        }),
        ..options(SIZE, samples, PATH)
    }
}

fn taken(scene: &Scene, options: &RenderOptions) -> Film {
    film(scene, AcceleratorKind::Bsp, SkyMode::Off, options)
}

/// Colour and samples of each pixel.
fn seen(film: &Film) -> Vec<(Vec3, u32)> {
    film.map(|pixel| (pixel.sum.color, pixel.sum.samples))
}

#[test]
fn threads_and_crops_along_blocks_change_nothing() {
    let (scene, options) = (yard(), adaptive(0.05, 96));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| seen(&taken(&scene, &options)))
    };
    let whole = on(1);
    assert!(whole == on(3));
    let window = PixelRect {
        x: 16,
        y: 8,
        width: 48,
        height: 24,
    };
    let crop = taken(&scene, &RenderOptions { window, ..options });
    let want: Vec<_> = window
        .pixels()
        .map(|(x, y)| whole[(y * SIZE.0 + x) as usize])
        .collect();
    assert!(seen(&crop) == want);
}

#[test]
fn pixels_have_the_first_of_their_samples_and_noisy_ones_more() {
    let (scene, options) = (yard(), adaptive(0.05, 160));
    let film = taken(&scene, &options);
    assert!(film.is_complete);
    let seen = seen(&film);
    let counts: Vec<u32> = seen.iter().map(|s| s.1).collect();
    let (least, most) = (counts.iter().min().copied(), film.most_samples());
    assert_eq!(
        least,
        Some(16),
        "what is black and what is beside the floor is clean at once"
    );
    assert!(
        most > 64 && film.samples() < 75 * 41 * 100,
        "{most} {}",
        film.samples()
    );
    let accelerator = AcceleratorKind::Bvh2.build(&scene);
    let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Off);
    let camera = scene.cameras[0].frame(SIZE.0, SIZE.1).expect("a camera");
    let pixel = PixelRenderer {
        stage: &stage,
        camera: &camera,
        options: &options,
    };
    let mut tracer = Tracer::new(&*accelerator, false);
    for (index, (x, y)) in options.window.pixels().enumerate().step_by(37) {
        let (color, count) = seen[index];
        let samples = (0..count).map(|sample| pixel.sample(&mut tracer, x, y, sample).color);
        assert!(
            samples.fold(Vec3::ZERO, |sum, c| sum + c) == color,
            "{x} {y}"
        );
    }
    // No pixel is left open but those that have all.
    let all = counts.iter().filter(|&&n| n == 160).count() as u64;
    assert!(film.open_pixels() <= all, "{} {all}", film.open_pixels());
}

#[test]
fn a_level_that_cannot_be_reached_is_the_uniform_picture() {
    let scene = yard();
    let uniform = taken(&scene, &options(SIZE, 40, PATH));
    let film = taken(&scene, &adaptive(1e-9, 40));
    // Pixels beside those that are black throughout, which have no noise at all, may end.
    let (mut ended, mut lit) = (0, 0);
    for (adaptive, uniform) in seen(&film).iter().zip(seen(&uniform)) {
        lit += usize::from(uniform.0 != Vec3::ZERO);
        if adaptive.1 == 40 {
            assert_eq!(*adaptive, uniform);
        } else {
            ended += usize::from(uniform.0 != Vec3::ZERO);
        }
    }
    assert!(ended * 50 < lit, "{ended} of {lit}");
}

/// Mean of all pixels over pictures of several seeds, and its standard error.
fn mean(scene: &Scene, options: &RenderOptions, seeds: u32) -> (DVec3, DVec3) {
    let means = (0..seeds).map(|seed| {
        let film = taken(scene, &RenderOptions { seed, ..*options });
        let colors = film.map(|pixel| pixel.mean().color.as_dvec3());
        colors.iter().sum::<DVec3>() / colors.len() as f64
    });
    let means: Vec<DVec3> = means.collect();
    let count = f64::from(seeds);
    let mean = means.iter().sum::<DVec3>() / count;
    let squares = means
        .iter()
        .map(|m| (*m - mean) * (*m - mean))
        .sum::<DVec3>();
    let error = squares / (count * (count - 1.0));
    (mean, DVec3::from_array(error.to_array().map(f64::sqrt)))
}

#[test]
fn the_mean_is_that_of_uniform_sampling() {
    let mut scene = yard();
    // Light by chance alone: most samples see nothing, a few much, which is where stopping too early shows.
    scene.materials[2].emissive *= 4.0;
    let chance = |options: RenderOptions| RenderOptions {
        size: (32, 24),
        window: PixelRect {
            x: 0,
            y: 0,
            width: 32,
            height: 24,
        },
        integrator: Integrator::Path {
            max_depth: 2,
            search: LightSearch::Surfaces,
        },
        ..options
    };
    let seeds = 48;
    let (uniform, error) = mean(&scene, &chance(options(SIZE, 64, PATH)), seeds);
    let (found, other) = mean(&scene, &chance(adaptive(0.3, 256)), seeds);
    let off = (found - uniform).abs();
    let both = (error * error + other * other).to_array();
    let allowed = DVec3::from_array(both.map(|v| 3.5 * v.sqrt()));
    println!("{found} {uniform} +- {error} {other}");
    assert!(off.cmple(allowed).all(), "{found} {uniform} {allowed}");
    assert!(
        (allowed / uniform).max_element() < 0.035,
        "{allowed} says little"
    );
}

#[test]
fn rays_that_are_saved_change_no_mean_and_less_than_the_noise() {
    let scene = yard();
    let options = RenderOptions {
        noise: None,
        ..adaptive(1.0, 16)
    };
    let accelerator = AcceleratorKind::Bsp.build(&scene);
    let stage = || Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Off);
    let (thrifty, exhaustive) = (stage(), stage().exhaustively());
    let camera = scene.cameras[0].frame(SIZE.0, SIZE.1).expect("a camera");
    let never = std::sync::atomic::AtomicBool::new(false);
    let take = |stage: &Stage, seed| {
        let film = render(stage, &camera, &RenderOptions { seed, ..options }, &never);
        let colors = film.map(|pixel| pixel.mean().color.as_dvec3());
        (colors, film.rays().shadow)
    };
    let seeds = 24;
    let pictures = (0..seeds).map(|seed| [take(&thrifty, seed), take(&exhaustive, seed)]);
    let pictures: Vec<_> = pictures.collect();
    let apart = |a: &[DVec3], b: &[DVec3]| {
        let off = a.iter().zip(b).map(|(a, b)| (*a - *b).abs().element_sum());
        off.sum::<f64>() / a.len() as f64
    };
    let of_rays = apart(&pictures[0][0].0, &pictures[0][1].0);
    let of_seeds = apart(&pictures[0][1].0, &pictures[1][1].0);
    println!("{of_rays} by rays, {of_seeds} by seeds");
    assert!(0.0 < of_rays && of_rays < 0.3 * of_seeds);
    let [saved, all] = [0, 1].map(|way| pictures.iter().map(|p| p[way].1).sum::<u64>());
    assert!(saved < all * 99 / 100, "{saved} of {all} shadow rays");
    // Of pairs with the same numbers, so that what both have in common says nothing.
    let mean = |colors: &[DVec3]| colors.iter().sum::<DVec3>() / colors.len() as f64;
    let steps: Vec<DVec3> = pictures
        .iter()
        .map(|[on, off]| mean(&on.0) - mean(&off.0))
        .collect();
    let step = steps.iter().sum::<DVec3>() / f64::from(seeds);
    let squares = steps
        .iter()
        .map(|s| (*s - step) * (*s - step))
        .sum::<DVec3>();
    let error = squares / f64::from(seeds * (seeds - 1));
    let allowed = DVec3::from_array(error.to_array().map(|v| 3.5 * v.sqrt()));
    let whole = mean(&pictures[0][1].0);
    assert!(
        step.abs().cmple(allowed).all(),
        "{step} of {whole}, {allowed}"
    );
    assert!(
        (allowed / whole).max_element() < 0.003,
        "{allowed} of {whole} says little"
    );
}

/// A long floor, seen from below lamps of very different powers, with a wall between each two of them.
fn street() -> Scene {
    let grey = Material {
        base_color: Vec3::splat(0.6).extend(1.0),
        ..Material::default()
    };
    let mut things = vec![(level(0.0, [-0.5, 24.5], [-1.5, 1.5]), grey.clone())];
    for i in 0..16_u8 {
        let x = f32::from(i) * 1.5;
        let power = 4.0 + f32::from(i * 7 % 5) * 6.0;
        let lamp = Material {
            emissive: Vec3::new(power, 9.0, 13.0 - power / 3.0),
            ..Material::default()
        };
        things.push((level(1.0, [x, x + 0.25], [-0.2, 0.3]), lamp));
        let corner = |y: f32, z: f32| Vec3::new(x + 0.9, y, z);
        let wall = [
            corner(0.0, -1.5),
            corner(0.0, 1.5),
            corner(1.4, 1.5),
            corner(1.4, -1.5),
        ];
        things.push((quad(wall), grey.clone()));
    }
    let mut scene = scenes::scene(things);
    scene.cameras.push(Camera {
        name: String::new(),
        position: Vec3::new(12.0, 0.9, 0.0),
        focal_point: Vec3::new(12.0, 0.0, 0.0),
        view_up: Vec3::NEG_Z,
        projection: Projection::Orthographic { height: 13.0 },
    });
    scene
}

#[test]
fn lamps_that_do_not_reach_a_place_are_asked_less_and_the_mean_stays() {
    let scene = street();
    let accelerator = AcceleratorKind::Bsp.build(&scene);
    let stage = || Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Off);
    let stages = [stage(), stage().with_emitters_by_power()];
    let camera = scene.cameras[0].frame(SIZE.0, SIZE.1).expect("a camera");
    let never = std::sync::atomic::AtomicBool::new(false);
    for integrator in [PATH, Integrator::Direct] {
        let seeds = 24_u32;
        let take = |stage: &Stage, seed| {
            let options = RenderOptions {
                seed,
                ..options(SIZE, 16, integrator)
            };
            let film = render(stage, &camera, &options, &never);
            film.map(|pixel| f64::from(pixel.mean().color.element_sum()))
        };
        let pictures = stages
            .each_ref()
            .map(|stage| (0..seeds).map(|seed| take(stage, seed)).collect::<Vec<_>>());
        let values = |way: usize, pixel: usize| pictures[way].iter().map(move |p| p[pixel]);
        let mean = |way, pixel| values(way, pixel).sum::<f64>() / f64::from(seeds);
        // Of each way, the sum of all mean pixels, and that of their variances.
        let [(ours, noise), (theirs, of_power)] = [0, 1].map(|way| {
            let variance = |pixel: usize| {
                let mean = mean(way, pixel);
                let squares = values(way, pixel)
                    .map(|v| (v - mean) * (v - mean))
                    .sum::<f64>();
                squares / f64::from(seeds - 1)
            };
            let pixels = 0..pictures[way][0].len();
            let means = pixels.clone().map(|pixel| mean(way, pixel)).sum::<f64>();
            (means, pixels.map(variance).sum::<f64>())
        });
        let n = f64::from(seeds);
        println!("{integrator:?}: {ours} {theirs}, noise {noise} {of_power}");
        assert!(8.0 * noise < of_power, "{integrator:?}: {noise} {of_power}");
        // Pixels are independent: the variance of their sum is the sum of theirs.
        let allowed = 3.5 * ((noise + of_power) / n).sqrt();
        assert!((ours - theirs).abs() < allowed, "{ours} {theirs} {allowed}");
        assert!(allowed < 0.02 * theirs, "{allowed} of {theirs} says little");
    }
}
