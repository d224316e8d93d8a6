//! Eight lanes in plain Rust: for machines without wider vectors, and the slow twin that the others are compared with.

use super::kernel;

#[derive(Clone, Copy)]
#[repr(transparent)]
pub(super) struct Lanes([f32; 8]);

impl Lanes {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn bits(f: impl Fn(usize) -> bool) -> u32 {
        (0..8).fold(0, |bits, i| bits | (u32::from(f(i)) << i))
    }
}

impl kernel::Lanes for Lanes {
    #[inline(always)]
    unsafe fn splat(x: f32) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: the trait's promise; an array of floats may be read from wherever a float may.
        Self(unsafe { from.cast::<[f32; 8]>().read() })
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; 8]) {
        *to = self.0;
    }
    #[inline(always)]
    unsafe fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline(always)]
    unsafe fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    unsafe fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    unsafe fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    unsafe fn mul_add(self, factor: Self, summand: Self) -> Self {
        Self(std::array::from_fn(|i| {
            self.0[i] * factor.0[i] + summand.0[i]
        }))
    }
    #[inline(always)]
    unsafe fn neg_mul_add(self, factor: Self, summand: Self) -> Self {
        Self(std::array::from_fn(|i| {
            summand.0[i] - self.0[i] * factor.0[i]
        }))
    }
    #[inline(always)]
    unsafe fn mul_sub(self, factor: Self, less: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] * factor.0[i] - less.0[i]))
    }
    #[inline(always)]
    unsafe fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    unsafe fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    unsafe fn at_most(self, other: Self) -> u32 {
        Self::bits(|i| self.0[i] <= other.0[i])
    }
    #[inline(always)]
    unsafe fn below(self, other: Self) -> u32 {
        Self::bits(|i| self.0[i] < other.0[i])
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }
    #[inline(always)]
    unsafe fn flipped_with(self, other: Self) -> Self {
        self.zip(other, |a, b| if b.is_sign_negative() { -a } else { a })
    }
    #[inline(always)]
    fn fused(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
    #[inline(always)]
    unsafe fn below_and_above(self, low: Self, other: Self, high: Self) -> u32 {
        Self::bits(|i| self.0[i] < low.0[i] && high.0[i] < other.0[i])
    }
    #[inline(always)]
    unsafe fn signs(self) -> u32 {
        Self::bits(|i| self.0[i].is_sign_negative())
    }
    #[inline(always)]
    unsafe fn least(self) -> f32 {
        self.0.into_iter().fold(f32::INFINITY, f32::min)
    }
    #[inline(always)]
    unsafe fn greatest(self) -> f32 {
        self.0.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }
}
