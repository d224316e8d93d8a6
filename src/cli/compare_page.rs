//! What a comparison found, as a page with charts and all numbers.

use bspray::accel::AcceleratorKind;
use bspray::analysis::report::{
    Axis, Cell, Chart, DotChart, HeatChart, Plot, Provenance, Report, Scale, Section, Table, Tone,
};
use bspray::analysis::{Fault, SetReport, Spread, compiled_instructions};

use super::compare_report::{CompareReport, per_ray};
use super::metadata::command_line;

/// Rays a second are shown in millions.
const MILLION: f64 = 1e6;

/// The page: verdict, speeds, steps, builds, and who is right.
pub(super) fn page(report: &CompareReport) -> Report {
    let models: Vec<_> = report
        .models
        .iter()
        .map(|m| m.file_name().unwrap_or(m.as_os_str()).to_string_lossy())
        .collect();
    let title = format!("Structures for {}", models.join(", "));
    let mut page = Report::new(&title, provenance(report));
    let (tone, words) = verdict(report);
    page.push(Section::Verdict(tone, words));
    page.push(Section::Paragraph(super::render::describe(report.scene)));
    page.push(Section::Heading("Speed".to_owned()));
    page.push(Section::Paragraph(
        "Rays a second of processor time on one thread, with the quartiles of all repetitions. In each repetition every \
        structure is asked in turn, and ratios are taken within it."
            .to_owned(),
    ));
    page.push(Section::Chart(speeds(report)));
    page.push(Section::Table(rays(report)));
    page.push(Section::Heading("Steps".to_owned()));
    page.push(Section::Chart(triangle_tests(report)));
    page.push(Section::Heading("Builds".to_owned()));
    page.push(Section::Table(builds(report)));
    page.push(Section::Heading("Who is right".to_owned()));
    page.push(Section::Paragraph(
        "Every ray that the structures answer differently is judged by exact arithmetic, and so is a sample of the others."
            .to_owned(),
    ));
    page.push(Section::Table(answers(report)));
    page.push(Section::Table(faults(report)));
    page
}

fn provenance(report: &CompareReport) -> Provenance {
    let options = report.options;
    let models: Vec<_> = report.models.iter().map(|m| m.to_string_lossy()).collect();
    let mut provenance = Provenance::of_run(&command_line())
        .with("models", &models.join(", "))
        .with("camera", report.camera_flags)
        .with(
            "resolution (pixels)",
            &format!("{}x{}", options.size.0, options.size.1),
        )
        .with("seed", &options.seed.to_string())
        .with("repetitions", &options.repetitions.to_string())
        .with("threads that build", &report.threads.to_string())
        .with("threads that trace", "1");
    for &kind in &options.kinds {
        let instructions = match kind {
            AcceleratorKind::Bsp => options.build.instructions.name_in_use().to_owned(),
            _ => format!("as compiled: {}", compiled_instructions()),
        };
        provenance = provenance.with(&format!("instructions of {}", kind.name()), &instructions);
    }
    provenance
}

/// Sets that have rays.
fn sets<'a>(report: &'a CompareReport) -> impl Iterator<Item = &'a SetReport> {
    report.comparison.sets.iter().filter(|set| set.rays > 0)
}

fn names(report: &CompareReport) -> Vec<&'static str> {
    let methods = report.comparison.methods.iter();
    methods.map(|m| m.kind.name()).collect()
}

/// Whether the first is right, and how fast it is beside the best of the others.
fn verdict(report: &CompareReport) -> (Tone, String) {
    let names = names(report);
    let first = names[0];
    let judged: usize = sets(report).map(|s| s.disagreements + s.sampled).sum();
    let wrong: Vec<String> = (0..names.len())
        .filter_map(|m| {
            let wrong: u64 = sets(report).map(|s| s.methods[m].faults.total()).sum();
            (wrong > 0).then(|| format!("{} is wrong about {wrong}", names[m]))
        })
        .collect();
    let mut words = if wrong.is_empty() {
        format!("All structures are right about all {judged} rays that were judged.")
    } else {
        format!("Of {judged} rays that were judged, {}.", wrong.join(", "))
    };
    let ratios: Vec<String> = sets(report)
        .filter_map(|set| {
            let others = set.methods.iter().zip(&names).skip(1);
            let ratio =
                |m: &bspray::analysis::MethodOnSet| m.speed.map(|s| s.ratio_to_first.median);
            let best = others
                .filter_map(|(m, name)| Some((ratio(m)?, name)))
                .max_by(|a, b| a.0.total_cmp(&b.0))?;
            let purpose = set.purpose.name();
            Some(format!(
                "{:.2} on {purpose} rays (over {})",
                1.0 / best.0,
                best.1
            ))
        })
        .collect();
    if !ratios.is_empty() {
        words += &format!(
            " The speed of {first} over that of the fastest other: {}.",
            ratios.join(", ")
        );
    }
    let tone = match (report.comparison.is_first_right(), wrong.is_empty()) {
        (true, true) => Tone::Good,
        (true, false) => Tone::Mixed,
        (false, _) => Tone::Bad,
    };
    (tone, words)
}

fn speeds(report: &CompareReport) -> Chart {
    let of_method = |m: usize| {
        let speed = |set: &SetReport| {
            let speed = set.methods[m].speed?.rays_per_second;
            Some([speed.lower, speed.median, speed.upper].map(|v| v / MILLION))
        };
        sets(report).map(speed).collect::<Vec<_>>()
    };
    let series = names(report).into_iter().enumerate();
    Chart {
        name: "speed".to_owned(),
        title: "Speed by kind of rays: median and quartiles".to_owned(),
        plot: Plot::Dots(DotChart {
            axis: Axis::new("million rays a second", Scale::Linear),
            rows: sets(report)
                .map(|set| format!("{} rays", set.purpose.name()))
                .collect(),
            series: series
                .map(|(m, name)| (name.to_owned(), of_method(m)))
                .collect(),
        }),
    }
}

fn triangle_tests(report: &CompareReport) -> Chart {
    let row = |m: usize| {
        let tests = |set: &SetReport| Some(per_ray(set, &set.methods[m])[2]);
        sets(report).map(tests).collect()
    };
    let names = names(report);
    Chart {
        name: "triangle-tests".to_owned(),
        title: "Tests of triangles that a ray takes, on average".to_owned(),
        plot: Plot::Heat(HeatChart {
            label: "triangle tests a ray".to_owned(),
            columns: sets(report).map(|s| s.purpose.name().to_owned()).collect(),
            values: (0..names.len()).map(row).collect(),
            rows: names.into_iter().map(str::to_owned).collect(),
        }),
    }
}

fn rays(report: &CompareReport) -> Table {
    let mut table = Table::new(
        "rays",
        "Speed and steps of each structure on each kind of rays",
        &[
            "rays",
            "structure",
            "rays/s, median",
            "rays/s, first quartile",
            "rays/s, third quartile",
            "ratio to the first, median",
            "ratio, first quartile",
            "ratio, third quartile",
            "nodes/ray",
            "leaves/ray",
            "triangles/ray",
        ],
    );
    for set in sets(report) {
        for (method, name) in set.methods.iter().zip(names(report)) {
            let spread = |s: Option<Spread>| {
                let parts = s.map(|s| [s.median, s.lower, s.upper]);
                [0, 1, 2].map(|k| Cell::from(parts.map(|p| p[k])))
            };
            let mut row = vec![set.purpose.name().into(), name.into()];
            row.extend(spread(method.speed.map(|s| s.rays_per_second)));
            row.extend(spread(method.speed.map(|s| s.ratio_to_first)));
            row.extend(per_ray(set, method).map(Cell::from));
            table.push(row);
        }
    }
    table
}

fn builds(report: &CompareReport) -> Table {
    let columns = [
        "structure",
        "build (s)",
        "bytes",
        "bytes/triangle",
        "nodes",
        "depth",
    ];
    let mut table = Table::new("builds", "The structures as they were built", &columns);
    for method in &report.comparison.methods {
        let size = method.size;
        table.push(vec![
            method.kind.name().into(),
            method.build_seconds.into(),
            size.bytes.into(),
            (size.bytes as f64 / size.triangles.max(1) as f64).into(),
            size.nodes.into(),
            (size.depth as u64).into(),
        ]);
    }
    table
}

fn answers(report: &CompareReport) -> Table {
    let columns = [
        "rays",
        "query",
        "number",
        "hits",
        "answered differently",
        "others judged",
        "decided among named triangles",
    ];
    let mut table = Table::new("answers", "What was judged", &columns);
    for set in &report.comparison.sets {
        table.push(vec![
            set.purpose.name().into(),
            set.purpose.query().name().into(),
            set.rays.into(),
            set.hits.into(),
            set.disagreements.into(),
            set.sampled.into(),
            set.decided_among_named.into(),
        ]);
    }
    table
}

fn faults(report: &CompareReport) -> Table {
    let columns = [
        "rays",
        "structure",
        "holes",
        "ghosts",
        "wrong depths",
        "wrong names",
    ];
    let mut table = Table::new("wrong-answers", "Wrong answers", &columns);
    for set in sets(report) {
        for (method, name) in set.methods.iter().zip(names(report)) {
            let faults = &method.faults;
            let count = |f: Fault| Cell::from(faults.count(f));
            table.push(vec![
                set.purpose.name().into(),
                name.into(),
                count(Fault::Hole),
                count(Fault::Ghost),
                count(Fault::WrongDepth),
                count(Fault::WrongName),
            ]);
        }
    }
    table
}
