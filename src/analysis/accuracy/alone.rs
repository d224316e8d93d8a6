//! Embree's triangle test without its tree: each triangle in a scene of its own. A tree of one triangle is a leaf, which has no box to miss.

use std::collections::HashSet;
use std::sync::OnceLock;

use crate::accel::{Accelerator, Embree, EmbreeMode, EmbreeScene, Hit};
use crate::analysis::plain_scene::scene_of;
use crate::geometry::{Ray, Triangle};

/// A triangle that is like no other one, with the first of its names, in a scene that is built when it is first asked.
struct Single {
    triangle: Triangle,
    name: (u32, u32),
    scene: OnceLock<EmbreeScene>,
}

/// Some triangles, one after the other.
pub(in crate::analysis) struct Alone {
    singles: Vec<Single>,
    embree: Embree,
    mode: EmbreeMode,
}

impl Alone {
    /// Of these triangles in world space, by instance and triangle.
    pub(in crate::analysis) fn of(
        triangles: Vec<((u32, u32), Triangle)>,
        embree: &Embree,
        mode: EmbreeMode,
    ) -> Self {
        let mut known = HashSet::new();
        let mut is_new = |triangle: &Triangle| {
            let corners = triangle.corners();
            known.insert(corners.map(|p| p.to_array().map(f32::to_bits)))
        };
        let singles = triangles.into_iter().filter(|(_, t)| is_new(t));
        let single = |(name, triangle)| Single {
            triangle,
            name,
            scene: OnceLock::new(),
        };
        Self {
            singles: singles.map(single).collect(),
            embree: embree.clone(),
            mode,
        }
    }

    /// The nearest hit; of equal ones the first.
    pub(in crate::analysis) fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
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
