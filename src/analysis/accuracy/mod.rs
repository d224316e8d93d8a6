//! Whether answers are true, by exact arithmetic: what a ray hits is decided from the `f32` inputs without rounding, and no method has a vote. And where one is wrong:
//! how ([`Kind`]), whose error it is ([`Blame`]), and what explains it ([`Trouble`]).
//!
//! Two standards. The crate's own structures owe the exact answer, bit for bit. Methods in single precision owe the nearest triangle at a plausible depth, half
//! of the digits of `f32`; hits whose exact depths round to one `t`, and the neighbour over an edge at the true depth, are *unresolved*, no errors.
//!
//! ```
//! use bspray::accel::AcceleratorKind;
//! use bspray::analysis::Query;
//! use bspray::analysis::accuracy::{Fault, Oracle, judge};
//! use bspray::geometry::Ray;
//! use bspray::render::Answer;
//! use glam::Vec3;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = bspray::import::load(&["models/lecture-block.obj".into()])?;
//! let ray = Ray::new(Vec3::new(0.3, 9.0, 0.4), Vec3::NEG_Y);
//! let truth = Oracle::new(&scene).truth(&ray, Query::Closest);
//! let answer = Answer::Closest(AcceleratorKind::Bsp.build(&scene).closest_hit(&ray));
//! assert_eq!(judge(truth, answer), None);
//! assert_eq!(judge(truth, Answer::Closest(None)), Some(Fault::Hole));
//! # Ok(())
//! # }
//! ```

pub(super) mod alone;
mod blame;
pub(super) mod dispute;
mod kinds;
mod mistakes;
mod oracle;
pub(super) mod trouble;
pub(super) mod verdict;

pub use kinds::{Blame, Kind, Trouble};
pub use mistakes::{Mistakes, WrongRay};
pub use oracle::Oracle;
pub(super) use oracle::exact_hit;

use crate::render::Answer;

/// How an answer is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// Something is hit, and the answer is nothing.
    Hole,
    /// Nothing is hit, and the answer is a hit.
    Ghost,
    /// The nearest hit is elsewhere on the ray.
    WrongDepth,
    /// A hit just there, of a triangle that is not hit there, or that is not the first by name among those that are.
    WrongName,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Hole, Self::Ghost, Self::WrongDepth, Self::WrongName];

    /// The name of one or several in reports.
    pub const fn name(self, is_plural: bool) -> &'static str {
        match (self, is_plural) {
            (Self::Hole, false) => "hole",
            (Self::Hole, true) => "holes",
            (Self::Ghost, false) => "ghost",
            (Self::Ghost, true) => "ghosts",
            (Self::WrongDepth, false) => "wrong depth",
            (Self::WrongDepth, true) => "wrong depths",
            (Self::WrongName, false) => "wrong name",
            (Self::WrongName, true) => "wrong names",
        }
    }
}

/// Wrong answers, counted by their kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults([u64; 4]);

impl Faults {
    /// Counts one more.
    pub fn add(&mut self, fault: Fault) {
        self.0[fault as usize] += 1;
    }

    /// These and others together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(std::array::from_fn(|kind| self.0[kind] + other.0[kind]))
    }

    /// How many of a kind.
    pub fn count(&self, fault: Fault) -> u64 {
        self.0[fault as usize]
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }
}

/// What is wrong with an answer, given the true one to the same question; `None` if nothing is. Depths are compared bit for bit: the
/// true one, rounded once, is what everybody owes.
pub fn judge(truth: Answer, answer: Answer) -> Option<Fault> {
    let nearest = |answer| match answer {
        Answer::Closest(hit) => hit.map(|h| (h.t.to_bits(), Some((h.instance, h.triangle)))),
        Answer::Any(hit) => hit.then_some((0, None)),
    };
    match (nearest(truth), nearest(answer)) {
        (None, None) => None,
        (Some(_), None) => Some(Fault::Hole),
        (None, Some(_)) => Some(Fault::Ghost),
        (Some((t, _)), Some((s, _))) if t != s => Some(Fault::WrongDepth),
        (Some((_, name)), Some((_, other))) => (name != other).then_some(Fault::WrongName),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Hit;

    fn at(t: f32, triangle: u32) -> Answer {
        Answer::Closest(Some(Hit {
            t,
            instance: 0,
            triangle,
        }))
    }

    #[test]
    fn each_fault_is_told_from_the_others() {
        let nothing = Answer::Closest(None);
        assert_eq!(judge(at(2.0, 7), at(2.0, 7)), None);
        assert_eq!(judge(nothing, nothing), None);
        assert_eq!(judge(at(2.0, 7), nothing), Some(Fault::Hole));
        assert_eq!(judge(nothing, at(2.0, 7)), Some(Fault::Ghost));
        let next = at(2.0_f32.next_up(), 7);
        assert_eq!(judge(at(2.0, 7), next), Some(Fault::WrongDepth));
        assert_eq!(judge(at(2.0, 7), at(2.0, 8)), Some(Fault::WrongName));
        let any = |truth, answer| judge(Answer::Any(truth), Answer::Any(answer));
        assert_eq!(any(true, false), Some(Fault::Hole));
        assert_eq!(any(false, true), Some(Fault::Ghost));
        assert!(any(true, true).is_none() && any(false, false).is_none());
    }

    #[test]
    fn faults_are_counted_by_kind() {
        let mut faults = Faults::default();
        for fault in [Fault::Ghost, Fault::WrongName, Fault::Ghost] {
            faults.add(fault);
        }
        assert_eq!(
            Fault::ALL.map(|f| faults.count(f)),
            [0, 2, 0, 1],
            "{faults:?}"
        );
        assert_eq!(faults.total(), 3);
        assert_eq!(faults.and(faults).count(Fault::Ghost), 4);
    }
}
