//! The light that comes from no object: a sky.

use glam::Vec3;

/// A gradient sky: one colour at the horizon, one overhead, and a ground that sends light back up.
///
/// It is a picture of a clear day without clouds or sun, cheap enough to be everybody's default; a physical sky is
/// another matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Unit vector to the zenith, in world space.
    pub up: Vec3,
    /// Linear radiance overhead.
    pub zenith: Vec3,
    /// Linear radiance at the horizon.
    pub horizon: Vec3,
    /// Linear radiance from below the horizon.
    pub ground: Vec3,
}

impl Sky {
    /// A soft daylight sky over light ground.
    pub fn daylight(up: Vec3) -> Self {
        Self {
            up,
            zenith: Vec3::new(0.26, 0.40, 0.68),
            horizon: Vec3::new(0.70, 0.76, 0.84),
            ground: Vec3::new(0.34, 0.33, 0.32),
        }
    }

    /// Linear radiance that comes from `direction`, a unit vector in world space that points to the sky.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let height = direction.dot(self.up);
        if height >= 0.0 {
            // The square root keeps most of the change near the horizon, where skies have it.
            self.horizon.lerp(self.zenith, height.min(1.0).sqrt())
        } else {
            // A blend instead of a hard line: far ground is seen through air.
            self.horizon.lerp(self.ground, (-height * 3.0).min(1.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_goes_from_ground_over_horizon_to_zenith() {
        let sky = Sky::daylight(Vec3::Z);
        assert_eq!(sky.radiance(Vec3::Z), sky.zenith);
        assert_eq!(sky.radiance(Vec3::X), sky.horizon);
        assert_eq!(sky.radiance(Vec3::NEG_Z), sky.ground);
    }
}
