//! Rays by which `auto` chooses extents: a coarse grid of eye rays, and one ray onwards from each of their hits.
//!
//! All numbers come from a fixed sequence, and costs are counted: the same scene, view and options give the same plan on every machine with the same
//! instructions (the wide BSP counts its steps by these).

use glam::{DVec3, Vec3};

use super::choice::ExtentSet;
use super::screen::View;
use super::study::ObjectStudy;
use super::trace::ExtentsLoop;
use crate::accel::Trace;
use crate::accel::counters::Uncounted;
use crate::geometry::{Aabb, Ray, RayOrigin};
use crate::scene::Scene;

/// Most eye rays. More: better plans for small objects, at a build time that grows with them.
const MOST_RAYS: usize = 2048;

/// Least eye rays, for scenes of many objects.
const LEAST_RAYS: usize = 64;

/// Visits of objects up to which all eye rays are sent.
const MOST_VISITS: usize = 1 << 20;

/// Cost, in the unit of the table, after which no more rays are sent: a tenth of a second. It bounds the time that a plan takes where full tests are very expensive.
const MOST_COST: f64 = 1e8;

/// Rays that are looked at between two looks at the cost.
const ROUND: usize = 32;

/// Numbers in 0..1 (SplitMix64; Steele, Lea, Flood 2014).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly on the unit sphere.
    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let angle = std::f64::consts::TAU * self.next();
        let across = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(across * libm::cos(angle), across * libm::sin(angle), z)
    }
}

/// What probe rays cost at each object. Without a view they come from around the scene.
pub(super) fn study(
    scene: &Scene,
    objects: &ExtentsLoop,
    view: Option<&View>,
    bounds: &Aabb,
) -> Vec<ObjectStudy> {
    let count = (MOST_VISITS / objects.objects().len().max(1)).clamp(LEAST_RAYS, MOST_RAYS);
    let mut numbers = Numbers(1);
    let first = match view {
        Some(view) => eye_rays(view, count, &mut numbers),
        None => around(bounds, count, &mut numbers),
    };
    let mut studies = objects.study(&[], true);
    let mut spent = 0.0;
    // Every round is spread over the whole list.
    let rounds = first.len().div_ceil(ROUND);
    for round in 0..rounds {
        let rays: Vec<Ray> = first.iter().skip(round).step_by(rounds).copied().collect();
        let onwards = rays
            .iter()
            .filter_map(|ray| onward(scene, objects, ray, &mut numbers));
        let onwards: Vec<Ray> = onwards.collect();
        for rays in [&rays, &onwards] {
            for (study, more) in studies.iter_mut().zip(objects.study(rays, true)) {
                spent += more.cost(ExtentSet::NONE) * more.rays() as f64;
                study.add(&more);
            }
        }
        if spent > MOST_COST {
            break;
        }
    }
    studies
}

/// One ray through each cell of a grid of the picture.
fn eye_rays(view: &View, count: usize, numbers: &mut Numbers) -> Vec<Ray> {
    let (width, height) = view.size;
    let pixels = f64::from(width) * f64::from(height);
    let cell = (pixels / count as f64).sqrt().max(1.0);
    let cells = |side: u32| (f64::from(side) / cell).ceil() as u32;
    let mut rays = Vec::new();
    for row in 0..cells(height) {
        for column in 0..cells(width) {
            let place = |cell_number: u32, share: f64, side: u32| {
                (((f64::from(cell_number) + share) * cell) as u32).min(side - 1)
            };
            let x = place(column, numbers.next(), width);
            let y = place(row, numbers.next(), height);
            let at = |pixel: u32| f64::from(pixel) + 0.5;
            rays.push(view.camera.ray(at(x), at(y), Some((x, y))));
        }
    }
    rays
}

/// From a sphere around the scene to points in its box.
fn around(bounds: &Aabb, count: usize, numbers: &mut Numbers) -> Vec<Ray> {
    if bounds.is_empty() {
        return Vec::new();
    }
    let (center, size) = (bounds.center().as_dvec3(), bounds.extent().as_dvec3());
    let ray = |_| {
        let from = center + numbers.direction() * f64::from(bounds.diagonal());
        let share = DVec3::new(numbers.next(), numbers.next(), numbers.next());
        let to = bounds.min.as_dvec3() + size * share;
        Ray::new(from.as_vec3(), (to - from).normalize_or_zero().as_vec3())
    };
    (0..count).map(ray).collect()
}

/// From what the ray meets into the half space above the surface.
fn onward(scene: &Scene, objects: &ExtentsLoop, ray: &Ray, numbers: &mut Numbers) -> Option<Ray> {
    let hit = objects.trace_closest(ray, &mut Uncounted)?;
    let instance = &scene.instances[hit.instance as usize];
    let triangle = scene.mesh_of(hit.instance).triangle(hit.triangle);
    let [a, b, c] = triangle
        .corners()
        .map(|p| instance.world_point(p).as_dvec3());
    let normal = (b - a).cross(c - a);
    let facing = |v: DVec3, to: DVec3| if v.dot(to) < 0.0 { -v } else { v };
    let normal = facing(normal, -ray.direction.as_dvec3());
    let direction = facing(numbers.direction(), normal).as_vec3();
    // A little before the surface: some of single precision's digits are lost to it, and a plan needs none of them.
    let place: Vec3 = ray.at(hit.t * (1.0 - 1e-4));
    let source = RayOrigin {
        depth: ray.source.depth + 1,
        pixel: None,
    };
    Some(Ray {
        source,
        ..Ray::new(place, direction)
    })
}
