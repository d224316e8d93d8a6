//! What became of rays at each object and each of its extents: the lecture's three outcomes ("Using Extents (4)").

use super::choice::{ExtentSet, ExtentTest};
use crate::accel::counters::{Counter, TraceCounters};

/// What became of the rays that were tested against one extent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TestTally {
    /// Rays tested.
    pub tested: u64,
    /// Rays that miss the extent, so that the rest of the test is skipped.
    pub rejected: u64,
    /// Rays that reach the extent, and do not hit the object.
    pub false_alarms: u64,
    /// Rays that reach the extent and hit the object.
    pub hits: u64,
    /// Planes of boxes that were looked at.
    pub planes: u64,
}

/// What became of the rays at one object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjectTally {
    /// By test, in the order of [`ExtentTest::ALL`].
    pub tests: [TestTally; ExtentTest::COUNT],
    /// Rays that were taken to object space.
    pub transforms: u64,
    /// Rays that got the full test.
    pub full_tests: u64,
    /// Those of them that hit the object, nearer than anything met before it.
    pub hits: u64,
    /// Steps of the full tests.
    pub steps: TraceCounters,
}

/// Counts for each object of a loop.
#[derive(Clone, Debug, Default)]
pub struct ExtentTally {
    /// In the order of the loop.
    pub objects: Vec<ObjectTally>,
    /// Tests that the current ray passed at the current object.
    passed: ExtentSet,
    current: usize,
}

impl ExtentTally {
    /// For a loop of so many objects.
    pub fn new(objects: usize) -> Self {
        Self {
            objects: vec![ObjectTally::default(); objects],
            ..Self::default()
        }
    }

    /// The sum over all objects.
    pub fn total(&self) -> ObjectTally {
        let mut total = ObjectTally::default();
        for object in &self.objects {
            for (sum, test) in total.tests.iter_mut().zip(&object.tests) {
                sum.tested += test.tested;
                sum.rejected += test.rejected;
                sum.false_alarms += test.false_alarms;
                sum.hits += test.hits;
                sum.planes += test.planes;
            }
            total.transforms += object.transforms;
            total.full_tests += object.full_tests;
            total.hits += object.hits;
            total.steps += object.steps;
        }
        total
    }

    fn settle(&mut self, is_hit: bool) {
        for test in std::mem::take(&mut self.passed).tests() {
            let tally = &mut self.objects[self.current].tests[test.index()];
            *if is_hit {
                &mut tally.hits
            } else {
                &mut tally.false_alarms
            } += 1;
        }
    }
}

impl Counter for ExtentTally {
    const COUNTS: bool = true;

    fn node(&mut self) {
        self.objects[self.current].steps.nodes += 1;
    }

    fn leaf(&mut self) {
        self.objects[self.current].steps.leaves += 1;
    }

    fn primitives(&mut self, count: usize) {
        self.objects[self.current].steps.primitives += count as u64;
    }

    fn extent(&mut self, object: u32, test: ExtentTest, planes: u32, is_admitted: bool) {
        self.current = object as usize;
        let tally = &mut self.objects[self.current].tests[test.index()];
        tally.tested += 1;
        tally.planes += u64::from(planes);
        if is_admitted {
            self.passed = self.passed.with(test);
        } else {
            tally.rejected += 1;
            self.settle(false);
        }
    }

    fn transform(&mut self, object: u32) {
        self.objects[object as usize].transforms += 1;
    }

    fn enter(&mut self, object: u32) {
        self.current = object as usize;
        self.objects[self.current].full_tests += 1;
    }

    fn leave(&mut self, object: u32, is_hit: bool) {
        self.objects[object as usize].hits += u64::from(is_hit);
        self.settle(is_hit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_that_a_later_test_rejects_is_a_false_alarm_of_the_earlier_ones() {
        let mut tally = ExtentTally::new(2);
        let (sphere, bounds) = (ExtentTest::SphereWorld, ExtentTest::BoxWorld);
        tally.extent(1, sphere, 0, true);
        tally.extent(1, bounds, 3, false);
        tally.extent(1, sphere, 0, true);
        tally.extent(1, bounds, 6, true);
        tally.enter(1);
        tally.primitives(12);
        tally.leave(1, true);
        tally.extent(0, sphere, 0, false);
        let total = tally.total();
        let outcome = |t: TestTally| [t.tested, t.rejected, t.false_alarms, t.hits, t.planes];
        assert_eq!(outcome(total.tests[sphere.index()]), [3, 1, 1, 1, 0]);
        assert_eq!(outcome(total.tests[bounds.index()]), [2, 1, 0, 1, 9]);
        assert_eq!(
            (total.full_tests, total.hits, total.steps.primitives),
            (1, 1, 12)
        );
        assert_eq!(tally.objects[0].full_tests, 0);
    }
}
