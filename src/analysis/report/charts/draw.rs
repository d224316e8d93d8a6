//! Draws charts on anything that plotters can draw on.

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Ruler;
use super::labels::{Labels, Place};
use super::{Chart, DotChart, HeatChart, LineChart, Plot, Point, Scale};
use crate::picture::{palette, srgb};

/// Text and axes. A page's style sheet knows this colour and the next, and has others for dark pages.
const INK: RGBColor = RGBColor(0x20, 0x20, 0x20);

/// Lines of the grid.
const GRID: RGBColor = RGBColor(0xd8, 0xd8, 0xd8);

/// Colours that colour-blind eyes tell apart (Okabe and Ito 2008), without the yellow that white swallows.
const COLORS: [RGBColor; 7] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0x7f, 0x7f, 0x7f),
];

/// Height of a line of text, in units.
pub(super) const LINE: i32 = 16;

/// Width that a character of text is taken to have, in units.
pub(super) const CHARACTER: i32 = 8;

type Area<DB> = DrawingArea<DB, Shift>;
type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;
type Axes<'a, DB> = ChartContext<'a, DB, Cartesian2d<Ruler, Ruler>>;

/// A surface and the pixels of a unit.
struct Sheet<'a, DB: DrawingBackend> {
    area: &'a Area<DB>,
    scale: i32,
}

/// Draws a chart; `scale` is the number of pixels of a unit.
pub(super) fn chart<DB: DrawingBackend>(
    chart: &Chart,
    area: &Area<DB>,
    scale: i32,
    has_ground: bool,
) -> Drawn<DB> {
    if has_ground {
        area.fill(&WHITE)?;
    }
    let sheet = Sheet { area, scale };
    sheet.text((12, 8), &chart.title, INK, (HPos::Left, VPos::Top))?;
    match &chart.plot {
        Plot::Lines(plot) => lines(&sheet, plot)?,
        Plot::Dots(plot) => dots(&sheet, plot)?,
        Plot::Heat(plot) => heat(&sheet, plot)?,
    }
    area.present()
}

fn lines<DB: DrawingBackend>(sheet: &Sheet<DB>, plot: &LineChart) -> Drawn<DB> {
    let points = || plot.series.iter().flat_map(|s| &s.points);
    let x = points().flat_map(|p| [p.x].into_iter().chain(p.across.into_iter().flatten()));
    let x = Ruler::of(plot.x.scale, x);
    let ends = points().flat_map(|p| {
        // An end at 0 would stretch a logarithmic axis to nothing.
        let ends = p.interval.unwrap_or([p.y; 2]);
        let is_usable = plot.y.scale != Scale::Log || ends[0] > p.y * 1e-3;
        [p.y, ends[1], if is_usable { ends[0] } else { p.y }]
    });
    let y = Ruler::of(plot.y.scale, ends);
    let names: Vec<&str> = plot.series.iter().map(|s| s.name.as_str()).collect();
    let top = sheet.legend(&names)?;
    let axes = sheet.axes(top, (&x, &plot.x.label), (&y, &plot.y.label), false)?;
    let at = |px: f64, py: f64| axes.plotting_area().map_coordinate(&(px, py));
    if plot.has_front {
        let front = front(
            points()
                .map(|p| (p.x, p.y))
                .filter(|p| x.has(p.0) && y.has(p.1)),
        );
        let corners = front.windows(2).flat_map(|w| [w[0], (w[1].0, w[0].1)]);
        let corners = corners.chain(front.last().copied());
        let path: Vec<_> = corners.map(|(px, py)| at(px, py)).collect();
        sheet.path(path, INK, 1)?;
    }
    let is_shown = |p: &&Point| x.has(p.x) && y.has(p.y);
    let in_units = |(x, y): (i32, i32)| (x / sheet.scale, y / sheet.scale);
    let marks = points().filter(is_shown).map(|p| {
        let ends = p.across.unwrap_or([p.x; 2]).map(|end| x.clamped(end));
        let [(left, y), (right, _)] = ends.map(|end| in_units(at(end, p.y)));
        ([left, right], y)
    });
    let mut labels = Labels::new(sheet.room(top, &axes), marks);
    for (number, series) in plot.series.iter().enumerate() {
        let color = COLORS[number % COLORS.len()];
        let shown = || series.points.iter().filter(is_shown);
        if series.is_line {
            sheet.path(shown().map(|p| at(p.x, p.y)).collect(), color, 2)?;
        }
        for point in shown() {
            let place = at(point.x, point.y);
            if let Some([low, high]) = point.interval {
                let [low, high] = [low, high].map(|end| at(point.x, y.clamped(end)));
                sheet.bar(low, high, color)?;
            }
            if let Some(ends) = point.across {
                let [left, right] = ends.map(|end| at(x.clamped(end), point.y));
                sheet.bar(left, right, color)?;
            }
            sheet.mark(place, number)?;
            if !point.label.is_empty() {
                let words = labels.place(in_units(place), &point.label);
                sheet.label(place, &point.label, words, color)?;
            }
        }
    }
    Ok(())
}

/// The points that no other is below and left of, from the left.
fn front(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut points: Vec<_> = points.collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut least = f64::INFINITY;
    points.retain(|p| {
        let is_better = p.1 < least;
        least = least.min(p.1);
        is_better
    });
    points
}

fn dots<DB: DrawingBackend>(sheet: &Sheet<DB>, plot: &DotChart) -> Drawn<DB> {
    let values = plot.series.iter().flat_map(|(_, values)| values);
    let x = Ruler::of(plot.axis.scale, values.flatten().flatten().copied());
    let y = Ruler::of_names(&plot.rows, true);
    let names: Vec<&str> = plot.series.iter().map(|(name, _)| name.as_str()).collect();
    let top = sheet.legend(&names)?;
    let axes = sheet.axes(top, (&x, &plot.axis.label), (&y, ""), true)?;
    let count = plot.series.len() as f64;
    for (number, (_, values)) in plot.series.iter().enumerate() {
        let offset = ((number as f64 + 0.5) / count - 0.5) * 0.72;
        for (row, value) in values.iter().enumerate() {
            let Some([low, value, high]) = value.filter(|v| x.has(v[1])) else {
                continue;
            };
            let y = row as f64 + offset;
            let at = |value: f64| axes.plotting_area().map_coordinate(&(x.clamped(value), y));
            sheet.bar(at(low), at(high), COLORS[number % COLORS.len()])?;
            sheet.mark(at(value), number)?;
        }
    }
    Ok(())
}

fn heat<DB: DrawingBackend>(sheet: &Sheet<DB>, plot: &HeatChart) -> Drawn<DB> {
    let finite = || {
        plot.values
            .iter()
            .flatten()
            .flatten()
            .filter(|v| v.is_finite())
    };
    let least = finite().copied().fold(f64::INFINITY, f64::min);
    let greatest = finite().copied().fold(f64::NEG_INFINITY, f64::max);
    let [x, y] = [(&plot.columns, false), (&plot.rows, true)]
        .map(|(names, is_vertical)| Ruler::of_names(names, is_vertical));
    let axes = sheet.axes(2 * LINE, (&x, &plot.label), (&y, ""), true)?;
    for (row, values) in plot.values.iter().enumerate() {
        for (column, value) in values.iter().enumerate() {
            let Some(value) = value.filter(|v| v.is_finite()) else {
                continue;
            };
            let share = (value - least) / (greatest - least).max(f64::MIN_POSITIVE);
            let [r, g, b] = palette::ramp(share as f32).map(srgb::u8_of_linear);
            let (column, row) = (column as f64, row as f64);
            let corner = |d: f64| {
                let place = (column + d, row + d);
                axes.plotting_area().map_coordinate(&place)
            };
            let cell = [corner(-0.5), corner(0.5)];
            sheet
                .area
                .draw(&Rectangle::new(cell, RGBColor(r, g, b).filled()))?;
            let (cx, cy) = corner(0.0);
            let color = if share > 0.6 { BLACK } else { WHITE };
            let center = (cx / sheet.scale, cy / sheet.scale);
            let number = super::super::table::shown(value);
            sheet.text(center, &number, color, (HPos::Center, VPos::Center))?;
        }
    }
    Ok(())
}

impl<'a, DB: DrawingBackend> Sheet<'a, DB> {
    /// A text at a place in units.
    fn text(
        &self,
        (x, y): (i32, i32),
        text: &str,
        color: RGBColor,
        (h, v): (HPos, VPos),
    ) -> Drawn<DB> {
        if text.is_empty() {
            return Ok(());
        }
        let style = self.style().color(&color).pos(Pos::new(h, v));
        self.area
            .draw_text(text, &style, (x * self.scale, y * self.scale))
    }

    /// Words of a point in pixels, with a line to it where they are not just beside it.
    fn label(&self, point: (i32, i32), text: &str, place: Place, color: RGBColor) -> Drawn<DB> {
        let (side, toward) = if place.is_left {
            (HPos::Right, 2)
        } else {
            (HPos::Left, -2)
        };
        if place.is_far {
            let end = (place.x + toward, place.bottom - LINE / 2);
            let end = (end.0 * self.scale, end.1 * self.scale);
            self.path(vec![point, end], color, 1)?;
        }
        self.text((place.x, place.bottom), text, INK, (side, VPos::Bottom))
    }

    /// Where words may stand, in units: left, right, top and bottom.
    fn room(&self, top: i32, axes: &Axes<DB>) -> [i32; 4] {
        let (across, down) = axes.plotting_area().get_pixel_range();
        let width = self.area.dim_in_pixel().0 as i32 / self.scale;
        [across.start / self.scale, width, top, down.end / self.scale]
    }

    fn style(&self) -> TextStyle<'static> {
        let size = f64::from(LINE * self.scale);
        ("sans-serif", size).into_font().color(&INK)
    }

    /// The names of the series with their marks; tells where it ends, in units. A single one is left to the title.
    fn legend(&self, names: &[&str]) -> Result<i32, DrawingAreaErrorKind<DB::ErrorType>> {
        let right = self.area.dim_in_pixel().0 as i32 / self.scale;
        let (mut x, mut y) = (18, 2 * LINE + 8);
        if names.len() < 2 {
            return Ok(2 * LINE);
        }
        for (number, name) in names.iter().enumerate() {
            let width = 28 + CHARACTER * name.chars().count() as i32;
            if x + width > right && x > 18 {
                (x, y) = (18, y + LINE + 2);
            }
            self.mark((x * self.scale, y * self.scale), number)?;
            self.text((x + 10, y), name, INK, (HPos::Left, VPos::Center))?;
            x += width;
        }
        Ok(y + LINE)
    }

    /// Axes and grid below `top`.
    fn axes<'b>(
        &self,
        top: i32,
        (x, x_label): (&'b Ruler, &str),
        (y, y_label): (&'b Ruler, &str),
        has_names: bool,
    ) -> Result<Axes<'a, DB>, DrawingAreaErrorKind<DB::ErrorType>>
    where
        'b: 'a,
    {
        let s = self.scale;
        let area = self.area.margin(top * s, 8 * s, 12 * s, 24 * s);
        let mut axes = ChartBuilder::on(&area)
            .x_label_area_size(46 * s)
            .y_label_area_size((if has_names { 130 } else { 74 }) * s)
            .build_cartesian_2d(x.clone(), y.clone())?;
        let mut mesh = axes.configure_mesh();
        mesh.axis_style(INK.stroke_width(s as u32))
            .bold_line_style(GRID.stroke_width(s as u32))
            .light_line_style(TRANSPARENT)
            .label_style(self.style())
            .x_desc(x_label)
            .y_desc(y_label)
            .set_all_tick_mark_size(5 * s);
        mesh.draw()?;
        Ok(axes)
    }

    fn path(&self, path: Vec<(i32, i32)>, color: RGBColor, width: i32) -> Drawn<DB> {
        let style = color.stroke_width((width * self.scale) as u32);
        // A path of several pixels' width needs two different points.
        for two in path.windows(2).filter(|two| two[0] != two[1]) {
            self.area.draw(&PathElement::new(two.to_vec(), style))?;
        }
        Ok(())
    }

    /// An interval: a line with a stroke at either end.
    fn bar(&self, from: (i32, i32), to: (i32, i32), color: RGBColor) -> Drawn<DB> {
        self.path(vec![from, to], color, 1)?;
        let half = 4 * self.scale;
        let (dx, dy) = if from.0 == to.0 { (half, 0) } else { (0, half) };
        for (x, y) in [from, to] {
            self.path(vec![(x - dx, y - dy), (x + dx, y + dy)], color, 1)?;
        }
        Ok(())
    }

    /// The mark of a series, in its colour.
    fn mark(&self, (x, y): (i32, i32), number: usize) -> Drawn<DB> {
        let style = COLORS[number % COLORS.len()].filled();
        let r = 5 * self.scale;
        let shape = |corners: &[(i32, i32)]| {
            let corner = |(dx, dy): &(i32, i32)| (x + dx, y + dy);
            Polygon::new(corners.iter().map(corner).collect::<Vec<_>>(), style)
        };
        let w = r * 9 / 10;
        match number % 5 {
            0 => self.area.draw(&Circle::new((x, y), r, style)),
            1 => self
                .area
                .draw(&shape(&[(-w, -w), (w, -w), (w, w), (-w, w)])),
            2 => self.area.draw(&shape(&[(0, -r), (r, w), (-r, w)])),
            3 => self
                .area
                .draw(&shape(&[(0, -r - 4), (r + 4, 0), (0, r + 4), (-r - 4, 0)])),
            _ => self.area.draw(&shape(&[(-r, -w), (r, -w), (0, r)])),
        }
    }
}
