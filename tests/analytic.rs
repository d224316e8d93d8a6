//! Pictures whose values are known without rendering them: light on a plate, shadows, coverage.

#[path = "support/scenes.rs"]
mod scenes;

use std::f64::consts::PI;

use bspray::accel::AcceleratorKind;
use bspray::render::{Film, Integrator, PixelRenderer, RenderOptions, SkyMode, Stage, Tracer};
use bspray::scene::{
    AlphaMode, Camera, Filter, Image, Light, LightKind, Material, Pixels, Projection, Scene, Sky,
    Texture, TextureRef,
};
use glam::{DVec3, Vec3, Vec4};
use scenes::{film, level, options, point_light, quad, scene};

/// A camera without perspective whose picture is `height` model units high.
fn parallel(position: Vec3, focal_point: Vec3, view_up: Vec3, height: f32) -> Camera {
    Camera {
        name: String::new(),
        position,
        focal_point,
        view_up,
        projection: Projection::Orthographic { height },
    }
}

/// Looks down at a point of the ground from one unit above it.
fn down(x: f32, z: f32, height: f32) -> Camera {
    let place = Vec3::new(x, 0.0, z);
    parallel(place + Vec3::Y, place, Vec3::NEG_Z, height)
}

fn matt(color: Vec3) -> Material {
    Material {
        base_color: color.extend(1.0),
        ..Material::default()
    }
}

fn unlit(color: Vec4) -> Material {
    Material {
        base_color: color,
        unlit: true,
        alpha_mode: AlphaMode::Blend,
        ..Material::default()
    }
}

fn direct(scene: &Scene, size: (u32, u32), samples: u32) -> Film {
    let options = options(size, samples, Integrator::Direct);
    film(scene, AcceleratorKind::Bvh2, SkyMode::Off, &options)
}

/// Mean colour and coverage of each pixel.
fn means(film: &Film) -> Vec<(Vec3, f32)> {
    film.map(|sum, _| (sum.mean().color, sum.mean().alpha))
}

#[track_caller]
fn assert_close(found: Vec3, want: DVec3, relative: f64) {
    let error = (found.as_dvec3() - want).abs() / want.abs();
    assert!(error.max_element() <= relative, "{found} is not {want}");
}

const COLOR: Vec3 = Vec3::new(0.5, 0.25, 0.75);

/// A plate much larger than what is seen of it.
fn plate() -> (bspray::scene::TriangleMesh, Material) {
    (level(0.0, [-7.0, 9.0], [-8.0, 6.0]), matt(COLOR))
}

#[test]
fn a_point_light_follows_cosine_and_inverse_square() {
    let candela = DVec3::new(12.0, 7.0, 3.0);
    let light = DVec3::new(0.25, 2.0, -0.5);
    for (x, z) in [(0.25_f32, -0.5_f32), (1.5, 0.0), (-3.0, 2.0)] {
        let mut scene = scene([plate()]);
        scene
            .lights
            .push(point_light(light.as_vec3(), candela.as_vec3()));
        // So small that the sample's place in the pixel does not matter.
        scene.cameras.push(down(x, z, 1e-6));
        let to_light = light - DVec3::new(f64::from(x), 0.0, f64::from(z));
        let squared = to_light.length_squared();
        let irradiance = candela * (to_light.y / squared.sqrt() / squared);
        let (color, alpha) = means(&direct(&scene, (1, 1), 1))[0];
        assert_close(color, COLOR.as_dvec3() * irradiance / PI, 1e-5);
        assert!((alpha - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_directional_light_follows_the_cosine_and_comes_from_its_side() {
    let lux = Vec3::new(3.0, 2.0, 1.0);
    let travels = DVec3::new(1.0, -2.0, 0.5).normalize();
    for (sign, want) in [
        (1.0, COLOR.as_dvec3() * lux.as_dvec3() * -travels.y / PI),
        (-1.0, DVec3::ZERO),
    ] {
        let mut scene = scene([plate()]);
        scene.lights.push(Light {
            kind: LightKind::Directional,
            direction: (travels * sign).as_vec3(),
            ..point_light(Vec3::ZERO, lux)
        });
        scene.cameras.push(down(0.5, 0.5, 2.0));
        for (color, _) in means(&direct(&scene, (5, 3), 2)) {
            if want == DVec3::ZERO {
                assert_eq!(color, Vec3::ZERO);
            } else {
                assert_close(color, want, 1e-5);
            }
        }
    }
}

/// Mean and standard error of the samples of a picture's one pixel.
fn sampled(scene: &Scene, sky: SkyMode, samples: u32) -> (DVec3, DVec3) {
    let options = RenderOptions {
        seed: 3,
        ..options((1, 1), samples, Integrator::Direct)
    };
    let accelerator = AcceleratorKind::Bvh2.build(scene);
    let stage = Stage::new(scene, &*accelerator, Vec3::Y, sky);
    let filter = options.filter.sampler();
    let pixel = PixelRenderer {
        stage: &stage,
        camera: &scene.cameras[0].frame(1, 1).expect("a camera"),
        options: &options,
        filter: &filter,
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
fn assert_sampled((mean, error): (DVec3, DVec3), want: DVec3) {
    let off = (mean - want).abs();
    // Rounding of single precision, where nothing varies.
    let allowed = 3.0 * error + 1e-5 * want.abs();
    assert!(off.cmple(allowed).all(), "{mean} +- {error} is not {want}");
    assert!((error / want).max_element() < 0.01, "{error} of {want}");
}

const SAMPLES: u32 = 4096;

/// The sun of our own sky, as it is told in `render/lights.rs`: direction, irradiance across it, angular radius in radians.
fn sun() -> (DVec3, DVec3, f64) {
    let direction = DVec3::new(-0.45, 1.0, 0.55).normalize();
    (
        direction,
        DVec3::new(1.70, 1.60, 1.45),
        1.5_f64.to_radians(),
    )
}

#[test]
fn sky_and_sun_on_a_horizontal_plate() {
    let mut scene = scene([(level(0.0, [-1.0, 2.0], [-2.0, 1.0]), matt(Vec3::ONE))]);
    scene.cameras.push(down(0.5, 0.5, 0.1));
    let sky = Sky::daylight(Vec3::Y);
    let [horizon, zenith] = [sky.horizon, sky.zenith].map(|c| c.as_dvec3());
    // The integral of (horizon + (zenith - horizon) sqrt(h)) h over the hemisphere, h the height of a direction.
    let from_sky = (horizon * 0.2 + zenith * 0.8) * PI;
    let (direction, irradiance, radius) = sun();
    // The mean of the directions of a cap is (1 + cos) / 2 of its axis.
    let from_sun = irradiance * direction.y * (1.0 + libm::cos(radius)) / 2.0;
    let want = (from_sky + from_sun) / PI;
    assert_sampled(sampled(&scene, SkyMode::On, SAMPLES), want);
}

#[test]
fn sky_and_ground_on_a_wall_in_the_shade() {
    // A wall that looks along -z, away from the sun: half of what it sees is sky, half ground.
    let wall = quad([
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(0.0, 0.0, 0.0),
        Vec3::new(0.0, 3.0, 0.0),
        Vec3::new(1.0, 3.0, 0.0),
    ]);
    let mut scene = scene([(wall, matt(Vec3::ONE))]);
    let middle = Vec3::new(0.4, 1.7, 0.0);
    scene
        .cameras
        .push(parallel(middle - Vec3::Z, middle, Vec3::Y, 0.1));
    let sky = Sky::daylight(Vec3::Y);
    // By the midpoint rule over angles around the wall's normal.
    let (rings, sectors) = (500, 500);
    let mut irradiance = DVec3::ZERO;
    for ring in 0..rings {
        let theta = (f64::from(ring) + 0.5) / f64::from(rings) * PI / 2.0;
        let (sine, cosine) = (libm::sin(theta), libm::cos(theta));
        for sector in 0..sectors {
            let phi = (f64::from(sector) + 0.5) / f64::from(sectors) * 2.0 * PI;
            let direction = DVec3::new(sine * libm::cos(phi), sine * libm::sin(phi), -cosine);
            let radiance = sky.radiance(direction.as_vec3()).as_dvec3();
            irradiance += radiance * (cosine * sine);
        }
    }
    irradiance *= PI * PI / f64::from(rings * sectors);
    assert_sampled(sampled(&scene, SkyMode::On, SAMPLES), irradiance / PI);
}

/// The form factor from a differential element to a parallel rectangle `h` above it, one of whose corners is above the element.
///
/// Siegel and Howell, Thermal Radiation Heat Transfer, configuration C-11; signed in both lengths.
fn corner_factor(a: f64, b: f64, h: f64) -> f64 {
    let (x, y) = (a / h, b / h);
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / p * libm::atan(y / p) + y / q * libm::atan(x / q)) / (2.0 * PI)
}

fn rectangle_factor(x: [f32; 2], z: [f32; 2], h: f32) -> f64 {
    let [[x0, x1], [z0, z1]] = [x, z].map(|r| r.map(f64::from));
    let corner = |a, b| corner_factor(a, b, f64::from(h));
    corner(x1, z1) - corner(x0, z1) - corner(x1, z0) + corner(x0, z0)
}

#[test]
fn area_lights_have_their_form_factors() {
    // Above the origin and beside it, of different power, one looking up: emitters shine to both sides.
    let lamps = [
        ([-0.4, 0.8], [-0.3, 1.7], 1.5, Vec3::new(8.0, 4.0, 2.0)),
        ([-3.5, -2.0], [0.5, 1.0], 0.75, Vec3::new(1.0, 20.0, 5.0)),
    ];
    let mut want = DVec3::ZERO;
    let mut things = vec![plate()];
    for (x, z, h, radiance) in lamps {
        want += radiance.as_dvec3() * rectangle_factor(x, z, h);
        let lamp = Material {
            emissive: radiance,
            ..matt(Vec3::ZERO)
        };
        things.push((level(h, x, z), lamp));
    }
    let mut scene = scene(things);
    // From the side, below the lamps.
    scene.cameras.push(parallel(
        Vec3::new(5.0, 1.0, 0.0),
        Vec3::ZERO,
        Vec3::Y,
        1e-4,
    ));
    // A sample sees one lamp or the other, which varies much.
    let found = sampled(&scene, SkyMode::Off, 16 * SAMPLES);
    assert_sampled(found, COLOR.as_dvec3() * want);
    // What the eye sees of a lamp itself is its radiance.
    scene.cameras[0] = parallel(
        Vec3::new(0.2, 5.0, 0.3),
        Vec3::new(0.2, 0.0, 0.3),
        Vec3::X,
        0.1,
    );
    assert_sampled(sampled(&scene, SkyMode::Off, 16), DVec3::new(8.0, 4.0, 2.0));
}

#[test]
fn the_shadow_of_an_edge_is_where_it_must_be() {
    // The edge at x = 0.5, halfway up to the light, throws its shadow to x = 1.
    let (light, candela) = (Vec3::new(0.0, 4.0, 0.0), Vec3::splat(50.0));
    let screen = level(2.0, [-6.0, 0.5], [-6.0, 5.0]);
    let mut scene = scene([plate(), (screen, matt(Vec3::ONE))]);
    scene.lights.push(point_light(light, candela));
    // 64 columns of 2^-14 units; the shadow's edge is the line between two of them.
    let height = 8.0 / 16384.0;
    scene.cameras.push(down(1.0, 0.3, height));
    let film = direct(&scene, (64, 8), 16);
    let squared = 1.0 + 16.0 + 0.3 * 0.3;
    let lit = COLOR.as_dvec3() * (50.0 * 4.0 / (f64::sqrt(squared) * squared) / PI);
    let mut beside_edge = 0.0;
    for (index, (color, _)) in means(&film).into_iter().enumerate() {
        match index % 64 {
            column @ ..31 => assert_eq!(color, Vec3::ZERO, "column {column} is in the shadow"),
            31 => beside_edge += f64::from(color.x) / lit.x / 8.0,
            _ => assert_close(color, lit, 1e-3),
        }
    }
    // Shadow rays start 2.1e-5 units above the plate (`surface_offset_factors` of one 9 units wide), where the edge's
    // shadow is a quarter of that nearer to the light: 0.086 of a column.
    assert!(
        beside_edge < 0.1,
        "the edge is {beside_edge} of a column off"
    );
}

#[test]
fn half_transparent_panes_lie_over_one_another() {
    let pane = |y, color: Vec3| (level(y, [-3.0, 2.0], [-2.0, 3.0]), unlit(color.extend(0.5)));
    let (upper, lower) = (Vec3::new(0.8, 0.4, 0.1), Vec3::new(0.2, 0.6, 1.0));
    let mut scene = scene([pane(0.25, lower), pane(0.5, upper)]);
    scene.cameras.push(down(0.1, 0.2, 0.5));
    for sky in [SkyMode::Off, SkyMode::On] {
        let options = options((3, 2), 2, Integrator::Direct);
        let film = film(&scene, AcceleratorKind::Bvh2, sky, &options);
        let behind = match sky {
            SkyMode::On => Sky::daylight(Vec3::Y).ground * 0.25,
            _ => Vec3::ZERO,
        };
        film.map(|sum, first| {
            let mean = sum.mean();
            // All are sums of a few powers of two times the colours.
            assert!((mean.alpha - 0.75).abs() < 1e-7, "{}", mean.alpha);
            let want = upper * 0.5 + lower * 0.25;
            assert!(
                (mean.color - want).abs().max_element() < 1e-6,
                "{}",
                mean.color
            );
            assert!(
                (mean.backdrop - behind).abs().max_element() < 1e-6,
                "{}",
                mean.backdrop
            );
            assert_eq!(first.map(|f| f.hit.instance), Some(1));
        });
    }
}

#[test]
fn a_pane_lets_its_share_of_light_through() {
    let pane = Material {
        base_color: Vec4::new(1.0, 0.0, 0.0, 0.375),
        alpha_mode: AlphaMode::Blend,
        ..Material::default()
    };
    let mut scene = scene([plate(), (level(2.0, [-6.0, 6.0], [-6.0, 6.0]), pane)]);
    scene
        .lights
        .push(point_light(Vec3::new(0.0, 4.0, 0.0), Vec3::splat(50.0)));
    scene.cameras.push(down(0.0, 0.0, 1e-6));
    let (color, _) = means(&direct(&scene, (1, 1), 1))[0];
    let want = COLOR.as_dvec3() * (50.0 / 16.0 * (1.0 - 0.375) / PI);
    assert_close(color, want, 1e-5);
}

#[test]
fn a_mask_is_there_from_its_cutoff_on() {
    let alphas = [0, 127, 128, 255];
    let texel = |a: u8| [255, 255, 255, a];
    let masked = Material {
        base_color_texture: Some(TextureRef::default()),
        alpha_mode: AlphaMode::Mask {
            cutoff: 128.0 / 255.0,
        },
        ..unlit(Vec4::ONE)
    };
    let ground = unlit(Vec4::new(0.125, 0.25, 0.5, 1.0));
    let mut scene = scene([
        (level(0.0, [-1.0, 5.0], [-1.0, 2.0]), ground),
        (level(0.5, [0.0, 4.0], [0.0, 1.0]), masked),
    ]);
    scene.images.push(Image {
        name: String::new(),
        width: 4,
        height: 1,
        pixels: Some(Pixels::Rgba8(alphas.map(texel).to_vec())),
    });
    scene.textures.push(Texture {
        filter: Filter::Nearest,
        ..Texture::default()
    });
    scene.cameras.push(down(2.0, 0.5, 1.0));
    let film = direct(&scene, (4, 1), 16);
    let found = film.map(|sum, first| {
        assert!((sum.mean().alpha - 1.0).abs() < 1e-6);
        (sum.mean().color, first.map(|f| f.hit.instance))
    });
    let behind = (Vec3::new(0.125, 0.25, 0.5), Some(0));
    let mask = (Vec3::ONE, Some(1));
    assert_eq!(found, [behind, behind, mask, mask]);
}

#[test]
fn coverage_is_the_area_within_the_pixel() {
    // The half-plane above the line y = slope x + offset, in pixels from the middle of a picture of 3 x 3.
    for (slope, offset) in [(0.3_f64, 0.1_f64), (-0.9, 0.35), (0.0, -0.2)] {
        let on = |x: f64, up: f64| Vec3::new(x as f32, (slope * x + offset + up) as f32, 0.0);
        let sheet = quad([on(-4.0, 0.0), on(4.0, 0.0), on(4.0, 9.0), on(-4.0, 9.0)]);
        let mut scene = scene([(sheet, unlit(Vec4::ONE))]);
        scene
            .cameras
            .push(parallel(Vec3::Z, Vec3::ZERO, Vec3::Y, 3.0));
        let film = direct(&scene, (3, 3), 4096);
        for (index, (color, alpha)) in (0..).zip(means(&film)) {
            let (x, y) = (f64::from(index % 3) - 1.0, 1.0 - f64::from(index / 3));
            // The area above the line, column by column.
            let steps = 10_000;
            let covered = |i: i32| {
                let x = x - 0.5 + (f64::from(i) + 0.5) / f64::from(steps);
                (y + 0.5 - (slope * x + offset)).clamp(0.0, 1.0)
            };
            let want = (0..steps).map(covered).sum::<f64>() / f64::from(steps);
            let off = (f64::from(alpha) - want).abs();
            // 4,096 samples of a sequence are far better than random ones, whose standard error is 0.008.
            let allowed = if want * (1.0 - want) < 1e-9 {
                0.0
            } else {
                2e-3
            };
            assert!(
                off <= allowed,
                "({x}, {y}), slope {slope}: {alpha}, want {want}"
            );
            assert!(
                (color.x - alpha).abs() < 1e-6,
                "white, multiplied by coverage"
            );
        }
    }
}
