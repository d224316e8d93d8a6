//! Vertices of a piece that are connected within one cell of a grid become one of them: rough, but fast
//! (vertex clustering, Rossignac and Borrel 1993; only along edges, so that neither gaps close nor the two sides of a sheet meet). Where the surface is not near enough then, its cells are divided.

use glam::Vec3;

/// Cells along an axis that have a number.
const MOST_CELLS: f32 = 2_000_000.0;

/// Cosine of the angle between a triangle and the surface that it stands for: 75 degrees. Beyond, it stands on edge or faces away, and is a fold.
const FOLD: f64 = 0.25;

/// A piece's surface.
#[derive(Clone, Copy)]
pub(super) struct Patch<'a> {
    pub(super) positions: &'a [Vec3],
    pub(super) triangles: &'a [[u32; 3]],
}

/// Which vertices have become one.
pub(super) struct Clusters {
    /// For each vertex the one that it has become, which has become itself.
    become_of: Vec<u32>,
    /// Vertices that must stay.
    fixed: Vec<bool>,
    /// The triangles that are left: those of different vertices.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Those of them that were made last, are folds, and of more than half of the area `least`.
    pub(super) folds: Vec<[u32; 3]>,
    least: f64,
    /// The sum of the normals around each vertex, as long as twice the areas.
    around: Vec<Vec3>,
    /// The same, around all that have become one.
    normals: Vec<Vec3>,
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

/// The normal of a triangle, as long as twice its area.
fn normal(positions: &[Vec3], corners: [u32; 3]) -> Vec3 {
    let [a, b, c] = corners.map(|v| positions[v as usize]);
    (b - a).cross(c - a)
}

/// The cell of a vertex that is in none.
const NO_CELL: u64 = u64::MAX;

/// No vertex.
const NO_VERTEX: u32 = u32::MAX;

/// The cell of each vertex that is `wanted`.
fn cells(positions: &[Vec3], cell: f32, wanted: impl Fn(usize) -> bool) -> Vec<u64> {
    let bounds: crate::geometry::Aabb = positions.iter().copied().collect();
    let usable = cell > 0.0 && bounds.extent().max_element() / cell < MOST_CELLS;
    if !usable {
        return vec![NO_CELL; positions.len()];
    }
    let scale = 1.0 / cell;
    let number = |vertex: usize| {
        if !wanted(vertex) {
            return NO_CELL;
        }
        let place = (positions[vertex] - bounds.min) * scale;
        let [x, y, z] = place.to_array().map(|c| u64::from(c as i32 as u32));
        x << 42 | y << 21 | z
    };
    (0..positions.len()).map(number).collect()
}

impl Clusters {
    /// Vertices joined within cells of an edge `cell`, in units of the positions. Where cells are too small to be numbered, vertices stay by themselves. No one sees folds of less than half of the area `least`.
    pub(super) fn new(patch: Patch, cell: f32, least: f64) -> Self {
        let mut clusters = Self {
            become_of: (0..patch.positions.len() as u32).collect(),
            fixed: fixed(patch.positions.len(), patch.triangles),
            triangles: Vec::new(),
            folds: Vec::new(),
            least,
            around: vec![Vec3::ZERO; patch.positions.len()],
            normals: vec![Vec3::ZERO; patch.positions.len()],
        };
        for t in patch.triangles {
            let normal = normal(patch.positions, *t);
            t.iter()
                .for_each(|&v| clusters.around[v as usize] += normal);
        }
        clusters.divide(patch, cell, |_| true);
        clusters
    }

    /// What a vertex has become.
    pub(super) fn of(&self, vertex: u32) -> u32 {
        self.become_of[vertex as usize]
    }

    /// What all triangles have become, also lines and points.
    pub(super) fn all(&self, patch: Patch) -> Vec<[u32; 3]> {
        let triangles = patch.triangles.iter();
        triangles.map(|t| t.map(|v| self.of(v))).collect()
    }

    /// Takes clusters apart and joins their vertices anew within cells of an edge `cell`; no others join them. `wanted`: whether the cluster of a vertex is one of them. Whether anything has changed.
    pub(super) fn divide(&mut self, patch: Patch, cell: f32, wanted: impl Fn(u32) -> bool) -> bool {
        let positions = patch.positions;
        let taken: Vec<bool> = self.become_of.iter().map(|&v| wanted(v)).collect();
        let members: Vec<u32> = (0..positions.len() as u32)
            .filter(|&v| taken[v as usize])
            .collect();
        let before: Vec<u32> = members.iter().map(|&v| self.of(v)).collect();
        let touched = patch.triangles.iter();
        let touched: Vec<[u32; 3]> = touched
            .filter(|t| t.iter().any(|&v| taken[v as usize]))
            .copied()
            .collect();
        self.triangles.retain(|t| !t.iter().any(|&v| wanted(v)));
        for &v in &members {
            self.become_of[v as usize] = v;
        }
        let cells = cells(positions, cell, |v| taken[v] && !self.fixed[v]);
        self.join(&touched, &cells);
        self.choose(positions, &members);
        self.folds.clear();
        for from in touched {
            let to = from.map(|v| self.of(v));
            let [a, b, c] = to;
            if a == b || b == c || c == a {
                continue;
            }
            self.triangles.push(to);
            if from != to && self.is_fold(positions, to) {
                self.folds.push(to);
            }
        }
        members
            .iter()
            .zip(before)
            .any(|(&v, was)| self.of(v) != was)
    }

    /// Whether a triangle stands on edge, or faces away from the way that those around its corners face, and can be seen.
    fn is_fold(&self, positions: &[Vec3], corners: [u32; 3]) -> bool {
        let faces = corners.map(|v| self.normals[v as usize].as_dvec3());
        let faces = faces[0] + faces[1] + faces[2];
        let normal = normal(positions, corners).as_dvec3();
        let cosine = normal.dot(faces);
        let lengths = normal.length_squared() * faces.length_squared();
        normal.length() > self.least && (cosine < 0.0 || cosine * cosine < FOLD * FOLD * lengths)
    }

    /// Joins vertices of triangles within cells.
    fn join(&mut self, triangles: &[[u32; 3]], cells: &[u64]) {
        for t in triangles {
            let [a, b, c] = t.map(|v| cells[v as usize]);
            for (i, j, is_one) in [(0, 1, a == b), (1, 2, b == c), (2, 0, c == a)] {
                if is_one && cells[t[i] as usize] != NO_CELL {
                    let (i, j) = (
                        root(&mut self.become_of, t[i]),
                        root(&mut self.become_of, t[j]),
                    );
                    self.become_of[i.max(j) as usize] = i.min(j);
                }
            }
        }
    }

    /// Of each group of joined vertices, the one nearest to the mean of all stands for them.
    fn choose(&mut self, positions: &[Vec3], members: &[u32]) {
        let mut means = vec![(Vec3::ZERO, 0.0_f32); positions.len()];
        let groups: Vec<u32> = members
            .iter()
            .map(|&v| root(&mut self.become_of, v))
            .collect();
        for (&v, &group) in members.iter().zip(&groups) {
            let (sum, count) = &mut means[group as usize];
            *sum += positions[v as usize];
            *count += 1.0;
        }
        let mut best = vec![(f32::INFINITY, NO_VERTEX); positions.len()];
        for (&v, &group) in members.iter().zip(&groups) {
            let (sum, count) = means[group as usize];
            let best = &mut best[group as usize];
            let off = (sum / count - positions[v as usize]).length_squared();
            if best.1 == NO_VERTEX || off < best.0 {
                *best = (off, v);
            }
        }
        for &v in members {
            self.normals[v as usize] = Vec3::ZERO;
        }
        for (&v, group) in members.iter().zip(groups) {
            let chosen = best[group as usize].1;
            self.become_of[v as usize] = chosen;
            self.normals[chosen as usize] += self.around[v as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two sheets of 40 by 40 cells of 0.1, one 0.05 above the other.
    fn on_sheets(test: impl FnOnce(Patch)) {
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
        let triangles: Vec<[u32; 3]> = corners(0).chain(corners(side * side)).collect();
        test(Patch {
            positions: &positions,
            triangles: &triangles,
        });
    }

    #[test]
    fn connected_vertices_join_and_sheets_and_borders_stay() {
        on_sheets(|patch| {
            let Patch {
                positions,
                triangles,
            } = patch;
            let clusters = Clusters::new(patch, 0.5, 0.0);
            assert_eq!(clusters.folds, [[0; 3]; 0]);
            let joined = &clusters.triangles;
            assert!(joined.len() < triangles.len() / 4, "{}", joined.len());
            for (vertex, from) in (0..).zip(positions) {
                let other = clusters.of(vertex);
                let to = positions[other as usize];
                assert_eq!(clusters.of(other), other);
                assert!(from.z == to.z && (from - to).abs().max_element() < 0.5);
                let is_inner = |x: f32| 0.05 < x && x < 3.95;
                assert!((is_inner(from.x) && is_inner(from.y)) || *from == to);
            }
            // With its border where it was, a flat sheet keeps its area, however its triangles are turned.
            let area = |triangles: &[[u32; 3]]| {
                let doubled = triangles.iter().map(|t| {
                    let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
                    (b - a).cross(c - a).z
                });
                doubled.sum::<f64>() / 2.0
            };
            let (after, before) = (area(joined), area(triangles));
            assert!((after - before).abs() < 1e-4, "{after} {before}");
        });
    }

    #[test]
    fn clusters_are_divided_where_that_is_wanted_alone() {
        on_sheets(|patch| {
            let Patch {
                positions,
                triangles,
            } = patch;
            let mut clusters = Clusters::new(patch, 0.5, 0.0);
            let before: Vec<u32> = (0..positions.len() as u32)
                .map(|v| clusters.of(v))
                .collect();
            let is_wanted = |other: u32| positions[other as usize].x < 2.0;
            assert!(clusters.divide(patch, 0.2, is_wanted));
            for (vertex, from) in (0..).zip(positions) {
                let (other, was) = (clusters.of(vertex), before[vertex as usize]);
                let cell = if is_wanted(was) { 0.2 } else { 0.5 };
                let reach = (from - positions[other as usize]).abs().max_element();
                assert!(reach < cell, "{reach}");
                assert!(other == was || is_wanted(was));
                assert_eq!(is_wanted(before[other as usize]), is_wanted(was));
            }
            assert!(clusters.divide(patch, 0.0, |_| true));
            assert_eq!(clusters.triangles, triangles);
            assert!(!clusters.divide(patch, 0.0, |_| true));
        });
    }

    #[test]
    fn cells_too_small_to_number_join_nothing() {
        on_sheets(|patch| {
            for cell in [0.0, 1e-7, 0.01, f32::NAN] {
                let clusters = Clusters::new(patch, cell, 0.0);
                assert_eq!(clusters.triangles, patch.triangles);
            }
        });
    }
}
