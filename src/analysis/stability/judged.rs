//! One step, prepared: its rays, their true answers, which are inside the domain; and what a method makes of it.

use serde::{Deserialize, Serialize};

use super::methods::{Built, Method};
use super::results::{Cell, HitRecord, RayRecord, Step, WrongAnswer};
use super::statistics::Rate;
use super::sweeps::Case;
use super::truth::{Truth, Truths};
use crate::accel::{Domain, Embree, Hit};
use crate::analysis::accuracy::trouble::Wrong;
use crate::analysis::accuracy::verdict::{self, Verdict};
use crate::analysis::accuracy::{Blame, Kind, Trouble};
use crate::geometry::Ray;
use crate::render::Answer;
use crate::scene::Scene;

/// What a method makes of a step, as it comes from a child process too.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct CellReply {
    pub(super) cell: Cell,
    pub(super) wrong: Option<WrongAnswer>,
}

/// A method's triangle test without its structure, built when it is first asked.
struct Brute<'e> {
    method: Method,
    embree: Option<&'e Embree>,
    built: Option<Built>,
}

impl Brute<'_> {
    fn closest_hit(&mut self, scene: &Scene, ray: &Ray) -> Option<Hit> {
        let build = || self.method.build_brute_force(scene, self.embree);
        self.built.get_or_insert_with(build).closest_hit(ray)
    }
}

/// A step ready to judge methods by.
pub(super) struct Judged<'a> {
    case: &'a Case,
    truths: Truths<'a>,
    truth: Vec<Truth>,
    is_inside_domain: Vec<bool>,
    outside: Option<String>,
}

impl<'a> Judged<'a> {
    pub(super) fn of(case: &'a Case) -> Self {
        let truths = Truths::of(&case.scene);
        let mut outside = None;
        let is_inside_domain = match Domain::of(&case.scene) {
            Err(reason) => {
                outside = Some(reason.to_string());
                vec![false; case.rays.len()]
            }
            Ok(domain) => {
                let mut check = |ray| {
                    let checked = domain.check(ray);
                    if let Err(reason) = checked {
                        outside.get_or_insert_with(|| reason.to_string());
                    }
                    checked.is_ok()
                };
                case.rays.iter().map(&mut check).collect()
            }
        };
        Self {
            truth: case.rays.iter().map(|ray| truths.truth(ray)).collect(),
            case,
            truths,
            is_inside_domain,
            outside,
        }
    }

    /// The step itself.
    pub(super) fn step(&self, value: f64) -> Step {
        let count = |what: fn(&Truth) -> bool| self.truth.iter().filter(|t| what(t)).count() as u64;
        Step {
            value,
            triangles: self.case.scene.placed_triangles(),
            rays: self.case.rays.len() as u64,
            hits: count(|t| t.hit.is_some()),
            ties: count(|t| t.is_tied),
            rays_outside: self.is_inside_domain.iter().filter(|i| !**i).count() as u64,
            outside: self.outside.clone(),
        }
    }

    /// Builds the method, asks it and judges its answers.
    pub(super) fn cell(&self, method: Method, embree: Option<&Embree>) -> CellReply {
        let built = method.build(&self.case.scene, embree);
        let ways = built.answers(&self.case.rays);
        drop(built);
        let mut reply = CellReply::default();
        let mut brute = Brute {
            method,
            embree,
            built: None,
        };
        for index in 0..self.case.rays.len() {
            let is_inside = self.is_inside_domain[index];
            reply.cell.rays += u64::from(is_inside);
            let verdicts = ways
                .iter()
                .map(|answers| (answers[index], self.verdict(method, index, answers[index])));
            let verdicts: Vec<(Answer, Verdict)> = verdicts.collect();
            let wrong = verdicts.iter().find_map(|(answer, verdict)| match verdict {
                Verdict::Wrong(kind) => Some((*answer, *kind)),
                _ => None,
            });
            let Some((answer, kind)) = wrong else {
                let is_unresolved = verdicts.iter().any(|(_, v)| *v == Verdict::Unresolved);
                reply.cell.unresolved += u64::from(is_inside && is_unresolved);
                continue;
            };
            if !is_inside {
                reply.cell.wrong_outside += 1;
                continue;
            }
            let wrong = self.explained(index, answer, kind, &mut brute);
            let cell = &mut reply.cell;
            cell.faults[wrong.kind as usize] += 1;
            cell.troubles[wrong.trouble as usize] += 1;
            match wrong.blame {
                Blame::Test => cell.by_test += 1,
                Blame::Traversal => cell.by_traversal += 1,
            }
            reply.wrong.get_or_insert(wrong);
        }
        reply.cell.rate = Rate::of(reply.cell.wrong(), reply.cell.rays);
        reply
    }

    fn verdict(&self, method: Method, index: usize, answer: Answer) -> Verdict {
        let (ray, truth) = (&self.case.rays[index], self.truth[index].hit);
        let verdict = match answer {
            Answer::Closest(hit) if !method.is_exact() => {
                verdict::of_plausible(&self.truths.oracle, ray, truth, hit)
            }
            _ => verdict::of_exact(&self.truths.oracle, ray, truth, answer),
        };
        match verdict {
            Verdict::Wrong(Kind::Hole) if self.case.is_inside => Verdict::Wrong(Kind::Leak),
            verdict => verdict,
        }
    }

    fn explained(
        &self,
        index: usize,
        answer: Answer,
        kind: Kind,
        brute: &mut Brute,
    ) -> WrongAnswer {
        let (ray, truth) = (&self.case.rays[index], self.truth[index].hit);
        let method = brute.method;
        let mut of_brute = || {
            let hit = brute.closest_hit(&self.case.scene, ray);
            self.verdict(method, index, Answer::Closest(hit))
        };
        let is_of_test = method.is_brute_force() || of_brute() == Verdict::Wrong(kind);
        let blame = if is_of_test {
            Blame::Test
        } else {
            Blame::Traversal
        };
        let said = match answer {
            Answer::Closest(hit) => hit,
            Answer::Any(_) => None,
        };
        let about: Option<Hit> = truth.or(said);
        let tested =
            about.and_then(|hit| self.truths.oracle.tested(ray, hit.instance, hit.triangle));
        let trouble = tested.map_or(Trouble::Cull, |(ray, triangle)| {
            let depths = (truth.map(|hit| hit.t), said.map(|hit| hit.t));
            Wrong {
                kind,
                blame,
                ray: &ray,
                triangle: &triangle,
                depths,
            }
            .trouble()
        });
        WrongAnswer {
            kind,
            blame,
            trouble,
            index: index as u64,
            ray: RayRecord::of(ray),
            truth: truth.map(HitRecord::of),
            answer: said.map(HitRecord::of),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sweeps::Sweep;
    use super::*;

    fn cell(sweep: &str, value: f64, method: &str) -> Cell {
        let case = Sweep::named(sweep).unwrap().case(value, 300, 1);
        Judged::of(&case).cell(method.parse().unwrap(), None).cell
    }

    #[test]
    fn naive_methods_fail_where_it_is_known_and_their_tests_or_trees_are_blamed() {
        let edges = cell("edges-inside", 0.0, "moller-trumbore");
        assert!(edges.faults[Kind::Leak as usize] > 3, "{edges:?}");
        assert_eq!(edges.by_test, edges.wrong());
        assert!(edges.troubles[Trouble::Edge as usize] > 3, "{edges:?}");
        let epsilon = cell("distance-boxes", 3e7, "epsilon-bsp");
        assert!(epsilon.by_traversal > 3, "{epsilon:?}");
        let small = cell("small", 1e-6, "obvhs-cwbvh-boxes");
        assert_eq!(small.by_traversal, 300, "{small:?}");
        assert!(small.troubles[Trouble::Cull as usize] > 200, "{small:?}");
        let back = cell("diagonal-back", 0.0, "obvhs-triangle");
        assert!(back.rate.low > 0.02, "{back:?}");
    }

    #[test]
    fn the_default_method_is_right_there() {
        for (sweep, value) in [
            ("edges-inside", 0.0),
            ("distance", 1e5),
            ("small", 1e-6),
            ("tilt", -0.0),
        ] {
            let cell = cell(sweep, value, "bsp");
            assert_eq!((cell.rays, cell.wrong()), (300, 0), "{sweep}: {cell:?}");
        }
    }

    #[test]
    fn what_is_outside_of_the_domain_is_named_and_does_not_count() {
        let case = Sweep::named("beyond").unwrap().case(1e25, 20, 1);
        let judged = Judged::of(&case);
        let step = judged.step(1e25);
        assert_eq!((step.rays, step.rays_outside), (20, 20));
        assert!(step.outside.unwrap().contains("beyond 1e18"));
        assert_eq!(judged.cell(Method::MollerTrumbore, None).cell.rays, 0);
    }
}
