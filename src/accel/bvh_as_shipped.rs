//! obvhs as it comes: its own boxes without a margin, its own triangle test, no normalised space. Not an
//! [`Accelerator`](super::Accelerator), since it does not keep that contract; `analysis::stability` shows where. The only file beside `bvh` that names
//! obvhs: there its trees are guarded, here nothing is, and nothing but a measurement may use it.
//!
//! World space, model units. Defects of obvhs 0.4.0 that are formulas, not answers to rays, are [`formula_checks`].

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::triangle::Triangle as ObvhsTriangle;

use super::Hit;
use crate::geometry::{Ray, RayFrame, Triangle};
use crate::scene::Scene;

/// Which structure of obvhs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShippedTree {
    /// None: every triangle, one after the other.
    Every,
    /// `Bvh2`, by its triangles, with the preset `medium_build`.
    Binary,
    /// `CwBvh`, the same.
    Wide,
}

enum Tree {
    Every,
    Binary(Bvh2),
    Wide(CwBvh),
}

/// Triangles in a structure of obvhs.
pub struct AsShipped {
    tree: Tree,
    triangles: Vec<ObvhsTriangle>,
    /// The same for our test, if that is the one to use.
    exact: Option<Vec<Triangle>>,
    /// Instance and index in the mesh, for each triangle.
    names: Vec<(u32, u32)>,
}

impl AsShipped {
    /// Builds over all triangles of the scene in world space, each corner rounded once. `has_exact_test` takes
    /// [`RayFrame`] for obvhs's triangle test, which leaves its boxes and their test.
    ///
    /// Whatever obvhs does happens: it may take very long, use up the stack, panic or abort.
    pub fn build(scene: &Scene, tree: ShippedTree, has_exact_test: bool) -> Self {
        let (names, exact): (Vec<_>, Vec<_>) = world_triangles(scene).into_iter().unzip();
        let triangles: Vec<ObvhsTriangle> = exact.iter().map(foreign).collect();
        let (preset, mut time) = (BvhBuildParams::medium_build(), Duration::default());
        let tree = match tree {
            _ if triangles.is_empty() => Tree::Every,
            ShippedTree::Every => Tree::Every,
            ShippedTree::Binary => {
                Tree::Binary(build_bvh2_from_tris(&triangles, preset, &mut time))
            }
            ShippedTree::Wide => Tree::Wide(build_cwbvh_from_tris(&triangles, preset, &mut time)),
        };
        Self {
            tree,
            triangles,
            exact: has_exact_test.then_some(exact),
            names,
        }
    }

    /// The nearest hit as obvhs has it; of equal ones that which it meets first.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        if !ray.is_traceable() {
            return None;
        }
        let frame = RayFrame::new(ray);
        let test = |ray: &ObvhsRay, triangle: usize| match &self.exact {
            Some(exact) => frame.intersect(&exact[triangle]).unwrap_or(f32::INFINITY),
            None => self.triangles[triangle].intersect(ray),
        };
        let (mut walked, mut hit) = (obvhs_ray(ray), RayHit::none());
        let found = match &self.tree {
            Tree::Every => {
                let mut nearest = None;
                for triangle in 0..self.triangles.len() {
                    let t = test(&walked, triangle);
                    if t < walked.tmax {
                        (walked.tmax, nearest) = (t, Some((t, triangle)));
                    }
                }
                nearest
            }
            Tree::Binary(bvh) => bvh
                .ray_traverse(walked, &mut hit, |ray, entry| {
                    test(ray, bvh.primitive_indices[entry] as usize)
                })
                .then(|| {
                    (
                        hit.t,
                        bvh.primitive_indices[hit.primitive_id as usize] as usize,
                    )
                }),
            Tree::Wide(bvh) => bvh
                .ray_traverse(walked, &mut hit, |ray, entry| {
                    test(ray, bvh.primitive_indices[entry] as usize)
                })
                .then(|| {
                    (
                        hit.t,
                        bvh.primitive_indices[hit.primitive_id as usize] as usize,
                    )
                }),
        };
        found.map(|(t, triangle)| {
            let (instance, triangle) = self.names[triangle];
            Hit {
                t,
                instance,
                triangle,
            }
        })
    }
}

/// The scene's triangles in world space, each corner rounded once, with instance and index in the mesh.
pub fn world_triangles(scene: &Scene) -> Vec<((u32, u32), Triangle)> {
    let mut all = Vec::new();
    for (instance, placed) in (0..).zip(&scene.instances) {
        let mesh = &scene.meshes[placed.mesh as usize];
        all.extend((0..mesh.triangles.len() as u32).map(|index| {
            let [a, b, c] = mesh
                .triangle(index)
                .corners()
                .map(|p| placed.world_point(p));
            ((instance, index), Triangle::new(a, b, c))
        }));
    }
    all
}

fn foreign(triangle: &Triangle) -> ObvhsTriangle {
    let [v0, v1, v2] = triangle.corners().map(Vec3A::from);
    ObvhsTriangle { v0, v1, v2 }
}

fn obvhs_ray(ray: &Ray) -> ObvhsRay {
    ObvhsRay::new(
        ray.origin.into(),
        ray.direction.into(),
        ray.interval.min,
        ray.interval.max,
    )
}

/// A number that a function of obvhs returns, beside what it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormulaCheck {
    /// The function, and what it is asked.
    pub name: &'static str,
    /// What is right.
    pub expected: f64,
    /// What it returns.
    pub found: f64,
}

/// Asks the functions of obvhs that were found wrong once, on input without symmetries.
pub fn formula_checks() -> Vec<FormulaCheck> {
    let one_two_three = Aabb::new(Vec3A::ZERO, Vec3A::new(1.0, 2.0, 3.0));
    let triangle = ObvhsTriangle {
        v0: Vec3A::ZERO,
        v1: Vec3A::new(4.0, 0.0, 0.0),
        v2: Vec3A::new(0.0, 2.0, 0.0),
    };
    // Meets the triangle at (1, 0.5, 0), t = 3; the area is 4, twice that the length of the normal.
    let down = ObvhsRay::new_inf(Vec3A::new(1.0, 0.5, 6.0), Vec3A::new(0.0, 0.0, -2.0));
    let behind_start = ObvhsRay::new(Vec3A::new(0.5, 1.0, -1.0), Vec3A::Z, 10.0, f32::INFINITY);
    let check = |name, expected, found: f32| FormulaCheck {
        name,
        expected,
        found: f64::from(found),
    };
    let mut checks = vec![
        check(
            "Aabb::surface_area of 1 x 2 x 3",
            22.0,
            one_two_three.surface_area(),
        ),
        check(
            "twice Aabb::half_area of 1 x 2 x 3",
            22.0,
            2.0 * one_two_three.half_area(),
        ),
        check("Triangle::intersect, t", 3.0, triangle.intersect(&down)),
        check(
            "Triangle::compute_barycentric, u of (1, 0.5) in 4 x 2",
            0.25,
            triangle.compute_barycentric(&down).x,
        ),
        check(
            "Aabb::intersect_ray of a box that ends before tmin",
            f64::INFINITY,
            one_two_three.intersect_ray(&behind_start),
        ),
    ];
    #[cfg(target_arch = "x86_64")]
    checks.push(check(
        "Triangle::intersect_embree, t",
        3.0,
        triangle.intersect_embree(&down),
    ));
    checks.extend([any_hit_visits(), missed_depth()]);
    checks
}

/// How many of three walls the any-hit query visits; one answers whether anything is hit.
fn any_hit_visits() -> FormulaCheck {
    let bvh = build_bvh2_from_tris(
        &walls(),
        BvhBuildParams::medium_build(),
        &mut Duration::default(),
    );
    let mut visits = 0;
    bvh.ray_traverse_anyhit(obvhs_ray(&through_walls()), |_, _| visits += 1);
    FormulaCheck {
        name: "Bvh2::ray_traverse_anyhit, triangles visited of 3 in a row",
        expected: 1.0,
        found: f64::from(visits),
    }
}

/// What a miss before a finite end leaves as the hit's depth in a tree of one leaf whose box is met.
fn missed_depth() -> FormulaCheck {
    let walls = walls();
    let (preset, mut time) = (BvhBuildParams::medium_build(), Duration::default());
    let bvh = build_bvh2_from_tris(&walls, preset, &mut time);
    // Enters the boxes beside the triangles, and ends behind them.
    let beside = Ray::new(Vec3::new(2.9, 1.9, 0.0), Vec3::new(0.01, 0.02, 1.0));
    let (mut ray, mut hit) = (obvhs_ray(&beside), RayHit::none());
    ray.tmax = 9.0;
    let _ = bvh.ray_traverse(ray, &mut hit, |ray, entry| {
        walls[bvh.primitive_indices[entry] as usize].intersect(ray)
    });
    FormulaCheck {
        name: "Bvh2::ray_traverse, t of the hit after a miss",
        expected: f64::INFINITY,
        found: f64::from(hit.t),
    }
}

/// Three parallel triangles, one behind the other.
fn walls() -> Vec<ObvhsTriangle> {
    [1.0, 2.0, 3.0]
        .map(|z| ObvhsTriangle {
            v0: Vec3A::new(-1.0, -1.0, z),
            v1: Vec3A::new(3.0, -1.0, z),
            v2: Vec3A::new(-1.0, 2.0, z),
        })
        .to_vec()
}

fn through_walls() -> Ray {
    Ray::new(Vec3::new(0.1, 0.2, 0.0), Vec3::new(0.01, 0.02, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_to_be_wrong_in_obvhs_0_4_0_still_is() {
        let wrong: Vec<_> = formula_checks()
            .into_iter()
            .filter(|c| c.found != c.expected)
            .map(|c| c.name.split([',', ' ']).next().unwrap())
            .collect();
        for name in [
            "Aabb::surface_area",
            "Triangle::compute_barycentric",
            "Bvh2::ray_traverse_anyhit",
        ] {
            assert!(wrong.contains(&name), "{name} is right now: {wrong:?}");
        }
        assert!(
            !wrong.contains(&"twice") && !wrong.contains(&"Triangle::intersect"),
            "{wrong:?}"
        );
    }
}
