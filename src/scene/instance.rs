//! Placed meshes.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::geometry::Aabb;

/// Scales of an inverse placement's axes that leave directions of usual length inside single precision, which ends at 1e38 and
/// loses digits below 1e-38.
const INVERSE_SCALES: std::ops::RangeInclusive<f64> = 1e-25..=1e25;

/// A mesh placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Name of the object in the file, or one made from its place there.
    pub name: String,
    /// Index of the scene's mesh.
    pub mesh: u32,
    /// The placement. Composed in double precision along the file's hierarchy; points are rounded once, after it.
    /// It may mirror (negative determinant) and may be singular (a mesh squashed flat).
    pub world_from_object: DAffine3,
    /// The materials that this instance shows the mesh's parts with: empty for those of the parts themselves, or one a part.
    pub materials: Vec<u32>,
}

impl Instance {
    /// An instance of mesh `mesh`.
    pub fn new(name: impl Into<String>, mesh: u32, world_from_object: DAffine3) -> Self {
        Self {
            name: name.into(),
            mesh,
            world_from_object,
            materials: Vec::new(),
        }
    }

    /// A point of the mesh in world space, rounded once.
    pub fn world_point(&self, object_point: Vec3) -> Vec3 {
        self.world_from_object
            .transform_point3(object_point.as_dvec3())
            .as_vec3()
    }

    /// The box in world space of the corners of a box in object space; an empty one of an empty one.
    pub fn world_bounds(&self, object: &Aabb) -> Aabb {
        match object.is_empty() {
            true => Aabb::EMPTY,
            false => object
                .corners()
                .map(|p| self.world_point(p))
                .into_iter()
                .collect(),
        }
    }

    /// By how much the placement lengthens at most: its matrix's greatest singular value, the root of the greatest eigenvalue of `MᵀM` (Smith 1961, "Eigenvalues of a Symmetric 3 × 3 Matrix").
    pub fn greatest_scale(&self) -> f64 {
        let m = self.world_from_object.matrix3;
        let s = m.transpose() * m;
        let mean = (s.x_axis.x + s.y_axis.y + s.z_axis.z) / 3.0;
        let off = s.x_axis.y * s.x_axis.y + s.x_axis.z * s.x_axis.z + s.y_axis.z * s.y_axis.z;
        let diagonal = DVec3::new(s.x_axis.x, s.y_axis.y, s.z_axis.z) - mean;
        let spread = ((diagonal.length_squared() + 2.0 * off) / 6.0).sqrt();
        if spread <= mean * f64::EPSILON {
            return mean.sqrt();
        }
        let shifted = (s - DMat3::from_diagonal(DVec3::splat(mean))) * (1.0 / spread);
        let angle = libm::acos((shifted.determinant() / 2.0).clamp(-1.0, 1.0)) / 3.0;
        (mean + 2.0 * spread * libm::cos(angle)).sqrt()
    }

    /// The inverse placement, or `None` where the matrix is singular, or where the inverse leaves the range in which a direction
    /// can be rounded to single precision without loss (axes scaled by 1e-25 to 1e25). Such instances are traced in world space.
    pub fn object_from_world(&self) -> Option<DAffine3> {
        let determinant = self.world_from_object.matrix3.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        let inverse = self.world_from_object.inverse();
        let m = inverse.matrix3;
        let in_range = [m.x_axis, m.y_axis, m.z_axis]
            .iter()
            .all(|c| INVERSE_SCALES.contains(&c.abs().max_element()));
        (in_range && inverse.translation.is_finite()).then_some(inverse)
    }

    /// The matrix of cofactors of the placement's linear part: the inverse transpose times the determinant, which exists without an
    /// inverse. It takes normals and area vectors to world space, and, for a placement that mirrors, to the other side.
    pub fn cofactors(&self) -> DMat3 {
        let m = self.world_from_object.matrix3;
        DMat3::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        )
    }

    /// Whether the placement turns the mesh inside out, so that counter-clockwise corners become clockwise.
    pub fn is_mirrored(&self) -> bool {
        self.world_from_object.matrix3.determinant() < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_rounded_once() {
        // 1e8 + 1 - 1e8 loses the 1 when each step is rounded to single precision.
        let there = DAffine3::from_translation(DVec3::splat(1e8));
        let back = DAffine3::from_translation(DVec3::splat(-1e8));
        let instance = Instance::new("x", 0, back * there);
        assert_eq!(
            instance.world_point(Vec3::new(1.0, 2.0, 3.0)),
            Vec3::new(1.0, 2.0, 3.0)
        );
    }

    #[test]
    fn flat_placements_have_no_inverse() {
        let flat = Instance::new("x", 0, DAffine3::from_scale(DVec3::new(1.0, 0.0, 2.0)));
        assert!(flat.object_from_world().is_none() && !flat.is_mirrored());
        let tiny = Instance::new("x", 0, DAffine3::from_scale(DVec3::new(1.0, 1e-30, 1.0)));
        assert!(tiny.object_from_world().is_none());
        let mirror = Instance::new("x", 0, DAffine3::from_scale(DVec3::new(-1.0, 3.0, 2.0)));
        assert!(mirror.object_from_world().is_some() && mirror.is_mirrored());
    }

    fn placed(matrix: DMat3) -> Instance {
        Instance::new("", 0, DAffine3::from_mat3(matrix))
    }

    #[test]
    fn the_greatest_scale_is_the_longest_image_of_a_unit_vector() {
        let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(-1.1);
        let other = DMat3::from_rotation_z(2.0);
        let stretch = DMat3::from_diagonal(DVec3::new(0.5, 3.0, -2.0));
        let shear = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 2.0, 1.0, 0.0, 0.5, -1.0, 1.0]);
        assert!((placed(turn * 2.5).greatest_scale() - 2.5).abs() < 1e-12);
        assert!((placed(turn * stretch * other).greatest_scale() - 3.0).abs() < 1e-9);
        for matrix in [shear, turn * shear * stretch] {
            let directions = (0..40_000).map(|i| {
                let (s, c) = libm::sincos(f64::from(i % 200) * 0.0314159);
                let z = f64::from(i / 200) / 100.0 - 1.0;
                DVec3::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z)
            });
            let longest = directions
                .map(|d| (matrix * d).length())
                .fold(0.0, f64::max);
            let found = placed(matrix).greatest_scale();
            assert!(
                longest <= found && found < longest * 1.001,
                "{found} {longest}"
            );
        }
    }
}
