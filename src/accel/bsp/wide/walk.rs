//! A ray made ready to walk the tree.
//!
//! Where a ray crosses the plane of a box's face is computed as `b * r + q` with `r = 1 / d` and `q = -o * r`. All errors on the way, seen as
//! a displacement of the face, are at most [`WALK_ERROR`] times the greatest coordinate of origin and scene together; so `q` is lowered by
//! as much for the faces where the ray enters, and raised for those where it leaves, and no ray is lost, from however far it comes.

use glam::Vec3A;

use crate::geometry::tolerance::{SHEAR_ERROR, U32, WALK_ERROR};
use crate::geometry::{Ray, RayFrame};

/// A ray ready to walk.
#[derive(Clone, Copy, Debug)]
pub(super) struct WalkRay {
    /// One over the direction.
    pub(super) inverse: Vec3A,
    /// Added for faces where the ray enters, and where it leaves.
    pub(super) enter: Vec3A,
    pub(super) leave: Vec3A,
    /// A bit for each component of the direction that is negative.
    pub(super) negative: usize,
    /// The direction's length was divided by this power of two.
    pub(super) per_t: f32,
    /// Greatest coordinate of the ray's origin plus that of the scene.
    pub(super) span: f32,
}

/// What the test in lanes needs of the ray's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneRay {
    pub(super) axes: [usize; 3],
    /// In the order of `axes`.
    pub(super) origin: [f32; 3],
    pub(super) shear: [f32; 2],
    /// The direction's component along the frame's z.
    pub(super) rate: f32,
    /// Bound on the error of a sheared coordinate.
    pub(super) error: f32,
}

/// What is the same for all rays of a tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Greatest coordinate of anything in the tree.
    pub(super) largest: f32,
}

/// Lengths of a direction's largest component with which the walk stays in range: inverses are below 1e6 * 2^24, and their products with
/// coordinates up to [`FARTHEST`] below 2e31.
const LENGTHS: std::ops::RangeInclusive<f32> = 1e-6..=1e6;

/// Greatest coordinate, from which on everything is tested.
const FARTHEST: f32 = 1e18;

impl WalkRay {
    /// `None` for a ray that is not traceable, and for one from so far off, or of such a direction, that its walk leaves the range
    /// of `f32`: it must be tested against everything.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, reach: Reach) -> Option<Self> {
        let origin = Vec3A::from(ray.origin);
        let mut direction = Vec3A::from(ray.direction);
        let mut longest = direction.abs().max_element();
        let mut per_t = 1.0;
        if !LENGTHS.contains(&longest) {
            (direction, per_t) = rescaled(direction, longest)?;
            longest = direction.abs().max_element();
        }
        let span = origin.abs().max_element() + reach.largest;
        let displacement = Vec3A::splat(WALK_ERROR * span + f32::MIN_POSITIVE);
        // A component of nearly nothing is taken for a little: over the whole span that is another displacement by 2u.
        let least = Vec3A::splat(longest * U32);
        let safe = direction.abs().max(least).copysign(direction);
        let inverse = Vec3A::ONE / safe;
        let middle = -origin * inverse;
        let widen = inverse.abs() * displacement;
        // Zero times what is not finite is not zero.
        let is_finite = (origin * Vec3A::ZERO + direction * Vec3A::ZERO)
            .cmpeq(Vec3A::ZERO)
            .all();
        (is_finite && span < FARTHEST && !ray.interval.is_empty()).then_some(Self {
            inverse,
            enter: middle - widen,
            leave: middle + widen,
            negative: direction.is_negative_bitmask() as usize,
            per_t,
            span,
        })
    }

    /// Its frame in the form for lanes.
    #[inline(always)]
    pub(super) fn lanes(&self, ray: &Ray, frame: &RayFrame) -> LaneRay {
        let axes = frame.axes().unwrap_or([0, 1, 2]);
        LaneRay {
            axes,
            origin: [
                ray.origin[axes[0]],
                ray.origin[axes[1]],
                ray.origin[axes[2]],
            ],
            shear: frame.shear(),
            rate: ray.direction[axes[2]],
            error: SHEAR_ERROR * (self.span * 1.000_001) + f32::MIN_POSITIVE,
        }
    }
}

impl LaneRay {
    /// Lengths along the frame's z at which an interval of `t` begins and ends.
    #[inline(always)]
    pub(super) fn ends(&self, min: f32, max: f32) -> [f32; 2] {
        let rate = self.rate.abs();
        [min * rate, max * rate]
    }
}

/// The direction divided by a power of two, so that its largest component is about 1, and that power.
#[cold]
#[inline(never)]
fn rescaled(direction: Vec3A, longest: f32) -> Option<(Vec3A, f32)> {
    if !(longest > 0.0 && longest.is_finite()) {
        return None;
    }
    let (_, exponent) = libm::frexpf(longest);
    // In two steps, since 2^149 is beyond f32.
    let half = libm::ldexpf(1.0, -exponent / 2);
    let rest = libm::ldexpf(1.0, -exponent - (-exponent / 2));
    let per_t = libm::ldexpf(1.0, exponent);
    (per_t > 0.0 && per_t.is_finite()).then_some((direction * half * rest, per_t))
}
