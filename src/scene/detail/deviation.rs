//! How far a simplified surface is from the vertices that it does without: measured, from above.
//!
//! For each vertex that was left out, the surface is searched from the kept vertex that is the fewest edges away: of the triangles around it, the nearest is taken; then those around that one's corners, until no one is
//! nearer. The distance to any triangle is no less than that to the surface, so what is found is a bound whichever way the search goes. It also ends where a triangle is found that is no
//! farther than another vertex was found to be, since only the greatest distance counts. Positions are in object space, and
//! differences of them in double precision.

use glam::Vec3;

use crate::geometry::Triangle;

/// Which triangles are around each vertex.
struct Around {
    /// For each vertex, where its triangles begin; and their end.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn new(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0_u32; vertices + 2];
        for &vertex in triangles.iter().flatten() {
            starts[vertex as usize + 2] += 1;
        }
        for vertex in 2..starts.len() {
            starts[vertex] += starts[vertex - 1];
        }
        let mut around = vec![0; triangles.len() * 3];
        for (triangle, corners) in (0_u32..).zip(triangles) {
            for &vertex in corners {
                let next = &mut starts[vertex as usize + 1];
                around[*next as usize] = triangle;
                *next += 1;
            }
        }
        Self {
            starts,
            triangles: around,
        }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|i| self.starts[vertex as usize + i] as usize);
        &self.triangles[start..end]
    }
}

/// Share of what is allowed below which distances are not told apart: most searches end at the first triangle then.
const LEAST_SHARE: f64 = 0.25;

/// A surface that stands for another.
pub(super) struct Surface<'a> {
    /// Places of its vertices.
    pub(super) positions: &'a [Vec3],
    /// Its triangles before some were left out.
    pub(super) all: &'a [[u32; 3]],
    /// Those that are left.
    pub(super) kept: &'a [[u32; 3]],
}

/// A bound for the distance of these points from a surface: the greatest, or a quarter of what is `allowed`. Each comes with a vertex of the surface, or one that it had, where the search begins. `None` if the
/// bound is more than `allowed`, or a part of the surface is gone.
pub(super) fn deviation(
    surface: &Surface,
    points: impl Iterator<Item = (Vec3, u32)>,
    allowed: f64,
) -> Option<f64> {
    let nearest = nearest_kept(surface);
    let around = Around::new(surface.positions.len(), surface.kept);
    let mut most = LEAST_SHARE * allowed * LEAST_SHARE * allowed;
    for (point, vertex) in points {
        let start = nearest[vertex as usize];
        if start == UNKNOWN {
            return None;
        }
        let squared = search(surface, &around, point, start, most);
        most = most.max(squared);
        if most > allowed * allowed {
            return None;
        }
    }
    Some(most.sqrt())
}

/// A vertex of which no kept one is known.
const UNKNOWN: u32 = u32::MAX;

/// For each vertex the kept one that is the fewest edges away, the earliest of several.
fn nearest_kept(surface: &Surface) -> Vec<u32> {
    let vertices = surface.positions.len();
    let mut nearest = vec![UNKNOWN; vertices];
    for &vertex in surface.kept.iter().flatten() {
        nearest[vertex as usize] = vertex;
    }
    let around = Around::new(vertices, surface.all);
    let is_kept = |v: &u32| nearest[*v as usize] == *v;
    let mut queue: Vec<u32> = (0..vertices as u32).filter(is_kept).collect();
    let mut next = 0;
    while let Some(&vertex) = queue.get(next) {
        next += 1;
        for &triangle in around.of(vertex) {
            for other in surface.all[triangle as usize] {
                if nearest[other as usize] == UNKNOWN {
                    nearest[other as usize] = nearest[vertex as usize];
                    queue.push(other);
                }
            }
        }
    }
    nearest
}

/// The square of a point's distance from a triangle that is found from a vertex on; the search ends with one that is no more than `enough`.
fn search(surface: &Surface, around: &Around, point: Vec3, start: u32, enough: f64) -> f64 {
    let point = point.as_dvec3();
    let (mut least, mut best) = (f64::INFINITY, None);
    let mut corners = [start; 3];
    loop {
        let before = best;
        for vertex in corners {
            for &triangle in around.of(vertex) {
                let corners = surface.kept[triangle as usize];
                let [a, b, c] = corners.map(|v| surface.positions[v as usize]);
                let squared = Triangle::new(a, b, c).squared_distance(point);
                if squared < least {
                    (least, best) = (squared, Some(triangle));
                    if least <= enough {
                        return least;
                    }
                }
            }
        }
        match best {
            Some(found) if best != before => corners = surface.kept[found as usize],
            _ => return least,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 9 by 9 points with heights.
    fn grid(height: impl Fn(u32, u32) -> f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let positions =
            (0..81).map(|i| Vec3::new((i % 9) as f32, (i / 9) as f32, height(i % 9, i / 9)));
        let cells = (0..64).map(|i| i % 8 + i / 8 * 9);
        let triangles = cells.flat_map(|v| [[v, v + 1, v + 9], [v + 1, v + 10, v + 9]]);
        (positions.collect(), triangles.collect())
    }

    fn of(positions: &[Vec3], all: &[[u32; 3]], kept: &[[u32; 3]], allowed: f64) -> Option<f64> {
        let surface = Surface {
            positions,
            all,
            kept,
        };
        let points = positions.iter().copied().zip(0..);
        deviation(&surface, points, allowed)
    }

    #[test]
    fn the_farthest_vertex_decides() {
        let (positions, all) = grid(|x, y| if (x, y) == (5, 6) { 0.75 } else { 0.0 });
        let kept = [[0, 8, 72], [8, 80, 72]];
        assert_eq!(of(&positions, &all, &kept, 1.0), Some(0.75));
        assert_eq!(of(&positions, &all, &kept, 0.7), None);
        assert_eq!(of(&positions, &all, &all, 0.0), Some(0.0));
        assert_eq!(of(&positions, &all, &all, 0.4), Some(0.1));
        // A roof of height 4 along its middle, cut off at 3.
        let (positions, all) = grid(|x, _| 4.0 - (x as f32 - 4.0).abs());
        let flat = [
            [0, 3, 72],
            [3, 75, 72],
            [3, 5, 75],
            [5, 77, 75],
            [5, 8, 77],
            [8, 80, 77],
        ];
        assert_eq!(of(&positions, &all, &flat, 2.0), Some(1.0));
    }

    #[test]
    fn a_part_that_is_gone_is_no_part_of_a_surface() {
        let (mut positions, mut all) = grid(|_, _| 0.0);
        let kept = all.clone();
        positions.extend([Vec3::ZERO, Vec3::X, Vec3::Y]);
        all.push([81, 82, 83]);
        assert_eq!(of(&positions, &all, &kept, 1e9), None);
    }
}
