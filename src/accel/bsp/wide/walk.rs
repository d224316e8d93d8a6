//! A ray made ready to walk the tree.
//!
//! Where a ray crosses the plane of a box's face is computed as `b * r + q` with `r = 1 / d` and `q = -o * r`. All errors on the way, seen as
//! a displacement of the face, are at most [`WALK_ERROR`] times the span of origin and tree; so `q` is lowered by as much for the
//! faces where the ray enters, and raised for those where it leaves, and no ray is lost, from however far it comes.

use glam::{Vec3, Vec4};

use super::axes::Axes;
use super::simd::parts;
use crate::geometry::tolerance::{
    BOUND_ROUNDING, LANE_SHEAR_ERROR, LEAST_LENGTH, LEAST_RATE, TURNED_WALK_ERROR, U32, WALK_ERROR,
    WALK_FARTHEST, WALK_LENGTHS,
};
use crate::geometry::{Ray, Triangle};

/// A ray ready to walk: `b * inverse + enter` is where it enters the half space beyond a face at `b`. The fourth lanes are of no use.
#[derive(Clone, Copy, Debug)]
pub(super) struct WalkRay {
    /// The ray's, in the space of the triangles, divided by `per_t`.
    pub(super) direction: Vec4,
    /// In the tree's space, as the following.
    pub(super) inverse: Vec4,
    pub(super) enter: Vec4,
    pub(super) leave: Vec4,
    /// A power of two.
    pub(super) per_t: f32,
    /// The sum of the origin's magnitudes and the greatest coordinate of the tree, as computed.
    pub(super) span: f32,
    /// Covers errors that do not shrink with what is computed: see [`LEAST_LENGTH`].
    pub(super) least: f32,
}

/// What the test of triangles in lanes needs of a ray: its frame, after Woop, Benthin and Wald (see [`RayFrame`](crate::geometry::RayFrame)).
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneRay {
    /// The coordinates' indices, the direction's largest last.
    pub(super) axes: [usize; 3],
    /// In the order of `axes`.
    pub(super) origin: [f32; 3],
    pub(super) shear: [f32; 2],
    /// The direction's component along the frame's z.
    pub(super) rate: f32,
    /// From lengths along the frame's z to those of the walk.
    walk_per_length: f32,
    /// Not less than the magnitude of any difference between a point of the tree and the origin, along each axis.
    pub(super) span: f32,
    /// Bound on the error of a sheared coordinate.
    pub(super) error: f32,
    /// As that of the [`WalkRay`].
    pub(super) least: f32,
}

/// What is the same for all rays of a tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Greatest coordinate of anything in the tree, along its own axes and along the space's.
    pub(super) largest: f32,
    /// If the tree has axes of its own.
    pub(super) axes: Option<Axes>,
}

impl Reach {
    pub(super) fn of<'a>(
        triangles: impl Iterator<Item = &'a Triangle>,
        in_tree: &[[Vec4; 3]],
        axes: Option<Axes>,
    ) -> Self {
        let greatest = |most: f32, p: Vec3| most.max(p.abs().max_element());
        let plain = triangles.flat_map(|t| *t.corners()).fold(0.0, greatest);
        let corners = in_tree.iter().flatten().map(|p| p.truncate());
        let largest = corners.fold(plain, greatest);
        Self { largest, axes }
    }
}

impl WalkRay {
    /// `None` for a ray that is not traceable, and for one from so far off, or of such a direction, that its walk leaves the range
    /// of `f32`: it must be tested against everything.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, reach: &Reach) -> Option<Self> {
        let mut origin = parts(&ray.origin);
        let mut direction = parts(&ray.direction);
        let (mut per_t, mut least) = (1.0, LEAST_LENGTH);
        let sum = |v: Vec4| v.x.abs() + v.y.abs() + v.z.abs();
        let span = sum(origin) + reach.largest;
        // What is not finite is in no range.
        if !WALK_LENGTHS.contains(&sum(direction)) {
            let scaled = rescaled(ray.direction)?;
            (direction, per_t) = (scaled.0.extend(0.0), scaled.1);
            least *= per_t.max(1.0);
        }
        let unturned = direction;
        let mut displacement = WALK_ERROR * span + least;
        if let Some(axes) = &reach.axes {
            (origin, direction) = (axes.turn(origin), axes.turn(direction));
            displacement = TURNED_WALK_ERROR * span + least;
        }
        let steepness = Vec4::ONE / direction.abs().max(Vec4::splat(LEAST_RATE));
        let inverse = steepness.copysign(direction);
        let widen = steepness * displacement;
        let middle = origin * inverse;
        (span < WALK_FARTHEST && ray.interval.min <= ray.interval.max).then_some(Self {
            direction: unturned,
            inverse,
            enter: -(middle + widen),
            leave: widen - middle,
            per_t,
            span,
            least,
        })
    }
}

/// The order of coordinates with the given one last.
const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

impl LaneRay {
    /// The frame of a ray that walks.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, walk: &WalkRay) -> Self {
        let [x, y, z] = ray.direction.abs().to_array();
        // The same choice as `RayFrame` makes, without branches; the axes keep their cyclic order.
        let last = if x > y && x > z {
            0
        } else {
            2 - usize::from(y > z)
        };
        let axes = AXES[last];
        // As slices: indexing of vectors branches.
        let origin: &[f32; 3] = ray.origin.as_ref();
        let direction: &[f32; 4] = walk.direction.as_ref();
        let per_rate = 1.0 / direction[last];
        let span = walk.span * BOUND_ROUNDING;
        Self {
            axes,
            origin: [origin[axes[0]], origin[axes[1]], origin[last]],
            shear: [direction[axes[0]] * per_rate, direction[axes[1]] * per_rate],
            rate: ray.direction.as_ref()[last],
            walk_per_length: per_rate.abs(),
            span,
            error: LANE_SHEAR_ERROR * span + f32::MIN_POSITIVE,
            least: walk.least,
        }
    }

    /// Lengths along the frame's z at which an interval of `t` begins and ends. What is further has no finite `t`, and so is no hit.
    #[inline(always)]
    pub(super) fn ends(&self, min: f32, max: f32) -> [f32; 2] {
        let rate = self.rate.abs();
        [min.max(f32::MIN) * rate, max.min(f32::MAX) * rate]
    }

    /// A length along the frame's z as one of the walk, rounded up.
    #[inline(always)]
    pub(super) fn walked(&self, length: f32) -> f32 {
        let walked = length * self.walk_per_length;
        walked + walked.abs() * (4.0 * U32)
    }
}

/// The direction divided by a power of two, so that its largest component is about 1, and that power.
#[cold]
#[inline(never)]
fn rescaled(direction: Vec3) -> Option<(Vec3, f32)> {
    let longest = direction.abs().max_element();
    if !(direction.is_finite() && longest > 0.0) {
        return None;
    }
    let (_, exponent) = libm::frexpf(longest);
    // In two steps, since 2^149 is beyond f32.
    let half = libm::ldexpf(1.0, -exponent / 2);
    let rest = libm::ldexpf(1.0, -exponent - (-exponent / 2));
    let per_t = libm::ldexpf(1.0, exponent);
    (per_t > 0.0 && per_t.is_finite()).then_some((direction * half * rest, per_t))
}
