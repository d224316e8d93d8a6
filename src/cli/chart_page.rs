//! Speed against accuracy, as a page with charts and as a table.

use std::fmt::Write;
use std::path::PathBuf;

use bspray::accel::AcceleratorKind;
use bspray::analysis::chart::{ChartOptions, ChartPoints, PicturePoint, RayPoint, Wrong};
use bspray::analysis::report::{
    Axis, Cell, Chart, LineChart, Plot, Point, Provenance, Report, Scale, Section, Series,
    ShownPicture, Table, Tone,
};
use bspray::picture::{Raster, ToneMap};
use bspray::scene::Scene;
use glam::Vec3;

use super::metadata::command_line;

/// Everything that is told of a chart.
pub(super) struct ChartPage<'a> {
    pub(super) models: &'a [PathBuf],
    pub(super) scene: &'a Scene,
    pub(super) camera_flags: &'a str,
    pub(super) max_depth: u32,
    pub(super) options: &'a ChartOptions,
    pub(super) threads: usize,
    pub(super) points: &'a ChartPoints,
}

/// A chart's name, its title, and what its values are.
type Words = [&'static str; 3];

/// A value, and where it lies.
type Measure<'a, P> = &'a dyn Fn(&P) -> (f64, Option<[f64; 2]>);

/// Nanoseconds a ray at so many rays a second.
fn nanoseconds(rays_per_second: f64) -> f64 {
    1e9 / rays_per_second
}

/// Where the time of a ray lies.
fn nanosecond_ends(p: &RayPoint) -> [f64; 2] {
    let speed = p.speed.rays_per_second;
    [speed.high, speed.low].map(nanoseconds)
}

impl ChartPage<'_> {
    /// The page.
    pub(super) fn report(&self) -> Report {
        let names: Vec<_> = self
            .models
            .iter()
            .map(|m| m.file_name().unwrap_or(m.as_os_str()).to_string_lossy())
            .collect();
        let title = format!("Speed against accuracy for {}", names.join(", "));
        let mut page = Report::new(&title, self.provenance());
        let (tone, words) = self.verdict();
        page.push(Section::Verdict(tone, words));
        page.push(Section::Paragraph(super::render::describe(self.scene)));
        if !self.points.rays.points.is_empty() {
            self.push_rays(&mut page);
        }
        if !self.points.pictures.points.is_empty() {
            self.push_pictures(&mut page);
        }
        page
    }

    fn provenance(&self) -> Provenance {
        let options = self.options;
        let models: Vec<_> = self.models.iter().map(|m| m.to_string_lossy()).collect();
        Provenance::of_run(&command_line())
            .with("models", &models.join(", "))
            .with("camera", self.camera_flags)
            .with(
                "resolution (pixels)",
                &format!("{}x{}", options.size.0, options.size.1),
            )
            .with("seed", &options.seed.to_string())
            .with("repetitions", &options.repetitions.to_string())
            .with("threads that build and render", &self.threads.to_string())
            .with("threads that trace timed rays", "1")
            .with(
                "instructions of bsp",
                options.build.instructions.name_in_use(),
            )
    }

    fn verdict(&self) -> (Tone, String) {
        let rays = &self.points.rays;
        let [asked, judged] = rays.judged;
        if !self.points.is_right() {
            let words = format!(
                "An exact method, or the reference, was wrong: of {judged} answers of the reference that were judged, {} were.",
                rays.reference_wrong
            );
            return (Tone::Bad, words);
        }
        let wrong = |p: &&RayPoint| p.view.rate.rate + p.edges.rate.rate > 0.0;
        let mut words = if rays.points.is_empty() {
            String::new()
        } else {
            let failing: Vec<_> = rays
                .points
                .iter()
                .filter(wrong)
                .map(|p| p.method.name())
                .collect();
            let others = if failing.is_empty() {
                "no other method was wrong here".to_owned()
            } else {
                format!("wrong answers gave {}", failing.join(", "))
            };
            format!(
                "No exact method was wrong about any of {asked} rays, of which {judged} were judged by every triangle; {others}."
            )
        };
        let fastest = |is_exact: bool| {
            let of = rays
                .points
                .iter()
                .filter(|p| p.method.is_exact() == is_exact);
            of.max_by(|a, b| {
                let speed = |p: &RayPoint| p.speed.rays_per_second.median;
                speed(a).total_cmp(&speed(b))
            })
        };
        if let Some(exact) = fastest(true) {
            let time = |p: &RayPoint| nanoseconds(p.speed.rays_per_second.median);
            let _ = write!(
                words,
                " The fastest exact method is {}, at {:.0} ns a ray",
                exact.method,
                time(exact)
            );
            match fastest(false) {
                Some(other) => {
                    let _ = write!(
                        words,
                        "; the fastest other is {}, at {:.0} ns.",
                        other.method,
                        time(other)
                    );
                }
                None => words.push('.'),
            }
        }
        (Tone::Good, words.trim().to_owned())
    }

    fn push_rays(&self, page: &mut Report) {
        let points = &self.points.rays.points;
        page.push(Section::Heading("Rays".to_owned()));
        page.push(Section::Paragraph(
            "Time of a ray, over eye rays and diffuse bounces of the view in equal parts, on one thread, against what is wrong. Rays at edges go from the eye to \
            points of the edges of the triangles that it sees: nowhere are tests wrong more often, and at silhouettes single precision can but guess. Exact methods owe every bit; others the first triangle, at a depth that \
            single precision can give. Error bars across are bootstrap intervals of the median, and bars upwards are confidence intervals of 95 % (Wilson). The line is the Pareto front: no method is \
            both faster and righter than those on it."
                .to_owned(),
        ));
        let rate = |w: &Wrong| (w.rate.rate, Some([w.rate.low, w.rate.high]));
        let wrong = "share of wrong answers";
        let depth = "relative error, root of mean square";
        let charts: [(Words, Measure<RayPoint>); 3] = [
            (
                ["wrong-at-edges", "Wrong answers to rays at edges", wrong],
                &|p| rate(&p.edges),
            ),
            (
                ["wrong-in-view", "Wrong answers to rays of the view", wrong],
                &|p| rate(&p.view),
            ),
            (
                ["depth-error", "Error of the depths of right hits", depth],
                &|p| (p.view.depth.rms, None),
            ),
        ];
        for ([name, title, label], value) in charts {
            let point = |p: &RayPoint| {
                let (y, interval) = value(p);
                Point {
                    x: nanoseconds(p.speed.rays_per_second.median),
                    y,
                    across: Some(nanosecond_ends(p)),
                    interval,
                    label: p.method.name(),
                }
            };
            let x = Axis::new("time of a ray (ns)", Scale::Log);
            let y = Axis::new(label, Scale::LogAndZero);
            let named = points.iter().map(|p| (p.method.kind, point(p)));
            page.push(Section::Chart(chart(name, title, (x, y), named, false)));
        }
        page.push(Section::Table(self.ray_table()));
    }

    fn push_pictures(&self, page: &mut Report) {
        let pictures = &self.points.pictures;
        page.push(Section::Heading("Pictures".to_owned()));
        page.push(Section::Paragraph(format!(
            "Time to a path-traced picture, build and render, on {} threads, against its difference from a reference of {} samples a pixel with other random \
            numbers. Exact structures make the same picture, bit for bit; they differ in time alone. Labels are samples a pixel.",
            self.threads, pictures.reference_samples
        )));
        let metrics: [(Words, Measure<PicturePoint>); 3] = [
            (
                ["picture-relmse", "Error of a picture: relMSE", "relMSE"],
                &|p| (p.rel_mse, None),
            ),
            (
                [
                    "picture-rmse",
                    "Error of a picture: RMSE in linear light",
                    "RMSE",
                ],
                &|p| (p.rmse, None),
            ),
            (
                [
                    "picture-flip",
                    "Difference to the eye: mean HDR-FLIP",
                    "FLIP",
                ],
                &|p| (p.flip, None),
            ),
        ];
        // Labels once: at the first method, whose points have the errors of all exact ones.
        let first = pictures.points.first().map(|p| p.method);
        for ([name, title, label], value) in metrics {
            let mut series: Vec<Series> = Vec::new();
            for p in &pictures.points {
                let label = if Some(p.method) == first {
                    p.samples.to_string()
                } else {
                    String::new()
                };
                let point = Point {
                    x: p.seconds.median,
                    y: value(p).0,
                    across: Some([p.seconds.low, p.seconds.high]),
                    interval: None,
                    label,
                };
                match series.last_mut().filter(|s| s.name == p.method.name()) {
                    Some(series) => series.points.push(point),
                    None => series.push(Series {
                        name: p.method.name(),
                        points: vec![point],
                        is_line: true,
                    }),
                }
            }
            page.push(Section::Chart(Chart {
                name: name.to_owned(),
                title: title.to_owned(),
                plot: Plot::Lines(LineChart {
                    x: Axis::new("time to the picture (s)", Scale::Log),
                    y: Axis::new(label, Scale::Log),
                    series,
                    has_front: true,
                }),
            }));
        }
        page.push(Section::Table(self.picture_table()));
        page.push(Section::Picture(self.reference()));
    }

    fn reference(&self) -> ShownPicture {
        let display = |color: &Vec3| {
            let [r, g, b] = ToneMap::default().apply(color.to_array());
            [r, g, b, 1.0]
        };
        let pixels: Vec<_> = self.points.pictures.reference.iter().map(display).collect();
        let (width, height) = self.options.size;
        ShownPicture {
            name: "reference".to_owned(),
            title: format!(
                "The reference, {} samples a pixel",
                self.points.pictures.reference_samples
            ),
            raster: Raster::from_rgba(width, height, &pixels),
        }
    }

    /// The command that measures a method again.
    fn ray_command(&self, p: &RayPoint) -> String {
        let options = self.options;
        format!(
            "bspray chart {} --method {} --samples 0 --resolution {}x{} --max-rays {} --repetitions {} --seed {}{}",
            self.model_words(),
            p.method,
            options.size.0,
            options.size.1,
            options.most_rays,
            options.repetitions,
            options.seed,
            self.camera_words(),
        )
    }

    /// The command that renders a picture again, as an EXR file.
    fn picture_command(&self, p: &PicturePoint) -> String {
        let options = self.options;
        format!(
            "bspray render {} {} --integrator path --max-depth {} --resolution {}x{} --spp {} --seed {}{} -o picture.exr",
            self.model_words(),
            p.method.arguments(),
            self.max_depth,
            options.size.0,
            options.size.1,
            p.samples,
            options.seed,
            self.camera_words(),
        )
    }

    fn model_words(&self) -> String {
        let words: Vec<_> = self
            .models
            .iter()
            .map(|m| super::metadata::quoted(&m.to_string_lossy()))
            .collect();
        words.join(" ")
    }

    fn camera_words(&self) -> String {
        if self.camera_flags.is_empty() {
            String::new()
        } else {
            format!(" {}", self.camera_flags)
        }
    }

    fn ray_table(&self) -> Table {
        let heads = [
            "method",
            "ns/ray, median",
            "ns/ray, low",
            "ns/ray, high",
            "build (s)",
            "bytes",
            "wrong at edges",
            "of rays at edges",
            "wrong in view",
            "of rays of the view",
            "holes",
            "ghosts",
            "misplaced",
            "depth error, RMS",
            "depth error, greatest",
            "command",
        ];
        let mut table = Table::new("rays", "Methods on rays", &heads);
        for p in &self.points.rays.points {
            let wrong = |w: &Wrong| w.holes + w.ghosts + w.misplaced;
            let both = |of: fn(&Wrong) -> u64| Cell::from(of(&p.edges) + of(&p.view));
            let [low, high] = nanosecond_ends(p);
            table.push(vec![
                p.method.name().as_str().into(),
                nanoseconds(p.speed.rays_per_second.median).into(),
                low.into(),
                high.into(),
                p.build.seconds.into(),
                p.bytes.into(),
                wrong(&p.edges).into(),
                p.edges.rays.into(),
                wrong(&p.view).into(),
                p.view.rays.into(),
                both(|w| w.holes),
                both(|w| w.ghosts),
                both(|w| w.misplaced),
                p.view.depth.rms.into(),
                p.view.depth.greatest.into(),
                self.ray_command(p).as_str().into(),
            ]);
        }
        table
    }

    fn picture_table(&self) -> Table {
        let heads = [
            "method",
            "samples",
            "s, median",
            "s, low",
            "s, high",
            "relMSE",
            "RMSE",
            "FLIP",
            "command",
        ];
        let mut table = Table::new("pictures", "Methods on pictures", &heads);
        for p in &self.points.pictures.points {
            let [low, high] = [p.seconds.low, p.seconds.high];
            table.push(vec![
                p.method.name().as_str().into(),
                u64::from(p.samples).into(),
                p.seconds.median.into(),
                low.into(),
                high.into(),
                p.rel_mse.into(),
                p.rmse.into(),
                p.flip.into(),
                self.picture_command(p).as_str().into(),
            ]);
        }
        table
    }

    /// For a terminal: a line a method, and a line a picture.
    pub(super) fn text(&self) -> String {
        let (_, verdict) = self.verdict();
        let mut out = format!(
            "{}\ncamera: {}\n",
            super::render::describe(self.scene),
            self.camera_flags
        );
        let rays = &self.points.rays.points;
        if !rays.is_empty() {
            let _ = writeln!(
                out,
                "\n{:<22}{:>18}{:>10}{:>14}{:>14}{:>14}",
                "rays", "ns/ray", "build s", "wrong/edges", "wrong/view", "depth error"
            );
        }
        for p in rays {
            let time = nanoseconds(p.speed.rays_per_second.median);
            let [low, high] = nanosecond_ends(p);
            let _ = writeln!(
                out,
                "{:<22}{:>18}{:>10.3}{:>14}{:>14}{:>14}",
                p.method.name(),
                format!("{time:.1} ± {:.1}", (high - low) / 2.0),
                p.build.seconds,
                share(p.edges.rate.rate),
                share(p.view.rate.rate),
                share(p.view.depth.rms),
            );
        }
        let pictures = &self.points.pictures.points;
        if !pictures.is_empty() {
            let _ = writeln!(
                out,
                "\n{:<22}{:>9}{:>18}{:>12}{:>12}{:>10}",
                "pictures", "samples", "s", "relMSE", "RMSE", "FLIP"
            );
        }
        for p in pictures {
            let [low, high] = [p.seconds.low, p.seconds.high];
            let _ = writeln!(
                out,
                "{:<22}{:>9}{:>18}{:>12.3e}{:>12.3e}{:>10.4}",
                p.method.name(),
                p.samples,
                format!("{:.3} ± {:.3}", p.seconds.median, (high - low) / 2.0),
                p.rel_mse,
                p.rmse,
                p.flip,
            );
        }
        let _ = write!(out, "\n{verdict}");
        out
    }
}

/// 0, or a number in few digits.
fn share(x: f64) -> String {
    if x > 0.0 {
        format!("{x:.2e}")
    } else {
        "0".to_owned()
    }
}

/// Points over two axes, a series for each structure.
fn chart(
    name: &str,
    title: &str,
    (x, y): (Axis, Axis),
    points: impl Iterator<Item = (AcceleratorKind, Point)>,
    is_line: bool,
) -> Chart {
    let mut series: Vec<Series> = Vec::new();
    for (kind, point) in points {
        match series.iter_mut().find(|s| s.name == kind.name()) {
            Some(series) => series.points.push(point),
            None => series.push(Series {
                name: kind.name().to_owned(),
                points: vec![point],
                is_line,
            }),
        }
    }
    Chart {
        name: name.to_owned(),
        title: title.to_owned(),
        plot: Plot::Lines(LineChart {
            x,
            y,
            series,
            has_front: true,
        }),
    }
}
