//! Triangle meshes in object space, with the runs of materials and the outlines of the file's polygons.

use glam::{Vec2, Vec3, Vec4};

use crate::geometry::{Aabb, Triangle};

/// A run of triangles that share a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Index of the run's first triangle.
    pub first_triangle: u32,
    /// How many triangles follow on.
    pub triangle_count: u32,
    /// Index of the scene's material.
    pub material: u32,
}

/// A polygon of the file with more than three corners, and the triangles it became.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outline {
    /// Vertex indices of the corners, in the file's order; at least 4.
    pub corners: Box<[u32]>,
    /// Index of the first triangle it became.
    pub first_triangle: u32,
    /// How many triangles it became.
    pub triangle_count: u32,
}

/// A mesh in object space.
///
/// Its vertex list is the point cluster of its extents; vertices that no triangle uses do no harm there, but
/// importers leave them out where they can.
#[derive(Clone, Debug, Default)]
pub struct TriangleMesh {
    /// Name in the file, or one made from its place there.
    pub name: String,
    /// Vertex positions, in model units, object space. All finite.
    pub positions: Vec<Vec3>,
    /// Shading normals: empty, or one a position, of unit length; a zero vector means the triangle's own normal.
    pub normals: Vec<Vec3>,
    /// The file's tangents, along which the normal map's u grows: empty, or one a position, of unit length in x, y and z. The bitangent is
    /// `cross(normal, tangent) * w`, w being 1 or -1. A zero vector means that there is none.
    pub tangents: Vec<Vec4>,
    /// Texture coordinates, a vector for each set, each empty or one a position. The origin is the image's top left corner
    /// (glTF's convention), v grows downwards.
    pub uv_sets: Vec<Vec<Vec2>>,
    /// Linear vertex colours with alpha: empty (white), or one a position.
    pub colors: Vec<Vec4>,
    /// Vertex indices of each triangle. The geometric normal is that of counter-clockwise corners.
    pub triangles: Vec<[u32; 3]>,
    /// Runs of materials: they cover all triangles, in order, without gaps.
    pub parts: Vec<Part>,
    /// The file's polygons of more than three corners, by first triangle.
    pub outlines: Vec<Outline>,
}

/// A [`TriangleMesh`] that breaks one of its own rules.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// An attribute has another length than the positions.
    #[error("{attribute}: {found} values for {vertices} vertices")]
    AttributeLength {
        /// Which attribute.
        attribute: &'static str,
        /// Its length.
        found: usize,
        /// Number of positions.
        vertices: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex} of {vertices}")]
    VertexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Number of positions.
        vertices: usize,
    },
    /// The parts do not cover the triangles in order.
    #[error("material runs do not cover the {0} triangles in order")]
    Parts(usize),
}

impl TriangleMesh {
    /// Checks the rules that the fields state.
    pub fn validate(&self) -> Result<(), MeshError> {
        let vertices = self.positions.len();
        let attribute = |attribute, found: usize| match found {
            0 => Ok(()),
            n if n == vertices => Ok(()),
            found => Err(MeshError::AttributeLength {
                attribute,
                found,
                vertices,
            }),
        };
        attribute("normals", self.normals.len())?;
        attribute("tangents", self.tangents.len())?;
        attribute("colours", self.colors.len())?;
        for set in &self.uv_sets {
            attribute("texture coordinates", set.len())?;
        }
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
                return Err(MeshError::VertexOutOfRange {
                    triangle,
                    vertex,
                    vertices,
                });
            }
        }
        let mut next = 0;
        for part in &self.parts {
            if part.first_triangle != next {
                return Err(MeshError::Parts(self.triangles.len()));
            }
            next += part.triangle_count;
        }
        if next as usize != self.triangles.len() {
            return Err(MeshError::Parts(self.triangles.len()));
        }
        Ok(())
    }

    /// The corners of a triangle, in object space.
    pub fn triangle(&self, triangle: u32) -> Triangle {
        let [a, b, c] = self.triangles[triangle as usize];
        Triangle::new(
            self.positions[a as usize],
            self.positions[b as usize],
            self.positions[c as usize],
        )
    }

    /// Points whose hull holds the mesh: the vertices that a triangle uses, or the corners of their box if these are more
    /// than `most`.
    pub fn cluster(&self, most: usize) -> Vec<Vec3> {
        let mut is_used = vec![false; self.positions.len()];
        self.triangles
            .iter()
            .flatten()
            .for_each(|&v| is_used[v as usize] = true);
        let used = self
            .positions
            .iter()
            .zip(&is_used)
            .filter(|(_, used)| **used)
            .map(|(p, _)| *p);
        if used.clone().count() <= most.max(8) {
            return used.collect();
        }
        let bounds: Aabb = used.collect();
        bounds.corners().to_vec()
    }

    /// Whether all is the same but the name, bit for bit.
    pub fn has_content_of(&self, other: &Self) -> bool {
        self.parts == other.parts && self.has_shape_of(other)
    }

    /// Whether all is the same but the name and the materials of the parts, bit for bit.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        fn same<const N: usize, T: AsRef<[f32; N]>>(a: &[T], b: &[T]) -> bool {
            let bits = |v: &T| v.as_ref().map(f32::to_bits);
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| bits(a) == bits(b))
        }
        let (a, b) = (&self.uv_sets, &other.uv_sets);
        // Positions first: those of different meshes differ soon, triangles that were made the same way nowhere.
        let runs = |parts: &[Part]| parts.iter().map(|p| p.triangle_count).collect::<Vec<_>>();
        same(&self.positions, &other.positions)
            && self.triangles == other.triangles
            && runs(&self.parts) == runs(&other.parts)
            && self.outlines == other.outlines
            && same(&self.normals, &other.normals)
            && same(&self.tangents, &other.tangents)
            && same(&self.colors, &other.colors)
            && a.len() == b.len()
            && a.iter().zip(b).all(|(a, b)| same(a, b))
    }

    /// The bits of all numbers of a vertex: of its position and its attributes. Vertices of the same mesh that have the same are one.
    pub(crate) fn vertex_bits(&self, vertex: usize) -> impl Iterator<Item = u32> + '_ {
        let normal = self.normals.get(vertex).map(Vec3::to_array);
        let tangent = self.tangents.get(vertex).map(Vec4::to_array);
        let color = self.colors.get(vertex).map(Vec4::to_array);
        let sets = self.uv_sets.iter().filter_map(move |set| set.get(vertex));
        let position = self.positions[vertex].to_array().into_iter();
        let numbers = position
            .chain(normal.into_iter().flatten())
            .chain(tangent.into_iter().flatten())
            .chain(color.into_iter().flatten())
            .chain(sets.flat_map(Vec2::to_array));
        numbers.map(f32::to_bits)
    }

    /// A mesh of the same name with these vertices, in this order, and no triangles.
    pub(crate) fn with_vertices(&self, vertices: &[u32]) -> Self {
        fn of<T: Copy>(values: &[T], vertices: &[u32]) -> Vec<T> {
            match values {
                [] => Vec::new(),
                values => vertices.iter().map(|&v| values[v as usize]).collect(),
            }
        }
        Self {
            name: self.name.clone(),
            positions: of(&self.positions, vertices),
            normals: of(&self.normals, vertices),
            tangents: of(&self.tangents, vertices),
            uv_sets: self.uv_sets.iter().map(|set| of(set, vertices)).collect(),
            colors: of(&self.colors, vertices),
            ..Self::default()
        }
    }

    /// The number of the part that has a triangle.
    pub fn part_of(&self, triangle: u32) -> usize {
        self.parts.partition_point(|p| p.first_triangle <= triangle) - 1
    }

    /// The scene's material of a triangle, where an instance has none of its own.
    pub fn material_of(&self, triangle: u32) -> u32 {
        self.parts[self.part_of(triangle)].material
    }

    /// Leaves out the triangles for which `keep` is false, and mends parts and outlines. Outlines that lose a triangle go.
    pub fn retain_triangles(&mut self, mut keep: impl FnMut(u32) -> bool) {
        let kept: Vec<bool> = (0..self.triangles.len() as u32).map(&mut keep).collect();
        // new_index[i]: how many kept triangles stand before i, which is i's place if it is kept.
        let mut new_index = Vec::with_capacity(kept.len() + 1);
        let mut count = 0_u32;
        for &k in &kept {
            new_index.push(count);
            count += u32::from(k);
        }
        new_index.push(count);
        if count as usize == kept.len() {
            return;
        }
        let mut index = 0;
        self.triangles.retain(|_| {
            index += 1;
            kept[index - 1]
        });
        for part in &mut self.parts {
            let end = new_index[(part.first_triangle + part.triangle_count) as usize];
            part.first_triangle = new_index[part.first_triangle as usize];
            part.triangle_count = end - part.first_triangle;
        }
        self.parts.retain(|p| p.triangle_count > 0);
        self.outlines.retain_mut(|o| {
            let (first, end) = (
                o.first_triangle as usize,
                (o.first_triangle + o.triangle_count) as usize,
            );
            o.first_triangle = new_index[first];
            kept[first..end].iter().all(|&k| k)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip() -> TriangleMesh {
        let part = |first_triangle, triangle_count, material| Part {
            first_triangle,
            triangle_count,
            material,
        };
        TriangleMesh {
            positions: (0..6)
                .map(|i| Vec3::new((i / 2) as f32, (i % 2) as f32, 0.0))
                .collect(),
            triangles: vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]],
            parts: vec![part(0, 1, 7), part(1, 2, 8), part(3, 1, 9)],
            outlines: vec![
                Outline {
                    corners: Box::new([0, 2, 3, 1]),
                    first_triangle: 0,
                    triangle_count: 2,
                },
                Outline {
                    corners: Box::new([2, 4, 5, 3]),
                    first_triangle: 2,
                    triangle_count: 2,
                },
            ],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn materials_follow_their_runs() {
        let mesh = strip();
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!([0, 1, 2, 3].map(|t| mesh.material_of(t)), [7, 8, 8, 9]);
    }

    #[test]
    fn dropping_a_triangle_mends_runs_and_outlines() {
        let mut mesh = strip();
        mesh.retain_triangles(|t| t != 0);
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(mesh.triangles, [[1, 2, 3], [2, 4, 3], [3, 4, 5]]);
        assert_eq!([0, 1, 2].map(|t| mesh.material_of(t)), [8, 8, 9]);
        assert_eq!(mesh.outlines.len(), 1);
        assert_eq!(mesh.outlines[0].first_triangle, 1);
    }

    #[test]
    fn a_cluster_is_the_used_vertices_or_their_box() {
        let mut mesh = strip();
        mesh.positions.push(Vec3::splat(99.0));
        assert_eq!(mesh.cluster(100), mesh.positions[..6]);
        // Twelve vertices in a row are more than a box has.
        mesh.positions = (0..12).map(|i| Vec3::new(i as f32, 1.0, 2.0)).collect();
        mesh.triangles = (0..10).map(|i| [i, i + 1, i + 2]).collect();
        let corners = mesh.cluster(9);
        assert_eq!(
            (corners.len(), corners[0], corners[7]),
            (8, mesh.positions[0], mesh.positions[11])
        );
    }

    #[test]
    fn broken_rules_are_named() {
        let mut mesh = strip();
        mesh.triangles[2] = [2, 40, 3];
        assert_eq!(
            mesh.validate(),
            Err(MeshError::VertexOutOfRange {
                triangle: 2,
                vertex: 40,
                vertices: 6
            })
        );
        let mut mesh = strip();
        mesh.normals = vec![Vec3::Z; 5];
        assert!(matches!(
            mesh.validate(),
            Err(MeshError::AttributeLength {
                found: 5,
                vertices: 6,
                ..
            })
        ));
        let mut mesh = strip();
        mesh.parts.pop();
        assert_eq!(mesh.validate(), Err(MeshError::Parts(4)));
    }
}
