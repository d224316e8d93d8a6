//! What `stress` found, as tables: for each sweep a row a method with the first failing parameter.

use std::fmt::Write;

use bspray::analysis::stability::{
    Blame, Cell, Ending, Kind, LeakResult, MethodResult, Rate, StressResults, SweepResult, Trouble,
    parameter_text,
};

/// The whole report.
pub(super) fn table(results: &StressResults) -> String {
    let mut out = format!(
        "seed {}, up to {} rays a step; wrong answers by exact arithmetic, with 95 % intervals\n",
        results.seed, results.rays
    );
    if let Some(version) = &results.embree {
        let _ = writeln!(out, "Embree {version}");
    }
    for sweep in &results.sweeps {
        self::sweep(sweep, &mut out);
    }
    leaks(&results.leaks, &mut out);
    obvhs(results, &mut out);
    let map = &results.sign_map;
    let _ = writeln!(
        out,
        "\nsigns of a point beside a line, over {0} x {0} neighbouring floats: {1} wrong in f32 (--sign-map draws them)",
        map.size, map.differing
    );
    let default = &results.default_method;
    let _ = match results.default_failures() {
        0 => writeln!(out, "{default}: nothing wrong inside its domain"),
        count => writeln!(out, "{default}: WRONG, {count} times inside its domain"),
    };
    out
}

fn sweep(sweep: &SweepResult, out: &mut String) {
    let unit = if sweep.unit.is_empty() {
        String::new()
    } else {
        format!(" ({})", sweep.unit)
    };
    let (Some(first), Some(last)) = (sweep.steps.first(), sweep.steps.last()) else {
        return;
    };
    let _ = writeln!(
        out,
        "\n{}: {}\n{}{unit}, {} steps from {} to {}",
        sweep.name,
        sweep.description,
        sweep.parameter,
        sweep.steps.len(),
        parameter_text(first.value),
        parameter_text(last.value)
    );
    let outside = sweep
        .steps
        .iter()
        .find_map(|s| Some((s.value, s.rays_outside, s.outside.as_ref()?)));
    if let Some((at, rays, reason)) = outside {
        let _ = writeln!(
            out,
            "outside of the domain from {} on ({rays} rays there): {reason}",
            parameter_text(at)
        );
    }
    let _ = writeln!(
        out,
        "{:<18}{:>9}  {:<12}{:<15}{:>9}{:>10}{:>24}{:>12}",
        "", "fails at", "kind", "trouble", "its test", "its tree", "worst rate, %", "unresolved"
    );
    let (asked, others): (Vec<_>, Vec<_>) = sweep
        .methods
        .iter()
        .partition(|m| m.cells.iter().any(|c| c.ending != Ending::NotTried));
    for method in asked {
        row(method, sweep, out);
    }
    if !others.is_empty() {
        let names: Vec<_> = others.iter().map(|m| m.method.as_str()).collect();
        let _ = writeln!(out, "not asked: {}", names.join(", "));
    }
}

/// The first failing parameter, in all and by error of the triangle test and of the traversal; the most frequent fault and cause there.
fn row(method: &MethodResult, sweep: &SweepResult, out: &mut String) {
    let worst = method
        .cells
        .iter()
        .filter(|c| c.rays > 0)
        .max_by(|a, b| a.rate.rate.total_cmp(&b.rate.rate));
    let rate = worst.map_or_else(|| "-".to_owned(), |cell| percent(&cell.rate));
    let sum = |count: fn(&Cell) -> u64| method.cells.iter().map(count).sum::<u64>();
    let at =
        |step: Option<usize>| step.map_or("-".to_owned(), |s| parameter_text(sweep.steps[s].value));
    let first = method.first_failure.as_ref().map(|f| f.step);
    let words = match first.map(|step| &method.cells[step]) {
        None => String::new(),
        Some(cell) if cell.ending == Ending::Answered => format!(
            "{:<12}{:<15}{:>9}{:>10}",
            mostly(&cell.faults, Kind::ALL.map(Kind::name)),
            mostly(&cell.troubles, Trouble::ALL.map(Trouble::name)),
            at(method.first_blamed(Blame::Test)),
            at(method.first_blamed(Blame::Traversal)),
        ),
        Some(cell) => ended(&cell.ending),
    };
    let fails = method.fails_at(&sweep.steps);
    let unresolved = sum(|c| c.unresolved);
    let _ = writeln!(
        out,
        "{:<18}{fails:>9}  {words:<46}{rate:>24}{unresolved:>12}",
        method.method
    );
    // What else there is to know is worth a line.
    let mut later = method
        .cells
        .iter()
        .zip(&sweep.steps)
        .skip(first.map_or(0, |step| step + 1));
    let runaway =
        |cell: &Cell| matches!(cell.ending, Ending::Died { .. } | Ending::DidNotEnd { .. });
    if let Some((cell, step)) = later.rfind(|(c, _)| runaway(c)) {
        let at = parameter_text(step.value);
        let _ = writeln!(out, "{:<29}at {at}: {}", "", ended(&cell.ending));
    }
    let outside = sum(|c| c.wrong_outside);
    if outside > 0 {
        let _ = writeln!(out, "{:<29}{outside} wrong outside of the domain", "");
    }
}

/// The most frequent of them.
pub(super) fn mostly<const N: usize>(counts: &[u64; N], names: [&'static str; N]) -> &'static str {
    let most = (0..N)
        .rev()
        .max_by_key(|&i| counts[i])
        .filter(|&i| counts[i] > 0);
    most.map_or("", |i| names[i])
}

pub(super) fn ended(ending: &Ending) -> String {
    match ending {
        Ending::Answered => "answered".to_owned(),
        Ending::NotTried => "not tried".to_owned(),
        Ending::DidNotEnd { seconds } => format!("did not end in {seconds} s"),
        Ending::Died { how } => how.chars().take(44).collect(),
    }
}

fn percent(rate: &Rate) -> String {
    let [rate, low, high] = [rate.rate, rate.low, rate.high].map(|x| 100.0 * x);
    format!("{rate:.2} ({low:.2} to {high:.2})")
}

fn leaks(leaks: &[LeakResult], out: &mut String) {
    let _ = writeln!(
        out,
        "\nleaks: rays from inside a closed ball, half of them at edges and corners\n{:<18}{:>14}{:>12}{:>32}",
        "", "rays", "leaks", "share, %"
    );
    for leak in leaks {
        let [rate, low, high] = [leak.rate.rate, leak.rate.low, leak.rate.high].map(|x| 100.0 * x);
        let share = format!("{rate:.2} ({low:.6} to {high:.6})");
        let _ = writeln!(
            out,
            "{:<18}{:>14}{:>12}{share:>32}",
            leak.method, leak.rays, leak.leaks
        );
    }
}

fn obvhs(results: &StressResults, out: &mut String) {
    let _ = writeln!(out, "\nknown defects of obvhs 0.4.0");
    for defect in &results.defects {
        let _ = writeln!(out, "- {}: {}", defect.name, defect.words());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_frequent_is_the_first_of_equals() {
        assert_eq!(mostly(&[1, 4, 4], ["a", "b", "c"]), "b");
        assert_eq!(mostly(&[0, 0], ["a", "b"]), "");
    }
}
