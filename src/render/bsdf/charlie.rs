//! Sheen: the distribution "Charlie" of Estevez and Kulla ("Production Friendly Microfacet Sheen BRDF", 2017), with their fit of the
//! masking, as KHR_materials_sheen prescribes it. Local frame.

use glam::Vec3;

/// Least perceptual roughness: cloth below it has a rim narrower than a pixel, and the exponent of the distribution runs away.
const LEAST_ROUGHNESS: f32 = 0.07;

/// Density times masking over 4 cos cos, without the cosine of the light: the lobe of white sheen.
pub(super) fn value(o: Vec3, i: Vec3, roughness: f32) -> f32 {
    let roughness = roughness.max(LEAST_ROUGHNESS);
    let alpha = roughness * roughness;
    let h = (o + i).normalize_or(Vec3::Z);
    let sine = (h.x * h.x + h.y * h.y).sqrt().min(1.0);
    let inverse = 1.0 / alpha;
    let distribution = (2.0 + inverse) * libm::powf(sine, inverse) / std::f32::consts::TAU;
    let masking = 1.0 / (1.0 + lambda(o.z, alpha) + lambda(i.z, alpha));
    distribution * masking / (4.0 * o.z * i.z)
}

fn lambda(cosine: f32, alpha: f32) -> f32 {
    if cosine < 0.5 {
        libm::expf(fit(cosine, alpha))
    } else {
        libm::expf(2.0 * fit(0.5, alpha) - fit(1.0 - cosine, alpha))
    }
}

/// The paper's curve, between its two columns of numbers.
fn fit(x: f32, alpha: f32) -> f32 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let mix = |rough: f32, smooth: f32| rough + (smooth - rough) * t;
    let a = mix(21.5473, 25.3245);
    let b = mix(3.82987, 3.32435);
    let c = mix(0.19823, 0.16801);
    let d = mix(-1.97760, -1.27393);
    let e = mix(-4.32054, -4.85967);
    a / (1.0 + b * libm::powf(x, c)) + d * x + e
}
