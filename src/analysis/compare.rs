//! Accelerators beside one another on the rays of one view: builds, speeds, steps, and every disagreement decided.

use glam::Vec3;

use super::accuracy::Faults;
use super::dispute::{Judged, WrongRay};
use super::measure::{self, Speed};
use super::view_rays::{RayPurpose, RaySet, ViewOptions, view_rays};
use crate::accel::{Accelerator, AcceleratorKind, BuildOptions, BuildStats, TraceCounters};
use crate::render::{Answer, SkyMode, Stage};
use crate::scene::{CameraFrame, Scene};

/// What is compared, and how.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// The structures; the first is the one that the others are measured by.
    pub kinds: Vec<AcceleratorKind>,
    /// How they are built.
    pub build: BuildOptions,
    /// Width and height of the view, in pixels.
    pub size: (u32, u32),
    /// Most rays of each purpose.
    pub most_rays: usize,
    /// How often each method is timed.
    pub repetitions: usize,
    /// Changes every random number.
    pub seed: u32,
    /// The scene's upward axis.
    pub up: Vec3,
}

impl Default for CompareOptions {
    /// All kinds with a structure over the whole scene, on the rays of a small picture.
    fn default() -> Self {
        let all = AcceleratorKind::ALL.into_iter();
        Self {
            kinds: all
                .filter(|k| !matches!(k, AcceleratorKind::Linear | AcceleratorKind::Extents))
                .collect(),
            build: BuildOptions::default(),
            size: (1280, 720),
            most_rays: 200_000,
            repetitions: 5,
            seed: 0,
            up: Vec3::Y,
        }
    }
}

/// What a comparison is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Builds a structure.
    Build(AcceleratorKind),
    /// Times and counts rays, and looks at the answers.
    Trace(RayPurpose),
}

/// A structure as it was built.
#[derive(Clone, Copy, Debug)]
pub struct BuiltMethod {
    /// Which.
    pub kind: AcceleratorKind,
    /// Wall-clock seconds; the least of three builds if one takes less than a second.
    pub build_seconds: f64,
    /// Its size.
    pub size: BuildStats,
}

/// One method on the rays of one purpose.
#[derive(Clone, Copy, Debug)]
pub struct MethodOnSet {
    /// How fast; `None` without rays.
    pub speed: Option<Speed>,
    /// Steps of traversal, summed over all rays.
    pub steps: TraceCounters,
    /// Its wrong answers among the rays that were judged.
    pub faults: Faults,
}

/// All methods on the rays of one purpose.
#[derive(Clone, Debug)]
pub struct SetReport {
    /// What the rays are for.
    pub purpose: RayPurpose,
    /// How many.
    pub rays: usize,
    /// How many hit something, as the first method has it.
    pub hits: usize,
    /// For each method, in their order.
    pub methods: Vec<MethodOnSet>,
    /// Rays that not all methods answered alike; all are judged.
    pub disagreements: usize,
    /// Disagreements beyond the oracle's budget, decided among the triangles that the methods named.
    pub decided_among_named: usize,
    /// Other rays, spread evenly, that were judged by every triangle.
    pub sampled: usize,
    /// The first wrong ones.
    pub wrong: Vec<WrongRay>,
}

/// A whole comparison.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The structures, in the order wished for.
    pub methods: Vec<BuiltMethod>,
    /// The rays, by purpose.
    pub sets: Vec<SetReport>,
}

impl Comparison {
    /// Compares. Builds and judges with the threads of the rayon pool in which it is called; rays are timed on one thread.
    ///
    /// # Panics
    /// If no kind is named.
    pub fn of(
        scene: &Scene,
        camera: &CameraFrame,
        options: &CompareOptions,
        watch: &(dyn Fn(Phase) + Sync),
    ) -> Self {
        let built = options.kinds.iter().map(|&kind| {
            watch(Phase::Build(kind));
            let (accelerator, build_seconds) = measure::build(kind, scene, &options.build);
            let size = accelerator.build_stats();
            let method = BuiltMethod {
                kind,
                build_seconds,
                size,
            };
            (method, accelerator)
        });
        let (methods, accelerators): (Vec<_>, Vec<_>) = built.unzip();
        let accelerators: Vec<&dyn Accelerator> = accelerators.iter().map(|a| &**a).collect();
        let stage = Stage::new(scene, accelerators[0], options.up, SkyMode::Auto);
        let view = ViewOptions {
            size: options.size,
            most_rays: options.most_rays,
            seed: options.seed,
        };
        let report = |set: &RaySet| {
            watch(Phase::Trace(set.purpose));
            compare_set(scene, &accelerators, set, options.repetitions)
        };
        let sets = view_rays(&stage, camera, &view)
            .iter()
            .map(report)
            .collect();
        Self { methods, sets }
    }

    /// Whether the oracle found no wrong answer of the first method.
    pub fn is_first_right(&self) -> bool {
        self.sets
            .iter()
            .all(|set| set.methods[0].faults.total() == 0)
    }
}

/// Compares on rays of one purpose.
pub fn compare_set(
    scene: &Scene,
    accelerators: &[&dyn Accelerator],
    set: &RaySet,
    repetitions: usize,
) -> SetReport {
    let speeds = measure::speeds_in_turns(accelerators, set, repetitions);
    let answers: Vec<Vec<Answer>> = accelerators
        .iter()
        .map(|a| measure::answers(*a, set))
        .collect();
    let is_hit = |a: &&Answer| matches!(a, Answer::Closest(Some(_)) | Answer::Any(true));
    let hits = answers
        .first()
        .map_or(0, |a| a.iter().filter(is_hit).count());
    let judged = Judged::of(scene, accelerators, set, &answers);
    let method = |m: usize| MethodOnSet {
        speed: speeds.as_ref().map(|s| s[m]),
        steps: measure::steps(accelerators[m], set),
        faults: judged.faults[m],
    };
    SetReport {
        purpose: set.purpose,
        rays: set.rays.len(),
        hits,
        methods: (0..accelerators.len()).map(method).collect(),
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
            ..CompareOptions::default()
        };
        let mut comparison = Comparison::of(&scene, &frame, &options, &|_| ());
        assert_eq!(comparison.methods.len(), options.kinds.len());
        assert!(comparison.is_first_right());
        for set in &comparison.sets {
            assert!(set.rays > 0 && set.disagreements == 0 && set.sampled == set.rays);
            for method in &set.methods {
                assert!(method.speed.is_some() && method.steps.primitives > 0);
            }
        }
        comparison.sets[2].methods[1].faults.add(Fault::Hole);
        assert!(comparison.is_first_right());
        comparison.sets[2].methods[0].faults.add(Fault::Hole);
        assert!(!comparison.is_first_right());
    }
}
