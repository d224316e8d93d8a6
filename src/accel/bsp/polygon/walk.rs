//! How a ray goes through the tree: front to back from where it starts, its interval clipped at each plane.
//!
//! The side that a ray comes from is gone through before the plane's own polygons, and these before the side it goes to. The clips overlap by a
//! margin ([`WALK_MARGIN`]) that covers every rounding, so that a cell is left out only if no hit can be in it. What lies behind the best hit so
//! far is left out; what may tie with it is not.
//!
//! What is left to do stands on a stack of the thread's own, which grows with the deepest tree that the thread meets and is used by ray after ray.

use std::cell::Cell;

use glam::{DVec3, Vec3};

use super::tree::{NONE, PolygonBsp};
use crate::accel::counters::Counter;
use crate::geometry::tolerance::{U64, WALK_MARGIN};
use crate::geometry::{Aabb, Interval, Ray};

/// A node as a ray reads it.
#[derive(Clone, Debug)]
struct Step {
    /// The greatest component is 1 in magnitude.
    normal: DVec3,
    /// Of each component of the normal; infinite in an undivided cell, through which a ray goes however it goes.
    error: f64,
    through: Vec3,
    front: u32,
    back: u32,
    first: u32,
    count: u32,
}

/// The tree as rays meet it: planes, and for each node the original triangles of the fragments in it.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    steps: Vec<Step>,
    /// Numbers of triangles, a run for each node.
    triangles: Vec<u32>,
    bounds: Aabb,
}

/// Something left to do: the polygons of a node, then the node on the far side of it.
#[derive(Clone, Copy)]
struct Task {
    polygons_of: u32,
    node: u32,
    span: Span,
}

/// Parameters that are left of the ray.
#[derive(Clone, Copy)]
struct Span {
    min: f64,
    max: f64,
}

/// Tasks for which a thread keeps room between rays: 100 KB. Deeper chains allocate for each ray; more would be held for one odd tree.
const KEPT_TASKS: usize = 4096;

thread_local! {
    /// The stack between two rays, empty. A walk takes it, so that a walk within a walk would get another.
    static STACK: Cell<Vec<Task>> = const { Cell::new(Vec::new()) };
}

impl Walk {
    pub(super) fn new(tree: &PolygonBsp) -> Self {
        let mut triangles: Vec<u32> = Vec::new();
        let mut steps = Vec::with_capacity(tree.nodes.len());
        for node in &tree.nodes {
            let first = triangles.len();
            let fragments =
                &tree.fragments[node.fragments().start as usize..node.fragments().end as usize];
            let mut run: Vec<u32> = fragments
                .iter()
                .flat_map(|f| &f.triangles)
                .copied()
                .collect();
            // Pieces of one polygon in one undivided cell may share triangles.
            run.sort_unstable();
            run.dedup();
            triangles.extend(run);
            let (normal, error, through) = match node.plane() {
                Some(plane) => {
                    let plane = tree.plane(plane);
                    let (normal, error) = plane.normal();
                    (normal, error, plane.points()[0])
                }
                None => (DVec3::ZERO, f64::INFINITY, Vec3::ZERO),
            };
            steps.push(Step {
                normal,
                error,
                through,
                front: node.front().unwrap_or(NONE),
                back: node.back().unwrap_or(NONE),
                first: first as u32,
                count: (triangles.len() - first) as u32,
            });
        }
        let used = tree.polygons.iter().flat_map(|p| &p.triangles);
        let corners = used.flat_map(|&t| *tree.triangles[t as usize].corners());
        Self {
            steps,
            triangles,
            bounds: corners.collect(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.steps) + size_of_val(&*self.triangles)
    }

    /// Calls `test` with the numbers of triangles that the ray may hit, nearer cells first; those of a split polygon may come again in another cell.
    /// It returns up to which `t` hits matter from then on; a `t` below the interval's beginning ends the walk.
    pub(super) fn visit<C: Counter>(
        &self,
        ray: &Ray,
        counter: &mut C,
        test: impl FnMut(&[u32], &mut C) -> f32,
    ) {
        let Some(span) = self.enter(ray) else { return };
        let mut stack = STACK.take();
        self.descend(ray, span, &mut stack, counter, test);
        if stack.capacity() <= KEPT_TASKS {
            stack.clear();
            STACK.set(stack);
        }
    }

    fn descend<C: Counter>(
        &self,
        ray: &Ray,
        span: Span,
        stack: &mut Vec<Task>,
        counter: &mut C,
        mut test: impl FnMut(&[u32], &mut C) -> f32,
    ) {
        let mut limit = ray.interval.max;
        let mut task = Task {
            polygons_of: NONE,
            node: if self.steps.is_empty() { NONE } else { 0 },
            span,
        };
        loop {
            // A hit whose `t` is rounded to the limit may lie up to the next number behind it.
            let most = f64::from(limit.next_up());
            if task.span.min <= most {
                if let Some(step) = self.steps.get(task.polygons_of as usize)
                    && step.count > 0
                {
                    let run = &self.triangles[step.first as usize..][..step.count as usize];
                    counter.leaf();
                    limit = test(run, counter);
                    if limit < ray.interval.min {
                        return;
                    }
                }
                task.span.max = task.span.max.min(f64::from(limit.next_up()));
                while let Some(step) = self.steps.get(task.node as usize)
                    && task.span.min <= task.span.max
                {
                    counter.node();
                    let (near, crosses, far) = step.divide(ray, task.span);
                    if let Some((far, span)) = far {
                        stack.push(Task {
                            polygons_of: if crosses { task.node } else { NONE },
                            node: far,
                            span,
                        });
                    }
                    let Some((near, span)) = near else { break };
                    task.node = near;
                    task.span = span;
                }
            }
            let Some(next) = stack.pop() else { return };
            task = next;
        }
    }

    /// The part of the ray's interval inside of the scene's box, widened by its roundings.
    fn enter(&self, ray: &Ray) -> Option<Span> {
        let Interval { min, max } = ray.interval;
        let mut span = Span {
            min: f64::from(min.next_down()),
            max: f64::from(max.next_up()),
        };
        for axis in 0..3 {
            let (o, d) = (f64::from(ray.origin[axis]), f64::from(ray.direction[axis]));
            if d.abs() > 0.0 {
                let ends =
                    [self.bounds.min[axis], self.bounds.max[axis]].map(|b| (f64::from(b) - o) / d);
                // Two roundings each, and the widening's own.
                let widened = |t: f64, sign: f64| t + sign * 4.0 * U64 * t.abs();
                span.min = span.min.max(widened(ends[0].min(ends[1]), -1.0));
                span.max = span.max.min(widened(ends[0].max(ends[1]), 1.0));
            }
        }
        (span.min <= span.max).then_some(span)
    }
}

/// A child and the part of the ray in it.
type Part = Option<(u32, Span)>;

impl Step {
    /// The side that the ray comes from, whether it may meet the plane, and the side that it goes to. What the ray surely does not enter is `None`; the far side
    /// stands for the plane's polygons too, and so may be [`NONE`].
    #[inline]
    fn divide(&self, ray: &Ray, span: Span) -> (Part, bool, Part) {
        let direction = ray.direction.as_dvec3();
        let to_origin = ray.origin.as_dvec3() - self.through.as_dvec3();
        let start = self.normal.dot(to_origin);
        let speed = self.normal.dot(direction);
        let reach = to_origin.abs().element_sum()
            + span.min.abs().max(span.max.abs()) * direction.abs().element_sum();
        let margin = (self.error + WALK_MARGIN) * reach;
        // Where the height above the plane leaves the margin: comparisons with a NaN leave the span as it is.
        let [a, b] = [(-margin - start) / speed, (margin - start) / speed];
        let rises = speed > 0.0;
        let (first, last) = if rises {
            (a, b)
        } else if speed < 0.0 {
            (b, a)
        } else {
            (span.min, span.max)
        };
        let [at_min, at_max] = [span.min, span.max].map(|t| start + t * speed);
        let (least, most) = (at_min.min(at_max), at_min.max(at_max));
        let avoids_front = most < -margin;
        let avoids_back = least > margin;
        let (from, to) = if rises {
            (self.back, self.front)
        } else {
            (self.front, self.back)
        };
        if avoids_front || avoids_back {
            let only = if avoids_front { self.back } else { self.front };
            let part = (only != NONE).then_some((only, span));
            return (part, false, None);
        }
        // The ray leaves the near side at `last`, and enters the far side at `first`.
        let near_span = Span {
            min: span.min,
            max: if last < span.max { last } else { span.max },
        };
        let far_span = Span {
            min: if first > span.min { first } else { span.min },
            max: span.max,
        };
        let near = (from != NONE && near_span.min <= near_span.max).then_some((from, near_span));
        (near, true, Some((to, far_span)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bsp::polygon::Fragment;
    use crate::accel::counters::Uncounted;
    use crate::geometry::exact::ExactPlane;
    use crate::geometry::{RayFrame, Triangle};

    #[test]
    fn a_chain_of_a_million_nodes_is_traced_printed_and_dropped() {
        const COUNT: u32 = 1_000_000;
        let at = |z: f32| [[0.0, 0.0, z], [3.0, 0.0, z], [0.0, 2.0, z]].map(Vec3::from_array);
        let [a, b, c] = at(COUNT as f32 - 1.0);
        let mut tree = PolygonBsp {
            planes: (0..COUNT)
                .filter_map(|i| ExactPlane::new(at(i as f32)))
                .collect(),
            polygons: vec![crate::accel::bsp::polygon::Polygon {
                plane: COUNT - 1,
                triangles: vec![0],
                loops: Vec::new(),
            }],
            triangles: vec![Triangle::new(a, b, c)],
            ..PolygonBsp::default()
        };
        let mut parent = None;
        for plane in 0..COUNT {
            parent = Some((tree.push_node(plane, parent), true));
        }
        tree.push_fragment(Fragment {
            polygon: 0,
            loops: Vec::new(),
            triangles: vec![0],
            piece: None,
        });
        assert_eq!(tree.stats().depth, COUNT);
        assert_eq!(tree.to_string().lines().count(), COUNT as usize);
        assert_eq!(tree.to_dot().lines().count(), 2 * COUNT as usize + 2);
        assert_eq!(tree.front_to_back(DVec3::ZERO).len(), 1);
        let walk = Walk::new(&tree);
        for (from, direction) in [(2e6, Vec3::NEG_Z), (0.5, Vec3::Z)] {
            let ray = Ray::new(Vec3::new(0.5, 0.5, from), direction);
            let frame = RayFrame::new(&ray);
            let mut found = None;
            walk.visit(&ray, &mut Uncounted, |run, _| {
                assert_eq!(run, [0]);
                found = frame.intersect(&tree.triangles[0]);
                found.unwrap_or(f32::INFINITY)
            });
            assert_eq!(found, Some((from - (COUNT as f32 - 1.0)).abs()));
        }
    }
}
