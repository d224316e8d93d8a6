//! A part of a cell's fragments that tells where to divide it as well as all of them.

use super::fragment::Fragment;

/// Of twice as many fragments and more, about so many are looked at to choose a plane: five hundred a bin tell it as well as all.
const SAMPLE: usize = 1 << 14;

/// Of many fragments one of every so many, else all.
#[derive(Clone, Copy)]
pub(super) struct Sample<'a> {
    fragments: &'a [Fragment],
    every: usize,
}

impl<'a> Sample<'a> {
    pub(super) fn of(fragments: &'a [Fragment]) -> Self {
        Self {
            fragments,
            every: (fragments.len() / SAMPLE).max(1),
        }
    }

    pub(super) fn count(&self) -> u32 {
        self.fragments.chunks(self.every).len() as u32
    }

    /// One of each run, at a place that looks random (Knuth's multiplicative hash of the run's number): files have rows, of which equal steps might meet one
    /// column only.
    #[inline(always)]
    pub(super) fn for_each(&self, mut visit: impl FnMut(&Fragment)) {
        if self.every == 1 {
            // Most cells are small, and what follows divides for each fragment.
            self.fragments.iter().for_each(visit);
            return;
        }
        for (run, number) in self.fragments.chunks(self.every).zip(0_u32..) {
            let hash = number.wrapping_mul(2_654_435_769) >> 8;
            visit(&run[hash as usize % run.len()]);
        }
    }

    /// How many stand for one.
    pub(super) fn every(&self) -> usize {
        self.every
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment::Extent;
    use super::super::plane::{Choice, Costs, choose_among};
    use super::super::tests::Numbers;
    use super::*;
    use glam::Vec4;

    const COSTS: Costs = Costs {
        step: 0.3,
        leaf: 0.4,
        block: 0.6,
        triangle: 0.02,
    };

    /// Denser towards one end of x, in the order of a grid's rows.
    fn rows() -> Vec<Fragment> {
        let mut numbers = Numbers(3);
        let mut fragments = Vec::new();
        for number in 0..(SAMPLE * 12) as u32 {
            let (row, column) = (number / 256, number % 256);
            let x = {
                let u = column as f32 / 256.0;
                u * u * u
            };
            let at = Vec4::new(x, 0.1 * numbers.next(), row as f32 / 3072.0, 0.0);
            let extent = Extent {
                min: at,
                max: at + Vec4::new(0.004, 0.01, 0.001, 0.0),
            };
            fragments.push(Fragment::new(extent, number));
        }
        fragments
    }

    #[test]
    fn a_choice_among_a_sample_is_about_as_good_as_among_all() {
        let fragments = rows();
        let (mut extent, mut middles) = (Extent::EMPTY, Extent::EMPTY);
        for fragment in &fragments {
            extent.grow(&fragment.extent());
            middles.grow_point(fragment.middle());
        }
        let all = Sample {
            fragments: &fragments,
            every: 1,
        };
        let some = Sample::of(&fragments);
        assert_eq!((some.every, some.count() as usize), (12, SAMPLE));
        for may_split in [false, true] {
            let choice =
                |sample| choose_among(sample, &extent, &middles, &COSTS, 32, may_split).unwrap();
            let (best, found): (Choice, Choice) = (choice(&all), choice(&some));
            assert_eq!((best.axis, best.crossing), (found.axis, found.crossing));
            // Of costs that a sample sees twelve times too small.
            assert!((found.cost * 12.0 / best.cost - 1.0).abs() < 0.05);
            for ((_, best), (_, found)) in best.sides.iter().zip(&found.sides) {
                let found = found * some.every() as u32;
                assert!(best.abs_diff(found) < best / 10, "{best} {found}");
            }
        }
    }

    #[test]
    fn few_fragments_are_all_looked_at() {
        let fragments = &rows()[..SAMPLE + 7];
        let sample = Sample::of(fragments);
        let mut seen = Vec::new();
        sample.for_each(|fragment| seen.push(fragment.triangle()));
        let all: Vec<u32> = fragments.iter().map(Fragment::triangle).collect();
        assert_eq!(seen, all);
        assert_eq!(sample.count() as usize, all.len());
    }
}
