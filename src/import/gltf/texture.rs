//! Images, textures and the ways a material refers to them.

use std::collections::{BTreeMap, BTreeSet};

use ::gltf::json::texture::{MagFilter, MinFilter, WrappingMode};
use ::gltf::json::validation::Checked;
use ::gltf::json::{self, Root};
use glam::{Affine2, Mat2, Vec2};
use rayon::prelude::*;
use serde_json::{Map, Value};

use super::document::{Document, label};
use super::extensions::Extension;
use super::ktx2;
use super::notes::Notes;
use super::uri::{self, Target};
use crate::import::images;
use crate::scene::{Filter, Image, ShownDetail, Texture, TextureRef, UvTransform, Wrap};

/// `gltf-json` has this for a texture without source.
const NO_SOURCE: usize = u32::MAX as usize;

/// A file's textures, as far as they can be used.
#[derive(Debug, Default)]
pub(super) struct Textures {
    /// All images of the file.
    pub(super) images: Vec<Image>,
    /// The textures whose image is there.
    pub(super) textures: Vec<Texture>,
    /// The place in `textures` of each texture of the file.
    places: Vec<Option<u32>>,
}

impl Textures {
    /// Looks whether the images are there.
    pub(super) fn find(document: &Document) -> Self {
        // They are read later, and then it is said what is amiss.
        let mut notes = Notes::new(document.file);
        Self::read(document, &BTreeSet::new(), &[], &mut notes)
    }

    /// Reads the images of the textures `shown`, each of the `detail` that is shown of it if that is known, and looks whether the others are there.
    pub(super) fn read(
        document: &Document,
        shown: &BTreeSet<usize>,
        detail: &[Option<ShownDetail>],
        notes: &mut Notes,
    ) -> Self {
        let root = &document.root;
        let mut choices = Choices::made(document, shown, detail);
        if !detail.is_empty()
            && choices.chosen != Choices::made(document, &BTreeSet::new(), &[]).chosen
        {
            // An image that cannot be decoded: its fallback stands in, of which other things were known.
            choices = Choices::made(document, shown, &[]);
        }

        let causes = choices.read.iter().enumerate();
        for (i, cause) in causes.filter_map(|(i, r)| Some((i, r.as_ref()?.as_ref().err()?))) {
            let element = label("image", i, root.images[i].name.as_ref());
            notes.add(element, format!("left out of its materials: {cause}"));
        }
        let mut textures = Vec::new();
        let mut places = Vec::with_capacity(root.textures.len());
        for (i, texture) in root.textures.iter().enumerate() {
            let image = choices.image(i);
            places.push(image.map(|_| textures.len() as u32));
            textures.extend(image.map(|image| sampled(root, texture, image as u32)));
            let text = match (image, &choices.sources[i][..]) {
                (Some(image), [best, ..]) if image == *best => continue,
                (Some(image), [best, ..]) => {
                    format!("image {best} cannot be had: image {image}, its fallback, is shown")
                }
                (_, []) => {
                    "left out of its materials: it has no image of a kind that is read".to_owned()
                }
                (None, sources) if sources.iter().any(|&s| s < root.images.len()) => continue,
                _ => "left out of its materials: its image is not there".to_owned(),
            };
            notes.add(label("texture", i, texture.name.as_ref()), text);
        }
        let read = choices.read.into_iter().enumerate();
        let images = read.map(|(i, read)| match read {
            Some(Ok((image, mended))) => {
                if let Some(mended) = mended {
                    notes.add(label("image", i, root.images[i].name.as_ref()), mended);
                }
                image
            }
            _ => empty_image(document, i),
        });
        Self {
            images: images.collect(),
            textures,
            places,
        }
    }

    /// The number of the texture that stands in for colours that cannot be had: it comes after all others, if it is needed.
    pub(super) fn stand_in(&self) -> u32 {
        self.textures.len() as u32
    }

    /// A use of texture `index` of the file, `None` where it cannot be used. `extensions` are those of the use.
    pub(super) fn refer(
        &self,
        index: usize,
        uv_set: u32,
        extensions: Option<&Map<String, Value>>,
    ) -> Option<TextureRef> {
        let texture = (*self.places.get(index)?)?;
        let Some(map) = Extension::find(extensions, "KHR_texture_transform") else {
            return Some(TextureRef {
                texture,
                uv_set,
                ..TextureRef::default()
            });
        };
        let instead = map.index("texCoord").and_then(|s| u32::try_from(s).ok());
        Some(TextureRef {
            texture,
            uv_set: instead.unwrap_or(uv_set),
            transform: uv_transform(map),
        })
    }
}

/// Which of the images that a texture names it shows: the first that can be had.
struct Choices {
    /// The images of each texture, the best first.
    sources: Vec<Vec<usize>>,
    /// The place in `sources` of the choice of each texture; behind their end where none can be had.
    chosen: Vec<usize>,
    /// The images as far as they were looked at; without pixels if nothing shows them so far.
    read: Vec<Option<Result<ImageRead, String>>>,
}

/// An image, and what was mended in it.
type ImageRead = (Image, Option<String>);

impl Choices {
    /// With the images read of the textures `shown`, each of its `detail`.
    fn made(document: &Document, shown: &BTreeSet<usize>, detail: &[Option<ShownDetail>]) -> Self {
        let mut choices = Self::new(&document.root);
        while choices.read_more(document, shown, detail) {}
        choices
    }

    /// All textures choose the best of their images that the file has.
    fn new(root: &Root) -> Self {
        let mut choices = Self {
            sources: root.textures.iter().map(|t| sources(t).collect()).collect(),
            chosen: vec![0; root.textures.len()],
            read: root.images.iter().map(|_| None).collect(),
        };
        choices.pass_lost();
        choices
    }

    /// The image that a texture has chosen.
    fn image(&self, texture: usize) -> Option<usize> {
        self.sources[texture].get(self.chosen[texture]).copied()
    }

    /// Textures whose choice cannot be had choose the next.
    fn pass_lost(&mut self) {
        for (chosen, sources) in self.chosen.iter_mut().zip(&self.sources) {
            let is_lost = |&s: &usize| !matches!(self.read.get(s), Some(None | Some(Ok(_))));
            *chosen += sources[*chosen..].iter().take_while(|s| is_lost(s)).count();
        }
    }

    /// Reads the images that are chosen, with pixels those of the textures `shown`. Whether there were any that were not
    /// read before. As an image is read twice at most, and three are named by a texture, this is soon over.
    fn read_more(
        &mut self,
        document: &Document,
        shown: &BTreeSet<usize>,
        detail: &[Option<ShownDetail>],
    ) -> bool {
        let mut is_shown_of: BTreeMap<usize, bool> = BTreeMap::new();
        for texture in 0..self.sources.len() {
            if let Some(image) = self.image(texture) {
                *is_shown_of.entry(image).or_default() |= shown.contains(&texture);
            }
        }
        is_shown_of.retain(|&image, &mut is_shown| match &self.read[image] {
            None => true,
            Some(Ok((image, _))) => is_shown && image.pixels.is_none(),
            Some(Err(_)) => false,
        });
        let images: Vec<(usize, bool)> = is_shown_of.into_iter().collect();
        let read = images
            .par_iter()
            .with_max_len(1)
            .map(|&(image, is_shown)| match is_shown {
                true => read_image(document, image, detail.get(image).copied().flatten()),
                false => find_image(document, image).map(|image| (image, None)),
            });
        let read: Vec<Result<ImageRead, String>> = read.collect();
        for (&(image, _), read) in images.iter().zip(read) {
            self.read[image] = Some(read);
        }
        self.pass_lost();
        !images.is_empty()
    }
}

/// The images that a texture names, the best first: those of formats made for textures, then the one that every reader knows.
fn sources(texture: &json::Texture) -> impl Iterator<Item = usize> {
    let extensions = texture.extensions.as_ref().map(|e| &e.others);
    let extended = ["KHR_texture_basisu", "EXT_texture_webp"];
    let extended = extended.map(|name| Extension::find(extensions, name)?.index("source"));
    let own = Some(texture.source.value()).filter(|&s| s != NO_SOURCE);
    extended.into_iter().chain([own]).flatten()
}

/// KHR_texture_transform: scale, then rotation, then offset.
///
/// The extension says "counter-clockwise", on the screen, that is with v downwards; its GLSL fragment turns the other way. The
/// Khronos model TextureTransformTest decides for the words, as do the common viewers.
fn uv_transform(map: Extension) -> UvTransform {
    let angle = f64::from(map.number("rotation").unwrap_or(0.0));
    let (sin, cos) = (libm::sin(angle) as f32, libm::cos(angle) as f32);
    let rotation = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    let scale = map.numbers("scale").map_or(Vec2::ONE, Vec2::from);
    let offset = map.numbers("offset").map_or(Vec2::ZERO, Vec2::from);
    Affine2::from_mat2_translation(rotation * Mat2::from_diagonal(scale), offset)
}

fn sampled(root: &Root, texture: &::gltf::json::Texture, image: u32) -> Texture {
    let default = ::gltf::json::texture::Sampler::default();
    let sampler = texture.sampler.and_then(|s| root.samplers.get(s.value()));
    let sampler = sampler.unwrap_or(&default);
    let wrap = |mode| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    };
    use MinFilter::{Nearest, NearestMipmapLinear, NearestMipmapNearest};
    let filter = match (sampler.mag_filter, sampler.min_filter) {
        (Some(Checked::Valid(MagFilter::Nearest)), _) => Filter::Nearest,
        (Some(Checked::Valid(MagFilter::Linear)), _) => Filter::Linear,
        (_, Some(Checked::Valid(Nearest | NearestMipmapLinear | NearestMipmapNearest))) => {
            Filter::Nearest
        }
        _ => Filter::Linear,
    };
    Texture {
        image,
        wrap_u: wrap(sampler.wrap_s),
        wrap_v: wrap(sampler.wrap_t),
        filter,
    }
}

fn image_name(document: &Document, index: usize) -> String {
    let image = &document.root.images[index];
    let path = image.uri.as_ref().filter(|u| !u.starts_with("data:"));
    let name = image.name.as_ref().filter(|n| !n.is_empty());
    match name.or(path) {
        Some(name) => name.clone(),
        None => format!("image {index}"),
    }
}

fn empty_image(document: &Document, index: usize) -> Image {
    Image {
        name: image_name(document, index),
        ..Image::default()
    }
}

/// The image, mended, with the levels that are shown.
fn read_image(
    document: &Document,
    index: usize,
    shown: Option<ShownDetail>,
) -> Result<ImageRead, String> {
    let image = &document.root.images[index];
    let name = image_name(document, index);
    let element = || label("image", index, image.name.as_ref());
    let charge = |bytes| document.budget.charge(bytes, element);
    let decode = |bytes: &[u8]| {
        let decoded = match ktx2::is_ktx2(bytes) {
            true => ktx2::decode(&name, bytes, charge),
            false => images::decode(&name, bytes, charge),
        };
        let mut image = decoded.map_err(|cause| format!("cannot be decoded: {cause}"))?;
        let mended = images::mend(&mut image);
        if let Some(shown) = shown {
            image.keep(shown);
        }
        Ok((image, mended))
    };
    match (&image.buffer_view, &image.uri) {
        (Some(view), _) => decode(document.view(view.value())?.0),
        (None, Some(uri)) => {
            let files = &document.files;
            decode(&uri::read(document.file, uri, files, u64::MAX, charge)?)
        }
        (None, None) => Err("has neither a URI nor a buffer view".to_owned()),
    }
}

/// The image without its pixels, if they could be had.
fn find_image(document: &Document, index: usize) -> Result<Image, String> {
    let image = &document.root.images[index];
    match (&image.buffer_view, &image.uri) {
        (Some(view), _) => document.view(view.value()).map(|_| ())?,
        (None, Some(uri)) => match uri::resolve(document.file, uri)? {
            Target::Data(_) => {}
            Target::Files(paths) => document.files.find_first(&paths).map(|_| ())?,
        },
        (None, None) => return Err("has neither a URI nor a buffer view".to_owned()),
    }
    Ok(empty_image(document, index))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transform(json: &str) -> UvTransform {
        let extensions: Map<String, Value> = serde_json::from_str(json).expect("JSON");
        let map = Extension::find(Some(&extensions), "KHR_texture_transform").expect("there");
        uv_transform(map)
    }

    #[test]
    fn textures_turn_as_in_the_khronos_test() {
        // TextureTransformTest: the arrow's tip is at (0.778, 0.778) of the image, the markers for a right loader
        // at those places of the quad (x - 0.5 and 0.5 - y of the nodes "Rotation - Correct" and "All - Correct").
        let tip = Vec2::splat(0.777_817_5);
        let rotation = transform(r#"{"KHR_texture_transform":{"rotation":0.39269908169872414}}"#);
        let marker = Vec2::new(0.5 - 0.079_048_224, 0.5 + 0.516_267_5);
        assert!((rotation.transform_point2(marker) - tip).length() < 1e-6);
        let all = transform(
            r#"{"KHR_texture_transform":{"offset":[-0.2,-0.1],"rotation":0.3,"scale":[1.5,1.5]}}"#,
        );
        let marker = Vec2::new(0.5 - 0.07, 0.5 + 0.25);
        assert!((all.transform_point2(marker) - tip).length() < 0.05);
    }

    #[test]
    fn textures_are_scaled_before_they_turn() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let map = transform(&format!(
            r#"{{"KHR_texture_transform":{{"offset":[10,20],"rotation":{quarter},"scale":[2,3]}}}}"#
        ));
        let uv = map.transform_point2(Vec2::new(1.0, 1.0));
        assert!((uv - Vec2::new(13.0, 18.0)).length() < 1e-5, "{uv}");
        assert_eq!(
            transform(r#"{"KHR_texture_transform":{}}"#),
            Affine2::IDENTITY
        );
    }
}
