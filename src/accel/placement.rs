//! How far rounding moves a ray on its way to object space: what every box around a placed object must be wider by.

use glam::{DAffine3, DMat3};

use crate::geometry::tolerance::object_space_error;

/// Norms of a placement with an inverse.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacementNorms {
    /// Frobenius norm of its matrix.
    pub(super) own: f64,
    /// Frobenius norm of the inverse's.
    pub(super) inverse: f64,
    /// The third power of `own` over the determinant: 5.2 (that is `3^1.5`) for similarities, more the flatter it makes things.
    pub(super) skew: f64,
    /// Length of the translation, in world units.
    translation: f64,
}

impl PlacementNorms {
    pub(super) fn of(placement: &DAffine3, inverse: &DAffine3) -> Self {
        let own = norm(placement.matrix3);
        Self {
            own,
            inverse: norm(inverse.matrix3),
            skew: own * own * own / placement.matrix3.determinant().abs(),
            translation: placement.translation.length(),
        }
    }

    /// How far a ray that starts up to `reach` (world units) from the placement's translation passes in object space beside where it should, at most, in
    /// units of the object, whose points are up to `object_radius` from the origin of its space.
    pub(super) fn object_error(&self, object_radius: f64, reach: f64) -> f64 {
        object_space_error(
            self.inverse,
            self.skew,
            object_radius,
            reach,
            self.translation,
        )
    }

    /// The same in world units.
    pub(super) fn world_error(&self, object_radius: f64, reach: f64) -> f64 {
        self.own * self.object_error(object_radius, reach)
    }
}

/// Frobenius norm.
fn norm(m: DMat3) -> f64 {
    m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn norms_are_of_the_matrix_and_the_way_back_and_skew_tells_flatness() {
        let norms = |scale: DVec3| {
            let placement = DAffine3::from_scale(scale);
            PlacementNorms::of(&placement, &placement.inverse())
        };
        let even = norms(DVec3::splat(-2.0));
        assert!((even.own - 2.0 * 3.0_f64.sqrt()).abs() < 1e-12);
        assert!((even.inverse - 3.0_f64.sqrt() / 2.0).abs() < 1e-12);
        assert!((even.skew - 27.0_f64.sqrt()).abs() < 1e-12);
        assert!(norms(DVec3::new(1.0, 1.0, 1e-3)).skew > 2000.0);
    }
}
