//! The defects of obvhs 0.4.0 that are known, and where a run shows them. A defect that a newer obvhs has not is reported as not found.

use super::ending::Ending;
use super::results::{DefectResult, FormulaResult, SweepResult, parameter_text};
use crate::accel::{FormulaCheck, formula_checks};
use crate::analysis::accuracy::Blame;

/// What shows a defect.
enum Shown {
    /// The formula whose name begins so is wrong.
    Formula(&'static str),
    /// The method is wrong in the sweep, and this is to blame.
    Wrong(&'static str, &'static str, Blame),
    /// The same, at the sweep's last step alone.
    WrongAtLast(&'static str, &'static str, Blame),
    /// The method does not end, or ends the process.
    RunsAway(&'static str, &'static str),
    /// Which of equal hits wins is not the first.
    Ties(&'static str, &'static str),
}

/// Name, and what shows it.
const KNOWN: &[(&str, Shown)] = &[
    (
        "Aabb::surface_area is wrong for all boxes but cubes",
        Shown::Formula("Aabb::surface_area"),
    ),
    (
        "Triangle::compute_barycentric is wrong",
        Shown::Formula("Triangle::compute_barycentric"),
    ),
    (
        "Triangle::intersect_embree returns an unscaled t",
        Shown::Formula("Triangle::intersect_embree"),
    ),
    (
        "Aabb::intersect_ray does not look at tmin",
        Shown::Formula("Aabb::intersect_ray"),
    ),
    (
        "a miss leaves the ray's end as the hit's t",
        Shown::Formula("Bvh2::ray_traverse,"),
    ),
    (
        "ray_traverse_anyhit visits all hits",
        Shown::Formula("Bvh2::ray_traverse_anyhit"),
    ),
    (
        "Triangle::intersect loses edges seen from the back",
        Shown::Wrong("diagonal-back", "obvhs-triangle", Blame::Test),
    ),
    (
        "Triangle::intersect leaks at shared edges",
        Shown::Wrong("edges-inside", "obvhs-triangle", Blame::Test),
    ),
    (
        "Triangle::intersect leaks at shared corners",
        Shown::Wrong("vertices", "obvhs-triangle", Blame::Test),
    ),
    (
        "Bvh2's boxes lose rays in their max sides",
        Shown::Wrong("face-planes", "obvhs-bvh2-boxes", Blame::Traversal),
    ),
    (
        "CwBvh's boxes lose rays in their sides",
        Shown::Wrong("splitting-planes", "obvhs-cwbvh-boxes", Blame::Traversal),
    ),
    (
        "Bvh2's boxes have no margin: rays at corners are lost",
        Shown::Wrong("vertices", "obvhs-bvh2-boxes", Blame::Traversal),
    ),
    (
        "Bvh2 loses boxes narrower than t / 8.4e6",
        Shown::Wrong("narrow", "obvhs-bvh2-boxes", Blame::Traversal),
    ),
    (
        "CwBvh loses boxes narrower than t / 8.4e6",
        Shown::Wrong("narrow", "obvhs-cwbvh-boxes", Blame::Traversal),
    ),
    (
        "both trees lose rays whose direction is short: components are clamped to 2^-23",
        Shown::Wrong("short-directions", "obvhs-bvh2-boxes", Blame::Traversal),
    ),
    (
        "CwBvh enters no node that ends within 1e-4 of the origin",
        Shown::Wrong("small", "obvhs-cwbvh-boxes", Blame::Traversal),
    ),
    (
        "CwBvh loses rays far from the origin",
        Shown::Wrong("distance", "obvhs-cwbvh-boxes", Blame::Traversal),
    ),
    (
        "CwBvh misses rays with a component of -0",
        Shown::WrongAtLast("tilt", "obvhs-cwbvh-boxes", Blame::Traversal),
    ),
    (
        "Bvh2 does not survive very many coincident triangles",
        Shown::RunsAway("coincident", "obvhs-bvh2"),
    ),
    (
        "CwBvh does not survive very many coincident triangles",
        Shown::RunsAway("coincident", "obvhs-cwbvh"),
    ),
    (
        "which of equal hits Bvh2 returns depends on its build",
        Shown::Ties("coincident", "obvhs-bvh2"),
    ),
];

/// The formulas of obvhs beside what they should give.
pub(super) fn formulas() -> Vec<FormulaResult> {
    let finite = |x: f64| x.is_finite().then_some(x);
    // The values are exact by construction, or wrong by far more than rounding.
    let is_right = |check: &FormulaCheck| (check.expected - check.found).abs() < 1e-6;
    formula_checks()
        .iter()
        .map(|check| FormulaResult {
            name: check.name.to_owned(),
            expected: finite(check.expected),
            found: finite(check.found),
            is_right: is_right(check) || check.expected.to_bits() == check.found.to_bits(),
        })
        .collect()
}

/// What this run shows of the known defects.
pub(super) fn defects(sweeps: &[SweepResult], formulas: &[FormulaResult]) -> Vec<DefectResult> {
    KNOWN
        .iter()
        .map(|(name, shown)| {
            let (is_looked_for, evidence) = look(shown, sweeps, formulas);
            DefectResult {
                name: (*name).to_owned(),
                evidence,
                is_looked_for,
            }
        })
        .collect()
}

fn look(
    shown: &Shown,
    sweeps: &[SweepResult],
    formulas: &[FormulaResult],
) -> (bool, Option<String>) {
    let (sweep, method) = match shown {
        Shown::Formula(begin) => {
            let formula = formulas.iter().find(|f| f.name.starts_with(begin));
            let wrong = formula.filter(|f| !f.is_right);
            let number = |x: Option<f64>| x.map_or("no number".to_owned(), |x| x.to_string());
            let words =
                wrong.map(|f| format!("{} instead of {}", number(f.found), number(f.expected)));
            return (formula.is_some(), words);
        }
        Shown::Wrong(sweep, method, _)
        | Shown::WrongAtLast(sweep, method, _)
        | Shown::RunsAway(sweep, method)
        | Shown::Ties(sweep, method) => (sweep, method),
    };
    let found = sweeps.iter().find(|s| s.name == *sweep);
    let cells = found.and_then(|s| Some((s, s.methods.iter().find(|m| m.method == *method)?)));
    let Some((sweep, method)) = cells else {
        return (false, None);
    };
    let last = sweep.steps.len() - 1;
    let of = |blame: &Blame, cell: &super::results::Cell| match blame {
        Blame::Test => cell.by_test,
        Blame::Traversal => cell.by_traversal,
    };
    let evidence =
        sweep
            .steps
            .iter()
            .zip(&method.cells)
            .enumerate()
            .find_map(|(i, (step, cell))| {
                let at = format!(
                    "{} at {} {}",
                    sweep.name,
                    parameter_text(step.value),
                    sweep.unit
                );
                let at = at.trim_end();
                let counted = |count: u64, what: &str| {
                    (count > 0).then(|| format!("{count} of {} {what}, {at}", cell.rays))
                };
                match shown {
                    Shown::WrongAtLast(_, _, _) if i < last => None,
                    Shown::Wrong(_, _, blame) | Shown::WrongAtLast(_, _, blame) => {
                        counted(of(blame, cell), "rays")
                    }
                    Shown::Ties(..) => counted(cell.unresolved, "rays under another name"),
                    Shown::RunsAway(..) => match &cell.ending {
                        Ending::DidNotEnd { seconds } => {
                            Some(format!("did not end in {seconds} s, {at}"))
                        }
                        Ending::Died { how } => Some(format!("{how}, {at}")),
                        _ => None,
                    },
                    Shown::Formula(_) => None,
                }
            });
    (true, evidence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::stability::{Method, Sweep};

    #[test]
    fn every_defect_names_sweeps_methods_and_formulas_that_there_are() {
        let formulas = formulas();
        for (name, shown) in KNOWN {
            match shown {
                Shown::Formula(begin) => {
                    assert!(formulas.iter().any(|f| f.name.starts_with(begin)), "{name}");
                }
                Shown::Wrong(sweep, method, _)
                | Shown::WrongAtLast(sweep, method, _)
                | Shown::RunsAway(sweep, method)
                | Shown::Ties(sweep, method) => {
                    assert!(
                        Sweep::named(sweep).is_ok() && method.parse::<Method>().is_ok(),
                        "{name}"
                    );
                }
            }
        }
        let shown = defects(&[], &formulas);
        let looked: Vec<_> = shown.iter().filter(|d| d.is_looked_for).collect();
        assert_eq!(looked.len(), 6);
        assert!(looked.iter().all(|d| d.evidence.is_some()), "{looked:?}");
    }
}
