//! Materials, cameras and comparisons of the tests beside this file.

use bspray::accel::AcceleratorKind;
use bspray::render::{Film, Integrator, PixelRenderer, RenderOptions, SkyMode, Stage, Tracer};
use bspray::scene::{AlphaMode, Camera, Material, Projection, Scene, TriangleMesh};
use glam::{DVec3, Vec3, Vec4};

use super::scenes::{film, level, options};

/// A camera without perspective whose picture is `height` model units high.
pub(crate) fn parallel(position: Vec3, focal_point: Vec3, view_up: Vec3, height: f32) -> Camera {
    Camera {
        name: String::new(),
        position,
        focal_point,
        view_up,
        projection: Projection::Orthographic { height },
    }
}

/// Looks down at a point of the ground from one unit above it.
pub(crate) fn down(x: f32, z: f32, height: f32) -> Camera {
    let place = Vec3::new(x, 0.0, z);
    parallel(place + Vec3::Y, place, Vec3::NEG_Z, height)
}

pub(crate) fn matt(color: Vec3) -> Material {
    Material {
        base_color: color.extend(1.0),
        ..Material::default()
    }
}

pub(crate) fn unlit(color: Vec4) -> Material {
    Material {
        base_color: color,
        unlit: true,
        alpha_mode: AlphaMode::Blend,
        ..Material::default()
    }
}

pub(crate) fn direct(scene: &Scene, size: (u32, u32), samples: u32) -> Film {
    let options = options(size, samples, Integrator::Direct);
    film(scene, AcceleratorKind::Bvh2, SkyMode::Off, &options)
}

/// Mean colour and coverage of each pixel.
pub(crate) fn means(film: &Film) -> Vec<(Vec3, f32)> {
    film.map(|pixel| (pixel.mean().color, pixel.mean().alpha))
}

#[track_caller]
pub(crate) fn assert_close(found: Vec3, want: DVec3, relative: f64) {
    let error = (found.as_dvec3() - want).abs() / want.abs();
    assert!(error.max_element() <= relative, "{found} is not {want}");
}

pub(crate) const COLOR: Vec3 = Vec3::new(0.5, 0.25, 0.75);

/// A plate much larger than what is seen of it.
pub(crate) fn plate() -> (TriangleMesh, Material) {
    (level(0.0, [-7.0, 9.0], [-8.0, 6.0]), matt(COLOR))
}

/// Mean and standard error of the samples of a picture's one pixel under direct light.
pub(crate) fn sampled(scene: &Scene, sky: SkyMode, samples: u32) -> (DVec3, DVec3) {
    sampled_by(Integrator::Direct, scene, sky, samples)
}

/// The same under any integrator.
pub(crate) fn sampled_by(
    integrator: Integrator,
    scene: &Scene,
    sky: SkyMode,
    samples: u32,
) -> (DVec3, DVec3) {
    let options = RenderOptions {
        seed: 3,
        ..options((1, 1), samples, integrator)
    };
    let accelerator = AcceleratorKind::Bvh2.build(scene);
    let stage = Stage::new(scene, &*accelerator, Vec3::Y, sky);
    let pixel = PixelRenderer {
        stage: &stage,
        camera: &scene.cameras[0].frame(1, 1).expect("a camera"),
        options: &options,
    };
    let mut tracer = Tracer::new(&*accelerator, false);
    let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
    for sample in 0..samples {
        let color = pixel.sample(&mut tracer, 0, 0, sample).color.as_dvec3();
        sum += color;
        squares += color * color;
    }
    let count = f64::from(samples);
    let mean = sum / count;
    let variance = (squares / count - mean * mean).max(DVec3::ZERO);
    (
        mean,
        DVec3::from_array((variance / count).to_array().map(f64::sqrt)),
    )
}

/// Asserts that `mean` is `want` within three standard errors, and that these are small enough to say something.
#[track_caller]
pub(crate) fn assert_sampled((mean, error): (DVec3, DVec3), want: DVec3) {
    let off = (mean - want).abs();
    // Rounding of single precision, where nothing varies.
    let allowed = 3.0 * error + 1e-5 * want.abs();
    assert!(off.cmple(allowed).all(), "{mean} +- {error} is not {want}");
    assert!((error / want).max_element() < 0.01, "{error} of {want}");
}

pub(crate) const SAMPLES: u32 = 4096;
