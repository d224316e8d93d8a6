//! Eight lanes in a vector of 256 bits, and the walks compiled for them: all that AVX2 and AVX-512VL have in common.

/// The lanes of a set of instructions and its walks, from the names of its features and from how it compares.
macro_rules! walks_in_256_bits {
    ($features:literal, { $($comparisons:tt)* }) => {
        use std::arch::x86_64::{__m256, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps, _mm256_castps256_ps128, _mm256_div_ps, _mm256_extractf128_ps, _mm256_fmadd_ps, _mm256_fmsub_ps, _mm256_fnmadd_ps, _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps, _mm256_storeu_ps, _mm256_sub_ps, _mm256_xor_ps, _mm_cvtss_f32, _mm_max_ps, _mm_max_ss, _mm_min_ps, _mm_min_ss, _mm_movehdup_ps, _mm_movehl_ps};

        use super::{
            Found, LaneTest, Occluded, Passed, Tree, kernel, single, tested, together_any, together_closest,
        };
        use crate::accel::counters::Counter;
        use crate::geometry::Ray;

        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub(super) struct Lanes(__m256);

        // SAFETY of all blocks: the trait's promise, and for addresses its own.
        impl kernel::Lanes for Lanes {
            $($comparisons)*
            #[inline(always)]
            unsafe fn splat(x: f32) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_set1_ps(x) })
            }
            #[inline(always)]
            unsafe fn load(from: *const f32) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_loadu_ps(from) })
            }
            #[inline(always)]
            unsafe fn store(self, to: &mut [f32; 8]) {
                // SAFETY: the trait's promise.
                unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
            }
            #[inline(always)]
            unsafe fn add(self, other: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_add_ps(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn sub(self, other: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_sub_ps(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn mul(self, other: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_mul_ps(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn div(self, other: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_div_ps(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn mul_add(self, factor: Self, summand: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, summand.0) })
            }
            #[inline(always)]
            unsafe fn neg_mul_add(self, factor: Self, summand: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_fnmadd_ps(self.0, factor.0, summand.0) })
            }
            #[inline(always)]
            unsafe fn mul_sub(self, factor: Self, less: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_fmsub_ps(self.0, factor.0, less.0) })
            }
            #[inline(always)]
            unsafe fn min(self, other: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_min_ps(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn max(self, other: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_max_ps(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn abs(self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
            }
            #[inline(always)]
            unsafe fn flipped_with(self, other: Self) -> Self {
                // SAFETY: the trait's promise.
                Self(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(other.0, _mm256_set1_ps(-0.0))) })
            }
            #[inline(always)]
            #[allow(
                clippy::disallowed_methods,
                reason = "a bound covers either rounding, and this machine has the instruction"
            )]
            fn fused(a: f64, b: f64, c: f64) -> f64 {
                a.mul_add(b, c)
            }
            #[inline(always)]
            unsafe fn signs(self) -> u32 {
                // SAFETY: the trait's promise.
                (unsafe { _mm256_movemask_ps(self.0) }) as u32
            }
            #[inline(always)]
            unsafe fn least(self) -> f32 {
                // SAFETY: the trait's promise.
                unsafe {
                    let (low, high) = (
                        _mm256_castps256_ps128(self.0),
                        _mm256_extractf128_ps::<1>(self.0),
                    );
                    let four = _mm_min_ps(low, high);
                    let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
                    _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
                }
            }
            #[inline(always)]
            unsafe fn greatest(self) -> f32 {
                // SAFETY: the trait's promise.
                unsafe {
                    let (low, high) = (
                        _mm256_castps256_ps128(self.0),
                        _mm256_extractf128_ps::<1>(self.0),
                    );
                    let four = _mm_max_ps(low, high);
                    let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
                    _mm_cvtss_f32(_mm_max_ss(two, _mm_movehdup_ps(two)))
                }
            }
        }

        /// [`single::closest`] with these instructions.
        ///
        /// # Safety
        /// The machine must have them.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest<C: Counter>(
            tree: Tree<'_>,
            ray: &Ray,
            passed: Passed,
            counter: &mut C,
        ) -> Found {
            // SAFETY: the caller's promise.
            unsafe { single::closest::<Lanes, C>(tree, ray, passed, counter) }
        }

        /// [`single::any`] with these instructions.
        ///
        /// # Safety
        /// The machine must have them.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any<C: Counter>(tree: Tree<'_>, ray: &Ray, counter: &mut C) -> Occluded {
            // SAFETY: the caller's promise.
            unsafe { single::any::<Lanes, C>(tree, ray, counter) }
        }

        /// [`tested::closest_tested`] with these instructions.
        ///
        /// # Safety
        /// The machine must have them.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest_tested<T: LaneTest, C: Counter>(
            tree: Tree<'_>,
            ray: &Ray,
            passed: Passed,
            counter: &mut C,
        ) -> Found {
            // SAFETY: the caller's promise.
            unsafe { tested::closest_tested::<Lanes, T, C>(tree, ray, passed, counter) }
        }

        /// [`tested::any_tested`] with these instructions.
        ///
        /// # Safety
        /// The machine must have them.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any_tested<T: LaneTest, C: Counter>(
            tree: Tree<'_>,
            ray: &Ray,
            counter: &mut C,
        ) -> Occluded {
            // SAFETY: the caller's promise.
            unsafe { tested::any_tested::<Lanes, T, C>(tree, ray, counter) }
        }

        /// [`tested::block_tested`] with these instructions.
        ///
        /// # Safety
        /// The machine must have them.
        #[cfg(test)]
        #[target_feature(enable = $features)]
        pub(super) unsafe fn block_tested<T: LaneTest>(
            ray: &Ray,
            block: *const f32,
            count: usize,
        ) -> [Option<u32>; 8] {
            // SAFETY: the caller's promise.
            unsafe { tested::block_tested::<Lanes, T>(ray, block, count) }
        }

        /// [`single::visit`] with these instructions.
        ///
        /// # Safety
        /// The machine must have them.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn visit<C: Counter>(
            tree: Tree<'_>,
            ray: &Ray,
            counter: &mut C,
            visit: &mut dyn FnMut(u32, &mut C) -> f32,
        ) -> bool {
            // SAFETY: the caller's promise.
            unsafe { single::visit::<Lanes, C>(tree, ray, counter, visit) }
        }

        /// [`together_closest::closest_together`] with these instructions.
        ///
        /// # Safety
        /// The machine must have them.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest_together(tree: Tree<'_>, rays: &[Ray], found: &mut [Found]) -> u64 {
            // SAFETY: the caller's promise.
            unsafe { together_closest::closest_together::<Lanes>(tree, rays, found) }
        }

        /// [`together_any::any_together`] with these instructions.
        ///
        /// # Safety
        /// The machine must have them.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any_together(tree: Tree<'_>, rays: &[Ray], hits: &mut [bool]) -> u64 {
            // SAFETY: the caller's promise.
            unsafe { together_any::any_together::<Lanes>(tree, rays, hits) }
        }
    };
}

pub(super) use walks_in_256_bits;
