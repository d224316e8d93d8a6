//! The eye rays of samples: one by one, and those of a pixel at once, with the same numbers.

use std::ops::Range;

use glam::Vec3;

use super::PixelRenderer;
use super::sampler::Sampler;
use crate::geometry::{LANES, Ray, RayOrigin};
use crate::scene::Pinhole;

/// Samples of a pixel that are worth the work of all lanes.
const WORTH_ALL: usize = LANES / 4;

impl PixelRenderer<'_> {
    /// The eye ray of a sample, and the numbers that are left.
    #[inline(always)]
    pub(super) fn begin(&self, x: u32, y: u32, sample: u32) -> (Ray, Sampler) {
        let options = self.options;
        let mut sampler = Sampler::among(x, y, sample, options.samples, options.seed);
        let (dx, dy) = options.filter.sample(sampler.next_2d());
        let (column, row) = (f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy);
        let ray = if self.camera.lens().is_some() {
            self.camera.lens_ray(column, row, sampler.next_2d())
        } else {
            self.camera.ray(column, row, Some((x, y)))
        };
        (ray, sampler)
    }

    /// Appends what [`PixelRenderer::begin`] has for each of a pixel's samples.
    #[inline]
    pub(super) fn begin_all(
        &self,
        (x, y): (u32, u32),
        samples: Range<u32>,
        rays: &mut Vec<Ray>,
        samplers: &mut Vec<Sampler>,
    ) {
        if let Some(pinhole) = self.camera.pinhole()
            && (WORTH_ALL..=LANES).contains(&samples.len())
        {
            self.begin_in_lanes(&pinhole, (x, y), samples, rays, samplers);
            return;
        }
        for sample in samples {
            let (ray, rest) = self.begin(x, y, sample);
            samplers.push(rest);
            rays.push(ray);
        }
    }

    fn begin_in_lanes(
        &self,
        pinhole: &Pinhole,
        (x, y): (u32, u32),
        samples: Range<u32>,
        rays: &mut Vec<Ray>,
        samplers: &mut Vec<Sampler>,
    ) {
        let options = self.options;
        // Lanes beyond the last sample have those that would follow.
        let mut all: [_; LANES] = std::array::from_fn(|lane| {
            let sample = samples.start + lane as u32;
            Sampler::among(x, y, sample, options.samples, options.seed)
        });
        let [u, v] = Sampler::next_2d_of_all(&mut all);
        let (mut columns, mut rows) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let (dx, dy) = options.filter.sample([u[lane], v[lane]]);
            columns[lane] = f64::from(x) + 0.5 + dx;
            rows[lane] = f64::from(y) + 0.5 + dy;
        }
        let [dx, dy, dz] = pinhole.directions(&columns, &rows);
        let ray = Ray {
            source: RayOrigin {
                depth: 0,
                pixel: Some((x, y)),
            },
            ..Ray::new(pinhole.eye(), Vec3::ZERO)
        };
        rays.extend((0..samples.len()).map(|lane| Ray {
            direction: Vec3::new(dx[lane], dy[lane], dz[lane]),
            ..ray
        }));
        samplers.extend_from_slice(&all[..samples.len()]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Integrator, PixelFilter, PixelRect, RenderOptions, SkyMode, Stage};
    use super::*;
    use crate::accel::AcceleratorKind;
    use crate::scene::{Camera, Lens, Projection, Scene};

    #[test]
    fn samples_begun_at_once_are_those_begun_one_by_one() {
        let scene = Scene::default();
        let accelerator = AcceleratorKind::Linear.build(&scene);
        let stage = Stage::new(&scene, &*accelerator, Vec3::Y, SkyMode::Off);
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 3.0),
            focal_point: Vec3::new(0.3, 0.2, -1.0),
            view_up: Vec3::Y,
            projection: Projection::Perspective { view_angle: 40.0 },
        };
        let pinhole = camera.frame(64, 48).expect("valid");
        let lens = pinhole.with_lens(Lens {
            radius: 0.1,
            focus_distance: 2.0,
        });
        for (camera, filter) in [
            (pinhole, PixelFilter::Box),
            (pinhole, PixelFilter::BlackmanHarris),
            (lens, PixelFilter::Box),
        ] {
            let options = RenderOptions {
                size: (64, 48),
                window: PixelRect {
                    x: 0,
                    y: 0,
                    width: 64,
                    height: 48,
                },
                samples: 50,
                seed: 3,
                integrator: Integrator::Direct,
                filter,
                counts_cost: false,
                wants_layers: false,
                noise: None,
            };
            let pixel = PixelRenderer {
                stage: &stage,
                camera: &camera,
                options: &options,
            };
            for samples in [0..1, 1..16, 16..32, 32..50] {
                let (mut rays, mut samplers) = (Vec::new(), Vec::new());
                pixel.begin_all((61, 17), samples.clone(), &mut rays, &mut samplers);
                assert_eq!(rays.len(), samples.len());
                for ((sample, ray), rest) in samples.zip(rays).zip(&mut samplers) {
                    let (want, mut wanted) = pixel.begin(61, 17, sample);
                    assert_eq!(ray, want);
                    assert_eq!(rest.next_2d(), wanted.next_2d());
                }
            }
        }
    }
}
