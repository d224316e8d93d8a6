//! The layers of a surface, put together for one viewer.

use glam::Vec3;

use super::energy::{self, Reflected};
use super::frame::Frame;
use super::glass::Interface;
use super::mirrors::{Facets, Mirrors};
use super::{LEAST_COSINE, Lobes, Normals, Solid};

/// The index of refraction of clear coats (KHR_materials_clearcoat).
const COAT_IOR: f32 = 1.5;

/// The lobes among which a direction is chosen.
pub(super) const COAT: usize = 0;
pub(super) const SHEEN: usize = 1;
pub(super) const DIFFUSE: usize = 2;
pub(super) const BASE: usize = 3;
pub(super) const THIN: usize = 4;
pub(super) const SOLID: usize = 5;
pub(super) const LOBES: usize = 6;

/// How a place scatters light to one viewer. Weights hold everything that lies above.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<'a> {
    pub(super) normals: Normals,
    pub(super) view: Vec3,
    /// Of the base.
    pub(super) frame: Frame,
    /// The viewer, in the frame.
    pub(super) o: Vec3,
    pub(super) coat: Option<Mirrors>,
    pub(super) sheen: Vec3,
    pub(super) sheen_roughness: f32,
    pub(super) diffuse: Vec3,
    pub(super) base: Mirrors,
    /// Of light through a thin wall: the mirrors of the base, turned to the far side.
    pub(super) thin: Vec3,
    pub(super) solid: Option<Interface<'a>>,
    pub(super) solid_share: f32,
    pub(super) solid_tint: Vec3,
    /// With which each lobe is chosen.
    pub(super) chances: [f32; LOBES],
    /// What the coat mirrors in all.
    pub(super) coat_albedo: Vec3,
    /// What coat and base mirror in all.
    pub(super) mirror_albedo: Vec3,
    /// What passes a thin wall in all.
    pub(super) thin_albedo: Vec3,
    diffuse_albedo: Vec3,
}

impl<'a> Bsdf<'a> {
    /// For a viewer in direction `view`. `solid` is the medium, if the material passes light into one.
    pub fn new(lobes: &Lobes, normals: Normals, view: Vec3, solid: Option<Solid<'a>>) -> Self {
        let seen_along = |normal: Vec3| {
            let frame = Frame::around(normal);
            let mut o = frame.to_local(view);
            o.z = o.z.max(LEAST_COSINE);
            (frame, o)
        };
        let (frame, o) = seen_along(normals.shading);
        let mut chances = [0.0; LOBES];

        // What the layers so far leave to those below.
        let mut below = 1.0;
        let mut coat_albedo = Vec3::ZERO;
        let coat = (lobes.coat > 0.0).then(|| {
            let facets = Facets {
                f0: Vec3::splat(Lobes::f0_of(COAT_IOR)),
                f90: Vec3::ONE,
                share: lobes.coat,
            };
            let roughness = lobes.coat_roughness;
            let seen = seen_along(normals.coat);
            let energy = Reflected::at(seen.1.z, roughness);
            let coat = Mirrors::new(seen, (roughness, energy), &[facets]);
            let albedo = facets.albedo(energy);
            chances[COAT] = albedo.x;
            coat_albedo = albedo;
            below -= albedo.x;
            coat
        });
        let (mut sheen, mut diffuse_albedo) = (Vec3::ZERO, Vec3::ZERO);
        if lobes.sheen != Vec3::ZERO {
            // The fit of the masking lets a smooth cloth's rim reflect more than it gets. The table errs by less than 1 %.
            let white = energy::sheen(o.z, lobes.sheen_roughness) * 1.01;
            sheen = lobes.sheen * (below / white.max(1.0));
            diffuse_albedo = sheen * white;
            chances[SHEEN] = diffuse_albedo.max_element();
            below -= chances[SHEEN];
        }

        let dielectric = (1.0 - lobes.metallic) * below;
        let solid_share = solid.map_or(0.0, |_| dielectric * lobes.transmission);
        // The base's mirrors are metal, and dielectric with a matt or thin ground.
        let kinds = [
            Facets {
                f0: lobes.f0,
                f90: Vec3::splat(lobes.f90),
                share: (dielectric - solid_share).max(0.0),
            },
            Facets {
                f0: lobes.base_color,
                f90: Vec3::ONE,
                share: lobes.metallic * below,
            },
        ];
        let is_matt =
            lobes.metallic + lobes.transmission + lobes.f90 == 0.0 && lobes.f0 == Vec3::ZERO;
        let reflected = if is_matt {
            Reflected::UNUSED
        } else {
            Reflected::at(o.z, lobes.roughness)
        };
        let base = Mirrors::new((frame, o), (lobes.roughness, reflected), &kinds);
        let base_albedo = kinds
            .iter()
            .map(|kind| kind.albedo(reflected))
            .sum::<Vec3>();
        chances[BASE] = base_albedo.max_element();

        let passed = Vec3::ONE - reflected.albedo(lobes.f0, Vec3::splat(lobes.f90));
        let ground = lobes.base_color * passed * dielectric;
        let diffuse = ground * (1.0 - lobes.transmission);
        chances[DIFFUSE] = diffuse.max_element();
        let thin = match solid {
            Some(_) => Vec3::ZERO,
            None => ground * lobes.transmission,
        };
        chances[THIN] = thin.max_element();
        chances[SOLID] = solid_share;
        let solid_tint = lobes.base_color;
        let mirror_albedo = coat_albedo + base_albedo;
        diffuse_albedo += diffuse;

        let total: f32 = chances.iter().sum();
        if total > 0.0 {
            chances.iter_mut().for_each(|c| *c /= total);
        }
        Self {
            normals,
            view,
            frame,
            o,
            coat,
            sheen,
            sheen_roughness: lobes.sheen_roughness,
            diffuse,
            base,
            // The mirrors lose light among their facets; what passes does not.
            thin: thin / reflected.white(),
            solid: solid.map(|solid| Interface {
                eta: solid.eta,
                roughness: lobes.roughness,
                energy: solid.energy,
                is_outside: solid.is_outside,
            }),
            solid_share,
            solid_tint,
            chances,
            coat_albedo,
            mirror_albedo,
            thin_albedo: thin,
            diffuse_albedo,
        }
    }

    /// The normal of the base, as the viewer's side has it.
    pub fn shading_normal(&self) -> Vec3 {
        self.normals.shading
    }

    /// Perceptual roughness of the base.
    pub fn roughness(&self) -> f32 {
        self.base.alpha.sqrt()
    }

    /// The share of light that is scattered matt, by colour.
    pub fn diffuse_albedo(&self) -> Vec3 {
        self.diffuse_albedo
    }

    /// The share of light that is mirrored or passes, by colour.
    pub fn specular_albedo(&self) -> Vec3 {
        self.mirror_albedo + self.thin_albedo + self.solid_tint * self.solid_share
    }
}
