//! Meshes in pieces: triangles of one material that are near one another. Pieces are simplified apart, each within its border.

use rayon::prelude::*;

use crate::geometry::Aabb;
use crate::scene::TriangleMesh;

/// Most triangles of a piece. Fewer: more of them on borders, which stay; more: less for each thread, and a piece that is near at one end is fine all over.
const MOST_TRIANGLES: usize = 1 << 17;

/// Cells along the longest side of a grid by which triangles are sorted into pieces.
const SIDE: usize = 64;

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
        let run = part.first_triangle..part.first_triangle + part.triangle_count;
        if run.len() <= MOST_TRIANGLES {
            pieces.push((index, Which::Run(run.start, run.end)));
        } else {
            let lists = split(mesh, run.collect()).into_iter();
            pieces.extend(lists.map(|list| (index, Which::List(list))));
        }
    }
    let pieces = pieces.into_par_iter().with_max_len(1);
    pieces
        .map(|(part, which)| (part, Piece::new(mesh, which)))
        .collect()
}

/// Lists of triangles that are near one another: cells of a grid are halved, and halved again, along the longest side of what there is; where one cell has too many, it gets a grid of its own. A triangle is where its first corner is.
fn split(mesh: &TriangleMesh, triangles: Vec<u32>) -> Vec<Vec<u32>> {
    if triangles.len() <= MOST_TRIANGLES {
        return vec![triangles];
    }
    let place = |triangle: u32| mesh.positions[mesh.triangles[triangle as usize][0] as usize];
    let bounds: Aabb = triangles.iter().map(|&t| place(t)).collect();
    let edge = bounds.extent().max_element() / SIDE as f32;
    if edge <= 0.0 {
        // All at one place, or as good as.
        return triangles
            .chunks(MOST_TRIANGLES)
            .map(<[u32]>::to_vec)
            .collect();
    }
    let sides = (bounds.extent() / edge)
        .to_array()
        .map(|s| (s as usize).min(SIDE - 1) + 1);
    let cell = |&triangle: &u32| {
        let from = (place(triangle) - bounds.min) / edge;
        let [x, y, z] = [0, 1, 2].map(|axis| (from[axis] as usize).min(sides[axis] - 1));
        (x + sides[0] * (y + sides[1] * z)) as u32
    };
    let cells: Vec<u32> = triangles.par_iter().map(cell).collect();
    let mut counts = vec![0_usize; sides.iter().product()];
    for &cell in &cells {
        counts[cell as usize] += 1;
    }
    let used = (0..counts.len()).filter(|&cell| counts[cell] > 0);
    let mut used: Vec<usize> = used.collect();
    let mut piece_of = vec![0; counts.len()];
    let mut sizes = Vec::new();
    halve(&mut used, sides, &counts, &mut |cells, size| {
        cells.iter().for_each(|&cell| piece_of[cell] = sizes.len());
        sizes.push(size);
    });
    let mut pieces: Vec<Vec<u32>> = sizes.into_iter().map(Vec::with_capacity).collect();
    for (triangle, cell) in triangles.iter().zip(cells) {
        pieces[piece_of[cell as usize]].push(*triangle);
    }
    drop(triangles);
    let pieces = pieces.into_iter();
    pieces.flat_map(|piece| split(mesh, piece)).collect()
}

/// Halves cells by their triangles until they have few enough, or there is one; each with the number of its triangles is given to `take`.
fn halve(
    cells: &mut [usize],
    sides: [usize; 3],
    counts: &[usize],
    take: &mut impl FnMut(&[usize], usize),
) {
    let size = cells.iter().map(|&cell| counts[cell]).sum();
    if size <= MOST_TRIANGLES || cells.len() == 1 {
        return take(cells, size);
    }
    let at = |cell: usize| {
        [
            cell % sides[0],
            cell / sides[0] % sides[1],
            cell / sides[0] / sides[1],
        ]
    };
    let reach = |axis: usize| {
        let along = || cells.iter().map(|&cell| at(cell)[axis]);
        along().max().unwrap_or(0) - along().min().unwrap_or(0)
    };
    let axis = (0..3).max_by_key(|&axis| reach(axis)).unwrap_or(0);
    cells.sort_unstable_by_key(|&cell| (at(cell)[axis], cell));
    let mut before = 0;
    let mut is_front = |&cell: &usize| {
        before += counts[cell];
        2 * before <= size
    };
    let front = cells.iter().take_while(|cell| is_front(cell)).count();
    let (front, behind) = cells.split_at_mut(front.clamp(1, cells.len() - 1));
    halve(front, sides, counts, take);
    halve(behind, sides, counts, take);
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
