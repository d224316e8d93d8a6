//! From an object's vertices and polygons to a [`TriangleMesh`]. OBJ has no transforms: object space is world space.
//!
//! - Texture coordinates: OBJ's v grows upwards, ours downwards, so v becomes 1 - v.
//! - Vertex colours are sRGB, as MeshLab, ZBrush, Blender and scanners write them, and become linear.
//! - Normals are made unit length; those without a direction become zero, which means the triangle's own.

use glam::{Vec2, Vec3, Vec4};

use super::objects::Object;
use super::reader::Geometry;
use super::triangulate::{Outcome, Triangulator};
use crate::scene::{Outline, Part, TriangleMesh};

/// What was odd about the polygons of an object without being a defect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Oddities {
    /// Polygons that became fans though those may not cover them.
    pub(super) fanned: u64,
    /// Corners that stand where the one before them does.
    pub(super) repeated_corners: u64,
}

impl Oddities {
    /// What is to be said of them.
    pub(super) fn notes(self) -> impl Iterator<Item = String> {
        let fanned = (self.fanned > 0).then(|| {
            let text = "polygons that cross themselves or have no plane are cut as fans from their first corner";
            format!("{text}: {}", self.fanned)
        });
        let repeated = (self.repeated_corners > 0).then(|| {
            let text = "corners at the place of the one before are left out, each with a triangle of no area";
            format!("{text}: {}", self.repeated_corners)
        });
        fanned.into_iter().chain(repeated)
    }
}

/// Builds the mesh of an object. `material_of` gives the scene's material for the index of a `usemtl` name.
/// Also gives the smoothing group of each triangle, unless all are in none, and tells what was odd about its polygons.
pub(super) fn build(
    object: &Object,
    geometry: Geometry,
    color_scale: f32,
    triangulator: &mut Triangulator,
    mut material_of: impl FnMut(Option<u32>) -> u32,
) -> (TriangleMesh, Vec<u32>, Oddities) {
    let mut mesh = TriangleMesh {
        name: object.name.clone(),
        positions: geometry
            .positions
            .chunks_exact(3)
            .map(Vec3::from_slice)
            .collect(),
        normals: normals(&geometry.normals),
        colors: geometry
            .colors
            .chunks_exact(3)
            .map(|c| linear(Vec3::from_slice(c) * color_scale))
            .collect(),
        ..TriangleMesh::default()
    };
    if !geometry.texcoords.is_empty() {
        mesh.uv_sets
            .push(geometry.texcoords.chunks_exact(2).map(uv).collect());
    }
    let mut oddities = Oddities::default();
    let mut next_corner = 0;
    let mut runs = object.materials.iter().peekable();
    let mut smoothing = object.smoothing.iter().peekable();
    let mut group_starts = Vec::new();
    for face in 0..object.face_count {
        if let Some(run) = runs.next_if(|r| r.first_face == face) {
            begin_part(&mut mesh, material_of(run.value));
        }
        if let Some(run) = smoothing.next_if(|r| r.first_face == face) {
            group_starts.push((mesh.triangles.len(), run.value));
        }
        let arity = geometry
            .arities
            .get(face as usize)
            .map_or(3, |&a| a as usize);
        let corners = &geometry.indices[next_corner..next_corner + arity];
        next_corner += arity;
        if let [a, b, c] = *corners {
            mesh.triangles.push([a, b, c]);
            continue;
        }
        let first_triangle = mesh.triangles.len() as u32;
        let outcome = triangulator.polygon(corners, &mesh.positions, &mut mesh.triangles);
        oddities.fanned += u64::from(outcome == Outcome::Fanned);
        oddities.repeated_corners += (arity - triangulator.corners().len()) as u64;
        if triangulator.corners().len() > 3 {
            mesh.outlines.push(Outline {
                corners: triangulator.corners().into(),
                first_triangle,
                triangle_count: mesh.triangles.len() as u32 - first_triangle,
            });
        }
    }
    end_part(&mut mesh);
    let groups = groups(&group_starts, mesh.triangles.len());
    (mesh, groups, oddities)
}

/// The group of each triangle, from the first triangle of each run on; empty if all are in none.
fn groups(starts: &[(usize, u32)], triangles: usize) -> Vec<u32> {
    if starts.iter().all(|&(_, group)| group == 0) {
        return Vec::new();
    }
    let mut groups = vec![0; starts[0].0];
    for (number, &(_, group)) in starts.iter().enumerate() {
        let end = starts.get(number + 1).map_or(triangles, |next| next.0);
        groups.resize(end, group);
    }
    groups
}

fn begin_part(mesh: &mut TriangleMesh, material: u32) {
    end_part(mesh);
    if mesh.parts.last().is_none_or(|p| p.material != material) {
        mesh.parts.push(Part {
            first_triangle: mesh.triangles.len() as u32,
            triangle_count: 0,
            material,
        });
    }
}

fn end_part(mesh: &mut TriangleMesh) {
    if let Some(part) = mesh.parts.last_mut() {
        part.triangle_count = mesh.triangles.len() as u32 - part.first_triangle;
    }
}

fn normals(values: &[f32]) -> Vec<Vec3> {
    let normals: Vec<Vec3> = values
        .chunks_exact(3)
        .map(|n| {
            // In double precision, where the square of no single overflows or vanishes.
            let n = Vec3::from_slice(n).as_dvec3();
            let length = n.length();
            if length > 0.0 && length.is_finite() {
                (n / length).as_vec3()
            } else {
                Vec3::ZERO
            }
        })
        .collect();
    if normals.iter().all(|n| *n == Vec3::ZERO) {
        return Vec::new();
    }
    normals
}

fn uv(values: &[f32]) -> Vec2 {
    let uv = Vec2::new(values[0], 1.0 - values[1]);
    if uv.is_finite() { uv } else { Vec2::ZERO }
}

/// Linear colour of an sRGB one (IEC 61966-2-1), opaque.
fn linear(srgb: Vec3) -> Vec4 {
    let channel = |c: f32| {
        let c = c.clamp(0.0, 1.0);
        if c <= 0.040_45 {
            c / 12.92
        } else {
            libm::powf((c + 0.055) / 1.055, 2.4)
        }
    };
    Vec4::new(channel(srgb.x), channel(srgb.y), channel(srgb.z), 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::obj::objects::Run;

    #[test]
    fn runs_become_parts_of_triangles() {
        let run = |first_face, value| Run { first_face, value };
        let mut object = Object::default();
        object.materials = vec![run(0, Some(0)), run(1, Some(1)), run(2, Some(2))];
        object.face_count = 3;
        let geometry = Geometry {
            positions: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 2.0, 0.0],
            indices: vec![0, 1, 2, 3, 0, 1, 2, 0, 2, 3],
            arities: vec![4, 3, 3],
            ..Geometry::default()
        };
        // Two names of one material are one run.
        object.smoothing = vec![
            Run {
                first_face: 1,
                value: 4,
            },
            Run {
                first_face: 2,
                value: 0,
            },
        ];
        let (mesh, groups, oddities) =
            build(&object, geometry, 1.0, &mut Triangulator::default(), |m| {
                u32::from(m == Some(2)) + 5
            });
        assert_eq!((mesh.validate(), oddities), (Ok(()), Oddities::default()));
        assert_eq!(
            (0..4).map(|t| mesh.material_of(t)).collect::<Vec<_>>(),
            [5, 5, 5, 6]
        );
        assert_eq!(mesh.parts.len(), 2);
        assert_eq!(groups, [0, 0, 4, 0]);
        assert_eq!(&*mesh.outlines[0].corners, [0, 1, 2, 3]);
        assert_eq!(mesh.outlines.len(), 1);
    }

    #[test]
    fn normals_without_direction_are_zero() {
        let found = normals(&[
            0.0,
            3e38,
            3e38,
            f32::NAN,
            0.0,
            1.0,
            0.0,
            0.0,
            0.0,
            1e-45,
            0.0,
            0.0,
        ]);
        assert!((found[0] - Vec3::new(0.0, 0.5_f32.sqrt(), 0.5_f32.sqrt())).length() < 1e-6);
        assert_eq!(found[1..], [Vec3::ZERO, Vec3::ZERO, Vec3::X]);
        assert!(normals(&[0.0; 6]).is_empty());
    }

    #[test]
    fn colours_become_linear() {
        let half = linear(Vec3::new(0.0, 0.5, 1.0));
        assert_eq!((half.x, half.z, half.w), (0.0, 1.0, 1.0));
        assert!((half.y - 0.214_041).abs() < 1e-5);
    }
}
