//! The trees of a scene: one in world space for all meshes that are placed once, and one in object space for each mesh that is placed several times.

use glam::{DAffine3, DVec3};

use super::tree::PolygonBsp;
use crate::accel::bake::{self, Baked};
use crate::accel::bsp::options::BuildOptions;
use crate::accel::hit::Hit;
use crate::accel::names::Names;
use crate::scene::Scene;

/// The polygon BSPs of a scene, as [`AcceleratorKind::BspPolygon`](crate::accel::AcceleratorKind::BspPolygon) builds them, to be looked at.
#[derive(Clone, Debug)]
pub struct SceneTrees {
    trees: Vec<SceneTree>,
    placements: Vec<PlacedTree>,
    /// By instance; `None` for those without triangles.
    places: Vec<Option<Place>>,
}

/// Where an instance's triangles are.
#[derive(Clone, Copy, Debug)]
struct Place {
    tree: u32,
    /// Number of its first triangle in the tree.
    first: u32,
    /// The way into the tree's space; `None` from world space to itself.
    object_from_world: Option<DAffine3>,
}

/// A tree, and the names of its triangles.
#[derive(Clone, Debug)]
pub struct SceneTree {
    /// The tree.
    pub bsp: PolygonBsp,
    names: Names,
    /// Fragments of the trees before it.
    first_fragment: u32,
}

impl SceneTree {
    /// The name of a triangle of the tree: instance, and triangle in the mesh. The instance is 0 in a tree that is placed several times.
    pub fn name(&self, triangle: u32) -> (u32, u32) {
        self.names.name(triangle)
    }
}

/// A tree in its place.
#[derive(Clone, Debug)]
pub struct PlacedTree {
    /// Which of the trees.
    pub tree: u32,
    /// The instance and its `world_from_object`; `None` for the tree in world space.
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
        for &(first, named) in Names::of(&baked.sets[set]).instances() {
            let instance = placement.instance.as_ref().map_or(named, |i| i.index);
            let of_mesh = scene.mesh_of(instance).outlines.iter();
            outlines[set].extend(of_mesh.map(|o| (first + o.first_triangle, o.triangle_count)));
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
        let mut trees = Vec::with_capacity(baked.sets.len());
        let mut first_fragment = 0;
        for (set, outlines) in baked.sets.into_iter().zip(outlines) {
            let triangles = set.iter().map(|t| t.triangle).collect();
            let bsp = PolygonBsp::build(triangles, &outlines, options);
            let names = Names::of(&set);
            let fragments = bsp.fragments().len() as u32;
            trees.push(SceneTree {
                bsp,
                names,
                first_fragment,
            });
            first_fragment += fragments;
        }
        let mut places = vec![None; scene.instances.len()];
        let mut placements = Vec::with_capacity(baked.placements.len());
        for placement in &baked.placements {
            let tree = placement.set;
            match &placement.instance {
                Some(instance) => {
                    places[instance.index as usize] = Some(Place {
                        tree,
                        first: 0,
                        object_from_world: Some(instance.object_from_world),
                    });
                }
                None => {
                    for &(first, instance) in trees[tree as usize].names.instances() {
                        places[instance as usize] = Some(Place {
                            tree,
                            first,
                            object_from_world: None,
                        });
                    }
                }
            }
            let instance = placement.instance.as_ref();
            placements.push(PlacedTree {
                tree,
                instance: instance.map(|i| (i.index, i.world_from_object)),
            });
        }
        Self {
            trees,
            placements,
            places,
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

    /// Nodes on the longest way from a root, both ends included, over all trees.
    pub fn depth(&self) -> u32 {
        let depths = self.trees.iter().map(|t| t.bsp.stats().depth);
        depths.max().unwrap_or(0)
    }

    /// The fragment's number when those of all trees are counted on, from 0.
    pub fn fragment_number(&self, located: &Located) -> u32 {
        self.trees[located.tree as usize].first_fragment + located.fragment
    }

    /// The fragment that was hit, `point` being the place in world space. In a cut, which belongs to two fragments, and within rounding of one, either.
    /// `None` for a hit that is not of this scene, and for a triangle without area.
    pub fn locate(&self, hit: &Hit, point: DVec3) -> Option<Located> {
        let place = (*self.places.get(hit.instance as usize)?)?;
        let in_tree = place
            .object_from_world
            .map_or(point, |m| m.transform_point3(point));
        let bsp = &self.trees[place.tree as usize].bsp;
        let (fragment, node) = bsp.locate(place.first + hit.triangle, in_tree)?;
        Some(Located {
            tree: place.tree,
            fragment,
            node,
            depth: bsp.nodes()[node as usize].depth(),
        })
    }
}

impl PolygonBsp {
    /// The fragment of this triangle's polygon in which the point lies, and its node. `None` if the triangle is in no node.
    ///
    /// The point, in the tree's space, lies in the triangle up to rounding. It goes down the tree by its computed side of each plane, until a node has a fragment of the triangle.
    /// Where rounding led it into a cell without one, the nearest plane that was passed is crossed: so the answer is wrong at most between fragments that the point is within rounding of.
    pub fn locate(&self, triangle: u32, point: DVec3) -> Option<(u32, u32)> {
        if self.left_out.binary_search(&triangle).is_ok() {
            return None;
        }
        // Distances from the planes that were passed, and what lies across.
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
