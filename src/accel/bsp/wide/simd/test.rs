//! The triangle test that a wide tree is walked with: the exact one, or one of those that show what exactness costs.

use super::{Found, Instructions, Occluded, Passed, Tree};
use crate::accel::counters::Counter;
use crate::geometry::{Double, Fast, Ray, RayFrame, TestedRay, Watertight};

/// A triangle test for the leaves of a wide tree.
pub(in crate::accel) trait WideTest: TestedRay {
    /// Whether many rays may walk together; else each goes alone.
    const WALKS_TOGETHER: bool;

    /// As [`closest`](super::closest).
    fn closest<C: Counter>(
        instructions: Instructions,
        tree: Tree<'_>,
        ray: &Ray,
        passed: Passed,
        counter: &mut C,
    ) -> Found;

    /// As [`any`](super::any).
    fn any<C: Counter>(
        instructions: Instructions,
        tree: Tree<'_>,
        ray: &Ray,
        counter: &mut C,
    ) -> Occluded;
}

impl WideTest for RayFrame {
    const WALKS_TOGETHER: bool = true;

    #[inline(always)]
    fn closest<C: Counter>(
        instructions: Instructions,
        tree: Tree<'_>,
        ray: &Ray,
        passed: Passed,
        counter: &mut C,
    ) -> Found {
        super::closest(instructions, tree, ray, passed, counter)
    }

    #[inline(always)]
    fn any<C: Counter>(
        instructions: Instructions,
        tree: Tree<'_>,
        ray: &Ray,
        counter: &mut C,
    ) -> Occluded {
        super::any(instructions, tree, ray, counter)
    }
}

/// The walks of tests in lanes.
macro_rules! walks_tested {
    ($($test:ty),*) => {$(
        impl WideTest for $test {
            const WALKS_TOGETHER: bool = false;

            #[inline(always)]
            fn closest<C: Counter>(
                instructions: Instructions,
                tree: Tree<'_>,
                ray: &Ray,
                passed: Passed,
                counter: &mut C,
            ) -> Found {
                super::closest_tested::<Self, C>(instructions, tree, ray, passed, counter)
            }

            #[inline(always)]
            fn any<C: Counter>(
                instructions: Instructions,
                tree: Tree<'_>,
                ray: &Ray,
                counter: &mut C,
            ) -> Occluded {
                super::any_tested::<Self, C>(instructions, tree, ray, counter)
            }
        }
    )*};
}

walks_tested!(Double, Watertight, Fast);
