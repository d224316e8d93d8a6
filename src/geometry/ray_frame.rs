//! The one ray-triangle test of the crate: fast, and without error.
//!
//! After Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, which computes the edge
//! functions in a frame of the ray in single precision and falls back to double precision where one is zero. Here
//! they are compared with a bound on their error instead, and the last stage is exact:
//!
//! 1. `f32`, which is certain of all but a few in ten thousand of the triangles whose box a ray meets;
//! 2. `f64` with a filter ([`exact::filter`]), for those;
//! 3. integers ([`exact`]), where the line passes through an edge to fifteen digits.
//!
//! `t` is computed in `f64` between bounds and rounded; where the bounds round differently, integers decide. So the
//! answer is the one that [`exact`] defines, bit for bit, and any other implementation that keeps the error bound
//! (in lanes, with other instructions) gives the same.

use glam::{Vec3, Vec3A, Vec3Swizzles};

use super::exact::{self, filter};
use super::tolerance::edge_function_error;
use super::{Ray, Triangle};

/// A ray made ready for testing many triangles: its shear, after Woop, Benthin and Wald.
///
/// ```
/// use bspray::geometry::{Ray, RayFrame, Triangle};
/// use glam::Vec3;
/// let triangle = Triangle::new(Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0));
/// let frame = RayFrame::new(&Ray::new(Vec3::new(1.0, 0.5, -4.0), Vec3::new(0.0, 0.0, 2.0)));
/// assert_eq!(frame.intersect(&triangle), Some(2.0));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RayFrame {
    ray: Ray,
    axis: Axis,
    /// The origin with its axes in the frame's order.
    origin: Vec3,
    /// `d.x / d.z` and `d.y / d.z` in the frame's order; at most 1 in magnitude.
    shear: [f32; 2],
}

/// The direction's largest component, which becomes the frame's z. The axes keep their cyclic order.
#[derive(Clone, Copy, Debug)]
enum Axis {
    X,
    Y,
    Z,
    /// The ray cannot hit anything.
    Never,
}

impl Axis {
    /// The vector with its axes in the frame's order.
    #[inline]
    fn order(self, v: Vec3) -> Vec3 {
        match self {
            Self::X => v.yzx(),
            Self::Y => v.zxy(),
            Self::Z | Self::Never => v,
        }
    }
}

/// What single precision knows of a ray's line and a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The line certainly meets the triangle's inside.
    Meets,
    /// The line certainly misses it.
    Misses,
    /// It passes too close to an edge to say.
    Doubt,
}

/// The edge functions `U`, `V`, `W` of one triangle in the ray's frame, and the bound on their errors. Square units.
#[derive(Clone, Copy, Debug)]
struct EdgeFunctions {
    values: Vec3A,
    error: f32,
}

impl RayFrame {
    /// The frame of this ray. That of a ray that is not [traceable](Ray::is_traceable) hits nothing.
    pub fn new(ray: &Ray) -> Self {
        let mut frame = Self::of_traceable(ray);
        if !ray.is_traceable() {
            frame.axis = Axis::Never;
        }
        frame
    }

    /// The frame of a ray that is [traceable](Ray::is_traceable).
    #[inline(always)]
    pub(crate) fn of_traceable(ray: &Ray) -> Self {
        let magnitude = ray.direction.abs();
        let axis = if magnitude.x > magnitude.y && magnitude.x > magnitude.z {
            Axis::X
        } else if magnitude.y > magnitude.z {
            Axis::Y
        } else {
            Axis::Z
        };
        // Divided, not multiplied by a reciprocal: one rounding, no overflow, and at most 1 (see `tolerance`).
        let d = axis.order(ray.direction);
        Self {
            ray: *ray,
            axis,
            origin: axis.order(ray.origin),
            shear: [d.x / d.z, d.y / d.z],
        }
    }

    /// The ray as given, with the interval as [`set_max`](Self::set_max) left it.
    #[inline]
    pub const fn ray(&self) -> &Ray {
        &self.ray
    }

    /// The coordinates' indices in the frame's order, the direction's largest component last; `None` if the ray cannot
    /// hit anything.
    #[inline]
    pub const fn axes(&self) -> Option<[usize; 3]> {
        match self.axis {
            Axis::X => Some([1, 2, 0]),
            Axis::Y => Some([2, 0, 1]),
            Axis::Z => Some([0, 1, 2]),
            Axis::Never => None,
        }
    }

    /// The direction's first and second component in the frame's order over its third: at most 1 in magnitude.
    #[inline]
    pub const fn shear(&self) -> [f32; 2] {
        self.shear
    }

    /// Ends the interval at `max`, itself included: what a search for the closest hit does at each hit.
    #[inline]
    pub const fn set_max(&mut self, max: f32) {
        self.ray.interval.max = max;
    }

    /// Where the ray hits the triangle: `t` in units of the direction's length, correctly rounded; `None` for a miss.
    ///
    /// Exact as defined in [`exact`]: both sides count, edges and corners belong to the triangle, and the closed
    /// interval is tested on the rounded `t`. Never `-0.0`. A triangle with a coordinate that is not finite is missed.
    #[inline]
    pub fn intersect(&self, triangle: &Triangle) -> Option<f32> {
        match self.verdict(triangle) {
            Verdict::Misses => None,
            Verdict::Meets => self.depth(triangle),
            Verdict::Doubt => self.settle(triangle),
        }
    }

    /// The first stage alone. What is [`Doubt`](Verdict::Doubt) costs the next stages: for statistics, and for tests
    /// of other implementations of this stage.
    #[inline]
    pub fn verdict(&self, triangle: &Triangle) -> Verdict {
        let [a, b, c] = triangle.corners();
        let x = Vec3A::new(a.x, b.x, c.x);
        let y = Vec3A::new(a.y, b.y, c.y);
        let z = Vec3A::new(a.z, b.z, c.z);
        let EdgeFunctions { values, error } = match self.axis {
            Axis::X => self.edge_functions(y, z, x),
            Axis::Y => self.edge_functions(z, x, y),
            Axis::Z => self.edge_functions(x, y, z),
            Axis::Never => return Verdict::Misses,
        };
        // No comparison holds for a NaN, and none for a function that is infinite together with its bound.
        let positive = values.cmpgt(Vec3A::splat(error));
        let negative = values.cmplt(Vec3A::splat(-error));
        if positive.any() && negative.any() {
            Verdict::Misses
        } else if positive.all() || negative.all() {
            Verdict::Meets
        } else {
            Verdict::Doubt
        }
    }

    /// The edge functions of the triangle whose corners have these coordinates along the frame's axes: a lane for each
    /// corner. No multiply-add is fused.
    #[inline]
    fn edge_functions(&self, x: Vec3A, y: Vec3A, z: Vec3A) -> EdgeFunctions {
        let z = z - Vec3A::splat(self.origin.z);
        let x = (x - Vec3A::splat(self.origin.x)) - self.shear[0] * z;
        let y = (y - Vec3A::splat(self.origin.y)) - self.shear[1] * z;
        // The maxima may lose a NaN. It does not matter: a NaN coordinate makes two of the three functions NaN.
        let depth = z.abs().max_element();
        let lateral = (x.abs() + y.abs()).max_element();
        EdgeFunctions {
            // U = Xc Yb - Yc Xb, V = Xa Yc - Ya Xc, W = Xb Ya - Yb Xa.
            values: x.zxy() * y.yzx() - y.zxy() * x.yzx(),
            error: edge_function_error(depth, lateral),
        }
    }

    /// The second and third stage.
    #[cold]
    #[inline(never)]
    fn settle(&self, triangle: &Triangle) -> Option<f32> {
        exact::meets(&self.ray, triangle).then_some(())?;
        self.depth(triangle)
    }

    #[inline(always)]
    fn depth(&self, triangle: &Triangle) -> Option<f32> {
        depth(&self.ray, triangle)
    }
}

/// The correctly rounded `t` of a ray whose line meets the triangle, if it lies in the interval.
#[inline(always)]
fn depth(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    let bounds = filter::depth(ray, triangle);
    if let Some(t) = rounded(bounds) {
        return ray.interval.contains(t).then_some(t);
    }
    if bounds.is_some_and(|bounds| are_beside(ray, bounds)) {
        return None;
    }
    let t = exact_depth(ray, triangle)?;
    (t.is_finite() && ray.interval.contains(t)).then_some(t)
}

/// Whether a ray certainly meets the triangle's plane beside its interval, so that it does not hit the triangle, whatever its line meets. `false` is doubt.
///
/// Cheaper than the test: for those who have in doubt the triangle that a ray leaves.
#[inline]
pub(crate) fn is_beside(ray: &Ray, triangle: &Triangle) -> bool {
    filter::depth(ray, triangle).is_some_and(|bounds| are_beside(ray, bounds))
}

/// Whether all between two bounds of `t` is beside the ray's interval.
#[inline(always)]
fn are_beside(ray: &Ray, (low, high): (f64, f64)) -> bool {
    (high as f32) < ray.interval.min || (low as f32) > ray.interval.max
}

/// The `f32` that everything between these bounds is rounded to, if it is one and finite.
#[inline(always)]
pub(crate) fn rounded(bounds: Option<(f64, f64)>) -> Option<f32> {
    let (low, high) = bounds?;
    let (low, high) = (low as f32, high as f32);
    // Adding +0 turns -0 into +0.
    (low.to_bits() == high.to_bits() && low.is_finite()).then_some(low + 0.0)
}

#[cold]
#[inline(never)]
fn exact_depth(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    exact::depth_of_plane(ray, triangle).map(|depth| depth.to_f32())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Interval;
    use crate::geometry::exact::Sign;
    use dashu_ratio::Relaxed;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    /// Coordinates that make trouble: few different values, neighbours of each other, and all magnitudes.
    fn coordinate() -> impl Strategy<Value = f32> {
        let near =
            |x: f32| (-2i32..=2).prop_map(move |k| f32::from_bits((x.to_bits() as i32 + k) as u32));
        prop_oneof![
            8 => (-3i8..=3).prop_map(f32::from),
            4 => near(0.1),
            4 => near(-1.7),
            4 => -10.0..10.0f32,
            1 => prop::sample::select(vec![-0.0, 1e18, -1e18, 9.9e17, 1e-30, -3e-20, 1e-45, 5e-39, 1e30, f32::MAX]),
        ]
    }

    fn vector() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(coordinate()).prop_map(Vec3::from_array)
    }

    fn triangle() -> impl Strategy<Value = Triangle> {
        prop::array::uniform3(vector()).prop_map(|[a, b, c]| Triangle::new(a, b, c))
    }

    fn ray() -> impl Strategy<Value = Ray> {
        let interval = prop::sample::select(vec![
            Interval::FORWARD,
            Interval::new(f32::NEG_INFINITY, f32::INFINITY),
            Interval::new(0.5, 2.0),
        ]);
        (vector(), vector(), interval).prop_map(|(origin, d, i)| Ray::new(origin, d).within(i))
    }

    /// Small triangles far away, seen through or beside their middle, where the shear's error is all there is; and, if
    /// flattened along z, triangles all around the ray's origin, where that of the products is.
    fn aimed() -> impl Strategy<Value = (Ray, Triangle)> {
        let real = prop::array::uniform3(-1.0..1.0f32);
        let size = prop::sample::select(vec![1.0f32, 1e-2, 1e-4, 1e-6]);
        let scale = prop::sample::select(vec![1.0f32, 1e-12, 1e-19, 1e-21, 1e17]);
        let flat = prop::sample::select(vec![1.0f32, 1e-4]);
        (prop::array::uniform6(real), size, scale, flat).prop_map(|(v, size, scale, flat)| {
            let [origin, middle, a, b, c, d] = v.map(Vec3::from_array);
            let points = [
                origin,
                middle + a * size,
                middle + b * size,
                middle + c * size,
            ];
            let [o, a, b, c] = points.map(|p| p * scale * Vec3::new(1.0, 1.0, flat));
            let direction = (middle + d * size * 0.3 - origin) * Vec3::new(flat, flat, 1.0);
            (Ray::new(o, direction), Triangle::new(a, b, c))
        })
    }

    fn any_pair() -> impl Strategy<Value = (Ray, Triangle)> {
        prop_oneof![(ray(), triangle()), aimed()]
    }

    /// The edge functions in the frame of the ray, without rounding.
    fn exact_edge_functions(frame: &RayFrame, triangle: &Triangle) -> [Relaxed; 3] {
        let rational = |v: Vec3| v.to_array().map(|x| Relaxed::try_from(x).unwrap());
        let d = rational(frame.axis.order(frame.ray.direction));
        let o = rational(frame.origin);
        exact::edges(triangle).map(|(from, to)| {
            let [[cx, cy, _], [bx, by, _]] = [from, to].map(|p| {
                let p = rational(frame.axis.order(p));
                let [x, y, z] = std::array::from_fn(|i| &p[i] - &o[i]);
                [x - &z * &d[0] / &d[2], y - &z * &d[1] / &d[2], z]
            });
            cx * by - cy * bx
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            cases: 20_000,
            rng_seed: RngSeed::Fixed(20_130_628),
            ..ProptestConfig::default()
        })]

        #[test]
        fn edge_functions_keep_their_error_bound((ray, triangle) in any_pair()) {
            let frame = RayFrame::new(&ray);
            prop_assume!(!matches!(frame.axis, Axis::Never));
            let [a, b, c] = triangle.corners().map(|p| frame.axis.order(p));
            let lanes = |i: usize| Vec3A::new(a[i], b[i], c[i]);
            let found = frame.edge_functions(lanes(0), lanes(1), lanes(2));
            let truth = exact_edge_functions(&frame, &triangle);
            if found.error.is_finite() {
                let bound = Relaxed::try_from(found.error).unwrap();
                for (x, truth) in found.values.to_array().into_iter().zip(truth) {
                    if x.is_finite() {
                        let error = Relaxed::try_from(x).unwrap() - truth;
                        prop_assert!(error <= bound && -error <= bound, "{found:?}");
                    } else {
                        prop_assert!(x.is_infinite() && (truth > Relaxed::ZERO) == (x > 0.0));
                    }
                }
            }
        }

        #[test]
        fn every_stage_agrees_with_the_integers((ray, triangle) in any_pair()) {
            let signs = exact::edge_signs(&ray, &triangle);
            for (i, (from, to)) in exact::edges(&triangle).into_iter().enumerate() {
                let sign = filter::edge_sign(&ray, from, to);
                prop_assert!(sign.is_none_or(|sign| sign == signs[i]));
            }
            prop_assert_eq!(exact::meets(&ray, &triangle), exact::is_inside(signs));
            let frame = RayFrame::new(&ray);
            match frame.verdict(&triangle) {
                Verdict::Meets => {
                    prop_assert!(signs[0] != Sign::Zero && signs == [signs[0]; 3]);
                }
                Verdict::Misses => {
                    prop_assert!(!ray.is_traceable() || !exact::is_inside(signs));
                }
                Verdict::Doubt => {}
            }
            prop_assert_eq!(
                frame.intersect(&triangle).map(f32::to_bits),
                exact::intersect(&ray, &triangle).map(f32::to_bits)
            );
        }
    }
}
