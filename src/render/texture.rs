//! Texture lookups: wrapping, bilinear filtering, the slot's colour space, and levels of detail.
//!
//! Coordinates and footprints are in units of the image's width and height (uv). A footprint is the width of the patch that a
//! lookup stands for: the level whose texels are as wide is looked up, between two levels both (Williams, "Pyramidal
//! Parametrics", 1983). It is isotropic: one width for u and v.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{Vec2, Vec4};
use rayon::prelude::*;

pub(super) use crate::scene::ColorSpace;
use crate::scene::{
    Filter, Image, Pixels, Pyramid, Scene, Texture, TextureRef, Wrap, fetch, fetch_four,
};

/// What is worked out of a scene's images for lookups: for each image, and each colour space in which materials use it, its levels of
/// detail, a third of the image's own memory. They are built when the first lookup wants one of them, since many images are never seen from far
/// enough, or not at all.
#[derive(Debug, Default)]
pub struct Textures {
    images: Vec<ImageLevels>,
}

/// The levels of an image, in the two ways in which it may be used.
#[derive(Debug, Default)]
struct ImageLevels {
    /// Of its sRGB and of its linear use, as [`ColorSpace`] numbers them; nothing for a use that no material makes of it.
    pyramids: [Option<OnceLock<Pyramid>>; 2],
    /// Whether a texel was looked up.
    is_used: AtomicBool,
}

impl Textures {
    /// Finds out which levels materials may want.
    pub fn new(scene: &Scene) -> Self {
        let mut images: Vec<ImageLevels> = Vec::new();
        images.resize_with(scene.images.len(), ImageLevels::default);
        for (space, texture) in scene.materials.iter().flat_map(|m| m.texture_slots()) {
            let sampled = &scene.textures[texture.texture as usize];
            if sampled.filter == Filter::Linear
                && let Some(pixels) = &scene.images[sampled.image as usize].pixels
            {
                let levels = &mut images[sampled.image as usize];
                levels.pyramids[meaning(space, pixels) as usize].get_or_insert_default();
            }
        }
        Self { images }
    }

    /// Builds the levels that materials may want, of all images at the same time, on rayon's current threads.
    pub fn build_all(&self, scene: &Scene) {
        let images = self.images.par_iter().zip(&scene.images);
        images.for_each(|(levels, image)| {
            for space in [ColorSpace::Srgb, ColorSpace::Linear] {
                if let (Some(once), Some(pixels)) = (levels.pyramid(space), &image.pixels) {
                    once.get_or_init(|| Pyramid::new(pixels, image.size(), space));
                }
            }
        });
    }

    /// Bytes of all levels that are built, without the finest, which are the scene's.
    pub fn memory(&self) -> u64 {
        let pyramids = self.images.iter().flat_map(|i| &i.pyramids).flatten();
        let built = pyramids.filter_map(OnceLock::get);
        built.map(Pyramid::memory).sum()
    }

    /// Bytes of all levels that may be built.
    pub fn whole_memory(&self, scene: &Scene) -> u64 {
        let images = self.images.iter().zip(&scene.images);
        let bytes = |(levels, image): (&ImageLevels, &Image)| {
            let uses = levels.pyramids.iter().flatten().count() as u64;
            let pixels = image.pixels.as_ref();
            uses * pixels.map_or(0, |p| Pyramid::memory_of(p, image.size()))
        };
        images.map(bytes).sum()
    }

    /// Whether a texel of an image was looked up.
    pub fn is_used(&self, image: u32) -> bool {
        let levels = self.images.get(image as usize);
        levels.is_some_and(|l| l.is_used.load(Ordering::Relaxed))
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
        let at = texture.map(uv);
        if !at.is_finite() {
            return Vec4::ONE;
        }
        // Written so that NaN counts as 0.
        let levels = self.images.get(sampled.image as usize);
        if let Some(levels) = levels
            && !levels.is_used.load(Ordering::Relaxed)
        {
            levels.is_used.store(true, Ordering::Relaxed);
        }
        if width_uv > 0.0
            && sampled.filter == Filter::Linear
            && let Some(once) = levels.and_then(|l| l.pyramid(meaning(space, pixels)))
        {
            let level = level(texture, (image.width, image.height), width_uv);
            let below = level - image.finest as f32;
            if below > 0.0 {
                let space = meaning(space, pixels);
                let new = || Pyramid::new(pixels, image.size(), space);
                let pyramid = once.get_or_init(new);
                let finest = (pixels, image.size());
                return trilinear(finest, pyramid, sampled, at, below, space);
            }
        }
        bilinear(pixels, image.size(), sampled, at, space)
    }
}

impl ImageLevels {
    fn pyramid(&self, space: ColorSpace) -> Option<&OnceLock<Pyramid>> {
        self.pyramids[space as usize].as_ref()
    }
}

/// What an image's numbers mean in a slot: those of floating-point images are linear in any.
fn meaning(space: ColorSpace, pixels: &Pixels) -> ColorSpace {
    match pixels {
        Pixels::RgbaF32(_) => ColorSpace::Linear,
        _ => space,
    }
}

/// The value at coordinates `at` of the image (0 to 1 along each side), `level` levels (above 0) below the finest that is kept, mixed of those beside it.
fn trilinear(
    finest: (&Pixels, (u32, u32)),
    pyramid: &Pyramid,
    sampled: &Texture,
    at: Vec2,
    level: f32,
    space: ColorSpace,
) -> Vec4 {
    let levels = pyramid.levels();
    let level = level.min(levels.len() as f32);
    let finer = level as usize;
    let value = |index: usize| {
        let (pixels, size) = match index.checked_sub(1) {
            None => finest,
            Some(below) => {
                let level = &levels[below.min(levels.len() - 1)];
                (&level.pixels, level.size)
            }
        };
        bilinear(pixels, size, sampled, at, space)
    };
    let share = level - finer as f32;
    if share <= 0.0 {
        return value(finer);
    }
    value(finer).lerp(value(finer + 1), share)
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
    let [a, b, c, d] = fetch_four(pixels, columns, rows, space);
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
    use crate::scene::Texture;

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
                width: 2,
                height: 2,
                pixels: Some(pixels),
                ..Image::default()
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
            width: 1,
            height: 1,
            pixels: Some(pixels),
            ..Image::default()
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
