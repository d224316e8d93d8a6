//! The level above meshes: which placed sets of triangles a ray visits, and in which space.

use super::bake::{Baked, Placement, TriangleSet};
use super::counters::{BuildStats, Counter, Uncounted};
use super::hit::{Hit, Nearest};
use super::{Trace, TraceSet};
use crate::geometry::Ray;

/// Finds the placements that a ray may hit.
pub(super) trait Top: Send + Sync {
    /// Calls `visit` with the index of every placement that the ray may hit within its interval and within the limit
    /// that the last call returned, in any order. A limit below the interval's beginning ends the search.
    fn visit<C: Counter>(&self, ray: &Ray, counter: &mut C, visit: impl FnMut(u32, &mut C) -> f32);

    /// Its size.
    fn stats(&self) -> BuildStats;
}

/// Every placement, one after the other.
pub(super) struct EveryPlacement(pub(super) u32);

impl Top for EveryPlacement {
    fn visit<C: Counter>(
        &self,
        ray: &Ray,
        counter: &mut C,
        mut visit: impl FnMut(u32, &mut C) -> f32,
    ) {
        for placement in 0..self.0 {
            if visit(placement, counter) < ray.interval.min {
                return;
            }
        }
    }

    fn stats(&self) -> BuildStats {
        BuildStats::default()
    }
}

/// An accelerator: one structure for each set of triangles, one for the placements.
pub(super) struct Instances<S, T> {
    sets: Vec<S>,
    placements: Vec<Placement>,
    top: T,
    /// Of a direction's largest component; with shorter ones every placement is visited.
    least_direction: f64,
    /// There is one set, and it is in world space.
    is_lone: bool,
}

impl<S: TraceSet, T: Top> Instances<S, T> {
    pub(super) fn build(
        baked: Baked,
        build_set: impl FnMut(TriangleSet) -> S,
        build_top: impl Fn(&[Placement]) -> T,
    ) -> Self {
        let top = build_top(&baked.placements);
        Self {
            sets: baked.sets.into_iter().map(build_set).collect(),
            least_direction: baked
                .placements
                .iter()
                .fold(0.0, |least, p| least.max(p.least_direction())),
            is_lone: matches!(&*baked.placements, [only] if only.instance.is_none()),
            placements: baked.placements,
            top,
        }
    }

    /// As [`Top::visit`], for all rays.
    #[inline(always)]
    fn visit<C: Counter>(&self, ray: &Ray, counter: &mut C, visit: impl FnMut(u32, &mut C) -> f32) {
        if f64::from(ray.direction.abs().max_element()) >= self.least_direction {
            self.top.visit(ray, counter, visit);
        } else {
            EveryPlacement(self.placements.len() as u32).visit(ray, counter, visit);
        }
    }

    /// The set that a placement shows, the ray in the space of its triangles, and the instance of its hits.
    fn enter(&self, placement: u32, ray: &Ray) -> Option<(&S, Ray, Option<u32>)> {
        let placement = &self.placements[placement as usize];
        let set = &self.sets[placement.set as usize];
        match &placement.instance {
            None => Some((set, *ray, None)),
            Some(instance) => {
                let ray = instance.object_ray(ray);
                // A scale near the ends of single precision can take a ray out of it.
                ray.is_traceable()
                    .then_some((set, ray, Some(instance.index)))
            }
        }
    }
}

impl<S: TraceSet, T: Top> Trace for Instances<S, T> {
    fn trace_closest<C: Counter>(&self, ray: &Ray, counter: &mut C) -> Option<Hit> {
        if self.is_lone {
            return self.sets[0].closest_alone(ray, counter);
        }
        if !ray.is_traceable() {
            return None;
        }
        let mut nearest = Nearest::of(ray);
        self.visit(ray, counter, |placement, counter| {
            if let Some((set, mut ray, instance)) = self.enter(placement, ray) {
                ray.interval.max = nearest.limit();
                set.closest(&ray, instance, &mut nearest, counter);
            }
            nearest.limit()
        });
        nearest.hit()
    }

    fn trace_any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        if self.is_lone && ray.behind.is_none() {
            return self.sets[0].any_alone(ray, counter);
        }
        if !ray.is_traceable() {
            return false;
        }
        if ray.behind.is_some() {
            // Names matter, which only the search for the nearest hit looks at.
            return self.trace_closest(ray, counter).is_some();
        }
        let mut occluded = false;
        self.visit(ray, counter, |placement, counter| {
            occluded |= self
                .enter(placement, ray)
                .is_some_and(|(set, ray, _)| set.any(&ray, counter));
            if occluded {
                f32::NEG_INFINITY
            } else {
                ray.interval.max
            }
        });
        occluded
    }

    fn trace_closest_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        if self.is_lone {
            return self.sets[0].closest_alone_batch(rays, hits);
        }
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.trace_closest(ray, &mut Uncounted);
        }
    }

    fn trace_any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        if self.is_lone {
            return self.sets[0].any_alone_batch(rays, hits);
        }
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.trace_any(ray, &mut Uncounted);
        }
    }

    fn stats(&self) -> BuildStats {
        let mut stats = self.top.stats();
        self.sets.iter().for_each(|s| stats += s.stats());
        stats.placements += self.placements.len() as u64;
        stats.bytes += size_of_val(&*self.placements) as u64;
        stats
    }
}
