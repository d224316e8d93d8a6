//! Which points of a cluster span its convex hull: quickhull (Barber, Dobkin, Huhdanpaa, "The Quickhull Algorithm for Convex Hulls",
//! ACM Transactions on Mathematical Software 22(4), 1996).
//!
//! On which side of a face a point lies is decided without rounding ([`side_of_point`]), so that neither flat nor duplicate nor nearly flat
//! points break the surface. Distances in double precision only choose which point comes next. A point in the plane of a face does not see it; so a
//! few points that lie within a flat side of the hull may stay, which does no harm.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::flat;
use crate::geometry::Triangle;
use crate::geometry::exact::{Sign, side_of_point};

/// A face of the hull; its corners run counter-clockwise for those who see it.
struct Face {
    corners: [u32; 3],
    /// Across the edge from each corner to the next.
    neighbors: [u32; 3],
    /// Points that see the face and belong to it.
    outside: Vec<u32>,
    is_alive: bool,
}

/// Numbers of the points whose hull is that of all, ascending. Points are finite.
pub(super) fn vertices(points: &[Vec3]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    let key = |i: &u32| (points[*i as usize] + Vec3::ZERO).to_array();
    let compare = |a: &u32, b: &u32| {
        let (a, b) = (key(a), key(b));
        let axes = a.iter().zip(&b).map(|(a, b)| a.total_cmp(b));
        axes.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
    };
    // Stable, so that of equal points the first in the list stays.
    order.sort_by(compare);
    order.dedup_by(|a, b| compare(a, b).is_eq());
    let (Some(&first), Some(&last)) = (order.first(), order.last()) else {
        return Vec::new();
    };
    if first == last {
        return vec![first];
    }
    let at = |i: u32| points[i as usize];
    let mut found = match third(points, &order, first, last) {
        None => vec![first, last],
        Some(third) => match fourth(points, &order, [first, last, third]) {
            None => flat::vertices(points, &order, [first, last, third]),
            Some(fourth) => {
                let mut base = [first, last, third];
                if side_of_point(base.map(at), at(fourth)) == Sign::Positive {
                    base.swap(0, 1);
                }
                let mut hull = Hull::tetrahedron(points, base, fourth);
                hull.take(&order);
                hull.vertices()
            }
        },
    };
    found.sort_unstable();
    found
}

/// The point of the greatest `measure` that `is_good`, or else any that is.
fn best(order: &[u32], measure: impl Fn(u32) -> f64, is_good: impl Fn(u32) -> bool) -> Option<u32> {
    let greatest = order
        .iter()
        .copied()
        .max_by(|&a, &b| measure(a).total_cmp(&measure(b)))?;
    if is_good(greatest) {
        return Some(greatest);
    }
    order.iter().copied().find(|&i| is_good(i))
}

/// A point beside the line through two others.
fn third(points: &[Vec3], order: &[u32], a: u32, b: u32) -> Option<u32> {
    let at = |i: u32| points[i as usize];
    let (from, to) = (at(a).as_dvec3(), at(b).as_dvec3());
    let measure = |i: u32| {
        (at(i).as_dvec3() - from)
            .cross(to - from)
            .abs()
            .max_element()
    };
    let is_beside = |i: u32| !Triangle::new(at(a), at(b), at(i)).is_degenerate();
    best(order, measure, is_beside)
}

/// A point beside the plane through three others.
fn fourth(points: &[Vec3], order: &[u32], plane: [u32; 3]) -> Option<u32> {
    let at = |i: u32| points[i as usize];
    let corners = plane.map(at);
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let normal = (b - a).cross(c - a);
    let measure = |i: u32| normal.dot(at(i).as_dvec3() - a).abs();
    best(order, measure, |i| {
        side_of_point(corners, at(i)) != Sign::Zero
    })
}

struct Hull<'a> {
    points: &'a [Vec3],
    faces: Vec<Face>,
}

impl<'a> Hull<'a> {
    /// `top` lies behind the face `base`.
    fn tetrahedron(points: &'a [Vec3], base: [u32; 3], top: u32) -> Self {
        let [a, b, c] = base;
        let face = |corners, neighbors| Face {
            corners,
            neighbors,
            outside: Vec::new(),
            is_alive: true,
        };
        let faces = vec![
            face([a, b, c], [1, 2, 3]),
            face([b, a, top], [0, 3, 2]),
            face([c, b, top], [0, 1, 3]),
            face([a, c, top], [0, 2, 1]),
        ];
        Self { points, faces }
    }

    fn corners(&self, face: u32) -> [Vec3; 3] {
        self.faces[face as usize]
            .corners
            .map(|i| self.points[i as usize])
    }

    fn sees(&self, point: u32, face: u32) -> bool {
        side_of_point(self.corners(face), self.points[point as usize]) == Sign::Positive
    }

    /// Gives each point to the first of the faces that it sees; the others lie in the hull.
    fn hand_out(&mut self, points: impl Iterator<Item = u32>, faces: &[u32]) {
        for point in points {
            if let Some(&face) = faces.iter().find(|&&f| self.sees(point, f)) {
                self.faces[face as usize].outside.push(point);
            }
        }
    }

    /// Grows to hold all points.
    fn take(&mut self, order: &[u32]) {
        let mut waiting: Vec<u32> = vec![0, 1, 2, 3];
        self.hand_out(order.iter().copied(), &waiting);
        while let Some(face) = waiting.pop() {
            let Some(point) = self.farthest(face) else {
                continue;
            };
            let (seen, rim) = self.seen_from(point, face);
            let first = self.faces.len() as u32;
            self.close(point, &rim);
            let new: Vec<u32> = (first..self.faces.len() as u32).collect();
            for face in seen {
                self.faces[face as usize].is_alive = false;
                let outside = std::mem::take(&mut self.faces[face as usize].outside);
                self.hand_out(outside.into_iter().filter(|&p| p != point), &new);
            }
            waiting.extend(new);
        }
    }

    /// Of the points of a living face, the one that is farthest from it.
    fn farthest(&self, face: u32) -> Option<u32> {
        let outside = Some(&self.faces[face as usize]).filter(|f| f.is_alive)?;
        let [a, b, c] = self.corners(face).map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a);
        let height = |&i: &u32| {
            let p: DVec3 = self.points[i as usize].as_dvec3();
            normal.dot(p - a)
        };
        let points = outside.outside.iter();
        points
            .max_by(|a, b| height(a).total_cmp(&height(b)))
            .copied()
    }

    /// The faces that a point sees, one of which is `start`; and the edges around them: from, to, and the face beyond.
    fn seen_from(&self, point: u32, start: u32) -> (Vec<u32>, Vec<(u32, u32, u32)>) {
        let mut known = HashMap::from([(start, true)]);
        let (mut seen, mut rim) = (vec![start], Vec::new());
        let mut next = 0;
        while let Some(&face) = seen.get(next) {
            next += 1;
            let Face {
                corners, neighbors, ..
            } = &self.faces[face as usize];
            for edge in 0..3 {
                let beyond = neighbors[edge];
                let is_new = !known.contains_key(&beyond);
                let sees = *known
                    .entry(beyond)
                    .or_insert_with(|| self.sees(point, beyond));
                if !sees {
                    rim.push((corners[edge], corners[(edge + 1) % 3], beyond));
                } else if is_new {
                    seen.push(beyond);
                }
            }
        }
        (seen, rim)
    }

    /// Adds a face from each edge of the rim to the point. The rim is one closed line, each of its corners once.
    fn close(&mut self, point: u32, rim: &[(u32, u32, u32)]) {
        let first = self.faces.len() as u32;
        let starting: HashMap<u32, u32> = rim
            .iter()
            .zip(first..)
            .map(|(&(from, ..), face)| (from, face))
            .collect();
        let ending: HashMap<u32, u32> = rim
            .iter()
            .zip(first..)
            .map(|(&(_, to, _), face)| (to, face))
            .collect();
        for (&(from, to, beyond), face) in rim.iter().zip(first..) {
            self.faces.push(Face {
                corners: [from, to, point],
                neighbors: [beyond, starting[&to], ending[&from]],
                outside: Vec::new(),
                is_alive: true,
            });
            let other = &mut self.faces[beyond as usize];
            for edge in 0..3 {
                if other.corners[edge] == to && other.corners[(edge + 1) % 3] == from {
                    other.neighbors[edge] = face;
                }
            }
        }
    }

    fn vertices(&self) -> Vec<u32> {
        let alive = self.faces.iter().filter(|f| f.is_alive);
        let mut found: Vec<u32> = alive.flat_map(|f| f.corners).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in -1..1 from a seed (SplitMix64).
    fn numbers(mut seed: u64) -> impl FnMut() -> f32 {
        move || {
            seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
        }
    }

    /// The hull again, from its vertices alone: all points lie behind its faces.
    fn check(points: &[Vec3]) -> usize {
        let found = vertices(points);
        let corners: Vec<Vec3> = found.iter().map(|&i| points[i as usize]).collect();
        // In every direction the vertices reach as far as all points: in exact sums of small whole numbers, and in f64.
        let mut next = numbers(9);
        for _ in 0..300 {
            let direction = DVec3::new(next().into(), next().into(), next().into());
            let reach = |points: &[Vec3]| {
                let along = points.iter().map(|p| direction.dot(p.as_dvec3()));
                along.fold(f64::NEG_INFINITY, f64::max)
            };
            let (all, hull) = (reach(points), reach(&corners));
            assert!(all <= hull + 1e-12 * all.abs(), "{all} {hull}");
        }
        found.len()
    }

    #[test]
    fn random_points_lie_in_the_hull_of_its_vertices() {
        for seed in 0..20 {
            let mut next = numbers(seed);
            let points: Vec<Vec3> = (0..300)
                .map(|_| Vec3::new(next(), next() * 2.0, next() * 3.0))
                .collect();
            let count = check(&points);
            assert!((8..200).contains(&count), "{count}");
        }
    }

    #[test]
    fn points_of_a_grid_leave_little_more_than_its_corners() {
        // Flat sides full of points, all of them duplicated.
        let grid = |i: usize| Vec3::new((i % 6) as f32, (i / 6 % 5) as f32, (i / 30 % 4) as f32);
        let points: Vec<Vec3> = (0..240).map(grid).collect();
        let count = check(&points);
        assert!((8..=20).contains(&count), "{count}");
    }

    #[test]
    fn points_of_a_sphere_all_stay() {
        let mut next = numbers(3);
        let points: Vec<Vec3> = (0..2000)
            .map(|_| Vec3::new(next(), next(), next()).normalize())
            .collect();
        assert_eq!(check(&points), 2000);
    }

    #[test]
    fn flat_straight_and_single_clusters_have_hulls_too() {
        let flat: Vec<Vec3> = (0..30)
            .map(|i| Vec3::new((i % 6) as f32, (i / 6) as f32, (i % 6 + i / 6) as f32))
            .collect();
        assert_eq!(check(&flat), 4);
        let straight: Vec<Vec3> = (0..9)
            .map(|i| Vec3::new(1.0, 2.0, 3.0) * (i * 7 % 9) as f32)
            .collect();
        assert_eq!(vertices(&straight), [0, 5]);
        assert_eq!(vertices(&[Vec3::ONE; 5]), [0]);
        assert_eq!(vertices(&[Vec3::ZERO, -Vec3::ZERO]), [0]);
        assert!(vertices(&[]).is_empty());
    }

    #[test]
    fn points_that_leave_a_plane_by_one_ulp_are_kept() {
        for scale in [1e-30, 1.0, 1e15] {
            let mut points: Vec<Vec3> = (0..25)
                .map(|i| Vec3::new((i % 5) as f32 + 1.0, (i / 5) as f32 + 1.0, 1.0) * scale)
                .collect();
            points[12].z = points[12].z.next_up();
            points[7].z = points[7].z.next_down();
            let found = vertices(&points);
            assert!(found.contains(&12) && found.contains(&7), "{found:?}");
            check(&points);
        }
    }
}
