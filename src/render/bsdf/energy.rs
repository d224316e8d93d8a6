//! How much light a lobe reflects in all: tables by angle and roughness, worked out once, from which come the energy that bounces
//! between microfacets (Turquin 2019, "Practical multiple scattering compensation for microfacet models") and the share that
//! a layer leaves to the one below it.

use std::sync::LazyLock;

use glam::Vec3;
use rayon::prelude::*;

use super::fresnel::schlick_weight;
use super::{charlie, ggx};

/// Entries along each side of a table.
const SIDE: usize = 32;

/// Directions that are summed for an entry. Fewer leave errors of more than half a percent in the furnace.
const POINTS: u32 = 610;

/// Values over the root of the cosine (columns), which is where they bend, and the perceptual roughness (rows).
#[derive(Debug)]
struct Table(Vec<f32>);

impl Table {
    /// `value` of a direction with the given cosine, and a roughness.
    fn new(value: impl Fn(Vec3, f32) -> f32 + Sync) -> Self {
        let entries = 0..SIDE * SIDE;
        let entry = |index: usize| {
            let place = |i: usize| i as f32 / (SIDE - 1) as f32;
            // Straight along the surface there is no lobe: the first column stands for a grazing one.
            let root = place(index % SIDE).max(0.02);
            let cosine = root * root;
            let o = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
            value(o, place(index / SIDE).max(0.04))
        };
        Self(entries.into_par_iter().map(entry).collect())
    }

    fn at(&self, cosine: f32, roughness: f32) -> f32 {
        let scaled = |x: f32| x.clamp(0.0, 1.0) * (SIDE - 1) as f32;
        let (x, y) = (scaled(cosine.max(0.0).sqrt()), scaled(roughness));
        let (left, top) = ((x as usize).min(SIDE - 2), (y as usize).min(SIDE - 2));
        let (fx, fy) = (x - left as f32, y - top as f32);
        let row = |y: usize| {
            let [a, b] = [left, left + 1].map(|x| self.0[y * SIDE + x]);
            a + (b - a) * fx
        };
        let (upper, lower) = (row(top), row(top + 1));
        upper + (lower - upper) * fy
    }
}

/// Evenly spread points of the unit square: a rank-1 lattice with the steps of the generalised golden ratio (Roberts 2018).
fn square() -> impl Iterator<Item = [f32; 2]> {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
    (0..POINTS).map(|i| STEPS.map(|step| ((f64::from(i) + 0.5) * step).fract() as f32))
}

/// The mean of a value over the square.
fn mean(value: impl Fn([f32; 2]) -> f32) -> f32 {
    square().map(value).sum::<f32>() / POINTS as f32
}

/// Mean of `value(weight, cosine to the facet)` over the reflections of GGX.
fn reflected(o: Vec3, roughness: f32, value: impl Fn(f32, f32) -> f32) -> f32 {
    let alpha = roughness * roughness;
    mean(|u| {
        let h = ggx::visible_normal(o, alpha, u);
        let cosine = o.dot(h);
        let i = h * (2.0 * cosine) - o;
        if i.z > 0.0 {
            value(ggx::seen_share(i.z, o.z, alpha), cosine)
        } else {
            0.0
        }
    })
}

static WHITE: LazyLock<Table> =
    LazyLock::new(|| Table::new(|o, roughness| reflected(o, roughness, |weight, _| weight)));

static GRAZING: LazyLock<Table> = LazyLock::new(|| {
    Table::new(|o, roughness| {
        reflected(o, roughness, |weight, cosine| {
            weight * schlick_weight(cosine)
        })
    })
});

static SHEEN: LazyLock<Table> = LazyLock::new(|| {
    Table::new(|o, roughness| {
        let lobes = mean(|[u, v]| {
            // Uniform over the root of the cosine, since the lobe is strongest along the surface: d cos = 2 root d root.
            let cosine = u * u;
            let sine = (1.0 - cosine * cosine).sqrt();
            let (s, c) = libm::sincosf(std::f32::consts::TAU * v);
            let i = Vec3::new(sine * c, sine * s, cosine);
            charlie::value(o, i, roughness) * cosine * 2.0 * u
        });
        lobes * std::f32::consts::TAU
    })
});

/// What GGX reflects, single bounces only, of light from a direction with this cosine, if its facets are perfect mirrors, and
/// the part of it that Schlick's weight keeps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflected {
    white: f32,
    grazing: f32,
}

impl Reflected {
    /// Stands for surfaces that mirror nothing, of which nobody asks how rough they are.
    pub(super) const UNUSED: Self = Self {
        white: 1.0,
        grazing: 0.0,
    };

    pub(super) fn at(cosine: f32, roughness: f32) -> Self {
        Self {
            white: WHITE.at(cosine, roughness),
            grazing: GRAZING.at(cosine, roughness),
        }
    }

    /// What white mirrors reflect in single bounces.
    pub(super) fn white(self) -> f32 {
        self.white
    }

    /// The factor by which further bounces between facets of reflectance `f0` raise a lobe.
    pub(super) fn compensation(self, f0: Vec3) -> Vec3 {
        Vec3::ONE + f0 * ((1.0 - self.white) / self.white)
    }

    /// All light that a lobe reflects whose facets reflect `f0` straight on and `f90` at grazing angles, further bounces included.
    pub(super) fn albedo(self, f0: Vec3, f90: Vec3) -> Vec3 {
        let single = f0 * (self.white - self.grazing) + f90 * self.grazing;
        (single * self.compensation(f0)).min(Vec3::ONE)
    }
}

/// What white sheen reflects of light from a direction with this cosine.
pub(super) fn sheen(cosine: f32, roughness: f32) -> f32 {
    SHEEN.at(cosine, roughness)
}

/// The tables of a rough interface between two media, which depend on the ratio of their indices of refraction.
#[derive(Debug)]
pub struct GlassEnergy {
    from_outside: Table,
    from_inside: Table,
}

impl GlassEnergy {
    /// Works the tables out. `ior`: inside over outside.
    pub fn new(ior: f32) -> Self {
        let passed = |eta: f32| {
            move |o: Vec3, roughness: f32| {
                let alpha = roughness * roughness;
                mean(|u| super::glass::kept(o, ggx::visible_normal(o, alpha, u), eta, alpha))
            }
        };
        Self {
            from_outside: Table::new(passed(ior)),
            from_inside: Table::new(passed(1.0 / ior)),
        }
    }

    /// The share of light that single bounces keep.
    pub(super) fn kept(&self, cosine: f32, roughness: f32, is_outside: bool) -> f32 {
        let table = if is_outside {
            &self.from_outside
        } else {
            &self.from_inside
        };
        table.at(cosine, roughness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_mirrors_lose_nothing_and_rough_ones_do() {
        for cosine in [0.1, 0.5, 1.0] {
            assert!((WHITE.at(cosine, 0.05) - 1.0).abs() < 0.01);
        }
        // At roughness 1, straight on: D is 1 / pi, masking 2 z / (1 + z), and the integral of z / (1 + z) is 1 - ln 2.
        let rough = WHITE.at(1.0, 1.0);
        assert!(
            (rough - (1.0 - std::f32::consts::LN_2)).abs() < 2e-3,
            "{rough}"
        );
    }

    #[test]
    fn a_white_mirror_reflects_everything_with_compensation() {
        for roughness in [0.1, 0.5, 0.9] {
            for cosine in [0.05, 0.4, 0.9] {
                let albedo = Reflected::at(cosine, roughness).albedo(Vec3::ONE, Vec3::ONE);
                assert!((albedo - Vec3::ONE).abs().max_element() < 1e-5);
            }
        }
    }
}
