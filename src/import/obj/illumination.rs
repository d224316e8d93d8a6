//! What the illumination models of MTL ask for.
//!
//! The numbers are those of the format's specification (Alias Wavefront, "Advanced Visualizer", appendix B1, "MTL material format");
//! exporters put them to uses of their own, which are looked at where they are known:
//!
//! | illum | specification | here |
//! |---|---|---|
//! | 0, 1 | colour; with Lambert's law | [`Illumination::Matt`]: no reflection |
//! | 2, 10 | highlight; shadows on what is not there | [`Illumination::Highlight`]: a lobe by `Ns` |
//! | 3, 8 | reflection, ray-traced or from a picture | [`Illumination::Mirror`]: a sharp one of strength `Ks` over `Kd` |
//! | 3 of Blender | what it writes for metals, with the share of metal in `Ka` (`io/wavefront_obj`, `obj_export_mtl.cc`) | [`Illumination::BlenderMetal`] |
//! | 4 | glass | [`Illumination::Glass`] where `d` is below 1 and `Ni` above, else as 2: Maya writes it for all materials |
//! | 5 | reflection by Fresnel | [`Illumination::FresnelMirror`]: a sharp one by `Ni` |
//! | 6, 7 | refraction, and reflection without and with Fresnel | [`Illumination::Glass`], always with Fresnel, as nature has it |
//! | 9 | glass without ray tracing | as 2, with alpha: Blender writes it for leaves too |

use glam::Vec3;

/// How a surface answers light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Illumination {
    /// No reflection.
    Matt,
    /// A lobe.
    Highlight,
    /// A sharp reflection of the strength of `Ks`.
    Mirror,
    /// A sharp reflection that grows at grazing angles.
    FresnelMirror,
    /// A metal, by this share.
    BlenderMetal(f32),
    /// Light passes, and is refracted.
    Glass,
}

impl Illumination {
    /// By the model's number, alpha, the index of refraction, and the colours `Ka` and `Ks`.
    pub(super) fn of(
        model: Option<u8>,
        alpha: f32,
        ior: f32,
        ka: Option<Vec3>,
        ks: Option<Vec3>,
    ) -> Self {
        match model {
            Some(0 | 1) => Self::Matt,
            Some(3) => match (ka, ks) {
                // What only Blender writes: half of white, and a grey share of metal.
                (Some(ka), Some(ks))
                    if ks == Vec3::splat(0.5) && ka == Vec3::splat(ka.x) && ka.x > 0.0 =>
                {
                    Self::BlenderMetal(ka.x.min(1.0))
                }
                _ => Self::Mirror,
            },
            Some(8) => Self::Mirror,
            Some(4) if alpha < 1.0 && ior > 1.0 => Self::Glass,
            Some(5) => Self::FresnelMirror,
            Some(6 | 7) => Self::Glass,
            _ => Self::Highlight,
        }
    }

    /// Whether reflection and refraction are sharp, whatever `Ns` says of highlights.
    pub(super) fn is_sharp(self) -> bool {
        matches!(self, Self::Mirror | Self::FresnelMirror | Self::Glass)
    }
}

/// Whether an image's colours are normals of a normal map: exporters name these in `map_Bump` as well. Their mean is bluish, and
/// about half in red and green; heights are grey.
pub(super) fn is_normal_map(mean: Vec3) -> bool {
    /// How far from half the mean of red and green may be: textures lean, but seldom as a whole.
    const MOST_LEAN: f32 = 0.15;
    /// Least blue, and least blue above the others.
    const LEAST_BLUE: (f32, f32) = (0.7, 0.2);
    let [red, green, blue] = mean.to_array();
    let is_half = |c: f32| (c - 0.5).abs() < MOST_LEAN;
    is_half(red) && is_half(green) && blue > LEAST_BLUE.0 && blue - red.max(green) > LEAST_BLUE.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_has_its_answer() {
        use Illumination as I;
        let of = |model, alpha, ior| I::of(model, alpha, ior, None, Some(Vec3::ONE));
        let opaque: Vec<I> = (0..=11).map(|m| of(Some(m), 1.0, 1.5)).collect();
        let expected = [
            I::Matt,
            I::Matt,
            I::Highlight,
            I::Mirror,
            I::Highlight,
            I::FresnelMirror,
            I::Glass,
            I::Glass,
            I::Mirror,
            I::Highlight,
            I::Highlight,
            I::Highlight,
        ];
        assert_eq!(opaque, expected);
        assert_eq!(of(None, 1.0, 1.5), I::Highlight);
        assert_eq!(of(Some(4), 0.2, 1.5), I::Glass);
        assert_eq!(of(Some(4), 0.2, 1.0), I::Highlight);
        let blender = |ka: f32, ks| I::of(Some(3), 1.0, 1.5, Some(Vec3::splat(ka)), Some(ks));
        assert_eq!(blender(0.75, Vec3::splat(0.5)), I::BlenderMetal(0.75));
        assert_eq!(blender(0.75, Vec3::splat(0.6)), I::Mirror);
        assert_eq!(blender(0.0, Vec3::splat(0.5)), I::Mirror);
    }

    #[test]
    fn normal_maps_are_told_from_heights() {
        assert!(is_normal_map(Vec3::new(0.502, 0.498, 0.96)));
        assert!(is_normal_map(Vec3::new(0.45, 0.55, 0.8)));
        for heights in [Vec3::splat(0.5), Vec3::ONE, Vec3::new(0.2, 0.3, 0.9)] {
            assert!(!is_normal_map(heights));
        }
    }
}
