//! Rays: where they start, where they go, which part of them counts, and where they come from.

use glam::Vec3;

use super::Interval;

/// Where a ray comes from: its depth, and the pixel if the eye sent it.
///
/// The depth is the lecture's recursion level ("Using Projection Extents (4)"): eye rays have 0, and each
/// bounce adds 1. Only eye rays know a pixel, because only they pass through the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayOrigin {
    /// 0 for eye rays, one more for each bounce.
    pub depth: u32,
    /// Column and row of the pixel, from the top left; `None` for secondary rays.
    pub pixel: Option<(u32, u32)>,
}

/// A ray `origin + t * direction` for `t` in a closed interval.
///
/// The direction need not be of unit length; `t` is in units of its length.
///
/// ```
/// use bspray::geometry::{Interval, Ray};
/// use glam::Vec3;
/// let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.0, -2.0));
/// assert_eq!(ray.at(1.5), Vec3::new(0.0, 0.0, -3.0));
/// assert!(ray.is_traceable());
/// assert!(!Ray::new(Vec3::ZERO, Vec3::ZERO).is_traceable());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where `t` is 0.
    pub origin: Vec3,
    /// Displacement for one unit of `t`; not necessarily of unit length.
    pub direction: Vec3,
    /// The part of the line that counts.
    pub interval: Interval,
    /// Depth and pixel.
    pub source: RayOrigin,
    /// If set, hits at just the interval's least `t` count only with a greater name (instance, triangle): the ray continues
    /// behind such a hit, and misses none of the other surfaces that lie in the same place.
    pub behind: Option<(u32, u32)>,
}

impl Ray {
    /// A ray from `origin` to infinity, of depth 0 and without a pixel.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            interval: Interval::FORWARD,
            source: RayOrigin::default(),
            behind: None,
        }
    }

    /// The same ray with another interval.
    #[must_use]
    pub fn within(self, interval: Interval) -> Self {
        Self { interval, ..self }
    }

    /// The rest of the ray behind a hit at `t` of the triangle of that name (instance, triangle).
    #[must_use]
    pub fn behind(self, t: f32, name: (u32, u32)) -> Self {
        Self {
            interval: Interval::new(t, self.interval.max),
            behind: Some(name),
            ..self
        }
    }

    /// The point at parameter `t`, rounded in single precision.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// Whether the ray can hit anything at all: finite origin and direction, a direction that is not zero,
    /// an interval that is not empty. Every accelerator answers "no hit" to any other ray.
    pub fn is_traceable(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != Vec3::ZERO
            && !self.interval.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_rays_are_not_traceable() {
        let good = Ray::new(Vec3::ONE, Vec3::new(0.0, 1e-30, 0.0));
        assert!(good.is_traceable());
        assert!(!Ray::new(Vec3::new(f32::NAN, 0.0, 0.0), Vec3::X).is_traceable());
        assert!(!Ray::new(Vec3::ZERO, Vec3::new(f32::INFINITY, 0.0, 0.0)).is_traceable());
        assert!(!Ray::new(Vec3::ZERO, Vec3::new(0.0, -0.0, 0.0)).is_traceable());
        assert!(!good.within(Interval::new(1.0, 0.0)).is_traceable());
    }
}
