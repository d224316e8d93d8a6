//! How the polygon BSP divides what the eye sees: the fragment of each hit, and how deep in the tree it is.

use glam::Vec3;

use super::stage::Stage;
use super::surface::Surface;
use crate::geometry::Ray;
use crate::picture::palette;

/// The fragment of the polygon BSP in which a surface is met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FragmentPoint {
    /// Its number, those of all trees of the scene counted on. Instances of one mesh share theirs.
    pub number: u32,
    /// Nodes above its node: 0 for the root.
    pub depth: u32,
}

/// Share of a colour that stays where a surface is seen edge-on. Less: more shape; more: colours that are told apart more easily.
const EDGE_ON: f32 = 0.45;

/// What shows hits that are in no fragment, and all where the stage has no trees.
const UNDIVIDED: Vec3 = Vec3::splat(0.2);

impl FragmentPoint {
    /// The fragment at a surface; `None` where the stage has no trees.
    pub fn at(stage: &Stage, surface: &Surface) -> Option<Self> {
        let trees = stage.trees?;
        let located = trees.locate(&surface.hit, surface.position.as_dvec3())?;
        Some(Self {
            number: trees.fragment_number(&located),
            depth: located.depth,
        })
    }

    /// The fragment's own colour, linear.
    pub fn color(&self) -> Vec3 {
        palette::distinct(self.number).into()
    }
}

/// A colour a fragment, darker where the surface turns from the eye.
pub(super) fn fragment(stage: &Stage, ray: &Ray, surface: &Surface) -> Vec3 {
    let color = FragmentPoint::at(stage, surface).map_or(UNDIVIDED, |f| f.color());
    color * light(ray, surface)
}

/// The depth of the fragment's node, from violet for the root to yellow for the deepest node of the scene's trees. Each doubling of the depth is the same step of colour:
/// a round part makes a chain of nodes much deeper than everything else.
pub(super) fn depth(stage: &Stage, ray: &Ray, surface: &Surface) -> Vec3 {
    let color = FragmentPoint::at(stage, surface).map_or(UNDIVIDED, |f| {
        palette::ramp(share_of_depth(f.depth, stage.deepest_node)).into()
    });
    color * light(ray, surface)
}

/// 0 for a root, 1 for the deepest node.
fn share_of_depth(depth: u32, deepest: u32) -> f32 {
    let level = |depth: u32| libm::log2(f64::from(depth) + 1.0);
    (level(depth) / level(deepest.max(1))) as f32
}

/// The cosine between the surface and the view, softened.
fn light(ray: &Ray, surface: &Surface) -> f32 {
    let view = ray.direction.normalize_or(Vec3::NEG_Z);
    let cosine = -surface.geometric_normal.dot(view);
    EDGE_ON + (1.0 - EDGE_ON) * cosine.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bsp::polygon::SceneTrees;
    use crate::accel::{AcceleratorKind, BspOrder, BuildOptions};
    use crate::render::SkyMode;

    #[test]
    fn a_ray_sees_the_fragment_that_it_hits_if_there_are_trees() {
        let scene = crate::import::load(&["models/lecture-block.obj".into()]).unwrap();
        let accelerator = AcceleratorKind::Linear.build(&scene);
        let options = BuildOptions {
            order: BspOrder::File,
            ..BuildOptions::default()
        };
        let trees = SceneTrees::build(&scene, &options);
        // #8 is cut by the plane of #3: 8a behind it, the deepest, and 8b in front.
        for (y, name, depth) in [(0.5, "8a", 6), (1.5, "8b", 5)] {
            let ray = Ray::new(Vec3::new(0.5, y, -2.0), Vec3::Z);
            let hit = accelerator.closest_hit(&ray).unwrap();
            let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Auto);
            let surface = Surface::at(&stage, &ray, hit);
            assert_eq!(FragmentPoint::at(&stage, &surface), None);
            assert_eq!(fragment(&stage, &ray, &surface), UNDIVIDED);
            let stage = stage.with_trees(Some(&trees));
            let point = FragmentPoint::at(&stage, &surface).unwrap();
            assert_eq!(trees.trees()[0].bsp.name(point.number), name);
            assert_eq!(point.depth, depth);
            assert_eq!(fragment(&stage, &ray, &surface), point.color());
        }
    }

    #[test]
    fn depths_fill_the_ramp_by_doublings() {
        assert_eq!([0, 15].map(|d| share_of_depth(d, 15)), [0.0, 1.0]);
        assert_eq!([1, 3].map(|d| share_of_depth(d, 15)), [0.25, 0.5]);
        assert_eq!(share_of_depth(0, 0), 0.0);
    }
}
