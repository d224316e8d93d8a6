//! An accelerator that notes which triangles its rays meet.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::accel::{Accelerator, BuildStats, Hit, TraceCounters};
use crate::geometry::Ray;
use crate::scene::Scene;

/// An accelerator with the same answers as another, which notes the hits it gives.
pub struct Watched {
    accelerator: Box<dyn Accelerator>,
    used: Arc<Used>,
}

/// Which instances and triangles were hit. Any number of threads may note hits at once.
#[derive(Debug)]
pub struct Used {
    instances: Vec<AtomicBool>,
    mesh_of_instance: Vec<u32>,
    /// Where the bits of each mesh begin; one more for the end.
    first_word: Vec<usize>,
    /// A bit a triangle.
    words: Vec<AtomicU64>,
}

impl Watched {
    /// Watches an accelerator of this scene.
    pub fn new(accelerator: Box<dyn Accelerator>, scene: &Scene) -> (Self, Arc<Used>) {
        let used = Arc::new(Used::nothing(scene));
        let watched = Self {
            accelerator,
            used: Arc::clone(&used),
        };
        (watched, used)
    }
}

impl Used {
    fn nothing(scene: &Scene) -> Self {
        let mut first_word = vec![0];
        let mut end = 0;
        for mesh in &scene.meshes {
            end += mesh.triangles.len().div_ceil(64);
            first_word.push(end);
        }
        let no = |_: &_| AtomicBool::new(false);
        Self {
            instances: scene.instances.iter().map(no).collect(),
            mesh_of_instance: scene.instances.iter().map(|i| i.mesh).collect(),
            first_word,
            words: (0..end).map(|_| AtomicU64::new(0)).collect(),
        }
    }

    fn note(&self, hit: &Hit) {
        let instance = hit.instance as usize;
        let mesh = self.mesh_of_instance[instance] as usize;
        let word = &self.words[self.first_word[mesh] + hit.triangle as usize / 64];
        let bit = 1 << (hit.triangle % 64);
        // Mostly it is there already, and a write would take the line from other threads.
        if word.load(Ordering::Relaxed) & bit == 0 {
            word.fetch_or(bit, Ordering::Relaxed);
        }
        if !self.instances[instance].load(Ordering::Relaxed) {
            self.instances[instance].store(true, Ordering::Relaxed);
        }
    }

    /// Triangles of a mesh that were hit.
    pub fn triangles(&self, mesh: u32) -> u64 {
        let words = self.words_of(mesh).iter();
        words
            .map(|w| u64::from(w.load(Ordering::Relaxed).count_ones()))
            .sum()
    }

    fn words_of(&self, mesh: u32) -> &[AtomicU64] {
        &self.words[self.first_word[mesh as usize]..self.first_word[mesh as usize + 1]]
    }

    /// Whether a triangle of a mesh was hit.
    pub fn is_used(&self, mesh: u32, triangle: u32) -> bool {
        let word = &self.words_of(mesh)[triangle as usize / 64];
        word.load(Ordering::Relaxed) >> (triangle % 64) & 1 != 0
    }

    /// For each instance, whether it was hit.
    pub fn instances(&self) -> Vec<bool> {
        let instances = self.instances.iter();
        instances.map(|i| i.load(Ordering::Relaxed)).collect()
    }

    /// For each material of the scene, whether an instance was hit that has it, and a triangle that this shows with it, if only elsewhere.
    pub fn materials(&self, scene: &Scene) -> Vec<bool> {
        let mut materials = vec![false; scene.materials.len()];
        let hit = scene.instances.iter().zip(self.instances());
        for instance in hit.filter(|(_, is_hit)| *is_hit).map(|(i, _)| i) {
            for part in scene.parts_of(instance) {
                let mut triangles = part.first_triangle..part.first_triangle + part.triangle_count;
                if let Some(material) = materials.get_mut(part.material as usize) {
                    *material |= triangles.any(|t| self.is_used(instance.mesh, t));
                }
            }
        }
        materials
    }
}

impl Accelerator for Watched {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.accelerator
            .closest_hit(ray)
            .inspect(|hit| self.used.note(hit))
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        self.accelerator.any_hit(ray)
    }

    fn closest_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> Option<Hit> {
        let hit = self.accelerator.closest_hit_counted(ray, counters);
        hit.inspect(|hit| self.used.note(hit))
    }

    fn any_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> bool {
        self.accelerator.any_hit_counted(ray, counters)
    }

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.accelerator.closest_hits(rays, hits);
        hits.iter().flatten().for_each(|hit| self.used.note(hit));
    }

    fn any_hits(&self, rays: &[Ray], hits: &mut [bool]) {
        self.accelerator.any_hits(rays, hits);
    }

    fn build_stats(&self) -> BuildStats {
        self.accelerator.build_stats()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::scene::{Instance, Material, Part, TriangleMesh};
    use glam::{DAffine3, DVec3, Vec3};

    /// Rows of 100 triangles along x, one above the other, the second placed once more far off.
    fn scene() -> Scene {
        let positions = (0..100).flat_map(|i| {
            let at = Vec3::X * i as f32;
            [at, at + Vec3::X, at + Vec3::Y]
        });
        let part = |first_triangle, triangle_count, material| Part {
            first_triangle,
            triangle_count,
            material,
        };
        let mesh = TriangleMesh {
            positions: positions.collect(),
            triangles: (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            parts: vec![part(0, 70, 0), part(70, 30, 1)],
            ..TriangleMesh::default()
        };
        let place = |mesh, z| {
            let at = DAffine3::from_translation(DVec3::new(0.0, 0.0, z));
            Instance::new("", mesh, at)
        };
        Scene {
            meshes: vec![mesh.clone(), mesh],
            instances: vec![place(0, 1.0), place(1, 0.0), place(1, -9.0)],
            materials: vec![Material::default(); 2],
            ..Scene::default()
        }
    }

    #[test]
    fn what_rays_meet_is_noted_and_what_only_shadows_meet_is_not() {
        let scene = scene();
        let (watched, used) = Watched::new(AcceleratorKind::Bsp.build(&scene), &scene);
        let down = |x: f32| Ray::new(Vec3::new(x + 0.2, 0.2, 5.0), Vec3::NEG_Z);
        assert!(watched.any_hit(&down(50.0)));
        assert_eq!((used.triangles(0), used.triangles(1)), (0, 0));
        watched.closest_hit(&down(2.0));
        watched.closest_hit(&down(2.0));
        watched.closest_hit_counted(&down(64.0), &mut TraceCounters::default());
        let mut hits = [None; 2];
        watched.closest_hits(&[down(99.0), down(-7.0)], &mut hits);
        assert_eq!(hits.iter().flatten().count(), 1);
        assert_eq!((used.triangles(0), used.triangles(1)), (3, 0));
        assert!(used.is_used(0, 2) && used.is_used(0, 64) && !used.is_used(0, 65));
        assert_eq!(used.materials(&scene), [true, true]);
        assert_eq!(used.instances(), [true, false, false]);
        // From below the third is met first; it shows the second mesh.
        watched.closest_hit(&Ray::new(Vec3::new(5.2, 0.2, -20.0), Vec3::Z));
        assert_eq!(used.instances(), [true, false, true]);
        assert_eq!(used.triangles(1), 1);
    }
}
