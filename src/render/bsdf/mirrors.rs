//! A lobe of microfacets that are mirrors.

use glam::Vec3;

use super::energy::Reflected;
use super::frame::Frame;
use super::{fresnel, ggx};

/// The lobe, for one viewer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirrors {
    pub(super) frame: Frame,
    /// The viewer, in the frame.
    pub(super) o: Vec3,
    pub(super) alpha: f32,
    /// Straight on and at grazing angles, with everything that lies above.
    pub(super) f0: Vec3,
    pub(super) f90: Vec3,
}

impl Mirrors {
    /// For a viewer in direction `o` of the frame, to whom white mirrors of this roughness reflect `energy`.
    pub(super) fn new(
        (frame, o): (Frame, Vec3),
        (roughness, energy): (f32, Reflected),
        f0: Vec3,
        f90: Vec3,
        share: f32,
    ) -> Self {
        let factor = energy.compensation(f0) * share;
        Self {
            frame,
            o,
            alpha: roughness * roughness,
            f0: f0 * factor,
            f90: f90 * factor,
        }
    }

    pub(super) fn is_smooth(&self) -> bool {
        self.alpha < ggx::SMOOTH
    }

    /// Fresnel's share at a facet that the viewer sees at this cosine.
    pub(super) fn reflectance(&self, cosine: f32) -> Vec3 {
        let weight = fresnel::schlick_weight(cosine);
        self.f0 * (1.0 - weight) + self.f90 * weight
    }

    /// Value of white mirrors, density, and the cosine at the facet; `i` is local.
    pub(super) fn white(&self, i: Vec3) -> (f32, f32, f32) {
        if i.z <= 0.0 || self.is_smooth() {
            return (0.0, 0.0, 0.0);
        }
        let h = (self.o + i).normalize_or(Vec3::Z);
        let cosine = self.o.dot(h).max(0.0);
        let density = ggx::masking(self.o.z, self.alpha) * ggx::distribution(h, self.alpha)
            / (4.0 * self.o.z);
        let value = density * ggx::seen_share(i.z, self.o.z, self.alpha);
        (value, density, cosine)
    }

    pub(super) fn facet(&self, u: [f32; 2]) -> Vec3 {
        if self.is_smooth() {
            Vec3::Z
        } else {
            ggx::visible_normal(self.o, self.alpha, u)
        }
    }
}
