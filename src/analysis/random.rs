//! Seeded random numbers: SplitMix64 (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014), the same on every machine.

use glam::DVec3;

/// A generator; equal seeds give equal numbers.
pub(super) struct Random(u64);

impl Random {
    /// The generator of one case of a series; cases do not depend on each other's order. `name` is hashed by FNV-1a.
    pub(super) fn new(seed: u64, name: &str, index: u64) -> Self {
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, byte| {
            (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mut scrambled = Self(seed ^ hash ^ index.wrapping_mul(0xd134_2543_de82_ef95));
        Self(scrambled.next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// An integer below `end`, which is not 0.
    pub(super) fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    /// One of the choices.
    pub(super) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A number from 0 to 1, 1 excluded.
    pub(super) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number between -1 and 1.
    pub(super) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// A vector with components between -1 and 1.
    pub(super) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// A vector of length 1.
    pub(super) fn direction(&mut self) -> DVec3 {
        loop {
            let vector = self.vector();
            if (0.01..1.0).contains(&vector.length_squared()) {
                return vector.normalize();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_differ_by_seed_name_and_index_and_repeat() {
        let first = |seed, name, index| Random::new(seed, name, index).next();
        assert_eq!(first(1, "a", 2), first(1, "a", 2));
        let all = [
            first(1, "a", 2),
            first(2, "a", 2),
            first(1, "b", 2),
            first(1, "a", 3),
        ];
        for (i, x) in all.iter().enumerate() {
            assert!(!all[..i].contains(x), "{all:?}");
        }
        let mut random = Random::new(0, "unit", 0);
        let mean = (0..1000).map(|_| random.unit()).sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.03, "{mean}");
        assert!((random.direction().length() - 1.0).abs() < 1e-15);
    }
}
