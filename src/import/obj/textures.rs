//! The `map_` statements of MTL: options, files, and the scene's images and textures.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{Affine2, DVec3, Vec2, Vec3};

use super::super::budget::Budget;
use super::super::{TextureNeeds, images};
use super::files::Finder;
use super::mtl::MtlFile;
use super::text::before_comment;
use crate::scene::{Image, Pixels, Texture, TextureRef, UvTransform, Wrap};

/// A `map_` statement taken apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// The file's name.
    pub(super) name: String,
    /// `-s`: how often the image repeats, along u and v.
    pub(super) scale: Vec2,
    /// `-o`: where it starts.
    pub(super) offset: Vec2,
    /// `-clamp on`.
    pub(super) is_clamped: bool,
    /// `-bm`: factor on heights.
    pub(super) bump_factor: f32,
    /// Whether there are options that change the picture and are not followed (`-mm`, `-t`).
    pub(super) has_unread_options: bool,
}

impl Map {
    /// Reads what stands behind the keyword.
    pub(super) fn parse(text: &str) -> Self {
        let mut map = Self {
            name: String::new(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            is_clamped: false,
            bump_factor: 1.0,
            has_unread_options: false,
        };
        let mut rest = text.trim();
        while let Some((option, behind)) = rest.split_once([' ', '\t']) {
            let mut behind = behind.trim_start();
            match option.to_ascii_lowercase().as_str() {
                "-s" => {
                    let [u, v, _] = numbers(&mut behind, [1.0; 3]);
                    map.scale = Vec2::new(u, v);
                }
                "-o" => {
                    let [u, v, _] = numbers(&mut behind, [0.0; 3]);
                    map.offset = Vec2::new(u, v);
                }
                "-t" => {
                    map.has_unread_options |=
                        Vec3::from(numbers(&mut behind, [0.0; 3])) != Vec3::ZERO
                }
                "-mm" => {
                    map.has_unread_options |=
                        Vec2::from(numbers(&mut behind, [0.0, 1.0])) != Vec2::Y
                }
                "-bm" => [map.bump_factor] = numbers(&mut behind, [1.0]),
                "-boost" | "-texres" => drop(numbers(&mut behind, [0.0])),
                "-clamp" => map.is_clamped = word(&mut behind).eq_ignore_ascii_case("on"),
                "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-type" => drop(word(&mut behind)),
                _ => break,
            }
            rest = behind;
        }
        map.name = rest.to_owned();
        map
    }

    /// The map of our texture coordinates, whose v is 1 minus OBJ's: OBJ looks up `uv * scale + offset`.
    pub(super) fn transform(&self) -> UvTransform {
        let offset = Vec2::new(self.offset.x, 1.0 - self.scale.y - self.offset.y);
        Affine2::from_scale_angle_translation(self.scale, 0.0, offset)
    }
}

fn word<'t>(text: &mut &'t str) -> &'t str {
    let (word, rest) = text.split_once([' ', '\t']).unwrap_or((text, ""));
    *text = rest.trim_start();
    word
}

/// As many numbers as there are, up to N; `default` for the others.
fn numbers<const N: usize>(text: &mut &str, default: [f32; N]) -> [f32; N] {
    default.map(|default| {
        let mut rest = *text;
        match word(&mut rest).parse::<f32>() {
            Ok(number) if number.is_finite() => {
                *text = rest;
                number
            }
            _ => default,
        }
    })
}

/// The scene's images and textures.
pub(super) struct Textures<'b> {
    budget: &'b Budget,
    /// What images are read for; the others are only found.
    needs: TextureNeeds,
    finder: Finder,
    /// Images: one a file.
    pub(super) images: Vec<Image>,
    /// Textures: one an image and way to sample it.
    pub(super) textures: Vec<Texture>,
    /// The files of images, read or found.
    pub(super) files: Vec<PathBuf>,
    image_of: HashMap<PathBuf, Result<u32, String>>,
    texture_of: HashMap<(u32, bool), u32>,
    stand_in: Option<u32>,
}

impl<'b> Textures<'b> {
    /// No images yet. What they take is taken from `budget`.
    pub(super) fn new(budget: &'b Budget, needs: TextureNeeds) -> Self {
        Self {
            budget,
            needs,
            finder: Finder::default(),
            images: Vec::new(),
            textures: Vec::new(),
            files: Vec::new(),
            image_of: HashMap::new(),
            texture_of: HashMap::new(),
            stand_in: None,
        }
    }

    /// The texture that stands in for colours that cannot be had; it is made when first needed.
    pub(super) fn stand_in(&mut self) -> u32 {
        let (images, textures) = (&mut self.images, &mut self.textures);
        let make = || images::add_stand_in(images, textures);
        *self.stand_in.get_or_insert_with(make)
    }

    /// The texture that a statement of an MTL file names, read if that is what is needed. `None`, and a note, if the file is not there or cannot be read.
    pub(super) fn find(
        &mut self,
        map: &Map,
        needed: TextureNeeds,
        mtl: &mut MtlFile,
    ) -> Option<TextureRef> {
        let candidates = [Some(map.name.as_str()), before_comment(&map.name)];
        let path = candidates
            .into_iter()
            .flatten()
            .find_map(|n| self.finder.find(&mtl.folder, n));
        let element = format!("texture {:?}", map.name);
        let Some(path) = path else {
            mtl.notes
                .element(element, "is not there; materials do without it");
            return None;
        };
        let image = match self.image(path, &map.name, needed <= self.needs) {
            Ok((image, None)) => image,
            Ok((image, Some(mended))) => {
                mtl.notes.element(&element, &mended);
                image
            }
            Err(error) => {
                let text = format!("cannot be read: {error}; materials do without it");
                mtl.notes.element(element, text);
                return None;
            }
        };
        if map.has_unread_options {
            mtl.notes
                .element(element, "options -mm and -t are not followed");
        }
        let texture = *self
            .texture_of
            .entry((image, map.is_clamped))
            .or_insert_with(|| {
                let wrap = if map.is_clamped {
                    Wrap::ClampToEdge
                } else {
                    Wrap::Repeat
                };
                self.textures.push(Texture {
                    image,
                    wrap_u: wrap,
                    wrap_v: wrap,
                    ..Texture::default()
                });
                self.textures.len() as u32 - 1
            });
        Some(TextureRef {
            texture,
            uv_set: 0,
            transform: map.transform(),
        })
    }

    /// The image of a file, with pixels if it `is_wanted`, and what was mended when it was read for the first time.
    fn image(
        &mut self,
        path: PathBuf,
        name: &str,
        is_wanted: bool,
    ) -> Result<(u32, Option<String>), String> {
        let found = match self.image_of.get(&path) {
            Some(Err(cause)) => return Err(cause.clone()),
            Some(&Ok(index)) => Some(index),
            None => None,
        };
        let has_pixels = |index: u32| self.images[index as usize].pixels.is_some();
        if let Some(index) = found.filter(|&index| !is_wanted || has_pixels(index)) {
            return Ok((index, None));
        }
        let read = match is_wanted {
            true => self.read(&path, name),
            false => Ok(Image {
                name: name.to_owned(),
                ..Image::default()
            }),
        };
        let index = read.map(|mut image| {
            let mended = images::mend(&mut image);
            let index = found.unwrap_or_else(|| {
                self.images.push(Image::default());
                self.images.len() as u32 - 1
            });
            self.images[index as usize] = image;
            (index, mended)
        });
        if found.is_none() {
            self.files.push(path.clone());
        }
        self.image_of
            .insert(path, index.clone().map(|(index, _)| index));
        index
    }

    fn read(&self, path: &Path, name: &str) -> Result<Image, String> {
        let element = || format!("texture {name:?}");
        let charge = |bytes| self.budget.charge(bytes, element);
        let length = std::fs::metadata(path).map_or(0, |m| m.len());
        charge(length)?;
        let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
        images::decode(name, &bytes, charge)
    }

    /// The mean colour of a texture's image, of its numbers as they are: 0 to 1 but for floats. Black without pixels.
    pub(super) fn mean(&self, texture: TextureRef) -> Vec3 {
        let image = self.textures[texture.texture as usize].image;
        let sum = |pixels: &mut dyn Iterator<Item = [f64; 3]>| {
            let add = |(sum, count): (DVec3, f64), c| (sum + DVec3::from(c), count + 1.0);
            let (sum, count) = pixels.fold((DVec3::ZERO, 0.0), add);
            sum / f64::max(count, 1.0)
        };
        let mean = match &self.images[image as usize].pixels {
            Some(Pixels::Rgba8(pixels)) => {
                sum(&mut pixels.iter().map(|p| [p[0], p[1], p[2]].map(f64::from))) / 255.0
            }
            Some(Pixels::Rgba16(pixels)) => {
                sum(&mut pixels.iter().map(|p| [p[0], p[1], p[2]].map(f64::from))) / 65_535.0
            }
            Some(Pixels::RgbaF32(pixels)) => {
                sum(&mut pixels.iter().map(|p| [p[0], p[1], p[2]].map(f64::from)))
            }
            None => DVec3::ZERO,
        };
        mean.as_vec3()
    }

    /// Whether some pixel of a texture is not opaque.
    pub(super) fn has_alpha(&self, texture: TextureRef) -> bool {
        let image = self.textures[texture.texture as usize].image;
        match &self.images[image as usize].pixels {
            Some(Pixels::Rgba8(pixels)) => pixels.iter().any(|p| p[3] < u8::MAX),
            Some(Pixels::Rgba16(pixels)) => pixels.iter().any(|p| p[3] < u16::MAX),
            Some(Pixels::RgbaF32(pixels)) => pixels.iter().any(|p| p[3] < 1.0),
            None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_told_from_names() {
        let map =
            Map::parse("-s 2 3 1 -o 0.5 -blendu off -clamp on -mm 0 1 -bm 0.2 my wood -s.png");
        assert_eq!(map.name, "my wood -s.png");
        assert_eq!(
            (map.scale, map.offset),
            (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0))
        );
        assert!(map.is_clamped && !map.has_unread_options);
        assert_eq!(map.bump_factor, 0.2);
        assert_eq!(Map::parse("-s 2 2wood.png").name, "2wood.png");
        assert_eq!(Map::parse("-S 2 3.png").scale, Vec2::new(2.0, 1.0));
        assert!(Map::parse("-mm 0.1 2 a.png").has_unread_options);
        assert_eq!(Map::parse("-unknown a.png").name, "-unknown a.png");
    }

    #[test]
    fn the_transform_minds_that_v_is_flipped() {
        let map = Map::parse("-s 2 3 1 -o 0.1 0.2 a.png");
        for uv in [Vec2::ZERO, Vec2::new(0.3, 0.7)] {
            let obj = uv * Vec2::new(2.0, 3.0) + Vec2::new(0.1, 0.2);
            let ours = map
                .transform()
                .transform_point2(Vec2::new(uv.x, 1.0 - uv.y));
            assert!((ours - Vec2::new(obj.x, 1.0 - obj.y)).length() < 1e-6);
        }
    }
}
