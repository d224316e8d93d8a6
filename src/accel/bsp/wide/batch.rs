//! Many rays at once: groups that go about the same way walk together, the others alone.
//!
//! The answers are those of each ray alone. In a tree with axes of its own, and by tests that are not exact, every ray goes alone.

use super::simd::{self, Found, GROUP};
use super::{WideSet, WideTest};
use crate::accel::TraceSet;
use crate::accel::counters::Uncounted;
use crate::accel::hit::Hit;
use crate::geometry::Ray;

impl<T: WideTest> WideSet<T> {
    /// Every ray walks alone.
    fn goes_alone(&self) -> bool {
        !T::WALKS_TOGETHER || self.reach.axes.is_some()
    }

    /// The nearest hits, as many as rays.
    pub(super) fn closest_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let mut found = [Found::NOTHING; GROUP];
        for (rays, hits) in rays.chunks(GROUP).zip(hits.chunks_mut(GROUP)) {
            let found = &mut found[..rays.len()];
            let alone = if self.goes_alone() {
                u64::MAX
            } else {
                simd::closest_together(self.instructions, self.tree(), rays, found)
            };
            for (index, (hit, found)) in hits.iter_mut().zip(&*found).enumerate() {
                *hit = if alone >> index & 1 != 0 {
                    self.closest_alone(&rays[index], &mut Uncounted)
                } else {
                    self.hit(found)
                };
            }
        }
    }

    /// Whether anything is hit, as many answers as rays.
    pub(super) fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        for (rays, hits) in rays.chunks(GROUP).zip(hits.chunks_mut(GROUP)) {
            let alone = if self.goes_alone() {
                u64::MAX
            } else {
                simd::any_together(self.instructions, self.tree(), rays, hits)
            };
            for (index, (ray, hit)) in rays.iter().zip(hits).enumerate() {
                if alone >> index & 1 != 0 {
                    *hit = if ray.behind.is_some() {
                        self.closest_alone(ray, &mut Uncounted).is_some()
                    } else {
                        self.any_alone(ray, &mut Uncounted)
                    };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Growth;
    use super::super::simd::Instructions;
    use super::super::tests::{Numbers, rays, set, set_along, set_grown, turned};
    use super::*;
    use crate::accel::BspQuality;
    use crate::geometry::Interval;
    use glam::Vec3;

    /// Tiles of 8 x 8 pixels seen from near and far, along and across the axes; and the ways from there to a light.
    fn coherent_rays() -> Vec<Ray> {
        let mut numbers = Numbers(13);
        let mut rays = Vec::new();
        for tile in 0..48 {
            let distance = [0.1, 2.0, 40.0, 3e5][tile % 4];
            let width = [1e-4, 0.02, 0.3, 2.0][tile / 4 % 4];
            let scale = [1.0, 1e-9, 3e8][tile % 3];
            let (mut eye, mut to) = (distance * numbers.point(), 0.5 * numbers.point());
            if tile % 5 == 0 {
                (eye, to) = (eye.with_x(0.0), to.with_x(0.0));
            }
            let mut shadows = Vec::new();
            let (right, up) = (to - eye).any_orthonormal_pair();
            for pixel in 0..64 {
                let (x, y) = ((pixel % 8) as f32 / 8.0, (pixel / 8) as f32 / 8.0);
                let target = to + width * (x * right + y * up);
                let ray = Ray::new(eye, (target - eye) * scale);
                let end = [f32::INFINITY, 1.0 / scale, 0.9 / scale][tile % 3];
                rays.push(ray.within(Interval::new(0.0, end)));
                let light = Vec3::new(0.3, 3.0, -0.2);
                if tile % 2 == 0 {
                    shadows.push(Ray::new(target, light - target).within(Interval::new(0.0, 1.0)));
                }
            }
            rays.extend(shadows);
        }
        rays
    }

    /// Rays among the coherent ones that are not traceable, continue behind a hit, or go another way.
    fn hostile_rays(tree: &WideSet) -> Vec<Ray> {
        let mut rays = coherent_rays();
        rays.truncate(2048);
        for (i, ray) in rays.iter_mut().enumerate() {
            let hit = tree.closest_alone(ray, &mut Uncounted);
            match i % 23 {
                0 => ray.origin.y = f32::NAN,
                2 => ray.direction = Vec3::ZERO,
                4 => ray.direction.z = f32::NAN,
                6 => ray.direction *= -1.0,
                8 => ray.interval.min = ray.interval.max,
                9 => ray.interval = Interval::new(1.0, f32::NAN),
                11 => ray.interval = Interval::new(f32::NEG_INFINITY, f32::INFINITY),
                13 => ray.origin *= 1e20,
                15 => ray.direction.x = [0.0, -0.0, 1e-40, f32::INFINITY][i % 4],
                17 => {
                    if let Some(hit) = hit {
                        *ray = ray.behind(hit.t, (hit.instance, hit.triangle));
                    }
                }
                19 => {
                    if let Some(hit) = hit {
                        ray.interval.max = hit.t;
                    }
                }
                _ => {}
            }
        }
        rays
    }

    #[test]
    fn many_rays_have_the_answers_of_each() {
        let cases = [
            (None, Growth::Whole),
            (None, Growth::Reached),
            (Some(turned()), Growth::Whole),
        ];
        for (axes, growth) in cases {
            let whole = set_along(axes, BspQuality::Default);
            compare(set_grown(axes, BspQuality::Default, growth), &whole);
        }
    }

    fn compare(mut tree: WideSet, whole: &WideSet) {
        for rays in [coherent_rays(), rays(), hostile_rays(whole)] {
            let truth: Vec<Option<Hit>> = rays
                .iter()
                .map(|ray| whole.closest_alone(ray, &mut Uncounted))
                .collect();
            for instructions in Instructions::available() {
                tree.instructions = instructions;
                for size in [1, 7, 8, 9, 17, 64, 1024] {
                    for (rays, truth) in rays.chunks(size).zip(truth.chunks(size)) {
                        let mut hits = vec![None; rays.len()];
                        tree.closest_batch(rays, &mut hits);
                        for ((ray, hit), truth) in rays.iter().zip(&hits).zip(truth) {
                            assert_eq!(hit, truth, "{instructions:?} {size} {ray:?}");
                        }
                        let mut flags = vec![true; rays.len()];
                        tree.any_batch(rays, &mut flags);
                        for ((ray, flag), truth) in rays.iter().zip(&flags).zip(truth) {
                            assert_eq!(*flag, truth.is_some(), "{instructions:?} {size} {ray:?}");
                        }
                    }
                }
            }
        }
        tree.closest_batch(&[], &mut []);
        tree.any_batch(&[], &mut []);
    }

    #[test]
    fn rays_of_a_tile_walk_together_and_scattered_ones_alone() {
        let tree = set(BspQuality::Default);
        let alone = |rays: &[Ray]| {
            let mut flags = [false; GROUP];
            let chunks = rays.chunks_exact(GROUP);
            let alone = chunks.map(|rays| {
                let alone = simd::any_together(tree.instructions, tree.tree(), rays, &mut flags);
                alone.count_ones() as usize
            });
            alone.sum::<usize>() as f32 / rays.len() as f32
        };
        let (few, most) = (alone(&coherent_rays()), alone(&rays()));
        assert!(few < 0.5 && most > 0.9, "{few} {most}");
    }
}
