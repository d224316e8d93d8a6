//! Where accelerators keep their contract, said in code: what is outside is named, so that nobody has to guess why a ray met nothing.

use super::bake::TestSpaces;
use crate::geometry::Ray;
use crate::geometry::tolerance::COORDINATE_LIMIT;
use crate::scene::Scene;

/// Why a question is outside of the accelerators' domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Outside {
    /// A corner in world space, or in the space in which it is tested, is no number or is infinite: the triangle is never hit.
    #[error(
        "triangle {triangle} of instance {instance} has a coordinate that is not finite, and is never hit"
    )]
    NotFinite {
        /// Index of the instance.
        instance: u32,
        /// Index in its mesh.
        triangle: u32,
    },
    /// A corner is beyond the coordinates that importers let through.
    #[error(
        "triangle {triangle} of instance {instance} has a coordinate beyond {COORDINATE_LIMIT:e}"
    )]
    Coordinate {
        /// Index of the instance.
        instance: u32,
        /// Index in its mesh.
        triangle: u32,
    },
    /// The ray hits nothing, by definition ([`Ray::is_traceable`]).
    #[error(
        "the ray has a number that is not finite, no direction, or an empty interval, and hits nothing"
    )]
    Ray,
    /// The ray leaves `f32` on its way to an object's space.
    #[error(
        "the ray is infinite or has no direction in the space of instance {instance}, and misses it"
    )]
    ObjectRay {
        /// Index of the instance.
        instance: u32,
    },
}

/// The questions about a scene that accelerators answer exactly.
///
/// ```
/// use bspray::accel::{Domain, Outside};
/// use bspray::geometry::Ray;
/// use bspray::scene::Scene;
/// use glam::Vec3;
/// let scene = Scene::default();
/// let domain = Domain::of(&scene).expect("an empty scene is inside");
/// assert_eq!(domain.check(&Ray::new(Vec3::ZERO, Vec3::X)), Ok(()));
/// assert_eq!(domain.check(&Ray::new(Vec3::ZERO, Vec3::ZERO)), Err(Outside::Ray));
/// ```
pub struct Domain<'a> {
    scene: &'a Scene,
    spaces: TestSpaces,
}

impl<'a> Domain<'a> {
    /// The domain of a scene.
    ///
    /// # Errors
    /// The first triangle, by instance and index, that is outside.
    pub fn of(scene: &'a Scene) -> Result<Self, Outside> {
        let spaces = TestSpaces::of(scene);
        let any = Ray::new(glam::Vec3::ZERO, glam::Vec3::X);
        for (instance, placed) in (0..).zip(&scene.instances) {
            let count = scene.meshes[placed.mesh as usize].triangles.len() as u32;
            for triangle in 0..count {
                let (_, tested) = spaces.test(scene, &any, instance, triangle);
                let in_object = scene.mesh_of(instance).triangle(triangle);
                let in_world = in_object.corners().map(|p| placed.world_point(p));
                let corners = || tested.corners().iter().chain(&in_world);
                if corners().any(|p| !p.is_finite()) {
                    return Err(Outside::NotFinite { instance, triangle });
                }
                if corners().any(|p| p.abs().max_element() > COORDINATE_LIMIT) {
                    return Err(Outside::Coordinate { instance, triangle });
                }
            }
        }
        Ok(Self { scene, spaces })
    }

    /// Whether the ray is inside.
    ///
    /// # Errors
    /// Why not.
    pub fn check(&self, ray: &Ray) -> Result<(), Outside> {
        if !ray.is_traceable() {
            return Err(Outside::Ray);
        }
        for (instance, placed) in (0..).zip(&self.scene.instances) {
            let is_empty = self.scene.meshes[placed.mesh as usize].triangles.is_empty();
            if is_empty || !self.spaces.is_object_space(instance) {
                continue;
            }
            let (in_object, _) = self.spaces.test(self.scene, ray, instance, 0);
            if !in_object.is_traceable() {
                return Err(Outside::ObjectRay { instance });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, TriangleMesh};
    use glam::{DAffine3, DVec3, Vec3};

    fn scene(size: f32, scales: &[f64]) -> Scene {
        let mesh = TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X * size, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..TriangleMesh::default()
        };
        let place = |&scale: &f64| Instance::new("", 0, DAffine3::from_scale(DVec3::splat(scale)));
        Scene {
            meshes: vec![mesh],
            instances: scales.iter().map(place).collect(),
            ..Scene::default()
        }
    }

    #[test]
    fn what_is_outside_is_named() {
        assert!(Domain::of(&scene(1e18, &[1.0])).is_ok());
        let name = |size, scales: &[f64]| Domain::of(&scene(size, scales)).err();
        let (instance, triangle) = (0, 0);
        assert_eq!(
            name(1.1e18, &[1.0]),
            Some(Outside::Coordinate { instance, triangle })
        );
        assert_eq!(
            name(1.0, &[1e19]),
            Some(Outside::Coordinate { instance, triangle })
        );
        assert_eq!(
            name(f32::NAN, &[1.0]),
            Some(Outside::NotFinite { instance, triangle })
        );
        assert_eq!(
            name(1.0, &[1e39]),
            Some(Outside::NotFinite { instance, triangle })
        );
        assert_eq!(
            name(1.0, &[1.0, 1e30]),
            Some(Outside::Coordinate {
                instance: 1,
                triangle
            })
        );
        let words = Outside::Coordinate { instance, triangle }.to_string();
        assert_eq!(
            words,
            "triangle 0 of instance 0 has a coordinate beyond 1e18"
        );
    }

    #[test]
    fn a_ray_that_a_placement_takes_out_of_single_precision_is_named() {
        let scene = scene(1.0, &[1.0, 1e10]);
        let domain = Domain::of(&scene).unwrap();
        let along = |length: f32| domain.check(&Ray::new(Vec3::ZERO, Vec3::Z * length));
        assert_eq!(along(1.0), Ok(()));
        assert_eq!(along(1e-40), Err(Outside::ObjectRay { instance: 1 }));
        assert_eq!(
            domain.check(&Ray::new(Vec3::NAN, Vec3::Z)),
            Err(Outside::Ray)
        );
    }
}
