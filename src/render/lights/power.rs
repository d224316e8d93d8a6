//! How much light each triangle of one material emits, by which triangles are chosen: area times radiance, up to a factor that all have in common.
//!
//! Where a texture says what glows, its mean over the triangle counts. That mean is estimated from a few places, so every triangle keeps some chance: an estimate of the light
//! is right in the mean whatever the chances are, as long as none is zero where light comes from.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::render::texture::{ColorSpace, Textures};
use crate::scene::{Material, Scene, TextureRef};

/// Share of the choices among textured triangles that go by area alone. Larger: more samples for black triangles; smaller: brighter dots where the estimate missed what glows.
const BY_AREA: f64 = 0.05;

/// Least mean of a texture over all its triangles that is believed: below, eight bits a texel round to nothing.
const LEAST_MEAN: f64 = 1.0 / 1024.0;

/// Most parts of a triangle's edge: the texture is looked up in the square of so many parts of the triangle. More would take longer than the light is worth.
const MOST_PARTS: u32 = 4;

/// The powers of triangles of one part of an instance's mesh, each given by its number and its area in world space.
pub(super) fn of_triangles(
    scene: &Scene,
    textures: &Textures,
    instance: u32,
    triangles: &[(u32, f32)],
) -> Vec<f64> {
    let Some(&(first, _)) = triangles.first() else {
        return Vec::new();
    };
    let material = &scene.materials[scene.material_of(instance, first) as usize];
    let plain = f64::from(material.emissive.element_sum());
    let Some(texture) = material.emissive_texture else {
        let power = |&(_, area): &(u32, f32)| f64::from(area) * plain;
        return triangles.iter().map(power).collect();
    };
    let power = |&(triangle, area): &(u32, f32)| {
        let uvs = uvs(scene, instance, triangle, &texture);
        f64::from(area) * mean(scene, textures, material, &texture, uvs)
    };
    let powers: Vec<f64> = triangles.par_iter().map(power).collect();
    let area: f64 = triangles.iter().map(|&(_, area)| f64::from(area)).sum();
    let radiance = (powers.iter().sum::<f64>() / area).max(plain * LEAST_MEAN);
    let by_both = |(power, &(_, area)): (f64, &(u32, f32))| {
        power * (1.0 - BY_AREA) + f64::from(area) * radiance * BY_AREA
    };
    powers.into_iter().zip(triangles).map(by_both).collect()
}

/// The texture coordinates of a triangle's corners; zero where it has none.
fn uvs(scene: &Scene, instance: u32, triangle: u32, texture: &TextureRef) -> [Vec2; 3] {
    let mesh = scene.mesh_of(instance);
    let set = mesh.uv_sets.get(texture.uv_set as usize);
    mesh.triangles[triangle as usize].map(|v| {
        let uv = set.and_then(|set| set.get(v as usize));
        uv.copied().unwrap_or_default()
    })
}

/// The mean of the emitted radiance over a triangle, summed over the colours: of the middles of small parts of it, each looked up with the footprint of its part.
fn mean(
    scene: &Scene,
    textures: &Textures,
    material: &Material,
    texture: &TextureRef,
    [a, b, c]: [Vec2; 3],
) -> f64 {
    let area = 0.5 * (b - a).perp_dot(c - a).abs();
    let image = &scene.images[scene.textures[texture.texture as usize].image as usize];
    let scale = texture.transform.matrix2.determinant().abs();
    let texels = area * scale * image.width as f32 * image.height as f32;
    // What is no number counts as one part.
    let parts = (texels.sqrt().ceil() as u32).clamp(1, MOST_PARTS);
    let width = area.sqrt() / parts as f32;
    let value = |i: f32, j: f32| {
        let uv = a + ((b - a) * i + (c - a) * j) / parts as f32;
        let texel = textures.lookup(scene, texture, uv, ColorSpace::Srgb, width);
        let radiance: Vec3 = material.emissive * texel.truncate();
        f64::from(radiance.element_sum())
    };
    const THIRD: f32 = 1.0 / 3.0;
    let mut sum = 0.0;
    for i in 0..parts {
        for j in 0..parts - i {
            let (x, y) = (i as f32, j as f32);
            sum += value(x + THIRD, y + THIRD);
            // The part beyond its long side, which points the other way.
            if i + j + 1 < parts {
                sum += value(x + 2.0 * THIRD, y + 2.0 * THIRD);
            }
        }
    }
    let mean = sum / f64::from(parts * parts);
    if mean.is_finite() { mean.max(0.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Filter, Image, Instance, Part, Pixels, Texture, TriangleMesh};
    use glam::DAffine3;

    /// Triangles with these texture coordinates, side by side, all of area 1, under a picture of 64 x 32 texels.
    fn scene(uvs: &[[Vec2; 3]], filter: Filter, texel: impl Fn(u32, u32) -> u8) -> Scene {
        let count = uvs.len() as u32;
        let place = |i: u32| Vec3::new((i / 3 * 9) as f32, 0.0, 0.0);
        let corner = |i: u32| [Vec3::ZERO, Vec3::X, Vec3::Y * 2.0][i as usize % 3] + place(i);
        let mesh = TriangleMesh {
            positions: (0..3 * count).map(corner).collect(),
            triangles: (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            uv_sets: vec![uvs.concat()],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: count,
                material: 0,
            }],
            ..TriangleMesh::default()
        };
        let pixel = |i: u32| [texel(i % 64, i / 64), 0, 0, 255];
        Scene {
            meshes: vec![mesh],
            instances: vec![Instance::new("", 0, DAffine3::IDENTITY)],
            materials: vec![Material {
                emissive: Vec3::new(2.0, 3.0, 5.0),
                emissive_texture: Some(TextureRef::default()),
                ..Material::default()
            }],
            textures: vec![Texture {
                filter,
                ..Texture::default()
            }],
            images: vec![Image {
                width: 64,
                height: 32,
                pixels: Some(Pixels::Rgba8((0..64 * 32).map(pixel).collect())),
                ..Image::default()
            }],
            ..Scene::default()
        }
    }

    fn powers(scene: &Scene) -> Vec<f64> {
        let triangles: Vec<_> = (0..scene.meshes[0].triangles.len() as u32)
            .map(|t| (t, 1.0))
            .collect();
        of_triangles(scene, &Textures::new(scene), 0, &triangles)
    }

    const HALF: [Vec2; 3] = [Vec2::ZERO, Vec2::new(0.4, 0.0), Vec2::new(0.0, 0.8)];

    fn moved(by: Vec2) -> [Vec2; 3] {
        HALF.map(|uv| uv + by)
    }

    #[test]
    fn power_is_the_mean_of_the_texture_over_the_triangle() {
        // A checkerboard of single texels, black and full: a half everywhere on its right side.
        let checkers = |x: u32, y: u32| u8::from(x >= 32 && (x + y).is_multiple_of(2)) * 255;
        let uvs = [moved(Vec2::new(0.05, 0.1)), moved(Vec2::new(0.55, 0.1))];
        let found = powers(&scene(&uvs, Filter::Linear, checkers));
        // Red alone, 2 times 1/2, and a share by area of the mean of both.
        let by_area = 0.05 * 0.5;
        assert!((found[1] - (0.95 + by_area)).abs() < 0.02, "{found:?}");
        assert!((found[0] - by_area).abs() < 0.01, "{found:?}");
        let ramp = |x: u32, _| (4 * x) as u8;
        let places = [Vec2::new(0.15, 0.1), Vec2::new(0.5, 0.05)];
        let uvs = places.map(moved);
        let found = powers(&scene(&uvs, Filter::Linear, ramp));
        // An independent mean: every texel whose middle is in the triangle, whose hypotenuse is u / 0.4 + v / 0.8 = 1.
        let mean = |by: Vec2| {
            let (mut sum, mut count) = (0.0, 0.0);
            for i in 0..64 * 32 {
                let uv = Vec2::new((i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5)
                    / Vec2::new(64.0, 32.0)
                    - by;
                if uv.min_element() > 0.0 && uv.x / 0.4 + uv.y / 0.8 < 1.0 {
                    let code = f64::from(ramp(i % 64, 0)) / 255.0;
                    sum += crate::picture::srgb::decode(code as f32);
                    count += 1.0;
                }
            }
            2.0 * f64::from(sum / count)
        };
        let means = places.map(mean);
        for (found, own) in found.iter().zip(means) {
            let want = own * 0.95 + (means[0] + means[1]) / 2.0 * 0.05;
            assert!((found / want - 1.0).abs() < 0.05, "{found} is not {want}");
        }
    }

    #[test]
    fn no_triangle_has_no_chance_and_the_black_ones_have_little() {
        let uvs = [
            moved(Vec2::new(0.05, 0.1)),
            moved(Vec2::new(0.55, 0.1)),
            [Vec2::NAN; 3],
            [Vec2::new(0.1, 0.1); 3],
        ];
        for filter in [Filter::Linear, Filter::Nearest] {
            let right = |x: u32, _| u8::from(x >= 32) * 255;
            let scene = scene(&uvs[..2], filter, right);
            let found = powers(&scene);
            let share = found[0] / (found[0] + found[1]);
            assert!(0.0 < share && share < 0.03, "{filter:?}: {found:?}");
        }
        for texel in [0, 1] {
            let found = powers(&scene(&uvs, Filter::Linear, |_, _| texel));
            assert!(found.iter().all(|&p| p > 0.0 && p.is_finite()), "{found:?}");
        }
    }
}
