//! Embree's triangle test without its tree: each triangle in a scene of its own. A tree of one triangle is a leaf, which has no box to miss.

use std::collections::HashMap;
use std::sync::OnceLock;

use super::sweeps::shapes::scene_of;
use crate::accel::{Accelerator, Embree, EmbreeMode, EmbreeScene, Hit, world_triangles};
use crate::geometry::{Ray, Triangle};
use crate::scene::Scene;

/// A triangle that is like no other one, with the first of its names, in a scene that is built when it is first asked.
struct Single {
    triangle: Triangle,
    name: (u32, u32),
    scene: OnceLock<EmbreeScene>,
}

/// All triangles, one after the other.
pub(super) struct Alone {
    singles: Vec<Single>,
    embree: Embree,
    mode: EmbreeMode,
}

impl Alone {
    pub(super) fn build(scene: &Scene, embree: &Embree, mode: EmbreeMode) -> Self {
        let (mut singles, mut known) = (Vec::new(), HashMap::new());
        for (name, triangle) in world_triangles(scene) {
            let bits = triangle.corners().map(|p| p.to_array().map(f32::to_bits));
            if known.insert(bits, ()).is_none() {
                singles.push(Single {
                    triangle,
                    name,
                    scene: OnceLock::new(),
                });
            }
        }
        Self {
            singles,
            embree: embree.clone(),
            mode,
        }
    }

    /// The nearest hit; of equal ones the first.
    pub(super) fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        for single in &self.singles {
            let scene = single.scene.get_or_init(|| self.scene_of(&single.triangle));
            if let Some(hit) = scene.closest_hit(ray)
                && nearest.is_none_or(|best| hit.t < best.t)
            {
                let (instance, triangle) = single.name;
                nearest = Some(Hit {
                    t: hit.t,
                    instance,
                    triangle,
                });
            }
        }
        nearest
    }

    fn scene_of(&self, triangle: &Triangle) -> EmbreeScene {
        let corners = triangle.corners().map(|p| p.as_dvec3());
        let scene = scene_of(&corners, &[[0, 1, 2]]);
        let built = self.embree.build(&scene, self.mode);
        // As a method that cannot be built.
        built.unwrap_or_else(|error| panic!("{error}"))
    }
}
