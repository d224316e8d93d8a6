//! The triangles of an object, under any of the structures that can be had within one, and by any triangle test.

use super::choice::MeshAccelerator;
use crate::accel::bake::TriangleSet;
use crate::accel::bsp::wide::{Growth, WideSet, WideTest};
use crate::accel::bvh::BvhKind;
use crate::accel::bvh_sets::BvhSet;
use crate::accel::counters::{BuildStats, Counter};
use crate::accel::hit::Nearest;
use crate::accel::linear::LinearSet;
use crate::accel::{BuildOptions, TraceSet};
use crate::geometry::{Double, Fast, Ray, RayFrame, TriangleTest, Watertight};

/// A set of triangles under one of the structures, tested by `T`.
pub(super) enum Under<T> {
    Linear(LinearSet<T>),
    Wide(Box<WideSet<T>>),
    Bvh(Box<BvhSet<T>>),
}

/// A set of triangles under one of the structures, by one of the tests.
pub(super) enum MeshSet {
    Exact(Under<RayFrame>),
    Double(Under<Double>),
    Watertight(Under<Watertight>),
    Fast(Under<Fast>),
}

impl<T: WideTest> Under<T> {
    fn build(set: TriangleSet, options: &BuildOptions) -> Self {
        match options.mesh {
            MeshAccelerator::Linear => Self::Linear(LinearSet::new(set)),
            MeshAccelerator::Bsp => {
                Self::Wide(Box::new(WideSet::build(set, options, Growth::Whole)))
            }
            MeshAccelerator::Bvh2 => Self::Bvh(Box::new(BvhSet::build(set, BvhKind::Binary))),
            MeshAccelerator::Cwbvh => Self::Bvh(Box::new(BvhSet::build(set, BvhKind::Wide))),
        }
    }
}

impl MeshSet {
    pub(super) fn build(set: TriangleSet, options: &BuildOptions) -> Self {
        match options.test {
            TriangleTest::Exact => Self::Exact(Under::build(set, options)),
            TriangleTest::Double => Self::Double(Under::build(set, options)),
            TriangleTest::Watertight => Self::Watertight(Under::build(set, options)),
            TriangleTest::Fast => Self::Fast(Under::build(set, options)),
        }
    }
}

/// Asks what is in an enumeration's variants, whichever it is.
macro_rules! of_each {
    ($value:expr, $($variant:ident)|+, $set:ident => $asked:expr) => {
        match $value {
            $(Self::$variant($set) => $asked,)+
        }
    };
}

impl<T: WideTest> TraceSet for Under<T> {
    #[inline]
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        of_each!(self, Linear | Wide | Bvh, set => set.closest(ray, instance, nearest, counter));
    }

    #[inline]
    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        of_each!(self, Linear | Wide | Bvh, set => set.any(ray, counter))
    }

    fn stats(&self) -> BuildStats {
        of_each!(self, Linear | Wide | Bvh, set => set.stats())
    }
}

impl TraceSet for MeshSet {
    #[inline]
    fn closest<C: Counter>(
        &self,
        ray: &Ray,
        instance: Option<u32>,
        nearest: &mut Nearest,
        counter: &mut C,
    ) {
        of_each!(
            self, Exact | Double | Watertight | Fast,
            set => set.closest(ray, instance, nearest, counter)
        );
    }

    #[inline]
    fn any<C: Counter>(&self, ray: &Ray, counter: &mut C) -> bool {
        of_each!(self, Exact | Double | Watertight | Fast, set => set.any(ray, counter))
    }

    fn stats(&self) -> BuildStats {
        of_each!(self, Exact | Double | Watertight | Fast, set => set.stats())
    }
}
