//! The triangles of an object, under any of the structures that can be had within one.

use super::choice::MeshAccelerator;
use crate::accel::bake::TriangleSet;
use crate::accel::bsp::wide::{Growth, WideSet};
use crate::accel::bvh::BvhKind;
use crate::accel::bvh_sets::BvhSet;
use crate::accel::counters::{BuildStats, Counter};
use crate::accel::hit::Nearest;
use crate::accel::linear::LinearSet;
use crate::accel::{BuildOptions, TraceSet};
use crate::geometry::Ray;

/// A set of triangles under one of the structures.
pub(super) enum MeshSet {
    Linear(LinearSet),
    Wide(Box<WideSet>),
    Bvh(Box<BvhSet>),
}

impl MeshSet {
    pub(super) fn build(set: TriangleSet, options: &BuildOptions) -> Self {
        match options.mesh {
            MeshAccelerator::Linear => Self::Linear(LinearSet::new(set)),
            MeshAccelerator::Bsp => {
                Self::Wide(Box::new(WideSet::build(set, options, Growth::Whole, false)))
            }
            MeshAccelerator::Bvh2 => Self::Bvh(Box::new(BvhSet::build(set, BvhKind::Binary))),
            MeshAccelerator::Cwbvh => Self::Bvh(Box::new(BvhSet::build(set, BvhKind::Wide))),
        }
    }
}

impl TraceSet for MeshSet {
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        match self {
            Self::Linear(set) => set.closest(ray, instance, nearest, counter),
            Self::Wide(set) => set.closest(ray, instance, nearest, counter),
            Self::Bvh(set) => set.closest(ray, instance, nearest, counter),
        }
    }

    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        match self {
            Self::Linear(set) => set.any(ray, counter),
            Self::Wide(set) => set.any(ray, counter),
            Self::Bvh(set) => set.any(ray, counter),
        }
    }

    fn stats(&self) -> BuildStats {
        match self {
            Self::Linear(set) => set.stats(),
            Self::Wide(set) => set.stats(),
            Self::Bvh(set) => set.stats(),
        }
    }
}
