//! One tree painted pixel by pixel from one eye, and the tracing that it is compared with.

use bspray::accel::bsp::polygon::{PlacedTree, PolygonBsp, SceneTrees, Seen};
use bspray::accel::{Accelerator, Hit, TestSpaces};
use bspray::geometry::{Ray, RayFrame, Triangle};
use bspray::scene::Scene;
use dashu_ratio::Relaxed;
use glam::Vec3;

use super::rational::{Rationals, dot, minus, plane_normal, rational};

/// Where the line of the ray meets the plane of the triangle.
fn meeting(ray: &Ray, triangle: &Triangle) -> Rationals {
    let (o, d) = (rational(ray.origin), rational(ray.direction));
    let normal = plane_normal(triangle);
    let to_plane = minus(&rational(triangle.corners()[0]), &o);
    let t = dot(&normal, &to_plane) / dot(&normal, &d);
    std::array::from_fn(|i| &o[i] + &t * &d[i])
}

/// Whether the ray comes from the side from which the corners run counter-clockwise.
fn is_from_the_front(ray: &Ray, triangle: &Triangle) -> bool {
    dot(&plane_normal(triangle), &rational(ray.direction)) < Relaxed::ZERO
}

/// A tree in its place, from one eye.
pub(crate) struct Canvas<'a> {
    bsp: &'a PolygonBsp,
    placed: &'a PlacedTree,
    names: Box<dyn Fn(u32) -> (u32, u32) + Sync + 'a>,
    /// From behind to in front.
    order: Vec<Seen>,
    /// Of each fragment, its node; of each node, the node above it and whether it lies in front of that.
    node_of: Vec<u32>,
    parents: Vec<Option<(u32, bool)>>,
}

impl<'a> Canvas<'a> {
    pub(crate) fn new(trees: &'a SceneTrees, placed: &'a PlacedTree, eye: Vec3) -> Self {
        let tree = &trees.trees()[placed.tree as usize];
        let bsp = &tree.bsp;
        assert_eq!(bsp.stats().unsplit, 0, "undivided cells have no order");
        let mut parents = vec![None; bsp.nodes().len()];
        let mut node_of = vec![0; bsp.fragments().len()];
        for (number, node) in (0..).zip(bsp.nodes()) {
            node.fragments().for_each(|f| node_of[f as usize] = number);
            for (child, is_front) in [(node.front(), true), (node.back(), false)] {
                if let Some(child) = child {
                    parents[child as usize] = Some((number, is_front));
                }
            }
        }
        Self {
            bsp,
            placed,
            names: Box::new(|triangle| match placed.instance {
                Some((instance, _)) => (instance, triangle),
                None => tree.name(triangle),
            }),
            order: bsp.back_to_front(eye.as_dvec3()),
            node_of,
            parents,
        }
    }

    /// Whether the point, on the polygon's plane, is in the closed cell of the fragment.
    fn is_in_cell(&self, fragment: u32, point: &Rationals) -> bool {
        let mut at = self.node_of[fragment as usize];
        while let Some((above, is_front)) = self.parents[at as usize] {
            let plane = self.bsp.nodes()[above as usize].plane().expect("divided");
            let [a, b, c] = *self.bsp.plane(plane).points();
            let normal = plane_normal(&Triangle::new(a, b, c));
            let height = dot(&normal, &minus(point, &rational(a)));
            let is_outside = if is_front {
                height < Relaxed::ZERO
            } else {
                height > Relaxed::ZERO
            };
            if is_outside {
                return false;
            }
            at = above;
        }
        true
    }

    /// The hit of the fragment, if it covers the ray's pixel. The ray is in the space of the tree.
    fn cover(&self, seen: &Seen, ray: &Ray, frame: &RayFrame) -> Option<Hit> {
        let fragment = &self.bsp.fragments()[seen.fragment as usize];
        fragment.triangles.iter().find_map(|&number| {
            let triangle = &self.bsp.triangles()[number as usize];
            let t = frame.intersect(triangle)?;
            let is_whole = fragment.piece.is_none();
            (is_whole || self.is_in_cell(seen.fragment, &meeting(ray, triangle))).then(|| {
                let (instance, triangle) = (self.names)(number);
                Hit {
                    t,
                    instance,
                    triangle,
                }
            })
        })
    }

    /// What stays to be seen in the pixel: the last that is drawn.
    pub(crate) fn paint(
        &self,
        scene: &Scene,
        spaces: &TestSpaces,
        ray: &Ray,
        fronts_only: bool,
    ) -> Option<Hit> {
        let ray = match self.placed.instance {
            Some((instance, _)) => spaces.test(scene, ray, instance, 0).0,
            None => *ray,
        };
        let frame = RayFrame::new(&ray);
        let drawn = self.order.iter().filter(|s| !(fronts_only && s.faces_away));
        drawn.rev().find_map(|seen| self.cover(seen, &ray, &frame))
    }
}

/// The first hit that is met from its front.
pub(crate) fn trace_fronts(
    scene: &Scene,
    spaces: &TestSpaces,
    accelerator: &dyn Accelerator,
    ray: &Ray,
) -> Option<Hit> {
    let mut ray = *ray;
    loop {
        let hit = accelerator.closest_hit(&ray)?;
        let (in_space, triangle) = spaces.test(scene, &ray, hit.instance, hit.triangle);
        if is_from_the_front(&in_space, &triangle) {
            return Some(hit);
        }
        ray = ray.behind(hit.t, (hit.instance, hit.triangle));
    }
}
