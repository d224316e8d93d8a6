//! What enters the tree: triangles, n-gons that are exactly planar, and, if wished, exactly coplanar neighbours as one.
//!
//! A polygon of several triangles has as its outline the edges that are not shared between two of them. Whether they lie in one plane and look the
//! same way is decided without rounding.

use std::collections::HashMap;

use glam::Vec3;

use super::fragment::{Corner, Edge, Loop, Origin, Polygon};
use crate::geometry::Triangle;
use crate::geometry::exact::{ExactPlane, Sign};

/// Polygons and their planes; the triangles that have no area, by number.
#[derive(Default)]
pub(super) struct Input {
    pub(super) polygons: Vec<Polygon>,
    pub(super) planes: Vec<ExactPlane>,
    pub(super) left_out: Vec<u32>,
}

type Key = [u32; 3];

/// The bits of a point, with one zero.
fn key(p: Vec3) -> Key {
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// Reads triangles; `outlines` are runs of triangles (first, count) that were one polygon of the file, ascending.
pub(super) fn read(triangles: &[Triangle], outlines: &[(u32, u32)], merges: bool) -> Input {
    let mut input = Input::default();
    let plane_of = |t: &u32| ExactPlane::new(*triangles[*t as usize].corners());
    let mut groups: Vec<(Vec<u32>, ExactPlane)> = Vec::new();
    let mut outlines = outlines.iter().copied().peekable();
    let mut next = 0;
    while next < triangles.len() as u32 {
        let count = outlines
            .next_if(|&(first, _)| first == next)
            .map_or(1, |(_, count)| count);
        let run: Vec<u32> = (next..next + count).collect();
        next += count;
        let planes: Vec<Option<ExactPlane>> = run.iter().map(plane_of).collect();
        let flat = run.iter().zip(&planes).filter(|(_, p)| p.is_none());
        input.left_out.extend(flat.map(|(&t, _)| t));
        let mut spanning = planes.iter().flatten();
        if let Some(first) = spanning.next()
            && count > 1
            && spanning.all(|p| first.same(p) == Sign::Positive)
            && boundary(triangles, &run).is_some()
        {
            groups.push((run, first.clone()));
        } else {
            let single = run.into_iter().zip(planes);
            groups.extend(single.filter_map(|(t, plane)| Some((vec![t], plane?))));
        }
    }
    if merges {
        groups = merge(triangles, groups);
    }
    for (run, plane) in groups {
        let Some(loops) = boundary(triangles, &run) else {
            continue;
        };
        let number = input.planes.len() as u32;
        let to_corners = |points: Vec<Vec3>| -> Loop {
            let n = points.len();
            (0..n)
                .map(|i| {
                    let line = [points[i], points[(i + 1) % n]];
                    Corner::new(Origin::Given(points[i]), Edge::Given(line), &input.planes)
                })
                .collect()
        };
        let loops = loops.into_iter().map(to_corners).collect();
        let has_area = |t: &u32| !triangles[*t as usize].is_degenerate();
        input.polygons.push(Polygon {
            plane: number,
            triangles: run.into_iter().filter(has_area).collect(),
            loops,
        });
        input.planes.push(plane);
    }
    input
}

/// The outline of triangles: loops of the edges that no two of them share. `None` if these do not close.
fn boundary(triangles: &[Triangle], run: &[u32]) -> Option<Vec<Vec<Vec3>>> {
    if let [only] = run {
        return Some(vec![triangles[*only as usize].corners().to_vec()]);
    }
    let mut open: HashMap<(Key, Key), u32> = HashMap::new();
    let edges: Vec<[Vec3; 2]> = run
        .iter()
        .flat_map(|&t| {
            let [a, b, c] = *triangles[t as usize].corners();
            [[a, b], [b, c], [c, a]]
        })
        .filter(|[p, q]| key(*p) != key(*q))
        .collect();
    for [p, q] in &edges {
        let (p, q) = (key(*p), key(*q));
        match open.get_mut(&(q, p)) {
            Some(count) if *count > 0 => *count -= 1,
            _ => *open.entry((p, q)).or_default() += 1,
        }
    }
    // In the order of the triangles, so that nothing depends on hashes.
    let mut ways: HashMap<Key, Vec<Vec3>> = HashMap::new();
    let mut starts = Vec::new();
    for [p, q] in &edges {
        if let Some(count) = open.get_mut(&(key(*p), key(*q)))
            && *count > 0
        {
            *count -= 1;
            ways.entry(key(*p)).or_default().push(*q);
            starts.push(*p);
        }
    }
    let mut loops = Vec::new();
    for start in starts {
        let mut points = Vec::new();
        let mut at = start;
        while let Some(next) = ways.get_mut(&key(at)).and_then(Vec::pop) {
            points.push(at);
            at = next;
        }
        if key(at) != key(start) {
            return None;
        }
        straighten(&mut points);
        if points.len() > 2 {
            loops.push(points);
        }
    }
    (!loops.is_empty()).then_some(loops)
}

/// Leaves out corners on straight lines and spikes.
fn straighten(points: &mut Vec<Vec3>) {
    let mut kept: Vec<Vec3> = Vec::with_capacity(points.len());
    let is_flat = |a, b, c| Triangle::new(a, b, c).is_degenerate();
    for &p in points.iter() {
        while let [.., a, b] = kept[..]
            && is_flat(a, b, p)
        {
            kept.pop();
        }
        kept.push(p);
    }
    let mut first = 0;
    while kept.len() - first > 2 {
        let n = kept.len();
        if is_flat(kept[n - 2], kept[n - 1], kept[first]) {
            kept.pop();
        } else if is_flat(kept[n - 1], kept[first], kept[first + 1]) {
            first += 1;
        } else {
            break;
        }
    }
    kept.drain(..first);
    *points = kept;
}

/// Joins groups that share an edge, exactly two at it, and lie in exactly one plane and look the same way.
fn merge(
    triangles: &[Triangle],
    groups: Vec<(Vec<u32>, ExactPlane)>,
) -> Vec<(Vec<u32>, ExactPlane)> {
    let mut at_edge: HashMap<(Key, Key), Vec<u32>> = HashMap::new();
    let mut edges = Vec::new();
    for (number, (run, _)) in groups.iter().enumerate() {
        for &t in run {
            let c = triangles[t as usize].corners();
            for i in 0..3 {
                let edge = (key(c[i]), key(c[(i + 1) % 3]));
                at_edge.entry(edge).or_default().push(number as u32);
                edges.push(edge);
            }
        }
    }
    let mut parent: Vec<u32> = (0..groups.len() as u32).collect();
    fn root(parent: &mut [u32], mut of: u32) -> u32 {
        while parent[of as usize] != of {
            let above = parent[of as usize];
            parent[of as usize] = parent[above as usize];
            of = above;
        }
        of
    }
    for (p, q) in edges {
        let (Some([a]), Some([b])) = (
            at_edge.get(&(p, q)).map(Vec::as_slice),
            at_edge.get(&(q, p)).map(Vec::as_slice),
        ) else {
            continue;
        };
        if a < b && groups[*a as usize].1.same(&groups[*b as usize].1) == Sign::Positive {
            let (a, b) = (root(&mut parent, *a), root(&mut parent, *b));
            let (least, other) = (a.min(b), a.max(b));
            parent[other as usize] = least;
        }
    }
    // A root is the least of its members, and so comes first.
    let mut joined: Vec<(Vec<u32>, ExactPlane)> = Vec::new();
    let mut place: HashMap<u32, usize> = HashMap::new();
    let mut parts: Vec<Vec<(Vec<u32>, ExactPlane)>> = Vec::new();
    for (number, group) in groups.into_iter().enumerate() {
        let root = root(&mut parent, number as u32);
        let at = *place.entry(root).or_insert(parts.len());
        if at == parts.len() {
            parts.push(Vec::new());
        }
        parts[at].push(group);
    }
    for part in parts {
        let mut run: Vec<u32> = part.iter().flat_map(|(r, _)| r.iter().copied()).collect();
        run.sort_unstable();
        // What does not close into loops stays apart.
        match part.first() {
            Some((_, plane)) if boundary(triangles, &run).is_some() => {
                joined.push((run, plane.clone()));
            }
            _ => joined.extend(part),
        }
    }
    joined
}
