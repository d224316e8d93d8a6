//! Every epsilon of the crate, with its derivation, and no epsilon anywhere else.
//!
//! `u` is the unit roundoff of single precision, 2^-24: one rounded operation has a relative error of at most `u`,
//! and, where it may underflow, an absolute error of at most 2^-150 besides (sums and differences never need that
//! part: they are exact when they are subnormal). `v` is the unit roundoff of double precision, 2^-53. A hat marks a
//! computed value; names without one are exact.
//!
//! # The edge functions in single precision
//!
//! After Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, a corner `p` becomes
//! `A = p - origin` with its axes permuted so that the direction's largest component is z, and then
//! `X = A.x - S A.z` with `S = d.x / d.z`, `|S| <= 1`; `Y` in the same way. The edge function of the corners `c`, `b`
//! is `U = Xc Yb - Yc Xb`, and the exact one is `det(d, c - origin, b - origin) / d.z`.
//!
//! 1. *One coordinate.* `A^ = A (1 + r)` and `S^ = S (1 + r) + h`, then the product, then the difference, with each
//!    `|r| <= u`, `|h| <= 2^-150`. The error of `A.x` is at most `u |A.x| <= u (|X| + |A.z|)`, that of the product at
//!    most `(3u + 3u^2 + u^3) |A.z| + 2^-150 (1 + 2 |A.z|)`, that of the last rounding at most `u |X^|`. With
//!    `|X| <= |X^| + |X^ - X|` and `M` = the greatest `|A^.z|` of the three corners:
//!    `|X^ - X| <= e + 2u (1 + 2u) |X^|` with `e = 4u M` plus terms of `u^2 M` plus 2^-149.
//! 2. *One product difference.* Let `s` be the greatest `|X^| + |Y^|` of the three corners. Replacing the four exact
//!    coordinates by computed ones changes `U` by at most
//!    `e (|Xc| + |Yc| + |Xb| + |Yb|) + 4u (|Xc Yb| + |Yc Xb|) + 2 (e + 2u s)^2 <= 2 e s + 4u s^2 + 2 e^2` plus terms of
//!    `u e s` and `u^2 s^2`. The two products and the difference round by at most `2u s^2 + 2^-149` more.
//!    (`|Xc Yb| + |Yc Xb| <= (|Xc| + |Yc|) max(|Xb|, |Yb|) <= s^2`.)
//! 3. *Sum.* `|U^ - U| <= 2 e s + 2 e^2 + 6u s^2 + 2^-149` plus second-order terms. With 5 for the 4 in `e` and 7 for
//!    the 6, a quarter and a sixth are left over. They pay for the second-order terms, for the roundings of `s` and of
//!    the bound itself, and 2^-126 added to `e` and to the sum pays for every underflow on the way.
//!
//! Nothing overflows unnoticed: an infinite `A` or `X` makes the bound infinite or NaN; `|X^| <= s^` (rounding is
//! monotone), so that a product of the edge function overflows only if `s^ s^` does; and an overflow of the
//! difference of two finite products has the right sign. Comparisons with an infinite or NaN bound decide nothing.
//!
//! # The determinants in double precision
//!
//! Products of three differences of `f32` neither overflow nor underflow in `f64` (they lie between 2^-447 and 2^387).
//! So each computed term is the exact one times `(1 + r)^k`, `|r| <= v`, where `k` counts the roundings on its way,
//! and the error is at most `k v / (1 - k v)` times the sum of the absolute values of the terms, which is the
//! permanent in Shewchuk's filter ("Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates", 1997). One more `v` pays for the permanent's own roundings, all of which together are below `16 v^2`.

/// Unit roundoff of `f32`: 2^-24.
pub const U32: f32 = f32::EPSILON / 2.0;

/// Factor on a sum of a few positive `f32`s that pays for its roundings, and those of its terms: up to sixteen of them. Larger: nothing but
/// somewhat coarser bounds.
pub const BOUND_ROUNDING: f32 = 1.0 + 16.0 * U32;

/// Unit roundoff of `f64`: 2^-53.
pub const U64: f64 = f64::EPSILON / 2.0;

/// Largest coordinate that an importer accepts, in model units.
///
/// Products of two coordinates stay below 1e36 and their sums below the largest `f32` (3.4e38), so that areas and edge
/// functions cannot overflow. A larger one drops its triangles as a defect.
pub const COORDINATE_LIMIT: f32 = 1e18;

/// Error of a sheared coordinate in units of the greatest depth `M`: 4u by step 1 above, and u to spare.
///
/// Smaller than 4u and hits are decided wrongly; larger and more triangles go to the slower `f64` stage.
pub const SHEAR_ERROR: f32 = 5.0 * U32;

/// The same for a shear that is a product with the rounded inverse of the direction's largest component, as the lanes of the wide BSP
/// have it: one rounding more, 5u, and u to spare.
pub const LANE_SHEAR_ERROR: f32 = 6.0 * U32;

/// Error of an edge function in units of `s^2`: 6u by steps 2 and 3 above, and u to spare.
pub const PRODUCT_ERROR: f32 = 7.0 * U32;

/// Largest error of the three edge functions of one triangle in single precision, by the derivation above.
///
/// `depth` is the greatest `|A.z|` of the corners and `lateral` the greatest `|X| + |Y|`, both as computed, in model
/// units; the result is in square units. An edge function whose magnitude exceeds it has the right sign.
///
/// ```
/// use bspray::geometry::tolerance::edge_function_error;
/// // A triangle of lateral size 1 at distance 10: edge functions above 7e-6 are certain.
/// let error = edge_function_error(10.0, 1.0);
/// assert!(6e-6 < error && error < 7e-6);
/// ```
#[inline]
pub fn edge_function_error(depth: f32, lateral: f32) -> f32 {
    edge_error(SHEAR_ERROR * depth + f32::MIN_POSITIVE, lateral)
}

/// The same from a bound on the error of the sheared coordinates.
#[inline(always)]
pub(crate) fn edge_error(shear: f32, lateral: f32) -> f32 {
    2.0 * shear * (lateral + shear) + PRODUCT_ERROR * (lateral * lateral) + f32::MIN_POSITIVE
}

/// Error of a depth in lanes, beside that of the edge functions, in units of twice the greatest depth `M`: 16 u.
///
/// In lanes, the depth of a hit along the frame's z is `(U / D) Az + (V / D) Bz + (W / D) Cz`, `D = U + V + W`: shares first, since the products `U Az` may leave
/// the range of `f32`. `E` is the bound on the error of an edge function. Where none is beyond it on the wrong side, `|U| + |V| + |W| <= |D| + 4 E`. The
/// edge functions' errors change the sum by `3 E M / |D|`, and `D` by `3 E`; the depth of a point of the triangle is at most `M`, so that the quotient is
/// wrong by at most `6 E M / |D|` for them, and by `8u (1 + 4 E / |D|) M` for the roundings of `D`, its inverse, shares, depths, products and sums. The margin's subtraction adds u, and the
/// ends of the interval, which are products of a rounded `t`, 2u of themselves: twice `M` at most. `2 M (4 E / |D| + 16 u)` leaves half as much again. Smaller than 7 u:
/// hits are lost; larger: more of them wait for double precision.
pub const LANE_DEPTH_ERROR: f32 = 16.0 * U32;

/// Error of `det(d, p - o, q - p)` in `f64`, in units of its permanent.
///
/// Seven roundings a term: two differences, a product, the minor's difference, a product, two sums.
pub const EDGE_FILTER: f64 = 8.0 * U64;

/// Error of one component of `(b - a) x (c - a)` in `f64`, in units of its permanent: four roundings a term.
pub const NORMAL_FILTER: f64 = 5.0 * U64;

/// Error of `((b - a) x (c - a)) . (a - o)` in `f64`, in units of its permanent.
///
/// Eight roundings a term: four for the normal, the difference `a - o`, a product, two sums. The surplus of 2, and that
/// of [`DENOMINATOR_FILTER`], are worth at least `4v |t|` in the radius around the quotient `t`. They pay for the two
/// roundings of the quotient and that of the interval's end, `3v |t|`; and a fifth of the radius pays for its own.
pub const NUMERATOR_FILTER: f64 = 10.0 * U64;

/// Error of `((b - a) x (c - a)) . d` in `f64`, in units of its permanent: seven roundings a term, and a surplus of 2,
/// see [`NUMERATOR_FILTER`].
pub const DENOMINATOR_FILTER: f64 = 9.0 * U64;

/// Factor on a running error bound that pays for the bound's own roundings.
///
/// It is a sum of at most four products and quotients of numbers that are not negative, in at most eight operations: `(1 + v)^8 < 1 + 9v`. Less: a bound may
/// be rounded to below the error.
pub const RUNNING_BOUND: f64 = 1.0 + 16.0 * U64;

/// Greatest error of a component of a plane's normal, in units of the largest component, for which `f64` is trusted; above, it is computed in
/// integers. At 2^-40 a polygon a metre wide is placed to within 1e-12 m. Smaller: more integers; greater: more of the plane's neighbourhood is in doubt.
pub const PLANE_TRUST: f64 = 1.0 / (1_u64 << 40) as f64;

/// Greatest error of a constructed point, in units of its greatest coordinate, for which `f64` is trusted; above, its position is rounded from integers.
/// As [`PLANE_TRUST`].
pub const POSITION_TRUST: f64 = 1.0 / (1_u64 << 40) as f64;

/// Least share of its permanent that the largest component of a triangle's normal must reach for `f64` to be trusted
/// with its direction; below, it is computed in integers.
///
/// The normal's error is at most `sqrt(3) * NORMAL_FILTER` times the largest permanent, so that at this share (2^-25)
/// the direction is wrong by less than 8.7 * 2^-53 / 2^-25 < 2^-24, half an ulp of 1 in `f32`.
pub const NORMAL_TRUST: f64 = 1.0 / (1u32 << 25) as f64;

/// Largest relative difference between the area of a polygon and that of its triangles which counts as rounding.
///
/// Both are sums of n products of differences in `f64`, so that rounding stays below about 4 n * 2^-53 of the polygon's
/// extent squared: 5e-12 for ten thousand corners. A polygon that crosses itself is off by the share of its area that is
/// covered twice. Larger: such crossings pass unnoticed; smaller: thin polygons lose their ears and become fans.
pub const POLYGON_AREA_TOLERANCE: f64 = 1e-9;

/// Margin around the boxes of the obvhs trees, in units of half the scene's largest extent: 64 u, about 4e-6.
///
/// In the space of `accel::normalized`, boxes and the ray's walk lie within 4 units. The errors of the slab test
/// `(b - o) * (1 / d)`, seen as a displacement of the box's face: subtraction, reciprocal and product, u each on at most 4
/// units: 12 u, and 8 u more for the wide tree's sum of two such terms. The walk's origin and direction are rounded: 2 u + 4 u. A
/// direction component below 2 u is clamped by obvhs to 2 u: a drift of 8 u over 4 units. The boxes are
/// rounded: 2 u. Together 36 u; the rest is reserve. Smaller, and rays along box faces are lost; larger, and
/// tiny triangles get needlessly large boxes.
pub const BVH_PADDING: f32 = 64.0 * U32;

/// Distance from the middle of the scene, in units of half its largest extent, beyond which a ray's origin is too far off for
/// double precision to tell where it passes the scene to well within [`BVH_PADDING`]: 1e9 times 2^-53 is 1.1e-7.
/// Such rays are tested against every triangle.
pub const BVH_FAR: f64 = 1e9;

/// Displacement of a box's face that covers every error of the wide BSP's walk, in units of the span `S`: the sum of the
/// magnitudes of the origin's coordinates, plus the greatest coordinate of the tree: 8 u.
///
/// Where the line crosses a face at `b` is computed as `b r + q`, with `r` = 1 / d rounded and `q = -o r - D |r|` where the ray enters (`+` where it
/// leaves), `D` the displacement. Multiplied by `d`, the errors are those of `r`, u |b - o|; of the product `b r`, u |b|; of `o r`, of
/// the sum and of `D |r|`, u (2 |o| + 2 D); of the last sum, u (|b - o| + D), or fewer where products and sums are fused. With
/// `|b| + |o| <= S`: 4 u S. A component of the direction below [`LEAST_RATE`] is taken for that, which moves the line
/// by at most u S within the tree. A hit counts by its rounded `t`, which may lie u |t| from the true one: along each
/// axis again u S. Together 6 u S, and 2 u for the rounding of `S` and of `D`. Smaller, and rays along faces are lost.
pub const WALK_ERROR: f32 = 8.0 * U32;

/// As [`WALK_ERROR`] for a tree with axes of its own: 24 u.
///
/// The tree's corners and the ray are multiplied by one matrix of entries up to 1, which as such is no error. A turned corner is rounded: u S. A
/// component of the turned origin is a sum of three products: 3 u S. One of the direction: 3 u of the sum of its magnitudes, which from the origin to a point of
/// the tree is at most three times the tree's greatest coordinate and the origin's sum: 9 u S. With the 8 u: 21 u, and 3 u to spare.
pub const TURNED_WALK_ERROR: f32 = 24.0 * U32;

/// As [`WALK_ERROR`], where the walk goes by lengths along the direction's largest axis: 10 u.
///
/// The slopes `d.x / d.z` are rounded, and so are the ends of the interval as lengths, `t |d.z|`: u S each. The least slope is u.
pub const GROUP_WALK_ERROR: f32 = 10.0 * U32;

/// Displacement of the sides of a shaft around rays, and of its ends, that covers the errors in them, in units of the greatest span `S` of the rays, see [`WALK_ERROR`]: 32 u.
///
/// A ray's x at the z of an end of the shaft is `o.x + (z - o.z) s`, with |s| <= 1 and |z| <= S: u S each for the slope, the difference
/// and the product, and u |x| <= 2 u S for the sum. A side is the line `a + s z` with `a` a difference: 4 u S. What lies beside it is told by `(a - b) + s z`: 5 u S for the
/// difference, u S for the product, and 5 u S for the sum. Together 20 u S. Where a ray's interval ends is known to 4 u S along z, and
/// so it is between ends that are moved apart by this much. The rest is for the rounding of `S` and of the displacement. Smaller, and rays at the rim of a group are lost.
pub const SHAFT_ERROR: f32 = 32.0 * U32;

/// Error of lengths, and of where a ray is, that does not shrink with them: 2^-126 of a model unit.
///
/// Whatever underflows in the wide BSP is off by 2^-150, a few times at most. A hit counts by its rounded `t`: where that is subnormal it is off by 2^-150
/// too, which along a direction whose components are up to [`WALK_LENGTHS`] makes 2^-130. A longer direction takes this times the power of two that
/// it is divided by. Smaller, and hits in tiny scenes, or close to the origin, are lost at the ends of intervals.
pub const LEAST_LENGTH: f32 = f32::MIN_POSITIVE;

/// Sums of the magnitudes of a direction's components with which the wide BSP's walk stays in the range of `f32`. Other directions
/// are scaled by a power of two first.
pub const WALK_LENGTHS: std::ops::RangeInclusive<f32> = 1e-6..=1e6;

/// Least magnitude of a direction's component in the wide BSP's walk: u times the least that the largest component can be by
/// [`WALK_LENGTHS`]. Its inverse times the largest coordinate of the walk is 5e31.
pub const LEAST_RATE: f32 = 1e-6 / 3.0 * U32;

/// Greatest span of the wide BSP's walk; rays from further off are tested against every triangle. It is the importers'
/// [`COORDINATE_LIMIT`], twice.
pub const WALK_FARTHEST: f32 = 2.0 * COORDINATE_LIMIT;

/// Error of a polygon's cut at up to six planes, along each axis, in units of the greatest difference between coordinates of its
/// triangle: 5 u for each cut, in `p + (q - p) f`: one each for the difference, the product and the three operations of `f`.
pub const CUT_ERROR_BY_SIZE: f32 = 32.0 * U32;

/// Further error of such cuts, in units of the greatest coordinate: u for the sum of each cut.
pub const CUT_ERROR_BY_PLACE: f32 = 8.0 * U32;

/// Distance, in the same units, beyond which a ray's origin makes the tree above the instances visit them all.
///
/// A ray taken to an instance's object space is rounded there, and so passes the instance beside its world-space line by
/// a multiple of u times this distance; [`object_space_error`] covers it up to here.
pub const INSTANCE_FAR: f64 = 64.0;

/// Length of a direction in object space, below which it may lose more than u of itself where it underflows: 2^-126.
///
/// In world space, the largest component is compared with this times the Frobenius norm of the way there. With shorter directions every instance is
/// visited. Smaller: hits are lost by directions below 1e-38; larger: more rays visit all.
pub const INSTANCE_LEAST_DIRECTION: f64 = f32::MIN_POSITIVE as f64;

/// Height above a plane that covers the roundings of a ray's walk through the polygon BSP, in units of the sum of the coordinates of `o - a` and of `t d`,
/// beside the error of the plane's normal: 16 v.
///
/// `n . (o - a) + t n . d` in `f64`, the greatest component of `n` being 1: each term of the products has the rounding of the difference `o - a`, of
/// the product and of two sums, 4v; the time at which the height leaves the margin has a difference and a quotient, which move the height by 2v of its parts; the height at a
/// given time a product and a sum: 2v. Together 8v at most; the rest is for the roundings of the margin itself. Smaller: hits in planes are lost.
pub const WALK_MARGIN: f64 = 16.0 * U64;

/// Greatest difference between a polygon's area and those of its fragments, in units of its area and of its longest edge times its greatest
/// coordinate. The coordinates of cut corners are rounded by [`POSITION_TRUST`] of the greatest at most, and so is a strip along each cut; 64 cuts are covered.
pub const TILING_AREA: f64 = 64.0 * POSITION_TRUST;

/// How far the object-space form of a ray passes beside its world-space line, at most, in world units.
///
/// The object-space origin and direction are rounded: by `u |o|` and `u |d|` a component, `o` being at most `reach *
/// inverse_norm + object_radius` from the origin of the object's space, and `t |d|` at most `|o|` plus `object_radius`. The sum comes back to
/// world space through a matrix of Frobenius norm `norm`; the square root of 3 is for the three components. `reach` is
/// the distance of the ray's origin from the instance's own, in world units. What underflows is off by `u` 2^-126 more. For the origin that is added here;
/// the direction must be at least [`INSTANCE_LEAST_DIRECTION`] times `norm`, so that it is no more than the first `u |d|` again, which the factor 2 pays for.
pub fn instance_margin(norm: f64, inverse_norm: f64, object_radius: f64, reach: f64) -> f64 {
    let origin = reach * inverse_norm;
    2.0 * 1.7321
        * f64::from(U32)
        * norm
        * (2.0 * origin + object_radius + f64::from(f32::MIN_POSITIVE))
}

/// Displacement of an extent's faces, in model units, that pays for every underflow of its test, and for the least numbers of the ray's parameter: 2^-60.
///
/// The tests scale a ray's direction by a power of two so that its greatest component lies between 1/2 and 1. A small component may lose 2^-150 by that,
/// which over the longest way, 2^63, is 2^-87. A hit at a `t` below 2^-150 counts as one at 0; by the greatest scale, 2^81, that is a way of 2^-69.
/// Smaller than both together: such hits are lost; larger: extents of models of that size reject nothing.
pub const EXTENT_FLOOR: f32 = 1.0 / (1_u64 << 60) as f32;

/// Magnitudes of a direction's greatest component for which extents are tested, see [`EXTENT_FLOOR`]: 2^-80 to 2^80. Other rays pass.
pub const EXTENT_DIRECTIONS: std::ops::RangeInclusive<f32> = 8.271_806e-25..=1.208_925_8e24;

/// Greatest coordinate of extents and of rays' origins for which extents are tested: the squares of cross products of their differences with a direction,
/// summed, stay below 2e38. Other rays pass. It is the importers' [`COORDINATE_LIMIT`], twice.
pub const EXTENT_FARTHEST: f32 = 2.0 * COORDINATE_LIMIT;

/// Error of the time at which a ray crosses a plane of a box extent, in units of that time: 4 u.
///
/// `(b - o) / d` has the roundings of the difference and of the quotient, 2 u + u^2, and the time that is moved by the error has one more.
/// Both ends of the ray's interval are moved by as much, for the rounding of a hit's `t`. Smaller: rays along faces are lost.
pub const EXTENT_TIME_ERROR: f32 = 4.0 * U32;

/// Error of the distance of a line from the centre of a sphere extent, in units of the sum of the magnitudes of `o - c`: 8 u.
///
/// A component of `(o - c) x d` has two products of a rounded difference, and a difference: 3 u + 3 u^2 of the sum of the magnitudes of
/// the products. The vector of these sums is at most sqrt 2 |o - c| |d| long: 4.3 u |o - c| |d|. The scalar product `(o - c) . d` has four roundings a
/// term: 4.1 u of the sum of magnitudes, and 2 u for what it is compared with. Smaller: rays that touch the sphere are lost.
pub const EXTENT_DISTANCE_ERROR: f32 = 8.0 * U32;

/// Relative error of the squares that are compared in the test of a sphere extent: 3 u each for three squared lengths, 2 u for the enlarged radius, twice, and
/// 2 u for products: 17 u. The rest is reserve.
pub const EXTENT_SQUARE_ERROR: f32 = 32.0 * U32;

/// Greatest `n^3 / det` (`n` the norm of a placement's matrix) for which an object's extents take part in tests of rays that are taken to its space:
/// 2^32. The inverse is computed in `f64` with an error of some `v n^3 / det`, here 2^-21 of itself, which [`object_space_error`] covers.
pub const EXTENT_MOST_SKEW: f64 = (1_u64 << 32) as f64;

/// How far a ray that is taken to object space passes there beside the exact image of its line, at most, in units of the object.
///
/// `inverse_norm` is the norm of the inverse placement, `skew` that of the placement to the third power over its determinant, `object_radius`
/// the greatest distance of the object's points from the origin of its space, `reach` the distance of the ray's origin from the placement's translation,
/// and `translation` the length of that, in world units. In single precision it is what [`instance_margin`] has for a norm of 1. In double precision the map
/// of a point has at most 7 v of `inverse_norm (reach + 2 translation)`, and the inverse itself is wrong by a share of 10 v `skew`; 32 covers both.
pub fn object_space_error(
    inverse_norm: f64,
    skew: f64,
    object_radius: f64,
    reach: f64,
    translation: f64,
) -> f64 {
    let origin = reach * inverse_norm;
    let double = skew * (2.0 * origin + object_radius) + inverse_norm * (reach + 2.0 * translation);
    instance_margin(1.0, inverse_norm, object_radius, reach) + 32.0 * U64 * double
}

/// Distance between a point of an object as it is tested and the hull of its point cluster in world space, at most, in units of the greatest coordinate: 4 u.
///
/// Both a corner of a triangle and a point of the cluster are placed in double precision and rounded once, u a component: 2 sqrt 3 u, and the rest for the roundings
/// in double precision, whose sums may be some thousand times as large before they cancel.
pub const CLUSTER_ERROR: f64 = 4.0 * U32 as f64;

/// Error of the tangent of the angle at which an eye ray leaves the view axis, in units of `1 + x^2 + y^2` (`x`, `y` the greatest tangents of the screen): 4 u.
///
/// The direction has unit length, and each component is rounded: u. The tangent is a quotient of components, the divisor being `1 / sqrt(1 + x^2 + y^2)` at
/// least: u (1 + |x|) sqrt(1 + x^2 + y^2), at most 1.5 u (1 + x^2 + y^2). The rest pays for all that is computed in double precision. Smaller: objects lose pixels at their rim.
pub const SCREEN_ERROR: f64 = 4.0 * U32 as f64;

/// How far a ray must start from the surface that it leaves, in world units: `factors.0 * c + factors.1`, where `c` is the
/// greatest coordinate of the triangle's corners in world space.
///
/// The point on the surface is rounded (u c a component), as are the corners of a triangle that was baked into world space
/// (u c), and the offset point itself (u c); along a unit normal that is sqrt(3) times 3 u c, below 6 u c; 8 u leaves room
/// for the rounding of the normal. Where the triangle is tested in object space, the ray is rounded once more there, by up to
/// [`instance_margin`] for an origin on the surface: `reach * inverse_norm` is then at most sqrt(3) `object_radius`, the
/// greatest coordinate of the mesh. A smaller offset lets a surface shadow itself; a larger one lets light leak through thin walls.
pub fn surface_offset_factors(world_from_object: glam::DMat3, object_radius: f32) -> (f32, f32) {
    let norm = world_from_object
        .to_cols_array()
        .iter()
        .map(|x| x * x)
        .sum::<f64>()
        .sqrt();
    let radius = 1.7321 * f64::from(object_radius);
    (8.0 * U32, instance_margin(norm, 1.0, radius, radius) as f32)
}

/// Error of a depth, in units of itself, up to which a method that does not promise exact depths is not blamed: 2^-12, half of the digits of `f32`.
///
/// A brute-force test in single precision is wrong by some tens of u. Smaller: such noise counts as failure; larger: depths pass that show in a picture.
pub const PLAUSIBLE_DEPTH: f64 = 1.0 / 4096.0;

/// Share of its permanent below which a determinant is taken for one that single precision cannot tell from zero, where wrong answers are explained: 16 u.
///
/// The sum of the roundings of a naive determinant of three rows is 8 u to 14 u. Smaller: rays beside an edge are explained by something else; larger: edges explain all.
pub const SINGLE_DOUBT: f64 = 16.0 * U32 as f64;

/// The epsilon of the naive triangle test that `stress` shows: that of the listing in Moller and Trumbore, "Fast, Minimum Storage Ray/Triangle
/// Intersection", 1997. It has no derivation, which is the point.
pub const NAIVE_DETERMINANT: f32 = 1e-6;

/// The fixed epsilon of the naive BSP that `stress` shows, in model units: the 1e-5 of Ize's published implementation. It has no derivation either.
pub const NAIVE_PLANE: f32 = 1e-5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_function_that_can_overflow_is_never_certain() {
        // 1.9e19 squared exceeds f32::MAX, and so may a product of two coordinates of that size.
        assert!(edge_function_error(0.0, 1.9e19).is_infinite());
        assert!(edge_function_error(0.0, 1.8e19).is_finite());
        assert!(edge_function_error(f32::INFINITY, 0.0).is_infinite());
    }
}
