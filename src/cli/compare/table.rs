//! What a comparison found, as tables of at most 100 columns.

use std::fmt::Write;

use bspray::analysis::accuracy::Trouble;
use bspray::analysis::{Agreement, Estimate, Fault, Mistakes, PairReport, SetReport, Speed};

use super::report::{CompareReport, per_ray};

/// Pairs of methods that are told one by one; JSON and reports have all.
const TOLD_PAIRS: usize = 12;

/// Degrees between normals from which they are told: less would be printed as none.
const LEAST_TURN: f64 = 0.05;

impl CompareReport<'_> {
    /// A table of the methods, one for each set of rays, the pairs that differ, and the oracle's verdict.
    pub(super) fn table(&self) -> String {
        let (options, threads) = (self.options, self.threads);
        let mut out = format!(
            "{}\ncamera: {}\nseed {}, {} repetitions; built with {threads} thread{}, rays timed on one\n\n",
            crate::cli::render::describe(self.scene),
            self.camera_flags,
            options.seed,
            options.repetitions,
            if threads == 1 { "" } else { "s" },
        );
        let _ = writeln!(
            out,
            "{:<14}{:>11}{:>14}{:>14}{:>12}{:>12}{:>8}",
            "structure", "build s", "peak bytes", "bytes", "bytes/tri", "nodes", "depth"
        );
        for method in &self.comparison.methods {
            let size = method.size;
            let peak = method.cost.peak_bytes;
            let told = |n: u64| match method.contestant.counts_steps() {
                true => n.to_string(),
                false => "-".to_owned(),
            };
            let _ = writeln!(
                out,
                "{:<14}{:>11.6}{:>14}{:>14}{:>12.1}{:>12}{:>8}",
                method.contestant.name,
                method.cost.seconds,
                peak.map_or("not known".to_owned(), |b| b.to_string()),
                size.bytes,
                size.bytes as f64 / size.triangles.max(1) as f64,
                told(size.nodes),
                told(u64::from(size.depth)),
            );
        }
        for set in &self.comparison.sets {
            self.set(set, &mut out);
        }
        out += "\nin brackets: 95 % intervals of medians\n";
        self.pairs(&mut out);
        self.verdict(&mut out);
        out
    }

    fn set(&self, set: &SetReport, out: &mut String) {
        let (name, query) = (&set.name, set.purpose.query().name());
        if set.rays == 0 {
            let _ = writeln!(out, "\n{name}: no rays");
            return;
        }
        let share = 100.0 * set.hits as f64 / set.rays as f64;
        let _ = writeln!(
            out,
            "\n{name}: {} rays, {query}; {share:.0} % hit",
            set.rays
        );
        let names = self.names();
        let _ = writeln!(
            out,
            "{:<14}{:>22}{:>25}{:>10}{:>11}{:>9}{:>7}",
            "",
            "Mrays/s",
            format!("x {}", names[0]),
            "nodes/ray",
            "leaves/ray",
            "tris/ray",
            "wrong"
        );
        for (name, method) in names.iter().zip(&set.methods) {
            let speed = |of: fn(&Speed) -> Estimate, unit: f64| {
                let estimate = method.speed.as_ref().map(of);
                estimate.map_or("-".to_owned(), |e| {
                    let [median, low, high] = [e.median, e.low, e.high].map(|x| digits(x / unit));
                    format!("{median} [{low}, {high}]")
                })
            };
            let [nodes, leaves, triangles] =
                per_ray(set, method).map(|mean| mean.map_or("-".to_owned(), |n| format!("{n:.2}")));
            let _ = writeln!(
                out,
                "{name:<14}{:>22}{:>25}{nodes:>10}{leaves:>11}{triangles:>9}{:>7}",
                speed(|s| s.rays_per_second, 1e6),
                speed(|s| s.ratio_to_first, 1.0),
                method.mistakes.faults.total()
            );
        }
        let alike = not_significant(set, &names);
        if !alike.is_empty() {
            let _ = writeln!(
                out,
                "no significant difference from {}: {}",
                names[0],
                alike.join(", ")
            );
        }
    }

    /// How the answers of each two methods lie to one another, where they are not all the same.
    fn pairs(&self, out: &mut String) {
        let (names, groups) = (self.names(), self.alike());
        out.push('\n');
        if groups.len() == 1 && names.len() > 1 {
            let _ = writeln!(out, "every structure gives the same answer to every ray");
            return;
        }
        for group in groups.iter().filter(|group| group.len() > 1) {
            let words = self.group_words(group);
            let _ = writeln!(out, "the same answer to every ray: {words}");
        }
        let pairs = self.unlike_pairs().into_iter();
        let different: Vec<_> = pairs.filter(|(_, pair)| pair.different() > 0).collect();
        for (set, pair) in different.iter().take(TOLD_PAIRS) {
            let [a, b] = pair.methods.map(|m| names[m]);
            let words = pair_words(pair);
            let _ = writeln!(out, "{} rays, {a} and {b}:\n  {words}", set.name);
        }
        if different.len() > TOLD_PAIRS {
            let more = different.len() - TOLD_PAIRS;
            let _ = writeln!(out, "{more} more pairs differ: see --json or --report");
        }
    }

    /// What was looked at, and who was wrong about what.
    fn verdict(&self, out: &mut String) {
        let sets = &self.comparison.sets;
        let sum = |count: fn(&SetReport) -> usize| sets.iter().map(count).sum::<usize>();
        let _ = writeln!(
            out,
            "disputed: {} of {} rays; of the others {} were checked against every triangle",
            sum(|s| s.disputed),
            sum(|s| s.rays),
            sum(|s| s.sampled)
        );
        let among_named = sum(|s| s.decided_among_named);
        if among_named > 0 {
            let _ = writeln!(
                out,
                "{among_named} of the disputed were decided among the triangles that a structure named"
            );
        }
        for (m, name) in self.names().iter().enumerate() {
            let mistakes = |set: &&SetReport| set.methods[m].mistakes;
            let wrong = sets.iter().filter_map(|set| {
                let words = in_words(&mistakes(&set))?;
                Some(format!("{words} in {} rays", set.name))
            });
            let wrong: Vec<_> = wrong.collect();
            let mut words = if wrong.is_empty() {
                "nothing wrong".to_owned()
            } else {
                format!("WRONG, by exact arithmetic: {}", wrong.join("; "))
            };
            let unresolved: u64 = sets.iter().map(|s| mistakes(&s).unresolved).sum();
            if unresolved > 0 {
                words += &format!("; {unresolved} unresolved (ties)");
            }
            let _ = writeln!(out, "{name:<14}{words}");
        }
    }
}

/// The methods whose speed on the rays of the set cannot be told from the first one's.
pub(super) fn not_significant<'a>(set: &SetReport, names: &[&'a str]) -> Vec<&'a str> {
    let others = set.methods.iter().zip(names).skip(1);
    let is_alike = |speed: Option<Speed>| speed.is_some_and(|s| !s.ratio_to_first.excludes(1.0));
    others
        .filter(|(m, _)| is_alike(m.speed))
        .map(|(_, name)| *name)
        .collect()
}

/// Such as "1994 same, 3 ties, 2 other depths (median 1, at most 5 ulps; at most 1.2e-5 model units)".
fn pair_words(pair: &PairReport) -> String {
    let mut words = vec![format!("{} same", pair.count(Agreement::Same))];
    let mut add = |agreement, plural: &str| {
        let count = pair.count(agreement);
        if count > 0 {
            let name = if count > 1 { plural } else { agreement.name() };
            words.push(format!("{count} {name}"));
        }
    };
    add(Agreement::Tie, "ties");
    add(Agreement::HitAgainstMiss, "hits against misses");
    add(Agreement::OtherDepth, "other depths");
    let mut words = words.join(", ");
    if let (Some(ulps), Some(lengths)) = (pair.ulps, pair.lengths) {
        words += &format!(
            " (median {}, at most {} ulps; at most {:.1e} model units)",
            ulps.median, ulps.largest, lengths.largest
        );
    }
    if let Some(turns) = pair.turns.filter(|t| t.largest >= LEAST_TURN) {
        let degrees = turns.largest;
        words += &format!("\n  normals of other triangles up to {degrees:.1} degrees apart");
    }
    words
}

/// Such as "2 holes, 1 ghost (2 by the triangle test, 1 by the traversal; edge 2, cull 1)"; `None` without mistakes.
fn in_words(mistakes: &Mistakes) -> Option<String> {
    let faults = mistakes.faults;
    let words: Vec<_> = Fault::ALL
        .into_iter()
        .filter(|&f| faults.count(f) > 0)
        .map(|f| format!("{} {}", faults.count(f), f.name(faults.count(f) > 1)))
        .collect();
    let (test, traversal) = (mistakes.by_test, mistakes.by_traversal);
    let blamed = format!("{test} by the triangle test, {traversal} by the traversal");
    let troubles = Trouble::ALL.into_iter().zip(mistakes.troubles);
    let troubles = troubles.filter(|(_, count)| *count > 0);
    let causes: Vec<_> = troubles.map(|(t, n)| format!("{} {n}", t.name())).collect();
    let causes = if causes.is_empty() {
        String::new()
    } else {
        format!("; {}", causes.join(", "))
    };
    (!words.is_empty()).then(|| format!("{} ({blamed}{causes})", words.join(", ")))
}

/// Four significant digits, but at most four behind the point.
fn digits(x: f64) -> String {
    let decimals = match x.abs() {
        x if x >= 1000.0 => 0,
        x if x >= 100.0 => 1,
        x if x >= 10.0 => 2,
        x if x >= 1.0 => 3,
        _ => 4,
    };
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let all = [0.00213, 0.51234, 1.0, 23.456, 123.44, 98_765.4].map(digits);
        assert_eq!(
            all,
            ["0.0021", "0.5123", "1.000", "23.46", "123.4", "98765"]
        );
    }

    #[test]
    fn mistakes_are_told_with_whose_they_are() {
        let mut mistakes = Mistakes::default();
        assert_eq!(in_words(&mistakes), None);
        mistakes.faults.add(Fault::Hole);
        mistakes.faults.add(Fault::Hole);
        mistakes.faults.add(Fault::Ghost);
        (mistakes.by_test, mistakes.by_traversal) = (1, 2);
        mistakes.troubles[Trouble::Vertex as usize] = 3;
        let words = "2 holes, 1 ghost (1 by the triangle test, 2 by the traversal; vertex 3)";
        assert_eq!(in_words(&mistakes).as_deref(), Some(words));
    }
}
