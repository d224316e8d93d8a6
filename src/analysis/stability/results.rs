//! What `stress` finds, as plain data: every list is in the order of the registries, and all of it serialises.

use serde::{Deserialize, Serialize};

use super::ending::Ending;
use super::statistics::Rate;
use crate::accel::Hit;
use crate::analysis::accuracy::{Blame, Kind, Trouble};
use crate::geometry::Ray;

/// A parameter in words: small integers as they are, others by powers of ten.
pub fn parameter_text(value: f64) -> String {
    if value.abs() < 1e6 && value.fract().abs() <= 0.0 {
        format!("{value}")
    } else {
        format!("{value:.1e}")
    }
}

/// One method at one step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Rays that were judged: those inside the domain.
    pub rays: u64,
    /// Wrong answers, for each of [`Kind::ALL`].
    pub faults: [u64; 6],
    /// The same by cause, for each of [`Trouble::ALL`].
    pub troubles: [u64; 7],
    /// Those that are the triangle test's.
    pub by_test: u64,
    /// Those that are the structure's.
    pub by_traversal: u64,
    /// Another triangle at the true depth, as far as `f32` can tell: no failure.
    pub unresolved: u64,
    /// Wrong answers outside of the domain ([`Step::outside`]), which do not count.
    pub wrong_outside: u64,
    /// Wrong answers over rays, with the 95 % interval.
    pub rate: Rate,
    /// How it ended.
    pub ending: Ending,
}

impl Cell {
    /// All wrong answers inside the domain.
    pub fn wrong(&self) -> u64 {
        self.faults.iter().sum()
    }

    /// Whether it answered, and nothing wrong. What was not tried is not known to fail.
    pub fn is_right(&self) -> bool {
        self.wrong() == 0 && matches!(self.ending, Ending::Answered | Ending::NotTried)
    }
}

/// A ray to reproduce: its numbers are printed so that they read back as the same bits. An infinite end is `null`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RayRecord {
    /// World space, model units.
    pub origin: [f32; 3],
    /// Not of unit length.
    pub direction: [f32; 3],
    /// Least `t`.
    pub min: Option<f32>,
    /// Greatest `t`.
    pub max: Option<f32>,
}

impl RayRecord {
    pub(super) fn of(ray: &Ray) -> Self {
        let finite = |x: f32| x.is_finite().then_some(x);
        Self {
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            min: finite(ray.interval.min),
            max: finite(ray.interval.max),
        }
    }
}

/// A hit to reproduce.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HitRecord {
    /// In units of the direction's length; `null` if the method's is not finite.
    pub t: Option<f32>,
    /// Index of the instance.
    pub instance: u32,
    /// Index in its mesh.
    pub triangle: u32,
}

impl HitRecord {
    pub(super) fn of(hit: Hit) -> Self {
        Self {
            t: hit.t.is_finite().then_some(hit.t),
            instance: hit.instance,
            triangle: hit.triangle,
        }
    }
}

/// A wrong answer with all that is needed to see it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrongAnswer {
    /// How it is wrong.
    pub kind: Kind,
    /// Whose error it is.
    pub blame: Blame,
    /// What explains it.
    pub trouble: Trouble,
    /// Index of the ray within the step; the scene is that of the sweep, the step and the seed.
    pub index: u64,
    /// The ray.
    pub ray: RayRecord,
    /// What it hits.
    pub truth: Option<HitRecord>,
    /// What the method says.
    pub answer: Option<HitRecord>,
}

/// Where a method first fails in a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstFailure {
    /// Index of the step.
    pub step: usize,
    /// The parameter there.
    pub value: f64,
    /// The first wrong answer; `null` if the method did not end or ended the process.
    pub wrong: Option<WrongAnswer>,
}

/// A step of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The parameter.
    pub value: f64,
    /// Triangles, as placed.
    pub triangles: u64,
    /// Rays.
    pub rays: u64,
    /// Rays that hit something.
    pub hits: u64,
    /// Rays that meet several triangles at depths that round to the `t` of the first hit.
    pub ties: u64,
    /// Rays outside of the domain, all of them if the scene is.
    pub rays_outside: u64,
    /// Why the scene, or the first such ray, is outside of the domain.
    pub outside: Option<String>,
}

/// One method in one sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodResult {
    /// Its name.
    pub method: String,
    /// One for each step.
    pub cells: Vec<Cell>,
    /// The first step at which it fails, from the mildest on.
    pub first_failure: Option<FirstFailure>,
}

impl MethodResult {
    /// At which step it first fails, in words; `never` only of methods that were asked inside the domain.
    pub fn fails_at(&self, steps: &[Step]) -> String {
        let is_asked = |cell: &Cell| cell.ending != Ending::NotTried;
        match &self.first_failure {
            Some(failure) => parameter_text(steps[failure.step].value),
            None if self.cells.iter().any(|cell| cell.rays > 0) => "never".to_owned(),
            None if self.cells.iter().any(is_asked) => "outside".to_owned(),
            None => "not asked".to_owned(),
        }
    }

    /// The first step with an error of the triangle test, or of the traversal.
    pub fn first_blamed(&self, blame: Blame) -> Option<usize> {
        self.cells.iter().position(|cell| match blame {
            Blame::Test => cell.by_test > 0,
            Blame::Traversal => cell.by_traversal > 0,
        })
    }
}

/// One sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepResult {
    /// Its name.
    pub name: String,
    /// What it does.
    pub description: String,
    /// What the parameter is.
    pub parameter: String,
    /// Its unit; empty for ratios and counts.
    pub unit: String,
    /// From the mildest to the hardest.
    pub steps: Vec<Step>,
    /// In the order of the registry.
    pub methods: Vec<MethodResult>,
}

/// Rays from inside a closed mesh, all of which must hit it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeakResult {
    /// The method.
    pub method: String,
    /// Rays sent, half of them at edges and corners.
    pub rays: u64,
    /// Rays that met nothing.
    pub leaks: u64,
    /// Their share.
    pub rate: Rate,
}

/// A formula of obvhs beside what it should give. A value that is not finite is `null`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormulaResult {
    /// The function, and what it was asked.
    pub name: String,
    /// What is right.
    pub expected: Option<f64>,
    /// What it gave.
    pub found: Option<f64>,
    /// Whether they are equal.
    pub is_right: bool,
}

/// A known defect of obvhs 0.4.0, and whether this run shows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DefectResult {
    /// Its name.
    pub name: String,
    /// The evidence in this run.
    pub evidence: Option<String>,
    /// Whether what would show it was part of this run.
    pub is_looked_for: bool,
}

impl DefectResult {
    /// The evidence, or why there is none.
    pub fn words(&self) -> &str {
        match (&self.evidence, self.is_looked_for) {
            (Some(evidence), _) => evidence,
            (None, true) => "not found",
            (None, false) => "not looked for",
        }
    }
}

/// The signs of one predicate over a square of neighbouring floats, in both arithmetics: -1, 0, 1, row by row from the greatest y.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignMap {
    /// Columns and rows.
    pub size: u32,
    /// In single precision.
    pub naive: Vec<i8>,
    /// Without rounding.
    pub exact: Vec<i8>,
    /// Places with different signs.
    pub differing: u64,
}

/// All that `stress` finds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressResults {
    /// The method that must be right.
    pub default_method: String,
    /// The seed.
    pub seed: u64,
    /// Rays a step, at most; fewer where each costs very much.
    pub rays: u64,
    /// The version of Embree, if it took part.
    pub embree: Option<String>,
    /// The sweeps, in the order of the registry.
    pub sweeps: Vec<SweepResult>,
    /// Rays from inside a closed mesh.
    pub leaks: Vec<LeakResult>,
    /// Formulas of obvhs.
    pub formulas: Vec<FormulaResult>,
    /// Known defects of obvhs.
    pub defects: Vec<DefectResult>,
    /// A predicate over neighbouring floats.
    pub sign_map: SignMap,
}

impl StressResults {
    /// Wrong answers and leaks of the default method inside its domain, and cells in which it did not answer.
    pub fn default_failures(&self) -> u64 {
        let is_default = |name: &str| name == self.default_method;
        let methods = self.sweeps.iter().flat_map(|sweep| &sweep.methods);
        let cells = methods
            .filter(|m| is_default(&m.method))
            .flat_map(|m| &m.cells);
        let wrong: u64 = cells
            .map(|c| c.wrong() + u64::from(c.ending != Ending::Answered))
            .sum();
        let leaks = self.leaks.iter().filter(|l| is_default(&l.method));
        wrong + leaks.map(|l| l.leaks).sum::<u64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_short() {
        assert_eq!(parameter_text(2048.0), "2048");
        assert_eq!(parameter_text(-0.0), "-0");
        assert_eq!(parameter_text(3.16e-7), "3.2e-7");
        assert_eq!(parameter_text(1e18), "1.0e18");
    }

    #[test]
    fn what_was_not_tried_is_not_known_to_fail() {
        let with = |ending| Cell {
            ending,
            ..Cell::default()
        };
        assert!(with(Ending::NotTried).is_right() && with(Ending::Answered).is_right());
        assert!(!with(Ending::DidNotEnd { seconds: 1 }).is_right());
        let mut cells = vec![Cell::default(); 3];
        (cells[1].by_test, cells[2].by_traversal) = (1, 1);
        let result = MethodResult {
            method: String::new(),
            cells,
            first_failure: None,
        };
        assert_eq!(result.first_blamed(Blame::Test), Some(1));
        assert_eq!(result.first_blamed(Blame::Traversal), Some(2));
    }
}
