//! The extents of one placed object, with the margins that its rays' rounding asks for.
//!
//! An object's triangles are tested in one space, which is fixed ([`TestSpaces`](crate::accel::TestSpaces)); its extents only tell whether to test. A ray
//! is exact in world space, and rounded in object space. So where the triangles are in object space the extents there need no margin,
//! and those in world space must reach as far as the rounded ray passes beside the exact one; and the other way round.

use glam::DAffine3;

use super::bounds::{BoxExtent, SphereExtent};
use super::choice::{ExtentSphere, ExtentTest};
use super::cluster::PointCluster;
use super::ray::ExtentRay;
use super::screen::{ScreenExtent, View};
use crate::accel::bake::object_ray;
use crate::accel::placement::PlacementNorms;
use crate::geometry::tolerance::{CLUSTER_ERROR, EXTENT_MOST_SKEW};
use crate::geometry::{Aabb, BoundingSphere, Ray};
use crate::scene::Instance;

/// Box and sphere in one space, as they are.
#[derive(Clone, Copy, Debug)]
pub struct ExtentShapes {
    /// The axis-aligned box.
    pub bounds: Aabb,
    /// The sphere; `None` beyond single precision.
    pub sphere: Option<BoundingSphere>,
}

impl ExtentShapes {
    fn of(cluster: &PointCluster, sphere: ExtentSphere) -> Self {
        Self {
            bounds: cluster.bounds(),
            sphere: match sphere {
                ExtentSphere::Smallest => cluster.smallest_sphere(),
                ExtentSphere::Centroid => cluster.centroid_sphere(),
            },
        }
    }
}

/// The tests of the extents in one space.
#[derive(Clone, Copy, Debug, Default)]
struct Tests {
    sphere: Option<SphereExtent>,
    bounds: Option<BoxExtent>,
    /// Whether the margin is for rays that start near the scene.
    is_for_near_rays: bool,
}

impl Tests {
    fn new(shapes: &ExtentShapes, margin: f64, is_for_near_rays: bool) -> Self {
        let margin = (margin as f32).next_up();
        Self {
            sphere: shapes.sphere.and_then(|s| SphereExtent::new(&s, margin)),
            bounds: BoxExtent::new(&shapes.bounds, margin),
            is_for_near_rays,
        }
    }
}

/// The extents of one placed object.
#[derive(Clone, Debug)]
pub struct ObjectExtents {
    /// In object space; the sphere does not know of the placement.
    pub object: ExtentShapes,
    /// In world space; `None` if the placement leaves single precision.
    pub world: Option<ExtentShapes>,
    /// On the screen, if it was built for a view.
    pub screen: Option<ScreenExtent>,
    in_world: Tests,
    in_object: Tests,
    object_from_world: Option<DAffine3>,
    /// Whether the triangles are tested in object space.
    is_tested_in_object: bool,
}

impl ObjectExtents {
    /// The extents of an instance whose mesh has this cluster. `reach` is how far rays that count as near start from the placement's translation
    /// at most.
    pub(in crate::accel) fn new(
        instance: &Instance,
        cluster: &PointCluster,
        is_tested_in_object: bool,
        sphere: ExtentSphere,
        reach: f64,
        view: Option<&View>,
    ) -> Self {
        let placement = &instance.world_from_object;
        let object_from_world = instance.object_from_world();
        let norms = object_from_world.map(|inverse| PlacementNorms::of(placement, &inverse));
        let norms = norms.filter(|n| n.skew <= EXTENT_MOST_SKEW);
        let radius = cluster
            .hull()
            .iter()
            .fold(0.0_f64, |r, p| r.max(p.as_dvec3().length()));
        let object = ExtentShapes::of(cluster, sphere);
        let placed = cluster.transformed(placement);
        let world = placed.as_ref().map(|c| ExtentShapes::of(c, sphere));
        let greatest = placed.as_ref().map_or(0.0, |cluster| {
            let coordinates = cluster.hull().iter().map(|p| p.abs().max_element());
            f64::from(coordinates.fold(0.0, f32::max))
        });
        // A point of the object as it is tested, beside the hull in world space.
        let rounding = CLUSTER_ERROR * greatest;
        let world_margin = |reach: f64| match (&norms, is_tested_in_object) {
            (_, false) => Some(rounding),
            (Some(norms), true) => Some(rounding + norms.world_error(radius, reach)),
            (None, true) => None,
        };
        let in_world = world.as_ref().zip(world_margin(reach));
        let in_world = in_world.map(|(shapes, m)| Tests::new(shapes, m, is_tested_in_object));
        let object_margin = match (&norms, is_tested_in_object) {
            (_, true) => Some(0.0),
            (Some(norms), false) => {
                Some(norms.inverse * rounding + norms.object_error(radius, reach))
            }
            (None, false) => None,
        };
        let in_object = object_margin.map(|m| Tests::new(&object, m, !is_tested_in_object));
        let screen = view.zip(placed.as_ref()).and_then(|(view, placed)| {
            let reach = view.origin_distance(placement.translation);
            Some(ScreenExtent::new(placed.hull(), world_margin(reach)?, view))
        });
        Self {
            object,
            world,
            screen,
            in_world: in_world.unwrap_or_default(),
            in_object: in_object.unwrap_or_default(),
            object_from_world,
            is_tested_in_object,
        }
    }

    /// Whether the object has the extent that a test needs: not without a view or an inverse, and not beyond the range of the tests.
    pub fn has(&self, test: ExtentTest) -> bool {
        match test {
            ExtentTest::Screen => self.screen.is_some(),
            ExtentTest::SphereWorld => self.in_world.sphere.is_some(),
            ExtentTest::BoxWorld => self.in_world.bounds.is_some(),
            ExtentTest::SphereObject => {
                self.in_object.sphere.is_some() && self.object_from_world.is_some()
            }
            ExtentTest::BoxObject => {
                self.in_object.bounds.is_some() && self.object_from_world.is_some()
            }
        }
    }

    /// Whether the triangles are tested in object space, so that a ray that gets to them is transformed anyway.
    pub fn is_tested_in_object(&self) -> bool {
        self.is_tested_in_object
    }

    /// The ray in object space; `None` without an inverse. It may have left single precision, and then is not traceable.
    pub fn object_ray(&self, ray: &Ray) -> Option<Ray> {
        Some(object_ray(self.object_from_world.as_ref()?, ray))
    }

    /// Whether a ray may hit the object within its interval, by one test. A test that the object has not admits all rays. `in_object` is the
    /// prepared form of [`ObjectExtents::object_ray`], which tests in object space need. Adds the planes of boxes that were looked at.
    #[inline]
    pub fn admits(
        &self,
        test: ExtentTest,
        ray: &Ray,
        world: &WorldRay,
        in_object: Option<&ExtentRay>,
        planes: &mut u32,
    ) -> bool {
        let (tests, prepared) = match test {
            ExtentTest::Screen => return self.screen.is_none_or(|s| s.admits(ray)),
            _ if test.is_in_object_space() => (&self.in_object, in_object),
            _ => (&self.in_world, Some(&world.ray)),
        };
        let Some(prepared) = prepared.filter(|_| world.is_near || !tests.is_for_near_rays) else {
            return true;
        };
        if matches!(test, ExtentTest::SphereWorld | ExtentTest::SphereObject) {
            tests.sphere.is_none_or(|s| s.admits(prepared))
        } else {
            tests.bounds.is_none_or(|b| b.admits(prepared, planes))
        }
    }
}

/// A ray in world space, made ready once for all objects.
#[derive(Clone, Copy, Debug)]
pub struct WorldRay {
    /// For tests in world space.
    pub ray: ExtentRay,
    /// Whether it starts near the scene, so that the margins for rounding in object space hold.
    pub is_near: bool,
    /// Whether it is an eye ray, which alone is asked for its pixel: others pay nothing for screen extents.
    pub has_pixel: bool,
}
