//! Sends rays, counts them by kind, and keeps a record of them when asked to.

use std::ops::AddAssign;

use super::facets::Facets;
use crate::accel::{Accelerator, Hit, TraceCounters};
use crate::geometry::Ray;

/// What a ray is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the eye, also its continuation behind a surface with alpha.
    Eye,
    /// To a light.
    Shadow,
    /// Into the surroundings, for ambient occlusion.
    Ambient,
    /// From a mirror, smooth or rough.
    Reflection,
    /// Through a surface.
    Refraction,
    /// From a matt surface.
    Diffuse,
}

impl RayKind {
    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Eye => "eye",
            Self::Shadow => "shadow",
            Self::Ambient => "ambient",
            Self::Reflection => "reflection",
            Self::Refraction => "refraction",
            Self::Diffuse => "diffuse",
        }
    }
}

/// Rays sent, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye.
    pub eye: u64,
    /// To lights.
    pub shadow: u64,
    /// For ambient occlusion.
    pub ambient: u64,
    /// From mirrors.
    pub reflection: u64,
    /// Through surfaces.
    pub refraction: u64,
    /// From matt surfaces.
    pub diffuse: u64,
}

impl RayCounts {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.eye + self.shadow + self.ambient + self.reflection + self.refraction + self.diffuse
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.eye += other.eye;
        self.shadow += other.shadow;
        self.ambient += other.ambient;
        self.reflection += other.reflection;
        self.refraction += other.refraction;
        self.diffuse += other.diffuse;
    }
}

/// A ray that was sent, and its answer.
#[derive(Clone, Copy, Debug)]
pub struct TracedRay {
    /// What it was for.
    pub kind: RayKind,
    /// The ray.
    pub ray: Ray,
    /// What it met: for rays that only asked whether they meet anything, a hit without a place.
    pub answer: Answer,
}

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// The nearest hit, or none.
    Closest(Option<Hit>),
    /// Whether there is any hit.
    Any(bool),
}

/// A surface that a sample of a pixel met, and the share of the sample that it covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covered {
    /// Index of the scene's instance.
    pub instance: u32,
    /// Index of the scene's material.
    pub material: u32,
    /// Share of the sample, 0 to 1.
    pub share: f32,
}

/// Sends rays to an accelerator, for one stage.
pub struct Tracer<'a> {
    accelerator: &'a dyn Accelerator,
    /// The triangles that were met last: a tracer serves one stage.
    pub(super) facets: Facets,
    /// Rays sent so far.
    pub rays: RayCounts,
    /// Steps of traversal so far, if they are counted.
    pub cost: Option<TraceCounters>,
    /// The rays themselves, if they are recorded.
    pub record: Option<Vec<TracedRay>>,
    /// What covers the sample, in the order in which the eye ray met it, if that is asked for.
    pub covered: Option<Vec<Covered>>,
}

impl<'a> Tracer<'a> {
    /// A tracer that counts the steps of traversal if `counted`, and records nothing.
    pub fn new(accelerator: &'a dyn Accelerator, counted: bool) -> Self {
        let cost = counted.then(TraceCounters::default);
        Self {
            accelerator,
            facets: Facets::default(),
            rays: RayCounts::default(),
            cost,
            record: None,
            covered: None,
        }
    }

    /// Notes, if that is asked for, that a surface covers a share of the sample: integrators say so of every surface that an eye ray meets.
    pub fn cover(&mut self, instance: u32, material: u32, share: f32) {
        if let Some(covered) = &mut self.covered {
            covered.push(Covered {
                instance,
                material,
                share,
            });
        }
    }

    /// The nearest hit.
    pub fn closest(&mut self, ray: &Ray, kind: RayKind) -> Option<Hit> {
        let hit = match &mut self.cost {
            Some(cost) => self.accelerator.closest_hit_counted(ray, cost),
            None => self.accelerator.closest_hit(ray),
        };
        self.note(ray, kind, Answer::Closest(hit));
        hit
    }

    /// The nearest hits of rays of one kind, together; `None` where each has to be traced by itself, since it is counted or recorded.
    pub(super) fn closest_together(
        &mut self,
        rays: &[Ray],
        hits: &mut Vec<Option<Hit>>,
        kind: RayKind,
    ) -> Option<()> {
        if self.cost.is_some() || self.record.is_some() {
            return None;
        }
        // What is in there is written over.
        hits.resize(rays.len(), None);
        self.accelerator.closest_hits(rays, hits);
        *self.count(kind) += rays.len() as u64;
        Some(())
    }

    /// Whether anything is hit, for rays of one kind, together; `None` where each has to be traced by itself, since it is counted or recorded.
    pub(super) fn any_together(
        &mut self,
        rays: &[Ray],
        hits: &mut Vec<bool>,
        kind: RayKind,
    ) -> Option<()> {
        if self.cost.is_some() || self.record.is_some() {
            return None;
        }
        hits.resize(rays.len(), false);
        self.accelerator.any_hits(rays, hits);
        *self.count(kind) += rays.len() as u64;
        Some(())
    }

    /// Whether anything is hit.
    pub fn any(&mut self, ray: &Ray, kind: RayKind) -> bool {
        let hit = match &mut self.cost {
            Some(cost) => self.accelerator.any_hit_counted(ray, cost),
            None => self.accelerator.any_hit(ray),
        };
        self.note(ray, kind, Answer::Any(hit));
        hit
    }

    fn count(&mut self, kind: RayKind) -> &mut u64 {
        match kind {
            RayKind::Eye => &mut self.rays.eye,
            RayKind::Shadow => &mut self.rays.shadow,
            RayKind::Ambient => &mut self.rays.ambient,
            RayKind::Reflection => &mut self.rays.reflection,
            RayKind::Refraction => &mut self.rays.refraction,
            RayKind::Diffuse => &mut self.rays.diffuse,
        }
    }

    fn note(&mut self, ray: &Ray, kind: RayKind, answer: Answer) {
        *self.count(kind) += 1;
        if let Some(record) = &mut self.record {
            record.push(TracedRay {
                kind,
                ray: *ray,
                answer,
            });
        }
    }
}
