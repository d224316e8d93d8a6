//! Point clusters: points whose convex hull encloses an object (the lecture's "Building Box and Sphere Extents").
//!
//! A mesh's vertex list is its cluster. Affine maps keep inside-ness: what lies in the hull of some points lies, transformed, in the hull of the
//! transformed points. Box and sphere depend on the hull alone, all but the centroid; so a cluster keeps only the vertices of its hull, and the
//! centroid of the full list beside them, and no others are transformed for each instance.
//!
//! # The lecture's numbers
//!
//! The lecture wraps round shapes in polyhedra and uses their corners. Tests here reproduce or correct its numbers:
//!
//! - An icosahedron around the unit sphere needs its corners at `sqrt(15 / (5 + 2 sqrt 5))` = 1.2584 (the lecture: "about 1.26", which is safe): then its faces touch the sphere.
//! - A hexagonal prism around a unit cylinder needs its corners at `2 / sqrt 3` = 1.1547. The lecture's 4/3 encloses the cylinder, but is not
//!   "snug" as it says: the sides stand off by 0.1547, and a section has 4/3 of the area that it needs.
//! - A full test that costs `m` = 20 extent tests and a share `f` = 1/40 of rays that reach the extent give a speed ratio `m / (1 + f m)` of 13 1/3 ("about 13"): see
//!   [`speed_ratio`](super::speed_ratio).
//!
//! # Where the lecture's code is not what its text says
//!
//! - `rayHitsSphereExtent` tests a line, not a ray: it accepts spheres behind the origin. Ours rejects them.
//! - `r.recurseLevel == 0 && r.col < left || r.col > right || ...`: `&&` binds tighter than `||`, so that only the first comparison is restricted to eye
//!   rays, and the others cull secondary rays, which know no pixel. Ours asks for an eye ray first.
//! - "Test whether the discriminant is positive", but the code counts zero as a hit, as it must: a ray may touch an object where that touches its sphere.
//! - The sphere about the centroid encloses, but is not the smallest: for unevenly spread vertices it may be almost twice as wide. We have both.

use glam::{DAffine3, DVec3, Vec3};

use super::{hull, smallest};
use crate::geometry::{Aabb, BoundingSphere};

/// Points whose convex hull encloses an object, reduced to those that span it.
///
/// ```
/// use bspray::accel::extents::PointCluster;
/// use glam::{DAffine3, DVec3, Vec3};
/// // A box of 1 x 2 x 3 with a point inside.
/// let corner = |i: u32| Vec3::new((i & 1) as f32, (i & 2) as f32, (i & 4) as f32 * 0.75);
/// let mut points: Vec<Vec3> = (0..8).map(corner).collect();
/// points.push(Vec3::new(0.5, 0.5, 0.5));
/// let cluster = PointCluster::new(&points).expect("there are points, and they are finite");
/// assert_eq!((cluster.count(), cluster.hull().len()), (9, 8));
/// assert_eq!(cluster.bounds().max, Vec3::new(1.0, 2.0, 3.0));
/// let map = DAffine3::from_scale(DVec3::new(2.0, 1.0, -1.0));
/// let placed = cluster.transformed(&map).expect("in range");
/// assert_eq!(placed.bounds().min, Vec3::new(0.0, 0.0, -3.0));
/// let sphere = placed.smallest_sphere().expect("in range");
/// assert!((sphere.radius - 17.0_f32.sqrt() / 2.0).abs() < 1e-6);
/// ```
#[derive(Clone, Debug)]
pub struct PointCluster {
    /// In the list's order.
    hull: Vec<Vec3>,
    centroid: DVec3,
    count: usize,
}

impl PointCluster {
    /// The cluster of a list of points; `None` for an empty list, or if a coordinate is not finite.
    ///
    /// The hull is found without rounding, also of flat, straight, duplicate and single points; a few points within its flat sides may stay.
    pub fn new(points: &[Vec3]) -> Option<Self> {
        if points.is_empty() || !points.iter().all(|p| p.is_finite()) {
            return None;
        }
        let sum: DVec3 = points.iter().map(|p| p.as_dvec3()).sum();
        Some(Self {
            hull: hull::vertices(points)
                .into_iter()
                .map(|i| points[i as usize])
                .collect(),
            centroid: sum / points.len() as f64,
            count: points.len(),
        })
    }

    /// The points that span the hull.
    pub fn hull(&self) -> &[Vec3] {
        &self.hull
    }

    /// How many points the full list had.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The mean of the full list, in double precision.
    pub fn centroid(&self) -> DVec3 {
        self.centroid
    }

    /// The cluster of the transformed object: each point in double precision, and rounded once, the centroid with them. `None` if that
    /// leaves the range of single precision.
    pub fn transformed(&self, map: &DAffine3) -> Option<Self> {
        let place = |p: &Vec3| map.transform_point3(p.as_dvec3()).as_vec3();
        let hull: Vec<Vec3> = self.hull.iter().map(place).collect();
        hull.iter().all(|p| p.is_finite()).then_some(Self {
            hull,
            centroid: map.transform_point3(self.centroid),
            count: self.count,
        })
    }

    /// The axis-aligned box that just holds the points, exactly.
    pub fn bounds(&self) -> Aabb {
        self.hull.iter().copied().collect()
    }

    /// The lecture's sphere: about the centroid of the full list. `None` if it leaves the range of single precision.
    pub fn centroid_sphere(&self) -> Option<BoundingSphere> {
        BoundingSphere::around(self.centroid.as_vec3(), &self.hull)
    }

    /// The smallest sphere, up to rounding. It holds all points. `None` if it leaves the range of single precision.
    pub fn smallest_sphere(&self) -> Option<BoundingSphere> {
        let points: Vec<DVec3> = self.hull.iter().map(|p| p.as_dvec3()).collect();
        BoundingSphere::around(smallest::center(&points)?.as_vec3(), &self.hull)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3Swizzles;

    /// Corners of an icosahedron at a distance from the origin, and its faces: triples of corners that are neighbours of one another.
    fn icosahedron(radius: f64) -> (Vec<Vec3>, Vec<[DVec3; 3]>) {
        let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
        let mut corners = Vec::new();
        for (one, long) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let corner = DVec3::new(0.0, one, long * golden).normalize() * radius;
            corners.extend([corner, corner.zxy(), corner.yzx()]);
        }
        let edge = corners
            .iter()
            .skip(1)
            .map(|c| c.distance(corners[0]))
            .fold(f64::INFINITY, f64::min);
        let touches = |a: usize, b: usize| corners[a].distance(corners[b]) < 1.01 * edge;
        let mut faces = Vec::new();
        for a in 0..12 {
            for b in a + 1..12 {
                for c in b + 1..12 {
                    if touches(a, b) && touches(b, c) && touches(a, c) {
                        faces.push([corners[a], corners[b], corners[c]]);
                    }
                }
            }
        }
        (corners.iter().map(|c| c.as_vec3()).collect(), faces)
    }

    #[test]
    fn the_faces_of_the_icosahedron_touch_the_unit_sphere() {
        let needed = (15.0 / (5.0 + 2.0 * 5.0_f64.sqrt())).sqrt();
        assert!((needed - 1.2584).abs() < 5e-5 && needed < 1.26);
        let (corners, faces) = icosahedron(needed);
        assert_eq!((corners.len(), faces.len()), (12, 20));
        for [a, b, c] in faces {
            let normal = (b - a).cross(c - a).normalize();
            assert!((normal.dot(a).abs() - 1.0).abs() < 1e-12);
        }
        let cluster = PointCluster::new(&corners).unwrap();
        assert_eq!(cluster.hull().len(), 12);
        assert!((f64::from(cluster.smallest_sphere().unwrap().radius) - needed).abs() < 1e-6);
    }

    /// Distance of the sides of a prism over a regular hexagon from its axis.
    fn side_distance(radius: f64) -> f64 {
        let corner = |i: f64| {
            let angle = i * std::f64::consts::FRAC_PI_3;
            DVec3::new(libm::cos(angle), libm::sin(angle), 0.0) * radius
        };
        corner(0.0).midpoint(corner(1.0)).length()
    }

    #[test]
    fn the_prism_is_snug_at_two_over_root_three_and_not_at_four_thirds() {
        assert!((side_distance(2.0 / 3.0_f64.sqrt()) - 1.0).abs() < 1e-12);
        assert!((2.0 / 3.0_f64.sqrt() - 1.1547).abs() < 5e-5);
        // The lecture's 4/3 encloses the cylinder at a distance.
        assert!((side_distance(4.0 / 3.0) - 1.1547).abs() < 5e-5);
    }

    #[test]
    fn the_centroid_is_that_of_the_full_list_also_when_transformed() {
        // Ten points on one end pull the centroid there; all but one are within the hull.
        let mut points = vec![
            Vec3::ZERO,
            Vec3::new(4.0, 0.0, 0.0),
            Vec3::new(4.0, 2.0, 0.0),
        ];
        points.extend([Vec3::new(3.9, 0.1, 0.0); 9]);
        let cluster = PointCluster::new(&points).unwrap();
        assert_eq!((cluster.count(), cluster.hull().len()), (12, 3));
        let mean = points.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / 12.0;
        assert!((cluster.centroid() - mean).length() < 1e-12);
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::new(1.0, 2.0, -3.0),
            glam::DQuat::from_rotation_y(0.3),
            DVec3::new(5.0, 6.0, 7.0),
        );
        let placed = cluster.transformed(&map).unwrap();
        assert!((placed.centroid() - map.transform_point3(mean)).length() < 1e-12);
        let [small, lecture] = [placed.smallest_sphere(), placed.centroid_sphere()];
        assert!(small.unwrap().radius < 0.8 * lecture.unwrap().radius);
    }

    #[test]
    fn clusters_of_nothing_or_without_measure_do_not_exist() {
        assert!(PointCluster::new(&[]).is_none());
        assert!(PointCluster::new(&[Vec3::NAN]).is_none());
        let point = PointCluster::new(&[Vec3::ONE]).unwrap();
        assert!(point.smallest_sphere().unwrap().radius == 0.0);
        let huge = DAffine3::from_scale(DVec3::splat(1e40));
        assert!(point.transformed(&huge).is_none());
    }
}
