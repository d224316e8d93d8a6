//! Building the tree: a list of cells, and one after the other divided by the plane of one of its polygons.
//!
//! The tree is the one that inserting polygon after polygon would make, the lecture's way, where the order is one of the input: the first of a cell
//! divides it. The cell with the most fragments is always the next. So, where splits grow without bound and the limits end the build, what is left
//! over is in small cells.

use std::collections::{BinaryHeap, HashMap};

use super::super::options::BuildOptions;
use super::fragment::{Fragment, area};
use super::input;
use super::order::Chooser;
use super::split::{Cutter, Placing};
use super::tree::{NONE, PolygonBsp};
use crate::geometry::Triangle;

/// When a build ends that would not end by itself in reasonable time and memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildLimits {
    /// Fragments, in all nodes and cells together.
    pub fragments: u64,
    /// Fragments sorted to a side, over all nodes.
    pub work: u64,
}

impl BuildLimits {
    /// For so many polygons. Ordinary models have up to 20 fragments a polygon, and cells halve; lines of polygons behind each other need half the square of their number in work,
    /// which is granted to 10,000 of them. More: hostile files take minutes and gigabytes; less: ordinary trees end in lists.
    pub const fn of(polygons: u64) -> Self {
        Self {
            fragments: 20 * polygons + 100_000,
            work: 1_000 * polygons + 50_000_000,
        }
    }
}

/// A cell of space with the fragments in it, not yet divided.
struct Cell {
    /// More than any other's: the next.
    size: usize,
    /// The later, the greater: ties go to the earlier.
    age: std::cmp::Reverse<u64>,
    parent: Option<(u32, bool)>,
    fragments: Vec<Fragment>,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.size, self.age).cmp(&(other.size, other.age))
    }
}

impl PolygonBsp {
    /// The tree of triangles, all in one space. `outlines` are runs of triangles (first, count), ascending, that were one polygon of the file.
    ///
    /// ```
    /// use bspray::accel::{BspOrder, BuildOptions, bsp::polygon::PolygonBsp};
    /// use bspray::geometry::Triangle;
    /// use glam::Vec3;
    /// let floor = Triangle::new(Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0));
    /// let wall = Triangle::new(Vec3::new(1.0, 0.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(1.0, 0.5, 2.0));
    /// let options = BuildOptions { order: BspOrder::File, ..BuildOptions::default() };
    /// let tree = PolygonBsp::build(vec![floor, wall], &[], &options);
    /// // The floor's plane splits the wall: one piece of it in front, one behind.
    /// assert_eq!(tree.to_string(), "1\n  back 2a\n  front 2b\n");
    /// let eye = glam::DVec3::new(0.5, 0.5, 9.0);
    /// let names: Vec<_> = tree.front_to_back(eye).iter().map(|seen| tree.name(seen.fragment)).collect();
    /// assert_eq!(names, ["2b", "1", "2a"]);
    /// ```
    pub fn build(
        triangles: Vec<Triangle>,
        outlines: &[(u32, u32)],
        options: &BuildOptions,
    ) -> Self {
        let input = input::read(&triangles, outlines, options.merges_coplanar);
        let limits = BuildLimits::of(input.polygons.len() as u64);
        Self::build_within(triangles, input, options, limits)
    }

    pub(super) fn build_within(
        triangles: Vec<Triangle>,
        input: input::Input,
        options: &BuildOptions,
        limits: BuildLimits,
    ) -> Self {
        let plane_of: Vec<u32> = input.polygons.iter().map(|p| p.plane).collect();
        let areas: Vec<f64> = input.polygons.iter().map(|p| area(&p.loops)).collect();
        let fragments: Vec<Fragment> = (0..)
            .zip(&input.polygons)
            .map(|(number, p)| Fragment {
                polygon: number,
                loops: p.loops.clone(),
                triangles: p.triangles.clone(),
                piece: None,
            })
            .collect();
        let mut tree = Self {
            planes: input.planes,
            polygons: input.polygons,
            triangles,
            left_out: input.left_out,
            ..Self::default()
        };
        let mut count = fragments.len() as u64;
        let (mut work, mut age) = (0_u64, 0_u64);
        let mut cells = BinaryHeap::new();
        let mut push = |cells: &mut BinaryHeap<Cell>, fragments: Vec<Fragment>, parent| {
            age += 1;
            if !fragments.is_empty() {
                cells.push(Cell {
                    size: fragments.len(),
                    age: std::cmp::Reverse(age),
                    parent,
                    fragments,
                });
            }
        };
        push(&mut cells, fragments, None);
        while let Some(cell) = cells.pop() {
            if cell.size > 1 && (count >= limits.fragments || work >= limits.work) {
                tree.push_node(NONE, cell.parent);
                cell.fragments
                    .into_iter()
                    .for_each(|f| tree.push_fragment(f));
                continue;
            }
            work += cell.size as u64;
            let chooser = Chooser {
                order: options.order,
                seed: options.seed,
                planes: &tree.planes,
                plane_of: &plane_of,
                areas: &areas,
            };
            let chosen = chooser.choose(&cell.fragments);
            let polygon = cell.fragments[chosen].polygon;
            let plane = plane_of[polygon as usize];
            let node = tree.push_node(plane, cell.parent);
            let (mut front, mut back, mut within) = (Vec::new(), Vec::new(), Vec::new());
            let cutter = Cutter::new(&tree.planes, plane);
            for (place, fragment) in cell.fragments.into_iter().enumerate() {
                let placing = if place == chosen {
                    Placing::Coplanar
                } else {
                    cutter.place(&fragment)
                };
                match placing {
                    Placing::Front => front.push(fragment),
                    Placing::Back => back.push(fragment),
                    Placing::Coplanar => within.push(fragment),
                    Placing::Spanning => {
                        let support = plane_of[fragment.polygon as usize];
                        let triangle = |t: u32| tree.triangles[t as usize];
                        let [before, behind] = cutter.split(&fragment, support, triangle);
                        front.push(before);
                        back.push(behind);
                        count += 1;
                        tree.splits += 1;
                    }
                }
            }
            within.into_iter().for_each(|f| tree.push_fragment(f));
            push(&mut cells, front, Some((node, true)));
            push(&mut cells, back, Some((node, false)));
        }
        tree.number_pieces();
        tree
    }

    /// Gives the pieces of a polygon their letters: what is behind a plane comes before what is in front.
    fn number_pieces(&mut self) {
        let mut order = Vec::with_capacity(self.fragments.len());
        self.in_order(|node| order.extend(self.nodes[node as usize].fragments()));
        let mut counts: HashMap<u32, u32> = HashMap::new();
        for fragment in &self.fragments {
            *counts.entry(fragment.polygon).or_default() += 1;
        }
        let mut next: HashMap<u32, u32> = HashMap::new();
        for fragment in order {
            let fragment = &mut self.fragments[fragment as usize];
            if counts[&fragment.polygon] > 1 {
                let piece = next.entry(fragment.polygon).or_default();
                fragment.piece = Some(*piece);
                *piece += 1;
            }
        }
    }
}
