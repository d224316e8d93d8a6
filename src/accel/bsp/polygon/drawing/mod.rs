//! Trees as drawings, in SVG: the tree itself, and for walls the regions of the plane into which it divides it.
//!
//! Both follow the figures of the lecture's "BSP Trees (3)" to "(9)" and "3D BSP Trees". Lengths are in pixels of the drawing, y downwards. A fragment has
//! the colour that it has in pictures of the integrator `fragment`; a cell of space has the same letters and tint in both drawings.

mod half_plane;
mod layout;
mod plan;
mod regions;
mod sheet;
mod tree;

use std::collections::HashMap;

use super::tree::{PolygonBsp, letters};
use crate::picture::{palette, srgb};

pub use plan::PlanFault;

/// A drawing, and what is not in it.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The file's content.
    pub svg: String,
    /// What was left out, and why; it is said in the drawing, too.
    pub note: Option<String>,
}

/// The undivided cells of space, by node and whether they lie in front of it: numbers from what is most behind to what is most in front.
fn cells(tree: &PolygonBsp) -> HashMap<(u32, bool), u32> {
    let mut cells = HashMap::new();
    tree.in_order(|number| {
        let node = &tree.nodes[number as usize];
        if node.plane().is_none() {
            return;
        }
        for (child, is_front) in [(node.back(), false), (node.front(), true)] {
            if child.is_none() {
                cells.insert((number, is_front), cells.len() as u32);
            }
        }
    });
    cells
}

/// Fragments that are named in one place; of more, the number is told.
const MOST_NAMES: usize = 4;

/// Names of fragments that lie in one plane, as many as fit.
fn short_names(tree: &PolygonBsp, fragments: &[u32]) -> String {
    let named = fragments.iter().take(MOST_NAMES);
    let mut names: Vec<String> = named.map(|&f| tree.name(f)).collect();
    if fragments.len() > MOST_NAMES {
        names.push(format!("+{}", fragments.len() - MOST_NAMES));
    }
    names.join(" ")
}

/// A to Z, then AA to ZZ.
fn cell_name(cell: u32) -> String {
    letters(cell, b'A')
}

/// As `#rrggbb`.
fn hex([r, g, b]: [f32; 3]) -> String {
    let [r, g, b] = [r, g, b].map(srgb::u8_of_linear);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The colour of a fragment, as the integrator `fragment` has it.
fn fragment_color(fragment: u32) -> String {
    hex(palette::distinct(fragment))
}

/// The pale tint of a cell. Its numbers go on where no fragment's are, so that no cell looks like its namesake.
fn cell_color(cell: u32) -> String {
    let pale = palette::distinct(u32::MAX - cell).map(|c| 0.35 * c + 0.65);
    hex(pale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BspOrder, BuildOptions};
    use crate::geometry::Triangle;
    use glam::Vec3;

    #[test]
    fn cells_are_numbered_from_behind() {
        // Two walls, the second in front of the first and split by none.
        let wall = |x: f32| {
            let at = |y, z| Vec3::new(x, y, z);
            Triangle::new(at(0.0, 0.0), at(2.0, 0.0), at(0.0, 1.0))
        };
        let options = BuildOptions {
            order: BspOrder::File,
            ..BuildOptions::default()
        };
        let tree = PolygonBsp::build(vec![wall(0.0), wall(1.0)], &[], &options);
        let mut found: Vec<_> = cells(&tree).into_iter().collect();
        found.sort_unstable();
        assert_eq!(found, [((0, false), 0), ((1, false), 1), ((1, true), 2)]);
        assert_eq!([cell_name(0), cell_name(27)], ["A", "AB"]);
    }
}
