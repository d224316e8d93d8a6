//! Eye rays that are traced together: those of neighbouring pixels go the same way, and cost about half of what they cost one by one.

use std::ops::Range;

use super::PixelRenderer;
use super::film::PixelRect;
use super::sampler::Sampler;
use super::tracer::{RayKind, Tracer};
use crate::accel::Hit;
use crate::geometry::Ray;

/// Edge of the squares of pixels whose rays are traced together.
pub(super) const BLOCK: u32 = 8;

/// Most samples of a pixel that are traced together. With those of a block they are 1,024 rays, as many as
/// `benches/record` has measured; they fit into the second cache.
pub(super) const TOGETHER: u32 = 16;

/// A sample whose eye ray is known.
#[derive(Clone, Debug)]
pub(super) struct Begun {
    pub(super) ray: Ray,
    /// What the ray meets, if that is known already.
    pub(super) hit: Option<Option<Hit>>,
    /// The numbers that are left.
    pub(super) sampler: Sampler,
}

/// The samples of a block of pixels, and room for their rays.
#[derive(Debug, Default)]
pub(super) struct Together {
    places: Vec<(u32, u32)>,
    samplers: Vec<Sampler>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    has_hits: bool,
}

impl Together {
    /// Begins samples of all pixels of a block, and traces their rays unless each has to be traced by itself.
    pub(super) fn trace(
        &mut self,
        pixel: &PixelRenderer,
        tracer: &mut Tracer,
        block: &PixelRect,
        samples: Range<u32>,
    ) {
        self.places.clear();
        self.samplers.clear();
        self.rays.clear();
        for place in block.pixels() {
            for sample in samples.clone() {
                let begun = pixel.begin(place.0, place.1, sample);
                self.places.push(place);
                self.samplers.push(begun.sampler);
                self.rays.push(begun.ray);
            }
        }
        let traced = tracer.closest_together(&self.rays, &mut self.hits, RayKind::Eye);
        self.has_hits = traced.is_some();
    }

    /// The samples, pixel by pixel, those of each in their order.
    pub(super) fn begun(&self) -> impl Iterator<Item = ((u32, u32), Begun)> {
        (0..self.rays.len()).map(|index| {
            let begun = Begun {
                ray: self.rays[index],
                hit: self.has_hits.then(|| self.hits[index]),
                sampler: self.samplers[index].clone(),
            };
            (self.places[index], begun)
        })
    }
}
