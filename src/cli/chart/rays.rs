//! Methods on rays, as charts and as a table: time of a ray against what is wrong.

use bspray::analysis::chart::{RayPoint, Wrong};
use bspray::analysis::report::{
    Axis, Cell, Chart, LineChart, Plot, Point, Report, Scale, Section, Series, Table,
};

use super::page::{ChartPage, Measure, Words};

/// Nanoseconds a ray at so many rays a second.
pub(super) fn nanoseconds(rays_per_second: f64) -> f64 {
    1e9 / rays_per_second
}

/// Where the time of a ray lies.
pub(super) fn nanosecond_ends(p: &RayPoint) -> [f64; 2] {
    let speed = p.speed.rays_per_second;
    [speed.high, speed.low].map(nanoseconds)
}

impl ChartPage<'_> {
    pub(super) fn push_rays(&self, page: &mut Report) {
        let points = &self.points.rays.points;
        page.push(Section::Heading("Rays".to_owned()));
        page.push(Section::Paragraph(
            "Time of a ray, over eye rays and diffuse bounces of the view in equal parts, on one thread, against what is wrong. Rays at edges go from the eye to \
            points of the edges of the triangles that it sees: nowhere are tests wrong more often, and at silhouettes single precision can but guess. Exact methods owe every bit; others the first triangle, at a depth that \
            single precision can give. Error bars across are bootstrap intervals of the median, and bars upwards are confidence intervals of 95 % (Wilson). The line is the Pareto front: no method is \
            both faster and righter than those on it. A hole misses a hit, a ghost hits nothing, and what is misplaced is not the first hit, or not where it is said to be."
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
            let named = points.iter().map(|p| (p.method.structure(), point(p)));
            page.push(Section::Chart(chart(name, title, (x, y), named)));
        }
        page.push(Section::Table(self.ray_table()));
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
}

/// Points over two axes, a series for each structure.
fn chart(
    name: &str,
    title: &str,
    (x, y): (Axis, Axis),
    points: impl Iterator<Item = (&'static str, Point)>,
) -> Chart {
    let mut series: Vec<Series> = Vec::new();
    for (structure, point) in points {
        match series.iter_mut().find(|s| s.name == structure) {
            Some(series) => series.points.push(point),
            None => series.push(Series {
                name: structure.to_owned(),
                points: vec![point],
                is_line: false,
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
