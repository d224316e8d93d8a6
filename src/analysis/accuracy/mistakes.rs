//! What one method got wrong, counted by how, by whose error it is and by what explains it; and the rays that show it.

use super::{Fault, Faults, Trouble};
use crate::geometry::Ray;
use crate::render::Answer;

/// A ray that somebody answered wrongly.
#[derive(Clone, Debug)]
pub struct WrongRay {
    /// The ray.
    pub ray: Ray,
    /// The true answer.
    pub truth: Answer,
    /// Each method's answer.
    pub answers: Vec<Answer>,
    /// What is wrong with each.
    pub faults: Vec<Option<Fault>>,
}

/// The wrong answers of one method to one set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mistakes {
    /// By their kind.
    pub faults: Faults,
    /// Those that brute force with the same triangle test makes too.
    pub by_test: u64,
    /// Those that it does not make. What is in neither was too much to look at.
    pub by_traversal: u64,
    /// Of both, what explains them, in the order of [`Trouble::ALL`].
    pub troubles: [u64; Trouble::ALL.len()],
    /// Answers of a method that does not promise names that are right but for the name: depths that round to one `t`, or neighbours over an edge. No errors.
    pub unresolved: u64,
}

impl Mistakes {
    /// These and others together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            faults: self.faults.and(other.faults),
            by_test: self.by_test + other.by_test,
            by_traversal: self.by_traversal + other.by_traversal,
            troubles: std::array::from_fn(|i| self.troubles[i] + other.troubles[i]),
            unresolved: self.unresolved + other.unresolved,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_of_two_sets_add_up() {
        let mut one = Mistakes {
            by_test: 1,
            unresolved: 5,
            ..Mistakes::default()
        };
        one.faults.add(Fault::Hole);
        one.troubles[Trouble::Vertex as usize] = 1;
        let mut other = Mistakes {
            by_traversal: 2,
            unresolved: 1,
            ..Mistakes::default()
        };
        other.faults.add(Fault::Ghost);
        other.faults.add(Fault::Hole);
        other.troubles[Trouble::Vertex as usize] = 2;
        let both = one.and(other);
        assert_eq!((both.by_test, both.by_traversal), (1, 2));
        assert_eq!((both.unresolved, both.faults.total()), (6, 3));
        assert_eq!(both.faults.count(Fault::Hole), 2);
        assert_eq!(both.troubles[Trouble::Vertex as usize], 3);
    }
}
