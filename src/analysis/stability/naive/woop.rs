//! Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, as published: edge functions in single precision in a frame of the ray,
//! again in double precision where one is zero, and `t` in single precision. Watertight, but neither its edges nor its depths are exact.

use glam::Vec3;

use crate::geometry::{Ray, Triangle};

#[allow(
    clippy::float_cmp,
    reason = "zero is what the published test compares with"
)]
pub(super) fn intersect(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    let magnitude = ray.direction.abs();
    let z = if magnitude.x > magnitude.y && magnitude.x > magnitude.z {
        0
    } else if magnitude.y > magnitude.z {
        1
    } else {
        2
    };
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let d = ray.direction;
    let (shear_x, shear_y, shear_z) = (d[x] / d[z], d[y] / d[z], 1.0 / d[z]);
    let sheared = triangle.corners().map(|p| {
        let p = p - ray.origin;
        Vec3::new(p[x] - shear_x * p[z], p[y] - shear_y * p[z], shear_z * p[z])
    });
    let [a, b, c] = sheared;
    let edge = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
    let mut functions = [edge(c, b), edge(a, c), edge(b, a)];
    if functions.contains(&0.0) {
        let edge = |p: Vec3, q: Vec3| {
            let (p, q) = (p.as_dvec3(), q.as_dvec3());
            (p.x * q.y - p.y * q.x) as f32
        };
        functions = [edge(c, b), edge(a, c), edge(b, a)];
    }
    if functions.iter().any(|f| *f < 0.0) && functions.iter().any(|f| *f > 0.0) {
        return None;
    }
    let [u, v, w] = functions;
    let determinant = u + v + w;
    if determinant == 0.0 {
        return None;
    }
    let t = (u * a.z + v * b.z + w * c.z) / determinant;
    ray.interval.contains(t).then_some(t)
}
