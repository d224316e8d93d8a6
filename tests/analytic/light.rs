//! Light on a plate: punctual lights, area lights, sky and sun, against what the lighting engineer's formulas say.

use std::f64::consts::PI;

use bspray::render::SkyMode;
use bspray::scene::{Light, LightKind, Material, Sky};
use glam::{DVec3, Vec3};

use super::scenes::{level, point_light, quad, scene};
use super::setup::{
    COLOR, SAMPLES, assert_close, assert_sampled, direct, down, matt, means, parallel, plate,
    sampled,
};

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

/// The sun of our own sky, as it is told in `render/lights.rs`: direction, irradiance across it, angular radius in radians.
fn sun() -> (DVec3, DVec3, f64) {
    let direction = DVec3::new(-0.45, 1.0, 0.55).normalize();
    (
        direction,
        DVec3::new(2.10, 1.98, 1.80),
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
fn a_sun_of_the_file_has_our_sky_and_takes_the_place_of_our_sun() {
    let mut scene = scene([(level(0.0, [-1.0, 2.0], [-2.0, 1.0]), matt(Vec3::ONE))]);
    scene.cameras.push(down(0.5, 0.5, 0.1));
    let (lux, travels) = (
        Vec3::new(3.0, 2.0, 1.0),
        DVec3::new(1.0, -2.0, 0.5).normalize(),
    );
    scene.lights.push(Light {
        kind: LightKind::Directional,
        direction: travels.as_vec3(),
        ..point_light(Vec3::ZERO, lux)
    });
    let sky = Sky::daylight(Vec3::Y);
    let [horizon, zenith] = [sky.horizon, sky.zenith].map(|c| c.as_dvec3());
    let from_sky = (horizon * 0.2 + zenith * 0.8) * PI;
    let want = (from_sky + lux.as_dvec3() * -travels.y) / PI;
    for mode in [SkyMode::Auto, SkyMode::On] {
        assert_sampled(sampled(&scene, mode, SAMPLES), want);
    }
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
