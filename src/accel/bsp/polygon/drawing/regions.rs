//! The regions of a plan as a drawing: tinted and lettered, with the walls numbered, their normals, and the lines that walls are extended to.

use glam::DVec2;

use super::super::tree::PolygonBsp;
use super::plan::{Plan, PlanFault, Region, Wall};
use super::sheet::{Sheet, text_width};
use super::{Drawing, cell_color, cell_name, short_names};

/// Of the longer edge of the plan.
const EXTENT: f64 = 900.0;
const MARGIN: f64 = 20.0;
/// Above the plan: title and legend.
const HEAD: f64 = 72.0;
/// Length of the arrow that shows a wall's front.
const ARROW: f64 = 15.0;
const LABEL_HEIGHT: f64 = 18.0;
/// Where along a wall its arrow and number may stand, the best first.
const FEET: [f64; 7] = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8];
/// Places that are tried for a region's letter, along each axis of its box.
const TRIED: u32 = 24;
/// Free room that a letter needs on all sides, large and small; without it a region has none.
const LEAST_ROOM: [f64; 2] = [6.5, 4.5];
/// Free room beyond which a letter rather stands in the middle of its region.
const AMPLE_ROOM: f64 = 30.0;

const STYLE: &str = "\
polygon.region { stroke: none }
polygon.head { stroke: none }
line.cut { stroke: #777; stroke-width: 1; stroke-dasharray: 6 4 }
line.wall { stroke: #111; stroke-width: 3.5; stroke-linecap: round }
line.normal { stroke: #b2182b; stroke-width: 1.4 }
text.wall { font-weight: bold; paint-order: stroke; stroke: #fff; stroke-width: 3px; stroke-opacity: 0.7 }
text.cell { font-size: 17px; fill: #555; font-style: italic }
text.small { font-size: 11px; fill: #555; font-style: italic }
";

/// A text's place.
struct Label {
    at: DVec2,
    half: DVec2,
}

impl Label {
    fn new(at: DVec2, text: &str) -> Self {
        Self {
            at,
            half: DVec2::new(text_width(text), LABEL_HEIGHT) / 2.0,
        }
    }

    /// Free room between the label and a point; negative within.
    fn distance(&self, p: DVec2) -> f64 {
        let beyond = (p - self.at).abs() - self.half;
        if beyond.max_element() > 0.0 {
            beyond.max(DVec2::ZERO).length()
        } else {
            beyond.max_element()
        }
    }

    fn overlaps(&self, other: &Self) -> bool {
        ((self.at - other.at).abs() - self.half - other.half).max_element() < 0.0
    }

    /// Whether the segment comes within a few pixels.
    fn is_crossed(&self, [p, q]: [DVec2; 2]) -> bool {
        let steps = (p.distance(q) / 3.0).ceil().max(1.0) as u32;
        (0..=steps).any(|i| self.distance(p.lerp(q, f64::from(i) / f64::from(steps))) < 3.0)
    }
}

impl PolygonBsp {
    /// The plane as the tree divides it, as an SVG drawing with `title` above it: for trees of walls that stand on one axis, such as the lecture's eleven edges.
    ///
    /// ```
    /// use bspray::accel::{BspOrder, BuildOptions, bsp::polygon::{PlanFault, SceneTrees}};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let options = BuildOptions { order: BspOrder::File, ..BuildOptions::default() };
    /// let edges = bspray::import::load(&["models/lecture-edges.obj".into()])?;
    /// let drawing = SceneTrees::build(&edges, &options).trees()[0].bsp.draw_regions("eleven edges")?;
    /// assert!(drawing.svg.contains(">9b</text>"));
    /// // The caps of the block are no walls.
    /// let block = bspray::import::load(&["models/lecture-block.obj".into()])?;
    /// let fault = SceneTrees::build(&block, &options).trees()[0].bsp.draw_regions("the block");
    /// assert_eq!(fault.err(), Some(PlanFault::NoWall { polygon: 6, axis: 'z' }));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Where this makes no sense, or the tree is too large to be read.
    pub fn draw_regions(&self, title: &str) -> Result<Drawing, PlanFault> {
        let plan = Plan::of(self)?;
        let [min, max] = plan.frame;
        let scale = EXTENT / (max - min).max_element();
        let size = (max - min) * scale;
        let width = size.x.max(text_width(title) * 1.2).max(640.0);
        let left = MARGIN + (width - size.x) / 2.0;
        let to_sheet = |p: DVec2| {
            let p = (p - min) * scale;
            DVec2::new(left + p.x, HEAD + size.y - p.y)
        };
        let mut sheet = Sheet::default();
        sheet.text("head", DVec2::new(MARGIN, 24.0), title);
        let words = "letters: regions, the cells of the tree; numbers: walls, arrows at their fronts; dashed: walls extended to lines";
        sheet.text("note", DVec2::new(MARGIN, 48.0), words);
        let outlines: Vec<(&Region, Vec<DVec2>)> = plan
            .regions
            .iter()
            .filter(|r| !r.corners.is_empty())
            .map(|r| (r, r.corners.iter().map(|&p| to_sheet(p)).collect()))
            .collect();
        for (region, corners) in &outlines {
            sheet.polygon("region", corners, &cell_color(region.cell));
        }
        let cuts: Vec<[DVec2; 2]> = plan.cuts.iter().map(|c| c.map(to_sheet)).collect();
        for [from, to] in &cuts {
            sheet.line("cut", *from, *to);
        }
        let segments: Vec<[DVec2; 2]> = plan
            .walls
            .iter()
            .map(|w| [to_sheet(w.from), to_sheet(w.to)])
            .collect();
        for [from, to] in &segments {
            sheet.line("wall", *from, *to);
        }
        let labels = self.draw_walls(&mut sheet, &plan.walls, &segments, &cuts);
        let hidden = plan.regions.iter().filter(|r| r.corners.is_empty());
        let hidden: Vec<String> = hidden.map(|r| cell_name(r.cell)).collect();
        let mut narrow = Vec::new();
        for (region, corners) in &outlines {
            let name = cell_name(region.cell);
            if !draw_letter(&mut sheet, &name, corners, &labels) {
                narrow.push(name);
            }
        }
        let notes = [
            ("Beyond the drawing", hidden),
            ("Too narrow for their letters", narrow),
        ];
        let told = notes.iter().filter(|(_, names)| !names.is_empty());
        let told: Vec<String> = told
            .map(|(what, names)| format!("{what}: {}.", names.join(", ")))
            .collect();
        let note = (!told.is_empty()).then(|| told.join(" "));
        let mut bottom = HEAD + size.y + MARGIN;
        if let Some(note) = &note {
            sheet.text("note", DVec2::new(MARGIN, bottom + 4.0), note);
            bottom += 24.0;
        }
        Ok(Drawing {
            svg: sheet.finish(DVec2::new(width + 2.0 * MARGIN, bottom), title, STYLE),
            note,
        })
    }

    /// Draws the normals and the numbers of walls, where they cover nothing if such a place is found.
    fn draw_walls(
        &self,
        sheet: &mut Sheet,
        walls: &[Wall],
        segments: &[[DVec2; 2]],
        cuts: &[[DVec2; 2]],
    ) -> Vec<Label> {
        let mut labels: Vec<Label> = Vec::new();
        for (wall, &[from, to]) in walls.iter().zip(segments) {
            let normal = DVec2::new(wall.normal.x, -wall.normal.y);
            let names = short_names(self, &wall.fragments);
            let half = Label::new(DVec2::ZERO, &names).half;
            let away = normal * (ARROW + 3.0 + half.dot(normal.abs()));
            let feet = FEET.map(|share| from.lerp(to, share));
            let is_clear = |foot: &DVec2, lines: &[[DVec2; 2]]| {
                let label = Label::new(*foot + away, &names);
                labels.iter().all(|other| !label.overlaps(other))
                    && lines.iter().all(|&line| !label.is_crossed(line))
            };
            // Dashed lines may be covered if need be, walls only if all else fails.
            let clear = feet
                .iter()
                .find(|f| is_clear(f, segments) && is_clear(f, cuts))
                .or_else(|| feet.iter().find(|f| is_clear(f, segments)));
            let foot = *clear.unwrap_or(&feet[0]);
            draw_arrow(sheet, foot, normal);
            sheet.text("wall", foot + away, &names);
            labels.push(Label::new(foot + away, &names));
        }
        labels
    }
}

fn draw_arrow(sheet: &mut Sheet, foot: DVec2, normal: DVec2) {
    let tip = foot + normal * ARROW;
    let neck = foot + normal * (ARROW - 6.0);
    sheet.line("normal", foot, neck);
    let side = normal.perp() * 3.0;
    sheet.polygon("head", &[tip, neck + side, neck - side], "#b2182b");
}

/// Writes a region's letter where it has most room. Whether there is enough.
fn draw_letter(sheet: &mut Sheet, name: &str, corners: &[DVec2], labels: &[Label]) -> bool {
    let min = corners.iter().fold(DVec2::INFINITY, |a, &p| a.min(p));
    let max = corners.iter().fold(DVec2::NEG_INFINITY, |a, &p| a.max(p));
    let room = |p: DVec2| {
        let next = corners.iter().cycle().skip(1);
        // Where a line meets a corner, two points are one.
        let edges = corners
            .iter()
            .zip(next)
            .filter(|(a, b)| a.distance(**b) > 1e-6);
        // On the sheet y goes downwards, so that the corners run clockwise.
        let to_edges = edges.map(|(a, b)| (p - *a).perp_dot((*b - *a).normalize_or_zero()));
        let to_labels = labels.iter().map(|l| l.distance(p) - 2.0);
        to_edges.chain(to_labels).fold(f64::INFINITY, f64::min)
    };
    let share = |i: u32| (f64::from(i) + 0.5) / f64::from(TRIED);
    let tried = (0..TRIED * TRIED)
        .map(|i| min + (max - min) * DVec2::new(share(i % TRIED), share(i / TRIED)));
    let middle = corners.iter().sum::<DVec2>() / corners.len().max(1) as f64;
    let value = |p: DVec2| room(p).min(AMPLE_ROOM) - 0.02 * p.distance(middle);
    let best = tried.max_by(|&p, &q| f64::total_cmp(&value(p), &value(q)));
    let Some(at) = best else { return false };
    let fits = |least: f64| room(at) > least * name.len() as f64;
    let [large, small] = LEAST_ROOM;
    if fits(small) {
        sheet.text(if fits(large) { "cell" } else { "small" }, at, name);
    }
    fits(small)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_across_a_label_is_noticed_and_one_beside_it_is_not() {
        let label = Label::new(DVec2::new(300.0, 50.0), "1");
        let across = |y: f64| [DVec2::new(0.0, y), DVec2::new(1000.0, y)];
        assert!(label.is_crossed(across(50.0)) && label.is_crossed(across(60.0)));
        assert!(!label.is_crossed(across(70.0)));
        assert!(label.distance(label.at) < 0.0);
    }
}
