//! The trees of a scene: one in world space for all meshes that are placed once, and one in object space for each mesh that is placed several times.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};

use super::tree::PolygonBsp;
use crate::accel::bake::{self, Baked};
use crate::accel::bsp::options::BuildOptions;
use crate::accel::hit::Hit;
use crate::scene::Scene;

/// The polygon BSPs of a scene, as [`AcceleratorKind::BspPolygon`](crate::accel::AcceleratorKind::BspPolygon) builds them, to be looked at.
#[derive(Clone, Debug)]
pub struct SceneTrees {
    trees: Vec<SceneTree>,
    placements: Vec<PlacedTree>,
    /// By instance: its tree, and where its triangles begin there.
    first_triangle: HashMap<u32, (u32, u32)>,
}

/// A tree, and the names of its triangles.
#[derive(Clone, Debug)]
pub struct SceneTree {
    /// The tree.
    pub bsp: PolygonBsp,
    /// For each of its triangles, instance and triangle in the mesh. The instance is 0 in a tree that is placed several times.
    pub names: Vec<(u32, u32)>,
}

/// A tree in its place.
#[derive(Clone, Debug)]
pub struct PlacedTree {
    /// Which of the trees.
    pub tree: u32,
    /// The instance and its placement; `None` for the tree in world space.
    pub instance: Option<(u32, DAffine3)>,
}

/// Where in a tree a point of a surface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Located {
    /// Which of the scene's trees.
    pub tree: u32,
    /// Number of the fragment in the tree.
    pub fragment: u32,
    /// Number of its node.
    pub node: u32,
    /// Nodes above it: 0 for the root.
    pub depth: u32,
}

/// Runs of triangles (first, count) of each set that were one polygon of the file.
pub(in crate::accel) fn outlines(scene: &Scene, baked: &Baked) -> Vec<Vec<(u32, u32)>> {
    let mut outlines = vec![Vec::new(); baked.sets.len()];
    for placement in &baked.placements {
        let set = placement.set as usize;
        if !outlines[set].is_empty() {
            continue;
        }
        // Runs of one mesh, one after the other.
        let mut first = 0;
        for run in baked.sets[set].chunk_by(|a, b| a.instance == b.instance) {
            let instance = placement
                .instance
                .as_ref()
                .map_or(run[0].instance, |i| i.index);
            outlines[set].extend(
                scene
                    .mesh_of(instance)
                    .outlines
                    .iter()
                    .map(|o| (first + o.first_triangle, o.triangle_count)),
            );
            first += run.len() as u32;
        }
    }
    outlines
}

impl SceneTrees {
    /// Builds the trees of a scene.
    ///
    /// ```
    /// use bspray::accel::{AcceleratorKind, BspOrder, BuildOptions, bsp::polygon::SceneTrees};
    /// use bspray::geometry::Ray;
    /// use glam::Vec3;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scene = bspray::import::load(&["models/lecture-block.obj".into()])?;
    /// let options = BuildOptions { order: BspOrder::File, ..BuildOptions::default() };
    /// let trees = SceneTrees::build(&scene, &options);
    /// let block = &trees.trees()[0].bsp;
    /// let stats = block.stats();
    /// assert_eq!((stats.polygons, stats.fragments, stats.splits), (8, 10, 2));
    /// // What a ray hits is a fragment somewhere in the tree.
    /// let ray = Ray::new(Vec3::new(0.5, 1.5, 3.0), Vec3::NEG_Z);
    /// let hit = AcceleratorKind::BspPolygon.build(&scene).closest_hit(&ray).ok_or("a hit")?;
    /// let located = trees.locate(&hit, ray.at(hit.t).as_dvec3()).ok_or("in a fragment")?;
    /// assert_eq!(block.name(located.fragment), "7b");
    /// # Ok(())
    /// # }
    /// ```
    pub fn build(scene: &Scene, options: &BuildOptions) -> Self {
        let baked = bake::bake(scene);
        let outlines = outlines(scene, &baked);
        let placements: Vec<PlacedTree> = baked
            .placements
            .iter()
            .map(|p| PlacedTree {
                tree: p.set,
                instance: p.instance.as_ref().map(|i| (i.index, i.world_from_object)),
            })
            .collect();
        let mut first_triangle = HashMap::new();
        for placement in &placements {
            if let Some((instance, _)) = placement.instance {
                first_triangle.insert(instance, (placement.tree, 0));
                continue;
            }
            let mut first = 0;
            let set = &baked.sets[placement.tree as usize];
            for run in set.chunk_by(|a, b| a.instance == b.instance) {
                first_triangle.insert(run[0].instance, (placement.tree, first));
                first += run.len() as u32;
            }
        }
        let tree = |(set, outlines): (bake::TriangleSet, Vec<(u32, u32)>)| SceneTree {
            names: set.iter().map(|t| (t.instance, t.index)).collect(),
            bsp: PolygonBsp::build(set.iter().map(|t| t.triangle).collect(), &outlines, options),
        };
        Self {
            trees: baked.sets.into_iter().zip(outlines).map(tree).collect(),
            placements,
            first_triangle,
        }
    }

    /// The trees.
    pub fn trees(&self) -> &[SceneTree] {
        &self.trees
    }

    /// Where they are.
    pub fn placements(&self) -> &[PlacedTree] {
        &self.placements
    }

    /// The fragment that was hit, `point` being the place in world space. In a cut, which belongs to two fragments, and within rounding of one, either.
    /// `None` for a hit that is not of this scene.
    pub fn locate(&self, hit: &Hit, point: DVec3) -> Option<Located> {
        let &(tree, first) = self.first_triangle.get(&hit.instance)?;
        let placed = self.placements.iter().find_map(|p| {
            let (instance, world_from_object) = p.instance?;
            (instance == hit.instance).then_some(world_from_object)
        });
        let point = placed.map_or(point, |m| m.inverse().transform_point3(point));
        let (fragment, node) = self.trees[tree as usize]
            .bsp
            .locate(first + hit.triangle, point)?;
        Some(Located {
            tree,
            fragment,
            node,
            depth: self.trees[tree as usize].bsp.nodes()[node as usize].depth(),
        })
    }
}

impl PolygonBsp {
    /// The fragment of this triangle's polygon in which the point lies, and its node. Of several within rounding, that on the point's computed side.
    pub fn locate(&self, triangle: u32, point: DVec3) -> Option<(u32, u32)> {
        if self.left_out.binary_search(&triangle).is_ok() {
            return None;
        }
        // The likelier side of each plane is looked at first; the other in the order of its distance, so that rounding leads astray only if it must.
        let mut others = Vec::new();
        let mut at = (!self.nodes.is_empty()).then_some(0);
        loop {
            while let Some(number) = at {
                let node = &self.nodes[number as usize];
                let holds = |f: &u32| self.fragments[*f as usize].triangles.contains(&triangle);
                if let Some(fragment) = node.fragments().find(holds) {
                    return Some((fragment, number));
                }
                at = node.plane().and_then(|plane| {
                    let plane = self.plane(plane);
                    let to_point = point - plane.points()[0].as_dvec3();
                    let height = plane.normal().0.dot(to_point);
                    let (near, far) = if height > 0.0 {
                        (node.front(), node.back())
                    } else {
                        (node.back(), node.front())
                    };
                    others.extend(far.map(|f| (height.abs(), f)));
                    near
                });
            }
            let closest =
                (0..others.len()).min_by(|&i, &j| f64::total_cmp(&others[i].0, &others[j].0))?;
            at = Some(others.swap_remove(closest).1);
        }
    }
}
