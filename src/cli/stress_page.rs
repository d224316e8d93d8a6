//! What `stress` found, as a page with a chart for each sweep and all numbers.

use bspray::analysis::report::{
    Axis, Cell, Chart, HeatChart, LineChart, PicturePair, Plot, Point, Provenance, Report, Scale,
    Section, Series, Table, Tone,
};
use bspray::analysis::stability::{
    Blame, Ending, Kind, MethodResult, StressResults, SweepResult, Trouble, parameter_text,
};

use super::metadata::command_line;
use super::stress_report::{ended, mostly};

/// Pixels for each float of the sign map.
const SIGN_SCALE: u32 = 6;

/// The page: verdict, all sweeps at a glance, each sweep, leaks, defects, signs.
pub(super) fn page(results: &StressResults) -> Report {
    let mut provenance = Provenance::of_run(&command_line())
        .with("seed", &results.seed.to_string())
        .with("rays a step, at most", &results.rays.to_string());
    if let Some(version) = &results.embree {
        provenance = provenance.with("Embree", version);
    }
    let mut page = Report::new("Where methods fail", provenance);
    let (tone, words) = verdict(results);
    page.push(Section::Verdict(tone, words));
    page.push(Section::Paragraph(
        "Each sweep takes one parameter from mild to hard. Every answer is judged by exact arithmetic; what brute force with the same triangle test gets wrong \
        too is the test's error, all else the tree's. Rates have Wilson's 95 % intervals."
            .to_owned(),
    ));
    page.push(Section::Chart(overview(results)));
    page.push(Section::Table(first_failures(results)));
    for sweep in &results.sweeps {
        push_sweep(sweep, &results.default_method, &mut page);
    }
    if !results.leaks.is_empty() {
        page.push(Section::Heading("Leaks".to_owned()));
        page.push(Section::Paragraph(
            "Rays from inside a closed ball, half of them aimed at edges and corners: all must hit."
                .to_owned(),
        ));
        page.push(Section::Table(leaks(results)));
    }
    page.push(Section::Heading("Known defects of obvhs 0.4.0".to_owned()));
    page.push(Section::Table(defects(results)));
    page.push(Section::Heading("Signs".to_owned()));
    let map = &results.sign_map;
    page.push(Section::Paragraph(format!(
        "On which side of a line {0} x {0} neighbouring floats lie: {1} of the signs are wrong in f32.",
        map.size, map.differing
    )));
    let [naive, exact] = map.pictures(SIGN_SCALE);
    page.push(Section::Pair(PicturePair {
        name: "signs".to_owned(),
        title: "Left of the line, on it, right of it".to_owned(),
        left: ("f32".to_owned(), naive),
        right: ("exact".to_owned(), exact),
    }));
    page
}

fn verdict(results: &StressResults) -> (Tone, String) {
    let default = &results.default_method;
    let failing: Vec<_> = methods(results)
        .filter(|m| {
            let of =
                |sweep: &SweepResult| result(sweep, m).is_some_and(|r| r.first_failure.is_some());
            m != default && results.sweeps.iter().any(of)
        })
        .collect();
    let others = if failing.is_empty() {
        "No other method failed.".to_owned()
    } else {
        format!("Somewhere fail: {}.", failing.join(", "))
    };
    let leaks = results.leaks.iter().find(|l| l.method == *default);
    let leaks = leaks.map_or_else(String::new, |l| {
        format!(" {} of {} rays leaked from a closed mesh.", l.leaks, l.rays)
    });
    match results.default_failures() {
        0 => {
            let words =
                format!("{default} gave no wrong answer inside its domain.{leaks} {others}");
            (Tone::Good, words)
        }
        n => (
            Tone::Bad,
            format!("{default} failed {n} times inside its domain.{leaks} {others}"),
        ),
    }
}

/// Names of the methods, in the order of the registry.
fn methods(results: &StressResults) -> impl Iterator<Item = String> {
    let first = results.sweeps.first();
    first
        .into_iter()
        .flat_map(|sweep| sweep.methods.iter().map(|m| m.method.clone()))
}

fn result<'a>(sweep: &'a SweepResult, method: &str) -> Option<&'a MethodResult> {
    sweep.methods.iter().find(|m| m.method == method)
}

/// The worst rate of a method in a sweep, in percent; none where it was not asked.
fn worst(method: &MethodResult) -> Option<f64> {
    let asked = method.cells.iter().filter(|c| c.rays > 0);
    asked.map(|c| 100.0 * c.rate.rate).reduce(f64::max)
}

/// The default method beside those that fail somewhere.
fn overview(results: &StressResults) -> Chart {
    let fails = |name: &String| {
        let rates = results
            .sweeps
            .iter()
            .filter_map(|sweep| result(sweep, name).and_then(worst));
        *name == results.default_method || rates.fold(0.0, f64::max) > 0.0
    };
    let names: Vec<_> = methods(results).filter(fails).collect();
    let of_sweep = |sweep: &SweepResult| {
        let of_method = |name: &String| result(sweep, name).and_then(worst);
        names.iter().map(of_method).collect()
    };
    Chart {
        name: "overview".to_owned(),
        title: "Worst rate of wrong answers in each sweep".to_owned(),
        plot: Plot::Heat(HeatChart {
            label: "wrong (%)".to_owned(),
            values: results.sweeps.iter().map(of_sweep).collect(),
            rows: results.sweeps.iter().map(|s| s.name.clone()).collect(),
            columns: names,
        }),
    }
}

/// At which parameter each method first fails in each sweep.
fn first_failures(results: &StressResults) -> Table {
    let names: Vec<_> = methods(results).collect();
    let columns = ["sweep", "parameter"];
    let columns: Vec<_> = columns
        .into_iter()
        .chain(names.iter().map(String::as_str))
        .collect();
    let mut table = Table::new("first-failures", "Where each method first fails", &columns);
    for sweep in &results.sweeps {
        let first = |name: &String| {
            let method = result(sweep, name);
            method.map_or_else(String::new, |m| m.fails_at(&sweep.steps))
        };
        let mut row = vec![
            Cell::from(sweep.name.as_str()),
            parameter(sweep).as_str().into(),
        ];
        row.extend(names.iter().map(|name| Cell::from(first(name).as_str())));
        table.push(row);
    }
    table
}

fn is_asked(method: &MethodResult) -> bool {
    method.cells.iter().any(|c| c.ending != Ending::NotTried)
}

/// What a sweep changes, with its unit.
fn parameter(sweep: &SweepResult) -> String {
    if sweep.unit.is_empty() {
        sweep.parameter.clone()
    } else {
        format!("{} ({})", sweep.parameter, sweep.unit)
    }
}

fn push_sweep(sweep: &SweepResult, default: &str, page: &mut Report) {
    page.push(Section::Heading(sweep.name.clone()));
    page.push(Section::Paragraph(sweep.description.clone()));
    let outside = sweep
        .steps
        .iter()
        .find_map(|s| Some((s.value, s.outside.as_ref()?)));
    if let Some((value, reason)) = outside {
        page.push(Section::Paragraph(format!(
            "Outside of the domain from {} on: {reason}.",
            parameter_text(value)
        )));
    }
    page.push(Section::Chart(rates(sweep, default)));
    page.push(Section::Table(outcomes(sweep)));
}

/// The rates of the default method and of those that fail, over the parameter.
fn rates(sweep: &SweepResult, default: &str) -> Chart {
    let values = || sweep.steps.iter().map(|s| s.value);
    let (least, most) = values().fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    // Evenly spaced steps are few; all others go by factors.
    let scale = if least > 0.0 && most > 20.0 * least {
        Scale::Log
    } else {
        Scale::Linear
    };
    let shown = sweep
        .methods
        .iter()
        .filter(|m| m.method == default || worst(m).is_some_and(|rate| rate > 0.0));
    let series = |method: &MethodResult| {
        let cells = method
            .cells
            .iter()
            .zip(&sweep.steps)
            .filter(|(c, _)| c.rays > 0);
        let point = |(cell, step): (
            &bspray::analysis::stability::Cell,
            &bspray::analysis::stability::Step,
        )| Point {
            x: step.value,
            y: 100.0 * cell.rate.rate,
            across: None,
            interval: Some([cell.rate.low, cell.rate.high].map(|r| 100.0 * r)),
            label: String::new(),
        };
        Series {
            name: method.method.clone(),
            points: cells.map(point).collect(),
            is_line: true,
        }
    };
    Chart {
        name: format!("rates-{}", sweep.name),
        title: format!("{}: wrong answers", sweep.name),
        plot: Plot::Lines(LineChart {
            x: Axis::new(&parameter(sweep), scale),
            y: Axis::new("wrong (%)", Scale::Linear),
            series: shown.map(series).collect(),
            has_front: false,
        }),
    }
}

/// A row for each method that was asked.
fn outcomes(sweep: &SweepResult) -> Table {
    let columns = [
        "method",
        "first fails at",
        "how",
        "likely cause",
        "its test from",
        "its tree from",
        "worst rate (%)",
        "wrong",
        "unresolved",
        "rays",
    ];
    let title = format!("{}: outcomes", sweep.name);
    let mut table = Table::new(&format!("outcomes-{}", sweep.name), &title, &columns);
    let at = |step: usize| parameter_text(sweep.steps[step].value);
    for method in sweep.methods.iter().filter(|m| is_asked(m)) {
        let first = method.first_failure.as_ref().map(|f| f.step);
        let cell = first.map(|step| &method.cells[step]);
        let how = cell.map(|c| match c.ending {
            Ending::Answered => mostly(&c.faults, Kind::ALL.map(Kind::name)).to_owned(),
            _ => ended(&c.ending),
        });
        let cause = cell.map(|c| mostly(&c.troubles, Trouble::ALL.map(Trouble::name)));
        let blamed = |blame| method.first_blamed(blame).map(at);
        let sum = |count: fn(&bspray::analysis::stability::Cell) -> u64| -> u64 {
            method.cells.iter().map(count).sum()
        };
        let text =
            |text: Option<String>| Cell::from(text.unwrap_or_else(|| "never".to_owned()).as_str());
        table.push(vec![
            method.method.as_str().into(),
            method.fails_at(&sweep.steps).as_str().into(),
            how.as_deref().unwrap_or_default().into(),
            cause.unwrap_or_default().into(),
            text(blamed(Blame::Test)),
            text(blamed(Blame::Traversal)),
            worst(method).into(),
            sum(|c| c.wrong()).into(),
            sum(|c| c.unresolved).into(),
            sum(|c| c.rays).into(),
        ]);
    }
    table
}

fn leaks(results: &StressResults) -> Table {
    let columns = ["method", "rays", "leaks", "share (%)", "from (%)", "to (%)"];
    let mut table = Table::new("leaks", "Leaks from a closed mesh", &columns);
    for leak in &results.leaks {
        let [rate, low, high] = [leak.rate.rate, leak.rate.low, leak.rate.high].map(|r| 100.0 * r);
        table.push(vec![
            leak.method.as_str().into(),
            leak.rays.into(),
            leak.leaks.into(),
            rate.into(),
            low.into(),
            high.into(),
        ]);
    }
    table
}

fn defects(results: &StressResults) -> Table {
    let mut table = Table::new(
        "defects",
        "What was looked for, and found",
        &["defect", "evidence"],
    );
    for defect in &results.defects {
        table.push(vec![defect.name.as_str().into(), defect.words().into()]);
    }
    table
}
