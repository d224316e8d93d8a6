//! Texture lookups: wrapping, bilinear filtering, and the slot's colour space.

use glam::{Vec2, Vec4};

use crate::picture::srgb;
use crate::scene::{Filter, Pixels, Scene, TextureRef, Wrap};

/// What an image's numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColorSpace {
    /// sRGB-encoded colours; alpha is linear.
    Srgb,
    /// Plain numbers.
    Linear,
}

/// The texture's value at coordinates (`uv`: those of the material's set), or white where its image has no pixels.
pub(super) fn lookup(scene: &Scene, texture: &TextureRef, uv: Vec2, space: ColorSpace) -> Vec4 {
    let sampled = &scene.textures[texture.texture as usize];
    let image = &scene.images[sampled.image as usize];
    let Some(pixels) = &image.pixels else {
        return Vec4::ONE;
    };
    let size = (image.width, image.height);
    let at = texture.map(uv);
    if !at.is_finite() {
        return Vec4::ONE;
    }
    let texel = |x: i64, y: i64| {
        let x = wrapped(x, size.0, sampled.wrap_u);
        let y = wrapped(y, size.1, sampled.wrap_v);
        fetch(pixels, y as usize * size.0 as usize + x as usize, space)
    };
    // In double precision: coordinates of a large floor run into the thousands.
    let (x, y) = (
        f64::from(at.x) * f64::from(size.0),
        f64::from(at.y) * f64::from(size.1),
    );
    match sampled.filter {
        Filter::Nearest => texel(x.floor() as i64, y.floor() as i64),
        Filter::Linear => {
            let (x, y) = (x - 0.5, y - 0.5);
            let (left, top) = (x.floor(), y.floor());
            let (fx, fy) = ((x - left) as f32, (y - top) as f32);
            let (left, top) = (left as i64, top as i64);
            let upper = texel(left, top).lerp(texel(left.saturating_add(1), top), fx);
            let below = top.saturating_add(1);
            let lower = texel(left, below).lerp(texel(left.saturating_add(1), below), fx);
            upper.lerp(lower, fy)
        }
    }
}

fn wrapped(index: i64, size: u32, wrap: Wrap) -> u32 {
    let size = i64::from(size);
    let index = match wrap {
        Wrap::Repeat => index.rem_euclid(size),
        Wrap::ClampToEdge => index.clamp(0, size - 1),
        Wrap::MirroredRepeat => {
            let place = index.rem_euclid(2 * size);
            place.min(2 * size - 1 - place)
        }
    };
    index as u32
}

fn fetch(pixels: &Pixels, index: usize, space: ColorSpace) -> Vec4 {
    match pixels {
        Pixels::Rgba8(p) => {
            let [r, g, b, a] = p[index];
            let alpha = f32::from(a) / 255.0;
            match space {
                ColorSpace::Srgb => {
                    let [r, g, b] = [r, g, b].map(|c| srgb::LINEAR_OF_U8[usize::from(c)]);
                    Vec4::new(r, g, b, alpha)
                }
                ColorSpace::Linear => {
                    let [r, g, b] = [r, g, b].map(|x| f32::from(x) / 255.0);
                    Vec4::new(r, g, b, alpha)
                }
            }
        }
        Pixels::Rgba16(p) => {
            let [r, g, b, a] = p[index];
            let plain = |x: u16| f32::from(x) / 65535.0;
            match space {
                ColorSpace::Srgb => {
                    let [r, g, b] = [r, g, b].map(srgb::linear_of_u16);
                    Vec4::new(r, g, b, plain(a))
                }
                ColorSpace::Linear => Vec4::new(plain(r), plain(g), plain(b), plain(a)),
            }
        }
        Pixels::RgbaF32(p) => Vec4::from_array(p[index]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Image, Texture};

    /// A picture of 2 by 2: red is the column, green the row.
    fn scene(wrap: Wrap, filter: Filter) -> Scene {
        let pixels = Pixels::Rgba8(vec![
            [0, 0, 0, 255],
            [255, 0, 0, 255],
            [0, 255, 0, 255],
            [255, 255, 0, 0],
        ]);
        Scene {
            textures: vec![Texture {
                image: 0,
                wrap_u: wrap,
                wrap_v: wrap,
                filter,
            }],
            images: vec![Image {
                name: String::new(),
                width: 2,
                height: 2,
                pixels: Some(pixels),
            }],
            ..Scene::default()
        }
    }

    fn at(scene: &Scene, u: f32, v: f32) -> Vec4 {
        lookup(
            scene,
            &TextureRef::default(),
            Vec2::new(u, v),
            ColorSpace::Linear,
        )
    }

    #[test]
    fn nearest_takes_the_pixel_and_linear_mixes_four() {
        let nearest = scene(Wrap::Repeat, Filter::Nearest);
        assert_eq!(at(&nearest, 0.9, 0.1), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(at(&nearest, 0.1, 0.9), Vec4::new(0.0, 1.0, 0.0, 1.0));
        let linear = scene(Wrap::ClampToEdge, Filter::Linear);
        assert_eq!(at(&linear, 0.5, 0.5), Vec4::new(0.5, 0.5, 0.0, 0.75));
        assert_eq!(at(&linear, 0.625, 0.25), Vec4::new(0.75, 0.0, 0.0, 1.0));
    }

    #[test]
    fn beyond_the_edge_the_image_repeats_mirrors_or_stays() {
        let red = |wrap, u| at(&scene(wrap, Filter::Nearest), u, 0.1).x;
        assert_eq!(
            [0.25, 1.25, -0.25, 2.75].map(|u| red(Wrap::Repeat, u)),
            [0.0, 0.0, 1.0, 1.0]
        );
        assert_eq!(
            [1.25, 1.75, -0.25, -0.75].map(|u| red(Wrap::MirroredRepeat, u)),
            [1.0, 0.0, 0.0, 1.0]
        );
        assert_eq!([7.0, -7.0].map(|u| red(Wrap::ClampToEdge, u)), [1.0, 0.0]);
    }

    #[test]
    fn absurd_coordinates_are_survived() {
        let scene = scene(Wrap::MirroredRepeat, Filter::Linear);
        for u in [f32::MAX, f32::MIN, f32::NAN, f32::INFINITY, 1e30] {
            assert!(at(&scene, u, 0.5).is_finite());
        }
    }

    #[test]
    fn colours_are_decoded_and_alpha_is_not() {
        let pixels = Pixels::Rgba8(vec![[188, 188, 188, 128]]);
        let image = Image {
            name: String::new(),
            width: 1,
            height: 1,
            pixels: Some(pixels),
        };
        let scene = Scene {
            textures: vec![Texture::default()],
            images: vec![image],
            ..Scene::default()
        };
        let value = lookup(&scene, &TextureRef::default(), Vec2::ZERO, ColorSpace::Srgb);
        assert!((value.x - 0.5029).abs() < 1e-3 && (value.w - 128.0 / 255.0).abs() < 1e-6);
    }
}
