//! Triangles and placements under obvhs's trees, with the guards that a fair baseline needs.
//!
//! obvhs 0.4.0 makes chains of boxes that lie about one point, equal or one within the other (20,000: 12 s and more; 100,000
//! equal ones: it overflows the stack). So equal boxes share an entry of the tree, and entries about one point are bounded. Ties, whose winner would depend on the build, are decided by
//! [`Nearest`]; the walk is kept long enough to see them all.

use std::marker::PhantomData;

use super::TraceSet;
use super::bake::{NamedTriangle, Placement, TriangleSet};
use super::bvh::{BoxTree, BvhKind};
use super::counters::{BuildStats, Counter};
use super::hit::Nearest;
use super::instances::Top;
use super::linear::offer;
use super::normalized::{NormalizedSpace, Walk};
use crate::geometry::tolerance::INSTANCE_FAR;
use crate::geometry::{Aabb, Ray, RayFrame, TestedRay};

/// Largest margin of an instance's box in the tree, in normalised units: more would reach out of the ball around the scene
/// to which rays are cut. Only instances with a very uneven scale, or very far from their own origin, have more.
const LARGEST_MARGIN: f64 = 0.0025;

/// Boxes about one point that the tree gets at most. obvhs takes 0.1 s to build a chain of so many.
const MOST_ABOUT_A_POINT: usize = 1024;

/// Cells a normalised unit, within which centres of boxes count as one point: about what obvhs's Morton codes tell apart.
const CELLS: f32 = 524_288.0;

/// A set of triangles under one of obvhs's trees.
pub(super) struct BvhSet<T = RayFrame> {
    space: NormalizedSpace,
    tree: BoxTree,
    /// For each entry of the tree, where its triangles begin; one more for the end.
    first_triangle: Vec<u32>,
    triangles: TriangleSet,
    test: PhantomData<T>,
}

impl<T> BvhSet<T> {
    pub(super) fn build(set: TriangleSet, kind: BvhKind) -> Self {
        let bounds = set.iter().flat_map(|t| *t.triangle.corners()).collect();
        let space = NormalizedSpace::around(&bounds);
        let (boxes, entries) = entries(&set, &space);
        let (tree, order) = BoxTree::build(&boxes, kind);
        let mut first_triangle = Vec::with_capacity(order.len() + 1);
        let mut triangles = TriangleSet::with_capacity(set.len());
        for entry in order {
            first_triangle.push(triangles.len() as u32);
            triangles.extend(entries[entry as usize].iter().map(|&t| set[t as usize]));
        }
        first_triangle.push(triangles.len() as u32);
        Self {
            space,
            tree,
            first_triangle,
            triangles,
            test: PhantomData,
        }
    }

    /// The triangles of an entry of the tree.
    fn entry(&self, entry: u32) -> &[NamedTriangle] {
        let [first, end] = [0, 1].map(|i| self.first_triangle[entry as usize + i] as usize);
        &self.triangles[first..end]
    }
}

/// Boxes for the tree, and the triangles that each stands for.
///
/// Triangles with the same box share one: the two halves of a rectangle, and coincident copies. Of boxes about one point no
/// more than [`MOST_ABOUT_A_POINT`] are left: further ones are joined with those next in size.
fn entries(set: &TriangleSet, space: &NormalizedSpace) -> (Vec<Aabb>, Vec<Vec<u32>>) {
    let mut sorted: Vec<([i32; 3], [u32; 6], Aabb, u32)> = set
        .iter()
        .enumerate()
        .map(|(index, named)| {
            let padded = space.padded(&named.triangle.bounds(), 0.0);
            let cell = (padded.center() * CELLS).as_ivec3().to_array();
            // Sizes first, so that neighbours in the order are alike.
            let key = [padded.extent().to_array(), padded.min.to_array()].concat();
            (
                cell,
                std::array::from_fn(|i| key[i].to_bits()),
                padded,
                index as u32,
            )
        })
        .collect();
    sorted.sort_unstable_by_key(|&(cell, bits, _, index)| (cell, bits, index));
    let (mut boxes, mut entries) = (Vec::new(), Vec::new());
    for about_a_point in sorted.chunk_by(|a, b| a.0 == b.0) {
        let same_box: Vec<_> = about_a_point.chunk_by(|a, b| a.1 == b.1).collect();
        for joined in same_box.chunks(same_box.len().div_ceil(MOST_ABOUT_A_POINT)) {
            let members = || joined.iter().copied().flatten();
            let bounds = members().fold(Aabb::EMPTY, |b, m| b.union(m.2));
            boxes.push(bounds);
            entries.push(members().map(|m| m.3).collect());
        }
    }
    (boxes, entries)
}

impl<T: TestedRay> TraceSet for BvhSet<T> {
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        let tested = T::new(ray);
        match self.space.walk(ray) {
            Walk::Misses => {}
            Walk::TooFar => {
                counter.primitives(self.triangles.len());
                self.triangles
                    .iter()
                    .for_each(|t| offer(&tested, t, instance, nearest));
            }
            Walk::Through(walk) => {
                let mut limit = walk.limit(nearest.limit());
                self.tree.walk(&walk, limit, counter, |entry, counter| {
                    let triangles = self.entry(entry);
                    counter.primitives(triangles.len());
                    let before = nearest.limit();
                    triangles
                        .iter()
                        .for_each(|t| offer(&tested, t, instance, nearest));
                    if nearest.limit() < before {
                        limit = walk.limit(nearest.limit());
                    }
                    limit
                });
            }
        }
    }

    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        let tested = T::new(ray);
        let test = |triangles: &[NamedTriangle], counter: &mut C| {
            let hit = triangles
                .iter()
                .position(|t| tested.intersect(&t.triangle).is_some());
            counter.primitives(hit.map_or(triangles.len(), |h| h + 1));
            hit.is_some()
        };
        match self.space.walk(ray) {
            Walk::Misses => false,
            Walk::TooFar => test(&self.triangles, counter),
            Walk::Through(walk) => {
                let limit = walk.limit(ray.interval.max);
                let mut occluded = false;
                self.tree.walk(&walk, limit, counter, |entry, counter| {
                    occluded = test(self.entry(entry), counter);
                    if occluded { -1.0 } else { limit }
                });
                occluded
            }
        }
    }

    fn stats(&self) -> BuildStats {
        let mut stats = self.tree.stats();
        stats.triangles = self.triangles.len() as u64;
        stats.bytes += (size_of_val(&*self.triangles) + size_of_val(&*self.first_triangle)) as u64;
        stats
    }
}

/// One of obvhs's trees over the placements.
pub(super) struct BvhTop {
    space: NormalizedSpace,
    tree: BoxTree,
    /// For each entry of the tree, its placement.
    order: Vec<u32>,
    /// Placements that every ray visits: a lone one, and those whose margin would be a large part of the scene.
    always: Vec<u32>,
    count: u32,
}

impl BvhTop {
    pub(super) fn build(placements: &[Placement], kind: BvhKind) -> Self {
        let bounds = placements
            .iter()
            .fold(Aabb::EMPTY, |b, p| b.union(p.bounds));
        let space = NormalizedSpace::around(&bounds);
        let mut always = Vec::new();
        let (mut boxes, mut order_of_box) = (Vec::new(), Vec::new());
        for (index, placement) in placements.iter().enumerate() {
            let margin = placement.margin(&space);
            if placements.len() == 1 || space.length(margin) > LARGEST_MARGIN {
                always.push(index as u32);
            } else {
                boxes.push(space.padded(&placement.bounds, margin));
                order_of_box.push(index as u32);
            }
        }
        let (tree, order) = BoxTree::build(&boxes, kind);
        let order = order
            .into_iter()
            .map(|b| order_of_box[b as usize])
            .collect();
        Self {
            space,
            tree,
            order,
            always,
            count: placements.len() as u32,
        }
    }
}

impl Top for BvhTop {
    fn visit<C: Counter>(
        &self,
        ray: &Ray,
        counter: &mut C,
        mut visit: impl FnMut(u32, &mut C) -> f32,
    ) {
        let distance = self
            .space
            .length(self.space.distance(ray.origin.as_dvec3()));
        let walk = if distance > INSTANCE_FAR {
            Walk::TooFar
        } else {
            self.space.walk(ray)
        };
        if matches!(walk, Walk::TooFar) {
            for placement in 0..self.count {
                if visit(placement, counter) < ray.interval.min {
                    return;
                }
            }
            return;
        }
        let mut limit = ray.interval.max;
        for &placement in &self.always {
            limit = visit(placement, counter);
            if limit < ray.interval.min {
                return;
            }
        }
        let Walk::Through(walk) = walk else { return };
        if self.order.is_empty() {
            return;
        }
        self.tree
            .walk(&walk, walk.limit(limit), counter, |entry, counter| {
                let limit = visit(self.order[entry as usize], counter);
                if limit < ray.interval.min {
                    -1.0
                } else {
                    walk.limit(limit)
                }
            });
    }

    fn stats(&self) -> BuildStats {
        let mut stats = self.tree.stats();
        stats.bytes += (size_of_val(&*self.order) + size_of_val(&*self.always)) as u64;
        stats
    }
}
