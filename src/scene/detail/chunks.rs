//! Meshes in pieces: triangles of one material that are near one another. Pieces are simplified apart, each within its border.

use crate::geometry::Aabb;
use crate::scene::TriangleMesh;

/// Most triangles of a piece. Fewer: more of them on borders, which stay; more: less for each thread, and a piece that is near at one end is fine all over.
const MOST_TRIANGLES: usize = 1 << 17;

/// Triangles of a mesh.
pub(super) struct Piece {
    which: Which,
    /// Their box, in object space.
    pub(super) bounds: Aabb,
}

enum Which {
    /// From the first to before the second.
    Run(u32, u32),
    /// These.
    List(Vec<u32>),
}

impl Piece {
    /// All triangles of a mesh.
    pub(super) fn all(mesh: &TriangleMesh) -> Self {
        Self::new(mesh, Which::Run(0, mesh.triangles.len() as u32))
    }

    fn new(mesh: &TriangleMesh, which: Which) -> Self {
        let mut piece = Self {
            which,
            bounds: Aabb::EMPTY,
        };
        let corners = piece.triangles().flat_map(|t| mesh.triangles[t as usize]);
        piece.bounds = corners.map(|v| mesh.positions[v as usize]).collect();
        piece
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        match &self.which {
            Which::Run(first, end) => (end - first) as usize,
            Which::List(list) => list.len(),
        }
    }

    /// Their numbers, in ascending order.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> + '_ {
        let (run, list) = match &self.which {
            Which::Run(first, end) => (*first..*end, &[][..]),
            Which::List(list) => (0..0, list.as_slice()),
        };
        run.chain(list.iter().copied())
    }
}

/// The pieces of each part of a mesh, part by part.
pub(super) fn of(mesh: &TriangleMesh) -> Vec<(usize, Piece)> {
    let mut pieces = Vec::new();
    for (index, part) in mesh.parts.iter().enumerate() {
        let end = part.first_triangle + part.triangle_count;
        if part.triangle_count as usize <= MOST_TRIANGLES {
            let which = Which::Run(part.first_triangle, end);
            pieces.push((index, Piece::new(mesh, which)));
            continue;
        }
        let halves = split(mesh, (part.first_triangle..end).collect());
        let halves = halves.into_iter().map(Which::List);
        pieces.extend(halves.map(|which| (index, Piece::new(mesh, which))));
    }
    pieces
}

/// Halves of halves, along the longest side of what there is. A triangle is where its first corner is.
fn split(mesh: &TriangleMesh, mut triangles: Vec<u32>) -> Vec<Vec<u32>> {
    if triangles.len() <= MOST_TRIANGLES {
        triangles.sort_unstable();
        return vec![triangles];
    }
    let place = |triangle: u32| mesh.positions[mesh.triangles[triangle as usize][0] as usize];
    let bounds: Aabb = triangles.iter().map(|&t| place(t)).collect();
    let extent = bounds.extent();
    let longer = |best, axis| {
        if extent[axis] > extent[best] {
            axis
        } else {
            best
        }
    };
    let axis = [1, 2].into_iter().fold(0, longer);
    // Places beside the names, so that comparing them reads nothing else.
    let mut keys: Vec<(f32, u32)> = triangles.iter().map(|&t| (place(t)[axis], t)).collect();
    drop(triangles);
    let middle = keys.len() / 2;
    keys.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let [front, behind] = [&keys[..middle], &keys[middle..]];
    let [front, behind] = [front, behind].map(|half| half.iter().map(|key| key.1).collect());
    drop(keys);
    let (mut front, behind) = rayon::join(|| split(mesh, front), || split(mesh, behind));
    front.extend(behind);
    front
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Part;
    use glam::Vec3;

    #[test]
    fn pieces_have_every_triangle_once_and_are_compact() {
        // A strip of 300,000 triangles in a scrambled order, behind a part of ten.
        let count = 300_000_u32;
        let place = |i: u32| i.wrapping_mul(7919) % count;
        let mesh = TriangleMesh {
            positions: (0..count + 2)
                .map(|i| Vec3::new(2.0, i as f32, (i % 2) as f32))
                .collect(),
            triangles: (0..count)
                .map(|i| [place(i), place(i) + 1, place(i) + 2])
                .collect(),
            parts: [(0, 10), (10, count - 10)]
                .map(|(first_triangle, triangle_count)| Part {
                    first_triangle,
                    triangle_count,
                    material: 0,
                })
                .to_vec(),
            ..TriangleMesh::default()
        };
        let pieces = of(&mesh);
        assert_eq!((pieces[0].0, pieces[0].1.len()), (0, 10));
        assert!(
            pieces[1..]
                .iter()
                .all(|(part, piece)| *part == 1 && piece.len() <= MOST_TRIANGLES)
        );
        let mut all: Vec<u32> = pieces
            .iter()
            .flat_map(|(_, piece)| piece.triangles())
            .collect();
        all.sort_unstable();
        assert!(all.iter().copied().eq(0..count));
        for (_, piece) in &pieces[1..] {
            let places = || piece.triangles().map(place);
            let reach = places().max().unwrap_or(0) - places().min().unwrap_or(0);
            assert!((reach as usize) < piece.len() + 64, "{reach}");
        }
    }
}
