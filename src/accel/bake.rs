//! Which triangles are tested in which space: the same for every accelerator, so that their answers can be
//! compared bit for bit.
//!
//! Meshes that are placed once, and those whose placement has no inverse, are baked into one set in world space, each point
//! rounded once. A mesh that is placed several times stays in object space, and rays are taken there.

use glam::{DAffine3, DVec3};

use super::normalized::NormalizedSpace;
use super::placement::PlacementNorms;
use crate::geometry::tolerance::{INSTANCE_FAR, INSTANCE_LEAST_DIRECTION};
use crate::geometry::{Aabb, Ray, Triangle};
use crate::scene::{Instance, Scene};

/// In which space each instance's triangles are tested.
///
/// This is for those who want to test a triangle as the accelerators do, to judge their answers.
#[derive(Clone, Debug)]
pub struct TestSpaces {
    /// For instances that are tested in object space, the way there.
    object_from_world: Vec<Option<DAffine3>>,
}

impl TestSpaces {
    /// Decides for every instance of the scene.
    pub fn of(scene: &Scene) -> Self {
        let mut uses = vec![0_u32; scene.meshes.len()];
        scene
            .instances
            .iter()
            .for_each(|i| uses[i.mesh as usize] += 1);
        let inverse = |i: &Instance| i.object_from_world().filter(|_| uses[i.mesh as usize] > 1);
        Self {
            object_from_world: scene.instances.iter().map(inverse).collect(),
        }
    }

    /// Whether the triangles of an instance are tested in its object space.
    pub fn is_object_space(&self, instance: u32) -> bool {
        self.object_from_world[instance as usize].is_some()
    }

    /// The ray and the triangle that are tested against one another: both in world space, or both in the instance's.
    pub fn test(&self, scene: &Scene, ray: &Ray, instance: u32, triangle: u32) -> (Ray, Triangle) {
        let placed = &scene.instances[instance as usize];
        let in_object = scene.mesh_of(instance).triangle(triangle);
        match &self.object_from_world[instance as usize] {
            Some(object_from_world) => (object_ray(object_from_world, ray), in_object),
            None => {
                let [a, b, c] = in_object.corners().map(|p| placed.world_point(p));
                (*ray, Triangle::new(a, b, c))
            }
        }
    }
}

/// The ray in object space: `t` keeps its meaning. Computed in double precision and rounded once.
pub(super) fn object_ray(object_from_world: &DAffine3, ray: &Ray) -> Ray {
    let origin = object_from_world
        .transform_point3(ray.origin.as_dvec3())
        .as_vec3();
    let direction = object_from_world
        .transform_vector3(ray.direction.as_dvec3())
        .as_vec3();
    Ray {
        origin,
        direction,
        ..*ray
    }
}

/// A triangle ready for tests, with the names that its hits carry.
#[derive(Clone, Copy, Debug)]
pub(super) struct NamedTriangle {
    pub(super) triangle: Triangle,
    /// The instance; in a set that is placed several times, a placeholder.
    pub(super) instance: u32,
    /// The triangle's index in its mesh.
    pub(super) index: u32,
}

/// A set of triangles in one space.
pub(super) type TriangleSet = Vec<NamedTriangle>;

/// A set of triangles, placed.
#[derive(Clone, Debug)]
pub(super) struct Placement {
    /// Index of the set.
    pub(super) set: u32,
    /// The instance that its hits carry, and the way there; `None` for the set in world space.
    pub(super) instance: Option<PlacedInstance>,
    /// World-space box of its triangles, rounded outwards.
    pub(super) bounds: Aabb,
}

/// An instance whose triangles are tested in object space.
#[derive(Clone, Debug)]
pub(super) struct PlacedInstance {
    pub(super) index: u32,
    pub(super) object_from_world: DAffine3,
    pub(super) world_from_object: DAffine3,
    /// Greatest distance of the mesh's points from the origin of its space.
    pub(super) object_radius: f64,
}

impl Placement {
    /// How far the object-space form of a ray passes beside its world-space line, at most, in world units, for origins up to
    /// [`INSTANCE_FAR`] from the middle of the placements.
    pub(super) fn margin(&self, space: &NormalizedSpace) -> f64 {
        let Some(instance) = &self.instance else {
            return 0.0;
        };
        let offset = space.distance(instance.world_from_object.translation);
        let reach = INSTANCE_FAR / space.length(1.0);
        let norms = instance.norms();
        norms.world_error(instance.object_radius, reach + offset)
    }

    /// Least largest component of a world-space direction for which [`Placement::margin`] holds.
    pub(super) fn least_direction(&self) -> f64 {
        let norms = self.instance.as_ref().map(PlacedInstance::norms);
        norms.map_or(0.0, |n| INSTANCE_LEAST_DIRECTION * n.own)
    }
}

impl PlacedInstance {
    fn norms(&self) -> PlacementNorms {
        PlacementNorms::of(&self.world_from_object, &self.object_from_world)
    }

    /// The ray in object space.
    pub(super) fn object_ray(&self, ray: &Ray) -> Ray {
        object_ray(&self.object_from_world, ray)
    }
}

/// Everything an accelerator is built from.
#[derive(Debug, Default)]
pub(super) struct Baked {
    pub(super) sets: Vec<TriangleSet>,
    pub(super) placements: Vec<Placement>,
}

/// Sorts the scene's triangles into sets. Sets without triangles are left out.
pub(super) fn bake(scene: &Scene) -> Baked {
    let (spaces, clusters) = (TestSpaces::of(scene), scene.clusters());
    let mut baked = Baked::default();
    let mut world = TriangleSet::new();
    let mut set_of_mesh: Vec<Option<u32>> = vec![None; scene.meshes.len()];
    for (index, instance) in scene.instances.iter().enumerate() {
        let index = index as u32;
        let mesh = &scene.meshes[instance.mesh as usize];
        if mesh.triangles.is_empty() {
            continue;
        }
        let Some(object_from_world) = spaces.object_from_world[index as usize] else {
            append_in_world(&mut world, scene, index);
            continue;
        };
        let set = *set_of_mesh[instance.mesh as usize].get_or_insert_with(|| {
            let named = |t: u32| NamedTriangle {
                triangle: mesh.triangle(t),
                instance: 0,
                index: t,
            };
            baked
                .sets
                .push((0..mesh.triangles.len() as u32).map(named).collect());
            baked.sets.len() as u32 - 1
        });
        let points = || {
            clusters[instance.mesh as usize]
                .iter()
                .map(|p| p.as_dvec3())
        };
        baked.placements.push(Placement {
            set,
            bounds: outward(points().map(|p| instance.world_from_object.transform_point3(p))),
            instance: Some(PlacedInstance {
                index,
                object_from_world,
                world_from_object: instance.world_from_object,
                object_radius: points().map(|p| p.length()).fold(0.0, f64::max),
            }),
        });
    }
    if !world.is_empty() {
        let bounds = world.iter().flat_map(|t| *t.triangle.corners()).collect();
        baked.placements.push(Placement {
            set: baked.sets.len() as u32,
            instance: None,
            bounds,
        });
        baked.sets.push(world);
    }
    baked
}

fn append_in_world(world: &mut TriangleSet, scene: &Scene, index: u32) {
    let instance: &Instance = &scene.instances[index as usize];
    let mesh = &scene.meshes[instance.mesh as usize];
    let points: Vec<_> = mesh
        .positions
        .iter()
        .map(|&p| instance.world_point(p))
        .collect();
    world.extend(mesh.triangles.iter().enumerate().map(|(t, corners)| {
        let [a, b, c] = corners.map(|v| points[v as usize]);
        NamedTriangle {
            triangle: Triangle::new(a, b, c),
            instance: index,
            index: t as u32,
        }
    }));
}

/// The smallest box of single precision that holds the points.
fn outward(points: impl Iterator<Item = DVec3>) -> Aabb {
    let (min, max) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| {
        (min.min(p), max.max(p))
    });
    let down = |x: f64| {
        if f64::from(x as f32) > x {
            (x as f32).next_down()
        } else {
            x as f32
        }
    };
    let up = |x: f64| -down(-x);
    Aabb {
        min: glam::Vec3::new(down(min.x), down(min.y), down(min.z)),
        max: glam::Vec3::new(up(max.x), up(max.y), up(max.z)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Part, TriangleMesh};
    use glam::Vec3;

    fn mesh() -> TriangleMesh {
        TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(0.0, 2.0, 3.0)],
            triangles: vec![[0, 1, 2]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 1,
                material: 0,
            }],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn meshes_used_once_go_to_the_world_and_shared_ones_stay() {
        let place = |mesh, x| {
            Instance::new(
                "",
                mesh,
                DAffine3::from_translation(DVec3::new(x, 0.0, 0.0)),
            )
        };
        let flat = Instance::new("", 1, DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0)));
        let scene = Scene {
            meshes: vec![mesh(), mesh(), TriangleMesh::default()],
            instances: vec![
                place(0, 5.0),
                place(1, 10.0),
                place(1, 20.0),
                flat,
                place(2, 0.0),
            ],
            ..Scene::default()
        };
        let baked = bake(&scene);
        assert_eq!(baked.sets.len(), 2);
        assert_eq!(baked.placements.len(), 3);
        // The one shared set, twice, in object space.
        assert_eq!(baked.sets[0][0].triangle, mesh().triangle(0));
        let indices: Vec<_> = baked
            .placements
            .iter()
            .map(|p| p.instance.as_ref().map(|i| i.index))
            .collect();
        assert_eq!(indices, [Some(1), Some(2), None]);
        assert_eq!(baked.placements[1].bounds.min, Vec3::new(20.0, 0.0, 0.0));
        // The single use and the flattened instance, in world space.
        let world: Vec<_> = baked.sets[1]
            .iter()
            .map(|t| (t.instance, t.triangle.corners()[2]))
            .collect();
        assert_eq!(
            world,
            [(0, Vec3::new(5.0, 2.0, 3.0)), (3, Vec3::new(0.0, 2.0, 0.0))]
        );
    }

    #[test]
    fn boxes_are_rounded_outwards() {
        let third = DVec3::new(1.0 / 3.0, -1.0 / 3.0, 0.5);
        let bounds = outward([third].into_iter());
        for axis in 0..3 {
            assert!(
                f64::from(bounds.min[axis]) <= third[axis]
                    && third[axis] <= f64::from(bounds.max[axis])
            );
        }
        assert_eq!((bounds.min.z, bounds.max.z), (0.5, 0.5));
    }
}
