//! What covers what, and how much of it: shadows, panes, masks, edges.

use std::f64::consts::PI;

use bspray::accel::AcceleratorKind;
use bspray::render::{Integrator, SkyMode};
use bspray::scene::{AlphaMode, Filter, Image, Material, Pixels, Sky, Texture, TextureRef};
use glam::{Vec3, Vec4};

use super::scenes::{film, level, options, point_light, quad, scene};
use super::setup::{COLOR, assert_close, direct, down, matt, means, parallel, plate, unlit};

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
        film.map(|pixel| {
            let (mean, first) = (pixel.mean(), pixel.first);
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
        width: 4,
        height: 1,
        pixels: Some(Pixels::Rgba8(alphas.map(texel).to_vec())),
        ..Image::default()
    });
    scene.textures.push(Texture {
        filter: Filter::Nearest,
        ..Texture::default()
    });
    scene.cameras.push(down(2.0, 0.5, 1.0));
    let film = direct(&scene, (4, 1), 16);
    let found = film.map(|pixel| {
        assert!((pixel.mean().alpha - 1.0).abs() < 1e-6);
        (pixel.mean().color, pixel.first.map(|f| f.hit.instance))
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
