//! Methods on rays: how long one takes, and how wrong its answers are.

use rayon::prelude::*;

use super::ChartOptions;
use super::aimed::at_edges;
use super::course::{Course, Doing};
use super::method::ChartMethod;
use crate::accel::{Accelerator, AcceleratorKind, EmbreeError, Hit};
use crate::analysis::accuracy::verdict::{self, Verdict};
use crate::analysis::accuracy::{Kind, Oracle, judge};
use crate::analysis::measure::{self, BuildCost, Speed};
use crate::analysis::stability::Rate;
use crate::analysis::view_rays::{Query, RayPurpose, RaySet, ViewOptions, view_rays};
use crate::render::{Answer, SkyMode, Stage};
use crate::scene::Scene;

/// Triangle tests that the oracle may spend on a sample of each kind of rays, to see that the reference is right.
const SAMPLE_TESTS: u64 = 200_000_000;

/// How far the depths of right hits are from the true ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthError {
    /// Root of the mean square of the relative error.
    pub rms: f64,
    /// The greatest relative error.
    pub greatest: f64,
}

/// Answers to one kind of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrong {
    /// How many rays.
    pub rays: u64,
    /// Nothing, where something is hit.
    pub holes: u64,
    /// A hit, where nothing is.
    pub ghosts: u64,
    /// A hit that is not the first, or not where it is said to be.
    pub misplaced: u64,
    /// Of all of these together.
    pub rate: Rate,
    /// Of the others that are hits.
    pub depth: DepthError,
}

/// A method as a point.
#[derive(Clone, Debug)]
pub struct RayPoint {
    /// Which.
    pub method: ChartMethod,
    /// What the build took.
    pub build: BuildCost,
    /// Memory of the structure.
    pub bytes: u64,
    /// Rays a second, of eye and bounce rays in equal parts, and the ratio to the first method.
    pub speed: Speed,
    /// On the eye and bounce rays of the view.
    pub view: Wrong,
    /// On rays at edges.
    pub edges: Wrong,
}

/// All methods on the rays of one view.
#[derive(Clone, Debug, Default)]
pub struct RayPoints {
    /// In the order of the options.
    pub points: Vec<RayPoint>,
    /// Rays that the reference was asked, and of these how many were judged by every triangle.
    pub judged: [u64; 2],
    /// Of those judged, how many the reference had wrong: 0, or nothing here is worth anything.
    pub reference_wrong: u64,
}

impl RayPoints {
    pub(super) fn of(
        scene: &Scene,
        options: &ChartOptions,
        course: &Course,
    ) -> Result<Self, EmbreeError> {
        if options.methods.is_empty() {
            return Ok(Self::default());
        }
        course.begin(Doing::Reference);
        let reference = AcceleratorKind::Bsp.build(scene);
        let [view, edges] = sets(scene, &*reference, options);
        let oracle = Oracle::new(scene);
        let known = [&view, &edges].map(|set| {
            let mut hits = vec![None; set.rays.len()];
            reference.closest_hits(&set.rays, &mut hits);
            hits
        });
        let (mut sampled, mut reference_wrong) = (0, 0);
        for (set, hits) in [&view, &edges].into_iter().zip(&known) {
            let (of_set, wrong) = check(&oracle, scene, set, hits);
            sampled += of_set;
            reference_wrong += wrong;
        }
        course.methods(3.0);
        let mut built = Vec::new();
        for method in &options.methods {
            course.begin(Doing::Build(*method));
            let once = || method.build(scene, &options.build, options.embree.as_ref());
            let (accelerator, cost) = measure::build(&once, None);
            built.push((accelerator?, cost));
            course.methods(1.0);
        }
        let accelerators: Vec<&dyn Accelerator> = built.iter().map(|(a, _)| &**a).collect();
        course.begin(Doing::Trace);
        let round = built.len() as f64 / (options.repetitions + 1) as f64;
        let speeds = measure::speeds_in_turns(
            &accelerators,
            &view,
            options.repetitions,
            options.seed,
            &|| course.methods(round),
        );
        course.begin(Doing::Judge);
        let point = |(index, method): (usize, &ChartMethod)| {
            let (accelerator, build) = &built[index];
            let judged = |set, known| wrong(&oracle, &**accelerator, method, set, known);
            let point = RayPoint {
                method: *method,
                build: *build,
                bytes: accelerator.build_stats().bytes,
                speed: speeds.as_ref()?[index],
                view: judged(&view, &known[0]),
                edges: judged(&edges, &known[1]),
            };
            course.methods(1.0);
            Some(point)
        };
        Ok(Self {
            points: options
                .methods
                .iter()
                .enumerate()
                .filter_map(point)
                .collect(),
            judged: [(view.rays.len() + edges.rays.len()) as u64, sampled],
            reference_wrong,
        })
    }
}

/// Eye and bounce rays of the view, and rays at the edges that it shows.
fn sets(scene: &Scene, reference: &dyn Accelerator, options: &ChartOptions) -> [RaySet; 2] {
    let stage = Stage::new(scene, reference, options.up, SkyMode::Auto);
    let wishes = ViewOptions {
        size: options.size,
        most_rays: options.most_rays,
        seed: options.seed,
    };
    let sets = view_rays(&stage, &options.camera, &wishes);
    let rays_of = |purpose| {
        let set = sets.iter().find(|s: &&RaySet| s.purpose == purpose);
        set.map_or(&[][..], |s| &s.rays)
    };
    let eye = rays_of(RayPurpose::Eye);
    let mut hits = vec![None; eye.len()];
    reference.closest_hits(eye, &mut hits);
    let edges = at_edges(scene, eye, &hits, options.seed);
    let view = [eye, rays_of(RayPurpose::Bounce)].concat();
    [view, edges].map(|rays| RaySet {
        purpose: RayPurpose::Bounce,
        rays,
    })
}

/// Judges a sample of the reference's answers by every triangle: how many, and how many are wrong.
fn check(oracle: &Oracle, scene: &Scene, set: &RaySet, hits: &[Option<Hit>]) -> (u64, u64) {
    let affordable = (SAMPLE_TESTS / scene.placed_triangles().max(1)).max(1) as usize;
    let count = affordable.min(set.rays.len());
    let is_wrong = |&i: &usize| {
        let index = i * set.rays.len() / count;
        let truth = oracle.truth(&set.rays[index], Query::Closest);
        judge(truth, Answer::Closest(hits[index])).is_some()
    };
    let wrong = (0..count).into_par_iter().filter(is_wrong).count();
    (count as u64, wrong as u64)
}

/// Judges all answers of a method by the reference's, and names of triangles by exact arithmetic.
fn wrong(
    oracle: &Oracle,
    accelerator: &dyn Accelerator,
    method: &ChartMethod,
    set: &RaySet,
    known: &[Option<Hit>],
) -> Wrong {
    let answers: Vec<_> = set
        .rays
        .par_iter()
        .zip(known)
        .map(|(ray, truth)| {
            let hit = accelerator.closest_hit(ray);
            let verdict = if method.is_exact() {
                verdict::of_exact(oracle, ray, *truth, Answer::Closest(hit))
            } else {
                verdict::of_plausible(oracle, ray, *truth, hit)
            };
            let error = truth.zip(hit).map(|(truth, hit)| {
                let [t, truth] = [hit.t, truth.t].map(f64::from);
                (t - truth).abs() / truth.abs().max(f64::MIN_POSITIVE)
            });
            (verdict, error)
        })
        .collect();
    let mut found = Wrong {
        rays: set.rays.len() as u64,
        ..Wrong::default()
    };
    let (mut hits, mut squares) = (0_u64, 0.0);
    for (verdict, error) in answers {
        match verdict {
            Verdict::Wrong(Kind::Hole) => found.holes += 1,
            Verdict::Wrong(Kind::Ghost) => found.ghosts += 1,
            Verdict::Wrong(_) => found.misplaced += 1,
            Verdict::Right | Verdict::Unresolved => {
                if let Some(error) = error {
                    hits += 1;
                    squares += error * error;
                    found.depth.greatest = found.depth.greatest.max(error);
                }
            }
        }
    }
    found.depth.rms = (squares / hits.max(1) as f64).sqrt();
    found.rate = Rate::of(found.holes + found.ghosts + found.misplaced, found.rays);
    found
}
