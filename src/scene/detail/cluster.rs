//! Vertices of a piece that are connected within one cell of a grid become one of them: rough, but fast, and few edges are left to collapse one by one then
//! (vertex clustering, Rossignac and Borrel 1993; only along edges, so that neither gaps close nor the two sides of a sheet meet).

use glam::Vec3;

/// Cells along an axis that have a number.
const MOST_CELLS: f32 = 2_000_000.0;

/// Which vertices have become one, and the triangles that are left.
pub(super) struct Clusters {
    /// For each vertex the one that it has become, which has become itself.
    pub(super) become_of: Vec<u32>,
    /// Triangles of different vertices.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Vertices whose triangles do not close around them, on borders and seams, so that they must stay; a few others may be taken for such.
///
/// Of all neighbours of a vertex, one for each corner of each triangle around it, those of a closed fan come in pairs, and the sum without carries of their hashes is zero.
fn fixed(vertices: usize, triangles: &[[u32; 3]]) -> Vec<bool> {
    let hash = |v: u32| (u64::from(v) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut sums = vec![0_u64; vertices];
    for &[a, b, c] in triangles {
        let [ha, hb, hc] = [a, b, c].map(hash);
        sums[a as usize] ^= hb ^ hc;
        sums[b as usize] ^= hc ^ ha;
        sums[c as usize] ^= ha ^ hb;
    }
    sums.into_iter().map(|sum| sum != 0).collect()
}

/// The end of a chain of vertices that became others, which is made shorter on the way.
fn root(parents: &mut [u32], mut vertex: u32) -> u32 {
    while parents[vertex as usize] != vertex {
        let parent = parents[vertex as usize];
        parents[vertex as usize] = parents[parent as usize];
        vertex = parents[vertex as usize];
    }
    vertex
}

/// Joins vertices within cells of an edge `cell`, in units of the positions; `None` where nothing can be joined: cells are too small or none are wanted.
pub(super) fn join(positions: &[Vec3], triangles: &[[u32; 3]], cell: f32) -> Option<Clusters> {
    let bounds: crate::geometry::Aabb = positions.iter().copied().collect();
    let usable = cell > 0.0 && bounds.extent().max_element() / cell < MOST_CELLS;
    if !usable {
        return None;
    }
    let fixed = fixed(positions.len(), triangles);
    let place = |p: Vec3| (p - bounds.min) / cell;
    let cells: Vec<u64> = positions
        .iter()
        .map(|&p| {
            let [x, y, z] = place(p).to_array().map(|c| c as u64);
            x << 42 | y << 21 | z
        })
        .collect();
    let mut parents: Vec<u32> = (0..positions.len() as u32).collect();
    for t in triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            let (i, j) = (a as usize, b as usize);
            if cells[i] == cells[j] && !fixed[i] && !fixed[j] {
                let (a, b) = (root(&mut parents, a), root(&mut parents, b));
                parents[a.max(b) as usize] = a.min(b);
            }
        }
    }
    // Of each group, the vertex nearest to the middle of the cell stands for all: they are evenly spaced then.
    let off_middle = |v: u32| (place(positions[v as usize]).fract() - 0.5).length_squared();
    let mut best: Vec<u32> = (0..positions.len() as u32).collect();
    for vertex in 0..positions.len() as u32 {
        let group = root(&mut parents, vertex) as usize;
        if off_middle(vertex) < off_middle(best[group]) {
            best[group] = vertex;
        }
    }
    let become_of: Vec<u32> = (0..positions.len() as u32)
        .map(|vertex| best[root(&mut parents, vertex) as usize])
        .collect();
    let joined = triangles.iter().map(|t| t.map(|v| become_of[v as usize]));
    let triangles = joined
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    Some(Clusters {
        become_of,
        triangles,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two sheets of 40 by 40 cells of 0.1, one 0.05 above the other.
    fn sheets() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let side = 41_u32;
        let sheet = |height: f32| {
            (0..side * side)
                .map(move |i| Vec3::new((i % side) as f32, (i / side) as f32, height * 10.0) * 0.1)
        };
        let positions: Vec<Vec3> = sheet(0.0).chain(sheet(0.05)).collect();
        let corners = |first: u32| {
            let cells = (0..40 * 40_u32).map(move |i| first + i % 40 + i / 40 * side);
            cells.flat_map(move |v| [[v, v + 1, v + side], [v + 1, v + 1 + side, v + side]])
        };
        let triangles = corners(0).chain(corners(side * side)).collect();
        (positions, triangles)
    }

    #[test]
    fn connected_vertices_join_and_sheets_and_borders_stay() {
        let (positions, triangles) = sheets();
        let clusters = join(&positions, &triangles, 0.5).expect("large cells");
        assert!(
            clusters.triangles.len() < triangles.len() / 4,
            "{}",
            clusters.triangles.len()
        );
        for (vertex, &other) in clusters.become_of.iter().enumerate() {
            let (from, to) = (positions[vertex], positions[other as usize]);
            assert_eq!(clusters.become_of[other as usize], other);
            assert!(from.z == to.z && (from - to).abs().max_element() < 0.5);
            let is_inner = |x: f32| 0.05 < x && x < 3.95;
            assert!((is_inner(from.x) && is_inner(from.y)) || from == to);
        }
        // With its border where it was, a flat sheet keeps its area, however its triangles are turned.
        let area = |triangles: &[[u32; 3]]| {
            let doubled = triangles.iter().map(|t| {
                let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
                (b - a).cross(c - a).z
            });
            doubled.sum::<f64>() / 2.0
        };
        let (after, before) = (area(&clusters.triangles), area(&triangles));
        assert!((after - before).abs() < 1e-4, "{after} {before}");
    }

    #[test]
    fn cells_too_small_to_number_join_nothing() {
        let (positions, triangles) = sheets();
        assert!(join(&positions, &triangles, 0.0).is_none());
        assert!(join(&positions, &triangles, 1e-7).is_none());
        let fine = join(&positions, &triangles, 0.01).expect("they can be numbered");
        assert_eq!(fine.triangles, triangles);
    }
}
