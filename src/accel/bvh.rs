//! The independent baseline: obvhs's trees, with our boxes and our triangle test. The only file that names obvhs.
//!
//! Here are the trees over boxes; `bvh_sets` puts triangles and placements into them. What is guarded against, all measured in
//! obvhs 0.4.0: recursion while building (a thread with a large stack), traversal stacks that overwrite themselves when
//! full (the tree's depth is measured, and chooses the stack), and what `normalized` and `bvh_sets` tell.

use std::time::Duration;

use glam::{UVec2, Vec3A};
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::faststack::FastStack;
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::{BvhBuildParams, fast_stack, traverse};

use super::counters::{BuildStats, Counter};
use super::normalized::NormalizedRay;
use crate::geometry::Aabb;
use crate::geometry::tolerance::BVH_PADDING;

/// Which of obvhs's trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BvhKind {
    Binary,
    Wide,
}

/// Entries that the wide tree's fixed traversal stack holds. One is pushed a level at most.
const WIDE_STACK: u32 = 32;

/// Stacks to try for the thread that builds: obvhs recurses as deep as the tree, which hostile input makes as deep as it is
/// long. The smaller one is for machines that do not lend the larger.
const BUILD_STACKS: [usize; 2] = [1 << 30, 1 << 26];

/// Primitives a leaf of the wide tree: the most that its format holds.
const WIDE_LEAF: u32 = 3;

/// Greatest growth of a box while the tree is built, as a share of its size.
const BUILD_GROWTH: f32 = 0.03;

/// Preset of the build: within 6 % of the speed of obvhs's best, at an eighth of its build time.
const PRESET: BvhBuildParams = BvhBuildParams::medium_build();

enum Tree {
    Binary(Bvh2),
    Wide(CwBvh),
}

/// A tree over boxes, and the order in which it wants what is in them.
pub(super) struct BoxTree {
    tree: Tree,
    depth: u32,
}

impl BoxTree {
    /// Builds over boxes in normalised space. Returns the tree and, for each of its entries, the box's index.
    pub(super) fn build(boxes: &[Aabb], kind: BvhKind) -> (Self, Vec<u32>) {
        let boxes: Vec<obvhs::aabb::Aabb> = boxes
            .iter()
            .map(|b| obvhs::aabb::Aabb::new(Vec3A::from(b.min), Vec3A::from(b.max)))
            .collect();
        let build = || {
            if kind == BvhKind::Wide {
                let single = BvhBuildParams {
                    max_prims_per_leaf: 1,
                    ..PRESET
                };
                let wide = bvh2_to_cwbvh(&build_binary(&boxes, single), WIDE_LEAF, true, false);
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
                // Only boxes one within the other make so deep a tree; the binary one has a stack for it.
            }
            let binary = build_binary(&boxes, PRESET);
            let (depth, order) = (
                binary.max_depth as u32 - 1,
                binary.primitive_indices.clone(),
            );
            (
                Self {
                    tree: Tree::Binary(binary),
                    depth,
                },
                order,
            )
        };
        std::thread::scope(|scope| {
            let spawned = BUILD_STACKS.iter().find_map(|&size| {
                std::thread::Builder::new()
                    .stack_size(size)
                    .spawn_scoped(scope, build)
                    .ok()
            });
            match spawned {
                Some(thread) => thread
                    .join()
                    .expect("building a tree over finite boxes does not fail"),
                None => build(),
            }
        })
    }

    /// Calls `visit` with each entry whose box the ray enters before the limit that the last call returned; a negative
    /// limit ends the walk.
    #[inline]
    pub(super) fn walk<C: Counter>(
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

    pub(super) fn stats(&self) -> BuildStats {
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

/// Builds the binary tree in a time that does not depend on how alike the boxes are.
///
/// obvhs joins the pairs of boxes that prefer each other. In rows, ribbons and fans of triangles all prefer the same side, so
/// that few pairs come about in a pass, and the build is quadratic (a row of 20,000 equal triangles: 10 s; a ribbon of
/// 80,000: 46 s). So each box is grown by a share that looks random, the tree is built, and the boxes are put
/// back to their size (the row: 0.03 s, the ribbon: 0.1 s).
fn build_binary(boxes: &[obvhs::aabb::Aabb], params: BvhBuildParams) -> Bvh2 {
    let grown: Vec<_> = boxes
        .iter()
        .zip(0_u32..)
        .map(|(b, index)| {
            // A multiplicative hash (Knuth, The Art of Computer Programming 3, 6.4) of the index, as a share of 1.
            let share = (index.wrapping_mul(2_654_435_769) >> 8) as f32 / (1 << 24) as f32;
            let growth = (b.diagonal() * BUILD_GROWTH + BVH_PADDING) * share;
            obvhs::aabb::Aabb::new(b.min - growth, b.max + growth)
        })
        .collect();
    let mut tree = build_bvh2(&grown, params, &mut Duration::default());
    tree.max_depth = binary_depth(&tree) as usize + 1;
    for node in tree.nodes.iter_mut().filter(|node| node.is_leaf()) {
        let entries =
            &tree.primitive_indices[node.first_index as usize..][..node.prim_count as usize];
        let union = entries
            .iter()
            .map(|&e| boxes[e as usize])
            .reduce(|a, b| a.union(&b));
        node.set_aabb(union.unwrap_or(*node.aabb()));
    }
    tree.refit_all();
    tree
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
    let enters = |node: &Bvh2Node, ray: &ObvhsRay| node.aabb().intersect_ray(ray) < ray.tmax;
    let Some(root) = bvh.nodes.first().filter(|root| enters(root, &ray)) else {
        return;
    };
    if root.is_leaf() {
        visit_leaf(root, &mut ray, counter, &mut visit);
        return;
    }
    fast_stack!(u32, (96, 192), bvh.max_depth, stack, {
        stack.push(root.first_index);
        while let Some(first) = stack.pop() {
            counter.node();
            let mut children = [0, 1].map(|i| {
                let child = &bvh.nodes[first as usize + i];
                (child.aabb().intersect_ray(&ray), child)
            });
            if children[0].0 > children[1].0 {
                children.swap(0, 1);
            }
            // Leaves are tested before anything is entered, the nearer child first.
            let mut inner = [None; 2];
            for ((entry, child), inner) in children.into_iter().zip(&mut inner) {
                if entry < ray.tmax {
                    if !child.is_leaf() {
                        *inner = Some(child.first_index);
                    } else if !visit_leaf(child, &mut ray, counter, &mut visit) {
                        return;
                    }
                }
            }
            inner
                .into_iter()
                .rev()
                .flatten()
                .for_each(|first| stack.push(first));
        }
    });
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
