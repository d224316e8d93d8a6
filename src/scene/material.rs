//! Materials: glTF's metallic-roughness model with the lobes of its extensions. MTL is mapped onto it.

use glam::{Affine2, Vec2, Vec3, Vec4};

use super::ColorSpace;

/// Where a texture's coordinates come from: a 2D affine map of a mesh's texture coordinates (KHR_texture_transform).
pub type UvTransform = Affine2;

/// The use of a texture by a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index of the scene's texture.
    pub texture: u32,
    /// Which of the mesh's sets of texture coordinates.
    pub uv_set: u32,
    /// Applied to the coordinates before the lookup.
    pub transform: UvTransform,
}

impl Default for TextureRef {
    fn default() -> Self {
        Self {
            texture: 0,
            uv_set: 0,
            transform: Affine2::IDENTITY,
        }
    }
}

impl TextureRef {
    /// The coordinates at which the texture is looked up.
    pub fn map(&self, uv: Vec2) -> Vec2 {
        self.transform.transform_point2(uv)
    }
}

/// What alpha means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Nothing: the surface is opaque.
    #[default]
    Opaque,
    /// The surface is there where alpha is at least the cutoff, and not elsewhere.
    Mask {
        /// Least alpha that counts.
        cutoff: f32,
    },
    /// The surface covers what is behind it by the share alpha.
    Blend,
}

/// A height map (MTL's `bump`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// Heights; the first channel counts.
    pub texture: TextureRef,
    /// Factor on the heights (`-bm`).
    pub scale: f32,
}

/// A map of alpha alone (MTL's `map_d`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opacity {
    /// Alpha, linear.
    pub texture: TextureRef,
    /// Where in the image it stands; the same for all of its texels.
    pub channel: OpacityChannel,
}

/// The channel of an image that is read as alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpacityChannel {
    /// The image's own alpha.
    Alpha,
    /// The first channel, of images that are opaque throughout.
    Red,
}

impl OpacityChannel {
    /// Alpha, 0 to 1, by a linear texel.
    pub fn of(self, texel: Vec4) -> f32 {
        match self {
            Self::Alpha => texel.w,
            Self::Red => texel.x,
        }
    }
}

/// KHR_materials_specular: strength and colour of the dielectric reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Strength, 0 to 1; the texture's alpha multiplies it.
    pub factor: f32,
    /// Multiplies the factor (alpha channel).
    pub texture: Option<TextureRef>,
    /// Linear colour at normal incidence.
    pub color: Vec3,
    /// Multiplies the colour (sRGB).
    pub color_texture: Option<TextureRef>,
}

/// KHR_materials_transmission: light that passes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// Share of the light that is not reflected and passes, 0 to 1.
    pub factor: f32,
    /// Multiplies the factor (red channel).
    pub texture: Option<TextureRef>,
}

/// KHR_materials_volume: what light crosses inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Thickness below the surface, in the mesh's units; 0 for a thin wall.
    pub thickness: f32,
    /// Multiplies the thickness (green channel).
    pub thickness_texture: Option<TextureRef>,
    /// Distance after which light has the attenuation colour, in world units; may be infinite.
    pub attenuation_distance: f32,
    /// Linear colour of white light after the attenuation distance.
    pub attenuation_color: Vec3,
}

/// KHR_materials_clearcoat: a clear layer on top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// Strength, 0 to 1.
    pub factor: f32,
    /// Multiplies the strength (red channel).
    pub texture: Option<TextureRef>,
    /// Roughness of the layer.
    pub roughness: f32,
    /// Multiplies the roughness (green channel).
    pub roughness_texture: Option<TextureRef>,
    /// Normals of the layer.
    pub normal_texture: Option<TextureRef>,
    /// Factor on the x and y of those normals.
    pub normal_scale: f32,
}

/// KHR_materials_sheen: cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Linear colour.
    pub color: Vec3,
    /// Multiplies the colour (sRGB).
    pub color_texture: Option<TextureRef>,
    /// Roughness.
    pub roughness: f32,
    /// Multiplies the roughness (alpha channel).
    pub roughness_texture: Option<TextureRef>,
}

/// A material. Colours are linear RGB of Rec. 709 primaries.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file.
    pub name: String,
    /// Linear colour and alpha.
    pub base_color: Vec4,
    /// Multiplies the base colour (sRGB, alpha linear).
    pub base_color_texture: Option<TextureRef>,
    /// Multiplies alpha (MTL's `map_d`).
    pub opacity: Option<Opacity>,
    /// 0 for dielectrics, 1 for metals.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// Multiplies roughness (green channel) and metallic (blue channel).
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Tangent-space normals.
    pub normal_texture: Option<TextureRef>,
    /// Factor on the x and y of those normals.
    pub normal_scale: f32,
    /// Heights instead of normals (MTL).
    pub bump: Option<Bump>,
    /// Baked occlusion (red channel).
    pub occlusion_texture: Option<TextureRef>,
    /// How far the occlusion counts, 0 to 1.
    pub occlusion_strength: f32,
    /// Emitted radiance, linear; the strength of KHR_materials_emissive_strength is in it.
    pub emissive: Vec3,
    /// Multiplies the emitted radiance (sRGB).
    pub emissive_texture: Option<TextureRef>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Whether the back face is shaded like the front face.
    pub double_sided: bool,
    /// Whether the base colour is shown as it is, unlit (KHR_materials_unlit).
    pub unlit: bool,
    /// Index of refraction.
    pub ior: f32,
    /// Dielectric reflection, where the file says something of it.
    pub specular: Option<Specular>,
    /// Light that passes through.
    pub transmission: Option<Transmission>,
    /// What is inside.
    pub volume: Option<Volume>,
    /// A clear layer on top.
    pub clearcoat: Option<Clearcoat>,
    /// Cloth.
    pub sheen: Option<Sheen>,
}

impl Default for Material {
    /// A white, rough, opaque dielectric, shaded from both sides: what a mesh without material gets.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            opacity: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            bump: None,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            unlit: false,
            ior: 1.5,
            specular: None,
            transmission: None,
            volume: None,
            clearcoat: None,
            sheen: None,
        }
    }
}

impl Material {
    /// Every use of a texture.
    pub fn texture_refs(&self) -> impl Iterator<Item = TextureRef> {
        let mut copy = self.clone();
        copy.texture_refs_mut()
            .map(|t| *t)
            .collect::<Vec<_>>()
            .into_iter()
    }

    /// Every use of a texture, to be renumbered.
    pub fn texture_refs_mut(&mut self) -> impl Iterator<Item = &mut TextureRef> {
        self.texture_slots_mut().map(|(_, texture)| texture)
    }

    /// Every use of a texture, with what its image's numbers mean there.
    pub fn texture_slots(&self) -> Vec<(ColorSpace, TextureRef)> {
        let mut copy = self.clone();
        copy.texture_slots_mut().map(|(s, t)| (s, *t)).collect()
    }

    fn texture_slots_mut(&mut self) -> impl Iterator<Item = (ColorSpace, &mut TextureRef)> {
        use ColorSpace::{Linear, Srgb};
        let own = [
            (Srgb, &mut self.base_color_texture),
            (Linear, &mut self.metallic_roughness_texture),
            (Linear, &mut self.normal_texture),
            (Linear, &mut self.occlusion_texture),
            (Srgb, &mut self.emissive_texture),
        ];
        let specular = self
            .specular
            .iter_mut()
            .flat_map(|s| [(Linear, &mut s.texture), (Srgb, &mut s.color_texture)]);
        let transmission = self.transmission.iter_mut();
        let transmission = transmission.map(|t| (Linear, &mut t.texture));
        let volume = self.volume.iter_mut();
        let volume = volume.map(|v| (Linear, &mut v.thickness_texture));
        let clearcoat = self.clearcoat.iter_mut().flat_map(|c| {
            [
                (Linear, &mut c.texture),
                (Linear, &mut c.roughness_texture),
                (Linear, &mut c.normal_texture),
            ]
        });
        let sheen = self.sheen.iter_mut().flat_map(|s| {
            [
                (Srgb, &mut s.color_texture),
                (Linear, &mut s.roughness_texture),
            ]
        });
        let opacity = self.opacity.iter_mut().map(|o| &mut o.texture);
        let bump = self.bump.iter_mut().map(|b| &mut b.texture);
        own.into_iter()
            .chain(specular)
            .chain(transmission)
            .chain(volume)
            .chain(clearcoat)
            .chain(sheen)
            .filter_map(|(space, texture)| Some((space, texture.as_mut()?)))
            .chain(opacity.chain(bump).map(|texture| (Linear, texture)))
    }

    /// The set of texture coordinates of the tangent-space normals, if there are any: the material's own, or else the clear coat's.
    pub fn normal_uv_set(&self) -> Option<u32> {
        let coat = self.clearcoat.and_then(|c| c.normal_texture);
        self.normal_texture.or(coat).map(|t| t.uv_set)
    }

    /// Whether the surface scatters light evenly and does nothing else with it (Lambert): no texture gives it mirrors, a coat, sheen, or lets light pass.
    pub fn is_matt(&self) -> bool {
        self.metallic <= 0.0
            && self.specular.is_some_and(|s| s.factor <= 0.0)
            && self.transmission.is_none_or(|t| t.factor <= 0.0)
            && self.clearcoat.is_none_or(|c| c.factor <= 0.0)
            && self.sheen.is_none_or(|s| s.color == Vec3::ZERO)
    }

    /// Whether light that passes the surface enters a medium and is bent. Else a surface that light passes is a thin wall.
    pub fn is_solid(&self) -> bool {
        let passes = self.transmission.is_some_and(|t| t.factor > 0.0);
        passes && self.ior >= 1.0 && self.volume.is_some_and(|v| v.thickness > 0.0)
    }

    /// Whether a ray can pass a surface of this material without being refracted: its alpha counts.
    pub fn has_alpha(&self) -> bool {
        self.alpha_mode != AlphaMode::Opaque
    }
}
