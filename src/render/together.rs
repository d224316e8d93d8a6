//! Samples of neighbouring pixels taken together: their eye rays go the same way, and cost about half of what they cost one by one; so do the shadow
//! rays of [`Lit`].

use std::ops::{ControlFlow, Range};

use super::PixelRenderer;
use super::adaptive::Share;
use super::film::PixelRect;
use super::integrator::{Lit, Sample};
use super::sampler::Sampler;
use super::tracer::{RayKind, Tracer};
use crate::accel::Hit;
use crate::geometry::{LANES, Ray};

/// Edge of the squares of pixels whose rays are traced together.
pub(super) const BLOCK: u32 = 8;

/// Most samples of a pixel that are traced together. With those of a block they are 1,024 rays, as many as
/// `benches/record` has measured; they fit into the second cache.
pub(super) const TOGETHER: u32 = LANES as u32;

/// The samples of a block of pixels, and room for their rays.
#[derive(Debug, Default)]
pub(super) struct Together {
    places: Vec<(u32, u32)>,
    /// For each pixel.
    samples: usize,
    samplers: Vec<Sampler>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    has_hits: bool,
    lit: Lit,
}

impl Together {
    /// Begins samples of a share of a block's pixels, and traces their rays unless each has to be traced by itself.
    pub(super) fn trace(
        &mut self,
        pixel: &PixelRenderer,
        tracer: &mut Tracer,
        (block, share): (&PixelRect, Share),
        samples: Range<u32>,
    ) {
        self.places.clear();
        self.samplers.clear();
        self.rays.clear();
        self.samples = samples.len();
        for (x, y) in squares(block).filter(|&(x, y)| share.has(x, y)) {
            self.places.push((x, y));
            let (rays, samplers) = (&mut self.rays, &mut self.samplers);
            pixel.begin_all((x, y), samples.clone(), rays, samplers);
        }
        let traced = tracer.closest_together(&self.rays, &mut self.hits, RayKind::Eye);
        self.has_hits = traced.is_some();
    }

    /// Sees the samples to their end: each goes to `done` with its pixel, those of a pixel in their order, until `done` says to stop.
    pub(super) fn finish<'a>(
        &mut self,
        pixel: &PixelRenderer,
        tracer: &mut Tracer<'a>,
        mut done: impl FnMut(&mut Tracer<'a>, (u32, u32), Sample) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (stage, integrator) = (pixel.stage, pixel.options.integrator);
        let cone = super::eye_cone(pixel.camera, pixel.options);
        let (places, samples) = (&self.places, self.samples);
        let all = self.rays.iter().zip(&mut self.samplers);
        if !self.has_hits {
            for (index, (ray, sampler)) in all.enumerate() {
                let sample = pixel.finish(tracer, ray, sampler.clone(), cone);
                done(tracer, places[index / samples], sample)?;
            }
            return ControlFlow::Continue(());
        }
        let all = all.zip(&self.hits);
        if Lit::is_for(integrator, stage) {
            self.lit.clear();
            for ((ray, sampler), hit) in all {
                self.lit.push(stage, tracer, (ray, *hit), cone, sampler);
            }
            return self.lit.finish(tracer, |tracer, index, sample| {
                done(tracer, places[index / samples], sample)
            });
        }
        for (index, ((ray, sampler), hit)) in all.enumerate() {
            let sample = integrator.sample(stage, tracer, (*ray, *hit), cone, sampler);
            done(tracer, places[index / samples], sample)?;
        }
        ControlFlow::Continue(())
    }
}

/// The pixels of a block, square by square within squares (Morton's order), so that the rays of any stretch of them are close to one another.
fn squares(block: &PixelRect) -> impl Iterator<Item = (u32, u32)> + use<> {
    let block = *block;
    let every_other = |i: u32| i & 1 | i >> 1 & 2 | i >> 2 & 4;
    let places = (0..BLOCK * BLOCK).map(move |i| (every_other(i), every_other(i >> 1)));
    places
        .filter(move |(x, y)| *x < block.width && *y < block.height)
        .map(move |(x, y)| (block.x + x, block.y + y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_have_every_pixel_of_a_block_once() {
        for (width, height) in [(BLOCK, BLOCK), (3, 8), (8, 1), (5, 6)] {
            let block = PixelRect {
                x: 16,
                y: 40,
                width,
                height,
            };
            let mut found: Vec<_> = squares(&block).collect();
            found.sort_by_key(|&(x, y)| (y, x));
            assert_eq!(found, block.pixels().collect::<Vec<_>>());
        }
    }
}
