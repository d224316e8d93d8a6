//! The words for what is wrong: how an answer is wrong, whose error it is, and what explains it.

use serde::{Deserialize, Serialize};

use super::Fault;

/// How an answer is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A hole in a closed mesh, seen from inside.
    Leak,
    /// Something is hit, and the answer is nothing.
    Hole,
    /// Nothing is hit, and the answer is a hit.
    Ghost,
    /// A triangle that is hit, but not first.
    WrongOrder,
    /// The nearest triangle, or one that is not hit at all, at a wrong depth. Exact methods owe every bit of it, others half of them.
    WrongDepth,
    /// The true depth under another name than the least of those that are hit there: owed by exact methods only.
    WrongName,
}

impl Kind {
    /// All of them, in the order of [`Cell::faults`](crate::analysis::stability::Cell::faults).
    pub const ALL: [Self; 6] = [
        Self::Leak,
        Self::Hole,
        Self::Ghost,
        Self::WrongOrder,
        Self::WrongDepth,
        Self::WrongName,
    ];

    /// The name in reports, of one.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Leak => "leak",
            Self::Hole => "hole",
            Self::Ghost => "ghost",
            Self::WrongOrder => "wrong order",
            Self::WrongDepth => "wrong depth",
            Self::WrongName => "wrong name",
        }
    }

    /// The same in fewer words, which do not ask where a ray comes from or what else it meets.
    pub(in crate::analysis) const fn fault(self) -> Fault {
        match self {
            Self::Leak | Self::Hole => Fault::Hole,
            Self::Ghost => Fault::Ghost,
            Self::WrongOrder | Self::WrongDepth => Fault::WrongDepth,
            Self::WrongName => Fault::WrongName,
        }
    }
}

/// Whose error it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Blame {
    /// The triangle test's: brute force with the same test gives the same answer.
    Test,
    /// The structure's: brute force with the same test gives another.
    Traversal,
}

/// What explains a wrong answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trouble {
    /// The ray passes an edge of the triangle, as far as single precision can tell.
    Edge,
    /// The same of a corner.
    Vertex,
    /// The ray lies in the triangle's plane, as far as single precision can tell.
    Coplanar,
    /// The structure lost it where the ray passes a side of the triangle's box.
    CellBoundary,
    /// The hit is at an end of the ray's interval.
    IntervalEnd,
    /// Depths that are too close for the arithmetic, or a depth that it lost.
    Depth,
    /// None of these: skipped by a fixed epsilon, an overflow, an underflow or a wrong bound.
    Cull,
}

impl Trouble {
    /// All of them, in the order of [`Cell::troubles`](crate::analysis::stability::Cell::troubles).
    pub const ALL: [Self; 7] = [
        Self::Edge,
        Self::Vertex,
        Self::Coplanar,
        Self::CellBoundary,
        Self::IntervalEnd,
        Self::Depth,
        Self::Cull,
    ];

    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Edge => "edge",
            Self::Vertex => "vertex",
            Self::Coplanar => "coplanar",
            Self::CellBoundary => "cell boundary",
            Self::IntervalEnd => "interval end",
            Self::Depth => "precision of t",
            Self::Cull => "cull",
        }
    }
}
