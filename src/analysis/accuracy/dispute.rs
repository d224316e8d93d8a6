//! Which rays the oracle is asked about, and what it says of each method's answers: all rays whose answers cannot all be right, and a
//! sample of the others.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::blame::{BruteForces, Wrong};
use super::verdict::{Verdict, of_exact, of_plausible};
use super::{Blame, Fault, Faults, Kind, Oracle, Trouble, judge};
use crate::accel::Hit;
use crate::analysis::compare::{Contestant, Entrant};
use crate::analysis::view_rays::RaySet;
use crate::geometry::Ray;
use crate::render::Answer;
use crate::scene::Scene;

/// Triangle tests that the oracle may spend on rays of one purpose that nobody disputes: some seconds. They find what all methods
/// get wrong.
const SAMPLE_TESTS: u64 = 20_000_000;

/// Triangle tests that it may spend on disputes of one purpose. Beyond, a dispute is decided among the triangles
/// that the methods named, which is wrong only where all of them missed the nearest.
const DISPUTE_TESTS: u64 = 1_000_000_000;

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
    /// Of both, what explains them, in the order of [`Trouble::ALL`].
    pub troubles: [u64; Trouble::ALL.len()],
    /// Answers of a method that does not promise names that are right but for the name: depths that round to one `t`, or neighbours over an edge. No errors.
    pub unresolved: u64,
}

impl Mistakes {
    /// These and others together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            faults: self.faults.and(other.faults),
            by_test: self.by_test + other.by_test,
            by_traversal: self.by_traversal + other.by_traversal,
            troubles: std::array::from_fn(|i| self.troubles[i] + other.troubles[i]),
            unresolved: self.unresolved + other.unresolved,
        }
    }
}

/// What the oracle says of the answers to one set.
pub(in crate::analysis) struct Judged {
    pub(in crate::analysis) mistakes: Vec<Mistakes>,
    pub(in crate::analysis) disputed: usize,
    pub(in crate::analysis) decided_among_named: usize,
    pub(in crate::analysis) sampled: usize,
    pub(in crate::analysis) wrong: Vec<WrongRay>,
}

/// The answers of all methods to one set, before anybody judges them.
struct Answers<'a> {
    oracle: Oracle<'a>,
    entrants: &'a [Entrant<'a>],
    set: &'a RaySet,
    by_method: &'a [Vec<Answer>],
}

impl Judged {
    pub(in crate::analysis) fn of(
        scene: &Scene,
        entrants: &[Entrant],
        set: &RaySet,
        answers: &[Vec<Answer>],
    ) -> Self {
        let asked = Answers {
            oracle: Oracle::new(scene),
            entrants,
            set,
            by_method: answers,
        };
        let accords: Vec<Option<Vec<usize>>> = (0..set.rays.len())
            .into_par_iter()
            .map(|r| asked.accord(r))
            .collect();
        let is_disputed = |r: &usize| accords[*r].is_none();
        let disputed: Vec<usize> = (0..set.rays.len()).filter(is_disputed).collect();
        let affordable = |tests: u64| (tests / scene.placed_triangles().max(1)) as usize;
        let searched = affordable(DISPUTE_TESTS).min(disputed.len());
        let sample = affordable(SAMPLE_TESTS).clamp(1, set.rays.len().max(1));
        let sample: BTreeSet<usize> = (0..sample.min(set.rays.len()))
            .map(|i| i * set.rays.len() / sample)
            .filter(|r| !is_disputed(r))
            .collect();
        let truths = asked.truths(&disputed, searched, &sample);

        let mut judged = Self {
            mistakes: vec![Mistakes::default(); answers.len()],
            disputed: disputed.len(),
            decided_among_named: disputed.len() - searched,
            sampled: sample.len(),
            wrong: Vec::new(),
        };
        for (r, accord) in accords.iter().enumerate() {
            for &m in accord.iter().flatten() {
                judged.mistakes[m].unresolved += u64::from(!sample.contains(&r));
            }
        }
        let mut brute = BruteForces::new(scene);
        let mut kept = vec![0; answers.len()];
        for (r, truth) in truths {
            let faults = judged.judge(&asked, r, truth, &mut brute);
            let is_new = |(kept, fault): (&usize, &Option<Fault>)| fault.is_some() && *kept < KEPT;
            if kept.iter().zip(&faults).any(is_new) {
                for (kept, fault) in kept.iter_mut().zip(&faults) {
                    *kept += usize::from(fault.is_some());
                }
                judged.wrong.push(WrongRay {
                    ray: set.rays[r],
                    truth,
                    answers: answers.iter().map(|a| a[r]).collect(),
                    faults,
                });
            }
        }
        judged
    }

    /// Judges all answers to one ray: what is wrong with each.
    fn judge(
        &mut self,
        asked: &Answers,
        r: usize,
        truth: Answer,
        brute: &mut BruteForces,
    ) -> Vec<Option<Fault>> {
        let ray = &asked.set.rays[r];
        let judge = |(m, entrant): (usize, &Entrant)| {
            let answer = asked.by_method[m][r];
            let verdict = verdict(&asked.oracle, entrant.contestant, ray, truth, answer);
            let mistakes = &mut self.mistakes[m];
            mistakes.unresolved += u64::from(verdict == Verdict::Unresolved);
            let Verdict::Wrong(kind) = verdict else {
                return None;
            };
            mistakes.faults.add(kind.fault());
            let wrong = Wrong {
                ray,
                query: asked.set.purpose.query(),
                truth,
                answer,
                kind,
            };
            if let Some((blame, trouble)) = brute.explain(&asked.oracle, entrant, &wrong) {
                match blame {
                    Blame::Test => mistakes.by_test += 1,
                    Blame::Traversal => mistakes.by_traversal += 1,
                }
                mistakes.troubles[trouble as usize] += 1;
            }
            Some(kind.fault())
        };
        asked.entrants.iter().enumerate().map(judge).collect()
    }
}

impl Answers<'_> {
    /// `None` if not all methods can be right about the ray. Else those that are right but for the name.
    ///
    /// What exact methods say must be the same, and others must have said, by their own standard, nothing else. Where no method is exact, all must be the same.
    fn accord(&self, r: usize) -> Option<Vec<usize>> {
        let exact = self.entrants.iter().position(|e| e.contestant.owes_exact);
        let taken_for_true = self.by_method[exact.unwrap_or(0)][r];
        let mut unresolved = Vec::new();
        for (m, entrant) in self.entrants.iter().enumerate() {
            let answer = self.by_method[m][r];
            if answer == taken_for_true {
                continue;
            }
            if exact.is_none() || entrant.contestant.owes_exact {
                return None;
            }
            let ray = &self.set.rays[r];
            match verdict(
                &self.oracle,
                entrant.contestant,
                ray,
                taken_for_true,
                answer,
            ) {
                Verdict::Right => {}
                Verdict::Unresolved => unresolved.push(m),
                Verdict::Wrong(_) => return None,
            }
        }
        Some(unresolved)
    }

    /// The true answers to the first disputed rays and to the sample, by every triangle; and to further disputed ones, by those that were named.
    fn truths(
        &self,
        disputed: &[usize],
        searched: usize,
        sample: &BTreeSet<usize>,
    ) -> Vec<(usize, Answer)> {
        let (rays, query) = (&self.set.rays, self.set.purpose.query());
        let by_all = |&r: &usize| (r, self.oracle.truth(&rays[r], query));
        let mut truths: Vec<(usize, Answer)> = disputed[..searched]
            .par_iter()
            .chain(sample)
            .map(by_all)
            .collect();
        truths.extend(disputed[searched..].iter().map(|&r| {
            let named = self.named(r);
            (r, self.oracle.truth_among(&rays[r], query, &named))
        }));
        truths.sort_by_key(|(r, _)| *r);
        truths
    }

    /// The hits that any method knows of on a ray: their answers, or, where these only say whether there is one, the nearest hits.
    fn named(&self, r: usize) -> Vec<Hit> {
        let nearest = |(answers, entrant): (&Vec<Answer>, &Entrant)| match answers[r] {
            Answer::Closest(hit) => hit,
            Answer::Any(_) => entrant.accelerator.closest_hit(&self.set.rays[r]),
        };
        let all = self.by_method.iter().zip(self.entrants);
        all.filter_map(nearest).collect()
    }
}

/// What is said of an answer, by the standard that the method is held to. Whether anything is hit is owed by all.
pub(in crate::analysis) fn verdict(
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Accelerator, AcceleratorKind, BuildStats, TraceCounters};
    use crate::analysis::compare::{NamedRays, SetReport, compare_set};
    use crate::analysis::measure;
    use crate::analysis::view_rays::{Query, RayPurpose};
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
                assert_eq!(mistakes.troubles.iter().sum::<u64>(), want as u64);
                let faults = mistakes.faults;
                assert!(report.wrong.iter().all(|w| w.faults == [None, Some(fault)]));
                assert_eq!(report.pairs[0].different(), want as u64);
                assert_eq!(faults.count(fault), want as u64, "{purpose:?} {fault:?}");
                assert_eq!(faults.total(), want as u64);
                assert_eq!((report.disputed, report.hits), (want, hits));
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
        assert_eq!(report.disputed, 0);
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
            let asked = Answers {
                oracle: Oracle::new(&scene),
                entrants: &entrants(&of, &both),
                set: &set,
                by_method: &answers,
            };
            let all: Vec<usize> = (0..set.rays.len()).collect();
            let none = BTreeSet::new();
            let among_named = asked.truths(&all, 0, &none);
            assert_eq!(among_named, asked.truths(&all, all.len(), &none));
        }
    }

    #[test]
    fn single_precision_beside_exact_methods_is_disputed_only_where_it_must_be_wrong() {
        let scene = block();
        let honest = AcceleratorKind::Bvh2.build(&scene);
        let exact = bvh2();
        let loose = Contestant {
            owes_exact: false,
            ..bvh2()
        };
        let set = rays(RayPurpose::Eye);
        let hits = set.rays.iter().filter(|r| honest.any_hit(r)).count();
        for (fault, disputed) in [(Fault::WrongDepth, 0), (Fault::Hole, hits)] {
            let liar = Liar {
                honest: &*honest,
                fault,
            };
            let both: [(&Contestant, &dyn Accelerator); 2] = [(&exact, &*honest), (&loose, &liar)];
            let both = both.map(|(contestant, accelerator)| Entrant {
                contestant,
                accelerator,
            });
            let answers = both.map(|e| measure::answers(e.accelerator, &set)).to_vec();
            let judged = Judged::of(&scene, &both, &set, &answers);
            assert_eq!(judged.disputed, disputed, "{fault:?}");
            assert_eq!(judged.sampled, 40 - disputed);
            let wrong: Vec<_> = judged.mistakes.iter().map(|m| m.faults.total()).collect();
            assert_eq!(wrong, [0, disputed as u64]);
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
            assert!(found.disputed > 5);
            let wrong = found.methods[1].mistakes.faults.total();
            assert_eq!(wrong == 0, is_forgiven, "{fault:?}");
            let ulps = found.pairs[0].ulps.map(|u| u.largest);
            assert_eq!(ulps, is_forgiven.then_some(1.0));
        }
    }
}
