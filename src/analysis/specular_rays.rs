//! The rays that a mirror or clear glass in the place of a surface would send on, whatever its material is.

use super::view_rays::secondary;
use crate::geometry::Ray;
use crate::render::{Stage, Surface};
use glam::Vec3;

/// Inside over outside, where the material has no index of refraction that light could have: glass.
const USUAL_IOR: f32 = 1.5;

/// The ray that a mirror sends on, about the triangle's own normal. `None` if rounding leaves no direction.
pub(super) fn mirror_ray(ray: &Ray, surface: &Surface) -> Option<Ray> {
    let normal = surface.geometric_normal;
    let direction = ray.direction - normal * (2.0 * ray.direction.dot(normal));
    onward(surface, direction)
}

/// The ray that enters the other side by Snell's law, with the index of refraction of the surface's material; what is seen from behind is left. `None` where all
/// light is reflected.
pub(super) fn refraction_ray(stage: &Stage, ray: &Ray, surface: &Surface) -> Option<Ray> {
    let material = stage.scene.materials.get(surface.material as usize);
    let known = material.map(|m| m.ior).filter(|ior| *ior >= 1.0);
    let ior = known.unwrap_or(USUAL_IOR);
    let eta = if surface.is_front { ior } else { 1.0 / ior };
    let towards = ray.direction.normalize();
    let normal = if towards.dot(surface.geometric_normal) > 0.0 {
        -surface.geometric_normal
    } else {
        surface.geometric_normal
    };
    onward(surface, refracted(towards, normal, eta)?)
}

/// The direction behind a surface of light that comes along the unit vector `towards`; the normal points against it, `eta` is there over here.
fn refracted(towards: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cosine = -towards.dot(normal);
    let squared = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
    (squared >= 0.0).then(|| towards / eta + normal * (cosine / eta - squared.sqrt()))
}

fn onward(surface: &Surface, direction: Vec3) -> Option<Ray> {
    let ray = secondary(surface.origin_towards(direction), direction);
    ray.is_traceable().then_some(ray)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::render::SkyMode;

    #[test]
    fn refraction_follows_snell_and_is_total_beyond_the_critical_angle() {
        let normal = Vec3::new(0.0, 1.0, 0.0);
        let towards = Vec3::new(0.6, -0.8, 0.0);
        let inside = refracted(towards, normal, 1.5).unwrap();
        // Sines over the normal: 0.6 and 0.4.
        assert!((inside.x - 0.4).abs() < 1e-6 && inside.y < 0.0, "{inside}");
        assert!((inside.length() - 1.0).abs() < 1e-6);
        assert_eq!(refracted(towards, normal, 0.5), None);
        let straight = refracted(-normal, normal, 1.0 / 1.5).unwrap();
        assert!((straight + normal).length() < 1e-6);
    }

    #[test]
    fn mirrors_send_back_and_glass_lets_through() {
        let scene = crate::import::load(&["models/lecture-block.obj".into()]).unwrap();
        let accelerator = AcceleratorKind::Linear.build(&scene);
        let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Auto);
        let center = scene.bounds().center();
        let mut met = 0;
        for i in 0..40_u8 {
            let from = center + Vec3::new(5.0 - 0.1 * f32::from(i), 9.0, 1.0);
            let ray = Ray::new(from, center + Vec3::new(0.1, 0.2, 0.3) - from);
            let Some(hit) = accelerator.closest_hit(&ray) else {
                continue;
            };
            met += 1;
            let surface = Surface::at(&stage, &ray, hit);
            let side = |r: &Ray| r.direction.dot(surface.geometric_normal).signum();
            let [mirror, glass] = [
                mirror_ray(&ray, &surface).unwrap(),
                refraction_ray(&stage, &ray, &surface).unwrap(),
            ];
            assert_eq!(side(&mirror), -side(&ray));
            assert_eq!(side(&glass), side(&ray));
            assert_eq!((mirror.source.depth, glass.source.depth), (1, 1));
        }
        assert!(met > 10, "{met}");
    }
}
