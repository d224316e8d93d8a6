//! Triangles made ready for shading, and a store of those that were met last: neighbouring rays mostly meet the same ones.

use glam::{Vec2, Vec3};

use super::ray_cone::uv_width_per_length;
use super::stage::Stage;
use crate::accel::Hit;
use crate::geometry::{Facet, Triangle};

/// What all hits of a triangle have in common, in world space.
#[derive(Clone, Copy, Debug)]
pub(super) struct StagedFacet {
    pub(super) facet: Facet,
    /// Unit normal of the front; `None` for a triangle that its placement squashed to a line.
    pub(super) front: Option<Vec3>,
    pub(super) material: u32,
    /// How far along the normal a ray must start so as to leave the triangle behind, in model units.
    pub(super) offset: f32,
    /// As [`uv_width_per_length`], in the first set of texture coordinates; 0 where no texture is looked up.
    pub(super) uv_per_length: f32,
}

impl StagedFacet {
    pub(super) fn of(stage: &Stage, hit: Hit) -> Self {
        let scene = stage.scene;
        let instance = &scene.instances[hit.instance as usize];
        let staged = &stage.instances[hit.instance as usize];
        let mesh = &scene.meshes[instance.mesh as usize];
        let corners = mesh.triangles[hit.triangle as usize].map(|v| v as usize);
        let points = corners.map(|v| instance.world_point(mesh.positions[v]));
        let triangle = Triangle::new(points[0], points[1], points[2]);
        let facet = Facet::new(triangle);
        let material = scene.material_of(hit.instance, hit.triangle);
        let uv_set =
            (mesh.uv_sets.first()).filter(|_| stage.materials[material as usize].is_textured);
        let density = |set: &Vec<Vec2>| {
            uv_width_per_length(
                points,
                corners.map(|v| set.get(v).copied().unwrap_or_default()),
            )
        };
        Self {
            facet,
            front: facet
                .normal
                .map(|n| if staged.is_mirrored { -n } else { n }),
            material,
            offset: staged.offset(&triangle),
            uv_per_length: uv_set.map_or(0.0, density),
        }
    }
}

/// Triangles kept: a power of two. Those of a few neighbouring pixels; more would fill the first cache.
const KEPT: usize = 64;

/// The triangles of one stage that were met last.
#[derive(Debug, Default)]
pub(super) struct Facets {
    /// Each at the place that its name has; none before the first is asked for.
    slots: Vec<Option<(Name, StagedFacet)>>,
}

/// Instance and triangle.
type Name = (u32, u32);

impl Facets {
    /// The triangle of a hit.
    #[inline]
    pub(super) fn of(&mut self, stage: &Stage, hit: Hit) -> &StagedFacet {
        if self.slots.is_empty() {
            self.slots.resize(KEPT, None);
        }
        let name = (hit.instance, hit.triangle);
        // Objects of few triangles each have the same numbers: the factor, odd, keeps them apart.
        let place = hit.triangle.wrapping_add(hit.instance.wrapping_mul(13)) as usize % KEPT;
        let slot = &mut self.slots[place];
        if slot.as_ref().is_none_or(|(kept, _)| *kept != name) {
            *slot = None;
        }
        &slot
            .get_or_insert_with(|| (name, StagedFacet::of(stage, hit)))
            .1
    }
}
