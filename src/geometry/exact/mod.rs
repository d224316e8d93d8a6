//! Truth without rounding: whether a ray hits a triangle, where, and what it hits first.
//!
//! # What a hit is
//!
//! The numbers of a [`Ray`] and a [`Triangle`] are taken as they are: every `f32` is a rational number. With origin
//! `o`, direction `d` and corners `a`, `b`, `c`, the ray hits the triangle if
//!
//! 1. the edge functions `U = det(d, c - o, b - o)`, `V = det(d, a - o, c - o)` and `W = det(d, b - o, a - o)` are
//!    all at least zero, or all at most zero, and not all zero; and
//! 2. the parameter `t = n . (a - o) / n . d` with `n = (b - a) x (c - a)`, rounded once to the nearest `f32` (ties to
//!    even), is finite and lies in the ray's closed interval.
//!
//! Both sides of a triangle count, and its edges and corners belong to it. A ray within the triangle's plane misses
//! (all three functions are zero), and so does every ray a triangle without area: its `U + V + W = -n . d` is zero.
//! The interval is tested on the rounded `t`, which is the `t` that everybody sees; a `t` just below zero that rounds
//! to zero is a hit at zero.
//!
//! The edge function of an edge is the same number, up to its sign, in both triangles that share the edge. So
//! a line through a closed mesh cannot slip between two triangles, and since the definition asks for no
//! arithmetic, all that follow it agree bit for bit.
//!
//! # Planes and constructed points
//!
//! [`ExactPlane`] and [`Point`] are for those who cut polygons by planes: on which side of a plane does the point lie in which
//! three others meet?
//!
//! # Filtered and unfiltered
//!
//! [`edge_signs`], [`depth()`], [`intersect`] and [`hits`] are the judge: integers only (`dashu-int`), which costs
//! microseconds where floating point costs nanoseconds. [`filter`] asks in double precision first; [`meets`] and
//! [`RayFrame`](crate::geometry::RayFrame) combine both and are as right, which tests check.
//!
//! ```
//! use bspray::geometry::{Ray, Triangle, exact};
//! use glam::Vec3;
//! let triangle = Triangle::new(Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0));
//! // Exactly through an edge: a hit.
//! let ray = Ray::new(Vec3::new(1.0, 0.0, 5.0), Vec3::NEG_Z);
//! assert_eq!(exact::intersect(&ray, &triangle), Some(5.0));
//! // Below it by the least number there is: a miss.
//! let below = Ray::new(Vec3::new(1.0, -f32::from_bits(1), 5.0), Vec3::NEG_Z);
//! assert!(!exact::hits(&below, &triangle));
//! ```

mod bounded;
mod depth;
pub mod filter;
mod homogeneous;
mod indirect;
mod integer;
mod orient;
mod plane;

use std::cmp::Ordering;

use dashu_int::ops::BitTest;
use glam::{DVec3, Vec3};

use super::{Ray, Triangle};
pub use depth::Depth;
pub use indirect::{Point, Position};
use integer::{lift, sign};
pub use orient::{side_of_line, side_of_point};
pub use plane::ExactPlane;

/// The sign of a number, with zero as a value of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Below zero.
    Negative,
    /// Zero, without rounding.
    Zero,
    /// Above zero.
    Positive,
}

impl Sign {
    /// From a comparison with zero.
    const fn of(against_zero: Ordering) -> Self {
        match against_zero {
            Ordering::Less => Self::Negative,
            Ordering::Equal => Self::Zero,
            Ordering::Greater => Self::Positive,
        }
    }

    /// The sign of the number's negative.
    #[must_use]
    pub const fn flipped(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Zero => Self::Zero,
            Self::Positive => Self::Negative,
        }
    }

    /// The sign of the product.
    const fn times(self, other: Self) -> Self {
        match other {
            Self::Negative => self.flipped(),
            Self::Zero => Self::Zero,
            Self::Positive => self,
        }
    }
}

/// Whether edge functions of these signs (`U`, `V`, `W`) mean that the line meets the triangle: no two opposite, and
/// not all zero.
pub fn is_inside(signs: [Sign; 3]) -> bool {
    let negative = signs.contains(&Sign::Negative);
    let positive = signs.contains(&Sign::Positive);
    negative != positive
}

/// The pairs of corners of the edge functions `U`, `V` and `W`, in the order of their determinants.
pub(crate) fn edges(triangle: &Triangle) -> [(Vec3, Vec3); 3] {
    let [a, b, c] = *triangle.corners();
    [(c, b), (a, c), (b, a)]
}

/// The sign of the edge function `det(d, from - o, to - o)`, in integers. `Zero` if an input is not finite.
pub fn edge_sign(ray: &Ray, from: Vec3, to: Vec3) -> Sign {
    let points = lift([ray.origin, from, to]);
    let Some(([o, from, to], _)) = points else {
        return Sign::Zero;
    };
    let Some(([direction], _)) = lift([ray.direction]) else {
        return Sign::Zero;
    };
    sign(&direction.dot(&from.minus(&o).cross(&to.minus(&o))))
}

/// The signs of the edge functions `U`, `V`, `W` of the ray's line, in integers.
///
/// They are the signs of the barycentric coordinates of the meeting point (of `a`, `b`, `c`), up to one common sign.
pub fn edge_signs(ray: &Ray, triangle: &Triangle) -> [Sign; 3] {
    edges(triangle).map(|(from, to)| edge_sign(ray, from, to))
}

/// Whether the ray's line meets the triangle: exact, with the filter first.
///
/// Asks nothing of the interval. The integers are needed only where the line passes within some 1e-15 (relative to
/// the triangle's size and distance) of an edge.
pub fn meets(ray: &Ray, triangle: &Triangle) -> bool {
    let edges = edges(triangle);
    let known = edges.map(|(from, to)| filter::edge_sign(ray, from, to));
    if known.contains(&Some(Sign::Negative)) && known.contains(&Some(Sign::Positive)) {
        return false;
    }
    is_inside(std::array::from_fn(|i| {
        known[i].unwrap_or_else(|| edge_sign(ray, edges[i].0, edges[i].1))
    }))
}

/// Where the ray's line meets the triangle, in integers; `None` if it does not. Asks nothing of the interval.
pub fn depth(ray: &Ray, triangle: &Triangle) -> Option<Depth> {
    is_inside(edge_signs(ray, triangle)).then_some(())?;
    depth_of_plane(ray, triangle)
}

/// Where the ray's line meets the triangle's plane, in integers; `None` if it is parallel to it, if the triangle has no
/// area, or if an input is not finite.
pub fn depth_of_plane(ray: &Ray, triangle: &Triangle) -> Option<Depth> {
    let [a, b, c] = *triangle.corners();
    let ([o, a, b, c], point_unit) = lift([ray.origin, a, b, c])?;
    let ([direction], direction_unit) = lift([ray.direction])?;
    let normal = b.minus(&a).cross(&c.minus(&a));
    Depth::new(
        normal.dot(&a.minus(&o)),
        normal.dot(&direction),
        point_unit - direction_unit,
    )
}

/// The correctly rounded `t` at which the ray hits the triangle, in integers; `None` if it misses.
///
/// This is what [`RayFrame::intersect`](crate::geometry::RayFrame::intersect) returns.
pub fn intersect(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    if !ray.is_traceable() {
        return None;
    }
    let t = depth(ray, triangle)?.to_f32();
    (t.is_finite() && ray.interval.contains(t)).then_some(t)
}

/// Whether the ray hits the triangle, in integers.
pub fn hits(ray: &Ray, triangle: &Triangle) -> bool {
    intersect(ray, triangle).is_some()
}

/// Whether the corners lie on one line (or in one point), in integers. A triangle that is not finite has no plane
/// either.
pub fn is_degenerate(triangle: &Triangle) -> bool {
    cross_of_edges(triangle).is_none_or(|normal| normal.is_zero())
}

/// The direction of `(b - a) x (c - a)`, of unit length and right to the last bits of `f64`; `None` for a degenerate
/// triangle.
pub fn normal(triangle: &Triangle) -> Option<DVec3> {
    let normal = cross_of_edges(triangle).filter(|normal| !normal.is_zero())?;
    // 60 bits of the largest component are more than f64 keeps, and cannot overflow.
    let bits = normal.components().each_ref().map(BitTest::bit_len);
    let surplus = bits.into_iter().fold(0, usize::max).saturating_sub(60);
    let leading = normal
        .components()
        .each_ref()
        .map(|x| (x >> surplus).to_f64().value());
    Some(DVec3::from_array(leading).normalize())
}

fn cross_of_edges(triangle: &Triangle) -> Option<integer::Vector> {
    let ([a, b, c], _) = lift(*triangle.corners())?;
    Some(b.minus(&a).cross(&c.minus(&a)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Interval;

    fn sample() -> Triangle {
        Triangle::new(
            Vec3::new(0.0, 0.0, 1.0),
            Vec3::new(2.0, 0.0, 1.0),
            Vec3::new(0.0, 3.0, 1.0),
        )
    }

    #[test]
    fn edge_signs_say_on_which_side_of_each_edge_the_line_passes() {
        use Sign::{Negative, Positive, Zero};
        let at = |x, y| edge_signs(&Ray::new(Vec3::new(x, y, 0.0), Vec3::Z), &sample());
        assert_eq!(at(0.5, 0.5), [Negative, Negative, Negative]);
        assert_eq!(at(1.0, 0.0), [Negative, Negative, Zero]);
        assert_eq!(at(0.0, 0.0), [Negative, Zero, Zero]);
        assert_eq!(at(-1.0, 1.0), [Negative, Positive, Negative]);
        let backward = Ray::new(Vec3::new(0.5, 0.5, 0.0), Vec3::NEG_Z);
        assert_eq!(edge_signs(&backward, &sample()), [Positive; 3]);
    }

    #[test]
    fn the_ray_in_the_plane_and_the_triangle_without_area_are_missed() {
        let within = Ray::new(Vec3::new(-1.0, 0.5, 1.0), Vec3::X);
        assert_eq!(edge_signs(&within, &sample()), [Sign::Zero; 3]);
        assert!(!hits(&within, &sample()) && !meets(&within, &sample()));
        let line = Triangle::new(Vec3::ZERO, Vec3::ONE, Vec3::splat(3.0));
        let through = Ray::new(Vec3::new(1.0, 1.0, 0.0), Vec3::Z);
        assert!(!hits(&through, &line) && !meets(&through, &line));
        assert!(is_degenerate(&line) && normal(&line).is_none());
        assert!(!is_degenerate(&sample()));
    }

    #[test]
    fn the_interval_is_closed() {
        let ray = Ray::new(Vec3::new(0.5, 0.5, 0.0), Vec3::Z);
        let within = |min, max| hits(&ray.within(Interval::new(min, max)), &sample());
        assert!(within(1.0, 1.0) && within(0.0, 1.0) && within(1.0, f32::INFINITY));
        assert!(!within(1.0_f32.next_up(), 2.0) && !within(0.0, 1.0_f32.next_down()));
        assert!(!within(2.0, 1.0));
    }

    #[test]
    fn the_normal_of_a_sliver_is_right() {
        // Two edges that differ by one unit in the last place: f64 would do here, single precision would not.
        let edge = Vec3::new(1.0, 2.0, 3.0);
        let sliver = Triangle::new(Vec3::ZERO, edge, edge.with_x(1.0_f32.next_up()));
        let truth = DVec3::new(0.0, 3.0, -2.0).normalize();
        assert!((normal(&sliver).unwrap() - truth).length() < 1e-15);
    }

    #[test]
    fn broken_input_is_never_hit() {
        let ray = Ray::new(Vec3::new(0.5, 0.5, 0.0), Vec3::Z);
        let broken = Triangle::new(Vec3::NAN, Vec3::X, Vec3::Y);
        assert!(!hits(&ray, &broken) && !meets(&ray, &broken) && is_degenerate(&broken));
        assert!(!hits(&Ray::new(Vec3::ZERO, Vec3::ZERO), &sample()));
        assert!(depth(&Ray::new(Vec3::INFINITY, Vec3::Z), &sample()).is_none());
    }
}
