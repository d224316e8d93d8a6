//! Seeded random numbers for tests: SplitMix64 (Steele, Lea, Flood 2014), the same on every machine.

use glam::Vec3;

/// A generator; equal seeds give equal numbers.
pub(crate) struct Random(u64);

impl Random {
    /// The generator of case `index` of a series: cases do not depend on each other's order.
    pub(crate) fn new(seed: u64, index: u64) -> Self {
        let mut scrambled = Self(seed ^ index.wrapping_mul(0xd134_2543_de82_ef95));
        Self(scrambled.next())
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// An integer from `low` to `high`, both included.
    pub(crate) fn integer(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() % (high - low + 1) as u64) as i64
    }

    /// A number from 0 to 1, 1 excluded.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number between -1 and 1.
    pub(crate) fn signed(&mut self) -> f32 {
        (2.0 * self.unit() - 1.0) as f32
    }

    /// A vector with components between -1 and 1.
    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// One of the choices.
    pub(crate) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.next() % choices.len() as u64) as usize]
    }
}
