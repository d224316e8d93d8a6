//! Which rays the oracle is asked about, and what it says of each method's answers: all rays whose answers cannot all be right, and a
//! sample of the others.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::blame::{BruteForces, Wrong};
use super::verdict::{Verdict, of_exact, of_plausible};
use super::{Blame, Fault, Kind, Mistakes, Oracle, WrongRay, judge};
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
mod tests;
