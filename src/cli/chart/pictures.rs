//! Methods on pictures, as charts and as a table: time to a picture against its distance from a converged one.

use bspray::analysis::chart::PicturePoint;
use bspray::analysis::report::{
    Axis, Chart, LineChart, Plot, Point, Report, Scale, Section, Series, ShownPicture, Table,
};
use bspray::picture::{Raster, ToneMap};
use glam::Vec3;

use super::page::{ChartPage, Measure, Words};

impl ChartPage<'_> {
    pub(super) fn push_pictures(&self, page: &mut Report) {
        let pictures = &self.points.pictures;
        page.push(Section::Heading("Pictures".to_owned()));
        page.push(Section::Paragraph(format!(
            "Time to a path-traced picture, build and render, on {} threads, against its difference from a reference of {} samples a pixel with other random \
            numbers. Exact structures make the same picture, bit for bit; they differ in time alone. `lod` are pictures of meshes simplified by so many pixels at most, which is done within the time. Labels are samples a pixel.",
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
        let first = pictures.points.first().map(PicturePoint::name);
        for ([name, title, label], value) in metrics {
            let mut series: Vec<Series> = Vec::new();
            for p in &pictures.points {
                let name = p.name();
                let label = if Some(&name) == first.as_ref() {
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
                match series.last_mut().filter(|s| s.name == name) {
                    Some(series) => series.points.push(point),
                    None => series.push(Series {
                        name,
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
        if !pictures.coarse.is_empty() {
            page.push(Section::Paragraph(
                "What simplifying leaves of the meshes, how far any of their vertices is from the surface that stands for it, and how far depths are from those of the whole scene, \
                in shares of these, along rays through the pixels' middles. Pixels at outlines may see a surface in one of both alone."
                    .to_owned(),
            ));
            page.push(Section::Table(self.coarse_table()));
        }
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

    fn coarse_table(&self) -> Table {
        let heads = [
            "lod (pixels)",
            "triangles",
            "kept",
            "error (pixels)",
            "depth error, rms",
            "depth error, greatest",
            "pixels in both",
            "pixels in one",
        ];
        let mut table = Table::new("simplified", "Simplified meshes", &heads);
        for c in &self.points.pictures.coarse {
            table.push(vec![
                f64::from(c.budget).into(),
                c.detail.triangles().into(),
                c.detail.kept().into(),
                c.detail.error().into(),
                c.depth.rms.into(),
                c.depth.greatest.into(),
                c.in_both.into(),
                c.in_one.into(),
            ]);
        }
        table
    }

    fn picture_table(&self) -> Table {
        let heads = [
            "method",
            "samples",
            "median (s)",
            "low (s)",
            "high (s)",
            "relMSE",
            "RMSE",
            "FLIP",
            "command",
        ];
        let mut table = Table::new("pictures", "Methods on pictures", &heads);
        for p in &self.points.pictures.points {
            let [low, high] = [p.seconds.low, p.seconds.high];
            table.push(vec![
                p.name().as_str().into(),
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
}
