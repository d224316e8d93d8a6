//! How fast accelerators are built and answer, and what steps they take.
//!
//! Methods are timed in turns: every repetition asks each of them once, and each repetition begins with another, so that a
//! change of the machine's mood meets all. Rays are timed on the thread that calls, by its processor time.

use std::hint::black_box;

use super::clock::Stopwatch;
use super::estimate::Estimate;
use super::memory::MemoryMeter;
use super::view_rays::{Query, RaySet};
use crate::accel::{Accelerator, TraceCounters};
use crate::render::Answer;

/// Least processor seconds of one timing: shorter passes over the rays are repeated within it, so that the clock's own cost and grain do not
/// count. Longer makes small comparisons slow.
const LEAST_TIMING: f64 = 0.005;

/// A build of fewer seconds is repeated, and the shortest of three counts: the first also pays for fresh memory pages.
const SHORT_BUILD: f64 = 1.0;

/// How fast one method answered, over all repetitions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Rays a second of processor time, on one thread.
    pub rays_per_second: Estimate,
    /// The same over that of the first method in the same repetition.
    pub ratio_to_first: Estimate,
}

/// One repetition: for each method, its rays a second.
pub type Timing = Vec<f64>;

/// What a build took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildCost {
    /// Wall-clock seconds; the least of three builds if one takes less than a second.
    pub seconds: f64,
    /// Most bytes on the heap at once, beyond what was there before; `None` where nobody counts them.
    pub peak_bytes: Option<u64>,
}

/// Builds a structure with the threads of the rayon pool in which it is called, and tells what that took.
pub fn build<T>(once: &dyn Fn() -> T, memory: Option<&MemoryMeter>) -> (T, BuildCost) {
    let timed = || {
        let watch = Stopwatch::start();
        let built = once();
        (built, watch.elapsed().wall)
    };
    let ((mut built, mut seconds), peak_bytes) = match memory {
        Some(meter) => {
            let (timed, bytes) = meter.of(timed);
            (timed, Some(bytes))
        }
        None => (timed(), None),
    };
    if seconds < SHORT_BUILD {
        for _ in 0..2 {
            // Not both at once: large structures would need twice the memory.
            drop(built);
            let (again, other) = timed();
            built = again;
            seconds = seconds.min(other);
        }
    }
    let cost = BuildCost {
        seconds,
        peak_bytes,
    };
    (built, cost)
}

/// What the accelerator answers to each ray of the set.
pub fn answers(accelerator: &dyn Accelerator, set: &RaySet) -> Vec<Answer> {
    let answer = |ray| match set.purpose.query() {
        Query::Closest => Answer::Closest(accelerator.closest_hit(ray)),
        Query::Any => Answer::Any(accelerator.any_hit(ray)),
    };
    set.rays.iter().map(answer).collect()
}

/// The steps of traversal that the answers take, summed over the set.
pub fn steps(accelerator: &dyn Accelerator, set: &RaySet) -> TraceCounters {
    let mut counters = TraceCounters::default();
    for ray in &set.rays {
        match set.purpose.query() {
            Query::Closest => {
                accelerator.closest_hit_counted(ray, &mut counters);
            }
            Query::Any => {
                accelerator.any_hit_counted(ray, &mut counters);
            }
        }
    }
    counters
}

/// Times all methods on the same rays, in turns; `None` without rays or repetitions. A pass of each before the first repetition
/// is not counted. `seed` is that of the intervals; `done` is called after the first pass and after each repetition.
pub fn speeds_in_turns(
    methods: &[&dyn Accelerator],
    set: &RaySet,
    repetitions: usize,
    seed: u32,
    done: &dyn Fn(),
) -> Option<Vec<Speed>> {
    if set.rays.is_empty() {
        return None;
    }
    let passes: Vec<usize> = methods
        .iter()
        .map(|method| {
            let warm = seconds(*method, set, 1);
            (LEAST_TIMING / warm.max(1e-9)).ceil().max(1.0) as usize
        })
        .collect();
    done();
    let mut timings: Vec<Timing> = Vec::new();
    for repetition in 0..repetitions {
        let mut timing = vec![0.0; methods.len()];
        for turn in 0..methods.len() {
            let m = (repetition + turn) % methods.len();
            let rays = (set.rays.len() * passes[m]) as f64;
            // The clock may stand still where it is coarse.
            timing[m] = rays / seconds(methods[m], set, passes[m]).max(1e-9);
        }
        timings.push(timing);
        done();
    }
    speeds(&timings, methods.len(), u64::from(seed))
}

/// The speeds of methods from the repetitions' timings.
fn speeds(timings: &[Timing], methods: usize, seed: u64) -> Option<Vec<Speed>> {
    let speed = |m: usize| {
        Some(Speed {
            rays_per_second: Estimate::of(timings.iter().map(|t| t[m]).collect(), seed)?,
            ratio_to_first: Estimate::of(timings.iter().map(|t| t[m] / t[0]).collect(), seed)?,
        })
    };
    (0..methods).map(speed).collect()
}

/// Processor seconds of some passes over the rays.
fn seconds(accelerator: &dyn Accelerator, set: &RaySet, passes: usize) -> f64 {
    let watch = Stopwatch::start();
    for _ in 0..passes {
        match set.purpose.query() {
            Query::Closest => set.rays.iter().for_each(|ray| {
                black_box(accelerator.closest_hit(ray));
            }),
            Query::Any => set.rays.iter().for_each(|ray| {
                black_box(accelerator.any_hit(ray));
            }),
        }
    }
    watch.elapsed().cpu
}

#[cfg(test)]
mod tests {
    use super::super::view_rays::RayPurpose;
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::geometry::Ray;
    use glam::Vec3;

    #[test]
    fn ratios_are_taken_within_a_repetition() {
        // A machine that is ten times slower in the second and third: the ratio is 2 throughout.
        let timings = [vec![100.0, 200.0], vec![10.0, 20.0], vec![11.0, 22.0]];
        let speeds = speeds(&timings, 2, 0).unwrap();
        assert_eq!(speeds[0].ratio_to_first.half_width(), 0.0);
        assert_eq!(speeds[1].ratio_to_first.median, 2.0);
        assert_eq!(speeds[1].rays_per_second.median, 22.0);
    }

    #[test]
    fn more_work_takes_longer_and_is_counted() {
        let scene = crate::import::load(&["models/cornell-box.obj".into()]).unwrap();
        let (linear, cost) = build(&|| AcceleratorKind::Linear.build(&scene), None);
        assert!(cost.seconds >= 0.0 && cost.peak_bytes.is_none());
        let ray = Ray::new(Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.0, 2.0, 3.0));
        let set = |purpose, count| RaySet {
            purpose,
            rays: vec![ray; count],
        };
        let eye = set(RayPurpose::Eye, 10);
        let triangles = linear.build_stats().triangles;
        assert_eq!(steps(&*linear, &eye).primitives, 10 * triangles);
        assert_eq!(answers(&*linear, &eye).len(), 10);
        let speed = speeds_in_turns(&[&*linear, &*linear], &eye, 3, 0, &|| ()).unwrap();
        assert!(speed[1].rays_per_second.median > 0.0);
        assert_eq!(speed[0].ratio_to_first.median, 1.0);
        assert_eq!(
            speeds_in_turns(&[&*linear], &set(RayPurpose::Eye, 0), 3, 0, &|| ()),
            None
        );
    }
}
