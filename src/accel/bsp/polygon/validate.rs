//! What must be true of every tree, checked without rounding where it can be.

use super::fragment::{Fragment, area};
use super::split::{Cutter, Placing};
use super::tree::PolygonBsp;
use crate::geometry::tolerance::TILING_AREA;

/// What is wrong with a tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TreeFault {
    /// A fragment lies on the wrong side of a node above it.
    #[error("fragment {fragment} is {found:?} to the plane of node {ancestor} above it, on whose {} it hangs", if *.in_front { "front" } else { "back" })]
    Side {
        /// Its number.
        fragment: u32,
        /// The node.
        ancestor: u32,
        /// Where it should be.
        in_front: bool,
        /// Where it is.
        found: Placing,
    },
    /// A fragment of a node does not lie in its plane.
    #[error("fragment {fragment} is {found:?} to the plane of its own node {node}")]
    OffPlane {
        /// Its number.
        fragment: u32,
        /// The node.
        node: u32,
        /// Where it is.
        found: Placing,
    },
    /// The areas of a polygon's fragments do not sum to its own.
    #[error("the fragments of polygon {polygon} have an area of {fragments}, the polygon {whole}")]
    Area {
        /// Its number.
        polygon: u32,
        /// Its area, square units.
        whole: f64,
        /// The sum.
        fragments: f64,
    },
    /// A polygon has two fragments in one cell: they might overlap.
    #[error("polygon {polygon} is twice in node {node}")]
    Twice {
        /// Its number.
        polygon: u32,
        /// The node.
        node: u32,
    },
}

impl PolygonBsp {
    /// Checks that every fragment lies on its side of every node above it, without rounding; and that the fragments of each polygon tile it: their areas
    /// sum to its own, and no two are in one cell, so that a plane lies between any two.
    ///
    /// Takes as many exact questions as the tree has corners times nodes above them.
    pub fn validate(&self) -> Result<(), TreeFault> {
        let mut parents = vec![None; self.nodes.len()];
        for (number, node) in (0..).zip(&self.nodes) {
            for (child, in_front) in [(node.front(), true), (node.back(), false)] {
                if let Some(child) = child {
                    parents[child as usize] = Some((number, in_front));
                }
            }
        }
        let mut areas = vec![0.0; self.polygons.len()];
        for (number, node) in (0..).zip(&self.nodes) {
            let mut seen: Vec<u32> = Vec::new();
            for fragment in node.fragments() {
                let shape = &self.fragments[fragment as usize];
                areas[shape.polygon as usize] += shape.area();
                seen.push(shape.polygon);
                self.check_sides(fragment, shape, number, &parents)?;
            }
            seen.sort_unstable();
            if let Some(pair) = seen.windows(2).find(|p| p[0] == p[1]) {
                return Err(TreeFault::Twice {
                    polygon: pair[0],
                    node: number,
                });
            }
        }
        for (polygon, (shape, fragments)) in (0..).zip(self.polygons.iter().zip(areas)) {
            let whole = area(&shape.loops);
            let points = || shape.loops.iter().flatten().map(|c| c.position.point);
            let extent = points().fold(0.0_f64, |most, p| most.max(p.abs().max_element()));
            let longest = points()
                .zip(points().skip(1))
                .fold(0.0_f64, |most, (p, q)| most.max(p.distance(q)));
            if (whole - fragments).abs() > TILING_AREA * (whole + extent * longest) {
                return Err(TreeFault::Area {
                    polygon,
                    whole,
                    fragments,
                });
            }
        }
        Ok(())
    }

    fn check_sides(
        &self,
        fragment: u32,
        shape: &Fragment,
        node: u32,
        parents: &[Option<(u32, bool)>],
    ) -> Result<(), TreeFault> {
        if let Some(plane) = self.nodes[node as usize].plane() {
            let found = Cutter::new(&self.planes, plane).place(shape);
            if found != Placing::Coplanar {
                return Err(TreeFault::OffPlane {
                    fragment,
                    node,
                    found,
                });
            }
        }
        let mut at = node;
        while let Some((ancestor, in_front)) = parents[at as usize] {
            if let Some(plane) = self.nodes[ancestor as usize].plane() {
                let found = Cutter::new(&self.planes, plane).place(shape);
                let wanted = if in_front {
                    Placing::Front
                } else {
                    Placing::Back
                };
                if found != wanted {
                    return Err(TreeFault::Side {
                        fragment,
                        ancestor,
                        in_front,
                        found,
                    });
                }
            }
            at = ancestor;
        }
        Ok(())
    }
}
