//! Numbers that look like chance and are the same every time: SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).

/// A sequence of numbers.
pub(super) struct Chance(u64);

impl Chance {
    /// A sequence for one part of the scene, so that a change to another part leaves it as it is.
    pub(super) fn new(part: u64) -> Self {
        Self(part)
    }

    /// A number from 0 to 1, 1 not included.
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        // The upper 53 bits are all that a double can hold.
        (z >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number from `low` to `high`.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number from `-most` to `most`.
    pub(super) fn about(&mut self, most: f64) -> f64 {
        self.between(-most, most)
    }

    /// One of `all`.
    pub(super) fn pick<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.unit() * all.len() as f64) as usize]
    }
}
