//! The attributes of a primitive's vertices: which accessors hold them, and what their values may be.

use ::gltf::json::mesh::{Primitive, Semantic};
use ::gltf::json::validation::Checked;
use glam::{Vec2, Vec3, Vec4};

use super::notes::Notes;

/// Most sets of texture coordinates that are read: more than any file was seen to have. A set's number costs nothing in
/// the file, so there must be a limit.
const MAX_UV_SETS: u32 = 8;

/// The accessors of a primitive's vertices.
#[derive(PartialEq, Eq)]
pub(super) struct Attributes {
    pub(super) position: usize,
    pub(super) normal: Option<usize>,
    pub(super) color: Option<usize>,
    /// Set and accessor, ascending.
    pub(super) uvs: Vec<(u32, usize)>,
}

impl Attributes {
    /// `None` without positions.
    pub(super) fn of(json: &Primitive, element: &str, notes: &mut Notes) -> Option<Self> {
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
        Some(Self {
            position: accessor(Semantic::Positions)?,
            normal: accessor(Semantic::Normals),
            color: accessor(Semantic::Colors(0)),
            uvs,
        })
    }
}

/// A normal of unit length; zero, which means the triangle's own, where there is none.
pub(super) fn unit_or_zero(normal: [f32; 3]) -> Vec3 {
    // In double precision: the squares of short and long vectors leave single precision.
    let normal = Vec3::from(normal).as_dvec3();
    normal.try_normalize().map_or(Vec3::ZERO, |n| n.as_vec3())
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
        assert_eq!(finite_or_zero([f32::NAN, 1.0]), Vec2::ZERO);
        assert_eq!(color_or_white([f32::INFINITY, 0.0, 0.0, 0.0]), Vec4::ONE);
    }
}
