//! How fine the images of a scene are seen, before they are read: levels of detail that no lookup wants need not be kept.
//!
//! A ray's cone never gets narrower ([`RayCone`]: bounces only add to its spread), so where a path meets a triangle it is as wide as after the whole way, which is no shorter than the straight
//! one from the eye, however many mirrors are between. That width on the triangle nearest to the eye for its texture coordinates is the least that is ever looked up. Lookups that
//! want the finest detail whatever the distance, of alpha and of emitted light, keep their images whole.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::integrator::Integrator;
use super::ray_cone::{RayCone, uv_width_per_length};
use super::{RenderOptions, eye_cone};
use crate::geometry::{Aabb, Triangle};
use crate::scene::{
    AlphaMode, CameraFrame, ColorSpace, Filter, Instance, Material, Part, Scene, ShownDetail,
    TextureRef, TriangleMesh,
};

/// Triangles of a mesh, times its instances, up to which each is looked at where it is placed.
const MOST_PLACED: usize = 500_000;

/// Share of its distance up to which a triangle is small.
const NEARLY: f64 = 0.1;

/// Greatest share of a part's area of triangles whose texture coordinates are one point, if these are not to count.
const MOST_POINTS: f64 = 1e-4;

/// Share of a width that is left to rounding, where it is that of a box.
const ROUNDING: f64 = 1e-3;

/// The finest detail of each of the scene's images that pictures from these places show; `None` for those that have to be whole. The scene's images may still be without their pixels.
pub fn shown_detail(
    scene: &Scene,
    views: &[CameraFrame],
    options: &RenderOptions,
) -> Vec<Option<ShownDetail>> {
    // Shadow rays of this one look at what they pass, and layers are of rays without a width.
    let is_whitted = matches!(options.integrator, Integrator::Whitted { .. });
    let has_shadows_of_glass =
        is_whitted && scene.materials.iter().any(|m| m.transmission.is_some());
    if has_shadows_of_glass || options.wants_layers || views.is_empty() {
        return vec![None; scene.images.len()];
    }
    let slots: Vec<Slots> = scene
        .materials
        .iter()
        .map(|m| Slots::new(scene, m))
        .collect();
    let eyes: Vec<Eye> = views.iter().map(|view| Eye::new(view, options)).collect();
    let mut placed: Vec<Vec<&Instance>> = vec![Vec::new(); scene.meshes.len()];
    for instance in &scene.instances {
        placed[instance.mesh as usize].push(instance);
    }
    let meshes = scene.meshes.par_iter().zip(placed).with_max_len(1);
    meshes.for_each(|(mesh, instances)| {
        let look = Look {
            scene,
            mesh,
            slots: &slots,
            eyes: &eyes,
        };
        if instances
            .iter()
            .all(|instance| look.parts(instance).is_empty())
        {
            return;
        }
        match mesh.triangles.len() * instances.len() <= MOST_PLACED {
            true => instances
                .par_iter()
                .for_each(|instance| look.at_triangles(instance)),
            false => look.at_boxes(&instances),
        }
    });
    detail(scene, &slots)
}

/// Where rays start, and how wide they are.
struct Eye {
    place: DVec3,
    cone: RayCone,
    /// How far from the place they start at most.
    radius: f64,
}

impl Eye {
    fn new(view: &CameraFrame, options: &RenderOptions) -> Self {
        Self {
            place: view.world_from_camera()[3],
            cone: eye_cone(view, options),
            radius: view.lens().map_or(0.0, |lens| lens.radius),
        }
    }

    /// Least width of a ray that has gone `distance` at least from the place.
    fn width(&self, distance: f64) -> f32 {
        let distance = (distance - self.radius).max(0.0);
        self.cone.propagated(distance as f32).footprint(1.0)
    }
}

/// What a material looks up of its textures.
#[derive(Default)]
struct Slots {
    /// With the least width so far, in units of the texture's own coordinates, as bits: those of numbers that are not negative sort as the numbers do.
    filtered: Vec<(ColorSpace, TextureRef, AtomicU32)>,
    /// The sets of texture coordinates of these, each once.
    sets: Vec<u32>,
    /// Whatever the width is.
    finest: Vec<TextureRef>,
}

impl Slots {
    fn new(scene: &Scene, material: &Material) -> Self {
        let is_filtered = |texture: &TextureRef| {
            scene.textures[texture.texture as usize].filter == Filter::Linear
        };
        let alpha = [
            material.base_color_texture,
            material.opacity.map(|o| o.texture),
        ];
        let alpha = alpha
            .into_iter()
            .filter(|_| material.alpha_mode != AlphaMode::Opaque);
        let finest: Vec<TextureRef> = alpha.chain([material.emissive_texture]).flatten().collect();
        let (filtered, unfiltered): (Vec<_>, Vec<_>) = (material.texture_slots().into_iter())
            .filter(|(_, texture)| !finest.contains(texture))
            .partition(|(_, texture)| is_filtered(texture));
        let mut sets: Vec<u32> = filtered.iter().map(|(_, t)| t.uv_set).collect();
        sets.sort_unstable();
        sets.dedup();
        let unseen = || AtomicU32::new(f32::INFINITY.to_bits());
        Self {
            filtered: (filtered.into_iter())
                .map(|(space, t)| (space, t, unseen()))
                .collect(),
            sets,
            finest: (finest.into_iter())
                .chain(unfiltered.into_iter().map(|(_, t)| t))
                .collect(),
        }
    }

    /// Takes a patch of the surface that is so wide in a set of texture coordinates.
    fn meet(&self, set: u32, width: f32) {
        for (_, _, least) in self.filtered.iter().filter(|(_, t, _)| t.uv_set == set) {
            least.fetch_min(width.to_bits(), Ordering::Relaxed);
        }
    }
}

fn triangles(part: &Part) -> Range<usize> {
    let first = part.first_triangle as usize;
    first..first + part.triangle_count as usize
}

/// The patches of the triangles of a part in one set of texture coordinates.
struct Patches {
    /// Area of all triangles.
    area: f64,
    /// Of those whose coordinates are one point.
    points: f64,
    /// Least width of the patches of the others, in units of the coordinates.
    least: f32,
}

impl Patches {
    /// Those of triangles at these places, each seen by a patch as wide as `width` says.
    fn new(
        mesh: &TriangleMesh,
        part: &Part,
        set: u32,
        place: impl Fn(Vec3) -> Vec3,
        width: impl Fn([Vec3; 3]) -> f32,
    ) -> Self {
        let mut patches = Self {
            area: 0.0,
            points: 0.0,
            least: f32::INFINITY,
        };
        let coordinates = mesh.uv_sets.get(set as usize).filter(|set| !set.is_empty());
        for triangle in triangles(part) {
            let corners = mesh.triangles[triangle].map(|v| v as usize);
            let points = corners.map(|v| place(mesh.positions[v]));
            let [a, b, c] = points;
            let area = f64::from((b - a).cross(c - a).length());
            if area == 0.0 {
                // No ray hits it.
                continue;
            }
            patches.area += area;
            match coordinates.map(|set| corners.map(|v| set[v])) {
                Some([p, q, r]) if p == q && q == r => patches.points += area,
                Some(uvs) => {
                    let width = uv_width_per_length(points, uvs) * width(points);
                    // NaN counts as 0.
                    patches.least = patches.least.min(width.max(0.0));
                }
                None => patches.least = 0.0,
            }
        }
        patches
    }

    /// Width of the least that counts. Triangles whose coordinates are one point want the finest detail whatever the distance, which is right where they have the colour of a palette; but mostly
    /// they are a few slivers that exporters leave.
    fn least(&self) -> f32 {
        match self.points <= MOST_POINTS * self.area {
            true => self.least,
            false => 0.0,
        }
    }
}

/// All that is seen of one mesh.
struct Look<'a> {
    scene: &'a Scene,
    mesh: &'a TriangleMesh,
    /// By material.
    slots: &'a [Slots],
    eyes: &'a [Eye],
}

impl Look<'_> {
    /// The parts of an instance whose material looks textures up, under their numbers.
    fn parts(&self, instance: &Instance) -> Vec<(usize, Part, &Slots)> {
        let parts = self.scene.parts_of(instance).enumerate();
        let parts = parts.map(|(number, part)| (number, part, &self.slots[part.material as usize]));
        parts
            .filter(|(_, _, slots)| !slots.filtered.is_empty())
            .collect()
    }

    /// Least width of a ray from an eye to something, given its distance.
    fn width(&self, distance: impl Fn(DVec3) -> f64) -> f32 {
        let widths = self.eyes.iter().map(|eye| eye.width(distance(eye.place)));
        widths.fold(f32::INFINITY, f32::min)
    }

    /// Looks at every triangle of an instance: the width of the patch is that of a ray that goes straight to its nearest point.
    fn at_triangles(&self, instance: &Instance) {
        let width = |[a, b, c]: [Vec3; 3]| {
            // All of it is as near to a corner as its edges there are long: that is enough where it is far.
            let reach = (b - a).length_squared().max((c - a).length_squared());
            let reach = f64::from(reach.sqrt());
            self.width(|eye| {
                let distance = a.as_dvec3().distance(eye);
                match reach < NEARLY * distance {
                    true => distance - reach,
                    false => Triangle::new(a, b, c).squared_distance(eye).sqrt(),
                }
            })
        };
        let parts = self.parts(instance).into_par_iter().with_max_len(1);
        parts.for_each(|(_, part, slots)| {
            for &set in &slots.sets {
                let place = |point| instance.world_point(point);
                slots.meet(
                    set,
                    Patches::new(self.mesh, &part, set, place, width).least(),
                );
            }
        });
    }

    /// Looks at the boxes of the parts of instances, and at the largest texels of each.
    fn at_boxes(&self, instances: &[&Instance]) {
        let of_part = |part: &Part| {
            let corners = triangles(part).flat_map(|t| self.mesh.triangles[t]);
            let bounds: Aabb = corners.map(|v| self.mesh.positions[v as usize]).collect();
            let density = |set| Patches::new(self.mesh, part, set, |point| point, |_| 1.0).least();
            let sets = 0..self.mesh.uv_sets.len() as u32;
            (bounds, sets.map(density).collect())
        };
        let of_parts: Vec<(Aabb, Vec<f32>)> = self.mesh.parts.par_iter().map(of_part).collect();
        instances.par_iter().for_each(|instance| {
            let scale = instance.greatest_scale();
            for (number, _, slots) in self.parts(instance) {
                let (bounds, densities) = &of_parts[number];
                let bounds = instance.world_bounds(bounds);
                let width = f64::from(self.width(|eye| bounds.distance(eye))) / scale;
                for &set in &slots.sets {
                    let density = densities.get(set as usize).copied().unwrap_or(0.0);
                    slots.meet(set, (width * f64::from(density) * (1.0 - ROUNDING)) as f32);
                }
            }
        });
    }
}

/// What the slots want of each image.
fn detail(scene: &Scene, slots: &[Slots]) -> Vec<Option<ShownDetail>> {
    let image = |texture: &TextureRef| scene.textures[texture.texture as usize].image as usize;
    let mut is_whole = vec![false; scene.images.len()];
    let mut shown: Vec<Option<ShownDetail>> = vec![None; scene.images.len()];
    for slots in slots {
        for texture in &slots.finest {
            is_whole[image(texture)] = true;
        }
        for (space, texture, least) in &slots.filtered {
            let scale = texture.transform.matrix2.determinant().abs().sqrt();
            let width = f32::from_bits(least.load(Ordering::Relaxed)) * scale;
            let known = &mut shown[image(texture)];
            match known {
                Some(known) if known.space == *space => known.width = known.width.min(width),
                Some(_) => is_whole[image(texture)] = true,
                None => {
                    *known = Some(ShownDetail {
                        width,
                        space: *space,
                    })
                }
            }
        }
    }
    let shown = shown.into_iter().zip(is_whole);
    shown
        .map(|(shown, is_whole)| shown.filter(|_| !is_whole))
        .collect()
}

#[cfg(test)]
mod tests;
