//! Rays asked again, one by one, of every method and of exact arithmetic.

use super::contestant::Entrant;
use crate::analysis::accuracy::dispute::verdict;
use crate::analysis::accuracy::verdict::Verdict;
use crate::analysis::accuracy::{Fault, Oracle};
use crate::analysis::view_rays::{Query, RaySet};
use crate::geometry::Ray;
use crate::render::Answer;
use crate::scene::Scene;

/// What one method says of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Said {
    /// Its answer.
    pub answer: Answer,
    /// What is wrong with it.
    pub fault: Option<Fault>,
    /// Right but for the name, of a method that does not promise names.
    pub is_unresolved: bool,
}

/// One ray, asked again.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// The ray.
    pub ray: Ray,
    /// The true answer.
    pub truth: Answer,
    /// What each method says.
    pub said: Vec<Said>,
}

/// Asks every method about every ray. The oracle looks at every triangle of the scene for each, with the threads of the rayon pool in which it is called.
pub fn replay(scene: &Scene, entrants: &[Entrant], set: &RaySet) -> Vec<Replayed> {
    let (oracle, query) = (Oracle::new(scene), set.purpose.query());
    let again = |ray: &Ray| {
        let truth = oracle.truth(ray, query);
        let ask = |entrant: &Entrant| {
            let answer = match query {
                Query::Closest => Answer::Closest(entrant.accelerator.closest_hit(ray)),
                Query::Any => Answer::Any(entrant.accelerator.any_hit(ray)),
            };
            let verdict = verdict(&oracle, entrant.contestant, ray, truth, answer);
            Said {
                answer,
                fault: match verdict {
                    Verdict::Wrong(kind) => Some(kind.fault()),
                    Verdict::Right | Verdict::Unresolved => None,
                },
                is_unresolved: verdict == Verdict::Unresolved,
            }
        };
        Replayed {
            ray: *ray,
            truth,
            said: entrants.iter().map(ask).collect(),
        }
    };
    set.rays.iter().map(again).collect()
}

#[cfg(test)]
mod tests {
    use super::super::contestant::Contestant;
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::analysis::view_rays::RayPurpose;
    use glam::Vec3;

    #[test]
    fn rays_get_the_truth_and_every_answer() {
        let scene = crate::import::load(&["models/lecture-block.obj".into()]).unwrap();
        let contestants = [AcceleratorKind::Bsp, AcceleratorKind::Cwbvh].map(Contestant::structure);
        let built = contestants
            .clone()
            .map(|c| c.build(&scene, &Default::default()).unwrap().accelerator);
        let entrants = [0, 1].map(|i| Entrant {
            contestant: &contestants[i],
            accelerator: &*built[i],
        });
        let center = scene.bounds().center();
        let ray = Ray::new(center + Vec3::new(0.1, 9.0, 0.2), Vec3::NEG_Y);
        for purpose in [RayPurpose::Bounce, RayPurpose::Shadow] {
            let set = RaySet {
                purpose,
                rays: vec![ray, Ray::new(ray.origin, Vec3::Y)],
            };
            let [hit, miss] = replay(&scene, &entrants, &set).try_into().unwrap();
            for (ray, is_hit) in [(&hit, true), (&miss, false)] {
                for said in &ray.said {
                    assert_eq!((said.answer, said.fault), (ray.truth, None));
                    assert!(!said.is_unresolved);
                }
                let truth = matches!(ray.truth, Answer::Closest(Some(_)) | Answer::Any(true));
                assert_eq!(truth, is_hit);
            }
        }
    }
}
