//! How far a triangle is from a point. Model units, in double precision.

use glam::{DVec3, Vec3};

use super::Triangle;

impl Triangle {
    /// The square of the distance from a point to the nearest point of the triangle, also of one that is a line or a point.
    ///
    /// ```
    /// use bspray::geometry::Triangle;
    /// use glam::{DVec3, Vec3};
    /// let triangle = Triangle::new(Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0));
    /// assert_eq!(triangle.squared_distance(DVec3::new(0.5, 0.5, 7.0)), 49.0);
    /// assert_eq!(triangle.squared_distance(DVec3::new(-3.0, -4.0, 0.0)), 25.0);
    /// ```
    #[inline]
    pub fn squared_distance(&self, point: DVec3) -> f64 {
        let corners = self.corners().map(Vec3::as_dvec3);
        let [a, b, c] = corners.map(|corner| corner - point);
        let (ab, bc, ca) = (b - a, c - b, a - c);
        let normal = ab.cross(-ca);
        let squared = normal.length_squared();
        // The foot of the perpendicular is inside where it is on the inner side of all edges.
        let is_inside = squared > 0.0
            && normal.cross(ab).dot(a) <= 0.0
            && normal.cross(bc).dot(b) <= 0.0
            && normal.cross(ca).dot(c) <= 0.0;
        if is_inside {
            let along = normal.dot(a);
            return along * along / squared;
        }
        let to_edge = |start: DVec3, edge: DVec3| {
            let share = (-start.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            // An edge of no length has no share.
            let share = if share.is_nan() { 0.0 } else { share };
            (start + edge * share).length_squared()
        };
        to_edge(a, ab).min(to_edge(b, bc)).min(to_edge(c, ca))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_of_the_triangle_is_nearer_and_one_is_as_near() {
        let part = |i: u32, n: u32| (i.wrapping_mul(n) % 10_007) as f32 / 5_003.5 - 1.0;
        for i in 0..60_u32 {
            let corner = |n: u32| Vec3::new(part(i, n), part(i, n + 2), part(i, n + 6)) * 3.0;
            let (a, b) = (corner(7919), corner(104_729));
            // Every third is a line, every seventh a point.
            let c = if i % 3 == 0 {
                a.lerp(b, 0.3)
            } else {
                corner(1_299_709)
            };
            let triangle = match i % 7 {
                0 => Triangle::new(a, a, a),
                _ => Triangle::new(a, b, c),
            };
            let point = corner(611_953).as_dvec3() * 2.0;
            let found = triangle.squared_distance(point).sqrt();
            let [a, b, c] = triangle.corners().map(Vec3::as_dvec3);
            let mut nearest = f64::INFINITY;
            for u in 0..=200 {
                for v in 0..=200 - u {
                    let (u, v) = (f64::from(u) / 200.0, f64::from(v) / 200.0);
                    nearest = nearest.min((a + (b - a) * u + (c - a) * v).distance(point));
                }
            }
            assert!(found <= nearest + 1e-9, "{i}: {found} {nearest}");
            assert!(nearest < found + 0.06, "{i}: {found} {nearest}");
        }
    }
}
