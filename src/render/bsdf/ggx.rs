//! The GGX distribution of microfacets (Walter et al. 2007), with Smith's height-correlated masking (Heitz 2014) and the sampling
//! of visible normals by spherical caps (Dupuy and Benyoub 2023). Local frame; `alpha` is the square of the perceptual roughness.

use glam::Vec3;

/// Below this, a lobe is narrower than single precision can tell from a mirror's one direction: it is treated as one. The
/// density at its peak, 1 / (pi alpha^2), is 3e5 there.
pub(super) const SMOOTH: f32 = 1e-3;

/// Density of normals, per steradian of the surface, at the unit normal `h`.
pub(super) fn distribution(h: Vec3, alpha: f32) -> f32 {
    // The usual 1 + (alpha^2 - 1) cos^2 loses everything near the peak of a narrow lobe; this is the same.
    let root = alpha * alpha * h.z * h.z + h.x * h.x + h.y * h.y;
    alpha * alpha / (std::f32::consts::PI * root * root)
}

/// Smith's Lambda: masked area over visible area, from a direction with this cosine.
fn lambda(cosine: f32, alpha: f32) -> f32 {
    let squared = cosine * cosine;
    0.5 * ((alpha * alpha * (1.0 - squared) / squared + 1.0).sqrt() - 1.0)
}

/// The share of facets that is seen from a direction with this cosine.
pub(super) fn masking(cosine: f32, alpha: f32) -> f32 {
    1.0 / (1.0 + lambda(cosine.abs(), alpha))
}

/// Of the facets that are lit from `i`, the share that is seen from `o`: the weight of a sampled direction.
pub(super) fn seen_share(i: f32, o: f32, alpha: f32) -> f32 {
    let (i, o) = (lambda(i.abs(), alpha), lambda(o.abs(), alpha));
    (1.0 + o) / (1.0 + o + i)
}

/// A normal of a facet that is visible from `o`, which must be above the surface.
pub(super) fn visible_normal(o: Vec3, alpha: f32, [u, v]: [f32; 2]) -> Vec3 {
    let stretched = Vec3::new(o.x * alpha, o.y * alpha, o.z).normalize();
    let (s, c) = libm::sincosf(std::f32::consts::TAU * u);
    let z = (1.0 - v) * (1.0 + stretched.z) - stretched.z;
    let sine = (1.0 - z * z).max(0.0).sqrt();
    let h = Vec3::new(sine * c, sine * s, z) + stretched;
    Vec3::new(h.x * alpha, h.y * alpha, h.z.max(0.0)).normalize_or(Vec3::Z)
}

/// Density of [`visible_normal`] at `h`, per steradian.
pub(super) fn visible_density(o: Vec3, h: Vec3, alpha: f32) -> f32 {
    masking(o.z, alpha) * distribution(h, alpha) * o.dot(h).max(0.0) / o.z
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums `value(h) * projection` over the hemisphere by the midpoint rule.
    fn hemisphere(value: impl Fn(Vec3) -> f64) -> f64 {
        let n = 600;
        let mut sum = 0.0;
        for i in 0..n {
            let z = (i as f64 + 0.5) / n as f64;
            for j in 0..n {
                let phi = (j as f64 + 0.5) / n as f64 * std::f64::consts::TAU;
                let s = (1.0 - z * z).sqrt();
                sum += value(glam::DVec3::new(s * libm::cos(phi), s * libm::sin(phi), z).as_vec3());
            }
        }
        sum * std::f64::consts::TAU / f64::from(n * n)
    }

    #[test]
    fn facets_cover_the_surface_once() {
        for alpha in [0.2, 0.4, 1.0] {
            let area = hemisphere(|h| f64::from(distribution(h, alpha) * h.z));
            assert!((area - 1.0).abs() < 2e-3, "alpha {alpha}: {area}");
        }
    }

    #[test]
    fn visible_facets_cover_what_is_seen() {
        let o = Vec3::new(0.8, -0.3, 0.25).normalize();
        for alpha in [0.15, 0.5, 1.0] {
            let total = hemisphere(|h| f64::from(visible_density(o, h, alpha)));
            assert!((total - 1.0).abs() < 3e-3, "alpha {alpha}: {total}");
        }
    }

    #[test]
    fn sampled_normals_have_their_density() {
        // The mean of any function under the samples is its integral against the density.
        let o = Vec3::new(-0.6, 0.5, 0.35).normalize();
        let alpha = 0.4;
        let n = 512;
        let mut mean = Vec3::ZERO;
        for i in 0..n * n {
            let u = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
            mean += visible_normal(o, alpha, u) / (n * n) as f32;
        }
        for axis in 0..3 {
            let expected =
                hemisphere(|h| f64::from(visible_density(o, h, alpha)) * f64::from(h[axis]));
            assert!(
                (f64::from(mean[axis]) - expected).abs() < 3e-3,
                "axis {axis}"
            );
        }
    }
}
