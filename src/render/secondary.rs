//! The rays that leave a surface, one of each kind, for those who measure tracing rather than light.

use super::integrator::shadow_ray_to;
use super::lights::{Incident, cosine_hemisphere};
use super::sampler::Sampler;
use super::stage::Stage;
use super::surface::Surface;
use crate::geometry::{Interval, Ray, RayOrigin};

/// The ray from the surface to one light: a punctual light, a point of the emissive triangles or of the environment (its sun, if the rest is even), chosen evenly among those
/// there are. `None` without a light, and if the surface turns its back on it.
pub fn shadow_ray(stage: &Stage, surface: &Surface, sampler: &mut Sampler) -> Option<Ray> {
    let lights = &stage.lights;
    let punctual: Vec<_> = lights.punctual(surface.position).collect();
    let environment = stage.environment.as_ref();
    let (emitters, sun) = (lights.has_emitters(), environment.is_some());
    let count = punctual.len() + usize::from(emitters) + usize::from(sun);
    let choice = (sampler.next_1d() * count as f32) as usize;
    let incident = match punctual.get(choice.min(count.checked_sub(1)?)) {
        Some(incident) => *incident,
        None if emitters && choice == punctual.len() => {
            let which = sampler.next_1d();
            lights.emitter(stage, &surface.receiver(stage), which, sampler.next_2d())?
        }
        None => {
            let (environment, numbers) = (environment?, sampler.next_2d());
            let found = environment.search(numbers);
            Incident::far(&found.or_else(|| environment.sample(numbers))?)
        }
    };
    let faces = incident.direction.dot(surface.geometric_normal) > 0.0;
    faces.then(|| shadow_ray_to(surface, &incident, 1))
}

/// A ray into the hemisphere above the surface, chosen by its cosine with the numbers given, that ends at `distance` (model
/// units; may be infinite).
pub fn hemisphere_ray(surface: &Surface, numbers: [f32; 2], distance: f32) -> Ray {
    let direction = cosine_hemisphere(surface.geometric_normal, numbers);
    let source = RayOrigin {
        depth: 1,
        pixel: None,
    };
    Ray {
        interval: Interval::new(0.0, distance),
        source,
        ..Ray::new(surface.origin_towards(direction), direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::render::SkyMode;
    use crate::scene::{Instance, Material, Part, Scene, TriangleMesh};
    use glam::{DAffine3, Vec3};

    fn floor() -> Scene {
        let mesh = TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::Z * 3.0, Vec3::X * 2.0],
            triangles: vec![[0, 1, 2]],
            parts: vec![Part {
                first_triangle: 0,
                triangle_count: 1,
                material: 0,
            }],
            ..TriangleMesh::default()
        };
        Scene {
            meshes: vec![mesh],
            instances: vec![Instance::new("floor", 0, DAffine3::IDENTITY)],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    #[test]
    fn rays_leave_on_the_side_that_is_seen_and_darkness_sends_none() {
        let scene = floor();
        let accelerator = AcceleratorKind::Linear.build(&scene);
        let eye = Ray::new(Vec3::new(0.5, 2.0, 0.5), Vec3::NEG_Y);
        let hit = accelerator.closest_hit(&eye).expect("the floor is below");
        for (sky, is_lit) in [(SkyMode::On, true), (SkyMode::Off, false)] {
            let stage = Stage::new(&scene, &*accelerator, Vec3::Y, sky);
            let surface = Surface::at(&stage, &eye, hit);
            let mut sampler = Sampler::new(3, 4, 0, 5);
            let shadow = shadow_ray(&stage, &surface, &mut sampler);
            assert_eq!(shadow.is_some(), is_lit);
            let above = |ray: &Ray| ray.direction.y > 0.0 && !accelerator.any_hit(ray);
            assert!(shadow.is_none_or(|ray| above(&ray)));
            let ray = hemisphere_ray(&surface, sampler.next_2d(), 0.25);
            assert!(above(&ray) && ray.interval.max == 0.25);
        }
    }
}
