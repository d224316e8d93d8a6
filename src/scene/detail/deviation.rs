//! How far a simplified surface is from the vertices that it does without: measured, from above.
//!
//! For each vertex that was left out, the surface is searched from the kept vertex that is the fewest edges away: of the triangles around it, the nearest is taken; then those around that one's corners, until no one is
//! nearer. The distance to any triangle is no less than that to the surface, so what is found is a bound whichever way the search goes. It also ends where a triangle is found that is no
//! farther than another vertex was found to be, since only the greatest distance counts. Positions are in object space, and
//! differences of them in double precision.

use std::cell::OnceCell;

use glam::{DVec3, Vec3};

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

/// A triangle, made ready for points above it.
struct Plane {
    corner: DVec3,
    /// What the second and the third corner weigh, by a unit of the way from the first one.
    weights: [DVec3; 2],
    /// Of unit length.
    normal: DVec3,
}

impl Plane {
    /// Nothing is above a triangle without area: its numbers are none.
    fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        let squared = normal.length_squared();
        Self {
            corner: a,
            weights: [
                (c - a).cross(normal) / squared,
                normal.cross(b - a) / squared,
            ],
            normal: normal / squared.sqrt(),
        }
    }

    /// The square of the distance of a point whose foot is in the triangle; infinite for others.
    fn squared_distance(&self, point: DVec3) -> f64 {
        let way = point - self.corner;
        let [b, c] = self.weights.map(|w| w.dot(way));
        match b >= 0.0 && c >= 0.0 && b + c <= 1.0 {
            true => self.normal.dot(way) * self.normal.dot(way),
            false => f64::INFINITY,
        }
    }
}

/// A surface that stands for another.
pub(super) struct Surface<'a> {
    /// Places of its vertices.
    pub(super) positions: &'a [Vec3],
    /// The vertices of each triangle before some were left out, also where it has become a line or a point.
    pub(super) all: &'a dyn Fn() -> Vec<[u32; 3]>,
    /// Those that are left.
    pub(super) kept: &'a [[u32; 3]],
}

/// How far points are from a surface.
pub(super) struct Deviation {
    /// A bound for the distance of all that are near enough: the greatest, or a quarter of what is allowed.
    pub(super) most: f64,
    /// The others, or those whose part of the surface is gone.
    pub(super) far: Vec<u32>,
}

impl Deviation {
    /// Of no points.
    pub(super) fn none(allowed: f64) -> Self {
        Self {
            most: LEAST_SHARE * allowed,
            far: Vec::new(),
        }
    }

    /// Looks at points, each by its name, its place, and a vertex of the surface, or one that it had, where the search begins. Asked of `accepts` is whether a point may be near to a triangle, of which it gets the corners.
    pub(super) fn measure(
        &mut self,
        surface: &Surface,
        points: impl Iterator<Item = (u32, Vec3, u32)>,
        allowed: f64,
        mut accepts: impl FnMut(u32, [u32; 3]) -> bool,
    ) {
        let nearest = OnceCell::new();
        let around = Around::new(surface.positions.len(), surface.kept);
        let corners = surface.kept.iter();
        let corners = corners.map(|t| t.map(|v| surface.positions[v as usize]));
        let planes: Vec<Plane> = corners.map(Plane::new).collect();
        let mut most = self.most * self.most;
        self.far.clear();
        for (name, point, vertex) in points {
            let is_kept = !around.of(vertex).is_empty();
            let start = match is_kept {
                true => vertex,
                false => nearest.get_or_init(|| nearest_kept(surface))[vertex as usize],
            };
            if start == UNKNOWN {
                self.far.push(name);
                continue;
            }
            let is_below = |&triangle: &u32| {
                planes[triangle as usize].squared_distance(point.as_dvec3()) <= most
            };
            let below = around.of(start).iter().copied().find(is_below);
            let (squared, triangle) = match below {
                // As near as another is.
                Some(triangle) => (most, triangle),
                None => search(surface, &around, point, start, most),
            };
            if squared <= allowed * allowed && accepts(name, surface.kept[triangle as usize]) {
                most = most.max(squared);
            } else {
                self.far.push(name);
            }
        }
        self.most = most.sqrt();
    }
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
    let all = (surface.all)();
    let around = Around::new(vertices, &all);
    let is_kept = |v: &u32| nearest[*v as usize] == *v;
    let mut queue: Vec<u32> = (0..vertices as u32).filter(is_kept).collect();
    let mut next = 0;
    while let Some(&vertex) = queue.get(next) {
        next += 1;
        for &triangle in around.of(vertex) {
            for other in all[triangle as usize] {
                if nearest[other as usize] == UNKNOWN {
                    nearest[other as usize] = nearest[vertex as usize];
                    queue.push(other);
                }
            }
        }
    }
    nearest
}

/// The square of a point's distance from a triangle that is found from a vertex on, and the triangle; the search ends with one that is no more than `enough`.
fn search(surface: &Surface, around: &Around, point: Vec3, start: u32, enough: f64) -> (f64, u32) {
    let point = point.as_dvec3();
    let mut nearest = (f64::INFINITY, UNKNOWN);
    let mut look = |vertex: u32| {
        for &triangle in around.of(vertex) {
            let corners = surface.kept[triangle as usize];
            let [a, b, c] = corners.map(|v| surface.positions[v as usize]);
            let squared = Triangle::new(a, b, c).squared_distance(point);
            if squared < nearest.0 {
                nearest = (squared, triangle);
                if squared <= enough {
                    break;
                }
            }
        }
        nearest
    };
    let mut found = look(start);
    while found.0 > enough && found.1 != UNKNOWN {
        let before = found.1;
        for vertex in surface.kept[before as usize] {
            if found.0 > enough {
                found = look(vertex);
            }
        }
        if found.1 == before {
            break;
        }
    }
    found
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

    fn of(positions: &[Vec3], all: &[[u32; 3]], kept: &[[u32; 3]], allowed: f64) -> Deviation {
        let surface = Surface {
            positions,
            all: &|| all.to_vec(),
            kept,
        };
        let points = positions.iter().zip(0..).map(|(&place, v)| (v, place, v));
        let mut deviation = Deviation::none(allowed);
        deviation.measure(&surface, points, allowed, |_, _| true);
        deviation
    }

    #[test]
    fn the_farthest_vertex_decides() {
        let (positions, all) = grid(|x, y| if (x, y) == (5, 6) { 0.75 } else { 0.0 });
        let kept = [[0, 8, 72], [8, 80, 72]];
        let found = |kept: &[[u32; 3]], allowed| {
            let found = of(&positions, &all, kept, allowed);
            (found.most, found.far)
        };
        assert_eq!(found(&kept, 1.0), (0.75, vec![]));
        assert_eq!(found(&kept, 0.7), (0.25 * 0.7, vec![5 + 6 * 9]));
        assert_eq!(found(&all, 0.0), (0.0, vec![]));
        assert_eq!(found(&all, 0.4), (0.1, vec![]));
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
        let found = of(&positions, &all, &flat, 2.0);
        assert_eq!((found.most, found.far), (1.0, vec![]));
    }

    #[test]
    fn a_part_that_is_gone_is_no_part_of_a_surface() {
        let (mut positions, mut all) = grid(|_, _| 0.0);
        let kept = all.clone();
        positions.extend([Vec3::ZERO, Vec3::X, Vec3::Y]);
        all.push([81, 82, 83]);
        assert_eq!(of(&positions, &all, &kept, 1e9).far, [81, 82, 83]);
    }

    #[test]
    fn a_vertex_is_near_where_its_triangle_is_accepted_alone() {
        let (positions, all) = grid(|_, _| 0.0);
        let surface = Surface {
            positions: &positions,
            all: &|| all.clone(),
            kept: &all,
        };
        let points = [0, 40].map(|v| (v, positions[v as usize], v));
        let mut deviation = Deviation::none(1.0);
        deviation.measure(&surface, points.into_iter(), 1.0, |v, corners| {
            assert!(corners.contains(&v));
            v != 40
        });
        assert_eq!(deviation.far, [40]);
    }
}
