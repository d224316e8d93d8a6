//! How much light a smooth interface reflects.

/// Schlick's weight (1994): 0 where the light comes straight, 1 where it grazes. `cosine` is that of the angle to the normal, 0 to 1.
pub(super) fn schlick_weight(cosine: f32) -> f32 {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    let squared = m * m;
    squared * squared * m
}

/// Reflectance at normal incidence between media whose indices of refraction have the ratio `eta`.
pub(super) fn reflectance_at_normal(eta: f32) -> f32 {
    let root = (eta - 1.0) / (eta + 1.0);
    root * root
}

/// Fresnel's equations for unpolarised light: the share that is reflected, and the cosine of the refracted direction (negative of
/// it is the local z on the far side); the latter `None` for total reflection. `cosine` is that of the incident direction, 0 to
/// 1; `eta` is the index of refraction behind the interface over the one before it.
pub(super) fn dielectric(cosine: f32, eta: f32) -> (f32, Option<f32>) {
    let sine_squared = (1.0 - cosine * cosine).max(0.0) / (eta * eta);
    if sine_squared >= 1.0 {
        return (1.0, None);
    }
    let refracted = (1.0 - sine_squared).sqrt();
    let parallel = (eta * cosine - refracted) / (eta * cosine + refracted);
    let across = (cosine - eta * refracted) / (cosine + eta * refracted);
    (
        0.5 * (parallel * parallel + across * across),
        Some(refracted),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_light_agrees_with_the_closed_form() {
        for eta in [0.4, 0.75, 1.0, 1.33, 1.5, 2.4] {
            let (reflected, refracted) = dielectric(1.0, eta);
            assert!((reflected - reflectance_at_normal(eta)).abs() < 1e-6);
            assert_eq!(refracted, Some(1.0));
        }
    }

    #[test]
    fn at_brewsters_angle_only_one_polarisation_is_reflected() {
        // tan(angle) = eta; there the reflected share is half of cos^2(2 angle).
        let eta = 1.5_f64;
        let angle = libm::atan(eta);
        let expected = 0.5 * libm::cos(2.0 * angle) * libm::cos(2.0 * angle);
        let (reflected, _) = dielectric(libm::cos(angle) as f32, eta as f32);
        assert!((f64::from(reflected) - expected).abs() < 1e-6);
    }

    #[test]
    fn beyond_the_critical_angle_everything_is_reflected() {
        let eta = 1.0 / 1.5_f32;
        let critical = (1.0 - eta * eta).sqrt();
        assert_eq!(dielectric(critical - 1e-3, eta), (1.0, None));
        let (reflected, refracted) = dielectric(critical + 1e-3, eta);
        assert!(reflected < 1.0 && refracted.is_some());
    }

    #[test]
    fn refraction_can_be_turned_around() {
        let (there, refracted) = dielectric(0.6, 1.5);
        let (back, out) = dielectric(refracted.expect("no total reflection"), 1.0 / 1.5);
        assert!((there - back).abs() < 1e-6);
        assert!((out.expect("the same path") - 0.6).abs() < 1e-6);
    }
}
