//! From MTL's Phong materials, and their extensions for physically based ones, to [`Material`].
//!
//! MTL says little of what its numbers mean. What is assumed here, in the space of linear Rec. 709:
//! - `Kd` and the other colours are linear, as Blender and the renderers write and read them; images of colours are sRGB.
//! - `Kd 0 0 0` beside `map_Kd` would show nothing: exporters mean the image alone. So with `Ke` and `map_Ke`.
//! - `illum` chooses mirrors and glass: [`super::illumination`] has the table. Without it, and with 2, there is a highlight.
//! - `Ks` is relative to a dielectric's reflection, 0.5 being that of glass (Blender's convention); `map_Ks` multiplies it. Black
//!   `Kd` with bright `Ks` is a metal of that colour. Of a mirror, `Ks` is the reflection itself; of glass, a tint.
//! - `Ns` is the exponent of Blinn's lobe: alpha = sqrt(2 / (Ns + 2)) (Walter et al. 2007), roughness = sqrt(alpha). Mirrors and
//!   glass are sharp whatever it is: it was their highlight's. `map_Ns` is left out: no factor takes exponents to roughness.
//! - `Ni 1` is what exporters write who know of no refraction; it counts only where `illum` asks for refraction.
//! - `d` is alpha, `Tr` is 1 - alpha where there is no `d`; both, and `map_d`, are blended, which is exact for leaves and
//!   for panes. Of glass, 1 - `d` is the share that passes, tinted by `Tf`; all of it passes where `d` is 1.
//! - `Pr`, `Pm`, `Pc`, `Pcr`, `Ps`, `norm` and their maps, the extension for physically based materials (Clara.io, 2013), count before
//!   what they replace.
//! - `map_Bump` is a height map, but for images that are normal maps by their colours: then it is `norm`, with `-bm` for
//!   its strength, as Blender reads it.
//! - `Ka` is the answer to ambient light, of which there is none here; but above 1, and without `Ke`, it can only
//!   mean a light (the Cornell box of Intel's Embree has its light so).

use glam::Vec3;

use super::super::{TextureNeeds, images};
use super::illumination::{Illumination, is_normal_map};
use super::mtl::MtlFile;
use super::reader::MtlMaterial;
use super::textures::{Map, Textures};
use crate::scene::{
    AlphaMode, Bump, Clearcoat, Material, Opacity, OpacityChannel, Sheen, Specular, TextureRef,
    Transmission,
};

/// The `Ks` that stands for a dielectric's own reflection.
const USUAL_KS: f32 = 0.5;

/// Roughness of sheen, of which MTL says nothing; pbrt's and Blender's default is about this.
const SHEEN_ROUGHNESS: f32 = 0.5;

/// Converts a material of `mtl`; what it needs of images goes into `textures`.
pub(super) fn convert(
    source: &MtlMaterial,
    textures: &mut Textures<'_>,
    mtl: &mut MtlFile,
) -> Material {
    let mut conversion = Conversion {
        source,
        textures,
        mtl,
        material: Material {
            name: source.name.clone(),
            ..Material::default()
        },
    };
    conversion.base_color();
    conversion.reflection();
    conversion.alpha_and_refraction();
    conversion.emission();
    conversion.surface();
    conversion.layers();
    conversion.left_out();
    conversion.material
}

struct Conversion<'c, 'b> {
    source: &'c MtlMaterial,
    textures: &'c mut Textures<'b>,
    mtl: &'c mut MtlFile,
    material: Material,
}

impl Conversion<'_, '_> {
    fn other(&self, key: &str) -> Option<&str> {
        self.source.unknown_param.get(key).map(String::as_str)
    }

    fn number(&self, key: &str) -> Option<f32> {
        self.other(key)?.parse().ok()
    }

    fn color(&self, key: &str) -> Option<Vec3> {
        let mut numbers = self.other(key)?.split(' ').map(str::parse);
        let mut next = || numbers.next()?.ok();
        Some(Vec3::new(next()?, next()?, next()?))
    }

    /// The texture of a statement, for pictures that `needed` it.
    fn texture(&mut self, statement: Option<&str>, needed: TextureNeeds) -> Option<TextureRef> {
        self.textures
            .find(&Map::parse(statement?), needed, self.mtl)
    }

    /// Whether a statement names an image and this is not to be had.
    fn is_lost(statement: Option<&str>, texture: Option<TextureRef>) -> bool {
        texture.is_none() && statement.is_some_and(|s| !Map::parse(s).name.is_empty())
    }

    fn note(&mut self, text: &str) {
        let element = format!("material {:?}", self.material.name);
        self.mtl.notes.element(element, text);
    }

    fn base_color(&mut self) {
        let statement = self.source.diffuse_texture.as_deref();
        // Its alpha counts where there is any other.
        let has_alpha = self.alpha() < 1.0 || self.source.dissolve_texture.is_some();
        let needed = match has_alpha {
            true => TextureNeeds::Alpha,
            false => TextureNeeds::All,
        };
        let texture = self.texture(statement, needed);
        if Self::is_lost(statement, texture) {
            images::show_stand_in(&mut self.material, self.textures.stand_in(), 0);
            return self.note(images::STAND_IN_NOTE);
        }
        let kd = color_of(self.source.diffuse).unwrap_or(Vec3::ONE);
        let color = if kd == Vec3::ZERO && texture.is_some() {
            Vec3::ONE
        } else {
            kd
        };
        self.material.base_color = color.extend(1.0);
        self.material.base_color_texture = texture;
    }

    fn alpha(&self) -> f32 {
        let of_tr = || self.number("Tr").map(|tr| 1.0 - tr);
        let alpha = self.source.dissolve.or_else(of_tr);
        alpha.unwrap_or(1.0).clamp(0.0, 1.0)
    }

    fn illumination(&self) -> Illumination {
        let source = self.source;
        Illumination::of(
            source.illumination_model,
            self.alpha(),
            source.optical_density.unwrap_or(1.0),
            color_of(source.ambient),
            color_of(source.specular),
        )
    }

    fn reflection(&mut self) {
        let source = self.source;
        if let Some(ns) = source.shininess {
            // Rounding or a joke of the exporter: a negative exponent is no lobe.
            self.material.roughness = (2.0 / (ns.max(0.0) + 2.0)).sqrt().sqrt();
        }
        if let Some(ni) = source.optical_density
            && ni > 1.0
        {
            self.material.ior = ni;
        }
        let illumination = self.illumination();
        if illumination.is_sharp() {
            self.material.roughness = 0.0;
        }
        let texture = self.texture(source.specular_texture.as_deref(), TextureNeeds::All);
        let ks = match (color_of(source.specular), illumination) {
            (_, Illumination::Matt) => Some(Vec3::ZERO),
            (Some(Vec3::ZERO), _) if texture.is_some() => Some(Vec3::ONE),
            (None, _) => texture.map(|_| Vec3::ONE),
            (ks, _) => ks,
        };
        let is_physical = self.other("Pm").is_some() || self.other("Pr").is_some();
        match illumination {
            Illumination::BlenderMetal(share) => {
                self.material.metallic = share;
                return;
            }
            Illumination::Glass => {
                self.material.specular = self.glass_reflection(ks);
                return;
            }
            _ => {}
        }
        let Some(ks) = ks else { return };
        let is_black = color_of(source.diffuse) == Some(Vec3::ZERO)
            && self.material.base_color_texture.is_none();
        if is_black && ks != Vec3::ZERO && !is_physical && !self.has_glass_number() {
            self.material.metallic = 1.0;
            self.material.base_color = ks.min(Vec3::ONE).extend(1.0);
            self.material.base_color_texture = texture;
        } else if ks == Vec3::ZERO && is_physical {
            // Programs that write Pr and Pm fill Ks with zeros.
        } else {
            // The specular colour multiplies the reflection by the index of refraction.
            let usual = match illumination {
                Illumination::Mirror => self.normal_reflection(),
                _ => USUAL_KS,
            };
            self.material.specular = Some(Specular {
                factor: if ks == Vec3::ZERO { 0.0 } else { 1.0 },
                texture: None,
                color: if ks == Vec3::ZERO {
                    Vec3::ONE
                } else {
                    ks / usual
                },
                color_texture: texture,
            });
        }
    }

    /// Whether black `Kd` may mean glass rather than metal.
    fn has_glass_number(&self) -> bool {
        matches!(self.source.illumination_model, Some(4 | 6 | 7 | 9))
    }

    /// What the index of refraction reflects at normal incidence, by Fresnel; above 0.
    fn normal_reflection(&self) -> f32 {
        let ratio = (self.material.ior - 1.0) / (self.material.ior + 1.0);
        (ratio * ratio).max(f32::MIN_POSITIVE)
    }

    /// The tint of what glass reflects: none if `Ks` is black or white, which exporters write who mean nothing by it.
    fn glass_reflection(&self, ks: Option<Vec3>) -> Option<Specular> {
        let color = ks?.min(Vec3::ONE);
        let is_tint = color != Vec3::ZERO && color != Vec3::ONE;
        is_tint.then_some(Specular {
            factor: 1.0,
            texture: None,
            color,
            color_texture: None,
        })
    }

    fn alpha_and_refraction(&mut self) {
        let source = self.source;
        let alpha = self.alpha();
        if self.illumination() == Illumination::Glass {
            let factor = if alpha < 1.0 { 1.0 - alpha } else { 1.0 };
            self.material.transmission = Some(Transmission {
                factor,
                texture: None,
            });
            self.material.ior = source.optical_density.unwrap_or(self.material.ior).max(1.0);
            let tint = self.color("Tf").unwrap_or(Vec3::ONE);
            if tint != Vec3::ZERO {
                self.material.base_color = tint.min(Vec3::ONE).extend(1.0);
            }
            return;
        }
        if alpha < 1.0 {
            self.material.base_color.w = alpha;
            self.material.alpha_mode = AlphaMode::Blend;
            if alpha <= 0.0 {
                self.note("is wholly transparent (d 0 or Tr 1): nothing of it shows");
            }
        }
        if let Some(texture) = self.texture(source.dissolve_texture.as_deref(), TextureNeeds::Alpha)
        {
            self.material.alpha_mode = AlphaMode::Blend;
            let channel = if self.textures.has_alpha(texture) {
                OpacityChannel::Alpha
            } else {
                OpacityChannel::Red
            };
            // The same image for both: its alpha already multiplies the base colour's.
            let is_counted = self.material.base_color_texture == Some(texture)
                && channel == OpacityChannel::Alpha;
            self.material.opacity = Some(Opacity { texture, channel }).filter(|_| !is_counted);
        }
    }

    fn emission(&mut self) {
        let params = &self.source.unknown_param;
        let statement = params.get("map_Ke").map(String::as_str);
        let texture = self.texture(statement, TextureNeeds::All);
        if Self::is_lost(statement, texture) {
            // The image says where the material emits: without it, all of it would be a light.
            return;
        }
        let ke = color_of(self.source.emissive).unwrap_or(Vec3::ZERO);
        self.material.emissive = match texture {
            Some(_) if ke == Vec3::ZERO => Vec3::ONE,
            _ => ke,
        };
        self.material.emissive_texture = texture;
        let ka = color_of(self.source.ambient).unwrap_or(Vec3::ZERO);
        if self.material.emissive == Vec3::ZERO && ka.max_element() > 1.0 {
            self.material.emissive = ka;
            self.note("has Ka above 1 and no Ke: taken as a light of that colour");
        }
    }

    fn surface(&mut self) {
        if let Some(roughness) = self.number("Pr") {
            self.material.roughness = roughness.clamp(0.0, 1.0);
        }
        if let Some(metallic) = self.number("Pm") {
            self.material.metallic = metallic.clamp(0.0, 1.0);
        }
        let params = &self.source.unknown_param;
        let (map_pr, map_pm) = (params.get("map_Pr"), params.get("map_Pm"));
        match (map_pr, map_pm) {
            // One image with both: roughness is green and metallic blue by convention.
            (Some(pr), Some(pm)) if pr == pm => {
                self.material.metallic_roughness_texture =
                    self.texture(Some(pr), TextureNeeds::All);
                if self.material.metallic_roughness_texture.is_some() {
                    self.material.metallic = self.number("Pm").unwrap_or(1.0).clamp(0.0, 1.0);
                }
            }
            // A grey image: its blue channel multiplies a metallic of 0.
            (Some(pr), None) if self.material.metallic <= 0.0 => {
                self.material.metallic_roughness_texture =
                    self.texture(Some(pr), TextureNeeds::All);
            }
            (None, None) => {}
            _ => {
                self.note("map_Pr and map_Pm are left out; put both in one image (green and blue)")
            }
        }
        self.material.normal_texture = self.texture(
            params.get("norm").map(String::as_str),
            TextureNeeds::Normals,
        );
        if let Some(statement) = &self.source.normal_texture {
            let map = Map::parse(statement);
            let Some(texture) = self.textures.find(&map, TextureNeeds::Normals, self.mtl) else {
                return;
            };
            if !is_normal_map(self.textures.mean(texture)) {
                self.material.bump = Some(Bump {
                    texture,
                    scale: map.bump_factor,
                });
            } else if self.material.normal_texture.is_none() {
                self.material.normal_texture = Some(texture);
                self.material.normal_scale = map.bump_factor;
                self.note("its map_Bump is a normal map by its colours, and is taken as one");
            }
        }
    }

    fn layers(&mut self) {
        if let Some(factor) = self.number("Pc").filter(|f| *f > 0.0) {
            self.material.clearcoat = Some(Clearcoat {
                factor: factor.min(1.0),
                texture: None,
                roughness: self.number("Pcr").unwrap_or(0.0).clamp(0.0, 1.0),
                roughness_texture: None,
                normal_texture: None,
                normal_scale: 1.0,
            });
        }
        if let Some(sheen) = self.number("Ps").filter(|f| *f > 0.0) {
            self.material.sheen = Some(Sheen {
                color: Vec3::splat(sheen.min(1.0)),
                color_texture: None,
                roughness: SHEEN_ROUGHNESS,
                roughness_texture: None,
            });
        }
    }

    /// Notes the statements that would change the picture and are not followed.
    fn left_out(&mut self) {
        let source = self.source;
        let mut names: Vec<&str> = [
            "disp", "decal", "refl", "aniso", "anisor", "map_Ps", "map_Pc", "map_Pcr",
        ]
        .into_iter()
        .filter(|name| source.unknown_param.contains_key(*name))
        .collect();
        names.extend(source.shininess_texture.as_ref().map(|_| "map_Ns"));
        if !names.is_empty() {
            let text = format!("{} left out", names.join(", "));
            self.note(&text);
        }
    }
}

fn color_of(color: Option<[f32; 3]>) -> Option<Vec3> {
    // Less than nothing is reflected by no surface.
    color.map(|c| Vec3::from_array(c).max(Vec3::ZERO))
}
