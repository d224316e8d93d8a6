//! Tangents by Mikkelsen's algorithm, the common convention of those who bake normal maps: the only file naming `bevy_mikktspace`.
//!
//! M. S. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008; <http://www.mikktspace.com>.

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

use crate::scene::TriangleMesh;

/// The tangents of some triangles' corners: x, y and z of unit length, w 1 or -1 such that the bitangent, which points up in
/// the image, is `cross(normal, tangent) * w`. Zero where there is none.
///
/// Each triangle comes with the set of texture coordinates that counts.
pub(super) fn corner_tangents(mesh: &TriangleMesh, triangles: &[(u32, u32)]) -> Vec<[Vec4; 3]> {
    let mut faces = Faces {
        mesh,
        triangles,
        tangents: vec![[Vec4::ZERO; 3]; triangles.len()],
    };
    // Its error has no cases. Corners without a tangent keep their zero.
    let done = generate_tangents::<_, Libm>(&mut faces);
    debug_assert!(done.is_ok());
    faces.tangents
}

struct Faces<'m> {
    mesh: &'m TriangleMesh,
    triangles: &'m [(u32, u32)],
    tangents: Vec<[Vec4; 3]>,
}

/// The same on every machine.
struct Libm;

impl Ops for Libm {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

impl Faces<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[self.triangles[face].0 as usize][corner] as usize
    }
}

impl Geometry<Libm> for Faces<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let own = || self.mesh.triangle(self.triangles[face].0).normal();
        let normals = self.mesh.normals.get(self.vertex(face, corner)).copied();
        let normal = normals.filter(|n| *n != Vec3::ZERO).or_else(own);
        normal.unwrap_or(Vec3::Z).to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let set = self.mesh.uv_sets.get(self.triangles[face].1 as usize);
        let uv = set.and_then(|set| set.get(self.vertex(face, corner)));
        uv.copied().unwrap_or(Vec2::ZERO).to_array()
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        let Some(space) = tangent else { return };
        let [x, y, z, w] = space.tangent_encoded();
        // Our v grows down the image, and the bitangent of a normal map points up.
        self.tangents[face][corner] = Vec4::new(x, y, z, -w);
    }
}
