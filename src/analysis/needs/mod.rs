//! What a scene holds against what a picture used of it.
//!
//! A triangle is used if a ray that asks what it meets first has it as its answer: rays from the eye, from mirrors, through glass and from matt surfaces. Rays to
//! lights only ask whether anything is there; what stands in their way and is seen by no other ray counts as unused.

mod repeats;
mod watched;

pub use repeats::{MeshRepeats, Repeats};
pub use watched::{Used, Watched};

use crate::accel::BuildStats;
use crate::render::Textures;
use crate::scene::{Image, Scene, TriangleMesh};

/// So many of a kind are in the scene, and so many of them were used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// In the scene.
    pub held: u64,
    /// By the picture.
    pub used: u64,
}

/// What a picture used of its scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Placed meshes; used are those of which a triangle was.
    pub instances: Share,
    /// Meshes.
    pub meshes: Share,
    /// Triangles of meshes: one that several instances show counts once.
    pub triangles: Share,
    /// Triangles in the accelerator; used are those for which it has been built.
    pub structure: Share,
    /// Materials; used are those of triangles that were.
    pub materials: Share,
    /// Images; used are those in which a texel was looked up.
    pub images: Share,
    /// Images of which pixels were read; used as above.
    pub decoded_images: Share,
    /// Bytes of corners, normals and all else that meshes have.
    pub mesh_bytes: Share,
    /// Bytes of pixels that were read; used are those of the levels that are kept, of images that were used.
    pub image_bytes: Share,
    /// Bytes of the coarser levels of images, if all were there; used are those that were built.
    pub level_bytes: Share,
    /// Bytes of the accelerator, as far as it is built.
    pub structure_bytes: u64,
    /// Triangles that are used, for each mesh.
    pub triangles_of_mesh: Vec<u64>,
}

impl Needs {
    /// What the picture used whose rays were watched, and whose textures were looked up there.
    pub fn of(scene: &Scene, used: &Used, textures: &Textures, built: &BuildStats) -> Self {
        let count = |flags: &[bool]| Share {
            held: flags.len() as u64,
            used: flags.iter().filter(|f| **f).count() as u64,
        };
        let triangles_of_mesh: Vec<u64> = (0..scene.meshes.len() as u32)
            .map(|mesh| used.triangles(mesh))
            .collect();
        let is_mesh_used: Vec<bool> = triangles_of_mesh.iter().map(|&n| n > 0).collect();
        let is_image_used: Vec<bool> = (0..scene.images.len() as u32)
            .map(|image| textures.is_used(image))
            .collect();
        let is_decoded = |(image, used): (&Image, &bool)| image.pixels.is_some().then_some(*used);
        let decoded: Vec<bool> = scene
            .images
            .iter()
            .zip(&is_image_used)
            .filter_map(is_decoded)
            .collect();
        Self {
            instances: count(&used.instances()),
            meshes: count(&is_mesh_used),
            triangles: Share {
                held: scene.meshes.iter().map(|m| m.triangles.len() as u64).sum(),
                used: triangles_of_mesh.iter().sum(),
            },
            structure: Share {
                held: built.triangles,
                used: built.triangles - built.unbuilt_triangles,
            },
            materials: count(&used.materials(scene)),
            images: count(&is_image_used),
            decoded_images: count(&decoded),
            mesh_bytes: sum(&scene.meshes, &is_mesh_used, mesh_bytes),
            image_bytes: Share {
                held: scene.images.iter().map(Image::whole_bytes).sum(),
                used: sum(&scene.images, &is_image_used, Image::bytes).used,
            },
            level_bytes: Share {
                held: textures.whole_memory(scene),
                used: textures.memory(),
            },
            structure_bytes: built.bytes,
            triangles_of_mesh,
        }
    }

    /// The names of its shares, in the order of tables.
    pub fn rows(&self) -> [(&'static str, Share); 10] {
        [
            ("instances", self.instances),
            ("meshes", self.meshes),
            ("triangles", self.triangles),
            ("triangles in built cells", self.structure),
            ("materials", self.materials),
            ("images", self.images),
            ("decoded images", self.decoded_images),
            ("mesh bytes", self.mesh_bytes),
            ("decoded image bytes", self.image_bytes),
            ("image level bytes", self.level_bytes),
        ]
    }
}

fn sum<T>(all: &[T], is_used: &[bool], bytes: impl Fn(&T) -> u64) -> Share {
    let mut share = Share::default();
    for (one, is_used) in all.iter().zip(is_used) {
        share.held += bytes(one);
        share.used += if *is_used { bytes(one) } else { 0 };
    }
    share
}

/// Bytes of all that a mesh has for its vertices and triangles.
fn mesh_bytes(mesh: &TriangleMesh) -> u64 {
    let sets: usize = mesh.uv_sets.iter().map(|set| size_of_val(&**set)).sum();
    let bytes = size_of_val(&*mesh.positions)
        + size_of_val(&*mesh.normals)
        + size_of_val(&*mesh.tangents)
        + size_of_val(&*mesh.colors)
        + size_of_val(&*mesh.triangles)
        + sets;
    bytes as u64
}
