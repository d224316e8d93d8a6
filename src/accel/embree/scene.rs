//! A scene in Embree, asked as any other structure is.

use super::layout::{ForeignRay, NO_GEOMETRY};
use super::library::Committed;
use crate::accel::{Accelerator, BuildStats, Hit, TraceCounters};
use crate::geometry::Ray;

/// All triangles of a scene in Embree. Each instance is a geometry under its own index.
pub struct EmbreeScene {
    committed: Committed,
    triangles: u64,
}

impl EmbreeScene {
    pub(super) fn new(committed: Committed, triangles: u64) -> Self {
        Self {
            committed,
            triangles,
        }
    }

    /// Most bytes that the library had allocated at once for the build; what this program gave it is not among them.
    pub fn peak_bytes(&self) -> u64 {
        self.committed.peak_bytes()
    }

    /// The nearest hit from `near` on.
    fn hit_from(&self, ray: &Ray, near: f32) -> Option<Hit> {
        let found = self.committed.closest(ForeignRay::of(ray, near).for_hit());
        (found.geometry != NO_GEOMETRY).then_some(Hit {
            t: found.ray.far,
            instance: found.geometry,
            triangle: found.triangle,
        })
    }

    /// The nearest hit behind the one of that name at `t`. Of others in the same place Embree tells none: they are passed over.
    fn hit_behind(&self, ray: &Ray, t: f32, name: (u32, u32)) -> Option<Hit> {
        let (mut near, mut step) = (t.next_up(), 1);
        while near <= ray.interval.max {
            let hit = self.hit_from(ray, near)?;
            if hit.t > t || (hit.instance, hit.triangle) > name {
                return Some(hit);
            }
            // Its test rounds, and has found the same place again: further on, by ever more floats.
            step *= 2;
            near = f32::from_bits(near.to_bits().saturating_add(step));
        }
        None
    }
}

/// Where Embree may begin: it takes no negative `t`.
fn near_of(ray: &Ray) -> f32 {
    ray.interval.min.max(0.0)
}

/// Whether it is one that Embree can be asked.
fn is_asked(ray: &Ray) -> bool {
    ray.is_traceable() && ray.interval.max >= 0.0
}

impl Accelerator for EmbreeScene {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        is_asked(ray).then_some(())?;
        match ray.behind {
            Some(name) => self.hit_behind(ray, near_of(ray), name),
            None => self.hit_from(ray, near_of(ray)),
        }
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        if ray.behind.is_some() {
            // Names matter, which only the search for the nearest hit tells.
            return self.closest_hit(ray).is_some();
        }
        is_asked(ray) && self.committed.any(ForeignRay::of(ray, near_of(ray)))
    }

    /// As [`Accelerator::closest_hit`]: Embree tells no steps, and nothing is counted.
    fn closest_hit_counted(&self, ray: &Ray, _counters: &mut TraceCounters) -> Option<Hit> {
        self.closest_hit(ray)
    }

    /// As [`Accelerator::any_hit`]: Embree tells no steps, and nothing is counted.
    fn any_hit_counted(&self, ray: &Ray, _counters: &mut TraceCounters) -> bool {
        self.any_hit(ray)
    }

    /// Triangles and bytes, its buffers among them; nodes and depth are not told, and 0.
    fn build_stats(&self) -> BuildStats {
        BuildStats {
            triangles: self.triangles,
            bytes: self.committed.bytes(),
            ..BuildStats::default()
        }
    }
}
