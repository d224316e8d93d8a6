//! The true answers to the rays of one case, by exact arithmetic over every triangle; copies of a triangle are decided once.

use std::collections::HashMap;

use crate::accel::{Hit, TestSpaces};
use crate::analysis::accuracy::{Oracle, exact_hit};
use crate::geometry::{Ray, Triangle};
use crate::scene::Scene;

/// What a ray truly meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Truth {
    /// The least (t, instance, triangle).
    pub(super) hit: Option<Hit>,
    /// Other triangles are hit at depths that round to the same `t`.
    pub(super) is_tied: bool,
}

/// Triangles that are equal, under the least of their names.
struct Unique {
    triangle: Triangle,
    index: u32,
    has_copies: bool,
}

/// The triangles of a scene, by instance.
pub(super) struct Truths<'a> {
    scene: &'a Scene,
    spaces: TestSpaces,
    /// Decides about single triangles.
    pub(super) oracle: Oracle<'a>,
    instances: Vec<Vec<Unique>>,
}

impl<'a> Truths<'a> {
    pub(super) fn of(scene: &'a Scene) -> Self {
        let spaces = TestSpaces::of(scene);
        let any = Ray::new(glam::Vec3::ZERO, glam::Vec3::X);
        let instances = (0..scene.instances.len() as u32).map(|instance| {
            let (mut unique, mut known) = (Vec::<Unique>::new(), HashMap::new());
            for index in 0..scene.mesh_of(instance).triangles.len() as u32 {
                let (_, triangle) = spaces.test(scene, &any, instance, index);
                let bits = triangle.corners().map(|p| p.to_array().map(f32::to_bits));
                let at = *known.entry(bits).or_insert(unique.len());
                match unique.get_mut(at) {
                    Some(same) => same.has_copies = true,
                    None => unique.push(Unique {
                        triangle,
                        index,
                        has_copies: false,
                    }),
                }
            }
            unique
        });
        let instances = instances.collect();
        Self {
            scene,
            spaces,
            oracle: Oracle::new(scene),
            instances,
        }
    }

    pub(super) fn truth(&self, ray: &Ray) -> Truth {
        let (mut best, mut is_tied) = (None::<Hit>, false);
        for (instance, unique) in (0..).zip(&self.instances) {
            let Some(first) = unique.first() else {
                continue;
            };
            let (ray, _) = self.spaces.test(self.scene, ray, instance, first.index);
            if !ray.is_traceable() {
                continue;
            }
            for of in unique {
                let Some(t) = exact_hit(&ray, &of.triangle) else {
                    continue;
                };
                if best.is_none_or(|hit| t < hit.t) {
                    is_tied = of.has_copies;
                    best = Some(Hit {
                        t,
                        instance,
                        triangle: of.index,
                    });
                } else if best.is_some_and(|hit| t <= hit.t) {
                    is_tied = true;
                }
            }
        }
        Truth { hit: best, is_tied }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sweeps::Sweep;
    use super::*;
    use crate::analysis::Query;
    use crate::render::Answer;

    #[test]
    fn copies_decided_once_and_the_oracle_agree() {
        let mut ties = 0;
        for (name, value) in [
            ("coincident", 30.0),
            ("back-to-back", 10.0),
            ("determinant", 1e-3),
        ] {
            let sweep = Sweep::named(name).unwrap();
            let case = sweep.case(value, 40, 7);
            let (truths, oracle) = (Truths::of(&case.scene), Oracle::new(&case.scene));
            for ray in &case.rays {
                let truth = truths.truth(ray);
                assert_eq!(
                    oracle.truth(ray, Query::Closest),
                    Answer::Closest(truth.hit)
                );
                ties += u32::from(truth.is_tied);
                if let Some(hit) = truth.hit {
                    assert_eq!(oracle.hit_of(ray, hit.instance, hit.triangle), Some(hit.t));
                }
                assert_eq!(oracle.hit_of(ray, 99, 0), None);
            }
        }
        assert!(ties > 20, "{ties}");
    }
}
