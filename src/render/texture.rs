//! Texture lookups: wrapping, bilinear filtering, the slot's colour space, and levels of detail.
//!
//! Coordinates and footprints are in units of the image's width and height (uv). A footprint is the width of the patch that a
//! lookup stands for: the level whose texels are as wide is looked up, between two levels both (Williams, "Pyramidal
//! Parametrics", 1983). It is isotropic: one width for u and v.

use glam::{Vec2, Vec4};
use rayon::prelude::*;

use super::mipmap::Pyramid;
use super::texel::{self, fetch};
pub(super) use crate::scene::ColorSpace;
use crate::scene::{Filter, Pixels, Scene, Texture, TextureRef, Wrap};

/// What is worked out of a scene's images for lookups: for each image, and each colour space in which materials use it, its levels of
/// detail, a third of the image's own memory.
#[derive(Debug, Default)]
pub struct Textures {
    /// By image: the levels of its sRGB and of its linear use, as [`ColorSpace`] numbers them.
    pyramids: Vec<[Option<Pyramid>; 2]>,
}

impl Textures {
    /// Builds the levels of all images that materials use, on rayon's current threads.
    pub fn new(scene: &Scene) -> Self {
        let mut is_used = vec![[false; 2]; scene.images.len()];
        for (space, texture) in scene.materials.iter().flat_map(|m| m.texture_slots()) {
            let sampled = &scene.textures[texture.texture as usize];
            let image = sampled.image as usize;
            if sampled.filter == Filter::Linear {
                is_used[image][place(space, scene.images[image].pixels.as_ref())] = true;
            }
        }
        let pyramid = |(image, is_used): (usize, [bool; 2])| {
            let image = &scene.images[image];
            [ColorSpace::Srgb, ColorSpace::Linear].map(|space| {
                let pixels = image.pixels.as_ref().filter(|_| is_used[space as usize]);
                pixels.map(|p| Pyramid::new(p, (image.width, image.height), space))
            })
        };
        let pyramids = is_used.into_par_iter().enumerate().map(pyramid).collect();
        Self { pyramids }
    }

    /// Bytes of all levels but the finest, which are the scene's.
    pub fn memory(&self) -> u64 {
        let pyramids = self.pyramids.iter().flatten().flatten();
        pyramids.map(Pyramid::memory).sum()
    }

    /// The texture's value at coordinates (`uv`: those of the material's set) over a patch of `width_uv`, in units of those
    /// coordinates, or white where its image has no pixels.
    ///
    /// Width 0 is the finest level: a bilinear mix of four texels. Textures that are sampled without a filter stay so. The
    /// scene must be the one that these levels were built from.
    pub fn lookup(
        &self,
        scene: &Scene,
        texture: &TextureRef,
        uv: Vec2,
        space: ColorSpace,
        width_uv: f32,
    ) -> Vec4 {
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
        // Written so that NaN counts as 0.
        if width_uv > 0.0
            && let Some(pyramid) = self.pyramid(sampled, pixels, space)
        {
            let level = level(texture, size, width_uv);
            if level > 0.0 {
                return pyramid.lookup((pixels, size), sampled, at, level);
            }
        }
        bilinear(pixels, size, sampled, at, space)
    }

    fn pyramid(&self, sampled: &Texture, pixels: &Pixels, space: ColorSpace) -> Option<&Pyramid> {
        if sampled.filter == Filter::Nearest {
            return None;
        }
        let pyramids = self.pyramids.get(sampled.image as usize)?;
        pyramids[place(space, Some(pixels))].as_ref()
    }
}

/// Where the levels of a use stand: floating-point images are linear in any slot.
fn place(space: ColorSpace, pixels: Option<&Pixels>) -> usize {
    match pixels {
        Some(Pixels::RgbaF32(_)) => ColorSpace::Linear as usize,
        _ => space as usize,
    }
}

/// The level whose texels have the area of a square of `width_uv`, by its binary logarithm; 0 or less for the finest.
fn level(texture: &TextureRef, size: (u32, u32), width_uv: f32) -> f32 {
    let texels = texture.transform.matrix2.determinant().abs() * size.0 as f32 * size.1 as f32;
    libm::log2f(width_uv) + 0.5 * libm::log2f(texels)
}

/// The value at coordinates of the image by the texture's own filter.
pub(super) fn bilinear(
    pixels: &Pixels,
    size: (u32, u32),
    sampled: &Texture,
    at: Vec2,
    space: ColorSpace,
) -> Vec4 {
    // In double precision: coordinates of a large floor run into the thousands.
    let (x, y) = (
        f64::from(at.x) * f64::from(size.0),
        f64::from(at.y) * f64::from(size.1),
    );
    let row = |y: i64| wrapped(y, size.1, sampled.wrap_v) as usize * size.0 as usize;
    let column = |x: i64| wrapped(x, size.0, sampled.wrap_u) as usize;
    if sampled.filter == Filter::Nearest {
        let index = row(y.floor() as i64) + column(x.floor() as i64);
        return fetch(pixels, index, space);
    }
    let (x, y) = (x - 0.5, y - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (fx, fy) = ((x - left) as f32, (y - top) as f32);
    let (left, top) = (left as i64, top as i64);
    let columns = [column(left), column(left.saturating_add(1))];
    let rows = [row(top), row(top.saturating_add(1))];
    let [a, b, c, d] = texel::fetch_four(pixels, columns, rows, space);
    a.lerp(b, fx).lerp(c.lerp(d, fx), fy)
}

fn wrapped(index: i64, size: u32, wrap: Wrap) -> u32 {
    // Most are inside, and a division of 64 bits takes longer than all the rest.
    if (0..i64::from(size)).contains(&index) {
        return index as u32;
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Image, Texture};

    /// The texture's value at coordinates on its finest level, or white where its image has no pixels.
    fn lookup(scene: &Scene, texture: &TextureRef, uv: Vec2, space: ColorSpace) -> Vec4 {
        Textures::default().lookup(scene, texture, uv, space, 0.0)
    }

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
