//! The scene as a file describes it: meshes in object space, instances that place them, materials,
//! textures, lights and cameras. A [`Scene`] never changes once built.

mod camera;
mod camera_frame;
mod defect;
mod detail;
mod environment;
mod extremes;
mod images;
mod instance;
mod light;
mod material;
mod measure;
mod mesh;
mod seen;
mod texture;

pub use camera::{Camera, Lens, Projection};
pub use camera_frame::{CameraFrame, Pinhole};
pub use defect::{Defect, DefectCause, Note};
pub use detail::{DetailOptions, DetailReport, InstanceDetail};
pub use environment::Sky;
pub use images::{ColorSpace, Image, Pixels, ShownDetail};
pub(crate) use images::{Pyramid, fetch, fetch_four};
pub use instance::Instance;
pub use light::{Light, LightKind};
pub use material::{
    AlphaMode, Bump, Clearcoat, Material, Opacity, OpacityChannel, Sheen, Specular, TextureRef,
    Transmission, UvTransform, Volume,
};
pub use measure::MeshMeasure;
pub use mesh::{MeshError, Outline, Part, TriangleMesh};
pub use texture::{Filter, Texture, Wrap};

use std::path::PathBuf;

/// Everything that a render needs to know of its models.
///
/// Indices are into the vectors beside them: an instance names a mesh, a mesh's part a material, a material
/// a texture, a texture an image.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Meshes, each in its own object space.
    pub meshes: Vec<TriangleMesh>,
    /// Placed meshes; the index is the `id` that pictures show.
    pub instances: Vec<Instance>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Images with the way they are sampled.
    pub textures: Vec<Texture>,
    /// Pixels.
    pub images: Vec<Image>,
    /// Punctual lights, in world space.
    pub lights: Vec<Light>,
    /// The file's cameras, in world space.
    pub cameras: Vec<Camera>,
    /// Every file that was read: the models, their MTL files, buffers and images.
    pub files: Vec<PathBuf>,
    /// What the importer did or left out, for people to read.
    pub notes: Vec<Note>,
    /// Elements of the file that were broken and dropped.
    pub defects: Vec<Defect>,
}

impl Scene {
    /// Adds everything of `other`, renumbered, behind what is here.
    pub fn append(&mut self, mut other: Scene) {
        let mesh = self.meshes.len() as u32;
        let material = self.materials.len() as u32;
        let texture = self.textures.len() as u32;
        let image = self.images.len() as u32;
        for m in &mut other.meshes {
            m.parts.iter_mut().for_each(|p| p.material += material);
        }
        for instance in &mut other.instances {
            instance.mesh += mesh;
            instance.materials.iter_mut().for_each(|m| *m += material);
        }
        for m in &mut other.materials {
            m.texture_refs_mut().for_each(|t| t.texture += texture);
        }
        other.textures.iter_mut().for_each(|t| t.image += image);
        self.meshes.append(&mut other.meshes);
        self.instances.append(&mut other.instances);
        self.materials.append(&mut other.materials);
        self.textures.append(&mut other.textures);
        self.images.append(&mut other.images);
        self.lights.append(&mut other.lights);
        self.cameras.append(&mut other.cameras);
        self.files.append(&mut other.files);
        self.notes.append(&mut other.notes);
        self.defects.append(&mut other.defects);
    }

    /// The mesh that an instance places.
    pub fn mesh_of(&self, instance: u32) -> &TriangleMesh {
        &self.meshes[self.instances[instance as usize].mesh as usize]
    }

    /// The material of a triangle of an instance.
    pub fn material_of(&self, instance: u32, triangle: u32) -> u32 {
        let mesh = self.mesh_of(instance);
        let own = &self.instances[instance as usize].materials;
        if own.is_empty() {
            return mesh.material_of(triangle);
        }
        own[mesh.part_of(triangle)]
    }

    /// The parts of an instance's mesh, with the materials that the instance shows.
    pub fn parts_of<'s>(&'s self, instance: &'s Instance) -> impl Iterator<Item = Part> + 's {
        let parts = self.meshes[instance.mesh as usize].parts.iter();
        parts.enumerate().map(|(number, part)| Part {
            material: instance
                .materials
                .get(number)
                .copied()
                .unwrap_or(part.material),
            ..*part
        })
    }

    /// Whether a material in use emits light evenly, not through a texture.
    pub fn has_constant_emission(&self) -> bool {
        let mut used = self.instances.iter().flat_map(|i| self.parts_of(i));
        used.any(|part| {
            let material = &self.materials[part.material as usize];
            material.emissive != glam::Vec3::ZERO && material.emissive_texture.is_none()
        })
    }

    /// Triangles as placed: a mesh counts once for each instance that shows it.
    pub fn placed_triangles(&self) -> u64 {
        self.instances
            .iter()
            .map(|i| self.meshes[i.mesh as usize].triangles.len() as u64)
            .sum()
    }

    /// For each mesh, points in object space whose hull holds it: the vertices that a triangle uses, or, for a mesh that is placed
    /// so often that these would be more than four million, the corners of its box.
    pub fn clusters(&self) -> Vec<Vec<glam::Vec3>> {
        let mut uses = vec![0_usize; self.meshes.len()];
        self.instances
            .iter()
            .for_each(|i| uses[i.mesh as usize] += 1);
        self.meshes
            .iter()
            .zip(uses)
            .map(|(mesh, uses)| mesh.cluster(MOST_PLACED_POINTS / uses.max(1)))
            .collect()
    }

    /// The points of [`Scene::clusters`] for every instance, in world space.
    pub fn world_points<'s>(
        &'s self,
        clusters: &'s [Vec<glam::Vec3>],
    ) -> impl Iterator<Item = glam::Vec3> + 's {
        let points = |i: &'s Instance| {
            clusters[i.mesh as usize]
                .iter()
                .map(move |&p| i.world_point(p))
        };
        self.instances.iter().flat_map(points)
    }
}

/// Points of one mesh, times its instances, up to which all of them are looked at to find boxes and cameras. More would make
/// thousands of instances of a large mesh as slow as that many meshes.
const MOST_PLACED_POINTS: usize = 4_000_000;

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DAffine3, DVec3, Vec3};

    fn one_triangle(offset: f64) -> Scene {
        let mesh = TriangleMesh {
            positions: vec![
                Vec3::ZERO,
                Vec3::X,
                Vec3::new(0.0, 2.0, 0.0),
                Vec3::splat(99.0),
            ],
            triangles: vec![[0, 1, 2]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 1,
                material: 0,
            }],
            ..TriangleMesh::default()
        };
        let material = Material {
            base_color_texture: Some(TextureRef {
                texture: 0,
                ..TextureRef::default()
            }),
            ..Material::default()
        };
        Scene {
            meshes: vec![mesh],
            instances: vec![Instance::new(
                "a",
                0,
                DAffine3::from_translation(DVec3::new(offset, 0.0, 0.0)),
            )],
            materials: vec![material],
            textures: vec![Texture::default()],
            images: vec![Image::default()],
            ..Scene::default()
        }
    }

    #[test]
    fn appended_scenes_keep_their_own_indices() {
        let mut scene = one_triangle(0.0);
        scene.append(one_triangle(10.0));
        assert_eq!(scene.instances[1].mesh, 1);
        assert_eq!(scene.material_of(1, 0), 1);
        assert_eq!(
            scene.materials[1].base_color_texture.map(|t| t.texture),
            Some(1)
        );
        assert_eq!(scene.textures[1].image, 1);
        assert_eq!(scene.placed_triangles(), 2);
    }

    #[test]
    fn bounds_ignore_vertices_that_no_triangle_uses() {
        let bounds = one_triangle(5.0).bounds();
        assert_eq!(
            (bounds.min, bounds.max),
            (Vec3::new(5.0, 0.0, 0.0), Vec3::new(6.0, 2.0, 0.0))
        );
    }
}
