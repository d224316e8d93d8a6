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
    /// Straight on and at grazing angles, with further bounces and everything that lies above.
    pub(super) f0: Vec3,
    pub(super) f90: Vec3,
}

/// Facets of one kind among the mirrors of a lobe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facets {
    /// What they reflect straight on.
    pub(super) f0: Vec3,
    /// What they reflect at grazing angles.
    pub(super) f90: Vec3,
    /// The share of the surface that they cover, with everything that lies above.
    pub(super) share: f32,
}

impl Facets {
    /// All light that they reflect.
    pub(super) fn albedo(&self, energy: Reflected) -> Vec3 {
        energy.albedo(self.f0, self.f90) * self.share
    }
}

impl Mirrors {
    /// A lobe of facets of several kinds, for a viewer in direction `o` of the frame, to whom white mirrors of this roughness reflect `energy`. Light bounces
    /// among facets of one kind, so that a surface that is half metal reflects the mean of what metal and dielectric do (glTF 2.0, B.2); by the mean of their `f0`,
    /// a white one would lose up to a sixth of it where it is rough.
    pub(super) fn new(
        (frame, o): (Frame, Vec3),
        (roughness, energy): (f32, Reflected),
        kinds: &[Facets],
    ) -> Self {
        let (mut f0, mut f90) = (Vec3::ZERO, Vec3::ZERO);
        for kind in kinds {
            let factor = energy.compensation(kind.f0) * kind.share;
            f0 += kind.f0 * factor;
            f90 += kind.f90 * factor;
        }
        Self {
            frame,
            o,
            alpha: roughness * roughness,
            f0,
            f90,
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
