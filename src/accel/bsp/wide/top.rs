//! The level above meshes, through nodes of the wide tree: the extents of placed sets of triangles.
//!
//! In world space. A ray taken to an instance's object space is rounded there and passes beside its world-space line; the extents are
//! grown by as much ([`Placement::margin`]).

use glam::Vec3;

use super::build::{Builder, Corners, Plan, Rest};
use super::collapse::{self, Ends};
use super::fragment::{Extent, Fragment};
use super::node::Word;
use super::simd::{self, Instructions, Tree};
use super::store::{Draft, Store};
use super::walk::Reach;
use crate::accel::bake::Placement;
use crate::accel::counters::{BuildStats, Counter};
use crate::accel::instances::Top;
use crate::accel::normalized::NormalizedSpace;
use crate::geometry::tolerance::INSTANCE_FAR;
use crate::geometry::{Aabb, Ray};

/// A wide tree over placements.
pub(in crate::accel) struct WideTop {
    space: NormalizedSpace,
    store: Store,
    /// Nothing without placements.
    root: Option<Word>,
    reach: Reach,
    depth: u32,
    /// Placements that every ray visits.
    always: Vec<u32>,
    count: u32,
    instructions: Instructions,
}

/// Largest margin of an extent in the tree, in units of half the scene's largest extent: more would help nobody. Only instances with a
/// very uneven scale, or very far from their own origin, have more.
const LARGEST_MARGIN: f64 = 1.0;

/// Leaves of the numbers of placements.
struct Numbers;

impl Ends for Numbers {
    fn leaf(&self, members: &[u32], draft: &mut Draft) -> Word {
        draft.push_numbers(members)
    }

    fn later(&self, _: Rest, _: u32, _: &mut Draft) -> Word {
        unreachable!("the tree over placements is built at once")
    }
}

impl WideTop {
    pub(in crate::accel) fn build(placements: &[Placement]) -> Self {
        let bounds = placements
            .iter()
            .fold(Aabb::EMPTY, |b, p| b.union(p.bounds));
        let space = NormalizedSpace::around(&bounds);
        let (mut fragments, mut always) = (Vec::new(), Vec::new());
        for (number, placement) in placements.iter().enumerate() {
            let margin = placement.margin(&space);
            if space.length(margin) <= LARGEST_MARGIN {
                let extent = grown(&placement.bounds, margin);
                fragments.push(Fragment::new(extent, number as u32));
            } else {
                always.push(number as u32);
            }
        }
        let largest = fragments.iter().fold(0.0_f32, |most, f| {
            let Extent { min, max } = f.extent();
            most.max(min.abs().max(max.abs()).truncate().max_element())
        });
        let mut draft = Draft::default();
        let (mut root, mut depth) = (None, 0);
        if !fragments.is_empty() {
            let builder = Builder {
                corners: Corners::Unknown,
                plan: Plan::OF_PLACEMENTS,
                later: None,
                is_shared: true,
            };
            let tree = builder.build(builder.undivided(fragments));
            let (word, levels) = collapse::write(&tree, 0, &Numbers, &mut draft);
            (root, depth) = (Some(word), levels);
        }
        Self {
            space,
            store: draft.finish(),
            root,
            reach: Reach {
                largest,
                axes: None,
            },
            depth,
            always,
            count: placements.len() as u32,
            instructions: Instructions::best(),
        }
    }
}

impl WideTop {
    /// `None` if the ray is not for the walk.
    fn walk<C: Counter>(
        &self,
        ray: &Ray,
        counter: &mut C,
        visit: &mut dyn FnMut(u32, &mut C) -> f32,
    ) -> Option<()> {
        let mut ray = *ray;
        for &placement in &self.always {
            ray.interval.max = visit(placement, counter);
            if ray.interval.is_empty() {
                return Some(());
            }
        }
        let Some(root) = self.root else {
            return Some(());
        };
        let tree = Tree::new(&self.store, root, &self.reach);
        simd::visit(self.instructions, tree, &ray, counter, visit).then_some(())
    }
}

/// The box grown by a margin, rounded outwards.
fn grown(bounds: &Aabb, margin: f64) -> Extent {
    let margin = (margin as f32).next_up();
    let low = |p: Vec3| p.to_array().map(|x| (x - margin).next_down());
    let high = |p: Vec3| p.to_array().map(|x| (x + margin).next_up());
    Extent {
        min: Vec3::from(low(bounds.min)).extend(0.0),
        max: Vec3::from(high(bounds.max)).extend(0.0),
    }
}

impl Top for WideTop {
    fn visit<C: Counter>(
        &self,
        ray: &Ray,
        counter: &mut C,
        mut visit: impl FnMut(u32, &mut C) -> f32,
    ) {
        let distance = self.space.distance(ray.origin.as_dvec3());
        let is_near = self.space.length(distance) <= INSTANCE_FAR;
        if is_near && let Some(walked) = self.walk(ray, counter, &mut visit) {
            return walked;
        }
        for placement in 0..self.count {
            if visit(placement, counter) < ray.interval.min {
                return;
            }
        }
    }

    fn stats(&self) -> BuildStats {
        BuildStats {
            nodes: self.store.nodes.len() as u64,
            depth: self.depth,
            bytes: (self.store.bytes() + size_of_val(&*self.always)) as u64,
            ..BuildStats::default()
        }
    }
}
