//! Runs the sweeps: cells in any order on all threads, results in that of the registries.

use rayon::prelude::*;

use super::child::{self, CellTask, Isolation};
use super::defects;
use super::ending::Ending;
use super::judged::{CellReply, Judged};
use super::leaks::leaks;
use super::methods::Method;
use super::results::{Cell, FirstFailure, MethodResult, SignMap, Step, StressResults, SweepResult};
use super::sweeps::Sweep;
use crate::accel::Embree;

/// Side of the sign map, in points.
const SIGN_MAP: u32 = 64;

/// What is run.
#[derive(Clone)]
pub struct StressOptions {
    /// The sweeps.
    pub sweeps: Vec<Sweep>,
    /// The methods.
    pub methods: Vec<Method>,
    /// Rays a step; fewer where there are very many triangles.
    pub rays: usize,
    /// Rays from inside a closed mesh for the default method; others get fewer.
    pub leak_rays: u64,
    /// Changes every random number.
    pub seed: u64,
    /// How children are started. Without it, methods that may run away do not take part in crowds.
    pub isolation: Option<Isolation>,
    /// The methods that need it take part only with it. Children load it on their own, see [`answer`](super::answer).
    pub embree: Option<Embree>,
}

impl Default for StressOptions {
    /// All sweeps and methods on few rays.
    fn default() -> Self {
        Self {
            sweeps: Sweep::all(),
            methods: Method::all(),
            rays: 128,
            leak_rays: 1_000_000,
            seed: 0,
            isolation: None,
            embree: None,
        }
    }
}

/// A piece of work of its own.
enum Job {
    /// A step with all methods that end.
    Step(usize, usize),
    /// A method that may run away, through all steps of a crowd.
    Chain(usize, Method),
}

/// What a job leaves behind.
#[derive(Default)]
struct Found {
    step: Option<(usize, usize, Step)>,
    /// By sweep, step and method.
    cells: Vec<(usize, usize, Method, CellReply)>,
}

impl StressResults {
    /// Runs it, with the threads of the rayon pool in which it is called; results do not depend on their number. `watch` is told the share of
    /// the work that was done since it was last told.
    pub fn of(options: &StressOptions, watch: &(dyn Fn(f64) + Sync)) -> Self {
        let mut jobs = Vec::new();
        let is_chained = |sweep: &Sweep, method: &Method| {
            sweep.is_crowd && method.may_run_away() && options.can_ask(*method)
        };
        for (s, sweep) in options.sweeps.iter().enumerate() {
            let chained = options.methods.iter().filter(|m| is_chained(sweep, m));
            jobs.extend(chained.map(|&method| Job::Chain(s, method)));
            jobs.extend((0..sweep.values().len()).map(|step| Job::Step(s, step)));
        }
        let share = 0.9 / jobs.len().max(1) as f64;
        let run = |job: &Job| {
            let found = match *job {
                Job::Step(s, step) => options.step(s, step),
                Job::Chain(s, method) => options.chain(s, method),
            };
            watch(share);
            found
        };
        // Jobs are long and uneven: each is a task of its own.
        let found: Vec<Found> = jobs.par_iter().with_max_len(1).map(run).collect();
        let sweeps = collected(options, found);
        let embree = options.embree.as_ref();
        let watch_leaks = |rays| watch(0.1 * rays as f64 / options.leak_rays as f64);
        let leaks = leaks(
            &options.methods,
            embree,
            options.leak_rays,
            options.seed,
            &watch_leaks,
        );
        let formulas = defects::formulas();
        Self {
            default_method: Method::DEFAULT.name().to_owned(),
            seed: options.seed,
            rays: options.rays as u64,
            embree: embree.map(|embree| embree.version().to_owned()),
            defects: defects::defects(&sweeps, &formulas),
            sweeps,
            leaks,
            formulas,
            sign_map: SignMap::new(SIGN_MAP),
        }
    }
}

impl StressOptions {
    fn can_ask(&self, method: Method) -> bool {
        !method.needs_embree() || self.embree.is_some()
    }

    /// One step with the methods that end.
    fn step(&self, s: usize, step: usize) -> Found {
        let sweep = &self.sweeps[s];
        let value = sweep.values()[step];
        let case = sweep.case(value, self.rays, self.seed);
        let judged = Judged::of(&case);
        let takes_part = |method: &Method| {
            self.can_ask(*method)
                && !(sweep.is_crowd && method.may_run_away())
                && (method.is_exact() || !sweep.is_for_structures)
        };
        let cell = |method: &Method| {
            let reply = std::panic::catch_unwind(|| judged.cell(*method, self.embree.as_ref()));
            let reply = reply.unwrap_or_else(|cause| died(&*cause));
            (s, step, *method, reply)
        };
        let methods = self.methods.iter().filter(|m| takes_part(m));
        Found {
            cells: methods.map(cell).collect(),
            step: Some((s, step, judged.step(value))),
        }
    }

    /// A method in children, step by step. After one that did not answer, only the last step is tried.
    fn chain(&self, s: usize, method: Method) -> Found {
        let mut found = Found::default();
        let Some(isolation) = &self.isolation else {
            return found;
        };
        let sweep = &self.sweeps[s];
        let (last, mut has_failed) = (sweep.values().len() - 1, false);
        for step in 0..=last {
            if has_failed && step < last {
                continue;
            }
            let task = CellTask {
                sweep: sweep.name.to_owned(),
                step,
                method: method.name().to_owned(),
                rays: self.rays,
                seed: self.seed,
            };
            let reply = child::ask(isolation, &task);
            has_failed |= reply.cell.ending != Ending::Answered;
            found.cells.push((s, step, method, reply));
        }
        found
    }
}

/// What a panic said.
fn died(cause: &(dyn std::any::Any + Send)) -> CellReply {
    let words = cause.downcast_ref::<String>().map(String::as_str);
    let words = words.or_else(|| cause.downcast_ref::<&str>().copied());
    let how = format!("panic: {}", words.unwrap_or("without words"));
    CellReply {
        cell: Cell {
            ending: Ending::Died { how },
            ..Cell::default()
        },
        wrong: None,
    }
}

/// Puts the cells of all jobs in order. Cells that nobody filled were not tried.
fn collected(options: &StressOptions, found: Vec<Found>) -> Vec<SweepResult> {
    let untried = || CellReply {
        cell: Cell {
            ending: Ending::NotTried,
            ..Cell::default()
        },
        wrong: None,
    };
    let mut steps: Vec<Vec<Option<Step>>> = Vec::new();
    let mut replies: Vec<Vec<Vec<CellReply>>> = Vec::new();
    for sweep in &options.sweeps {
        let count = sweep.values().len();
        steps.push(vec![None; count]);
        replies.push(vec![vec![untried(); count]; options.methods.len()]);
    }
    for job in found {
        if let Some((s, step, of)) = job.step {
            steps[s][step] = Some(of);
        }
        for (s, step, method, reply) in job.cells {
            if let Some(m) = options.methods.iter().position(|other| *other == method) {
                replies[s][m][step] = reply;
            }
        }
    }
    let sweeps = options.sweeps.iter().zip(steps).zip(replies);
    sweeps
        .map(|((sweep, steps), replies)| {
            let steps: Vec<Step> = steps.into_iter().flatten().collect();
            let methods = options.methods.iter().zip(replies);
            let methods = methods.map(|(method, replies)| of_method(*method, &steps, replies));
            SweepResult {
                name: sweep.name.to_owned(),
                description: sweep.description.to_owned(),
                parameter: sweep.parameter.to_owned(),
                unit: sweep.unit.to_owned(),
                methods: methods.collect(),
                steps,
            }
        })
        .collect()
}

fn of_method(method: Method, steps: &[Step], replies: Vec<CellReply>) -> MethodResult {
    let first = replies.iter().position(|reply| !reply.cell.is_right());
    MethodResult {
        method: method.name().to_owned(),
        first_failure: first.map(|step| FirstFailure {
            step,
            value: steps[step].value,
            wrong: replies[step].wrong.clone(),
        }),
        cells: replies.into_iter().map(|reply| reply.cell).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options() -> StressOptions {
        StressOptions {
            sweeps: ["small", "coincident"]
                .map(|name| Sweep::named(name).unwrap())
                .to_vec(),
            methods: [Method::DEFAULT, Method::ObvhsCwbvhBoxes].to_vec(),
            rays: 24,
            leak_rays: 40_000,
            seed: 3,
            isolation: None,
            embree: None,
        }
    }

    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| StressResults::of(&options(), &|_| ()))
        };
        let one = run(1);
        assert_eq!(one, run(3));
        assert_eq!(one.default_failures(), 0);
        let boxes = &one.sweeps[0].methods[1];
        let first = boxes.first_failure.as_ref().unwrap();
        assert!((1e-6..1e-2).contains(&first.value), "{first:?}");
        assert_eq!(boxes.cells[first.step - 1].wrong(), 0);
        assert!(first.wrong.is_some());
        // Without a way to start children it stays away from crowds, which is no failure.
        let crowd = &one.sweeps[1].methods[1];
        assert!(
            crowd.cells.iter().all(|c| c.ending == Ending::NotTried)
                && crowd.first_failure.is_none()
        );
    }

    #[test]
    fn failures_of_the_default_method_are_counted_wherever_they_are() {
        let mut results = StressResults::of(&options(), &|_| ());
        assert_eq!(results.default_failures(), 0);
        results.sweeps[0].methods[1].cells[0].faults[0] = 5;
        assert_eq!(results.default_failures(), 0);
        results.sweeps[0].methods[0].cells[2].faults[1] = 2;
        results.sweeps[1].methods[0].cells[0].ending = Ending::DidNotEnd { seconds: 1 };
        results.leaks[0].leaks = 4;
        assert_eq!(results.default_failures(), 7);
    }
}
