//! Detail by pixels: meshes made as coarse as a picture cannot tell, before any structure is built over them.
//!
//! The error of a simplified mesh is a length in object space, measured at every vertex that was left out ([`deviation`]). What it is worth in pixels depends on where the mesh is
//! seen from, and by way of what: [`budget`] has the rule. A mesh that one instance shows is simplified in pieces, each as coarse as its own distance allows; one that several show gets
//! a level for each octave of what they allow, so that near and far ones share levels with their like, and a level that nobody asks for is never built.
//!
//! Left as they are: surfaces that emit light, that have alpha, or that light passes; borders, of a mesh and of its materials; seams of attributes, along which both sides stay together.

mod budget;
mod chunks;
mod cluster;
mod deviation;
mod levels;
mod simplify;

use rayon::prelude::*;

use self::budget::Budget;
use self::levels::Level;
use super::{CameraFrame, Material, Scene};

/// Triangles below which a mesh is not worth the while.
const LEAST_TRIANGLES: usize = 128;

/// What may be coarser.
#[derive(Clone, Debug)]
pub struct DetailOptions {
    /// Where pictures are taken from.
    pub views: Vec<CameraFrame>,
    /// Width and height of the pictures, in pixels.
    pub size: (u32, u32),
    /// How far any vertex of a mesh may be from the surface that stands for it, in pixels.
    pub budget: f64,
}

/// What became of an instance's triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InstanceDetail {
    /// Those of its mesh as it was.
    pub triangles: u64,
    /// Those that are left.
    pub kept: u64,
    /// The greatest distance of a vertex that was left out from the surface that is left, in pixels; no more than the budget.
    pub error: f64,
}

/// What became of a scene's triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DetailReport {
    /// By instance.
    pub instances: Vec<InstanceDetail>,
    /// Simplified meshes that were made.
    pub levels: usize,
}

impl DetailReport {
    /// Triangles as placed, before.
    pub fn triangles(&self) -> u64 {
        self.instances.iter().map(|i| i.triangles).sum()
    }

    /// Triangles as placed, after.
    pub fn kept(&self) -> u64 {
        self.instances.iter().map(|i| i.kept).sum()
    }

    /// The greatest error of all instances, in pixels.
    pub fn error(&self) -> f64 {
        self.instances.iter().map(|i| i.error).fold(0.0, f64::max)
    }
}

/// Whether surfaces of a material are left as they are: where they end or how they are turned decides more than what they hide.
fn is_protected(material: &Material) -> bool {
    let is_lit = material.emissive != glam::Vec3::ZERO && !material.unlit;
    is_lit || material.has_alpha() || material.transmission.is_some_and(|t| t.factor > 0.0)
}

impl Scene {
    /// The scene with meshes as coarse as the pictures allow, by the threads of the rayon pool in which it is called. Instances, materials and everything else stay as they are.
    ///
    /// ```
    /// use bspray::scene::{DetailOptions, Scene};
    /// let options = DetailOptions { views: Vec::new(), size: (640, 480), budget: 0.5 };
    /// let (scene, report) = Scene::default().simplified(&options);
    /// assert_eq!((scene.placed_triangles(), report.kept()), (0, 0));
    /// ```
    #[must_use]
    pub fn simplified(mut self, options: &DetailOptions) -> (Self, DetailReport) {
        let mut protected: Vec<Vec<bool>> = (self.meshes.iter())
            .map(|mesh| vec![false; mesh.parts.len()])
            .collect();
        for instance in &self.instances {
            let parts = self.parts_of(instance);
            for (part, protected) in parts.zip(&mut protected[instance.mesh as usize]) {
                *protected |= is_protected(&self.materials[part.material as usize]);
            }
        }
        let budget = Budget::new(&self, options);
        let mut shown_by = vec![Vec::new(); self.meshes.len()];
        for (index, instance) in self.instances.iter().enumerate() {
            shown_by[instance.mesh as usize].push(index);
        }
        let instances = &self.instances;
        let meshes = std::mem::take(&mut self.meshes);
        let work = meshes
            .into_par_iter()
            .with_max_len(1)
            .zip(shown_by.par_iter().zip(&protected));
        let levels: Vec<Vec<Level>> = work
            .map(|(mesh, (shown_by, protected))| {
                let is_small = mesh.triangles.len() < LEAST_TRIANGLES;
                match shown_by.as_slice() {
                    [] => vec![Level::whole(mesh, shown_by)],
                    _ if is_small => vec![Level::whole(mesh, shown_by)],
                    &[one] => vec![levels::of_one(
                        mesh,
                        (one, &instances[one]),
                        &budget,
                        protected,
                    )],
                    several => levels::of_several(mesh, several, instances, &budget, protected),
                }
            })
            .collect();
        let mut report = DetailReport {
            instances: vec![InstanceDetail::default(); self.instances.len()],
            levels: 0,
        };
        for level in levels.into_iter().flatten() {
            let mesh = self.meshes.len() as u32;
            report.levels += usize::from(level.is_simplified());
            for &(instance, error) in &level.instances {
                self.instances[instance].mesh = mesh;
                report.instances[instance] = InstanceDetail {
                    triangles: level.full,
                    kept: level.mesh.triangles.len() as u64,
                    error,
                };
            }
            self.meshes.push(level.mesh);
        }
        (self, report)
    }
}
