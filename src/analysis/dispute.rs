//! Which rays the oracle is asked about, and what it says of each method's answers: all rays that the methods disagree about, and a
//! sample of the others.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::accuracy::{Faults, Oracle, judge};
use super::view_rays::{Query, RaySet};
use crate::accel::{Accelerator, Hit};
use crate::geometry::Ray;
use crate::render::Answer;
use crate::scene::Scene;

/// Triangle tests that the oracle may spend on rays of one purpose that nobody disagrees about: some seconds. They find what all methods
/// get wrong.
const SAMPLE_TESTS: u64 = 20_000_000;

/// Triangle tests that it may spend on disagreements of one purpose. Beyond, a disagreement is decided among the triangles
/// that the methods named, which is wrong only where all of them missed the nearest.
const DISAGREEMENT_TESTS: u64 = 1_000_000_000;

/// Wrong rays of one purpose that are kept with their answers.
const KEPT: usize = 8;

/// A ray that somebody answered wrongly.
#[derive(Clone, Debug)]
pub struct WrongRay {
    /// The ray.
    pub ray: Ray,
    /// The true answer.
    pub truth: Answer,
    /// Each method's answer.
    pub answers: Vec<Answer>,
}

/// What the oracle says of the answers to one set.
pub(super) struct Judged {
    pub(super) faults: Vec<Faults>,
    pub(super) disagreements: usize,
    pub(super) decided_among_named: usize,
    pub(super) sampled: usize,
    pub(super) wrong: Vec<WrongRay>,
}

impl Judged {
    pub(super) fn of(
        scene: &Scene,
        accelerators: &[&dyn Accelerator],
        set: &RaySet,
        answers: &[Vec<Answer>],
    ) -> Self {
        let (oracle, query) = (Oracle::new(scene), set.purpose.query());
        let differs = |r: &usize| answers.iter().any(|a| a[*r] != answers[0][*r]);
        let disputed: Vec<usize> = (0..set.rays.len()).filter(differs).collect();
        let affordable = |tests: u64| (tests / scene.placed_triangles().max(1)) as usize;
        let searched = affordable(DISAGREEMENT_TESTS).min(disputed.len());
        let sample = affordable(SAMPLE_TESTS).clamp(1, set.rays.len().max(1));
        let sample: BTreeSet<usize> = (0..sample.min(set.rays.len()))
            .map(|i| i * set.rays.len() / sample)
            .filter(|r| disputed.binary_search(r).is_err())
            .collect();
        let by_all = |&r: &usize| (r, oracle.truth(&set.rays[r], query));
        let mut truths: Vec<(usize, Answer)> = disputed[..searched]
            .par_iter()
            .chain(&sample)
            .map(by_all)
            .collect();
        truths.extend(disputed[searched..].iter().map(|&r| {
            let named = named(accelerators, &set.rays[r], query, answers, r);
            (r, oracle.truth_among(&set.rays[r], query, &named))
        }));
        truths.sort_by_key(|(r, _)| *r);

        let mut faults = vec![Faults::default(); answers.len()];
        let mut wrong = Vec::new();
        for (r, truth) in truths {
            let verdicts: Vec<_> = answers.iter().map(|a| judge(truth, a[r])).collect();
            for (faults, verdict) in faults.iter_mut().zip(&verdicts) {
                verdict.iter().for_each(|&fault| faults.add(fault));
            }
            if verdicts.iter().any(Option::is_some) && wrong.len() < KEPT {
                wrong.push(WrongRay {
                    ray: set.rays[r],
                    truth,
                    answers: answers.iter().map(|a| a[r]).collect(),
                });
            }
        }
        Self {
            faults,
            disagreements: disputed.len(),
            decided_among_named: disputed.len() - searched,
            sampled: sample.len(),
            wrong,
        }
    }
}

/// The hits that any method knows of on a ray: their answers, or, where these only say whether there is one, the nearest hits.
fn named(
    accelerators: &[&dyn Accelerator],
    ray: &Ray,
    query: Query,
    answers: &[Vec<Answer>],
    index: usize,
) -> Vec<Hit> {
    let nearest = |(a, accelerator): (&Vec<Answer>, &&dyn Accelerator)| match (query, a[index]) {
        (Query::Closest, Answer::Closest(hit)) => hit,
        _ => accelerator.closest_hit(ray),
    };
    answers
        .iter()
        .zip(accelerators)
        .filter_map(nearest)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::accuracy::Fault;
    use super::super::compare::compare_set;
    use super::super::measure;
    use super::super::view_rays::RayPurpose;
    use super::*;
    use crate::accel::{AcceleratorKind, BuildStats, TraceCounters};
    use crate::geometry::Interval;
    use glam::Vec3;

    /// Answers wrongly in one way wherever it can.
    struct Liar<'a> {
        honest: &'a dyn Accelerator,
        fault: Fault,
    }

    impl Liar<'_> {
        fn lie(&self, hit: Option<Hit>) -> Option<Hit> {
            let made_up = Hit {
                t: 0.5,
                instance: 0,
                triangle: 3,
            };
            match (self.fault, hit) {
                (Fault::Hole, Some(_)) => None,
                (Fault::Ghost, None) => Some(made_up),
                (Fault::WrongDepth, Some(hit)) => Some(Hit {
                    t: hit.t.next_up(),
                    ..hit
                }),
                (Fault::WrongName, Some(hit)) => Some(Hit {
                    triangle: hit.triangle ^ 1,
                    ..hit
                }),
                (_, hit) => hit,
            }
        }
    }

    impl Accelerator for Liar<'_> {
        fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
            self.lie(self.honest.closest_hit(ray))
        }

        fn any_hit(&self, ray: &Ray) -> bool {
            self.closest_hit(ray).is_some()
        }

        fn closest_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> Option<Hit> {
            self.lie(self.honest.closest_hit_counted(ray, counters))
        }

        fn any_hit_counted(&self, ray: &Ray, counters: &mut TraceCounters) -> bool {
            self.closest_hit_counted(ray, counters).is_some()
        }

        fn build_stats(&self) -> BuildStats {
            self.honest.build_stats()
        }
    }

    fn block() -> Scene {
        crate::import::load(&["models/lecture-block.obj".into()]).unwrap()
    }

    /// Forty rays down on the block, of which some miss.
    fn rays(purpose: RayPurpose) -> RaySet {
        let ray = |i: u8| {
            let x = f32::from(i) * 0.07 - 0.33;
            Ray::new(Vec3::new(x, 5.0, 0.4), Vec3::NEG_Y).within(Interval::new(0.0, 99.0))
        };
        RaySet {
            purpose,
            rays: (0..40).map(ray).collect(),
        }
    }

    #[test]
    fn every_made_up_fault_is_found_and_the_honest_are_not_blamed() {
        let scene = block();
        let honest = AcceleratorKind::Bvh2.build(&scene);
        for purpose in RayPurpose::ALL {
            let set = rays(purpose);
            let hits = set.rays.iter().filter(|r| honest.any_hit(r)).count();
            assert!(hits > 5 && hits < 35);
            for fault in Fault::ALL {
                let liar = Liar {
                    honest: &*honest,
                    fault,
                };
                let is_closest = purpose.query() == Query::Closest;
                let want = match fault {
                    Fault::Hole => hits,
                    Fault::Ghost => 40 - hits,
                    Fault::WrongDepth | Fault::WrongName if is_closest => hits,
                    _ => 0,
                };
                let report = compare_set(&scene, &[&*honest, &liar], &set, 0);
                assert_eq!(report.methods[0].faults.total(), 0);
                let faults = report.methods[1].faults;
                assert_eq!(faults.count(fault), want as u64, "{purpose:?} {fault:?}");
                assert_eq!(faults.total(), want as u64);
                assert_eq!((report.disagreements, report.hits), (want, hits));
                assert_eq!(report.wrong.len(), want.min(KEPT));
                assert_eq!(report.sampled, 40 - want);
            }
        }
    }

    #[test]
    fn what_all_get_wrong_is_found_in_the_sample() {
        let scene = block();
        let honest = AcceleratorKind::Linear.build(&scene);
        let liar = Liar {
            honest: &*honest,
            fault: Fault::Hole,
        };
        let report = compare_set(&scene, &[&liar, &liar], &rays(RayPurpose::Eye), 0);
        assert_eq!(report.disagreements, 0);
        assert!(report.methods.iter().all(|m| m.faults.total() > 5));
    }

    #[test]
    fn a_dispute_beyond_the_budget_is_decided_among_what_was_named() {
        let scene = block();
        let honest = AcceleratorKind::Bvh2.build(&scene);
        let liar = Liar {
            honest: &*honest,
            fault: Fault::Ghost,
        };
        for purpose in [RayPurpose::Eye, RayPurpose::Shadow] {
            let set = rays(purpose);
            let both: [&dyn Accelerator; 2] = [&*honest, &liar];
            let answers = both.map(|a| measure::answers(a, &set)).to_vec();
            let oracle = Oracle::new(&scene);
            for (r, ray) in set.rays.iter().enumerate() {
                let named = named(&both, ray, purpose.query(), &answers, r);
                let truth = oracle.truth_among(ray, purpose.query(), &named);
                assert_eq!(truth, oracle.truth(ray, purpose.query()));
            }
        }
    }
}
