//! The BSP as textbooks have it (Fuchs, Kedem, Naylor, SIGGRAPH 1980): triangles are cut by one another's planes in single precision with a fixed
//! epsilon, and rays meet the cut pieces. World space, model units.

use glam::Vec3;

use super::textbook_test;
use crate::accel::{Hit, world_triangles};
use crate::geometry::tolerance::NAIVE_PLANE;
use crate::geometry::{Ray, Triangle};
use crate::scene::Scene;

/// Splitters tried at a node; the one with the fewest cuts and the best balance wins.
const CANDIDATES: usize = 8;

/// What a cut counts beside a piece of imbalance.
const CUT_COST: usize = 8;

/// A piece of a triangle.
#[derive(Clone, Copy)]
struct Piece {
    triangle: Triangle,
    name: (u32, u32),
}

struct Node {
    normal: Vec3,
    distance: f32,
    /// Within the epsilon of the plane.
    coplanar: Vec<Piece>,
    /// The nodes in front and behind.
    children: [Option<u32>; 2],
}

/// The tree.
pub(crate) struct EpsilonBsp {
    nodes: Vec<Node>,
    root: Option<u32>,
}

impl EpsilonBsp {
    /// Builds recursively, as textbooks do, and so deep as the tree.
    pub(crate) fn build(scene: &Scene) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            root: None,
        };
        let pieces = world_triangles(scene)
            .into_iter()
            .map(|(name, triangle)| Piece { triangle, name });
        tree.root = tree.insert(pieces.collect());
        tree
    }

    fn insert(&mut self, pieces: Vec<Piece>) -> Option<u32> {
        let candidates = (0..CANDIDATES.min(pieces.len()))
            .map(|i| i * pieces.len() / CANDIDATES.min(pieces.len()))
            .filter_map(|i| plane_of(&pieces[i].triangle));
        let cost = |&(normal, distance): &(Vec3, f32)| {
            let sides = pieces
                .iter()
                .map(|p| Sides::of(&p.triangle, normal, distance));
            let mut counts = [0_usize; 3];
            for sides in sides {
                match (sides.has_front(), sides.has_back()) {
                    (true, true) => counts[2] += 1,
                    (true, false) => counts[0] += 1,
                    (false, true) => counts[1] += 1,
                    (false, false) => {}
                }
            }
            counts[2] * CUT_COST + counts[0].abs_diff(counts[1])
        };
        let (normal, distance) = candidates.min_by_key(cost)?;
        let (mut coplanar, mut front, mut back) = (Vec::new(), Vec::new(), Vec::new());
        for piece in pieces {
            let sides = Sides::of(&piece.triangle, normal, distance);
            match (sides.has_front(), sides.has_back()) {
                (false, false) => coplanar.push(piece),
                (true, false) => front.push(piece),
                (false, true) => back.push(piece),
                (true, true) => {
                    cut(&piece, &sides, 1.0, &mut front);
                    cut(&piece, &sides, -1.0, &mut back);
                }
            }
        }
        if coplanar.is_empty() {
            // The triangle that gave the plane does not lie in it: rounding beyond the epsilon. A textbook would not end.
            let all = front.len() + back.len();
            coplanar.append(&mut front);
            coplanar.append(&mut back);
            debug_assert_eq!(coplanar.len(), all);
        }
        let children = [self.insert(front), self.insert(back)];
        self.nodes.push(Node {
            normal,
            distance,
            coplanar,
            children,
        });
        Some(self.nodes.len() as u32 - 1)
    }

    /// The nearest hit; of equal ones the first that is met.
    pub(crate) fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        ray.is_traceable().then_some(())?;
        let (mut stack, mut nearest) = (Vec::new(), None);
        stack.extend(
            self.root
                .map(|root| (root, ray.interval.min, ray.interval.max)),
        );
        while let Some((node, start, end)) = stack.pop() {
            if nearest.is_some_and(|hit: Hit| hit.t < start) {
                continue;
            }
            self.visit(ray, node, (start, end), &mut nearest, &mut stack);
        }
        nearest
    }

    fn visit(
        &self,
        ray: &Ray,
        node: u32,
        (start, end): (f32, f32),
        nearest: &mut Option<Hit>,
        stack: &mut Vec<(u32, f32, f32)>,
    ) {
        let node = &self.nodes[node as usize];
        let height = node.normal.dot(ray.origin) - node.distance;
        let slope = node.normal.dot(ray.direction);
        let crossing = -height / slope;
        for piece in &node.coplanar {
            if let Some(t) = textbook_test(ray, &piece.triangle)
                && nearest.is_none_or(|hit| t < hit.t)
            {
                *nearest = Some(Hit {
                    t,
                    instance: piece.name.0,
                    triangle: piece.name.1,
                });
            }
        }
        // Where the ray starts in the plane, it is in front of what it goes to.
        let starts_in_front = height > 0.0 || (height >= 0.0 && slope > 0.0);
        let [near, far] = if starts_in_front { [0, 1] } else { [1, 0] };
        let [near, far] = [near, far].map(|side: usize| node.children[side]);
        let mut push = |child: Option<u32>, start, end| {
            stack.extend(child.map(|child| (child, start, end)));
        };
        if !crossing.is_finite() || crossing < 0.0 || crossing > end + NAIVE_PLANE {
            push(near, start, end);
        } else if crossing < start - NAIVE_PLANE {
            push(far, start, end);
        } else {
            push(far, crossing, end);
            push(near, start, crossing);
        }
    }
}

fn plane_of(triangle: &Triangle) -> Option<(Vec3, f32)> {
    let [a, b, c] = *triangle.corners();
    let normal = (b - a).cross(c - a).try_normalize()?;
    Some((normal, normal.dot(a)))
}

/// Signed distances of the corners, those within the epsilon as zero.
struct Sides([f32; 3]);

impl Sides {
    fn of(triangle: &Triangle, normal: Vec3, distance: f32) -> Self {
        Self(triangle.corners().map(|p| {
            let height = normal.dot(p) - distance;
            if height.abs() < NAIVE_PLANE {
                0.0
            } else {
                height
            }
        }))
    }

    fn has_front(&self) -> bool {
        self.0.iter().any(|h| *h > 0.0)
    }

    fn has_back(&self) -> bool {
        self.0.iter().any(|h| *h < 0.0)
    }
}

/// The part of the piece on the side of `sign`, as triangles (Sutherland, Hodgman 1974).
fn cut(piece: &Piece, sides: &Sides, sign: f32, kept: &mut Vec<Piece>) {
    let corners = piece.triangle.corners();
    let mut outline: Vec<Vec3> = Vec::with_capacity(4);
    for i in 0..3 {
        let next = (i + 1) % 3;
        let (here, there) = (sides.0[i] * sign, sides.0[next] * sign);
        if here >= 0.0 {
            outline.push(corners[i]);
        }
        if here * there < 0.0 {
            outline.push(corners[i] + (corners[next] - corners[i]) * (here / (here - there)));
        }
    }
    for i in 2..outline.len() {
        kept.push(Piece {
            triangle: Triangle::new(outline[0], outline[i - 1], outline[i]),
            name: piece.name,
        });
    }
}
