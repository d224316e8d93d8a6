//! What rays truly hit.

use rayon::prelude::*;

use crate::accel::{Hit, TestSpaces};
use crate::analysis::view_rays::Query;
use crate::geometry::{Ray, Triangle, exact};
use crate::render::Answer;
use crate::scene::Scene;

/// Decides what rays hit.
pub struct Oracle<'a> {
    scene: &'a Scene,
    spaces: TestSpaces,
}

impl<'a> Oracle<'a> {
    /// The oracle of a scene.
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            spaces: TestSpaces::of(scene),
        }
    }

    /// The true answer, by every triangle of the scene, with the threads of the rayon pool in which it is called.
    pub fn truth(&self, ray: &Ray, query: Query) -> Answer {
        let names = (0..self.scene.instances.len() as u32).into_par_iter();
        let hits = names.flat_map(|instance| {
            let count = self.scene.mesh_of(instance).triangles.len() as u32;
            (0..count)
                .into_par_iter()
                .with_min_len(1024)
                .filter_map(move |triangle| self.hit(ray, instance, triangle))
        });
        match query {
            Query::Closest => Answer::Closest(hits.min_by(order)),
            Query::Any => Answer::Any(hits.find_any(|_| true).is_some()),
        }
    }

    /// The true answer if the ray hits nothing but some of the triangles that `named` names; what it says of where does not count.
    pub fn truth_among(&self, ray: &Ray, query: Query, named: &[Hit]) -> Answer {
        let of = |h: &Hit| self.hit(ray, h.instance, h.triangle);
        let nearest = named.iter().filter_map(of).min_by(order);
        match query {
            Query::Closest => Answer::Closest(nearest),
            Query::Any => Answer::Any(nearest.is_some()),
        }
    }

    fn hit(&self, ray: &Ray, instance: u32, triangle: u32) -> Option<Hit> {
        let t = self.hit_of(ray, instance, triangle)?;
        Some(Hit {
            t,
            instance,
            triangle,
        })
    }

    /// Where the ray truly hits the triangle of that name; a name that nobody has is not hit.
    pub fn hit_of(&self, ray: &Ray, instance: u32, triangle: u32) -> Option<f32> {
        let (ray, tested) = self.tested(ray, instance, triangle)?;
        exact_hit(&ray, &tested)
    }

    /// The ray and the triangle of that name in the space in which they are tested.
    pub(in crate::analysis) fn tested(
        &self,
        ray: &Ray,
        instance: u32,
        triangle: u32,
    ) -> Option<(Ray, Triangle)> {
        let placed = self.scene.instances.get(instance as usize)?;
        let count = self.scene.meshes[placed.mesh as usize].triangles.len();
        ((triangle as usize) < count).then(|| self.spaces.test(self.scene, ray, instance, triangle))
    }
}

/// Where a ray hits a triangle of the same space.
pub(in crate::analysis) fn exact_hit(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    // The same in two steps: integers are needed for few, and cost a hundred times as much.
    exact::meets(ray, triangle).then_some(())?;
    exact::intersect(ray, triangle)
}

/// The order in which hits win.
fn order(a: &Hit, b: &Hit) -> std::cmp::Ordering {
    a.t.total_cmp(&b.t)
        .then((a.instance, a.triangle).cmp(&(b.instance, b.triangle)))
}

#[cfg(test)]
mod tests {
    use super::super::judge;
    use super::*;
    use crate::accel::AcceleratorKind;
    use glam::Vec3;

    #[test]
    fn the_oracle_and_brute_force_agree_also_on_edges_and_instances() {
        let scene = crate::import::load(&["models/lecture-objects.gltf".into()]).unwrap();
        let (oracle, linear) = (Oracle::new(&scene), AcceleratorKind::Linear.build(&scene));
        let center = scene.bounds().center();
        for i in 0..60_u8 {
            let place = f32::from(i);
            let origin = center + Vec3::new(place - 30.0, 20.0, 5.0 - place * 0.3);
            let ray = Ray::new(origin, center - origin + Vec3::new(0.0, -4.0, place * 0.2));
            let truth = oracle.truth(&ray, Query::Closest);
            let hit = linear.closest_hit(&ray);
            assert_eq!(judge(truth, Answer::Closest(hit)), None, "{ray:?}");
            let any = oracle.truth(&ray, Query::Any);
            assert_eq!(judge(any, Answer::Any(hit.is_some())), None);
            if let Some(hit) = hit {
                // What is said of the place does not count, and nor does a name that is nobody's.
                let rumours = [
                    Hit { t: -3.0, ..hit },
                    Hit {
                        instance: 999,
                        ..hit
                    },
                ];
                assert_eq!(oracle.truth_among(&ray, Query::Closest, &rumours), truth);
                let nobody = oracle.truth_among(&ray, Query::Any, &rumours[1..]);
                assert_eq!(nobody, Answer::Any(false));
            }
        }
    }
}
