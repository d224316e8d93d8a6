//! What a ray meets at a hit: place, normals, texture coordinates, and the material's values there. World space.

use glam::{Vec2, Vec3, Vec4};

use super::facets::{Facets, StagedFacet};
use super::lights::Receiver;
use super::ray_cone::RayCone;
use super::stage::Stage;
use super::texture::ColorSpace;
use crate::accel::Hit;
use crate::geometry::Ray;
use crate::scene::{AlphaMode, Material, TextureRef};

/// The surface at a hit. Both normals are of unit length and turned towards where the ray came from.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The hit it belongs to.
    pub hit: Hit,
    /// Place in world space.
    pub position: Vec3,
    /// The triangle's own normal.
    pub geometric_normal: Vec3,
    /// The normal that light sees: the file's, between its vertices.
    pub shading_normal: Vec3,
    /// Whether the ray came from the front, where corners run counter-clockwise.
    pub is_front: bool,
    /// First set of texture coordinates, or zero.
    pub uv: Vec2,
    /// Weights of the triangle's second and third corner.
    pub barycentric: (f32, f32),
    /// Index of the scene's material.
    pub material: u32,
    /// How far along the geometric normal a ray must start so as to leave the surface behind, in model units.
    pub offset: f32,
    /// The cone of the ray where it meets the surface: nothing finer than its width counts.
    pub cone: RayCone,
    /// Width of the patch in the cone, in model units; 0 for the finest detail.
    pub footprint: f32,
    /// The same in units of the first set of texture coordinates.
    uv_footprint: f32,
    /// How many of these a patch of a model unit is wide; 0 where no texture is looked up.
    uv_per_length: f32,
}

/// A material's values at one place.
#[derive(Clone, Copy, Debug)]
pub struct MaterialPoint {
    /// Linear base colour, with vertex colour and texture.
    pub base_color: Vec3,
    /// Share of the light that the surface stops: 1 for opaque ones, 0 or 1 for masks.
    pub alpha: f32,
    /// Emitted radiance; none where the base colour is shown as it is.
    pub emission: Vec3,
    /// Whether the base colour is shown as it is.
    pub is_unlit: bool,
}

impl MaterialPoint {
    /// Those of a material without textures and vertex colours.
    pub(super) fn plain(material: &Material) -> Self {
        let emission = if material.unlit {
            Vec3::ZERO
        } else {
            material.emissive
        };
        Self {
            base_color: material.base_color.truncate(),
            alpha: alpha_of(material, material.base_color),
            emission,
            is_unlit: material.unlit,
        }
    }
}

impl Surface {
    /// Looks up the surface at a hit of a ray.
    pub fn at(stage: &Stage, ray: &Ray, hit: Hit) -> Self {
        Self::on(stage, &StagedFacet::of(stage, hit), ray, hit)
    }

    /// As [`Surface::at`], with the triangles that were met last.
    #[inline(always)]
    pub(super) fn kept(stage: &Stage, facets: &mut Facets, ray: &Ray, hit: Hit) -> Self {
        Self::on(stage, facets.of(stage, hit), ray, hit)
    }

    /// As [`Surface::kept`], with what the cone of the ray covers.
    #[inline]
    pub(super) fn seen(
        stage: &Stage,
        facets: &mut Facets,
        ray: &Ray,
        hit: Hit,
        cone: RayCone,
    ) -> Self {
        let mut surface = Self::kept(stage, facets, ray, hit);
        surface.widen(ray, cone);
        surface
    }

    #[inline(always)]
    fn on(stage: &Stage, of_all: &StagedFacet, ray: &Ray, hit: Hit) -> Self {
        let scene = stage.scene;
        let instance = &scene.instances[hit.instance as usize];
        let mesh = &scene.meshes[instance.mesh as usize];
        let corners = || mesh.triangles[hit.triangle as usize].map(|v| v as usize);
        let weights = of_all.facet.barycentric(ray);
        let mix = |values: [Vec4; 3]| {
            values[0] * (1.0 - weights.u - weights.v)
                + values[1] * weights.u
                + values[2] * weights.v
        };

        // A triangle that its placement squashed to a line is never hit; any unit vector will do.
        let front = of_all
            .front
            .unwrap_or_else(|| -ray.direction.normalize_or(Vec3::NEG_Z));
        let is_front = front.dot(ray.direction) < 0.0;
        let geometric_normal = if is_front { front } else { -front };

        let smooth = (!mesh.normals.is_empty()).then(|| {
            let [a, b, c] = corners().map(|v| mesh.normals[v]);
            // A vertex whose normal is zero says that the triangle's own counts.
            let all = [a, b, c].iter().all(|n| *n != Vec3::ZERO);
            let n = mix([a, b, c].map(|n| n.extend(0.0))).truncate();
            all.then(|| {
                (stage.instances[hit.instance as usize].normal_matrix * n.as_dvec3())
                    .normalize_or_zero()
                    .as_vec3()
            })
        });
        let shading = smooth
            .flatten()
            .filter(|n| *n != Vec3::ZERO)
            .unwrap_or(front);
        let shading = if is_front { shading } else { -shading };
        // A shading normal that looks away from the viewer would be lit from behind.
        let shading_normal = if shading.dot(ray.direction) < 0.0 {
            shading
        } else {
            geometric_normal
        };

        let uv = mesh
            .uv_sets
            .first()
            .filter(|set| !set.is_empty())
            .map_or(Vec2::ZERO, |set| {
                mix(corners().map(|v| set[v].extend(0.0).extend(0.0)))
                    .truncate()
                    .truncate()
            });
        Self {
            hit,
            position: of_all.facet.point(weights),
            geometric_normal,
            shading_normal,
            is_front,
            uv,
            barycentric: (weights.u, weights.v),
            material: of_all.material,
            offset: of_all.offset,
            cone: RayCone::default(),
            footprint: 0.0,
            uv_per_length: of_all.uv_per_length,
            uv_footprint: 0.0,
        }
    }

    /// Takes the cone with which the ray left its origin for what is seen.
    #[inline(always)]
    pub(super) fn widen(&mut self, ray: &Ray, cone: RayCone) {
        let length = ray.direction.length();
        let cone = cone.propagated(self.hit.t * length);
        let cosine = self.geometric_normal.dot(ray.direction) / length;
        let footprint = cone.footprint(cosine);
        // A footprint that is no number stands for the finest detail.
        let is_wide = footprint > 0.0;
        self.cone = cone;
        self.footprint = footprint;
        self.uv_footprint = if is_wide {
            footprint * self.uv_per_length
        } else {
            0.0
        };
    }

    /// The surface as lights see it.
    pub(super) fn receiver(&self, stage: &Stage) -> Receiver {
        let passes = stage.has_transmission && self.material(stage).transmission.is_some();
        Receiver {
            position: self.position,
            normal: if passes {
                Vec3::ZERO
            } else {
                self.geometric_normal
            },
        }
    }

    /// Where a ray that leaves towards `direction` starts: on its side of the surface, clear of rounding.
    pub fn origin_towards(&self, direction: Vec3) -> Vec3 {
        let side = if direction.dot(self.geometric_normal) < 0.0 {
            -self.offset
        } else {
            self.offset
        };
        self.position + self.geometric_normal * side
    }

    /// The material's values here.
    #[inline]
    pub fn material_point(&self, stage: &Stage) -> MaterialPoint {
        let plain = &stage.materials[self.material as usize].point;
        if let Some(point) = plain
            && !stage.instances[self.hit.instance as usize].is_colored
        {
            return *point;
        }
        self.varying_point(stage)
    }

    fn varying_point(&self, stage: &Stage) -> MaterialPoint {
        let material = self.material(stage);
        let color = self.color(stage, material);
        let emission = if material.emissive == Vec3::ZERO || material.unlit {
            Vec3::ZERO
        } else {
            let texel = self.texel(stage, material.emissive_texture, ColorSpace::Srgb);
            material.emissive * texel.truncate()
        };
        MaterialPoint {
            base_color: color.truncate(),
            alpha: self.alpha(stage),
            emission,
            is_unlit: material.unlit,
        }
    }

    /// The share of the light that the surface stops here, as in [`MaterialPoint`]. In the finest detail for all rays: the cutoff of a mask is no mean, so
    /// that wide cones would close its holes, and rays to lights would see others than rays from surfaces.
    pub(super) fn alpha(&self, stage: &Stage) -> f32 {
        let material = self.material(stage);
        if material.has_alpha() {
            let finest = Self {
                footprint: 0.0,
                uv_footprint: 0.0,
                ..*self
            };
            alpha_of(material, finest.color(stage, material))
        } else {
            1.0
        }
    }

    pub(super) fn material<'s>(&self, stage: &Stage<'s>) -> &'s Material {
        &stage.scene.materials[self.material as usize]
    }

    /// A texture's value here; white where there is none.
    #[inline]
    pub(super) fn texel(
        &self,
        stage: &Stage,
        texture: Option<TextureRef>,
        space: ColorSpace,
    ) -> Vec4 {
        let Some(t) = texture else { return Vec4::ONE };
        let (uv, width) = if t.uv_set == 0 {
            (self.uv, self.uv_footprint)
        } else {
            self.patch(stage, &t, self.footprint)
        };
        stage.textures.lookup(stage.scene, &t, uv, space, width)
    }

    /// Colour and alpha with textures and vertex colours.
    #[inline]
    fn color(&self, stage: &Stage, material: &Material) -> Vec4 {
        let mut color = material.base_color
            * self.texel(stage, material.base_color_texture, ColorSpace::Srgb)
            * self.vertex_color(stage);
        if let Some(opacity) = material.opacity {
            let texel = self.texel(stage, Some(opacity.texture), ColorSpace::Linear);
            color.w *= opacity.channel.of(texel);
        }
        color
    }

    pub(super) fn uv_of(&self, stage: &Stage, texture: &TextureRef) -> Vec2 {
        if texture.uv_set == 0 {
            return self.uv;
        }
        let mesh = stage.scene.mesh_of(self.hit.instance);
        let Some(set) = mesh
            .uv_sets
            .get(texture.uv_set as usize)
            .filter(|set| !set.is_empty())
        else {
            return Vec2::ZERO;
        };
        let [a, b, c] = mesh.triangles[self.hit.triangle as usize].map(|v| set[v as usize]);
        let (u, v) = self.barycentric;
        a * (1.0 - u - v) + b * u + c * v
    }

    #[inline]
    fn vertex_color(&self, stage: &Stage) -> Vec4 {
        let mesh = stage.scene.mesh_of(self.hit.instance);
        if mesh.colors.is_empty() {
            return Vec4::ONE;
        }
        let [a, b, c] = mesh.triangles[self.hit.triangle as usize].map(|v| mesh.colors[v as usize]);
        let (u, v) = self.barycentric;
        a * (1.0 - u - v) + b * u + c * v
    }
}

fn alpha_of(material: &Material, color: Vec4) -> f32 {
    match material.alpha_mode {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask { cutoff } => f32::from(u8::from(color.w >= cutoff)),
        AlphaMode::Blend => color.w.clamp(0.0, 1.0),
    }
}
