//! Normals from normal maps and height maps.
//!
//! A normal map's vectors count along the tangent, where u grows, the bitangent, up in the image, and the shading normal (glTF 2.0,
//! section 3.9.3). Tangents are the file's, or are made as Mikkelsen's algorithm has it. That gives one for each corner
//! of a triangle; corners of one vertex have the same nearly everywhere, since files split vertices at seams. So a mesh keeps one a vertex (16
//! bytes) and a list of the corners that differ (20 bytes each), not 48 bytes a triangle, and its vertices stay those of the point
//! cluster.

use glam::{DVec3, Vec2, Vec3, Vec4};
use rayon::prelude::*;

use super::mikktspace::corner_tangents;
use super::ray_cone::{uv_per_length, uv_width_per_length};
use super::stage::Stage;
use super::surface::Surface;
use super::texture::ColorSpace;
use crate::scene::{Bump, Scene, TextureRef, TriangleMesh};

/// Height of a white texel of a height map at a factor of 1, as a share of the length over which the texture's coordinates
/// grow by 1. MTL names no unit. With this, a slope over ten texels of an image of 1,024 is one of about 45 degrees.
const BUMP_HEIGHT: f32 = 1.0 / 96.0;

/// The tangents that had to be made, by mesh.
#[derive(Debug, Default)]
pub(super) struct Tangents {
    meshes: Vec<MeshTangents>,
}

#[derive(Debug, Default)]
struct MeshTangents {
    /// One a vertex; empty where the file has them, or nothing shows them.
    vertices: Vec<Vec4>,
    /// Corners (three times the triangle, and its corner) that differ from their vertex, ascending.
    corners: Vec<(u32, Vec4)>,
}

impl Tangents {
    /// Makes the tangents of meshes whose materials have normal maps and that have none, on rayon's current threads.
    pub(super) fn new(scene: &Scene) -> Self {
        let meshes = scene.meshes.par_iter();
        Self {
            meshes: meshes.map(|m| MeshTangents::new(scene, m)).collect(),
        }
    }

    /// The tangents of a triangle's corners; zero where there is none.
    fn of(&self, mesh: &TriangleMesh, index: u32, triangle: u32) -> [Vec4; 3] {
        let made = &self.meshes[index as usize];
        let vertices = if mesh.tangents.is_empty() {
            &made.vertices
        } else {
            &mesh.tangents
        };
        let mut corner = 3 * triangle;
        mesh.triangles[triangle as usize].map(|vertex| {
            let found = made.corners.binary_search_by_key(&corner, |c| c.0);
            corner += 1;
            match found {
                Ok(place) => made.corners[place].1,
                Err(_) => vertices.get(vertex as usize).copied().unwrap_or_default(),
            }
        })
    }
}

impl MeshTangents {
    fn new(scene: &Scene, mesh: &TriangleMesh) -> Self {
        if !mesh.tangents.is_empty() {
            return Self::default();
        }
        let shown = mesh.parts.iter().flat_map(|part| {
            let set = scene.materials[part.material as usize].normal_uv_set();
            let triangles = part.first_triangle..part.first_triangle + part.triangle_count;
            set.into_iter()
                .flat_map(move |set| triangles.clone().map(move |t| (t, set)))
        });
        let shown: Vec<(u32, u32)> = shown.collect();
        let mut made = Self::default();
        if shown.is_empty() {
            return made;
        }
        made.vertices.resize(mesh.positions.len(), Vec4::ZERO);
        let tangents = corner_tangents(mesh, &shown);
        for ((triangle, _), tangents) in shown.iter().zip(tangents) {
            let vertices = mesh.triangles[*triangle as usize];
            for (corner, (vertex, tangent)) in (0..).zip(vertices.into_iter().zip(tangents)) {
                let known = &mut made.vertices[vertex as usize];
                if *known == Vec4::ZERO {
                    *known = tangent;
                } else if *known != tangent {
                    made.corners.push((3 * triangle + corner, tangent));
                }
            }
        }
        made
    }
}

impl Surface {
    /// The normal that light sees, by the material's normal map or else its height map: [`Surface::shading_normal`] where it has neither.
    /// It may look away from the eye. `footprint` is the width of the patch that is seen, in model units (0 for the finest detail).
    pub fn mapped_normal(&self, stage: &Stage, footprint: f32) -> Vec3 {
        let material = &stage.scene.materials[self.material as usize];
        if let Some(texture) = &material.normal_texture {
            let (uv, width) = self.patch(stage, texture, footprint);
            return perturbed_normal(stage, self, texture, material.normal_scale, uv, width);
        }
        if let Some(bump) = &material.bump {
            let (uv, width) = self.patch(stage, &bump.texture, footprint);
            return bumped_normal(stage, self, bump, uv, width);
        }
        self.shading_normal
    }

    /// The normal of the material's clear coat, as [`Surface::mapped_normal`] is that of what lies below.
    pub fn coat_normal(&self, stage: &Stage, footprint: f32) -> Vec3 {
        let material = &stage.scene.materials[self.material as usize];
        let coat = material.clearcoat.as_ref();
        let Some((coat, texture)) = coat.and_then(|c| Some((c, c.normal_texture.as_ref()?))) else {
            return self.shading_normal;
        };
        let (uv, width) = self.patch(stage, texture, footprint);
        perturbed_normal(stage, self, texture, coat.normal_scale, uv, width)
    }

    /// Where a texture is looked up here, in its set of coordinates, and over which width for a patch of `footprint` model units.
    pub fn patch(&self, stage: &Stage, texture: &TextureRef, footprint: f32) -> (Vec2, f32) {
        let uv = self.uv_of(stage, texture);
        if footprint.is_nan() || footprint <= 0.0 {
            return (uv, 0.0);
        }
        let instance = &stage.scene.instances[self.hit.instance as usize];
        let mesh = &stage.scene.meshes[instance.mesh as usize];
        let Some(set) = mesh.uv_sets.get(texture.uv_set as usize) else {
            return (uv, 0.0);
        };
        let corners = mesh.triangles[self.hit.triangle as usize].map(|v| v as usize);
        let points = corners.map(|v| instance.world_point(mesh.positions[v]));
        let uvs = corners.map(|v| set.get(v).copied().unwrap_or_default());
        (uv, footprint * uv_width_per_length(points, uvs))
    }
}

/// The tangent and the bitangent at a surface, of unit length, for the normal of its front (`shading_normal` turned to the front). `None`
/// where texture coordinates give none.
pub(super) fn tangent_frame(stage: &Stage, surface: &Surface) -> Option<(Vec3, Vec3)> {
    let scene = stage.scene;
    let instance = &scene.instances[surface.hit.instance as usize];
    let mesh = &scene.meshes[instance.mesh as usize];
    let [a, b, c] = stage.tangents.of(mesh, instance.mesh, surface.hit.triangle);
    if [a, b, c].contains(&Vec4::ZERO) {
        return None;
    }
    let (u, v) = surface.barycentric;
    let mixed = a * (1.0 - u - v) + b * u + c * v;
    let object = mixed.truncate().as_dvec3();
    let world = instance.world_from_object.matrix3 * object;
    let tangent = world.try_normalize()?.as_vec3();
    let is_mirrored = stage.instances[surface.hit.instance as usize].is_mirrored;
    let side = if (mixed.w < 0.0) == is_mirrored {
        1.0
    } else {
        -1.0
    };
    let bitangent = front_normal(surface).cross(tangent) * side;
    Some((tangent, bitangent.try_normalize()?))
}

/// The normal that a normal map gives at a surface, on the side of `shading_normal`; that itself where there are no tangents.
///
/// `scale` multiplies the x and y of the map's vectors, `width_uv` is the footprint of the lookup at `uv`.
pub(super) fn perturbed_normal(
    stage: &Stage,
    surface: &Surface,
    texture: &TextureRef,
    scale: f32,
    uv: Vec2,
    width_uv: f32,
) -> Vec3 {
    let Some((tangent, bitangent)) = tangent_frame(stage, surface) else {
        return surface.shading_normal;
    };
    let textures = &stage.textures;
    let texel = textures.lookup(stage.scene, texture, uv, ColorSpace::Linear, width_uv);
    let [x, y, z] = (texel.truncate() * 2.0 - 1.0).to_array();
    let front = front_normal(surface);
    let normal = tangent * (x * scale) + bitangent * (y * scale) + front * z;
    turned(surface, normal.normalize_or(front))
}

/// The normal that a height map gives at a surface, on the side of `shading_normal`, by the gradient of the heights along the surface
/// (Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU", JGT 2010).
pub(super) fn bumped_normal(
    stage: &Stage,
    surface: &Surface,
    bump: &Bump,
    uv: Vec2,
    width_uv: f32,
) -> Vec3 {
    let scene = stage.scene;
    let instance = &scene.instances[surface.hit.instance as usize];
    let mesh = &scene.meshes[instance.mesh as usize];
    let corners = mesh.triangles[surface.hit.triangle as usize].map(|v| v as usize);
    let Some(set) = mesh.uv_sets.get(bump.texture.uv_set as usize) else {
        return surface.shading_normal;
    };
    if set.is_empty() {
        return surface.shading_normal;
    }
    let points = corners.map(|v| instance.world_point(mesh.positions[v]));
    let uvs = corners.map(|v| set[v]);
    let gradient = height_slopes(stage, &bump.texture, uv, width_uv);
    let front = front_normal(surface);
    let slope = surface_gradient(points, uvs, gradient, front);
    let height = bump.scale * BUMP_HEIGHT / uv_per_length(points, uvs);
    let normal = front - slope * height;
    // Not finite where the triangle has no area in the texture.
    if !normal.is_finite() {
        return surface.shading_normal;
    }
    turned(surface, normal.normalize_or(front))
}

/// How fast heights grow along u and v.
fn height_slopes(stage: &Stage, texture: &TextureRef, uv: Vec2, width_uv: f32) -> Vec2 {
    let scene = stage.scene;
    let image = &scene.images[scene.textures[texture.texture as usize].image as usize];
    // Half a texel to either side, or half the footprint where that is wider.
    let shrink = texture.transform.matrix2.determinant().abs().sqrt();
    let step = |side: u32| (0.5 / (side.max(1) as f32 * shrink)).max(0.5 * width_uv);
    let (du, dv) = (step(image.width), step(image.height));
    let height = |offset: Vec2| {
        let textures = &stage.textures;
        let at = uv + offset;
        textures
            .lookup(scene, texture, at, ColorSpace::Linear, width_uv)
            .x
    };
    let along = |d: Vec2| height(d) - height(-d);
    Vec2::new(
        along(Vec2::X * du) / (2.0 * du),
        along(Vec2::Y * dv) / (2.0 * dv),
    )
}

/// The gradient in space of a value that grows by `slopes` along u and v on a triangle, across `normal`. Not finite without an
/// area in the texture.
fn surface_gradient(
    [a, b, c]: [Vec3; 3],
    [p, q, r]: [Vec2; 3],
    slopes: Vec2,
    normal: Vec3,
) -> Vec3 {
    let (e, f) = ((b - a).as_dvec3(), (c - a).as_dvec3());
    let (s, t) = ((q - p).as_dvec2(), (r - p).as_dvec2());
    let det = s.perp_dot(t);
    let along_u = (e * t.y - f * s.y) / det;
    let along_v = (f * s.x - e * t.x) / det;
    let normal: DVec3 = normal.as_dvec3();
    let across_u = along_v.cross(normal);
    let across_v = normal.cross(along_u);
    let volume = along_u.dot(across_u);
    let slopes = slopes.as_dvec2();
    ((across_u * slopes.x + across_v * slopes.y) / volume).as_vec3()
}

/// The shading normal of the front, whichever side is seen.
fn front_normal(surface: &Surface) -> Vec3 {
    turned(surface, surface.shading_normal)
}

/// From the front's side to the side that is seen, and back.
fn turned(surface: &Surface, normal: Vec3) -> Vec3 {
    if surface.is_front { normal } else { -normal }
}

#[cfg(test)]
mod tests;
