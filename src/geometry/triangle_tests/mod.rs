//! The tests of a ray against a triangle that can be had: [the exact one](RayFrame), which the crate owes its users, and three that the literature has, to see
//! what exactness costs and what one loses without it.

mod double;
mod fast;
mod watertight;

pub(crate) use double::Double;
pub(crate) use fast::{Fast, moller_trumbore};
pub(crate) use watertight::Watertight;

use super::{Ray, RayFrame, Triangle};

/// How it is decided whether and where a ray hits a triangle. Both sides of a triangle count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TriangleTest {
    /// Filters with error bounds, and integers behind them ([`RayFrame`]): hits and `t` without error.
    #[default]
    Exact,
    /// Pluecker's edge functions in double precision: rays through edges are decided by rounding, but meet one of the two triangles.
    Double,
    /// Woop, Benthin and Wald's in single precision, with double precision on edges: no holes along shared edges, but edges and depths are rounded.
    Watertight,
    /// Moller and Trumbore's in single precision: rays may pass between two triangles.
    Fast,
}

impl TriangleTest {
    /// All of them, the most exact first.
    pub const ALL: [Self; 4] = [Self::Exact, Self::Double, Self::Watertight, Self::Fast];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Double => "double",
            Self::Watertight => "watertight",
            Self::Fast => "fast",
        }
    }

    /// One line about it.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Exact => "without error: f32 with error bounds, then f64, then integers",
            Self::Double => "Pluecker's edge functions in f64, rounded",
            Self::Watertight => "Woop, Benthin and Wald 2013: f32, with f64 on edges",
            Self::Fast => "Moller and Trumbore 1997, in f32 without an epsilon",
        }
    }
}

impl std::fmt::Display for TriangleTest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// A ray made ready for one of the tests. It is [traceable](Ray::is_traceable).
pub(crate) trait TestedRay: Send + Sync + Sized + 'static {
    fn new(ray: &Ray) -> Self;

    /// Ends the interval at `max`, itself included.
    fn set_max(&mut self, max: f32);

    /// Where the ray hits the triangle: `t` in the ray's interval, in units of the direction's length.
    fn intersect(&self, triangle: &Triangle) -> Option<f32>;
}

impl TestedRay for RayFrame {
    #[inline]
    fn new(ray: &Ray) -> Self {
        Self::new(ray)
    }

    #[inline]
    fn set_max(&mut self, max: f32) {
        self.set_max(max);
    }

    #[inline]
    fn intersect(&self, triangle: &Triangle) -> Option<f32> {
        self.intersect(triangle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Interval;
    use glam::{Vec3, Vec3Swizzles};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn hit<T: TestedRay>(ray: &Ray, triangle: &Triangle) -> Option<f32> {
        T::new(ray).intersect(triangle)
    }

    /// What each of the tests says, in their order.
    fn all(ray: &Ray, triangle: &Triangle) -> [Option<f32>; 4] {
        TriangleTest::ALL.map(|test| match test {
            TriangleTest::Exact => hit::<RayFrame>(ray, triangle),
            TriangleTest::Double => hit::<Double>(ray, triangle),
            TriangleTest::Watertight => hit::<Watertight>(ray, triangle),
            TriangleTest::Fast => hit::<Fast>(ray, triangle),
        })
    }

    #[test]
    fn all_agree_about_rays_well_inside_and_well_outside() {
        let corners = [(0.1, 0.2, 1.0), (3.2, 0.0, 1.3), (0.0, 2.1, 0.8)];
        let [a, b, c] = corners.map(Vec3::from);
        let mut hits = 0;
        for i in 0..64_u8 {
            let (x, y) = (
                f32::from(i % 8) * 0.53 - 0.31,
                f32::from(i / 8) * 0.41 - 0.33,
            );
            for (from, way) in [(-2.0, 1.5), (4.0, -0.7)] {
                let ray = Ray::new(Vec3::new(x, y, from), Vec3::new(0.01, -0.02, way));
                for turn in 0..3 {
                    let turned = |p: Vec3| [p, p.yzx(), p.zxy()][turn];
                    let triangle = Triangle::new(turned(a), turned(b), turned(c));
                    let ray = Ray::new(turned(ray.origin), turned(ray.direction));
                    let [want, others @ ..] = all(&ray, &triangle);
                    for found in others {
                        assert_eq!(found.is_some(), want.is_some(), "{ray:?}");
                        if let (Some(t), Some(want)) = (found, want) {
                            assert!((t - want).abs() < 1e-5 * want, "{t} {want}");
                            hits += 1;
                        }
                    }
                }
            }
        }
        assert!(hits > 180, "{hits}");
    }

    #[test]
    fn all_keep_to_the_interval() {
        let triangle = Triangle::new(Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0);
        let ray = Ray::new(Vec3::new(1.0, 1.0, 2.0), Vec3::NEG_Z);
        assert_eq!(all(&ray, &triangle), [Some(2.0); 4]);
        let ends = |min, max| all(&ray.within(Interval::new(min, max)), &triangle);
        assert_eq!(ends(2.0, 2.0), [Some(2.0); 4]);
        assert_eq!(ends(0.0, 2.0_f32.next_down()), [None; 4]);
        assert_eq!(ends(2.0_f32.next_up(), 9.0), [None; 4]);
        let beside = Ray::new(ray.origin, Vec3::X);
        assert_eq!(all(&beside, &triangle), [None; 4]);
        fn ended<T: TestedRay>(ray: &Ray, triangle: &Triangle) -> Option<f32> {
            let mut ready = T::new(ray);
            ready.set_max(1.5);
            ready.intersect(triangle)
        }
        assert_eq!(ended::<RayFrame>(&ray, &triangle), None);
        assert_eq!(ended::<Double>(&ray, &triangle), None);
        assert_eq!(ended::<Watertight>(&ray, &triangle), None);
        assert_eq!(ended::<Fast>(&ray, &triangle), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            cases: 4_000,
            rng_seed: RngSeed::Fixed(1_997),
            ..ProptestConfig::default()
        })]

        /// Of two triangles that share an edge, a ray aimed at the edge hits one, except by the fast test.
        #[test]
        fn nothing_passes_between_two_triangles_but_by_the_fast_test(
            corners in prop::array::uniform4(prop::array::uniform3(-1.0..1.0f32)),
            origin in prop::array::uniform3(-50.0..50.0f32),
            share in 0.01..0.99f32,
        ) {
            let [a, b, left, right] = corners.map(Vec3::from_array);
            let [from, middle] = [Vec3::from_array(origin), a + (b - a) * share];
            let ray = Ray::new(from, middle - from);
            // As seen along the ray the two are on different sides, and no sliver, which a ray aimed at the edge may miss for its rounding.
            let side = |p: Vec3| (b - a).cross(ray.direction).dot(p - a);
            let [l, r] = [side(left), side(right)].map(|s| s / ray.direction.length());
            prop_assume!(l.abs() > 0.01 && r.abs() > 0.01);
            let right = if l * r > 0.0 { 2.0 * a - right } else { right };
            let both = [Triangle::new(a, b, left), Triangle::new(b, a, right)];
            let [first, second] = both.map(|t| all(&ray, &t));
            for test in 0..3 {
                prop_assert!(
                    first[test].is_some() || second[test].is_some(),
                    "{}", TriangleTest::ALL[test]
                );
            }
        }
    }

    #[test]
    fn rays_pass_between_two_triangles_by_the_fast_test() {
        // Rays at the common edge of two triangles from afar: some pass.
        let [a, b] = [Vec3::new(0.13, 0.0, 0.31), Vec3::new(-0.2, 1.0, 0.77)];
        let left = Triangle::new(a, b, Vec3::new(-1.0, 0.3, 0.0));
        let right = Triangle::new(b, a, Vec3::new(1.0, 0.4, 0.1));
        let lost = (1..2000_u16).filter(|&i| {
            let share = f32::from(i) / 2000.0;
            let from = Vec3::new(7.0, -3.0, 40.0) + Vec3::new(share, 0.3 * share, 0.0);
            let ray = Ray::new(from, a + (b - a) * share - from);
            let hits = [left, right].map(|t| all(&ray, &t));
            (0..3).for_each(|test| {
                assert!(hits.iter().any(|h| h[test].is_some()), "{share}");
            });
            hits.iter().all(|h| h[3].is_none())
        });
        assert!(lost.count() > 3);
    }
}
