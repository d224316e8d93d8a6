//! Environments against quadrature over the sphere.

use std::f64::consts::{PI, TAU};

use glam::Vec3;

use super::distribution::tests::random;
use super::*;

/// A picture of 16 x 8 pixels: dark grey, with one bright pixel.
fn one_bright(x: u32, y: u32) -> Image {
    let mut pixels = vec![[0.01, 0.01, 0.01, 1.0]; 16 * 8];
    pixels[(y * 16 + x) as usize] = [500.0, 300.0, 100.0, 1.0];
    Image {
        width: 16,
        height: 8,
        pixels: Some(Pixels::RgbaF32(pixels)),
        ..Image::default()
    }
}

fn image(x: u32, y: u32, up: Vec3, rotation: f64) -> Environment {
    Environment::image(one_bright(x, y), up, rotation, 2.0).expect("it has pixels")
}

/// The integral of a function over the sphere by the midpoint rule.
fn integral(of: impl Fn(Vec3) -> Vec3) -> Vec3 {
    let (n, m) = (1200, 600);
    let axes = Axes::new(Vec3::new(0.3, 1.0, 0.2), 10.0);
    let mut sum = DVec3::ZERO;
    for y in 0..m {
        let polar = PI * (f64::from(y) + 0.5) / f64::from(m);
        for x in 0..n {
            let place = Place {
                turn: (f64::from(x) + 0.5) / f64::from(n),
                cosine: libm::cos(polar),
            };
            sum += of(axes.direction(place)).as_dvec3() * libm::sin(polar);
        }
    }
    (sum * (PI / f64::from(m) * TAU / f64::from(n))).as_vec3()
}

fn estimate(environment: &Environment, weight: impl Fn(Vec3) -> f32) -> Vec3 {
    let n = 1_000_000;
    let mut numbers = random(5);
    let mut sum = DVec3::ZERO;
    for _ in 0..n {
        if let Some(s) = environment.sample(numbers()) {
            assert!((s.direction.length() - 1.0).abs() < 1e-5);
            let density = environment.density(s.direction);
            assert!((s.density / density - 1.0).abs() < 1e-5);
            sum += (s.radiance * weight(s.direction) / s.density).as_dvec3();
        }
    }
    (sum / f64::from(n)).as_vec3()
}

fn all() -> Vec<(&'static str, Environment)> {
    let sky = Sky::daylight(Vec3::Z);
    let day = Daylight::default();
    vec![
        ("constant", Environment::constant(Vec3::new(1.0, 2.0, 3.0))),
        ("image", image(5, 2, Vec3::Y, 30.0)),
        ("image with a bright pole", image(3, 0, Vec3::Z, 200.0)),
        ("studio", Environment::studio(sky, false)),
        (
            "daylight without the sun",
            Environment {
                sun: None,
                sun_share: 0.0,
                ..Environment::daylight(&day, Vec3::Y)
            },
        ),
    ]
}

#[test]
fn densities_integrate_to_one() {
    for (name, environment) in all() {
        let sum = integral(|d| Vec3::splat(environment.density(d))).x;
        assert!((sum - 1.0).abs() < 2e-3, "{name}: {sum}");
    }
}

#[test]
fn estimates_of_irradiance_agree_with_quadrature() {
    let normal = Vec3::new(-0.3, 0.8, 0.5).normalize();
    let cosine = |d: Vec3| d.dot(normal).max(0.0);
    for (name, environment) in all() {
        let exact = integral(|d| environment.radiance(d) * cosine(d));
        let found = estimate(&environment, cosine);
        let error = ((found - exact) / exact).abs().max_element();
        assert!(error < 4e-3, "{name}: {found} instead of {exact}");
        let whole = integral(|d| environment.radiance(d));
        let error = ((estimate(&environment, |_| 1.0) - whole) / whole).abs();
        assert!(error.max_element() < 4e-3, "{name}: all light, {error}");
    }
}

#[test]
fn the_suns_light_is_found_beside_the_skys() {
    let sky = Sky::daylight(Vec3::Y);
    let to_sun = Vec3::new(-0.45, 1.0, 0.55).normalize();
    let light = Vec3::new(2.10, 1.98, 1.80);
    let without = Environment::studio(sky, false);
    let with = Environment::studio(sky, true);
    let floor = |d: Vec3| d.y.max(0.0);
    let sun = estimate(&with, floor) - estimate(&without, floor);
    assert!((sun - light * to_sun.y).abs().max_element() < 0.02, "{sun}");
    let one = with.sample_sun([0.3, 0.6]).expect("it shines");
    let irradiance = one.radiance / one.density;
    assert!(
        (irradiance - light).abs().max_element() < 1e-4,
        "{irradiance}"
    );
    assert!(without.sample_sun([0.3, 0.6]).is_none());
    let far = with.sample_sky([0.3, 0.6]).expect("it shines");
    assert_eq!(far, without.sample([0.3, 0.6]).expect("it shines"));
    assert_eq!(with.backdrop(to_sun), sky.radiance(to_sun));
    assert!(with.radiance(to_sun).x > 900.0);
}

#[test]
fn samples_fall_where_the_light_is() {
    // The bright pixel sends nearly all of the light, and takes nearly all of the samples; some fall where it fades out.
    let environment = image(5, 2, Vec3::Y, 0.0);
    let near = |numbers| {
        let s = environment.sample(numbers).expect("not black");
        luminance(s.radiance) > 1.0
    };
    let count = (0..100).filter(|i| near([(*i as f32 + 0.5) / 100.0, 0.37]));
    assert!(count.count() > 80);
    for (name, environment) in all() {
        for i in 0..1000 {
            // Fibonacci's spiral.
            let cosine = 1.0 - (f64::from(i) + 0.5) / 500.0;
            let turn = (f64::from(i) * 0.618_033_988_75).fract();
            let d = environment.axes.direction(Place { turn, cosine });
            let is_dark = environment.radiance(d) == Vec3::ZERO;
            assert!(is_dark || environment.density(d) > 0.0, "{name}");
        }
    }
}

#[test]
fn pictures_lie_around_the_scene_as_in_blender_and_turn_counter_clockwise() {
    // The brightest direction, by up and rotation, for the pixel behind a quarter of the width.
    let brightest = |up, rotation| {
        let environment = image(4, 4, up, rotation);
        let directions = (0..64).flat_map(|i| {
            let turn = f64::from(i) / 64.0;
            let axes = Axes::new(up, 0.0);
            [axes.direction(Place {
                turn,
                cosine: -0.15,
            })]
        });
        let value = |d: &Vec3| environment.radiance(*d).x;
        let best = directions.max_by(|a, b| value(a).total_cmp(&value(b)));
        best.expect("there are some")
    };
    // A quarter, and half a pixel: u = 0.28, between -Z and the middle at +X.
    let near = |found: Vec3, expected: Vec3| {
        assert!(found.dot(expected) > 0.93, "{found} is not near {expected}");
    };
    near(brightest(Vec3::Y, 0.0), Vec3::NEG_Z);
    near(brightest(Vec3::Y, 90.0), Vec3::NEG_X);
    near(brightest(Vec3::Y, -90.0), Vec3::X);
    near(brightest(Vec3::Z, 0.0), Vec3::Y);
    near(brightest(Vec3::Z, 90.0), Vec3::NEG_X);
    // Row 0 is overhead.
    let top = image(0, 0, Vec3::Z, 0.0);
    assert!(top.radiance(Vec3::new(-0.2, 0.0, 1.0).normalize()).x > 10.0);
}

#[test]
fn black_light_and_odd_directions_are_survived() {
    assert_eq!(Environment::constant(Vec3::ZERO).sample([0.3, 0.4]), None);
    let black = Image {
        pixels: Some(Pixels::Rgba8(vec![[0, 0, 0, 255]; 128])),
        ..one_bright(0, 0)
    };
    let black = Environment::image(black, Vec3::Y, 0.0, 1.0).expect("it has pixels");
    assert_eq!(black.sample([0.3, 0.4]), None);
    assert!(Environment::image(Image::default(), Vec3::Y, 0.0, 1.0).is_none());
    for (name, environment) in all() {
        for d in [
            Vec3::Y,
            Vec3::NEG_Y,
            Vec3::Z,
            Vec3::NEG_Z,
            Vec3::NAN,
            Vec3::ZERO,
        ] {
            let finite = environment.density(d).is_finite() || d.is_nan();
            assert!(finite, "{name} {d}");
            assert!(
                d.is_nan() || environment.radiance(d).is_finite(),
                "{name} {d}"
            );
        }
        for numbers in [
            [0.0, 0.0],
            [0.999_999_94, 0.999_999_94],
            [0.0, 0.999_999_94],
        ] {
            assert!(environment.sample(numbers).is_some(), "{name}");
        }
    }
}
