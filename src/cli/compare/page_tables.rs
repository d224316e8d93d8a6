//! The tables and charts of a comparison's page.

use bspray::analysis::accuracy::Trouble;
use bspray::analysis::report::{Axis, Cell, Chart, DotChart, HeatChart, Plot, Scale, Table};
use bspray::analysis::{Agreement, Estimate, Fault, Mistakes, NamedRays, SetReport};

use super::report::{CompareReport, per_ray};

/// Rays a second are shown in millions.
const MILLION: f64 = 1e6;

/// Rays a second of each method, by kind of rays.
pub(super) fn speeds(report: &CompareReport) -> Chart {
    let of_method = |m: usize| {
        let speed = |set: &SetReport| {
            let speed = set.methods[m].speed?.rays_per_second;
            Some([speed.low, speed.median, speed.high].map(|v| v / MILLION))
        };
        report.sets().map(speed).collect::<Vec<_>>()
    };
    let series = report.names().into_iter().enumerate();
    Chart {
        name: "speed".to_owned(),
        title: "Speed by kind of rays: medians and their 95 % intervals".to_owned(),
        plot: Plot::Dots(DotChart {
            axis: Axis::new("million rays a second", Scale::Log),
            rows: report
                .sets()
                .map(|set| format!("{} rays", set.name))
                .collect(),
            series: series
                .map(|(m, name)| (name.to_owned(), of_method(m)))
                .collect(),
        }),
    }
}

/// Triangle tests a ray of each method, by kind of rays.
pub(super) fn triangle_tests(report: &CompareReport) -> Chart {
    let row = |m: &usize| {
        let tests = |set: &SetReport| per_ray(set, &set.methods[*m])[2];
        report.sets().map(tests).collect()
    };
    let (names, methods) = (report.names(), &report.comparison.methods);
    let counted = (0..names.len()).filter(|&m| methods[m].contestant.counts_steps());
    let counted: Vec<usize> = counted.collect();
    Chart {
        name: "triangle-tests".to_owned(),
        title: "Triangles that a ray is tested against, on average".to_owned(),
        plot: Plot::Heat(HeatChart {
            label: "triangle tests a ray".to_owned(),
            columns: report.sets().map(|s| s.name.clone()).collect(),
            values: counted.iter().map(row).collect(),
            rows: counted.iter().map(|&m| names[m].to_owned()).collect(),
        }),
    }
}

/// Speed and steps of each method on each kind of rays.
pub(super) fn rays(report: &CompareReport) -> Table {
    let mut table = Table::new(
        "rays",
        "Speed and steps of each structure on each kind of rays",
        &[
            "rays",
            "structure",
            "million rays/s, median",
            "million rays/s, low",
            "million rays/s, high",
            "ratio to the first, median",
            "ratio, low",
            "ratio, high",
            "difference to the first",
            "nodes/ray",
            "leaves/ray",
            "triangles/ray",
        ],
    );
    for set in report.sets() {
        for (m, (method, name)) in set.methods.iter().zip(report.names()).enumerate() {
            let parts = |e: Option<Estimate>| {
                let parts = e.map(|e| [e.median, e.low, e.high]);
                [0, 1, 2].map(|k| Cell::from(parts.map(|p| p[k])))
            };
            let ratio = method.speed.map(|s| s.ratio_to_first);
            let difference = ratio.map_or("", |ratio| match ratio.excludes(1.0) {
                _ if m == 0 => "",
                true if ratio.median > 1.0 => "faster",
                true => "slower",
                false => "not significant",
            });
            let mut row = vec![set.name.as_str().into(), name.into()];
            let speed = method.speed.map(|s| s.rays_per_second);
            let parts_of_speed = speed.map(|e| [e.median, e.low, e.high].map(|v| v / MILLION));
            row.extend([0, 1, 2].map(|k| Cell::from(parts_of_speed.map(|p| p[k]))));
            row.extend(parts(ratio));
            row.push(difference.into());
            row.extend(per_ray(set, method).map(Cell::from));
            table.push(row);
        }
    }
    table
}

/// What each method was to build.
pub(super) fn builds(report: &CompareReport) -> Table {
    let columns = [
        "structure",
        "build (s)",
        "peak (bytes)",
        "bytes",
        "bytes/triangle",
        "nodes",
        "depth",
    ];
    let mut table = Table::new("builds", "The structures as they were built", &columns);
    for method in &report.comparison.methods {
        let (size, told) = (method.size, method.contestant.counts_steps());
        table.push(vec![
            method.contestant.name.as_str().into(),
            method.cost.seconds.into(),
            method.cost.peak_bytes.into(),
            size.bytes.into(),
            (size.bytes as f64 / size.triangles.max(1) as f64).into(),
            told.then_some(size.nodes).into(),
            told.then_some(u64::from(size.depth)).into(),
        ]);
    }
    table
}

/// How each two methods agree on each kind of rays. Methods that agree about every ray are one row, and after it are what the first of them is.
pub(super) fn pairs(report: &CompareReport) -> Table {
    let columns = [
        "rays",
        "structure",
        "other structure",
        "same",
        "ties",
        "other depths",
        "hits against misses",
        "median (ulps)",
        "largest (ulps)",
        "median (model units)",
        "largest (model units)",
        "normals, median (degrees)",
        "normals, largest (degrees)",
    ];
    let mut table = Table::new("pairs", "How each two structures agree", &columns);
    let names = report.names();
    let all: usize = report.sets().map(|set| set.rays).sum();
    for group in report.alike().iter().filter(|group| group.len() > 1) {
        let others = report.group_words(&group[1..]);
        let mut row = vec!["all".into(), names[group[0]].into(), others.as_str().into()];
        row.extend([all, 0, 0, 0].map(Cell::from));
        row.extend([0; 6].map(|_| Cell::from(None::<f64>)));
        table.push(row);
    }
    for (set, pair) in report.unlike_pairs() {
        let [a, b] = pair.methods.map(|m| Cell::from(names[m]));
        let mut row = vec![set.name.as_str().into(), a, b];
        row.extend(Agreement::ALL.map(|agreement| pair.count(agreement).into()));
        for distances in [pair.ulps, pair.lengths, pair.turns] {
            row.push(distances.map(|d| d.median).into());
            row.push(distances.map(|d| d.largest).into());
        }
        table.push(row);
    }
    table
}

/// What was judged.
pub(super) fn answers(report: &CompareReport) -> Table {
    let columns = [
        "rays",
        "query",
        "number",
        "hits",
        "disputed",
        "others judged",
        "decided among named triangles",
    ];
    let mut table = Table::new("answers", "What was judged", &columns);
    for set in &report.comparison.sets {
        table.push(vec![
            set.name.as_str().into(),
            set.purpose.query().name().into(),
            set.rays.into(),
            set.hits.into(),
            set.disputed.into(),
            set.sampled.into(),
            set.decided_among_named.into(),
        ]);
    }
    table
}

/// Who was wrong about what, and whose error it is: each method about all rays, and about those of each kind of which it got any wrong, or right but for the name.
pub(super) fn faults(report: &CompareReport) -> Table {
    let columns = [
        "rays",
        "structure",
        "holes",
        "ghosts",
        "wrong depths",
        "wrong names",
        "by the triangle test",
        "by the traversal",
        "mostly explained by",
        "unresolved (ties)",
    ];
    let mut table = Table::new("wrong-answers", "Wrong answers", &columns);
    let mut add = |rays: &str, structure: &str, mistakes: &Mistakes| {
        let mut row = vec![rays.into(), structure.into()];
        row.extend(Fault::ALL.map(|f| Cell::from(mistakes.faults.count(f))));
        row.extend([mistakes.by_test, mistakes.by_traversal].map(Cell::from));
        let causes = Trouble::ALL.into_iter().zip(mistakes.troubles);
        let most = causes
            .filter(|(_, count)| *count > 0)
            .max_by_key(|(_, n)| *n);
        row.push(most.map_or("", |(trouble, _)| trouble.name()).into());
        row.push(mistakes.unresolved.into());
        table.push(row);
    };
    for (m, name) in report.names().into_iter().enumerate() {
        let all = report.sets().map(|set| set.methods[m].mistakes);
        add("all", name, &all.fold(Mistakes::default(), Mistakes::and));
    }
    for set in report.sets() {
        for (method, name) in set.methods.iter().zip(report.names()) {
            if method.mistakes != Mistakes::default() {
                add(&set.name, name, &method.mistakes);
            }
        }
    }
    table
}

/// The files of wrong rays.
pub(super) fn wrong_rays(wrong: &[NamedRays]) -> Table {
    let columns = ["file", "rays"];
    let title = "The first wrong rays of each structure, for --replay";
    let mut table = Table::new("wrong-rays", title, &columns);
    for rays in wrong {
        let file = format!("{}.ray", rays.name);
        table.push(vec![file.as_str().into(), rays.set.rays.len().into()]);
    }
    table
}
