//! Axis-aligned boxes.

use glam::{DVec3, Vec3};

/// An axis-aligned box given by its least and greatest corner, both included.
///
/// ```
/// use bspray::geometry::Aabb;
/// use glam::Vec3;
/// let b: Aabb = [Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)].into_iter().collect();
/// assert_eq!(b.surface_area(), 22.0);
/// assert!(Aabb::EMPTY.is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing; the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// Whether the box holds no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box that holds this one and `point`.
    #[must_use]
    pub fn grown(self, point: Vec3) -> Self {
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Lengths of the edges; zero for an empty box.
    pub fn extent(&self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// The middle; meaningless for an empty box.
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Length of the diagonal; 0 for an empty box.
    pub fn diagonal(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        // In double precision: the squares of large extents overflow single precision.
        (self.max.as_dvec3() - self.min.as_dvec3()).length() as f32
    }

    /// Area of the six faces, in square units; 0 for an empty box.
    pub fn surface_area(&self) -> f32 {
        let e = self.extent();
        2.0 * (e.x * e.y + e.y * e.z + e.z * e.x)
    }

    /// The eight corners; bit `axis` of a corner's number says whether it has the greatest coordinate there.
    pub fn corners(&self) -> [Vec3; 8] {
        let side = |corner: usize, axis: usize| [self.min, self.max][corner >> axis & 1][axis];
        std::array::from_fn(|i| Vec3::new(side(i, 0), side(i, 1), side(i, 2)))
    }

    /// Distance of a point from the box, in model units: 0 inside, infinite from an empty one.
    pub fn distance(&self, point: DVec3) -> f64 {
        if self.is_empty() {
            return f64::INFINITY;
        }
        let [min, max] = [self.min, self.max].map(Vec3::as_dvec3);
        (min - point).max(point - max).max(DVec3::ZERO).length()
    }

    /// Whether the box holds `point`; its faces belong to it.
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }
}

impl FromIterator<Vec3> for Aabb {
    fn from_iter<I: IntoIterator<Item = Vec3>>(points: I) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::grown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surface_of_a_box_with_three_different_edges() {
        // obvhs 0.4.0 returns 28 here, and its test uses a cube, where the error does not show.
        let b: Aabb = [Vec3::new(-1.0, 5.0, 2.0), Vec3::new(0.0, 7.0, 5.0)]
            .into_iter()
            .collect();
        assert_eq!(b.surface_area(), 22.0);
        assert_eq!(b.center(), Vec3::new(-0.5, 6.0, 3.5));
        assert!((b.diagonal() - 14.0_f32.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn empty_is_neutral() {
        let b: Aabb = [Vec3::new(1.0, 2.0, 3.0)].into_iter().collect();
        assert_eq!(Aabb::EMPTY.union(b), b);
        assert!(!b.is_empty() && b.contains(Vec3::new(1.0, 2.0, 3.0)));
        assert!(Aabb::EMPTY.is_empty() && Aabb::EMPTY.diagonal() == 0.0);
        assert_eq!(Aabb::EMPTY.surface_area(), 0.0);
    }

    #[test]
    fn huge_boxes_keep_a_finite_diagonal() {
        let b: Aabb = [Vec3::splat(-1e30), Vec3::splat(1e30)]
            .into_iter()
            .collect();
        assert!(b.diagonal().is_finite());
    }
}
