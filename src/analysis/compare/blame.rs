//! Whose error an error is: the triangle test's, if brute force with the same test makes it too; else the traversal's.

use super::contestant::Contestant;
use super::dispute::verdict;
use crate::accel::{Accelerator, BuildOptions};
use crate::analysis::accuracy::Oracle;
use crate::analysis::stability::verdict::Verdict;
use crate::analysis::stability::{Blame, Kind};
use crate::analysis::view_rays::Query;
use crate::geometry::Ray;
use crate::render::Answer;
use crate::scene::Scene;

/// Triangle tests that may be spent on the errors of one set: some seconds.
const BLAME_TESTS: u64 = 400_000_000;

/// Brute force by the triangle tests of the methods that were wrong, each built when it is first needed.
pub(super) struct BruteForces<'a> {
    scene: &'a Scene,
    built: Vec<(Contestant, Box<dyn Accelerator>)>,
    tests_left: u64,
}

impl<'a> BruteForces<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            built: Vec::new(),
            tests_left: BLAME_TESTS,
        }
    }

    /// Whose error it is that a method's answer to a question was wrong in this way; `None` where that is too much work.
    pub(super) fn blame(
        &mut self,
        oracle: &Oracle,
        contestant: &Contestant,
        (ray, query): (&Ray, Query),
        truth: Answer,
        wrong: Kind,
    ) -> Option<Blame> {
        self.tests_left = self.tests_left.checked_sub(self.scene.placed_triangles())?;
        let brute = self.of(contestant);
        let answer = match query {
            Query::Closest => Answer::Closest(brute.closest_hit(ray)),
            Query::Any => Answer::Any(brute.any_hit(ray)),
        };
        let is_same = verdict(oracle, contestant, ray, truth, answer) == Verdict::Wrong(wrong);
        Some(if is_same {
            Blame::Test
        } else {
            Blame::Traversal
        })
    }

    fn of(&mut self, contestant: &Contestant) -> &dyn Accelerator {
        let wanted = contestant.brute_force();
        let known = self.built.iter().position(|(built, _)| *built == wanted);
        let place = known.unwrap_or_else(|| {
            let accelerator = wanted.build(self.scene, &BuildOptions::default());
            self.built.push((wanted, accelerator));
            self.built.len() - 1
        });
        &*self.built[place].1
    }
}
