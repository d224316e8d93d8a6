//! The lecture's cost model ("The Cost Saving"), and the one table of costs that it is used with.
//!
//! Costs are counted, not timed, so that a plan is the same on every run and machine. The unit is a thousandth of a microsecond on the machine where
//! the table was made; only ratios matter.

use super::choice::{ExtentTest, MeshAccelerator};
use crate::accel::counters::TraceCounters;

/// How many times faster rays are with an extent than without, as the lecture predicts it: `m / (1 + f m)`.
///
/// `m` is the cost of the full test in tests of the extent, `f` the share of rays that reach the extent. Below 1, the extent is a loss. It supposes that the full test
/// costs all rays the same: of a tree, those that miss the object leave it after a node.
///
/// ```
/// use bspray::accel::extents::speed_ratio;
/// // The lecture's example: "about 13".
/// assert!((speed_ratio(20.0, 1.0 / 40.0) - 40.0 / 3.0).abs() < 1e-12);
/// ```
pub fn speed_ratio(m: f64, f: f64) -> f64 {
    m / (1.0 + f * m)
}

/// What steps cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostTable {
    /// Comparing a pixel with a screen extent.
    pub screen: f64,
    /// A test of a sphere.
    pub sphere: f64,
    /// A test of a box, without its planes.
    pub bounds: f64,
    /// A plane of a box.
    pub plane: f64,
    /// Taking a ray to object space and making it ready for tests there.
    pub transform: f64,
    /// Taking a ray to object space for a full test alone.
    pub bare_transform: f64,
    /// Beginning a full test.
    pub enter: f64,
    /// An inner node within an object.
    pub node: f64,
    /// A leaf within an object.
    pub leaf: f64,
    /// A ray-triangle test within an object.
    pub primitive: f64,
}

impl CostTable {
    /// The table for objects whose hits are found in this way.
    ///
    /// Found once by least squares (no number negative) over 231 times of `bspray ladder` on lecture-objects, chess-board and SimpleInstancing, with each structure within
    /// objects; rounded. They tell half of these times to within 5 %, all to within 36 %. The costs of steps that always come together, such as a leaf and its triangles, are not told apart, so
    /// that one may have the cost of both. Transformations did not come apart from the beginnings of full tests: theirs are estimated from their operations. Where a number is
    /// wrong, a plan is somewhat worse, and no picture changes.
    pub const fn of(mesh: MeshAccelerator) -> Self {
        let (enter, node, leaf, primitive) = match mesh {
            MeshAccelerator::Linear => (54.0, 0.0, 0.0, 4.8),
            MeshAccelerator::Bsp => (35.0, 0.0, 3.8, 2.6),
            MeshAccelerator::Bvh2 => (50.0, 8.0, 38.0, 0.0),
            MeshAccelerator::Cwbvh => (47.0, 21.0, 0.0, 25.0),
        };
        Self {
            screen: 3.0,
            sphere: 4.8,
            bounds: 1.0,
            plane: 3.3,
            transform: 12.0,
            bare_transform: 8.0,
            enter,
            node,
            leaf,
            primitive,
        }
    }

    /// The cost of the steps of some full tests, their beginnings left out.
    pub fn steps(&self, steps: &TraceCounters) -> f64 {
        self.node * steps.nodes as f64
            + self.leaf * steps.leaves as f64
            + self.primitive * steps.primitives as f64
    }

    /// The cost of a test that looks at so many planes: the lecture's `T`, without the transformation.
    pub fn test(&self, test: ExtentTest, planes: f64) -> f64 {
        match test {
            ExtentTest::Screen => self.screen,
            ExtentTest::SphereWorld | ExtentTest::SphereObject => self.sphere,
            ExtentTest::BoxWorld | ExtentTest::BoxObject => self.bounds + self.plane * planes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extent_pays_only_for_objects_that_cost_more_than_it() {
        // The lecture's Square: two triangles, all of whose extents are looked at in vain.
        assert!(speed_ratio(1.0, 0.5) < 1.0);
        assert!(speed_ratio(1000.0, 0.5) > 1.9);
        let table = CostTable::of(MeshAccelerator::Linear);
        let steps = TraceCounters {
            primitives: 100,
            ..TraceCounters::default()
        };
        let m = table.steps(&steps) / table.test(ExtentTest::SphereWorld, 0.0);
        assert!(speed_ratio(m, 0.01) > 20.0);
    }
}
