//! The extents of all objects of a scene as one view shows them, without the structures that are within the objects.

use rayon::prelude::*;

use super::choice::ExtentSphere;
use super::cluster::PointCluster;
use super::object::ObjectExtents;
use super::screen::View;
use crate::accel::bake::TestSpaces;
use crate::scene::{Instance, Scene};

/// The extents of every instance whose mesh has triangles, in the instances' order, each with its instance's index. They are those that
/// [`ExtentsLoop`](super::ExtentsLoop) has, but for the tests of rays in space, which are left out.
///
/// ```
/// use bspray::accel::extents::{ExtentSphere, View, viewed_extents};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scene = bspray::import::load(&["models/lecture-objects.gltf".into()])?;
/// let camera = scene.cameras[0].frame(640, 480).ok_or("it sees nothing")?;
/// let view = View { camera, size: (640, 480), filter_radius: 0.5 };
/// let extents = viewed_extents(&scene, ExtentSphere::Smallest, &view);
/// assert_eq!(extents.len(), 14);
/// assert!(extents.iter().all(|(_, extents)| extents.screen.is_some()));
/// # Ok(())
/// # }
/// ```
pub fn viewed_extents(
    scene: &Scene,
    sphere: ExtentSphere,
    view: &View,
) -> Vec<(u32, ObjectExtents)> {
    let spaces = TestSpaces::of(scene);
    let clusters: Vec<_> = scene
        .meshes
        .par_iter()
        .map(|mesh| PointCluster::new(&mesh.cluster(usize::MAX)))
        .collect();
    let extents = |(index, instance): (usize, &Instance)| {
        let cluster = clusters[instance.mesh as usize].as_ref()?;
        let index = index as u32;
        // Rays from anywhere would need an endless margin: then there are no tests in space.
        let extents = ObjectExtents::new(
            instance,
            cluster,
            spaces.is_object_space(index),
            sphere,
            f64::INFINITY,
            Some(view),
        );
        Some((index, extents))
    };
    let instances = scene.instances.par_iter().enumerate();
    instances.filter_map(extents).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::BuildOptions;
    use crate::accel::extents::{ExtentTest, ExtentsLoop};
    use crate::geometry::{Interval, Ray};
    use crate::scene::{Camera, Part, Projection, TriangleMesh};
    use glam::{DAffine3, DQuat, DVec3, Vec3};

    /// Two placements of a triangle, and a mesh without any.
    fn scene() -> Scene {
        let mesh = TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(0.0, 2.0, 0.5)],
            triangles: vec![[0, 1, 2]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 1,
                material: 0,
            }],
            ..TriangleMesh::default()
        };
        let turned = DAffine3::from_rotation_translation(
            DQuat::from_rotation_z(0.4),
            DVec3::new(1.5, -0.5, -1.0),
        );
        Scene {
            meshes: vec![TriangleMesh::default(), mesh],
            instances: vec![
                Instance::new("a", 1, DAffine3::IDENTITY),
                Instance::new("nothing", 0, DAffine3::IDENTITY),
                Instance::new("b", 1, turned),
            ],
            ..Scene::default()
        }
    }

    fn view() -> View {
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(0.5, 1.0, 6.0),
            focal_point: Vec3::ZERO,
            view_up: Vec3::Y,
            projection: Projection::Perspective { view_angle: 50.0 },
        };
        View {
            camera: camera.frame(320, 200).unwrap(),
            size: (320, 200),
            filter_radius: 1.5,
        }
    }

    #[test]
    fn they_are_those_of_the_loop() {
        let options = BuildOptions {
            view: Some(view()),
            ..BuildOptions::default()
        };
        let objects = ExtentsLoop::build(&scene(), &options);
        let found = viewed_extents(&scene(), ExtentSphere::Smallest, &view());
        assert_eq!((found.len(), objects.objects().len()), (2, 2));
        for ((index, extents), object) in found.iter().zip(objects.objects()) {
            assert_eq!(*index, object.instance);
            assert_eq!(extents.screen, object.extents.screen);
            let [ours, theirs] = [extents.world, object.extents.world].map(Option::unwrap);
            assert_eq!((ours.bounds, ours.sphere), (theirs.bounds, theirs.sphere));
        }
    }

    #[test]
    fn tests_in_space_that_know_no_margin_reject_nothing() {
        use crate::accel::extents::{ExtentRay, WorldRay};
        for (_, extents) in viewed_extents(&scene(), ExtentSphere::Smallest, &view()) {
            assert!(extents.has(ExtentTest::Screen));
            let ray = Ray::new(Vec3::splat(9.0), Vec3::X).within(Interval::new(0.0, 1.0));
            let world = WorldRay {
                ray: ExtentRay::new(&ray),
                is_near: true,
                has_pixel: false,
            };
            let in_object = extents.object_ray(&ray).map(|r| ExtentRay::new(&r));
            let margined = if extents.is_tested_in_object() {
                [ExtentTest::BoxWorld, ExtentTest::SphereWorld]
            } else {
                [ExtentTest::BoxObject, ExtentTest::SphereObject]
            };
            for test in margined {
                assert!(extents.admits(test, &ray, &world, in_object.as_ref(), &mut 0));
            }
        }
    }
}
