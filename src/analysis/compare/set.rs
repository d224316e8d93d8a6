//! All methods on the rays of one set: speeds, steps, how each two agree, and who is right.

use super::contestant::Entrant;
use super::options::NamedRays;
use super::pairs::{PairReport, is_hit};
use crate::accel::TraceCounters;
use crate::analysis::accuracy::dispute::Judged;
use crate::analysis::accuracy::{Mistakes, WrongRay};
use crate::analysis::measure::{self, Speed};
use crate::analysis::view_rays::RayPurpose;
use crate::render::Answer;
use crate::scene::Scene;

/// One method on the rays of one set.
#[derive(Clone, Copy, Debug)]
pub struct MethodOnSet {
    /// How fast; `None` without rays.
    pub speed: Option<Speed>,
    /// Steps of traversal, summed over all rays; `None` if the method does not tell them.
    pub steps: Option<TraceCounters>,
    /// Its wrong answers among the rays that were judged.
    pub mistakes: Mistakes,
}

/// All methods on the rays of one set.
#[derive(Clone, Debug)]
pub struct SetReport {
    /// What the set is called.
    pub name: String,
    /// What the rays are for.
    pub purpose: RayPurpose,
    /// How many.
    pub rays: usize,
    /// How many hit something, as the first method has it.
    pub hits: usize,
    /// For each method, in their order.
    pub methods: Vec<MethodOnSet>,
    /// Each two methods, by the first and then by the second of them.
    pub pairs: Vec<PairReport>,
    /// Rays whose answers cannot all be right, by what each method owes; all are judged.
    pub disputed: usize,
    /// Disputed rays beyond the oracle's budget, decided among the triangles that the methods named.
    pub decided_among_named: usize,
    /// Other rays, spread evenly, that were judged by every triangle.
    pub sampled: usize,
    /// The first wrong ones of each method.
    pub wrong: Vec<WrongRay>,
}

/// Compares on the rays of one set. `timed` is called after every round of timings.
pub fn compare_set(
    scene: &Scene,
    entrants: &[Entrant],
    rays: &NamedRays,
    repetitions: usize,
    seed: u32,
    timed: &dyn Fn(),
) -> SetReport {
    let set = &rays.set;
    let accelerators: Vec<_> = entrants.iter().map(|e| e.accelerator).collect();
    let speeds = measure::speeds_in_turns(&accelerators, set, repetitions, seed, timed);
    let answers: Vec<Vec<Answer>> = accelerators
        .iter()
        .map(|a| measure::answers(*a, set))
        .collect();
    let hits = answers
        .first()
        .map_or(0, |a| a.iter().filter(|a| is_hit(**a)).count());
    let judged = Judged::of(scene, entrants, set, &answers);
    let method = |m: usize| MethodOnSet {
        speed: speeds.as_ref().map(|s| s[m]),
        steps: entrants[m]
            .contestant
            .counts_steps()
            .then(|| measure::steps(accelerators[m], set)),
        mistakes: judged.mistakes[m],
    };
    let count = entrants.len();
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    SetReport {
        name: rays.name.clone(),
        purpose: set.purpose,
        rays: set.rays.len(),
        hits,
        methods: (0..count).map(method).collect(),
        pairs: pairs
            .map(|pair| PairReport::of(scene, pair, &set.rays, &answers))
            .collect(),
        disputed: judged.disputed,
        decided_among_named: judged.decided_among_named,
        sampled: judged.sampled,
        wrong: judged.wrong,
    }
}
