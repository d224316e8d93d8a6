//! How far a comparison is, for those who watch.

use std::cell::Cell;

/// Share of the whole work that builds are taken for.
pub(super) const BUILD_SHARE: f64 = 0.2;

/// Share of it that pictures of costs are taken for, if there are any.
pub(super) const DRAW_SHARE: f64 = 0.1;

/// Share of the work on a set that its judging is taken for.
pub(super) const JUDGE_SHARE: f64 = 0.3;

/// What a comparison is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase<'a> {
    /// Builds a method.
    Build(&'a str),
    /// Times the rays of a set.
    Time(&'a str),
    /// Counts their steps, and looks at the answers.
    Judge(&'a str),
    /// Counts the steps of every pixel.
    Draw,
}

impl std::fmt::Display for Phase<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Build(name) => write!(f, "building {name}"),
            Self::Time(name) => write!(f, "timing {name} rays"),
            Self::Judge(name) => write!(f, "judging {name} rays"),
            Self::Draw => write!(f, "counting the steps of pixels"),
        }
    }
}

/// The share of the work that is done, told with what comes next.
pub(super) struct Course<'a> {
    pub(super) watch: &'a dyn Fn(Phase, f64),
    pub(super) done: Cell<f64>,
}

impl Course<'_> {
    /// Says what comes now, and that so much more is done.
    pub(super) fn on(&self, phase: Phase, more: f64) {
        self.done.set(self.done.get() + more);
        (self.watch)(phase, self.done.get());
    }
}
