//! The names that hits carry, from the numbers of triangles in a set: which instance, and which triangle of its mesh.
//!
//! Sets are in the order of instances, and in each instance in that of triangles ([`bake`](super::bake)); so a few numbers name all triangles.

use super::bake::TriangleSet;
use super::hit::Nearest;

/// The names of a set's triangles.
#[derive(Clone, Debug)]
pub(super) struct Names {
    count: u32,
    /// Where each instance's numbers begin, and the instance; ascending in both.
    instances: Vec<(u32, u32)>,
}

impl Names {
    pub(super) fn of(set: &TriangleSet) -> Self {
        let mut instances: Vec<(u32, u32)> = Vec::new();
        for (number, named) in set.iter().enumerate() {
            let number = number as u32;
            if instances
                .last()
                .is_none_or(|&(_, last)| last != named.instance)
            {
                instances.push((number - named.index, named.instance));
            }
        }
        Self {
            count: set.len() as u32,
            instances,
        }
    }

    /// How many triangles there are.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// Memory beside the value itself.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.instances)
    }

    /// Where each instance's numbers begin, and the instance; ascending in both.
    pub(super) fn instances(&self) -> &[(u32, u32)] {
        &self.instances
    }

    /// Instance and triangle.
    #[inline(always)]
    pub(super) fn name(&self, number: u32) -> (u32, u32) {
        let at = if self.instances.len() == 1 {
            0
        } else {
            self.instances
                .partition_point(|&(first, _)| first <= number)
                - 1
        };
        let (first, instance) = self.instances[at];
        (instance, number - first)
    }

    /// How many come up to this name, itself included, when hits are under the name of `instance` or of their own.
    pub(super) fn up_to(&self, name: (u32, u32), instance: Option<u32>) -> u32 {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            let (own, index) = self.name(middle);
            if (instance.unwrap_or(own), index) <= name {
                low = middle + 1
            } else {
                high = middle
            }
        }
        low
    }

    /// Offers a hit of the triangle of this number, under the name of `instance` or its own.
    #[inline]
    pub(super) fn offer(&self, t: f32, number: u32, instance: Option<u32>, nearest: &mut Nearest) {
        let (own, index) = self.name(number);
        nearest.offer(t, instance.unwrap_or(own), index);
    }
}

#[cfg(test)]
mod tests {
    use super::super::bake::NamedTriangle;
    use super::*;
    use crate::geometry::Triangle;
    use glam::Vec3;

    #[test]
    fn numbers_and_names_are_the_same_order() {
        let triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
        let names = [(1, 0), (1, 1), (4, 0), (5, 0), (5, 1), (5, 2)];
        let named = |(instance, index)| NamedTriangle {
            triangle,
            instance,
            index,
        };
        let set: TriangleSet = names.into_iter().map(named).collect();
        let table = Names::of(&set);
        assert_eq!(table.instances(), [(0, 1), (2, 4), (3, 5)]);
        for (number, name) in (0..).zip(names) {
            assert_eq!(table.name(number), name);
            assert_eq!(table.up_to(name, None), number + 1);
        }
        assert_eq!(table.up_to((0, 9), None), 0);
        assert_eq!(table.up_to((4, 7), None), 3);
        assert_eq!(table.up_to((9, 0), None), table.count());
    }
}
