//! The attributes of a primitive's vertices: which accessors hold them, and what their values may be.

use ::gltf::json::mesh::{MorphTarget, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use glam::{Vec2, Vec3, Vec4};

use super::notes::Notes;
use super::pose::MeshPose;

/// Most sets of texture coordinates that are read: more than any file was seen to have. A set's number costs nothing in
/// the file, so there must be a limit.
const MAX_UV_SETS: u32 = 8;

/// Most sets of joints that are read, four joints each.
const MAX_JOINT_SETS: u32 = 8;

/// The accessors of a primitive's vertices.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Attributes {
    pub(super) position: usize,
    pub(super) normal: Option<usize>,
    /// Only where there are normals, as the format has it, and something that shows tangents.
    pub(super) tangent: Option<usize>,
    pub(super) color: Option<usize>,
    /// Set and accessor, ascending.
    pub(super) uvs: Vec<(u32, usize)>,
    /// The morph targets that are gone to.
    pub(super) morphs: Vec<Morph>,
    /// Set, joints and their weights, four of each a set.
    pub(super) joints: Vec<(u32, usize, usize)>,
}

/// A morph target: the accessors of its displacements.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Morph {
    /// Its place among the primitive's targets.
    pub(super) target: usize,
    pub(super) position: Option<usize>,
    pub(super) normal: Option<usize>,
    pub(super) tangent: Option<usize>,
}

impl Attributes {
    /// `None` without positions. What bends the mesh in `pose` needs attributes of its own. Tangents are for meshes that show them.
    pub(super) fn of(
        json: &Primitive,
        pose: &MeshPose,
        shows_tangents: bool,
        element: &str,
        notes: &mut Notes,
    ) -> Option<Self> {
        let accessor = |semantic| {
            let found = json.attributes.get(&Checked::Valid(semantic));
            found.map(|a| a.value())
        };
        let mut uvs = Vec::new();
        for (semantic, accessor) in &json.attributes {
            match semantic {
                Checked::Valid(Semantic::TexCoords(set)) if *set < MAX_UV_SETS => {
                    uvs.push((*set, accessor.value()));
                }
                Checked::Valid(Semantic::TexCoords(_)) => {
                    let text = format!(
                        "texture coordinates beyond TEXCOORD_{} are ignored",
                        MAX_UV_SETS - 1
                    );
                    notes.add(element, text);
                }
                Checked::Valid(Semantic::Colors(1..)) => {
                    notes.add(element, "colours beyond COLOR_0 are ignored");
                }
                _ => {}
            }
        }
        let normal = accessor(Semantic::Normals);
        Some(Self {
            position: accessor(Semantic::Positions)?,
            normal,
            tangent: accessor(Semantic::Tangents).filter(|_| shows_tangents && normal.is_some()),
            color: accessor(Semantic::Colors(0)),
            uvs,
            morphs: morphs(json, pose),
            joints: match pose.skin {
                Some(_) => joints(json, element, notes),
                None => Vec::new(),
            },
        })
    }
}

fn morphs(json: &Primitive, pose: &MeshPose) -> Vec<Morph> {
    let targets = json.targets.iter().flatten().enumerate();
    let gone_to = |target: &usize| pose.weights.get(*target).is_some_and(|w| w.abs() > 0.0);
    let morph = |(target, json): (usize, &MorphTarget)| {
        gone_to(&target).then(|| Morph {
            target,
            position: json.positions.map(|a| a.value()),
            normal: json.normals.map(|a| a.value()),
            tangent: json.tangents.map(|a| a.value()),
        })
    };
    targets.filter_map(morph).collect()
}

/// The sets of joints that have weights.
fn joints(json: &Primitive, element: &str, notes: &mut Notes) -> Vec<(u32, usize, usize)> {
    let accessor = |semantic| json.attributes.get(&Checked::Valid(semantic));
    let set = |set| {
        let joints = accessor(Semantic::Joints(set))?;
        let weights = accessor(Semantic::Weights(set))?;
        Some((set, joints.value(), weights.value()))
    };
    let sets: Vec<_> = (0..MAX_JOINT_SETS).filter_map(set).collect();
    if sets.is_empty() {
        let text = "has no joints for its skin: shown where its node places it";
        notes.add(element, text);
    }
    sets
}

/// A normal of unit length; zero, which means the triangle's own, where there is none.
pub(super) fn unit_or_zero(normal: [f32; 3]) -> Vec3 {
    // In double precision: the squares of short and long vectors leave single precision.
    let normal = Vec3::from(normal).as_dvec3();
    normal.try_normalize().map_or(Vec3::ZERO, |n| n.as_vec3())
}

/// A tangent of unit length with its handedness, 1 or -1; zero, which means none, where there is none.
pub(super) fn tangent_or_zero([x, y, z, w]: [f32; 4]) -> Vec4 {
    let tangent = unit_or_zero([x, y, z]);
    if tangent == Vec3::ZERO {
        return Vec4::ZERO;
    }
    tangent.extend(if w < 0.0 { -1.0 } else { 1.0 })
}

/// Texture coordinates, the origin where they are not finite.
pub(super) fn finite_or_zero(uv: [f32; 2]) -> Vec2 {
    let uv = Vec2::from(uv);
    if uv.is_finite() { uv } else { Vec2::ZERO }
}

/// A colour, white where it is not finite.
pub(super) fn color_or_white(color: [f32; 4]) -> Vec4 {
    let color = Vec4::from(color);
    if color.is_finite() { color } else { Vec4::ONE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_no_numbers_do_no_harm() {
        let large = unit_or_zero([0.0, 3e30, 4e30]);
        assert!((large - Vec3::new(0.0, 0.6, 0.8)).length() < 1e-6);
        assert_eq!(unit_or_zero([0.0, 0.0, -1e-40]), Vec3::NEG_Z);
        for none in [0.0, f32::NAN, f32::INFINITY] {
            assert_eq!(unit_or_zero([0.0, none, none]), Vec3::ZERO);
        }
        assert_eq!(tangent_or_zero([0.0, 0.0, 0.0, 1.0]), Vec4::ZERO);
        let sheared = tangent_or_zero([0.0, -2.0, 0.0, -0.5]);
        assert_eq!(sheared, Vec4::new(0.0, -1.0, 0.0, -1.0));
        assert_eq!(finite_or_zero([f32::NAN, 1.0]), Vec2::ZERO);
        assert_eq!(color_or_white([f32::INFINITY, 0.0, 0.0, 0.0]), Vec4::ONE);
    }
}
