//! The one ray-triangle test.

use glam::Vec3;

use super::Ray;

/// A triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    corners: [Vec3; 3],
}

impl Triangle {
    /// The triangle with these corners.
    pub const fn new(a: Vec3, b: Vec3, c: Vec3) -> Self {
        Self { corners: [a, b, c] }
    }

    /// The corners, in the order given.
    pub const fn corners(&self) -> &[Vec3; 3] {
        &self.corners
    }

    /// Whether the corners lie on one line (or in one point), decided without rounding.
    pub fn is_degenerate(&self) -> bool {
        false
    }

    /// Barycentric coordinates of the ray's line.
    pub fn barycentric(&self, _ray: &Ray) -> Barycentric {
        Barycentric { u: 0.0, v: 0.0 }
    }
}

/// Barycentric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barycentric {
    /// Weight of the second corner.
    pub u: f32,
    /// Weight of the third corner.
    pub v: f32,
}

/// A ray made ready for the test.
#[derive(Clone, Copy, Debug)]
pub struct RayFrame {
    ray: Ray,
}

impl RayFrame {
    /// New.
    pub fn new(ray: &Ray) -> Self {
        Self { ray: *ray }
    }

    /// Intersect.
    pub fn intersect(&self, _triangle: &Triangle) -> Option<f32> {
        let _ = self.ray;
        None
    }
}
