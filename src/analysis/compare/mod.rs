//! Methods beside one another on the same rays: builds, speeds, steps, how each pair agrees, and every disagreement decided.

mod contestant;
mod cost_picture;
mod course;
mod options;
mod pairs;
mod ray_file;
mod replay;
mod set;

use std::cell::Cell;

use super::measure::{self, BuildCost};
use super::view_rays::{RaySet, ViewOptions, view_rays};
use crate::accel::{Accelerator, BuildStats, EmbreeError};
use crate::render::{SkyMode, Stage};
use crate::scene::{CameraFrame, Scene};
use course::{BUILD_SHARE, Course, DRAW_SHARE, JUDGE_SHARE};

pub use contestant::{Built, Contestant, Entrant, Source};
pub use cost_picture::CostPictures;
pub use course::Phase;
pub use options::{CompareOptions, NamedRays};
pub use pairs::{Agreement, Distances, PairReport};
pub use ray_file::{RayFileError, read_rays, write_rays};
pub use replay::{Replayed, Said, replay};
pub use set::{MethodOnSet, SetReport, compare_set};

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

impl Comparison {
    /// Compares. Builds and judges with the threads of the rayon pool in which it is called; rays are timed on one thread. `watch` hears what begins, and the
    /// share of the work that is done by then, as far as that can be told beforehand.
    ///
    /// # Errors
    /// If a foreign library cannot build its structure.
    ///
    /// # Panics
    /// If no method is named.
    pub fn of(
        scene: &Scene,
        camera: &CameraFrame,
        options: &CompareOptions,
        watch: &(dyn Fn(Phase, f64) + Sync),
    ) -> Result<Self, EmbreeError> {
        let course = Course {
            watch,
            done: Cell::new(0.0),
        };
        let (methods, accelerators) = build_all(scene, options, &course)?;
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
        Ok(Self {
            methods,
            sets,
            costs,
        })
    }

    /// Whether the oracle found no wrong answer of the first method.
    pub fn is_first_right(&self) -> bool {
        self.sets
            .iter()
            .all(|set| set.methods[0].mistakes.faults.total() == 0)
    }
}

/// Methods as they were built, and what answers.
type AllBuilt = (Vec<BuiltMethod>, Vec<Box<dyn Accelerator>>);

/// Builds all methods, in their order.
fn build_all(
    scene: &Scene,
    options: &CompareOptions,
    course: &Course,
) -> Result<AllBuilt, EmbreeError> {
    let share = BUILD_SHARE / options.contestants.len() as f64;
    let (mut methods, mut accelerators) = (Vec::new(), Vec::new());
    for contestant in &options.contestants {
        course.on(Phase::Build(&contestant.name), 0.0);
        let once = || contestant.build(scene, &options.build);
        let (built, mut cost) = measure::build(&once, options.memory.as_ref());
        let built = built?;
        course.on(Phase::Build(&contestant.name), share);
        // What a foreign library takes is not on our heap, and what it is given is there all the while.
        let foreign = built.foreign_peak_bytes;
        cost.peak_bytes = cost.peak_bytes.map(|bytes| bytes + foreign);
        methods.push(BuiltMethod {
            contestant: contestant.clone(),
            cost,
            size: built.accelerator.build_stats(),
        });
        accelerators.push(built.accelerator);
    }
    Ok((methods, accelerators))
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

#[cfg(test)]
mod tests {
    use super::super::accuracy::Fault;
    use super::super::view_rays::RayPurpose;
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::render::{CameraWishes, frame_scene};
    use glam::Vec3;

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
        let mut comparison = Comparison::of(&scene, &frame, &options, &watch).unwrap();
        let shares = shares.into_inner().unwrap();
        assert!(shares.is_sorted() && (0.89..0.91).contains(shares.last().unwrap()));
        assert_eq!(comparison.methods.len(), options.contestants.len());
        assert!(comparison.is_first_right());
        let costs = comparison.costs.as_ref().unwrap();
        assert_eq!(costs.count(Agreement::Same), 1600);
        for set in &comparison.sets {
            assert!(set.rays > 0 && set.disputed == 0 && set.sampled == set.rays);
            assert_eq!(set.pairs.len(), 10);
            for pair in &set.pairs {
                assert_eq!(pair.count(Agreement::Same), set.rays as u64);
            }
            for method in &set.methods {
                assert!(method.speed.is_some() && method.steps.is_some_and(|s| s.primitives > 0));
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
        let comparison = Comparison::of(&scene, &frame, &options, &|_, _| ()).unwrap();
        let [set] = &comparison.sets[..] else {
            panic!("one set was brought");
        };
        assert_eq!((&*set.name, set.rays), ("mine", count));
        assert_eq!(set.purpose, RayPurpose::Refraction);
    }
}
