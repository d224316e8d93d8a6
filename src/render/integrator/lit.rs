//! Direct light of many samples: all their shadow rays are traced together. Every number is the same as one by one.

use std::ops::ControlFlow;

use glam::Vec3;

use super::direct::{self, Arriving};
use super::{Integrator, Radiance, Sample};
use crate::accel::Hit;
use crate::geometry::Ray;
use crate::render::ray_cone::RayCone;
use crate::render::sampler::Sampler;
use crate::render::stage::Stage;
use crate::render::surface::{MaterialPoint, Surface};
use crate::render::tracer::{RayKind, Tracer};

/// Samples of which only the answers of shadow rays are missing.
#[derive(Debug, Default)]
pub(in super::super) struct Lit {
    seen: Vec<Seen>,
    /// Of all samples, in their order.
    shadows: Vec<Ray>,
    /// For each shadow ray, the irradiance across it and the cosine at the surface.
    lights: Vec<(Vec3, f32)>,
    hits: Vec<bool>,
}

/// What a sample saw.
#[derive(Debug)]
enum Seen {
    /// Nothing but this.
    Backdrop(Vec3),
    /// An opaque surface.
    Surface {
        instance: u32,
        material: u32,
        point: MaterialPoint,
        normal: Vec3,
        /// How many of the shadow rays are its own.
        lights: u32,
    },
}

impl Lit {
    /// Whether samples can be taken so: those of direct light, where no surface lets any through.
    pub(in super::super) fn is_for(integrator: Integrator, stage: &Stage) -> bool {
        integrator == Integrator::Direct && !stage.has_alpha
    }

    /// Forgets all samples.
    pub(in super::super) fn clear(&mut self) {
        self.seen.clear();
        self.shadows.clear();
        self.lights.clear();
    }

    /// Adds a sample: what its eye ray met.
    pub(in super::super) fn push(
        &mut self,
        stage: &Stage,
        tracer: &mut Tracer,
        (ray, hit): (&Ray, Option<Hit>),
        cone: RayCone,
        sampler: &mut Sampler,
    ) {
        let Some(hit) = hit else {
            let backdrop = Integrator::Direct.backdrop(stage, ray);
            self.seen.push(Seen::Backdrop(backdrop));
            return;
        };
        let mut surface = Surface::kept(stage, &mut tracer.facets, ray, hit);
        // No further ray takes the cone over.
        if stage.materials[surface.material as usize].is_textured {
            surface.widen(ray, cone);
        }
        let point = surface.material_point(stage);
        let before = self.shadows.len();
        if !point.is_unlit {
            direct::lights(stage, ray, &surface, sampler, |arriving: Arriving| {
                self.shadows.push(arriving.shadow);
                self.lights.push((arriving.irradiance, arriving.cosine));
            });
        }
        self.seen.push(Seen::Surface {
            instance: hit.instance,
            material: surface.material,
            point,
            normal: surface.shading_normal,
            lights: (self.shadows.len() - before) as u32,
        });
    }

    /// Traces the shadow rays; each sample in its order, with the tracer, goes to `done`, until that says to stop.
    pub(in super::super) fn finish<'a>(
        &mut self,
        tracer: &mut Tracer<'a>,
        mut done: impl FnMut(&mut Tracer<'a>, usize, Sample) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        if (tracer.any_together(&self.shadows, &mut self.hits, RayKind::Shadow)).is_none() {
            let any = |ray| tracer.any(ray, RayKind::Shadow);
            self.hits.clear();
            self.hits.extend(self.shadows.iter().map(any));
        }
        let mut answers = self.lights.iter().zip(&self.hits);
        for (index, seen) in self.seen.iter().enumerate() {
            let mut sample = Sample::default();
            match seen {
                Seen::Backdrop(backdrop) => sample.backdrop = *backdrop,
                Seen::Surface {
                    instance,
                    material,
                    point,
                    normal,
                    lights,
                } => {
                    let mut irradiance = Vec3::ZERO;
                    for ((light, cosine), hit) in answers.by_ref().take(*lights as usize) {
                        irradiance += *light * (cosine * f32::from(u8::from(!hit)));
                    }
                    let color = direct::reflected(point, irradiance);
                    sample.add(&Radiance::plain(color, *normal, point), 1.0);
                    tracer.cover(*instance, *material, 1.0);
                }
            }
            done(tracer, index, sample)?;
        }
        ControlFlow::Continue(())
    }
}
