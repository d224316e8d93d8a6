//! Rays at the edges of what eye rays meet: where triangle tests are wrong if they are.

use crate::accel::Hit;
use crate::geometry::Ray;
use crate::render::Sampler;
use crate::scene::Scene;

/// For each hit of an eye ray, a ray from the same origin at a point of one of the triangle's edges.
pub(super) fn at_edges(scene: &Scene, rays: &[Ray], hits: &[Option<Hit>], seed: u32) -> Vec<Ray> {
    let aimed = |(index, (ray, hit)): (usize, (&Ray, &Option<Hit>))| {
        let hit = (*hit)?;
        let placed = &scene.instances[hit.instance as usize];
        let triangle = scene.mesh_of(hit.instance).triangle(hit.triangle);
        let corners = triangle.corners().map(|p| placed.world_point(p));
        let mut sampler = Sampler::new(index as u32, index as u32 >> 16, 2, seed);
        let edge = (sampler.next_1d() * 3.0) as usize % 3;
        let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
        let point = from + (to - from) * sampler.next_1d();
        let ray = Ray::new(ray.origin, point - ray.origin);
        ray.is_traceable().then_some(ray)
    };
    rays.iter()
        .zip(hits)
        .enumerate()
        .filter_map(aimed)
        .collect()
}
