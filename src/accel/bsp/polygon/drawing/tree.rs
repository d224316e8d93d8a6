//! The tree as a drawing: a box a node with the names of its fragments, what is behind on the left, what is in front on the right, as the lecture has them.

use std::collections::HashMap;

use glam::DVec2;

use super::super::tree::PolygonBsp;
use super::layout::{Item, place};
use super::sheet::{Sheet, text_width};
use super::{Drawing, cell_color, cell_name, cells, fragment_color, short_names};

/// Nodes and levels of a drawing, and its width in pixels. More cannot be read on one sheet.
const MOST_NODES: usize = 400;
const MOST_LEVELS: u32 = 60;
const MOST_WIDTH: f64 = 4000.0;

/// Nodes of a tree whose cells of space are drawn, too.
const MOST_WITH_CELLS: usize = 64;

const LEVEL_HEIGHT: f64 = 64.0;
const BOX_HEIGHT: f64 = 28.0;
const MARGIN: f64 = 20.0;
/// Above the tree: title and legend.
const HEAD: f64 = 76.0;

const STYLE: &str = "\
line.back { stroke: #2166ac; stroke-width: 1.8; stroke-dasharray: 5 3 }
line.front { stroke: #b2182b; stroke-width: 1.8 }
rect.node { stroke: #333; stroke-width: 1.2 }
rect.undivided { stroke: #333; stroke-dasharray: 3 2 }
rect.cell { stroke: #999; stroke-width: 0.8 }
.cell text { font-size: 12px; fill: #333 }
";

/// What stands at a place of the drawing.
enum Shown {
    Node(u32),
    Cell(u32),
    /// So many nodes that are not drawn.
    More(u32),
}

impl PolygonBsp {
    /// The tree as an SVG drawing, with `title` above it. Of large trees the upper levels are drawn, and how many nodes are below each place.
    ///
    /// ```
    /// use bspray::accel::{BspOrder, BuildOptions, bsp::polygon::SceneTrees};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scene = bspray::import::load(&["models/lecture-block.obj".into()])?;
    /// let options = BuildOptions { order: BspOrder::File, ..BuildOptions::default() };
    /// let drawing = SceneTrees::build(&scene, &options).trees()[0].bsp.draw_tree("the lecture's block");
    /// assert!(drawing.note.is_none() && drawing.svg.contains(">7a</text>"));
    /// # Ok(())
    /// # }
    /// ```
    pub fn draw_tree(&self, title: &str) -> Drawing {
        let mut levels = self.drawn_levels();
        let (shown, items, middles, width) = loop {
            let shown = self.shown(levels);
            let items = self.items(&shown);
            let (middles, width) = place(&items);
            if width <= MOST_WIDTH || levels <= 1 {
                break (shown, items, middles, width);
            }
            levels -= 1;
        };
        let mut depths = vec![0_u32; shown.len()];
        for (number, (_, children)) in shown.iter().enumerate() {
            for child in children.iter().flatten() {
                depths[*child] = depths[number] + 1;
            }
        }
        let drawn = shown
            .iter()
            .filter(|(s, _)| matches!(s, Shown::Node(_)))
            .count();
        let note = (drawn < self.nodes.len()).then(|| {
            format!(
                "The upper {levels} of {} levels are drawn, {drawn} of {} nodes.",
                self.stats().depth,
                self.nodes.len()
            )
        });
        let size = DVec2::new(
            width.max(text_width(title) * 1.2).max(legend_width()) + 2.0 * MARGIN,
            HEAD + f64::from(depths.iter().max().map_or(0, |d| d + 1)) * LEVEL_HEIGHT
                + if note.is_some() { 24.0 } else { 0.0 },
        );
        let left = (size.x - width) / 2.0;
        let at = |i: usize| {
            let level = f64::from(depths[i]);
            DVec2::new(
                left + middles[i],
                HEAD + BOX_HEIGHT / 2.0 + level * LEVEL_HEIGHT,
            )
        };
        let mut sheet = Sheet::default();
        sheet.text("head", DVec2::new(MARGIN, 24.0), title);
        let has_cells = shown.iter().any(|(s, _)| matches!(s, Shown::Cell(_)));
        draw_legend(&mut sheet, has_cells);
        for (number, (_, children)) in shown.iter().enumerate() {
            let half = DVec2::new(0.0, BOX_HEIGHT / 2.0);
            for (child, class) in children.iter().zip(["back", "front"]) {
                if let Some(child) = *child {
                    sheet.line(class, at(number) + half, at(child) - half);
                }
            }
        }
        for (number, (what, _)) in shown.iter().enumerate() {
            self.draw(&mut sheet, what, at(number), items[number].width);
        }
        if let Some(note) = &note {
            sheet.text("note", DVec2::new(MARGIN, size.y - 20.0), note);
        }
        Drawing {
            svg: sheet.finish(size, title, STYLE),
            note,
        }
    }

    fn items(&self, shown: &[(Shown, [Option<usize>; 2])]) -> Vec<Item> {
        let item = |(what, children): &(Shown, [Option<usize>; 2])| Item {
            width: match *what {
                Shown::Node(node) => 18.0 + text_width(&self.short_label(node)),
                Shown::Cell(cell) => 12.0 + text_width(&cell_name(cell)),
                Shown::More(count) => 10.0 + text_width(&more(count)),
            },
            children: *children,
        };
        shown.iter().map(item).collect()
    }

    fn draw(&self, sheet: &mut Sheet, what: &Shown, at: DVec2, width: f64) {
        match *what {
            Shown::Node(number) => {
                let node = &self.nodes[number as usize];
                let size = DVec2::new(width, BOX_HEIGHT);
                let fill = node
                    .fragments()
                    .next()
                    .map_or("#eee".to_owned(), fragment_color);
                let class = if node.plane().is_some() {
                    "node"
                } else {
                    "undivided"
                };
                sheet.rectangle(class, at, size, &fill);
                sheet.text("name", at, &self.short_label(number));
            }
            Shown::Cell(cell) => sheet.group("cell", |sheet| {
                let size = DVec2::new(width, 20.0);
                let at = at - DVec2::new(0.0, 4.0);
                sheet.rectangle("cell", at, size, &cell_color(cell));
                sheet.text("name", at, &cell_name(cell));
            }),
            Shown::More(count) => sheet.text("more", at, &more(count)),
        }
    }

    /// The greatest number of levels whose nodes fit.
    fn drawn_levels(&self) -> u32 {
        let mut counts: Vec<usize> = Vec::new();
        for node in &self.nodes {
            let depth = node.depth() as usize;
            if depth >= counts.len() {
                counts.resize(depth + 1, 0);
            }
            counts[depth] += 1;
        }
        let mut sum = 0;
        let mut fits = |count: &usize| {
            sum += count;
            sum <= MOST_NODES
        };
        let levels = counts.iter().take(MOST_LEVELS as usize);
        levels.take_while(|c| fits(c)).count().max(1) as u32
    }

    /// Everything that is drawn, and what hangs from it on either side.
    fn shown(&self, levels: u32) -> Vec<(Shown, [Option<usize>; 2])> {
        let cells = if self.nodes.len() <= MOST_WITH_CELLS {
            cells(self)
        } else {
            HashMap::new()
        };
        let sizes = self.sizes();
        let mut shown: Vec<(Shown, [Option<usize>; 2])> = Vec::new();
        if !self.nodes.is_empty() {
            shown.push((Shown::Node(0), [None; 2]));
        }
        let mut next = 0;
        while next < shown.len() {
            if let Shown::Node(number) = shown[next].0 {
                let node = &self.nodes[number as usize];
                for (side, child) in [node.back(), node.front()].into_iter().enumerate() {
                    let what = match child {
                        Some(child) if node.depth() + 1 < levels => Shown::Node(child),
                        Some(child) => Shown::More(sizes[child as usize]),
                        None => match cells.get(&(number, side == 1)) {
                            Some(&cell) => Shown::Cell(cell),
                            None => continue,
                        },
                    };
                    shown[next].1[side] = Some(shown.len());
                    shown.push((what, [None; 2]));
                }
            }
            next += 1;
        }
        shown
    }

    /// Nodes of each subtree.
    fn sizes(&self) -> Vec<u32> {
        let mut sizes = vec![1; self.nodes.len()];
        for number in (0..self.nodes.len()).rev() {
            let node = &self.nodes[number];
            let below = [node.back(), node.front()].into_iter().flatten();
            sizes[number] += below.map(|c| sizes[c as usize]).sum::<u32>();
        }
        sizes
    }

    fn short_label(&self, node: u32) -> String {
        let fragments: Vec<u32> = self.nodes[node as usize].fragments().collect();
        short_names(self, &fragments)
    }
}

fn more(count: u32) -> String {
    format!("… {count}")
}

/// What the lines and boxes are, and the width of the words.
const LEGEND: [(&str, &str, f64); 3] = [
    ("back", "behind (inside)", 96.0),
    ("front", "in front (outside)", 112.0),
    ("cell", "cell of space", 80.0),
];
/// Width of a line or box of the legend with its room.
const SIGN: f64 = 38.0;
const BETWEEN: f64 = 28.0;

fn legend_width() -> f64 {
    LEGEND
        .iter()
        .map(|(.., width)| SIGN + width + BETWEEN)
        .sum()
}

fn draw_legend(sheet: &mut Sheet, has_cells: bool) {
    let mut x = MARGIN;
    for (class, words, width) in LEGEND {
        let from = DVec2::new(x, 48.0);
        if class == "cell" {
            if !has_cells {
                break;
            }
            let fill = cell_color(0);
            sheet.rectangle(class, from + DVec2::X * 18.0, DVec2::new(22.0, 18.0), &fill);
        } else {
            sheet.line(class, from, from + DVec2::X * 30.0);
        }
        sheet.text("note", from + DVec2::X * SIGN, words);
        x += SIGN + width + BETWEEN;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BspOrder, BuildOptions};
    use crate::geometry::Triangle;
    use glam::Vec3;

    fn planes(count: u32) -> Vec<Triangle> {
        let at = |i: u32, x, y| Vec3::new(x, y, i as f32);
        (0..count)
            .map(|i| Triangle::new(at(i, 0.0, 0.0), at(i, 3.0, 0.0), at(i, 0.0, 2.0)))
            .collect()
    }

    #[test]
    fn large_trees_are_drawn_down_to_a_level_and_say_so() {
        for (order, levels) in [(BspOrder::File, 60), (BspOrder::Balanced, 6)] {
            let options = BuildOptions {
                order,
                ..BuildOptions::default()
            };
            let tree = PolygonBsp::build(planes(3000), &[], &options);
            let drawing = tree.draw_tree("many");
            let note = drawing.note.unwrap();
            assert!(
                note.starts_with(&format!("The upper {levels} of ")),
                "{note}"
            );
            assert!(drawing.svg.len() < 300_000 && drawing.svg.contains(&note));
        }
    }

    #[test]
    fn an_empty_tree_is_an_empty_sheet() {
        let drawing = PolygonBsp::default().draw_tree("nothing");
        assert!(drawing.note.is_none() && !drawing.svg.contains("class=\"node\""));
    }
}
