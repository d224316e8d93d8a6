//! Answers of accelerators, and the rule by which the nearest of several hits is chosen.

use crate::geometry::Ray;

/// Where a ray first meets the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance, in units of the ray direction's length: the exact one, rounded to the nearest `f32`.
    pub t: f32,
    /// Index of the scene's instance.
    pub instance: u32,
    /// Index of the triangle in the instance's mesh: the original one, also where a structure has split it.
    pub triangle: u32,
}

/// The nearest hit so far: least `t`, then least instance, then least triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    limit: f32,
    hit: Option<Hit>,
    /// Hits up to this one, in the order of `t` and names, are passed over.
    behind: Option<(f32, (u32, u32))>,
}

impl Nearest {
    /// Nothing yet; what counts is what the ray's interval holds, and what is not passed over.
    pub(super) fn of(ray: &Ray) -> Self {
        Self {
            limit: ray.interval.max,
            hit: None,
            behind: ray.behind.map(|name| (ray.interval.min, name)),
        }
    }

    /// Greatest `t` that still matters. A hit with just this `t` may win by its name.
    pub(super) fn limit(&self) -> f32 {
        self.limit
    }

    pub(super) fn hit(&self) -> Option<Hit> {
        self.hit
    }

    /// Takes the hit if it comes before the one that is here.
    #[inline]
    pub(super) fn offer(&mut self, t: f32, instance: u32, triangle: u32) {
        let wins = match self.hit {
            None => t <= self.limit,
            Some(best) => {
                t < best.t || (t <= best.t && (instance, triangle) < (best.instance, best.triangle))
            }
        };
        let is_passed = self
            .behind
            .is_some_and(|(least, name)| t <= least && (instance, triangle) <= name);
        if wins && !is_passed {
            self.limit = t;
            self.hit = Some(Hit {
                t,
                instance,
                triangle,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Interval;
    use glam::Vec3;

    #[test]
    fn ties_go_to_the_least_name_in_any_order() {
        let offers = [
            (2.0, 1, 5),
            (2.0, 0, 9),
            (2.0, 0, 7),
            (3.0, 0, 0),
            (2.0, 1, 0),
        ];
        for start in 0..offers.len() {
            let mut nearest = Nearest::of(&Ray::new(Vec3::ZERO, Vec3::X));
            for &(t, instance, triangle) in offers[start..].iter().chain(&offers[..start]) {
                nearest.offer(t, instance, triangle);
            }
            assert_eq!(
                nearest.hit(),
                Some(Hit {
                    t: 2.0,
                    instance: 0,
                    triangle: 7
                })
            );
        }
    }

    #[test]
    fn the_limit_itself_counts() {
        let mut nearest =
            Nearest::of(&Ray::new(Vec3::ZERO, Vec3::X).within(Interval::new(0.0, 1.0)));
        nearest.offer(1.0_f32.next_up(), 0, 0);
        assert_eq!(nearest.hit(), None);
        nearest.offer(1.0, 0, 0);
        assert_eq!((nearest.limit(), nearest.hit().is_some()), (1.0, true));
    }
}
