//! Paths: furnaces, form factors and slabs of glass against closed forms, and the ways to find a light against one another.

use std::f64::consts::PI;

use bspray::render::{Integrator, LightSearch, SkyMode};
use bspray::scene::{
    AlphaMode, Filter, Image, Material, Part, Pixels, Scene, Specular, Texture, TextureRef,
    Transmission, TriangleMesh, Volume,
};
use glam::{DVec3, Vec2, Vec3, Vec4};

use super::scenes::{level, scene};
use super::setup::{assert_sampled, down, matt, parallel, sampled, sampled_by};

/// Mean and standard error of the samples of a picture's one pixel under path tracing.
fn traced(scene: &Scene, max_depth: u32, samples: u32) -> (DVec3, DVec3) {
    traced_by(LightSearch::Both, scene, max_depth, samples)
}

fn traced_by(search: LightSearch, scene: &Scene, max_depth: u32, samples: u32) -> (DVec3, DVec3) {
    let path = Integrator::Path { max_depth, search };
    sampled_by(path, scene, SkyMode::Off, samples)
}

/// Without the reflection that a dielectric has by its index of refraction.
fn lambert(color: Vec3) -> Material {
    Material {
        specular: Some(Specular {
            factor: 0.0,
            texture: None,
            color: Vec3::ONE,
            color_texture: None,
        }),
        ..matt(color)
    }
}

fn glowing(radiance: Vec3) -> Material {
    Material {
        emissive: radiance,
        ..lambert(Vec3::ZERO)
    }
}

/// Smooth solid glass that leaves `color` of white light after `distance` model units.
fn glass(distance: f32, color: Vec3) -> Material {
    Material {
        roughness: 0.0,
        ior: 1.5,
        transmission: Some(Transmission {
            factor: 1.0,
            texture: None,
        }),
        volume: Some(Volume {
            thickness: 1.0,
            thickness_texture: None,
            attenuation_distance: distance,
            attenuation_color: color,
        }),
        ..matt(Vec3::ONE)
    }
}

/// A box around the origin, seen from inside and outside.
fn cube(half: Vec3) -> TriangleMesh {
    let corner = |x: f32, y: f32, z: f32| half * Vec3::new(x, y, z);
    let face = |a: Vec3, u: Vec3, v: Vec3| [a - u - v, a + u - v, a + u + v, a - u + v];
    let (x, y, z) = (
        corner(1.0, 0.0, 0.0),
        corner(0.0, 1.0, 0.0),
        corner(0.0, 0.0, 1.0),
    );
    let faces = [
        face(x, y, z),
        face(-x, z, y),
        face(y, z, x),
        face(-y, x, z),
        face(z, x, y),
        face(-z, y, x),
    ];
    let mut mesh = TriangleMesh {
        parts: vec![Part {
            first_triangle: 0,
            triangle_count: 12,
            material: 0,
        }],
        ..TriangleMesh::default()
    };
    for (i, face) in (0_u32..).zip(faces) {
        mesh.positions.extend(face);
        mesh.triangles
            .extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|c| 4 * i + c)));
    }
    mesh
}

/// Everything in a closed room that glows and reflects: the sum of the geometric series.
#[test]
fn a_room_that_glows_and_reflects_is_a_geometric_series() {
    let (glow, albedo) = (DVec3::new(0.5, 0.25, 1.0), DVec3::new(0.5, 0.25, 0.75));
    let walls = Material {
        emissive: glow.as_vec3(),
        ..lambert(albedo.as_vec3())
    };
    let mut scene = scene([(cube(Vec3::new(3.0, 2.0, 4.0)), walls)]);
    scene.cameras.push(down(0.5, 0.25, 1e-3));
    for bounces in [0, 1, 3] {
        let mut want = DVec3::ZERO;
        for bounce in 0..=bounces {
            want += glow * albedo.powf(f64::from(bounce));
        }
        assert_sampled(traced(&scene, bounces, 4096), want);
    }
    // Roulette, of paths and of their shadow rays, asks for more.
    assert_sampled(traced(&scene, 200, 8192), glow / (DVec3::ONE - albedo));
}

/// The form factor of a disc-like small square over a plate (differential element to a parallel square: Howell's catalogue, B-4).
#[test]
fn a_small_emitter_lights_by_its_form_factor() {
    let (scene, want) = square_emitter(0.25, 1.0);
    // At depth 1 the light's own black surface adds nothing.
    assert_sampled(traced(&scene, 1, 8192), want);
}

#[test]
fn an_emitter_that_is_there_by_a_share_sends_that_share_of_its_light_however_it_is_found() {
    let (scene, want) = square_emitter(1.0, 0.25);
    for search in [
        LightSearch::Both,
        LightSearch::Lights,
        LightSearch::Surfaces,
    ] {
        assert_sampled(traced_by(search, &scene, 1, 1 << 18), want);
    }
    assert_sampled(sampled(&scene, SkyMode::Off, 1 << 16), want);
}

/// A sheet of 64 squares, of which the four in the middle glow by a texture: as much light as a small square alone, and as little noise, since black triangles are hardly
/// ever chosen.
#[test]
fn a_mostly_black_texture_lights_as_what_is_lit_of_it() {
    let (mut scene, want) = square_emitter(0.25, 1.0);
    let is_lit = |i: usize| matches!((i % 8, i / 8), (3 | 4, 3 | 4));
    let texel = |i| [if is_lit(i) { 255 } else { 0 }; 4];
    scene.images.push(Image {
        width: 8,
        height: 8,
        pixels: Some(Pixels::Rgba8((0..64).map(texel).collect())),
        ..Image::default()
    });
    scene.textures.push(Texture {
        filter: Filter::Nearest,
        ..Texture::default()
    });
    let mesh = &mut scene.meshes[1];
    let height = mesh.positions[0].y;
    *mesh = TriangleMesh {
        uv_sets: vec![Vec::new()],
        parts: mesh.parts.clone(),
        ..TriangleMesh::default()
    };
    mesh.parts[0].triangle_count = 128;
    let corner = |i: u32| Vec2::new((i % 9) as f32, (i / 9) as f32) / 8.0;
    for uv in (0..81).map(corner) {
        mesh.uv_sets[0].push(uv);
        mesh.positions
            .push(Vec3::new(2.0 * uv.x - 1.0, height, 2.0 * uv.y - 1.0));
    }
    for first in (0..72).filter(|i| i % 9 < 8) {
        let square = [first, first + 1, first + 10, first + 9];
        mesh.triangles
            .extend([[0, 1, 2], [0, 2, 3]].map(|t: [usize; 3]| t.map(|c| square[c])));
    }
    scene.materials[1].emissive_texture = Some(TextureRef::default());
    for search in [LightSearch::Both, LightSearch::Lights] {
        assert_sampled(traced_by(search, &scene, 1, 8192), want);
    }
    assert_sampled(traced_by(LightSearch::Surfaces, &scene, 1, 1 << 19), want);
}

/// A plate below a square of light of half the width `half` and the coverage `alpha`, and the radiance of the plate.
fn square_emitter(half: f64, alpha: f32) -> (Scene, DVec3) {
    let radiance = DVec3::new(40.0, 20.0, 10.0);
    let color = Vec3::new(0.5, 0.25, 0.75);
    let height = 1.5_f64;
    let side = [-half as f32, half as f32];
    let light = level(height as f32, side, side);
    let ground = level(0.0, [-7.0, 9.0], [-8.0, 6.0]);
    let glowing = Material {
        base_color: Vec4::new(0.0, 0.0, 0.0, alpha),
        alpha_mode: AlphaMode::Blend,
        ..glowing(radiance.as_vec3())
    };
    let mut scene = scene([(ground, lambert(color)), (light, glowing)]);
    scene.cameras.push(down(0.0, 0.0, 1e-6));
    // Four times the factor of the quarter above whose corner the point lies.
    let a = half / height;
    let root = (1.0 + a * a).sqrt();
    let factor = 4.0 / (2.0 * PI) * 2.0 * (a / root * libm::atan(a / root));
    (
        scene,
        radiance * color.as_dvec3() * factor * f64::from(alpha),
    )
}

/// A slab of clear glass before a wall that glows: what is reflected at both faces, again and again, is lost, (1 - R) / (1 + R)
/// passes.
#[test]
fn a_slab_of_glass_passes_what_fresnel_says() {
    let glass = glass(0.5, Vec3::new(0.5, 0.25, 1.0));
    let wall = DVec3::new(2.0, 4.0, 6.0);
    let slab = cube(Vec3::new(4.0, 0.125, 4.0));
    let ground = level(-3.0, [-90.0, 90.0], [-90.0, 90.0]);
    let mut scene = scene([(slab, glass), (ground, glowing(wall.as_vec3()))]);
    scene.cameras.push(down(0.5, 0.25, 1e-3));
    let reflected = 0.04;
    // A way through is 0.25 long: half the attenuation distance.
    let left = DVec3::new(0.5, 0.25, 1.0).powf(0.5);
    let passed = left * (1.0 - reflected) * (1.0 - reflected)
        / (DVec3::ONE - left * left * reflected * reflected);
    assert_sampled(traced(&scene, 64, 20_000), wall * passed);
}

/// Looked at slantwise, the ray leaves the slab as it came, moved aside by what Snell says: half of what is seen is of another colour.
#[test]
fn a_slab_moves_rays_aside_by_snells_law() {
    let glass = glass(f32::INFINITY, Vec3::ONE);
    // Sine 0.6 outside, 0.4 inside; the slab is 0.5 thick.
    let (sine, inner) = (0.6_f64, 0.4_f64);
    let tangent = |s: f64| s / (1.0 - s * s).sqrt();
    // From (0, 1.25) on the slab's top at y = 0.25, down to the ground at y = -1.75.
    let lands = tangent(inner) * 0.5 + tangent(sine) * 1.5;
    let slab = cube(Vec3::new(4.0, 0.25, 4.0));
    let near = level(-1.75, [-90.0, lands as f32], [-90.0, 90.0]);
    let far = level(-1.75, [lands as f32, 90.0], [-90.0, 90.0]);
    for (offset, is_near) in [(-1e-3, true), (1e-3, false)] {
        let mut scene = scene([
            (slab.clone(), glass.clone()),
            (near.clone(), glowing(Vec3::X)),
            (far.clone(), glowing(Vec3::Z)),
        ]);
        let start = Vec3::new(offset, 0.25, 0.0);
        let direction = Vec3::new(sine as f32, -0.8, 0.0);
        scene
            .cameras
            .push(parallel(start - direction, start, Vec3::Z, 1e-5));
        let (mean, _) = traced(&scene, 64, 256);
        assert!(
            if is_near {
                mean.x > 0.8 && mean.z < 0.1
            } else {
                mean.z > 0.8 && mean.x < 0.1
            },
            "{offset}: {mean}"
        );
    }
}

/// A glossy floor under two emitters of very different size, with the sun: rays to lights alone, the path's own rays alone, and both together
/// have one mean.
#[test]
fn all_ways_to_find_lights_agree() {
    let floor = Material {
        roughness: 0.3,
        metallic: 0.5,
        ..matt(Vec3::new(0.75, 0.5, 0.25))
    };
    let mut scene = scene([
        (level(0.0, [-9.0, 9.0], [-9.0, 9.0]), floor),
        (
            level(1.5, [-0.25, 0.25], [-0.5, 0.5]),
            glowing(Vec3::new(9.0, 5.0, 3.0)),
        ),
        (
            level(4.0, [1.0, 9.0], [-8.0, 8.0]),
            glowing(Vec3::new(0.5, 1.0, 2.0)),
        ),
    ]);
    scene.cameras.push(parallel(
        Vec3::new(-2.0, 1.0, 0.25),
        Vec3::ZERO,
        Vec3::Y,
        1e-3,
    ));
    let [both, lights, surfaces] = [
        LightSearch::Both,
        LightSearch::Lights,
        LightSearch::Surfaces,
    ]
    .map(|search| traced_by(search, &scene, 3, 40_000));
    for (mean, error) in [lights, surfaces] {
        let off = (mean - both.0).abs();
        let allowed = 3.0 * (error * error + both.1 * both.1).powf(0.5);
        assert!(
            off.cmple(allowed).all(),
            "{mean} +- {error} is not {both:?}"
        );
        assert!((error / mean).max_element() < 0.02, "{error} of {mean}");
        assert!(
            both.1.cmple(error).all(),
            "both ways together are the surest: {both:?}, {error}"
        );
    }
}
