//! Pictures of the geometry alone, which need no further rays.

use glam::Vec3;

use super::super::surface::Surface;
use crate::geometry::Ray;

/// The shading normal in world space, from -1..1 mapped to 0..1.
pub(super) fn normals(surface: &Surface) -> Vec3 {
    surface.shading_normal * 0.5 + 0.5
}

/// The cosine between the surface and the view: grey for fronts, red for backs.
pub(super) fn facing(ray: &Ray, surface: &Surface) -> Vec3 {
    let cosine = -surface
        .geometric_normal
        .dot(ray.direction.normalize_or(Vec3::Z));
    if surface.is_front {
        Vec3::splat(cosine)
    } else {
        Vec3::new(0.9, 0.15, 0.1) * cosine
    }
}
