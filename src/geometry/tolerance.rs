//! Every epsilon of the crate, with its derivation, and no epsilon anywhere else.
//!
//! `u` is the unit roundoff of single precision, 2^-24: one rounded operation has a relative error of at most `u`.

/// Unit roundoff of `f32`: 2^-24.
pub const U32: f32 = f32::EPSILON / 2.0;

/// Unit roundoff of `f64`: 2^-53.
pub const U64: f64 = f64::EPSILON / 2.0;

/// Largest coordinate that an importer accepts, in model units.
///
/// Products of two coordinates stay below 1e36 and their sums below the largest `f32` (3.4e38), so that areas and edge
/// functions cannot overflow. A larger one drops its triangles as a defect.
pub const COORDINATE_LIMIT: f32 = 1e18;

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

/// Distance, in the same units, beyond which a ray's origin makes the tree above the instances visit them all.
///
/// A ray taken to an instance's object space is rounded there, and so passes the instance beside its world-space line by
/// a multiple of u times this distance; [`instance_margin`] covers it up to here.
pub const INSTANCE_FAR: f64 = 64.0;

/// How far the object-space form of a ray passes beside its world-space line, at most, in world units.
///
/// The object-space origin and direction are rounded: by `u |o|` and `u |d|` a component, `o` being at most `reach *
/// inverse_norm + object_radius` from the origin of the object's space, and `t |d|` at most `|o|` plus `object_radius`. The sum comes back to
/// world space through a matrix of Frobenius norm `norm`; the square root of 3 is for the three components. `reach` is
/// the distance of the ray's origin from the instance's own, in world units.
pub fn instance_margin(norm: f64, inverse_norm: f64, object_radius: f64, reach: f64) -> f64 {
    let origin = reach * inverse_norm;
    2.0 * 1.7321 * f64::from(U32) * norm * (2.0 * origin + object_radius)
}

/// How far a ray must start from the surface that it leaves, in world units: `factors.0 * c + factors.1`, where `c` is the
/// greatest coordinate of the triangle's corners in world space.
///
/// The point on the surface is rounded (u c a component), as are the corners of a triangle that was baked into world space
/// (u c), and the offset point itself (u c); along a unit normal that is sqrt(3) times 3 u c, below 6 u c; 8 u leaves room
/// for the rounding of the normal. Where the triangle is tested in object space, the ray is rounded once more there, by up to
/// [`instance_margin`] for an origin on the surface: `reach * inverse_norm` is then at most sqrt(3) `object_radius`, the
/// greatest coordinate of the mesh. A smaller offset lets a surface shadow itself; a larger one lets light leak through thin walls.
pub fn surface_offset_factors(world_from_object: glam::DMat3, object_radius: f32) -> (f32, f32) {
    let norm = world_from_object.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    let radius = 1.7321 * f64::from(object_radius);
    (8.0 * U32, instance_margin(norm, 1.0, radius, radius) as f32)
}
