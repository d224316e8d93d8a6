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

/// The depth of the fragment's node, from violet for the root to yellow for the deepest node of the scene's trees.
pub(super) fn depth(stage: &Stage, ray: &Ray, surface: &Surface) -> Vec3 {
    let deepest = stage.deepest_node.max(1) as f32;
    let color = FragmentPoint::at(stage, surface).map_or(UNDIVIDED, |f| {
        palette::ramp(f.depth as f32 / deepest).into()
    });
    color * light(ray, surface)
}

/// The cosine between the surface and the view, softened.
fn light(ray: &Ray, surface: &Surface) -> f32 {
    let view = ray.direction.normalize_or(Vec3::NEG_Z);
    let cosine = -surface.geometric_normal.dot(view);
    EDGE_ON + (1.0 - EDGE_ON) * cosine.clamp(0.0, 1.0)
}
