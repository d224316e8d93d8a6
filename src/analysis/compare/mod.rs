//! Methods beside one another on the same rays: builds, speeds, steps, how each pair agrees, and every disagreement decided.

mod blame;
mod contestant;
mod cost_picture;
mod defaults;
mod dispute;
mod pairs;
mod ray_file;
mod replay;

use std::cell::Cell;

use glam::Vec3;

use super::measure::{self, BuildCost, Speed};
use super::memory::MemoryMeter;
use super::view_rays::{RayPurpose, RaySet, ViewOptions, view_rays};
use crate::accel::{Accelerator, AcceleratorKind, BuildOptions, BuildStats, TraceCounters};
use crate::render::{Answer, SkyMode, Stage};
use crate::scene::{CameraFrame, Scene};

pub use contestant::{Contestant, Entrant, Source};
pub use cost_picture::CostPictures;
pub use defaults::Work;
use dispute::Judged;
pub use dispute::{Mistakes, WrongRay};
use pairs::is_hit;
pub use pairs::{Agreement, Distances, PairReport};
pub use ray_file::{RayFileError, read_rays, write_rays};
pub use replay::{Replayed, Said, replay};

/// Share of the whole work that builds are taken for.
const BUILD_SHARE: f64 = 0.2;

/// Share of it that pictures of costs are taken for, if there are any.
const DRAW_SHARE: f64 = 0.1;

/// Share of the work on a set that its judging is taken for.
const JUDGE_SHARE: f64 = 0.3;

/// Rays under a name.
#[derive(Clone, Debug)]
pub struct NamedRays {
    /// What they are called in reports and names of files.
    pub name: String,
    /// The rays.
    pub set: RaySet,
}

/// What is compared, and how.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// The methods; the first is the one that the others are measured by.
    pub contestants: Vec<Contestant>,
    /// How they are built.
    pub build: BuildOptions,
    /// Rays to ask; without any, those of the view.
    pub rays: Vec<NamedRays>,
    /// Width and height of the view, in pixels.
    pub size: (u32, u32),
    /// Most rays of each purpose that a view gives.
    pub most_rays: usize,
    /// How often each method is timed.
    pub repetitions: usize,
    /// Whether the cost of every pixel of the view is looked at too.
    pub draws_costs: bool,
    /// Counts the memory that builds take.
    pub memory: Option<MemoryMeter>,
    /// Changes every random number.
    pub seed: u32,
    /// The scene's upward axis.
    pub up: Vec3,
}

impl Default for CompareOptions {
    /// All kinds but brute force, on the rays of a small picture.
    fn default() -> Self {
        let all = AcceleratorKind::ALL.into_iter();
        Self {
            contestants: all
                .filter(|k| !matches!(k, AcceleratorKind::Linear))
                .map(Contestant::structure)
                .collect(),
            build: BuildOptions::default(),
            rays: Vec::new(),
            size: (1280, 720),
            most_rays: 200_000,
            repetitions: 9,
            draws_costs: false,
            memory: None,
            seed: 0,
            up: Vec3::Y,
        }
    }
}

/// What a comparison is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase<'a> {
    /// Builds a method.
    Build(&'a str),
    /// Times the rays of a set.
    Time(&'a str),
    /// Counts their steps, and looks at the answers.
    Judge(&'a str),
    /// Counts the steps of every pixel.
    Draw,
}

impl std::fmt::Display for Phase<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Build(name) => write!(f, "building {name}"),
            Self::Time(name) => write!(f, "timing {name} rays"),
            Self::Judge(name) => write!(f, "judging {name} rays"),
            Self::Draw => write!(f, "counting the steps of pixels"),
        }
    }
}

/// A method as it was built.
#[derive(Clone, Debug)]
pub struct BuiltMethod {
    /// Which.
    pub contestant: Contestant,
    /// What the build took.
    pub cost: BuildCost,
    /// Its size.
    pub size: BuildStats,
}

/// One method on the rays of one set.
#[derive(Clone, Copy, Debug)]
pub struct MethodOnSet {
    /// How fast; `None` without rays.
    pub speed: Option<Speed>,
    /// Steps of traversal, summed over all rays.
    pub steps: TraceCounters,
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
    /// Rays that not all methods answered alike; all are judged.
    pub disagreements: usize,
    /// Disagreements beyond the oracle's budget, decided among the triangles that the methods named.
    pub decided_among_named: usize,
    /// Other rays, spread evenly, that were judged by every triangle.
    pub sampled: usize,
    /// The first wrong ones of each method.
    pub wrong: Vec<WrongRay>,
}

/// A whole comparison.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The methods, in the order wished for.
    pub methods: Vec<BuiltMethod>,
    /// What they make of the rays.
    pub sets: Vec<SetReport>,
    /// What each pixel costs, if that was wished for.
    pub costs: Option<CostPictures>,
}

/// How far the work is, for those who watch.
struct Course<'a> {
    watch: &'a dyn Fn(Phase, f64),
    done: Cell<f64>,
}

impl Course<'_> {
    /// Says what comes now, and that so much more is done.
    fn on(&self, phase: Phase, more: f64) {
        self.done.set(self.done.get() + more);
        (self.watch)(phase, self.done.get());
    }
}

impl Comparison {
    /// Compares. Builds and judges with the threads of the rayon pool in which it is called; rays are timed on one thread. `watch` hears what begins, and the
    /// share of the work that is done by then, as far as that can be told beforehand.
    ///
    /// # Panics
    /// If no method is named.
    pub fn of(
        scene: &Scene,
        camera: &CameraFrame,
        options: &CompareOptions,
        watch: &(dyn Fn(Phase, f64) + Sync),
    ) -> Self {
        let course = Course {
            watch,
            done: Cell::new(0.0),
        };
        let (methods, accelerators) = build_all(scene, options, &course);
        let entrants = entrants(&methods, &accelerators);
        let of_view;
        let sets = if options.rays.is_empty() {
            of_view = rays_of_view(scene, &*accelerators[0], camera, options);
            &of_view
        } else {
            &options.rays
        };
        let draw_share = if options.draws_costs { DRAW_SHARE } else { 0.0 };
        let share = (1.0 - BUILD_SHARE - draw_share) / sets.len() as f64;
        let report = |rays: &NamedRays| {
            let name = &*rays.name;
            course.on(Phase::Time(name), 0.0);
            let rounds = (options.repetitions + 1) as f64;
            let timed = || course.on(Phase::Time(name), share * (1.0 - JUDGE_SHARE) / rounds);
            let report = compare_set(
                scene,
                &entrants,
                rays,
                options.repetitions,
                options.seed,
                &timed,
            );
            course.on(Phase::Judge(name), share * JUDGE_SHARE);
            report
        };
        let sets = sets.iter().map(report).collect();
        let costs = options.draws_costs.then(|| {
            course.on(Phase::Draw, 0.0);
            CostPictures::of(&entrants, camera, options.size)
        });
        Self {
            methods,
            sets,
            costs,
        }
    }

    /// Whether the oracle found no wrong answer of the first method.
    pub fn is_first_right(&self) -> bool {
        self.sets
            .iter()
            .all(|set| set.methods[0].mistakes.faults.total() == 0)
    }
}

/// Builds all methods, in their order.
fn build_all(
    scene: &Scene,
    options: &CompareOptions,
    course: &Course,
) -> (Vec<BuiltMethod>, Vec<Box<dyn Accelerator>>) {
    let share = BUILD_SHARE / options.contestants.len() as f64;
    let built = options.contestants.iter().map(|contestant| {
        course.on(Phase::Build(&contestant.name), 0.0);
        let once = || contestant.build(scene, &options.build);
        let (accelerator, cost) = measure::build(&once, options.memory.as_ref());
        course.on(Phase::Build(&contestant.name), share);
        let method = BuiltMethod {
            contestant: contestant.clone(),
            cost,
            size: accelerator.build_stats(),
        };
        (method, accelerator)
    });
    built.unzip()
}

fn entrants<'a>(
    methods: &'a [BuiltMethod],
    accelerators: &'a [Box<dyn Accelerator>],
) -> Vec<Entrant<'a>> {
    let accelerators = accelerators.iter().map(|a| &**a);
    let entrant = |(method, accelerator): (&'a BuiltMethod, _)| Entrant {
        contestant: &method.contestant,
        accelerator,
    };
    methods.iter().zip(accelerators).map(entrant).collect()
}

/// The rays of the view that the options describe, each set under the name of its purpose.
pub fn rays_of_view(
    scene: &Scene,
    accelerator: &dyn Accelerator,
    camera: &CameraFrame,
    options: &CompareOptions,
) -> Vec<NamedRays> {
    let stage = Stage::new(scene, accelerator, options.up, SkyMode::Auto);
    let view = ViewOptions {
        size: options.size,
        most_rays: options.most_rays,
        seed: options.seed,
    };
    let named = |set: RaySet| NamedRays {
        name: set.purpose.name().to_owned(),
        set,
    };
    view_rays(&stage, camera, &view).map(named).into()
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
        steps: measure::steps(accelerators[m], set),
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
            .map(|pair| PairReport::of(pair, &set.rays, &answers))
            .collect(),
        disagreements: judged.disagreements,
        decided_among_named: judged.decided_among_named,
        sampled: judged.sampled,
        wrong: judged.wrong,
    }
}

#[cfg(test)]
mod tests {
    use super::super::accuracy::Fault;
    use super::*;
    use crate::render::{CameraWishes, frame_scene};

    #[test]
    fn a_comparison_is_right_until_its_first_method_is_wrong() {
        let scene = crate::import::load(&["models/lecture-block.obj".into()]).unwrap();
        let frame = frame_scene(&scene, &CameraWishes::default(), Vec3::Y, 1.0)
            .frame(40, 40)
            .unwrap();
        let options = CompareOptions {
            size: (40, 40),
            repetitions: 1,
            draws_costs: true,
            ..CompareOptions::default()
        };
        let shares = std::sync::Mutex::new(vec![0.0]);
        let watch = |_: Phase, share| shares.lock().unwrap().push(share);
        let mut comparison = Comparison::of(&scene, &frame, &options, &watch);
        let shares = shares.into_inner().unwrap();
        assert!(shares.is_sorted() && (0.89..0.91).contains(shares.last().unwrap()));
        assert_eq!(comparison.methods.len(), options.contestants.len());
        assert!(comparison.is_first_right());
        let costs = comparison.costs.as_ref().unwrap();
        assert_eq!(costs.count(Agreement::Same), 1600);
        for set in &comparison.sets {
            assert!(set.rays > 0 && set.disagreements == 0 && set.sampled == set.rays);
            assert_eq!(set.pairs.len(), 10);
            for pair in &set.pairs {
                assert_eq!(pair.count(Agreement::Same), set.rays as u64);
            }
            for method in &set.methods {
                assert!(method.speed.is_some() && method.steps.primitives > 0);
            }
        }
        let add = |c: &mut Comparison, m: usize| {
            c.sets[2].methods[m].mistakes.faults.add(Fault::Hole);
        };
        add(&mut comparison, 1);
        assert!(comparison.is_first_right());
        add(&mut comparison, 0);
        assert!(!comparison.is_first_right());
    }

    #[test]
    fn rays_that_are_brought_take_the_place_of_the_views() {
        let scene = crate::import::load(&["models/lecture-block.obj".into()]).unwrap();
        let frame = frame_scene(&scene, &CameraWishes::default(), Vec3::Y, 1.0)
            .frame(16, 16)
            .unwrap();
        let mut options = CompareOptions {
            size: (16, 16),
            repetitions: 1,
            ..CompareOptions::default()
        };
        let linear = AcceleratorKind::Linear.build(&scene);
        let mut rays = rays_of_view(&scene, &*linear, &frame, &options);
        let count = rays[3].set.rays.len();
        options.rays = vec![NamedRays {
            name: "mine".to_owned(),
            set: rays.swap_remove(3).set,
        }];
        let comparison = Comparison::of(&scene, &frame, &options, &|_, _| ());
        let [set] = &comparison.sets[..] else {
            panic!("one set was brought");
        };
        assert_eq!((&*set.name, set.rays), ("mine", count));
        assert_eq!(set.purpose, RayPurpose::Refraction);
    }
}
