//! Eight lanes of AVX2 and FMA.

use std::arch::x86_64::{_CMP_LE_OQ, _CMP_LT_OQ, _mm256_cmp_ps};

use super::vectors::walks_in_256_bits;

walks_in_256_bits!("avx2,fma,bmi1", {
    #[inline(always)]
    unsafe fn at_most(self, other: Self) -> u32 {
        // SAFETY: the trait's promise.
        (unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) }) as u32
    }
    #[inline(always)]
    unsafe fn below(self, other: Self) -> u32 {
        // SAFETY: the trait's promise.
        (unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) }) as u32
    }
    #[inline(always)]
    unsafe fn below_and_above(self, low: Self, other: Self, high: Self) -> u32 {
        // SAFETY: the trait's promise.
        (unsafe {
            let below = _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, low.0);
            let above = _mm256_cmp_ps::<_CMP_LT_OQ>(high.0, other.0);
            _mm256_movemask_ps(_mm256_and_ps(below, above))
        }) as u32
    }
});
