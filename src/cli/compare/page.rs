//! What a comparison found, as a page: the verdict first, then charts, tables and pictures.

use bspray::accel::AcceleratorKind;
use bspray::analysis::report::{
    Layers, PicturePair, Provenance, Report, Section, ShownPicture, Tone,
};
use bspray::analysis::{
    Agreement, Contestant, CostPictures, Estimate, NamedRays, SetReport, Source,
    compiled_instructions,
};

use super::page_tables as tables;
use super::report::CompareReport;
use super::table::not_significant;
use crate::cli::metadata::command_line;

/// What is to be known of Embree's part.
const EMBREE: &str = "Embree is asked for one ray at a time, as all structures are here (rtcIntersect1, rtcOccluded1), and gets every triangle in world space: it has no instances where our structures have a mesh once that is placed several times. It works in single precision and is held to \
    that: it owes the nearest triangle at a depth that is right to half of the digits, and not the exact one. Its steps are not told; its memory is what it reports, the triangles' buffers among it.";

/// The page; `wrong` are the files of wrong rays beside it.
pub(super) fn page(report: &CompareReport, wrong: &[NamedRays]) -> Report {
    let models: Vec<_> = report
        .models
        .iter()
        .map(|m| m.file_name().unwrap_or(m.as_os_str()).to_string_lossy())
        .collect();
    let title = format!("Structures for {}", models.join(", "));
    let mut page = Report::new(&title, provenance(report));
    let (tone, words) = verdict(report);
    page.push(Section::Verdict(tone, words));
    let paragraph = |page: &mut Report, words: String| page.push(Section::Paragraph(words));
    let heading = |page: &mut Report, words: &str| page.push(Section::Heading(words.to_owned()));
    for words in summary(report) {
        paragraph(&mut page, words);
    }
    heading(&mut page, "Speed");
    paragraph(
        &mut page,
        "Eye rays go through the centres of pixels. From what they meet go shadow rays to lights, mirror and refraction rays, ambient rays (a tenth of the scene's diagonal long, into the hemisphere) \
        and bounces (the same without an end). Shadow and ambient rays ask whether anything is hit, all others for the nearest hit."
            .to_owned(),
    );
    paragraph(
        &mut page,
        "Rays a second of processor time on one thread. In each repetition every structure is asked in turn; a ratio is taken within a repetition. Medians \
        have the 95 % intervals of the bootstrap, and a ratio whose interval has 1 in it is called not significant. Steps are counted apart from the timing."
            .to_owned(),
    );
    page.push(Section::Chart(tables::speeds(report)));
    page.push(Section::Table(tables::rays(report)));
    heading(&mut page, "Steps");
    let is_counted = |c: &Contestant| c.counts_steps();
    if report.options.contestants.iter().any(is_counted) {
        page.push(Section::Chart(tables::triangle_tests(report)));
    }
    if let Some(costs) = &report.comparison.costs {
        pictures(costs, report.names()[0], &mut page);
    }
    heading(&mut page, "Builds");
    paragraph(
        &mut page,
        "Seconds by the clock on the wall with all threads, the least of three for builds below a second. The peak is the most that was on the heap at once during the build, \
        beyond what was there before; bytes are what queries read."
            .to_owned(),
    );
    page.push(Section::Table(tables::builds(report)));
    heading(&mut page, "How each two agree");
    paragraph(&mut page, agreement(report));
    if report.names().len() > 1 {
        page.push(Section::Table(tables::pairs(report)));
    }
    heading(&mut page, "Who is right");
    paragraph(
        &mut page,
        "Every ray whose answers cannot all be right is judged by exact arithmetic against every triangle, and so is a sample of the others. A hole misses a hit, a ghost hits nothing, a wrong depth is not the \
        nearest hit, a wrong name is another triangle there. An error is the triangle test's if brute force with the same test makes it too, and the traversal's otherwise. Unresolved are answers in single precision that name another \
        triangle at the true depth, as far as such numbers tell: no errors."
            .to_owned(),
    );
    page.push(Section::Table(tables::answers(report)));
    page.push(Section::Table(tables::faults(report)));
    if !wrong.is_empty() {
        page.push(Section::Table(tables::wrong_rays(wrong)));
    }
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
    for contestant in &options.contestants {
        let instructions = match contestant.source {
            Source::Structure(AcceleratorKind::Bsp) => {
                options.build.instructions.name_in_use().to_owned()
            }
            Source::Structure(_) => format!("as compiled: {}", compiled_instructions()),
            Source::Embree(ref embree, _) => {
                format!("chosen by the library, Embree {}", embree.version())
            }
        };
        provenance = provenance.with(&format!("instructions of {contestant}"), &instructions);
    }
    provenance
}

/// Who is right, and how fast the first is beside the best of the others.
fn verdict(report: &CompareReport) -> (Tone, String) {
    let names = report.names();
    let judged: usize = report.sets().map(|s| s.disputed + s.sampled).sum();
    let wrong: Vec<String> = (0..names.len())
        .filter_map(|m| {
            let of_set = |s: &SetReport| s.methods[m].mistakes.faults.total();
            let wrong: u64 = report.sets().map(of_set).sum();
            (wrong > 0).then(|| format!("{} is wrong about {wrong}", names[m]))
        })
        .collect();
    let mut words = if wrong.is_empty() {
        format!("All structures are right about all {judged} rays that were judged.")
    } else {
        format!("Of {judged} rays that were judged, {}.", wrong.join(", "))
    };
    let sets: Vec<_> = report
        .sets()
        .filter_map(|s| against_best(s, &names))
        .collect();
    let count = |is: fn(&Beside) -> bool| sets.iter().filter(|s| is(s)).count();
    let (faster, slower) = (
        count(|s| s.factor.excludes(1.0) && s.factor.median > 1.0),
        count(|s| s.factor.excludes(1.0) && s.factor.median < 1.0),
    );
    if !sets.is_empty() {
        let (first, all) = (names[0], sets.len());
        words += &match (faster, slower) {
            (f, 0) if f == all => format!(" {first} is the fastest for all {all} kinds of rays."),
            (0, s) if s == all => {
                format!(" Another is faster than {first} for all {all} kinds of rays.")
            }
            (f, s) => format!(
                " {first} is the fastest for {f} of {all} kinds of rays, slower than another for {s}, and not to be told from the fastest other for {}.",
                all - f - s
            ),
        };
    }
    let tone = match (report.comparison.is_first_right(), wrong.is_empty()) {
        (true, true) => Tone::Good,
        (true, false) => Tone::Mixed,
        (false, _) => Tone::Bad,
    };
    (tone, words)
}

/// The first method beside the fastest other.
struct Beside<'a> {
    other: &'a str,
    /// How many times as fast the first is.
    factor: Estimate,
}

fn against_best<'a>(set: &SetReport, names: &[&'a str]) -> Option<Beside<'a>> {
    let others = set.methods.iter().zip(names).skip(1);
    let ratios = others.filter_map(|(m, name)| Some((m.speed?.ratio_to_first, *name)));
    let (ratio, other) = ratios.max_by(|a, b| a.0.median.total_cmp(&b.0.median))?;
    Some(Beside {
        other,
        factor: Estimate {
            low: 1.0 / ratio.high,
            median: 1.0 / ratio.median,
            high: 1.0 / ratio.low,
            values: ratio.values,
        },
    })
}

/// What a reader should know, in a few paragraphs.
fn summary(report: &CompareReport) -> Vec<String> {
    let names = report.names();
    let mut words = vec![format!(
        "The scene has {}. {}",
        crate::cli::render::describe(report.scene),
        report.left_out.join(". ")
    )];
    let is_embree = |c: &&Contestant| matches!(c.source, Source::Embree(..));
    if report.options.contestants.iter().any(|c| is_embree(&c)) {
        words.push(EMBREE.to_owned());
    }
    let speeds: Vec<String> = report
        .sets()
        .filter_map(|set| {
            let Beside { other, factor } = against_best(set, &names)?;
            let name = &set.name;
            Some(if factor.excludes(1.0) {
                let [low, median, high] = [factor.low, factor.median, factor.high];
                format!(
                    "{median:.2} times as fast as {other} on {name} rays ({low:.2} to {high:.2})"
                )
            } else {
                format!("on {name} rays not significantly different from {other}")
            })
        })
        .collect();
    if !speeds.is_empty() {
        words.push(format!(
            "Beside the fastest of the others {} is {}.",
            names[0],
            speeds.join("; ")
        ));
    }
    let alike: Vec<String> = report
        .sets()
        .filter_map(|set| {
            let alike = not_significant(set, &names);
            (!alike.is_empty()).then(|| format!("{} on {} rays", alike.join(", "), set.name))
        })
        .collect();
    if !alike.is_empty() {
        words.push(format!(
            "Not significant is the difference in speed between {} and {}.",
            names[0],
            alike.join("; ")
        ));
    }
    words
}

/// In words, whether all answers are the same.
fn agreement(report: &CompareReport) -> String {
    let all: usize = report.sets().map(|s| s.rays).sum();
    let disputed: usize = report.sets().map(|s| s.disputed).sum();
    if report.alike().len() == 1 {
        return format!(
            "Every structure gives the same answer, bit for bit, to each of {all} rays."
        );
    }
    format!(
        "{disputed} of {all} rays are disputed: their answers cannot all be right. A tie is another triangle at the same depth, bit for bit. Depths lie apart by so many ulps, \
        steps from one number of single precision to the next, or by so much in the model's unit of length. Structures that agree about every ray are one row."
    )
}

/// Heat maps of the first method and of a BVH, or of the second where there is none; and where answers differ.
fn pictures(costs: &CostPictures, first: &str, page: &mut Report) {
    let names: Vec<&str> = costs.names().collect();
    let bvh = names
        .iter()
        .skip(1)
        .position(|n| *n == AcceleratorKind::Bvh2.name());
    let legend = "steps of the eye ray of each pixel (nodes, leaves and triangles): violet for 1, yellow for 1024, by the logarithm";
    let words = |m: usize| format!("{}: {:.1} steps a pixel", names[m], costs.mean(m));
    if names.len() > 1 {
        let other = 1 + bvh.unwrap_or(0);
        page.push(Section::Pair(PicturePair {
            name: "costs".to_owned(),
            title: format!("Left {}, right {}: {legend}.", names[0], names[other]),
            left: (words(0), costs.heat_map(0)),
            right: (words(other), costs.heat_map(other)),
        }));
    } else if names.len() == 1 {
        page.push(Section::Picture(ShownPicture {
            name: "costs".to_owned(),
            title: format!("{}; {legend}.", words(0)),
            raster: costs.heat_map(0),
        }));
    }
    let [ties, depths, misses] = [
        Agreement::Tie,
        Agreement::OtherDepth,
        Agreement::HitAgainstMiss,
    ]
    .map(|a| costs.count(a));
    if ties + depths + misses > 0 {
        page.push(Section::Picture(ShownPicture {
            name: "disagreement".to_owned(),
            title: format!(
                "Where a structure answers otherwise than {first}: {ties} ties (blue), {depths} other depths (orange), {misses} hits against misses (red). A depth in single precision \
                may be off by what its digits allow."
            ),
            raster: costs.agreement_map(),
        }));
    }
    page.push(Section::Layers(Layers {
        name: "cost-layers".to_owned(),
        title: "Steps of every structure, their differences, and the class of disagreement of each pixel:".to_owned(),
        picture: costs.picture(),
    }));
}
