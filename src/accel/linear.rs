//! Every triangle, one after the other: the oracle in single precision that all other accelerators must agree with.

use std::marker::PhantomData;

use super::TraceSet;
use super::bake::{NamedTriangle, TriangleSet};
use super::counters::{BuildStats, Counter};
use super::hit::Nearest;
use crate::geometry::{Ray, RayFrame, TestedRay};

/// A set of triangles without any structure.
pub(super) struct LinearSet<T = RayFrame>(TriangleSet, PhantomData<T>);

impl<T> LinearSet<T> {
    pub(super) fn new(set: TriangleSet) -> Self {
        Self(set, PhantomData)
    }
}

impl<T: TestedRay> TraceSet for LinearSet<T> {
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        counter.primitives(self.0.len());
        let ray = T::new(ray);
        for t in &self.0 {
            offer(&ray, t, instance, nearest);
        }
    }

    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        let ray = T::new(ray);
        let hit = self
            .0
            .iter()
            .position(|t| ray.intersect(&t.triangle).is_some());
        counter.primitives(hit.map_or(self.0.len(), |h| h + 1));
        hit.is_some()
    }

    fn stats(&self) -> BuildStats {
        BuildStats {
            triangles: self.0.len() as u64,
            bytes: size_of_val(&*self.0) as u64,
            ..BuildStats::default()
        }
    }
}

/// Tests one triangle and offers its hit, under the instance's name if the set is placed by one.
#[inline]
pub(super) fn offer(
    ray: &impl TestedRay,
    named: &NamedTriangle,
    instance: Option<u32>,
    nearest: &mut Nearest,
) {
    if let Some(t) = ray.intersect(&named.triangle) {
        nearest.offer(t, instance.unwrap_or(named.instance), named.index);
    }
}
