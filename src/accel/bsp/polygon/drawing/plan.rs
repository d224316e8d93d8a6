//! Walls seen from above: the lines along which a tree divides the plane, and the regions that are left. The lecture's "BSP Trees (4)".
//!
//! Everything stands on one axis: a wall is a segment, a node's plane a line, a cell of space a convex region. What is a wall is decided without
//! rounding; where lines meet is computed in double precision, for a drawing. Model units, u to the right, v upwards, the axis towards the viewer.

use glam::{DVec2, DVec3, Vec3};

use super::super::tree::PolygonBsp;
use super::cells;
use super::half_plane::{HalfPlane, area};
use crate::geometry::Triangle;

/// Nodes of a tree whose regions are drawn. More cannot be read on one sheet.
const MOST_NODES: usize = 200;

/// Free room around the walls, as a share of their extent.
const ROOM: f64 = 0.16;

/// How often the drawing is widened, by how much, to show a region that lies further off.
const WIDENED: (u32, f64) = (6, 1.3);

/// Why the regions of a tree cannot be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanFault {
    /// There is nothing to draw.
    #[error("there are no polygons")]
    Empty,
    /// The tree is too large for a sheet.
    #[error("the tree has {nodes} nodes, and the regions of up to {MOST_NODES} can be drawn")]
    TooLarge {
        /// Its nodes.
        nodes: usize,
    },
    /// A polygon does not stand on the axis on which most of the others stand.
    #[error("is not parallel to the {axis} axis, and regions are drawn of walls that all are")]
    NoWall {
        /// Its number.
        polygon: u32,
        /// The axis: `x`, `y` or `z`.
        axis: char,
    },
    /// The build's limits left polygons of a cell undivided.
    #[error("the tree has a cell of {fragments} fragments that is not divided")]
    Undivided {
        /// Their number.
        fragments: usize,
    },
}

/// A convex region of the plane, which nothing divides further.
pub(super) struct Region {
    /// Its number, from behind to in front.
    pub(super) cell: u32,
    /// Counter-clockwise. Empty if it lies beyond the frame.
    pub(super) corners: Vec<DVec2>,
}

/// The part of a wall in one node.
pub(super) struct Wall {
    pub(super) from: DVec2,
    pub(super) to: DVec2,
    /// Towards its front; unit length.
    pub(super) normal: DVec2,
    /// Numbers of the fragments that lie there, above one another.
    pub(super) fragments: Vec<u32>,
}

/// Walls and regions.
pub(super) struct Plan {
    /// Corners of what is shown.
    pub(super) frame: [DVec2; 2],
    pub(super) regions: Vec<Region>,
    /// Where a node's line divides its cell.
    pub(super) cuts: Vec<[DVec2; 2]>,
    pub(super) walls: Vec<Wall>,
}

/// The axis on which walls stand, and the plane across it.
#[derive(Clone, Copy)]
struct Axis {
    name: char,
    up: Vec3,
    u: DVec3,
    v: DVec3,
}

impl Axis {
    /// In the order in which they are tried. Seen from above, x goes to the right where it can.
    const ALL: [Self; 3] = [
        Self {
            name: 'z',
            up: Vec3::Z,
            u: DVec3::X,
            v: DVec3::Y,
        },
        Self {
            name: 'y',
            up: Vec3::Y,
            u: DVec3::X,
            v: DVec3::NEG_Z,
        },
        Self {
            name: 'x',
            up: Vec3::X,
            u: DVec3::Y,
            v: DVec3::Z,
        },
    ];

    fn across(&self, p: DVec3) -> DVec2 {
        DVec2::new(p.dot(self.u), p.dot(self.v))
    }

    /// Whether the plane through three points holds the axis's direction: seen along it, they lie on a line.
    fn lies_in(&self, points: &[Vec3; 3]) -> bool {
        let [a, b, c] = points.map(|p| p * (Vec3::ONE - self.up));
        Triangle::new(a, b, c).is_degenerate()
    }
}

impl Plan {
    pub(super) fn of(tree: &PolygonBsp) -> Result<Self, PlanFault> {
        let nodes = tree.nodes.len();
        if nodes == 0 {
            return Err(PlanFault::Empty);
        }
        let axis = axis_of(tree)?;
        if nodes > MOST_NODES {
            return Err(PlanFault::TooLarge { nodes });
        }
        if let Some(cell) = tree.nodes.iter().find(|n| n.plane().is_none()) {
            let fragments = cell.fragments().len();
            return Err(PlanFault::Undivided { fragments });
        }
        let walls = walls(tree, axis);
        let ends = || walls.iter().flat_map(|w| [w.from, w.to]);
        let min = ends().fold(DVec2::INFINITY, DVec2::min);
        let max = ends().fold(DVec2::NEG_INFINITY, DVec2::max);
        let (middle, room) = (
            (min + max) / 2.0,
            DVec2::splat(ROOM * (max - min).max_element()),
        );
        let mut half_size = (max - min) / 2.0 + room;
        let mut plan = Self {
            frame: [DVec2::ZERO; 2],
            regions: Vec::new(),
            cuts: Vec::new(),
            walls,
        };
        for _ in 0..WIDENED.0 {
            plan.frame = [middle - half_size, middle + half_size];
            plan.divide(tree, axis);
            if plan.regions.iter().all(|r| !r.corners.is_empty()) {
                break;
            }
            half_size *= WIDENED.1;
        }
        Ok(plan)
    }

    /// Divides the frame by the planes of the nodes.
    fn divide(&mut self, tree: &PolygonBsp, axis: Axis) {
        self.regions.clear();
        self.cuts.clear();
        let cells = cells(tree);
        let [min, max] = self.frame;
        let corners = vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        let least_area = 1e-9 * (max - min).element_product();
        let mut stack = vec![(0, corners)];
        while let Some((number, corners)) = stack.pop() {
            let node = &tree.nodes[number as usize];
            let Some(plane) = node.plane() else { continue };
            let plane = tree.plane(plane);
            let normal = axis.across(plane.normal().0);
            let front = HalfPlane {
                through: axis.across(plane.points()[0].as_dvec3()),
                normal,
            };
            let back = HalfPlane {
                normal: -normal,
                ..front
            };
            let (_, crossings) = front.clip(&corners);
            if let [from, to] = crossings[..] {
                self.cuts.push([from, to]);
            }
            for (half, child, is_front) in [(front, node.front(), true), (back, node.back(), false)]
            {
                let (mut part, _) = half.clip(&corners);
                if area(&part) < least_area {
                    part.clear();
                }
                match (child, cells.get(&(number, is_front))) {
                    (Some(child), _) => stack.push((child, part)),
                    (None, Some(&cell)) => self.regions.push(Region {
                        cell,
                        corners: part,
                    }),
                    (None, None) => {}
                }
            }
        }
        self.regions.sort_by_key(|r| r.cell);
    }
}

/// The axis on which all polygons stand.
fn axis_of(tree: &PolygonBsp) -> Result<Axis, PlanFault> {
    let misfits = |axis: &Axis| -> Vec<u32> {
        let numbered = (0..).zip(&tree.polygons);
        let misfit = numbered.filter(|(_, p)| !axis.lies_in(tree.plane(p.plane).points()));
        misfit.map(|(number, _)| number).collect()
    };
    let found = Axis::ALL.map(|axis| (misfits(&axis), axis));
    // The first of the best.
    let best = found.iter().min_by_key(|(misfits, _)| misfits.len());
    let (misfits, axis) = best.ok_or(PlanFault::Empty)?;
    match misfits.first() {
        None => Ok(*axis),
        Some(&polygon) => Err(PlanFault::NoWall {
            polygon,
            axis: axis.name,
        }),
    }
}

/// The walls; those of one node that have the same ends are one.
fn walls(tree: &PolygonBsp, axis: Axis) -> Vec<Wall> {
    let mut walls: Vec<Wall> = Vec::new();
    for node in &tree.nodes {
        let first = walls.len();
        for fragment in node.fragments() {
            let shape = &tree.fragments[fragment as usize];
            let plane = tree.plane(tree.polygons[shape.polygon as usize].plane);
            let normal = axis.across(plane.normal().0).normalize_or_zero();
            let along = normal.perp();
            let mut points: Vec<DVec2> = shape
                .corners()
                .map(|c| axis.across(c.position.point))
                .collect();
            points.sort_by(|p, q| f64::total_cmp(&p.dot(along), &q.dot(along)));
            let (Some(&from), Some(&to)) = (points.first(), points.last()) else {
                continue;
            };
            let slack = 1e-9 * from.distance(to);
            let is_same = |w: &&mut Wall| {
                let ends = w.from.distance(from).max(w.to.distance(to));
                ends <= slack && w.normal.dot(normal) > 0.0
            };
            match walls[first..].iter_mut().find(is_same) {
                Some(wall) => wall.fragments.push(fragment),
                None => walls.push(Wall {
                    from,
                    to,
                    normal,
                    fragments: vec![fragment],
                }),
            }
        }
    }
    walls
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BspOrder, BuildOptions};

    /// Walls over the sides of a polygon in the plane, which stand on the axis that `to_space` makes of the third coordinate.
    fn room(corners: &[[f32; 2]], to_space: impl Fn(Vec3) -> Vec3) -> PolygonBsp {
        let mut triangles = Vec::new();
        for (i, p) in corners.iter().enumerate() {
            let q = corners[(i + 1) % corners.len()];
            let at = |p: [f32; 2], h| to_space(Vec3::new(p[0], p[1], h));
            // Two triangles of different heights, the second within the first's width.
            triangles.push(Triangle::new(at(*p, 0.0), at(q, 0.0), at(q, 2.0)));
            triangles.push(Triangle::new(at(*p, 3.0), at(*p, 1.0), at(q, 5.0)));
        }
        let options = BuildOptions {
            order: BspOrder::File,
            ..BuildOptions::default()
        };
        PolygonBsp::build(triangles, &[], &options)
    }

    const CORNERS: [[f32; 2]; 4] = [[0.0, 0.0], [3.0, 0.5], [2.5, 2.0], [-0.5, 1.5]];

    #[test]
    fn regions_tile_the_frame_whatever_axis_the_walls_stand_on() {
        let turns: [fn(Vec3) -> Vec3; 3] = [
            |p| p,
            |p| Vec3::new(p.x, p.z, -p.y),
            |p| Vec3::new(p.z, p.x, p.y),
        ];
        let mut frames = Vec::new();
        for turn in turns {
            let plan = Plan::of(&room(&CORNERS, turn)).unwrap();
            let [min, max] = plan.frame;
            let sum: f64 = plan.regions.iter().map(|r| area(&r.corners)).sum();
            assert!((sum - (max - min).element_product()).abs() < 1e-9);
            // Inside, and one beyond each wall; both triangles of a wall are one.
            assert_eq!(
                (plan.regions.len(), plan.walls.len(), plan.cuts.len()),
                (5, 4, 4)
            );
            assert!(plan.walls.iter().all(|w| w.fragments.len() == 2));
            let inside = DVec2::new(1.2, 1.0);
            for wall in &plan.walls {
                assert!(wall.normal.dot(inside - wall.from) < 0.0);
            }
            frames.push(plan.frame);
        }
        assert!(frames.windows(2).all(|f| f[0] == f[1]), "{frames:?}");
    }

    #[test]
    fn a_wall_that_leans_by_the_least_is_none() {
        let lean = |p: Vec3| {
            if p.z != 2.0 {
                p
            } else {
                Vec3::new(p.x.next_up(), p.y, p.z)
            }
        };
        let fault = Plan::of(&room(&CORNERS, lean)).err();
        assert_eq!(
            fault,
            Some(PlanFault::NoWall {
                polygon: 0,
                axis: 'z'
            })
        );
        assert_eq!(
            Plan::of(&PolygonBsp::default()).err(),
            Some(PlanFault::Empty)
        );
    }
}
