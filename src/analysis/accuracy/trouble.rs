//! What explains a wrong answer: where the ray passes the triangle that it is about.

use glam::DVec3;

use super::{Blame, Kind, Trouble};
use crate::geometry::exact::{self, filter};
use crate::geometry::tolerance::SINGLE_DOUBT;
use crate::geometry::{Ray, Triangle};

/// A wrong answer, and what is known of it.
pub(in crate::analysis) struct Wrong<'a> {
    pub(in crate::analysis) kind: Kind,
    pub(in crate::analysis) blame: Blame,
    /// The ray and the triangle that it truly hits, or that it was said to, in the space in which they are tested.
    pub(in crate::analysis) ray: &'a Ray,
    pub(in crate::analysis) triangle: &'a Triangle,
    /// The true depth, if there is one, and that of the answer.
    pub(in crate::analysis) depths: (Option<f32>, Option<f32>),
}

impl Wrong<'_> {
    /// The likeliest cause, most special first.
    pub(in crate::analysis) fn trouble(&self) -> Trouble {
        if self.blame == Blame::Traversal {
            return if self.grazes_box() {
                Trouble::CellBoundary
            } else {
                Trouble::Cull
            };
        }
        if self.is_in_plane() {
            return Trouble::Coplanar;
        }
        match self.edges_touched() {
            0 => {}
            1 if self.kind != Kind::WrongOrder => return Trouble::Edge,
            2.. if self.kind != Kind::WrongOrder => return Trouble::Vertex,
            _ => {}
        }
        if self.is_at_interval_end() {
            Trouble::IntervalEnd
        } else if matches!(self.kind, Kind::WrongOrder | Kind::WrongDepth)
            && self.depths.1.is_some()
        {
            Trouble::Depth
        } else {
            Trouble::Cull
        }
    }

    /// Single precision cannot tell the direction from one within the triangle's plane.
    fn is_in_plane(&self) -> bool {
        let (normal, permanent) = filter::normal(self.triangle);
        let direction = self.ray.direction.as_dvec3();
        normal.dot(direction).abs() <= SINGLE_DOUBT * permanent.dot(direction.abs())
    }

    /// Edge functions that single precision cannot tell from zero.
    fn edges_touched(&self) -> usize {
        let near = exact::edges(self.triangle).map(|(from, to)| {
            let (value, permanent) = filter::edge_function(self.ray, from, to);
            value.abs() <= SINGLE_DOUBT * permanent
        });
        near.into_iter().filter(|near| *near).count()
    }

    /// The true depth is the interval's end, as far as single precision can tell.
    fn is_at_interval_end(&self) -> bool {
        let Some(t) = self.depths.0 else {
            return false;
        };
        let length = self.ray.direction.as_dvec3().length();
        let span = f64::from(self.span()) / length;
        let interval = self.ray.interval;
        [interval.min, interval.max].into_iter().any(|end| {
            end.is_finite() && (f64::from(end) - f64::from(t)).abs() <= SINGLE_DOUBT * span
        })
    }

    fn span(&self) -> f32 {
        let points = self.triangle.corners().iter().chain([&self.ray.origin]);
        points.fold(0.0, |span, p| span.max(p.abs().max_element()))
    }

    /// The line passes the triangle's box only through its skin, which is as thick as single precision is coarse there.
    fn grazes_box(&self) -> bool {
        let bounds = self.triangle.bounds();
        let skin = DVec3::splat(SINGLE_DOUBT * f64::from(self.span()));
        let (min, max) = (bounds.min.as_dvec3() + skin, bounds.max.as_dvec3() - skin);
        let (origin, direction) = (self.ray.origin.as_dvec3(), self.ray.direction.as_dvec3());
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let inverse = 1.0 / direction[axis];
            let ends = [min, max].map(|side| (side[axis] - origin[axis]) * inverse);
            if direction[axis].abs() > 0.0 {
                enter = enter.max(ends[0].min(ends[1]));
                leave = leave.min(ends[0].max(ends[1]));
            } else if origin[axis] < min[axis] || origin[axis] > max[axis] {
                return true;
            }
        }
        enter >= leave || min.cmpgt(max).any()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn trouble(kind: Kind, blame: Blame, origin: Vec3, direction: Vec3) -> Trouble {
        let triangle = Triangle::new(
            Vec3::new(0.0, 0.0, 1.0),
            Vec3::new(3.0, 0.0, 1.5),
            Vec3::new(0.0, 2.0, 1.2),
        );
        let ray = Ray::new(origin, direction);
        let depth = exact::depth_of_plane(&ray, &triangle).map(|d| d.to_f32());
        Wrong {
            kind,
            blame,
            ray: &ray,
            triangle: &triangle,
            depths: (depth, depth),
        }
        .trouble()
    }

    #[test]
    fn the_place_explains_the_fault() {
        let of_test = |x, y, z| trouble(Kind::Hole, Blame::Test, Vec3::new(x, y, z), Vec3::Z);
        assert_eq!(of_test(0.0, 1.0, 0.0), Trouble::Edge);
        assert_eq!(of_test(0.0, 2.0, 0.0), Trouble::Vertex);
        assert_eq!(of_test(0.5, 0.5, 0.0), Trouble::Cull);
        assert_eq!(of_test(0.6, 0.5, 1.15), Trouble::IntervalEnd);
        let along = Vec3::new(3.0, 0.0, 0.5);
        let within = trouble(Kind::Hole, Blame::Test, Vec3::new(-3.0, 0.5, 0.55), along);
        assert_eq!(within, Trouble::Coplanar);
        let order = trouble(
            Kind::WrongOrder,
            Blame::Test,
            Vec3::new(0.5, 0.5, 0.0),
            Vec3::Z,
        );
        assert_eq!(order, Trouble::Depth);
    }

    #[test]
    fn a_traversal_is_blamed_for_the_box_or_for_nothing() {
        let of = |x, y| trouble(Kind::Hole, Blame::Traversal, Vec3::new(x, y, 0.0), Vec3::Z);
        assert_eq!(of(0.0, 1.0), Trouble::CellBoundary);
        assert_eq!(of(0.5, 0.5), Trouble::Cull);
        let beside = trouble(
            Kind::Hole,
            Blame::Traversal,
            Vec3::new(3.0, 0.0, 0.0),
            Vec3::Z,
        );
        assert_eq!(beside, Trouble::CellBoundary);
    }
}
