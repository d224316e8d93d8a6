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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bsp::wide::Growth;
    use crate::accel::bsp::wide::tests::{rays, set_grown, turned};
    use crate::accel::counters::Uncounted;
    use crate::accel::hit::Nearest;
    use crate::accel::{BspQuality, TraceSet};

    /// The tree and its triangles one by one, by the same test: where their answers are not the same bits, and of how many hits.
    fn compare_with_every_triangle<T: WideTest>(growth: Growth) -> (usize, usize) {
        let tree = set_grown(Some(turned()), BspQuality::Default, growth);
        let mut tree = tree.tested_by::<T>();
        let (mut hits, mut others) = (0, 0);
        for ray in rays() {
            let mut nearest = Nearest::of(&ray);
            if ray.is_traceable() {
                tree.test_everything(&ray, None, &mut nearest, &mut Uncounted);
            }
            let every = nearest.hit();
            hits += usize::from(every.is_some());
            let mut of_portable = None;
            for instructions in Instructions::available().into_iter().rev() {
                tree.instructions = instructions;
                let found = tree.closest_alone(&ray, &mut Uncounted);
                assert_eq!(
                    *of_portable.get_or_insert(found),
                    found,
                    "{instructions:?} {ray:?}"
                );
                let is_hit = tree.any_alone(&ray, &mut Uncounted);
                assert_eq!(is_hit, found.is_some(), "{instructions:?} {ray:?}");
                let (mut batch, mut flags) = ([None], [!is_hit]);
                tree.closest_alone_batch(&[ray], &mut batch);
                tree.any_alone_batch(&[ray], &mut flags);
                assert_eq!((batch, flags), ([found], [is_hit]));
            }
            others += usize::from(of_portable.flatten() != every);
        }
        (others, hits)
    }

    #[test]
    fn other_tests_are_walked_alike_by_all_instructions_and_hit_what_they_hit_without_a_tree() {
        let all = [
            compare_with_every_triangle::<Double>(Growth::Whole),
            compare_with_every_triangle::<Watertight>(Growth::Reached),
            compare_with_every_triangle::<Fast>(Growth::Whole),
        ];
        for (others, hits) in all {
            // What they hit beside a triangle, a tree need not find.
            assert!(
                hits > 2000 && others * 500 < hits,
                "{others} of {hits}: {all:?}"
            );
        }
    }
}
