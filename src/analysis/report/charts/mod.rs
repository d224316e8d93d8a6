//! Charts: what they show, and their SVG and PNG. The only folder that names the crate `plotters`.
//!
//! Every chart's numbers are also a [`Table`], so that a report's CSV and JSON have them.

mod axis;
mod bitmap;
mod draw;
mod labels;

use plotters::prelude::{IntoDrawingArea, SVGBackend};

use super::table::Table;
use crate::picture::Raster;
use bitmap::Bitmap;

/// Size of a chart in the units of its text, of which a line takes 16.
const SIZE: (u32, u32) = (760, 430);

/// Charts are drawn larger by this, since drawings have whole coordinates.
const SCALE: u32 = 4;

/// How an axis runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By factors; values that are not above 0 are left out.
    Log,
    /// By factors, with a place for 0 below all others.
    LogAndZero,
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit: `time (s)`.
    pub label: String,
    /// How it runs.
    pub scale: Scale,
}

impl Axis {
    /// An axis.
    pub fn new(label: &str, scale: Scale) -> Self {
        Self {
            label: label.to_owned(),
            scale,
        }
    }
}

/// A point of a [`LineChart`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// Where `x` lies by its measurement.
    pub across: Option<[f64; 2]>,
    /// Where `y` lies by its measurement: confidence interval, quartiles.
    pub interval: Option<[f64; 2]>,
    /// Words beside it.
    pub label: String,
}

/// The points of one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The method.
    pub name: String,
    /// Its points.
    pub points: Vec<Point>,
    /// Whether a line joins them in their order.
    pub is_line: bool,
}

/// Points over two axes, joined by lines or not.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn, each in a colour and a mark of its own.
    pub series: Vec<Series>,
    /// Whether the Pareto front is drawn: the points that no other is below and left of at once.
    pub has_front: bool,
}

/// Estimates with intervals, of several series for each of some names.
#[derive(Clone, Debug, PartialEq)]
pub struct DotChart {
    /// The horizontal axis, of the values.
    pub axis: Axis,
    /// The names, from the top.
    pub rows: Vec<String>,
    /// What is drawn: for each series an estimate for each row, as lower end, value and upper end.
    pub series: Vec<(String, Vec<Option<[f64; 3]>>)>,
}

/// Values in the cells of two lists of names, as colours and numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatChart {
    /// What the values are.
    pub label: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Names of the rows, from the top.
    pub rows: Vec<String>,
    /// Values, a list for each row.
    pub values: Vec<Vec<Option<f64>>>,
}

/// The kinds of charts.
#[derive(Clone, Debug, PartialEq)]
pub enum Plot {
    /// Points over two axes.
    Lines(LineChart),
    /// Estimates with intervals.
    Dots(DotChart),
    /// Values in cells.
    Heat(HeatChart),
}

/// A chart with a name, which is the stem of its files'.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Lower-case letters, digits and hyphens, different from all names of the report.
    pub name: String,
    /// What it shows, in a line.
    pub title: String,
    /// What is drawn.
    pub plot: Plot,
}

impl Chart {
    /// Its numbers.
    pub fn table(&self) -> Table {
        match &self.plot {
            Plot::Lines(chart) => {
                let (x, y) = (&chart.x.label, &chart.y.label);
                let ends =
                    |of: &str| ["lower end of", "upper end of"].map(|end| format!("{end} {of}"));
                let ([left, right], [low, high]) = (ends(x), ends(y));
                let columns = ["series", x, &left, &right, y, &low, &high, "label"];
                let mut table = Table::new(&self.name, &self.title, &columns);
                for series in &chart.series {
                    for p in &series.points {
                        let ends = |of: Option<[f64; 2]>| [0, 1].map(|end| of.map(|i| i[end]));
                        let ([left, right], [low, high]) = (ends(p.across), ends(p.interval));
                        let name = series.name.as_str();
                        table.push(vec![
                            name.into(),
                            p.x.into(),
                            left.into(),
                            right.into(),
                            p.y.into(),
                            low.into(),
                            high.into(),
                            p.label.as_str().into(),
                        ]);
                    }
                }
                table
            }
            Plot::Dots(chart) => {
                let value = &chart.axis.label;
                let [low, high] =
                    ["lower end of", "upper end of"].map(|end| format!("{end} {value}"));
                let columns = ["name", "series", &low, value, &high];
                let mut table = Table::new(&self.name, &self.title, &columns);
                for (name, values) in &chart.series {
                    for (row, value) in chart.rows.iter().zip(values) {
                        let [low, value, high] = [0, 1, 2].map(|k| value.map(|v| v[k]));
                        table.push(vec![
                            row.as_str().into(),
                            name.as_str().into(),
                            low.into(),
                            value.into(),
                            high.into(),
                        ]);
                    }
                }
                table
            }
            Plot::Heat(chart) => {
                let columns = ["row", "column", &chart.label];
                let mut table = Table::new(&self.name, &self.title, &columns);
                for (row, values) in chart.rows.iter().zip(&chart.values) {
                    for (column, value) in chart.columns.iter().zip(values) {
                        table.push(vec![
                            row.as_str().into(),
                            column.as_str().into(),
                            (*value).into(),
                        ]);
                    }
                }
                table
            }
        }
    }

    /// An SVG file on white. Text is left to the reader's fonts.
    pub fn svg(&self) -> String {
        self.drawing(true)
    }

    /// SVG without a ground, for a page whose style sheet colours it.
    pub(super) fn inline_svg(&self) -> String {
        let drawing = self.drawing(false);
        let start = drawing.find("<svg").unwrap_or(0);
        drawing[start..].to_owned()
    }

    fn drawing(&self, has_ground: bool) -> String {
        let (width, height) = self.size();
        let mut svg = String::new();
        let area = SVGBackend::with_string(&mut svg, (width * SCALE, height * SCALE));
        let area = area.into_drawing_area();
        let drawn = draw::chart(self, &area, SCALE as i32, has_ground);
        drawn.expect("text in memory takes all drawings");
        drop(area);
        let large = format!("width=\"{}\" height=\"{}\"", width * SCALE, height * SCALE);
        svg.replacen(&large, &format!("width=\"{width}\" height=\"{height}\""), 1)
    }

    /// A picture of two pixels for each unit.
    pub fn raster(&self) -> Raster {
        let (width, height) = self.size();
        let mut bitmap = Bitmap::new((width * SCALE, height * SCALE));
        {
            let area = (&mut bitmap).into_drawing_area();
            let drawn = draw::chart(self, &area, SCALE as i32, true);
            drawn.expect("a picture in memory takes all drawings");
        }
        bitmap.halved()
    }

    /// Charts of names grow with their number, and so that none is written over another.
    fn size(&self) -> (u32, u32) {
        let (columns, rows) = match &self.plot {
            Plot::Lines(_) => return SIZE,
            Plot::Dots(chart) => (0, chart.rows.len() * (chart.series.len() * 14 + 16)),
            Plot::Heat(chart) => {
                let longest = |names: &[String]| names.iter().map(|n| n.chars().count()).max();
                let [column, row] = [&chart.columns, &chart.rows].map(|n| longest(n).unwrap_or(0));
                let character = draw::CHARACTER as usize;
                let columns = chart.columns.len() * (column + 2) + row + 4;
                (columns * character, chart.rows.len() * 34)
            }
        };
        (SIZE.0.max(columns as u32), 110 + rows as u32)
    }
}

#[cfg(test)]
mod tests;
