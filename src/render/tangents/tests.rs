//! Normals from maps, against the plane in which they are known.

use glam::{DAffine3, DVec3};

use super::*;
use crate::accel::AcceleratorKind;
use crate::geometry::Ray;
use crate::render::SkyMode;
use crate::scene::{Image, Instance, Material, Part, Pixels, Texture};

/// A square in the plane z = 0, of 2 x 2 units under one image, whose top left is (-1, 1), seen from above. `pixel` gives the colours of
/// an image of 32 x 32 pixels.
fn square(pixel: impl Fn(u32, u32) -> [f32; 4]) -> Scene {
    let pixels = (0..32 * 32).map(|i| pixel(i % 32, i / 32)).collect();
    let texture = TextureRef::default();
    Scene {
        meshes: vec![TriangleMesh {
            positions: [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| Vec3::new(x, y, 0.0))
                .to_vec(),
            uv_sets: vec![vec![Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 2,
                material: 0,
            }],
            ..TriangleMesh::default()
        }],
        instances: vec![Instance::new("square", 0, DAffine3::IDENTITY)],
        materials: vec![Material {
            normal_texture: Some(texture),
            bump: Some(Bump {
                texture,
                scale: 1.0,
            }),
            ..Material::default()
        }],
        textures: vec![Texture::default()],
        images: vec![Image {
            width: 32,
            height: 32,
            pixels: Some(Pixels::RgbaF32(pixels)),
            ..Image::default()
        }],
        ..Scene::default()
    }
}

/// What `of` gives where a ray meets the scene.
fn met<T>(scene: &Scene, ray: Ray, of: impl Fn(&Stage, &Surface) -> T) -> T {
    let accelerator = AcceleratorKind::Linear.build(scene);
    let stage = Stage::new(scene, &*accelerator, Vec3::Y, SkyMode::On);
    let hit = accelerator.closest_hit(&ray).expect("the square is there");
    of(&stage, &Surface::at(&stage, &ray, hit))
}

fn from_above(x: f32, y: f32) -> Ray {
    Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z)
}

/// A normal of a map, as its colour.
fn encoded(normal: Vec3) -> [f32; 4] {
    let c = normal * 0.5 + 0.5;
    [c.x, c.y, c.z, 1.0]
}

fn mapped(stage: &Stage, surface: &Surface) -> Vec3 {
    let texture = TextureRef::default();
    perturbed_normal(stage, surface, &texture, 1.0, surface.uv, 0.0)
}

#[test]
fn on_a_picture_that_hangs_upright_the_maps_normals_are_those_of_space() {
    // u grows with x, up in the image is y: the map's axes are those of the world.
    let normal = Vec3::new(0.48, 0.6, 0.64);
    let scene = square(|_, _| encoded(normal));
    for (x, y) in [(0.5, -0.3), (-0.7, 0.1)] {
        let found = met(&scene, from_above(x, y), mapped);
        assert!((found - normal).length() < 1e-5, "{found}");
    }
    // From behind, all is turned.
    let behind = Ray::new(Vec3::new(0.5, -0.3, -5.0), Vec3::Z);
    let found = met(&scene, behind, mapped);
    assert!((found + normal).length() < 1e-5, "{found}");
    // The scale counts for x and y only.
    let half = met(&scene, from_above(0.5, 0.5), |stage, surface| {
        let texture = TextureRef::default();
        perturbed_normal(stage, surface, &texture, 0.5, surface.uv, 0.0)
    });
    let expected = Vec3::new(0.24, 0.3, 0.64).normalize();
    assert!((half - expected).length() < 1e-5, "{half}");
}

#[test]
fn a_placement_takes_the_maps_normals_along() {
    let normal = Vec3::new(0.48, 0.6, 0.64);
    let mut scene = square(|_, _| encoded(normal));
    // Turned by a quarter about z: x becomes y, y becomes -x.
    let quarter = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
    scene.instances[0] = Instance::new("turned", 0, quarter);
    let found = met(&scene, from_above(0.2, 0.4), mapped);
    assert!((found - Vec3::new(-0.6, 0.48, 0.64)).length() < 1e-5);
    // Mirrored, what is to the right in the map is to the left.
    let mirror = DAffine3::from_scale(DVec3::new(-2.0, 2.0, 2.0));
    scene.instances[0] = Instance::new("mirrored", 0, mirror);
    let found = met(&scene, from_above(0.2, 0.4), mapped);
    assert!(
        (found - Vec3::new(-0.48, 0.6, 0.64)).length() < 1e-5,
        "{found}"
    );
}

#[test]
fn mirrored_coordinates_turn_the_tangent_and_corners_keep_their_own() {
    // Both halves of a face share one half of the image, and the vertices between them.
    let normal = Vec3::new(0.48, 0.6, 0.64);
    let mut scene = square(|_, _| encoded(normal));
    let mesh = &mut scene.meshes[0];
    mesh.positions = [(0.0, -1.0), (0.0, 1.0), (1.0, 0.0), (-1.0, 0.0)]
        .map(|(x, y)| Vec3::new(x, y, 0.0))
        .to_vec();
    mesh.uv_sets[0] = [(0.0, 1.0), (0.0, 0.0), (0.5, 0.5), (0.5, 0.5)]
        .map(|(u, v)| Vec2::new(u, v))
        .to_vec();
    mesh.triangles = vec![[0, 2, 1], [0, 1, 3]];
    let right = met(&scene, from_above(0.3, 0.1), mapped);
    assert!((right - normal).length() < 1e-5, "{right}");
    let left = met(&scene, from_above(-0.3, 0.1), mapped);
    assert!(
        (left - Vec3::new(-0.48, 0.6, 0.64)).length() < 1e-5,
        "{left}"
    );
    let made = Tangents::new(&scene);
    assert_eq!(made.meshes[0].vertices.len(), 4);
    assert_eq!(made.meshes[0].corners.len(), 2);
}

#[test]
fn the_files_tangents_come_before_made_ones() {
    let normal = Vec3::new(0.48, 0.6, 0.64);
    let mut scene = square(|_, _| encoded(normal));
    // The tangent along -y, the bitangent (0, 0, 1) x (0, -1, 0) = (1, 0, 0) turned to (-1, 0, 0).
    scene.meshes[0].tangents = vec![Vec4::new(0.0, -1.0, 0.0, -1.0); 4];
    let found = met(&scene, from_above(0.2, 0.4), mapped);
    assert!(
        (found - Vec3::new(-0.6, -0.48, 0.64)).length() < 1e-5,
        "{found}"
    );
    assert!(Tangents::new(&scene).meshes[0].vertices.is_empty());
}

#[test]
fn a_surface_finds_its_maps_and_its_patches() {
    let normal = Vec3::new(0.48, 0.6, 0.64);
    let mut scene = square(|_, _| encoded(normal));
    scene.materials[0].normal_scale = 0.5;
    scene.materials[0].clearcoat = Some(crate::scene::Clearcoat {
        factor: 1.0,
        texture: None,
        roughness: 0.0,
        roughness_texture: None,
        normal_texture: Some(TextureRef::default()),
        normal_scale: 1.0,
    });
    let ray = || from_above(0.5, 0.5);
    let found = met(&scene, ray(), |stage, s| s.mapped_normal(stage, 0.0));
    let expected = Vec3::new(0.24, 0.3, 0.64).normalize();
    assert!((found - expected).length() < 1e-5, "{found}");
    let found = met(&scene, ray(), |stage, s| s.coat_normal(stage, 0.0));
    assert!((found - normal).length() < 1e-5, "{found}");
    let patch = met(&scene, ray(), |stage, s| {
        s.patch(stage, &TextureRef::default(), 0.1)
    });
    assert!((patch.0 - Vec2::new(0.75, 0.25)).length() < 1e-6);
    assert!((patch.1 - 0.05).abs() < 1e-6, "{patch:?}");
    scene.materials[0] = Material::default();
    assert_eq!(
        met(&scene, ray(), |stage, s| s.mapped_normal(stage, 0.1)),
        Vec3::Z
    );
}

#[test]
fn without_coordinates_there_is_no_frame() {
    let mut scene = square(|_, _| encoded(Vec3::X));
    scene.meshes[0].uv_sets = vec![vec![Vec2::ONE; 4]];
    let found = met(&scene, from_above(0.2, 0.4), mapped);
    assert_eq!(found, Vec3::Z);
    let bumped = |stage: &Stage, s: &Surface| {
        let bump = stage.scene.materials[0].bump.expect("there");
        bumped_normal(stage, s, &bump, s.uv, 0.0)
    };
    assert_eq!(met(&scene, from_above(0.2, 0.4), bumped), Vec3::Z);
    scene.meshes[0].uv_sets.clear();
    assert_eq!(met(&scene, from_above(0.2, 0.4), mapped), Vec3::Z);
    assert_eq!(met(&scene, from_above(0.2, 0.4), bumped), Vec3::Z);
}

#[test]
fn a_ramp_of_heights_tilts_the_plane_by_its_slope() {
    // Heights grow by 24 from left to right and by 12 from the top down; linear in between, so differences are exact.
    let scene = square(|x, y| {
        let h = (x as f32 * 24.0 + y as f32 * 12.0) / 32.0;
        [h, 0.0, 0.0, 1.0]
    });
    // An image is 2 units long, and white is 2 / 96 high: over 2 units the plane rises by 24 * 2 / 96.
    let (by_x, by_y) = (24.0 / 96.0, -12.0 / 96.0);
    let expected = Vec3::new(-by_x, -by_y, 1.0).normalize();
    for width in [0.0, 0.05] {
        let bumped = |stage: &Stage, s: &Surface| {
            let bump = stage.scene.materials[0].bump.expect("there");
            bumped_normal(stage, s, &bump, s.uv, width)
        };
        let found = met(&scene, from_above(0.11, 0.23), bumped);
        assert!((found - expected).length() < 1e-4, "{found} {expected}");
        let behind = Ray::new(Vec3::new(0.11, 0.23, -5.0), Vec3::Z);
        let found = met(&scene, behind, bumped);
        assert!((found + expected).length() < 1e-4, "{found}");
    }
}
