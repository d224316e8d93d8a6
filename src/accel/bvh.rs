//! The independent baseline: obvhs's trees, with our boxes and our triangle test. The only file that names obvhs.
//!
//! What is guarded against, all measured in obvhs 0.4.0: absolute epsilons and box tests without a margin
//! (see `normalized`); a negative zero in a direction; ties, whose winner would depend on the build; triangles
//! with one and the same box, whose tree would become a chain as long as their number (they share one entry); recursion while
//! building (a thread with a large stack); traversal stacks that overwrite themselves when full (the tree's depth is measured, and
//! chooses the stack).

use std::collections::HashMap;
use std::time::Duration;

use glam::{UVec2, Vec3A};
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::{BvhBuildParams, fast_stack, traverse};

use super::TraceSet;
use super::bake::{NamedTriangle, Placement, TriangleSet};
use super::counters::{BuildStats, Counter};
use super::hit::Nearest;
use super::instances::Top;
use super::linear::offer;
use super::normalized::{NormalizedRay, NormalizedSpace, Walk};
use crate::geometry::tolerance::{INSTANCE_FAR, instance_margin};
use crate::geometry::{Aabb, Ray, RayFrame};

/// Which of obvhs's trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BvhKind {
    Binary,
    Wide,
}

/// Entries that the wide tree's fixed traversal stack holds. One is pushed a level at most.
const WIDE_STACK: u32 = 32;

/// Stack of the thread that builds: obvhs recurses as deep as the tree, which hostile input makes as deep as it is long.
const BUILD_STACK: usize = 1 << 30;

/// Largest margin of an instance's box in the tree, in normalised units: more would reach out of the ball around the scene
/// to which rays are cut. Only instances with a very uneven scale, or very far from their own origin, have more.
const LARGEST_MARGIN: f64 = 0.0025;

/// Preset of the build: within 6 % of the speed of obvhs's best, at an eighth of its build time.
const PRESET: BvhBuildParams = BvhBuildParams::medium_build();

enum Tree {
    Binary(Bvh2),
    Wide(CwBvh),
}

/// A tree over boxes, and the order in which it wants what is in them.
struct BoxTree {
    tree: Tree,
    depth: u32,
}

impl BoxTree {
    /// Builds over boxes in normalised space. Returns the tree and, for each of its entries, the box's index.
    fn build(boxes: &[Aabb], kind: BvhKind) -> (Self, Vec<u32>) {
        let boxes: Vec<obvhs::aabb::Aabb> = boxes
            .iter()
            .map(|b| obvhs::aabb::Aabb::new(Vec3A::from(b.min), Vec3A::from(b.max)))
            .collect();
        let build = || {
            let binary = build_bvh2(&boxes, PRESET, &mut Duration::default());
            if kind == BvhKind::Wide {
                // Up to three primitives a leaf is the format's limit.
                let wide = bvh2_to_cwbvh(&binary, 3, true, false);
                let depth = wide_depth(&wide);
                if depth < WIDE_STACK {
                    let order = wide.primitive_indices.clone();
                    return (
                        Self {
                            tree: Tree::Wide(wide),
                            depth,
                        },
                        order,
                    );
                }
            }
            let mut binary = binary;
            let depth = binary_depth(&binary);
            binary.max_depth = depth as usize + 1;
            let order = binary.primitive_indices.clone();
            (
                Self {
                    tree: Tree::Binary(binary),
                    depth,
                },
                order,
            )
        };
        std::thread::scope(|scope| {
            std::thread::Builder::new()
                .stack_size(BUILD_STACK)
                .spawn_scoped(scope, build)
                .map(|thread| {
                    thread
                        .join()
                        .expect("building a tree over finite boxes does not fail")
                })
                .unwrap_or_else(|_| build())
        })
    }

    /// Calls `visit` with each entry whose box the ray enters before the limit that the last call returned; a negative
    /// limit ends the walk.
    #[inline]
    fn walk<C: Counter>(
        &self,
        ray: &NormalizedRay,
        limit: f32,
        counter: &mut C,
        visit: impl FnMut(u32, &mut C) -> f32,
    ) {
        let ray = ObvhsRay::new(
            Vec3A::from(ray.origin),
            Vec3A::from(ray.direction),
            0.0,
            limit,
        );
        match &self.tree {
            Tree::Binary(bvh) if C::COUNTS => walk_binary_counted(bvh, ray, counter, visit),
            Tree::Binary(bvh) => walk_binary(bvh, ray, counter, visit),
            Tree::Wide(bvh) => walk_wide(bvh, ray, counter, visit),
        }
    }

    fn stats(&self) -> BuildStats {
        let (nodes, bytes) = match &self.tree {
            Tree::Binary(bvh) => (bvh.nodes.len(), size_of_val(&*bvh.nodes)),
            Tree::Wide(bvh) => (bvh.nodes.len(), size_of_val(&*bvh.nodes)),
        };
        BuildStats {
            nodes: nodes as u64,
            depth: self.depth,
            bytes: bytes as u64,
            ..BuildStats::default()
        }
    }
}

/// Visits the entries of a leaf; `false` ends the walk.
fn visit_leaf<C: Counter>(
    node: &Bvh2Node,
    ray: &mut ObvhsRay,
    counter: &mut C,
    visit: &mut impl FnMut(u32, &mut C) -> f32,
) -> bool {
    counter.leaf();
    for entry in node.first_index..node.first_index + node.prim_count {
        ray.tmax = visit(entry, counter);
        if ray.tmax < 0.0 {
            return false;
        }
    }
    true
}

fn walk_binary<C: Counter>(
    bvh: &Bvh2,
    ray: ObvhsRay,
    counter: &mut C,
    mut visit: impl FnMut(u32, &mut C) -> f32,
) {
    let mut leaf = |node: &Bvh2Node, ray: &mut ObvhsRay, _: &mut RayHit| {
        visit_leaf(node, ray, counter, &mut visit)
    };
    fast_stack!(u32, (96, 192), bvh.max_depth, stack, {
        bvh.ray_traverse_dynamic(&mut stack, ray, &mut RayHit::none(), &mut leaf)
    });
}

/// The same walk in the same order, written out, because obvhs's own does not show its inner nodes.
fn walk_binary_counted<C: Counter>(
    bvh: &Bvh2,
    mut ray: ObvhsRay,
    counter: &mut C,
    mut visit: impl FnMut(u32, &mut C) -> f32,
) {
    let Some(root) = bvh
        .nodes
        .first()
        .filter(|root| root.aabb().intersect_ray(&ray) < ray.tmax)
    else {
        return;
    };
    if root.is_leaf() {
        visit_leaf(root, &mut ray, counter, &mut visit);
        return;
    }
    let mut stack = vec![root];
    while let Some(node) = stack.pop() {
        counter.node();
        let mut children = [0, 1].map(|i| {
            let child = &bvh.nodes[node.first_index as usize + i];
            (child.aabb().intersect_ray(&ray), child)
        });
        if children[0].0 > children[1].0 {
            children.swap(0, 1);
        }
        // Leaves are tested before anything is entered, the nearer child first.
        let bottom = stack.len();
        for (entry, child) in children {
            if entry < ray.tmax {
                if child.is_leaf() {
                    if !visit_leaf(child, &mut ray, counter, &mut visit) {
                        return;
                    }
                } else {
                    stack.insert(bottom, child);
                }
            }
        }
    }
}

fn walk_wide<C: Counter>(
    bvh: &CwBvh,
    mut ray: ObvhsRay,
    counter: &mut C,
    mut visit: impl FnMut(u32, &mut C) -> f32,
) {
    let mut state = bvh.new_traversal(ray.direction);
    if bvh.nodes.is_empty() {
        return;
    }
    let mut node;
    'walk: {
        traverse!(
            bvh,
            node,
            state,
            {
                let hits = node.intersect_ray(&ray, state.oct_inv4);
                counter.node();
                if hits & 0x00ff_ffff != 0 {
                    counter.leaf();
                }
                hits
            },
            {
                ray.tmax = visit(state.primitive_id, counter);
                if ray.tmax < 0.0 {
                    break 'walk;
                }
            }
        );
    }
}

fn binary_depth(bvh: &Bvh2) -> u32 {
    let mut deepest = 0;
    let mut stack = vec![(0_usize, 1_u32)];
    while let Some((index, depth)) = stack.pop() {
        let Some(node) = bvh.nodes.get(index) else {
            continue;
        };
        deepest = deepest.max(depth);
        if !node.is_leaf() {
            let first = node.first_index as usize;
            stack.extend([(first, depth + 1), (first + 1, depth + 1)]);
        }
    }
    deepest
}

fn wide_depth(bvh: &CwBvh) -> u32 {
    let mut deepest = 0;
    let mut stack = vec![(0_u32, 1_u32)];
    while let Some((index, depth)) = stack.pop() {
        let Some(node) = bvh.nodes.get(index as usize) else {
            continue;
        };
        deepest = deepest.max(depth);
        stack.extend((0..node.imask.count_ones()).map(|i| (node.child_base_idx + i, depth + 1)));
    }
    deepest
}

/// A set of triangles under one of obvhs's trees.
pub(super) struct BvhSet {
    space: NormalizedSpace,
    tree: BoxTree,
    /// For each entry of the tree, where its triangles begin; one more for the end.
    first_triangle: Vec<u32>,
    triangles: TriangleSet,
}

impl BvhSet {
    pub(super) fn build(set: TriangleSet, kind: BvhKind) -> Self {
        let bounds = set.iter().flat_map(|t| *t.triangle.corners()).collect();
        let space = NormalizedSpace::around(&bounds);
        // Triangles with the same box share an entry: the two halves of a rectangle, and coincident copies.
        let mut entry_of_box: HashMap<[u32; 6], usize> = HashMap::with_capacity(set.len());
        let mut boxes = Vec::with_capacity(set.len());
        let mut entries: Vec<Vec<u32>> = Vec::with_capacity(set.len());
        for (index, named) in set.iter().enumerate() {
            let tight: Aabb = named.triangle.corners().iter().copied().collect();
            let padded = space.padded(&tight, 0.0);
            let key = [padded.min.to_array(), padded.max.to_array()].concat();
            let key = std::array::from_fn(|i| key[i].to_bits());
            let entry = *entry_of_box.entry(key).or_insert_with(|| {
                boxes.push(padded);
                entries.push(Vec::new());
                boxes.len() - 1
            });
            entries[entry].push(index as u32);
        }
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
        }
    }

    fn entry(&self, entry: u32) -> &[NamedTriangle] {
        let [first, end] = [0, 1].map(|i| self.first_triangle[entry as usize + i] as usize);
        &self.triangles[first..end]
    }
}

impl TraceSet for BvhSet {
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        let frame = RayFrame::new(ray);
        match self.space.walk(ray) {
            Walk::Misses => {}
            Walk::TooFar => {
                counter.primitives(self.triangles.len());
                self.triangles
                    .iter()
                    .for_each(|t| offer(&frame, t, instance, nearest));
            }
            Walk::Through(walk) => {
                let mut limit = walk.limit(nearest.limit());
                self.tree.walk(&walk, limit, counter, |entry, counter| {
                    let triangles = self.entry(entry);
                    counter.primitives(triangles.len());
                    let before = nearest.limit();
                    triangles
                        .iter()
                        .for_each(|t| offer(&frame, t, instance, nearest));
                    if nearest.limit() < before {
                        limit = walk.limit(nearest.limit());
                    }
                    limit
                });
            }
        }
    }

    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        let frame = RayFrame::new(ray);
        let test = |triangles: &[NamedTriangle], counter: &mut C| {
            let hit = triangles
                .iter()
                .position(|t| frame.intersect(&t.triangle).is_some());
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
        let reach = INSTANCE_FAR / space.length(1.0);
        let mut always = Vec::new();
        let (mut boxes, mut order_of_box) = (Vec::new(), Vec::new());
        for (index, placement) in placements.iter().enumerate() {
            let margin = placement.instance.as_ref().map_or(0.0, |i| {
                let norm =
                    |m: glam::DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
                let matrix = norm(i.world_from_object.matrix3);
                let inverse = norm(i.object_from_world.matrix3);
                let offset = space.distance(i.world_from_object.translation);
                instance_margin(matrix, inverse, i.object_radius, reach + offset)
            });
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
