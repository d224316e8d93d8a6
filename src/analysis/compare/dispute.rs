//! Which rays the oracle is asked about, and what it says of each method's answers: all rays that the methods disagree about, and a
//! sample of the others.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::blame::BruteForces;
use super::contestant::{Contestant, Entrant};
use crate::accel::Hit;
use crate::analysis::accuracy::{Fault, Faults, Oracle, judge};
use crate::analysis::stability::verdict::{Verdict, of_exact, of_plausible};
use crate::analysis::stability::{Blame, Kind};
use crate::analysis::view_rays::{Query, RaySet};
use crate::geometry::Ray;
use crate::render::Answer;
use crate::scene::Scene;

/// Triangle tests that the oracle may spend on rays of one purpose that nobody disagrees about: some seconds. They find what all methods
/// get wrong.
const SAMPLE_TESTS: u64 = 20_000_000;

/// Triangle tests that it may spend on disagreements of one purpose. Beyond, a disagreement is decided among the triangles
/// that the methods named, which is wrong only where all of them missed the nearest.
const DISAGREEMENT_TESTS: u64 = 1_000_000_000;

/// Wrong rays of one set that are kept for each method.
const KEPT: usize = 100;

/// A ray that somebody answered wrongly.
#[derive(Clone, Debug)]
pub struct WrongRay {
    /// The ray.
    pub ray: Ray,
    /// The true answer.
    pub truth: Answer,
    /// Each method's answer.
    pub answers: Vec<Answer>,
    /// What is wrong with each.
    pub faults: Vec<Option<Fault>>,
}

/// The wrong answers of one method to one set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mistakes {
    /// By their kind.
    pub faults: Faults,
    /// Those that brute force with the same triangle test makes too.
    pub by_test: u64,
    /// Those that it does not make. What is in neither was too much to look at.
    pub by_traversal: u64,
    /// Answers of a method that does not promise names that are right but for the name: depths that round to one `t`, or neighbours over an edge. No errors.
    pub unresolved: u64,
}

/// What the oracle says of the answers to one set.
pub(super) struct Judged {
    pub(super) mistakes: Vec<Mistakes>,
    pub(super) disagreements: usize,
    pub(super) decided_among_named: usize,
    pub(super) sampled: usize,
    pub(super) wrong: Vec<WrongRay>,
}

impl Judged {
    pub(super) fn of(
        scene: &Scene,
        entrants: &[Entrant],
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
            let named = named(entrants, &set.rays[r], query, answers, r);
            (r, oracle.truth_among(&set.rays[r], query, &named))
        }));
        truths.sort_by_key(|(r, _)| *r);

        let mut brute = BruteForces::new(scene);
        let mut mistakes = vec![Mistakes::default(); answers.len()];
        let mut kept = vec![0; answers.len()];
        let mut wrong = Vec::new();
        for (r, truth) in truths {
            let ray = &set.rays[r];
            let mut faults = vec![None; answers.len()];
            let mut is_new = false;
            for (m, entrant) in entrants.iter().enumerate() {
                let verdict = verdict(&oracle, entrant.contestant, ray, truth, answers[m][r]);
                let mistakes = &mut mistakes[m];
                mistakes.unresolved += u64::from(verdict == Verdict::Unresolved);
                let Verdict::Wrong(kind) = verdict else {
                    continue;
                };
                mistakes.faults.add(kind.fault());
                match brute.blame(&oracle, entrant.contestant, (ray, query), truth, kind) {
                    Some(Blame::Test) => mistakes.by_test += 1,
                    Some(Blame::Traversal) => mistakes.by_traversal += 1,
                    None => {}
                }
                faults[m] = Some(kind.fault());
                is_new |= kept[m] < KEPT;
            }
            if is_new {
                for (kept, fault) in kept.iter_mut().zip(&faults) {
                    *kept += usize::from(fault.is_some());
                }
                wrong.push(WrongRay {
                    ray: *ray,
                    truth,
                    answers: answers.iter().map(|a| a[r]).collect(),
                    faults,
                });
            }
        }
        Self {
            mistakes,
            disagreements: disputed.len(),
            decided_among_named: disputed.len() - searched,
            sampled: sample.len(),
            wrong,
        }
    }
}

/// What is said of an answer, by the standard that the method is held to. Whether anything is hit is owed by all.
pub(super) fn verdict(
    oracle: &Oracle,
    contestant: &Contestant,
    ray: &Ray,
    truth: Answer,
    answer: Answer,
) -> Verdict {
    match (truth, answer) {
        (Answer::Closest(truth), Answer::Closest(hit)) if !contestant.owes_exact => {
            of_plausible(oracle, ray, truth, hit)
        }
        (Answer::Closest(truth), _) => of_exact(oracle, ray, truth, answer),
        (Answer::Any(_), _) => match judge(truth, answer) {
            None => Verdict::Right,
            Some(Fault::Ghost) => Verdict::Wrong(Kind::Ghost),
            Some(_) => Verdict::Wrong(Kind::Hole),
        },
    }
}

/// The hits that any method knows of on a ray: their answers, or, where these only say whether there is one, the nearest hits.
fn named(
    entrants: &[Entrant],
    ray: &Ray,
    query: Query,
    answers: &[Vec<Answer>],
    index: usize,
) -> Vec<Hit> {
    let nearest = |(a, entrant): (&Vec<Answer>, &Entrant)| match (query, a[index]) {
        (Query::Closest, Answer::Closest(hit)) => hit,
        _ => entrant.accelerator.closest_hit(ray),
    };
    answers.iter().zip(entrants).filter_map(nearest).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{NamedRays, SetReport, compare_set};
    use super::*;
    use crate::accel::{Accelerator, AcceleratorKind, BuildStats, TraceCounters};
    use crate::analysis::measure;
    use crate::analysis::view_rays::RayPurpose;
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

    fn bvh2() -> Contestant {
        Contestant::structure(AcceleratorKind::Bvh2)
    }

    /// The accelerators under one contestant's name.
    fn entrants<'a>(of: &'a Contestant, all: &[&'a dyn Accelerator]) -> Vec<Entrant<'a>> {
        let entrant = |&accelerator: &&'a dyn Accelerator| Entrant {
            contestant: of,
            accelerator,
        };
        all.iter().map(entrant).collect()
    }

    fn report(scene: &Scene, of: &Contestant, all: &[&dyn Accelerator], set: &RaySet) -> SetReport {
        let rays = NamedRays {
            name: String::new(),
            set: set.clone(),
        };
        compare_set(scene, &entrants(of, all), &rays, 0, 0, &|| ())
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
                let report = report(&scene, &bvh2(), &[&*honest, &liar], &set);
                assert_eq!(report.methods[0].mistakes, Mistakes::default());
                let mistakes = report.methods[1].mistakes;
                // Brute force is honest: it is not the triangle test.
                assert_eq!((mistakes.by_test, mistakes.by_traversal), (0, want as u64));
                let faults = mistakes.faults;
                assert!(report.wrong.iter().all(|w| w.faults == [None, Some(fault)]));
                assert_eq!(report.pairs[0].different(), want as u64);
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
        let report = report(&scene, &bvh2(), &[&liar, &liar], &rays(RayPurpose::Eye));
        assert_eq!(report.disagreements, 0);
        assert!(report.methods.iter().all(|m| m.mistakes.faults.total() > 5));
    }

    #[test]
    fn a_dispute_beyond_the_budget_is_decided_among_what_was_named() {
        let scene = block();
        let honest = AcceleratorKind::Bvh2.build(&scene);
        let liar = Liar {
            honest: &*honest,
            fault: Fault::Ghost,
        };
        let of = bvh2();
        for purpose in [RayPurpose::Eye, RayPurpose::Shadow] {
            let set = rays(purpose);
            let both: [&dyn Accelerator; 2] = [&*honest, &liar];
            let answers = both.map(|a| measure::answers(a, &set)).to_vec();
            let oracle = Oracle::new(&scene);
            for (r, ray) in set.rays.iter().enumerate() {
                let named = named(&entrants(&of, &both), ray, purpose.query(), &answers, r);
                let truth = oracle.truth_among(ray, purpose.query(), &named);
                assert_eq!(truth, oracle.truth(ray, purpose.query()));
            }
        }
    }

    #[test]
    fn who_promises_no_bits_is_held_to_depths_only() {
        let scene = block();
        let honest = AcceleratorKind::Bvh2.build(&scene);
        let loose = Contestant {
            owes_exact: false,
            ..bvh2()
        };
        let set = rays(RayPurpose::Eye);
        for (fault, is_forgiven) in [(Fault::WrongDepth, true), (Fault::Hole, false)] {
            let liar = Liar {
                honest: &*honest,
                fault,
            };
            let found = report(&scene, &loose, &[&*honest, &liar], &set);
            assert!(found.disagreements > 5);
            let wrong = found.methods[1].mistakes.faults.total();
            assert_eq!(wrong == 0, is_forgiven, "{fault:?}");
            let ulps = found.pairs[0].ulps.map(|u| u.largest);
            assert_eq!(ulps, is_forgiven.then_some(1.0));
        }
    }
}
