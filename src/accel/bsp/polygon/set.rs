//! The tree as an accelerator of one set of triangles.

use std::marker::PhantomData;

use super::tree::PolygonBsp;
use super::walk::Walk;
use crate::accel::TraceSet;
use crate::accel::bake::TriangleSet;
use crate::accel::bsp::options::BuildOptions;
use crate::accel::counters::{BuildStats, Counter};
use crate::accel::hit::Nearest;
use crate::accel::names::Names;
use crate::geometry::{Ray, RayFrame, TestedRay, Triangle};

/// A set of triangles under a polygon BSP.
pub(in crate::accel) struct PolygonSet<T = RayFrame> {
    triangles: Vec<Triangle>,
    names: Names,
    walk: Walk,
    nodes: u64,
    depth: u32,
    test: PhantomData<T>,
}

impl<T> PolygonSet<T> {
    /// `outlines` are runs of triangles that were one polygon of the file.
    pub(in crate::accel) fn build(
        set: TriangleSet,
        outlines: &[(u32, u32)],
        options: &BuildOptions,
    ) -> Self {
        let shapes = set.iter().map(|t| t.triangle).collect();
        let tree = PolygonBsp::build(shapes, outlines, options);
        Self {
            names: Names::of(&set),
            nodes: tree.nodes().len() as u64,
            depth: tree.stats().depth,
            walk: Walk::new(&tree),
            triangles: tree.triangles,
            test: PhantomData,
        }
    }
}

impl<T: TestedRay> TraceSet for PolygonSet<T> {
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        let mut tested = T::new(ray);
        self.walk.visit(ray, counter, |run, counter| {
            counter.primitives(run.len());
            for &number in run {
                if let Some(t) = tested.intersect(&self.triangles[number as usize]) {
                    self.names.offer(t, number, instance, nearest);
                }
            }
            tested.set_max(nearest.limit());
            nearest.limit()
        });
    }

    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        let tested = T::new(ray);
        let mut is_hit = false;
        self.walk.visit(ray, counter, |run, counter| {
            let hits = |&t: &u32| tested.intersect(&self.triangles[t as usize]).is_some();
            let hit = run.iter().position(hits);
            counter.primitives(hit.map_or(run.len(), |h| h + 1));
            is_hit = hit.is_some();
            if is_hit {
                f32::NEG_INFINITY
            } else {
                ray.interval.max
            }
        });
        is_hit
    }

    fn stats(&self) -> BuildStats {
        let bytes = self.walk.bytes() + self.names.bytes() + size_of_val(&*self.triangles);
        BuildStats {
            triangles: self.triangles.len() as u64,
            nodes: self.nodes,
            depth: self.depth,
            bytes: bytes as u64,
            ..BuildStats::default()
        }
    }
}
