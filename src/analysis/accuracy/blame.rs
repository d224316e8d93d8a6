//! Whose error an error is: the triangle test's, if brute force with the same test makes it too; else the traversal's. And what explains it.

use super::alone::Alone;
use super::dispute::verdict;
use super::trouble;
use super::verdict::Verdict;
use super::{Blame, Kind, Oracle, Trouble};
use crate::accel::{Accelerator, AcceleratorKind, Embree, EmbreeMode, Hit};
use crate::analysis::compare::{Entrant, Source};
use crate::analysis::view_rays::Query;
use crate::geometry::{Ray, Triangle};
use crate::render::Answer;
use crate::scene::Scene;

/// Triangle tests that may be spent on the errors of one set: some seconds.
const BLAME_TESTS: u64 = 400_000_000;

/// Brute force by the triangle tests of the methods that were wrong.
pub(super) struct BruteForces<'a> {
    scene: &'a Scene,
    /// Built when it is first needed.
    linear: Option<Box<dyn Accelerator>>,
    tests_left: u64,
}

/// A wrong answer to a question.
#[derive(Clone, Copy)]
pub(super) struct Wrong<'a> {
    pub(super) ray: &'a Ray,
    pub(super) query: Query,
    pub(super) truth: Answer,
    pub(super) answer: Answer,
    pub(super) kind: Kind,
}

impl<'a> BruteForces<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            linear: None,
            tests_left: BLAME_TESTS,
        }
    }

    /// Whose error it is that a method's answer was wrong in this way, and what explains it; `None` where that is too much work.
    pub(super) fn explain(
        &mut self,
        oracle: &Oracle,
        entrant: &Entrant,
        wrong: &Wrong,
    ) -> Option<(Blame, Trouble)> {
        self.tests_left = self.tests_left.checked_sub(self.scene.placed_triangles())?;
        let hits = hits(oracle, entrant, wrong);
        let hit = match &entrant.contestant.source {
            Source::Structure(_) => self.nearest_of_all(wrong.ray),
            Source::Embree(embree, mode) => self.nearest_alone(wrong.ray, hits, embree, *mode),
        };
        let answer = match wrong.query {
            Query::Closest => Answer::Closest(hit),
            Query::Any => Answer::Any(hit.is_some()),
        };
        let said = verdict(oracle, entrant.contestant, wrong.ray, wrong.truth, answer);
        let blame = if said == Verdict::Wrong(wrong.kind) {
            Blame::Test
        } else {
            Blame::Traversal
        };
        Some((blame, trouble(oracle, wrong, hits, blame)))
    }

    fn nearest_of_all(&mut self, ray: &Ray) -> Option<Hit> {
        let build = || AcceleratorKind::Linear.build(self.scene);
        self.linear.get_or_insert_with(build).closest_hit(ray)
    }

    /// What Embree's test says of the triangles that matter, each in a scene of its own.
    fn nearest_alone(
        &self,
        ray: &Ray,
        hits: [Option<Hit>; 2],
        embree: &Embree,
        mode: EmbreeMode,
    ) -> Option<Hit> {
        let names = hits.into_iter().flatten();
        let names = names.map(|hit| (hit.instance, hit.triangle));
        let triangles = names.filter_map(|name| Some((name, self.in_world(name)?)));
        Alone::of(triangles.collect(), embree, mode).closest_hit(ray)
    }

    /// The triangle of that name as Embree has it.
    fn in_world(&self, (instance, triangle): (u32, u32)) -> Option<Triangle> {
        let placed = self.scene.instances.get(instance as usize)?;
        let triangles = &self.scene.mesh_of(instance).triangles;
        let is_there = (triangle as usize) < triangles.len();
        is_there.then(|| {
            let in_object = self.scene.mesh_of(instance).triangle(triangle);
            let [a, b, c] = in_object.corners().map(|p| placed.world_point(p));
            Triangle::new(a, b, c)
        })
    }
}

/// What is truly hit, and what the answer says; of answers that only say whether there is a hit, the nearest ones.
fn hits(oracle: &Oracle, entrant: &Entrant, wrong: &Wrong) -> [Option<Hit>; 2] {
    let truly = match wrong.truth {
        Answer::Closest(hit) => hit,
        Answer::Any(false) => None,
        Answer::Any(true) => match oracle.truth(wrong.ray, Query::Closest) {
            Answer::Closest(hit) => hit,
            Answer::Any(_) => None,
        },
    };
    let said = match wrong.answer {
        Answer::Closest(hit) => hit,
        Answer::Any(false) => None,
        Answer::Any(true) => entrant.accelerator.closest_hit(wrong.ray),
    };
    [truly, said]
}

/// What explains it, from where the ray passes the triangle that it is about.
fn trouble(
    oracle: &Oracle,
    wrong: &Wrong,
    [truly, said]: [Option<Hit>; 2],
    blame: Blame,
) -> Trouble {
    let about = truly.or(said);
    let tested = about.and_then(|hit| oracle.tested(wrong.ray, hit.instance, hit.triangle));
    tested.map_or(Trouble::Cull, |(ray, triangle)| {
        trouble::Wrong {
            kind: wrong.kind,
            blame,
            ray: &ray,
            triangle: &triangle,
            depths: (truly.map(|hit| hit.t), said.map(|hit| hit.t)),
        }
        .trouble()
    })
}
