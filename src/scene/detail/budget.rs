//! How large an error in the world may be, for what a picture shows of it.
//!
//! **Eye rays.** A point that is moved by `e` at depth `z` and angle `θ` from the view axis moves on the screen by at most `e / (z cos θ)` screen units at distance 1, which at distance
//! `d = z / cos θ` is `e / (d cos² θ)`. With `θ` at the picture's corner and `d` the distance to the nearest part of a mesh, that holds for all that is seen of it.
//! A thin lens moves the eye by its radius at most; what it blurs needs less.
//!
//! **Mirrors.** Light that comes by way of a flat mirror has gone at least as far as the straight way (the triangle inequality), so `d` does, wherever the mesh is: also behind the
//! eye. A convex mirror makes its picture smaller. Concave mirrors and lenses magnify without a bound of their own: in scenes with solid glass or smooth metal, everything has to be [`MAGNIFIED`]
//! times as exact, as under a good loupe.
//!
//! **Shadows.** A caster moved by `e` moves its shadow by `e` too, times `(light to receiver) / (light to caster)`, and the receiver may be nearer to the eye than the caster. Under lights
//! of no size, shadows are sharp: then the pixels of the nearest surface of all count for every mesh. Sun, sky and emitters have a size. Far from the caster, where receivers may be nearer to the eye, its shadow is
//! soft: of the sun's width, 0.53 degrees, half a pixel (0.03 degrees at 720 rows of 40 degrees) is 5 %.

use glam::DVec3;

use super::DetailOptions;
use super::chunks::Piece;
use crate::geometry::Triangle;
use crate::scene::{CameraFrame, Instance, LightKind, Material, Scene, TriangleMesh};

/// By how much lenses and concave mirrors may magnify.
const MAGNIFIED: f64 = 4.0;

/// Roughness below which metal shows pictures of other surfaces.
const SMOOTH: f32 = 0.25;

/// Triangles of a mesh, times its instances, up to which the distance of each is looked at where that of the box is small.
const MOST_PLACED: usize = 4_000_000;

/// A view, as far as the size of its pixels goes.
struct Eye {
    place: DVec3,
    /// Least width of a pixel at distance 0, and what a unit of distance adds, in model units.
    pixel: (f64, f64),
    /// How far rays start from the place at most.
    radius: f64,
}

impl Eye {
    fn new(view: &CameraFrame, (width, height): (u32, u32)) -> Self {
        let half = view.half_size();
        let pixel = 2.0 * half.1 / f64::from(height);
        let pixel = if view.is_perspective() {
            let corner = 1.0 + half.0 * half.0 + half.1 * half.1;
            (0.0, pixel / corner)
        } else if view.has_screen() {
            (pixel, 0.0)
        } else {
            use std::f64::consts::{PI, TAU};
            (0.0, (TAU / f64::from(width)).min(PI / f64::from(height)))
        };
        Self {
            place: view.world_from_camera()[3],
            pixel,
            radius: view.lens().map_or(0.0, |lens| lens.radius),
        }
    }

    /// Least width of a pixel on what is no nearer than a distance, in model units.
    fn pixel_at(&self, distance: f64) -> f64 {
        self.pixel.0 + self.pixel.1 * (distance - self.radius).max(0.0)
    }
}

/// A light without size, whose shadows are sharp.
struct Sharp {
    place: DVec3,
    /// Greatest distance of a receiver.
    reach: f64,
}

/// What errors may be.
pub(super) struct Budget {
    pub(super) pixels: f64,
    eyes: Vec<Eye>,
    magnified: f64,
    /// Width of the least pixel on any surface, where shadows are sharp.
    nearest: Option<f64>,
    /// Lights near which shadows grow.
    lights: Vec<Sharp>,
}

impl Budget {
    pub(super) fn new(scene: &Scene, options: &DetailOptions) -> Self {
        let magnifies = |material: &Material| {
            material.is_solid() || (material.metallic > 0.5 && material.roughness < SMOOTH)
        };
        let mut budget = Self {
            pixels: options.budget,
            eyes: options
                .views
                .iter()
                .map(|view| Eye::new(view, options.size))
                .collect(),
            magnified: if scene.materials.iter().any(magnifies) {
                MAGNIFIED
            } else {
                1.0
            },
            nearest: None,
            lights: Vec::new(),
        };
        if scene.lights.is_empty() {
            return budget;
        }
        let bounds = scene.bounds();
        let standing = scene.lights.iter();
        let standing = standing.filter(|light| light.kind != LightKind::Directional);
        budget.lights = standing
            .map(|light| {
                let farthest = (light.position - bounds.min)
                    .abs()
                    .max((light.position - bounds.max).abs());
                let farthest = farthest.as_dvec3().length();
                let range = light.range.map_or(f64::INFINITY, f64::from);
                Sharp {
                    place: light.position.as_dvec3(),
                    reach: farthest.min(range),
                }
            })
            .collect();
        let mut uses = vec![0; scene.meshes.len()];
        for instance in &scene.instances {
            uses[instance.mesh as usize] += 1;
        }
        let all: Vec<Piece> = scene.meshes.iter().map(Piece::all).collect();
        let pixel = |instance: &Instance| {
            let mesh = instance.mesh as usize;
            budget.pixel(&all[mesh], &scene.meshes[mesh], instance, uses[mesh])
        };
        let pixels = scene.instances.iter().map(pixel);
        budget.nearest = Some(pixels.fold(f64::INFINITY, f64::min));
        budget
    }

    /// Error in object space that a piece of an instance's mesh may have; `uses`: how many instances show the mesh.
    pub(super) fn error(
        &self,
        piece: &Piece,
        mesh: &TriangleMesh,
        instance: &Instance,
        uses: usize,
    ) -> f64 {
        let mut pixel = self.pixel(piece, mesh, instance, uses);
        if let Some(nearest) = self.nearest {
            let bounds = instance.world_bounds(&piece.bounds);
            let grown = |light: &Sharp| light.reach / bounds.distance(light.place);
            let grown = self.lights.iter().map(grown).fold(1.0, f64::max);
            pixel = pixel.min(nearest / grown);
        }
        let error = self.pixels * pixel / self.magnified / instance.greatest_scale();
        if error.is_finite() { error } else { 0.0 }
    }

    /// Width of the least pixel that can lie on a piece, in model units.
    fn pixel(&self, piece: &Piece, mesh: &TriangleMesh, instance: &Instance, uses: usize) -> f64 {
        let bounds = instance.world_bounds(&piece.bounds);
        let diagonal = f64::from(bounds.diagonal());
        let is_cheap = piece.len() <= MOST_PLACED / uses.max(1);
        let pixel = |eye: &Eye| {
            let mut distance = bounds.distance(eye.place);
            if distance < diagonal && is_cheap {
                let triangles = piece.triangles();
                let nearest = triangles.map(|triangle| {
                    let corners = mesh.triangles[triangle as usize];
                    let [a, b, c] =
                        corners.map(|v| instance.world_point(mesh.positions[v as usize]));
                    Triangle::new(a, b, c).squared_distance(eye.place)
                });
                distance = nearest.fold(f64::INFINITY, f64::min).sqrt();
            }
            eye.pixel_at(distance)
        };
        self.eyes.iter().map(pixel).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Light, Projection};
    use glam::{DAffine3, DMat3, Vec3};

    /// A triangle at a depth of 4 to 6 before the camera.
    fn scene(lights: Vec<Light>) -> Scene {
        let mesh = TriangleMesh {
            positions: vec![
                Vec3::new(-0.5, 0.0, -4.0),
                Vec3::new(0.5, 0.0, -4.0),
                Vec3::new(0.0, 1.0, -6.0),
            ],
            triangles: vec![[0, 1, 2]],
            ..TriangleMesh::default()
        };
        Scene {
            meshes: vec![mesh],
            instances: vec![Instance::new("", 0, DAffine3::IDENTITY)],
            lights,
            ..Scene::default()
        }
    }

    fn camera(projection: Projection) -> CameraFrame {
        let camera = Camera {
            name: String::new(),
            position: Vec3::ZERO,
            focal_point: Vec3::NEG_Z,
            view_up: Vec3::Y,
            projection,
        };
        camera.frame(300, 200).expect("valid")
    }

    fn error(scene: &Scene, view: CameraFrame) -> f64 {
        let options = DetailOptions {
            views: vec![view],
            size: (300, 200),
            budget: 0.5,
        };
        let mesh = &scene.meshes[0];
        let budget = Budget::new(scene, &options);
        budget.error(&Piece::all(mesh), mesh, &scene.instances[0], 1)
    }

    #[test]
    fn an_error_in_budget_moves_nothing_by_more_on_the_screen() {
        for projection in [
            Projection::Perspective { view_angle: 70.0 },
            Projection::Orthographic { height: 3.0 },
            Projection::Panoramic,
        ] {
            let view = camera(projection);
            let found = error(&scene(Vec::new()), view);
            let (mut most, mut count) = (0.0_f64, 0);
            // Points of the nearest distance all over the picture, moved all ways. Rows near a panorama's poles are no pixels' width.
            for i in 0..20_000_u32 {
                let part = |n: u32| f64::from(i.wrapping_mul(n) % 9973) / 9973.0;
                let rows = if view.has_screen() {
                    0.0..200.0
                } else {
                    90.0..110.0
                };
                let row = rows.start + part(7919) * (rows.end - rows.start);
                let ray = view.ray(part(104_729) * 300.0, row, None);
                let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * 4.0;
                let turn =
                    DMat3::from_rotation_x(part(31) * 7.0) * DMat3::from_rotation_y(part(57) * 7.0);
                let moved = view.project(point + turn * DVec3::X * found);
                if let (Some(from), Some(to)) = (view.project(point), moved) {
                    most = most.max(view.way(from, to).length());
                    count += 1;
                }
            }
            assert!(
                count > 19_000 && 0.4 < most && most < 0.51,
                "{projection:?} {most}"
            );
        }
    }

    #[test]
    fn sharp_shadows_and_glass_ask_for_more() {
        let view = camera(Projection::Perspective { view_angle: 70.0 });
        let plain = error(&scene(Vec::new()), view);
        let light = |x: f32, kind| Light {
            name: String::new(),
            kind,
            intensity: Vec3::ONE,
            position: Vec3::new(x, 0.0, -4.0),
            direction: Vec3::NEG_Y,
            range: Some(5.0),
        };
        // All that there is is as near as the nearest.
        let sun = error(&scene(vec![light(0.0, LightKind::Directional)]), view);
        assert!((sun / plain - 1.0).abs() < 1e-12);
        // One unit from the caster, which it can throw five times as large at most; here there are receivers up to about 2.7 away.
        let lamp = error(&scene(vec![light(1.5, LightKind::Point)]), view);
        let far = DVec3::new(2.0, 1.0, 2.0).length();
        assert!((lamp * far / plain - 1.0).abs() < 1e-6, "{lamp} {plain}");
        let mut glass = scene(Vec::new());
        glass.materials.push(Material {
            metallic: 1.0,
            roughness: 0.1,
            ..Material::default()
        });
        assert!((error(&glass, view) * MAGNIFIED / plain - 1.0).abs() < 1e-12);
    }
}
