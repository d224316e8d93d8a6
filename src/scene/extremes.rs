//! How far a scene reaches: the greatest values of functions over all its points.

use glam::{DVec3, Vec3};

use super::Scene;
use crate::geometry::Aabb;

/// What rounding to single precision may move a point by, and more, as a share of its greatest coordinate.
const ROUNDING: f64 = 1e-6;

impl Scene {
    /// The greatest value of each of `N` functions over the points of [`Scene::clusters`] as they are placed, negative infinity where nothing is. The functions are linear but for a constant, and change by
    /// `steepest` a model unit at most: so an instance whose box has no greater value at its corners has none inside, and is passed by.
    pub(crate) fn extremes<const N: usize>(
        &self,
        steepest: f64,
        functions: impl Fn(Vec3) -> [f64; N],
    ) -> [f64; N] {
        let clusters = self.clusters();
        let boxes = clusters
            .iter()
            .map(|points| points.iter().copied().collect());
        let boxes: Vec<Aabb> = boxes.collect();
        let mut greatest = [f64::NEG_INFINITY; N];
        let greater = |all: [f64; N], point: Vec3| {
            let values = functions(point);
            std::array::from_fn(|i| all[i].max(values[i]))
        };
        for instance in &self.instances {
            let points = &clusters[instance.mesh as usize];
            if points.len() > 8 {
                let bounds = instance.world_bounds(&boxes[instance.mesh as usize]);
                let [low, high] = [bounds.min, bounds.max].map(Vec3::as_dvec3);
                let farthest = low.abs().max(high.abs()).max_element();
                let slack = steepest * ROUNDING * farthest;
                let most = bounds
                    .corners()
                    .into_iter()
                    .fold([f64::NEG_INFINITY; N], greater);
                if most
                    .iter()
                    .zip(&greatest)
                    .all(|(most, known)| most + slack <= *known)
                {
                    continue;
                }
            }
            let placed = points.iter().map(|&p| instance.world_point(p));
            greatest = placed.fold(greatest, greater);
        }
        greatest
    }

    /// The world-space box of all instances; empty when nothing is placed. Only vertices that a triangle uses count.
    pub fn bounds(&self) -> Aabb {
        let sides = |p: Vec3| {
            let p = p.as_dvec3();
            [p.x, p.y, p.z, -p.x, -p.y, -p.z]
        };
        let [x, y, z, nx, ny, nz] = self.extremes(1.0, sides);
        Aabb {
            min: -DVec3::new(nx, ny, nz).as_vec3(),
            max: DVec3::new(x, y, z).as_vec3(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, TriangleMesh};
    use glam::{DAffine3, DQuat};

    /// A hundred points on a ball, placed in many ways.
    fn scene(count: u32) -> Scene {
        let part = |i: u32, factor: u32| f64::from(i.wrapping_mul(factor) % 9973) / 9973.0;
        let point = |i: u32| {
            let turn = DQuat::from_rotation_y(7.0 * part(i, 7919))
                * DQuat::from_rotation_x(7.0 * part(i, 104_729));
            (turn * DVec3::X).as_vec3()
        };
        let mesh = TriangleMesh {
            positions: (0..100).map(point).collect(),
            triangles: (0..98).map(|i| [i, i + 1, i + 2]).collect(),
            ..TriangleMesh::default()
        };
        let place = |i: u32| {
            let turn = DQuat::from_rotation_z(9.0 * part(i, 31))
                * DQuat::from_rotation_x(9.0 * part(i, 57));
            let at = DVec3::new(part(i, 7919), part(i, 131), part(i, 2903)) * 1000.0;
            DAffine3::from_scale_rotation_translation(DVec3::splat(1.0 + part(i, 17)), turn, at)
        };
        Scene {
            meshes: vec![mesh],
            instances: (0..count).map(|i| Instance::new("", 0, place(i))).collect(),
            ..Scene::default()
        }
    }

    #[test]
    fn instances_that_are_passed_by_reach_no_further() {
        for count in [0, 1, 2, 50, 1000] {
            let scene = scene(count);
            let clusters = scene.clusters();
            let all: Aabb = scene.world_points(&clusters).collect();
            assert_eq!(scene.bounds(), all, "{count}");
            let slope = Vec3::new(0.3, -2.0, 0.7);
            let value = |p: Vec3| f64::from(p.dot(slope)) - 17.0;
            let expected = scene.world_points(&clusters).map(value);
            let expected = expected.fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(scene.extremes(3.0, |p| [value(p)]), [expected]);
        }
    }
}
