//! Polygons and their fragments: loops of corners that know what they were cut from.
//!
//! In the space of the triangles. A corner is a point of the input, or where an edge of the input meets a cutting plane, or where two cuts
//! meet on the polygon's own plane; none is ever rounded, only shown rounded ([`Corner::position`]).

use glam::{DVec3, Vec3};

use crate::geometry::exact::{ExactPlane, Point, Position};

/// The line on which an edge lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// Through two points of the input.
    Given([Vec3; 2]),
    /// In the plane of this number, which cut the polygon.
    Cut(u32),
}

/// What a corner is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// A point of the input.
    Given(Vec3),
    /// Where the line through two points of the input meets the plane of this number.
    OnLine([Vec3; 2], u32),
    /// Where the polygon's own plane and those of two cuts meet.
    OfPlanes([u32; 3]),
}

/// A corner of a fragment, and the edge that leads to the next.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// What it is made of.
    pub origin: Origin,
    /// The point rounded, and by how much.
    pub position: Position,
    /// The edge to the next corner of the loop.
    pub edge: Edge,
}

impl Origin {
    pub(super) fn point<'a>(&self, planes: &'a [ExactPlane]) -> Point<'a> {
        match *self {
            Self::Given(p) => Point::Explicit(p),
            Self::OnLine(line, plane) => Point::OnLine {
                line,
                plane: &planes[plane as usize],
            },
            Self::OfPlanes(of) => Point::OfPlanes(of.map(|p| &planes[p as usize])),
        }
    }
}

impl Corner {
    pub(super) fn new(origin: Origin, edge: Edge, planes: &[ExactPlane]) -> Self {
        Self {
            origin,
            position: origin.point(planes).position(),
            edge,
        }
    }
}

/// A closed line of corners, counter-clockwise around what it encloses as its plane's front sees it; clockwise around holes.
pub type Loop = Vec<Corner>;

/// A polygon of the input: a triangle, an n-gon of the file that is exactly planar, or several of these merged.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// Number of the plane in which it lies.
    pub plane: u32,
    /// Numbers of its triangles in the set of triangles from which the tree was built.
    pub triangles: Vec<u32>,
    /// Its outline.
    pub loops: Vec<Loop>,
}

/// What is left of a polygon in one cell of space.
#[derive(Clone, Debug)]
pub struct Fragment {
    /// Number of the polygon.
    pub polygon: u32,
    /// Its outline. Several loops where a concave polygon has come apart, or where it has holes.
    pub loops: Vec<Loop>,
    /// Numbers of those of the polygon's triangles that have a point in the cell.
    pub triangles: Vec<u32>,
    /// Which of the polygon's fragments it is, as the tree has them from behind to in front; `None` if the polygon is whole.
    pub piece: Option<u32>,
}

impl Fragment {
    /// Area in square units, from rounded corners.
    pub fn area(&self) -> f64 {
        area(&self.loops)
    }

    pub(super) fn corners(&self) -> impl Iterator<Item = &Corner> {
        self.loops.iter().flatten()
    }
}

/// Area enclosed by loops, in square units, from rounded corners.
pub(super) fn area(loops: &[Loop]) -> f64 {
    let Some(origin) = loops.iter().flatten().map(|c| c.position.point).next() else {
        return 0.0;
    };
    let mut sum = DVec3::ZERO;
    for corners in loops {
        let Some(last) = corners.last() else { continue };
        let mut previous = last.position.point - origin;
        for corner in corners {
            let point = corner.position.point - origin;
            sum += previous.cross(point);
            previous = point;
        }
    }
    0.5 * sum.length()
}
