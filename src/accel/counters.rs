//! What a traversal did, counted when asked for and free when not.

use std::ops::AddAssign;

use super::extents::ExtentTest;

/// Steps of traversal, summed over rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TraceCounters {
    /// Inner nodes whose children were tested.
    pub nodes: u64,
    /// Leaves whose primitives were tested.
    pub leaves: u64,
    /// Ray-triangle tests.
    pub primitives: u64,
    /// Tests of extents of objects: 0 for structures without such.
    pub extents: u64,
}

impl AddAssign for TraceCounters {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.leaves += other.leaves;
        self.primitives += other.primitives;
        self.extents += other.extents;
    }
}

/// What a traversal reports its steps to: [`TraceCounters`], or [`Uncounted`], which compiles to nothing.
pub(super) trait Counter {
    /// Whether anybody counts: a traversal that cannot report its steps as it goes may take another path then.
    const COUNTS: bool;
    /// One inner node.
    fn node(&mut self);
    /// One leaf.
    fn leaf(&mut self);
    /// So many ray-triangle tests.
    fn primitives(&mut self, count: usize);

    /// One test of an object's extent, which looked at so many planes of a box.
    fn extent(&mut self, _object: u32, _test: ExtentTest, _planes: u32, _is_admitted: bool) {}

    /// A ray was taken to an object's space.
    fn transform(&mut self, _object: u32) {}

    /// The full test of an object begins.
    fn enter(&mut self, _object: u32) {}

    /// The full test of an object ended.
    fn leave(&mut self, _object: u32, _is_hit: bool) {}
}

impl Counter for TraceCounters {
    const COUNTS: bool = true;

    fn node(&mut self) {
        self.nodes += 1;
    }

    fn leaf(&mut self) {
        self.leaves += 1;
    }

    fn primitives(&mut self, count: usize) {
        self.primitives += count as u64;
    }

    fn extent(&mut self, _object: u32, _test: ExtentTest, _planes: u32, _is_admitted: bool) {
        self.extents += 1;
    }
}

/// Counts nothing, at no cost.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Uncounted;

impl Counter for Uncounted {
    const COUNTS: bool = false;

    fn node(&mut self) {}

    fn leaf(&mut self) {}

    fn primitives(&mut self, _count: usize) {}
}

/// The size of a built structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildStats {
    /// Triangles in the structure; a mesh that several instances share counts once.
    pub triangles: u64,
    /// Those of them that are in no leaf yet, since no ray has come near: see
    /// [`BuildTime`](super::BuildTime).
    pub unbuilt_triangles: u64,
    /// Placed sets of triangles above the meshes.
    pub placements: u64,
    /// Inner nodes and leaves of all trees.
    pub nodes: u64,
    /// Levels of the deepest tree, its leaves included; 0 without a tree.
    pub depth: u32,
    /// Everything that queries read, in bytes.
    pub bytes: u64,
}

impl BuildStats {
    /// Share of the triangles that are in leaves; 1 of none.
    pub fn built_share(&self) -> f64 {
        1.0 - self.unbuilt_triangles as f64 / self.triangles.max(1) as f64
    }
}

impl AddAssign for BuildStats {
    /// Sums sizes; of depths the greater counts.
    fn add_assign(&mut self, other: Self) {
        self.triangles += other.triangles;
        self.unbuilt_triangles += other.unbuilt_triangles;
        self.placements += other.placements;
        self.nodes += other.nodes;
        self.depth = self.depth.max(other.depth);
        self.bytes += other.bytes;
    }
}
