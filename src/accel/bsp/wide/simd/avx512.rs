//! Eight lanes of AVX-512VL: masks in registers of their own.

use std::arch::x86_64::{_CMP_LE_OQ, _CMP_LT_OQ, _mm256_cmp_ps_mask, _mm256_mask_cmp_ps_mask};

use super::vectors::walks_in_256_bits;

walks_in_256_bits!("avx2,fma,bmi1,avx512f,avx512vl", {
    #[inline(always)]
    unsafe fn at_most(self, other: Self) -> u32 {
        // SAFETY: the trait's promise.
        u32::from(unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn below(self, other: Self) -> u32 {
        // SAFETY: the trait's promise.
        u32::from(unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn below_and_above(self, low: Self, other: Self, high: Self) -> u32 {
        // SAFETY: the trait's promise.
        u32::from(unsafe {
            _mm256_mask_cmp_ps_mask::<_CMP_LT_OQ>(
                _mm256_cmp_ps_mask::<_CMP_LT_OQ>(self.0, low.0),
                high.0,
                other.0,
            )
        })
    }
});
