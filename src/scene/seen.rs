//! Whether a picture shows a scene as a whole.

use super::{CameraFrame, Scene};
use crate::geometry::Aabb;

/// Vertices that are looked at.
const LOOKED_AT: u64 = 1024;

impl Scene {
    /// Whether a picture of so many pixels is taken from outside, and most of the scene lies within its frame, whatever is before it: as about a thousand vertices tell, which are evenly taken from all that are placed.
    ///
    /// ```
    /// use bspray::scene::{Camera, Projection, Scene};
    /// # use glam::Vec3;
    /// # let camera = Camera {
    /// #     name: String::new(),
    /// #     position: Vec3::Z,
    /// #     focal_point: Vec3::ZERO,
    /// #     view_up: Vec3::Y,
    /// #     projection: Projection::Perspective { view_angle: 40.0 },
    /// # };
    /// let frame = camera.frame(640, 480).expect("a camera with an eye and a focal point apart");
    /// assert!(!Scene::default().is_seen_whole(&frame, (640, 480)));
    /// ```
    pub fn is_seen_whole(&self, frame: &CameraFrame, (width, height): (u32, u32)) -> bool {
        let vertices = |mesh: u32| self.meshes[mesh as usize].positions.len() as u64;
        let all: u64 = self.instances.iter().map(|i| vertices(i.mesh)).sum();
        let step = all.div_ceil(LOOKED_AT).max(1);
        let is_inside = |place: glam::DVec2| {
            let (right, bottom) = (f64::from(width), f64::from(height));
            (0.0..=right).contains(&place.x) && (0.0..=bottom).contains(&place.y)
        };
        let (mut before, mut looked_at, mut inside) = (0_u64, 0_u32, 0_u32);
        let mut bounds = Aabb::EMPTY;
        for instance in &self.instances {
            let count = vertices(instance.mesh);
            let mut vertex = before.next_multiple_of(step) - before;
            while vertex < count {
                let place = self.meshes[instance.mesh as usize].positions[vertex as usize];
                let point = instance.world_point(place);
                bounds = bounds.grown(point);
                let place = frame.project(point.as_dvec3());
                looked_at += 1;
                inside += u32::from(place.is_some_and(is_inside));
                vertex += step;
            }
            before += count;
        }
        let [_, _, _, eye] = frame.world_from_camera();
        !bounds.contains(eye.as_vec3()) && 2 * inside > looked_at
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3, Vec3};

    use super::*;
    use crate::scene::{Camera, Instance, Projection, TriangleMesh};

    /// Ten vertices straight away from the eye, placed as often.
    fn scene(places: &[(f64, f64)]) -> Scene {
        let mesh = TriangleMesh {
            positions: (1..=10).map(|i| Vec3::NEG_Z * i as f32).collect(),
            ..TriangleMesh::default()
        };
        let at = |&(x, z): &(f64, f64)| DAffine3::from_translation(DVec3::new(x, 0.0, z));
        let placed = places.iter().map(|place| Instance::new("", 0, at(place)));
        Scene {
            instances: placed.collect(),
            meshes: vec![mesh],
            ..Scene::default()
        }
    }

    #[test]
    fn what_is_behind_or_beside_the_eye_or_around_it_is_not_seen_whole() {
        let camera = Camera {
            name: String::new(),
            position: Vec3::ZERO,
            focal_point: Vec3::NEG_Z,
            view_up: Vec3::Y,
            projection: Projection::Perspective { view_angle: 40.0 },
        };
        let frame = camera.frame(300, 200).expect("valid");
        let is_whole = |places: &[(f64, f64)]| scene(places).is_seen_whole(&frame, (300, 200));
        assert!(is_whole(&[(0.0, 0.0)]));
        assert!(is_whole(&[(0.0, 0.0), (0.0, -3.0), (90.0, 0.0)]));
        assert!(
            !is_whole(&[(0.0, 0.0), (90.0, 0.0), (-90.0, 0.0)]),
            "beside it"
        );
        assert!(!is_whole(&[(0.0, 30.0)]), "behind it");
        assert!(
            !is_whole(&[(0.0, 0.0), (0.0, -3.0), (0.0, 5.5)]),
            "around it"
        );
        // Of many, some are looked at.
        let many = |behind: usize| [vec![(0.0, 0.0); 3000], vec![(90.0, -5.0); behind]].concat();
        assert!(is_whole(&many(2900)) && !is_whole(&many(3100)));
    }
}
