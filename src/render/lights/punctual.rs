//! Light from points, cones and infinitely far directions: KHR_lights_punctual.

use super::Incident;
use crate::scene::{Light, LightKind};
use glam::Vec3;

/// Light from one light at a point: intensity over the square of the distance, a window that fades to nothing at the range, and a
/// smooth edge between a spot's two cones.
pub(super) fn incident(light: &Light, point: Vec3) -> Option<Incident> {
    if light.kind == LightKind::Directional {
        return Some(Incident {
            direction: -light.direction,
            target: None,
            irradiance: light.intensity,
            density: f32::INFINITY,
        });
    }
    let to_light = light.position - point;
    let squared = to_light.length_squared();
    let distance = squared.sqrt();
    let direction = to_light / distance;
    let window = light.range.map_or(1.0, |range| {
        let ratio = distance / range;
        (1.0 - ratio * ratio * ratio * ratio).clamp(0.0, 1.0)
    });
    let cone = match light.kind {
        LightKind::Spot {
            inner_angle,
            outer_angle,
        } => {
            let [inner, outer] = [inner_angle, outer_angle].map(libm::cosf);
            let within = ((-direction.dot(light.direction) - outer) / (inner - outer).max(1e-3))
                .clamp(0.0, 1.0);
            within * within
        }
        _ => 1.0,
    };
    let irradiance = light.intensity * (window * cone / squared);
    Incident {
        direction,
        target: Some(light.position),
        irradiance,
        density: f32::INFINITY,
    }
    .if_lit()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(kind: LightKind) -> Light {
        Light {
            name: String::new(),
            kind,
            intensity: Vec3::new(12.0, 8.0, 4.0),
            position: Vec3::new(0.0, 2.0, 0.0),
            direction: Vec3::NEG_Y,
            range: None,
        }
    }

    #[test]
    fn point_lights_follow_the_inverse_square() {
        let i = incident(&light(LightKind::Point), Vec3::ZERO).expect("lit");
        assert_eq!(
            (i.direction, i.irradiance),
            (Vec3::Y, Vec3::new(3.0, 2.0, 1.0))
        );
        assert_eq!(i.target, Some(Vec3::new(0.0, 2.0, 0.0)));
        let faded = Light {
            range: Some(2.0),
            ..light(LightKind::Point)
        };
        assert!(incident(&faded, Vec3::ZERO).is_none());
    }

    #[test]
    fn spots_light_their_cone_only() {
        let spot = light(LightKind::Spot {
            inner_angle: 0.3,
            outer_angle: 0.5,
        });
        let full = incident(&spot, Vec3::ZERO).expect("on the axis");
        assert_eq!(full.irradiance, Vec3::new(3.0, 2.0, 1.0));
        let edge = incident(&spot, Vec3::new(2.0 * 0.42, 0.0, 0.0)).expect("between the cones");
        assert!(edge.irradiance.x > 0.0 && edge.irradiance.x < 2.0);
        assert!(incident(&spot, Vec3::new(2.0, 0.0, 0.0)).is_none());
    }
}
