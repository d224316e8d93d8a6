//! How much of a scene lies within a picture's frame.

use super::{CameraFrame, Scene};

/// Vertices that are looked at.
const LOOKED_AT: u64 = 1024;

impl Scene {
    /// The share of all placed vertices that lie within the frame of a picture of so many pixels, whatever is before them: of about a thousand, evenly taken. None of an empty scene.
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
    /// assert_eq!(Scene::default().share_in_frame(&frame, (640, 480)), 0.0);
    /// ```
    pub fn share_in_frame(&self, frame: &CameraFrame, (width, height): (u32, u32)) -> f64 {
        let vertices = |mesh: u32| self.meshes[mesh as usize].positions.len() as u64;
        let all: u64 = self.instances.iter().map(|i| vertices(i.mesh)).sum();
        let step = all.div_ceil(LOOKED_AT).max(1);
        let is_inside = |place: glam::DVec2| {
            let (right, bottom) = (f64::from(width), f64::from(height));
            (0.0..=right).contains(&place.x) && (0.0..=bottom).contains(&place.y)
        };
        let (mut before, mut looked_at, mut inside) = (0_u64, 0_u32, 0_u32);
        for instance in &self.instances {
            let count = vertices(instance.mesh);
            let mut vertex = before.next_multiple_of(step) - before;
            while vertex < count {
                let place = self.meshes[instance.mesh as usize].positions[vertex as usize];
                let place = frame.project(instance.world_point(place).as_dvec3());
                looked_at += 1;
                inside += u32::from(place.is_some_and(is_inside));
                vertex += step;
            }
            before += count;
        }
        f64::from(inside) / f64::from(looked_at.max(1))
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3, Vec3};

    use super::*;
    use crate::scene::{Camera, Instance, Projection, TriangleMesh};

    #[test]
    fn vertices_beside_and_behind_the_eye_are_not_in_the_frame() {
        // Straight away from the eye, ten of each mesh; the others beside and behind it.
        let mesh = TriangleMesh {
            positions: (1..=10).map(|i| Vec3::NEG_Z * i as f32).collect(),
            ..TriangleMesh::default()
        };
        let at = |x: f64, z: f64| DAffine3::from_translation(DVec3::new(x, 0.0, z));
        let placed = [at(0.0, 0.0), at(90.0, 0.0), at(0.0, 30.0), at(0.0, 5.5)];
        let mut scene = Scene {
            meshes: vec![mesh],
            instances: placed.map(|place| Instance::new("", 0, place)).to_vec(),
            ..Scene::default()
        };
        let camera = Camera {
            name: String::new(),
            position: Vec3::ZERO,
            focal_point: Vec3::NEG_Z,
            view_up: Vec3::Y,
            projection: Projection::Perspective { view_angle: 40.0 },
        };
        let frame = camera.frame(300, 200).expect("valid");
        let share = |scene: &Scene| scene.share_in_frame(&frame, (300, 200));
        assert_eq!(share(&scene), 15.0 / 40.0);
        // Of many, some are looked at.
        let at_first = scene.instances[0].clone();
        let behind = scene.instances[2].clone();
        scene.instances = [vec![at_first; 1500], vec![behind; 1500]].concat();
        let found = share(&scene);
        assert!((found - 0.5).abs() < 0.01, "{found}");
    }
}
