//! From scene-referred radiance to what a display shows, [0, 1], both linear RGB of Rec. 709 primaries.

use std::fmt;
use std::str::FromStr;

/// Largest input that is told from a larger one. Every curve is at white long before, and its squares are finite here.
const INPUT_LIMIT: f32 = 1e9;

/// How radiance becomes display light. Exposure comes before it, [`srgb`](super::srgb) encoding after it.
///
/// Every curve is total: NaN and negative values count as 0, an infinite channel gives 1, and the result is in
/// [0, 1]. A brighter grey never gets darker.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToneMap {
    /// Khronos PBR Neutral: base colours under white light come out as they are, only highlights are compressed.
    ///
    /// The specification of 2024, <https://github.com/KhronosGroup/ToneMapping/tree/main/PBR_Neutral>.
    #[default]
    PbrNeutral,
    /// Stephen Hill's fit of the ACES reference rendering and sRGB output transforms (BakingLab, `ACES.hlsl`): the film look,
    /// with its darker mid-tones and its shifted hues. Not scaled by 1/0.6 as some programs do.
    Aces,
    /// c / (1 + c) on each channel: equation 3 of Reinhard et al., Photographic Tone Reproduction for Digital Images (2002).
    Reinhard,
    /// Nothing but the cut at 1: for colours that already are what a display should show, and for measurements.
    Clip,
}

impl ToneMap {
    /// Every tone map.
    pub const ALL: [Self; 4] = [Self::PbrNeutral, Self::Aces, Self::Reinhard, Self::Clip];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::PbrNeutral => "pbr-neutral",
            Self::Aces => "aces",
            Self::Reinhard => "reinhard",
            Self::Clip => "clip",
        }
    }

    /// Display light, in [0, 1], of linear radiance.
    pub fn apply(self, radiance: [f32; 3]) -> [f32; 3] {
        // NaN is not greater than 0.
        let c = radiance.map(|v| if v > 0.0 { v.min(INPUT_LIMIT) } else { 0.0 });
        let mapped = match self {
            Self::PbrNeutral => pbr_neutral(c),
            Self::Aces => aces(c),
            Self::Reinhard => c.map(|v| v / (1.0 + v)),
            Self::Clip => c,
        };
        mapped.map(|v| v.clamp(0.0, 1.0))
    }
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no tone map's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no tone map {name:?}; there are pbr-neutral, aces, reinhard and clip")]
pub struct UnknownToneMap {
    /// The name.
    pub name: String,
}

impl FromStr for ToneMap {
    type Err = UnknownToneMap;

    /// `none` is another name of `clip`.
    fn from_str(name: &str) -> Result<Self, UnknownToneMap> {
        if name == "none" {
            return Ok(Self::Clip);
        }
        let found = Self::ALL.into_iter().find(|map| map.name() == name);
        found.ok_or_else(|| UnknownToneMap {
            name: name.to_owned(),
        })
    }
}

/// The factor on radiance of an exposure in stops: 2^stops.
pub fn exposure_factor(stops: f32) -> f32 {
    libm::exp2f(stops)
}

/// Reflection at normal incidence of an index of refraction of 1.5, which the mapper takes off again.
const F90: f32 = 0.04;
/// K_s of the specification: where compression starts.
const START_COMPRESSION: f32 = 0.8 - F90;
/// K_d of the specification: how fast highlights lose their colour.
const DESATURATION: f32 = 0.15;

fn pbr_neutral(c: [f32; 3]) -> [f32; 3] {
    let least = c[0].min(c[1]).min(c[2]);
    let offset = if least <= 2.0 * F90 {
        least - least * least / (4.0 * F90)
    } else {
        F90
    };
    let c = c.map(|v| v - offset);
    let peak = c[0].max(c[1]).max(c[2]);
    if peak <= START_COMPRESSION {
        return c;
    }
    let room = 1.0 - START_COMPRESSION;
    let new_peak = 1.0 - room * room / (peak + room - START_COMPRESSION);
    let kept = 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    c.map(|v| v * (new_peak / peak) * kept + new_peak * (1.0 - kept))
}

fn aces(c: [f32; 3]) -> [f32; 3] {
    // sRGB to XYZ, D65 to D60, to AP1, and the desaturation of the reference rendering transform.
    const IN: [[f32; 3]; 3] = [
        [0.597_19, 0.354_58, 0.048_23],
        [0.076_00, 0.908_34, 0.015_66],
        [0.028_40, 0.133_83, 0.837_77],
    ];
    // The desaturation of the output transform, to XYZ, D60 to D65, to sRGB.
    const OUT: [[f32; 3]; 3] = [
        [1.604_75, -0.531_08, -0.073_67],
        [-0.102_08, 1.108_13, -0.006_05],
        [-0.003_27, -0.072_76, 1.076_02],
    ];
    let product = |rows: [[f32; 3]; 3], v: [f32; 3]| {
        rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    };
    let fitted = product(IN, c).map(|v| {
        (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081)
    });
    product(OUT, fitted)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: [f32; 3], b: [f32; 3], tolerance: f32) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
    }

    /// The specification's inverse, solved by hand from its equations.
    fn pbr_neutral_inverse(out: [f32; 3]) -> [f32; 3] {
        let new_peak = out[0].max(out[1]).max(out[2]);
        let mut c = out;
        if new_peak > START_COMPRESSION {
            let room = 1.0 - START_COMPRESSION;
            let peak = room * room / (1.0 - new_peak) - 1.0 + 2.0 * START_COMPRESSION;
            let g = 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
            c = out.map(|v| (v - new_peak * (1.0 - g)) / g * (peak / new_peak));
        }
        let least = c[0].min(c[1]).min(c[2]);
        let offset = if least <= F90 {
            2.0 * (F90 * least.max(0.0)).sqrt() - least
        } else {
            F90
        };
        c.map(|v| v + offset)
    }

    #[test]
    fn pbr_neutral_only_takes_the_reflection_off_base_colours() {
        // The specification's first note: for channels in [0.08, 0.8].
        let cases = [[0.08, 0.3, 0.8], [0.8, 0.8, 0.8], [0.5, 0.08, 0.11]];
        for case in cases {
            let out = ToneMap::PbrNeutral.apply(case);
            assert!(close(out, case.map(|v| v - 0.04), 1e-7), "{case:?}");
        }
    }

    #[test]
    fn pbr_neutral_gives_the_values_of_its_formula() {
        // Worked by hand. Grey 1: offset 0.04, peak 0.96, 1 - 0.24^2 / (0.96 + 1 - 1.52) = 1 - 0.0576 / 0.44.
        let grey = ToneMap::PbrNeutral.apply([1.0; 3]);
        assert!(close(grey, [0.869_090_9; 3], 1e-6), "{grey:?}");
        // Red 2: no offset, new peak 1 - 0.0576 / 1.48, g = 1 / (0.15 (2 - 0.961081) + 1) = 0.865173.
        let red = ToneMap::PbrNeutral.apply([2.0, 0.0, 0.0]);
        assert!(
            close(red, [0.961_081, 0.129_579_6, 0.129_579_6], 1e-5),
            "{red:?}"
        );
        // Dark: 0.04 - 0.04^2 / 0.16 = 0.03 off.
        let dark = ToneMap::PbrNeutral.apply([0.04, 0.05, 0.06]);
        assert!(close(dark, [0.01, 0.02, 0.03], 1e-7), "{dark:?}");
    }

    #[test]
    fn pbr_neutral_is_undone_by_its_inverse() {
        for case in [
            [0.01, 0.5, 0.02],
            [0.3, 0.9, 2.0],
            [4.0, 0.1, 0.7],
            [1.0, 2.0, 3.0],
        ] {
            let back = pbr_neutral_inverse(ToneMap::PbrNeutral.apply(case));
            assert!(close(back, case, 2e-4), "{case:?} came back as {back:?}");
        }
    }

    #[test]
    fn pbr_neutral_keeps_hue() {
        // Hue is the middle channel's place between the least and the greatest.
        let place = |c: [f32; 3]| (c[1] - c[2]) / (c[0] - c[2]);
        for scale in [0.05, 0.5, 1.0, 3.0, 20.0] {
            let case = [1.0, 0.35, 0.1].map(|v| v * scale);
            let out = ToneMap::PbrNeutral.apply(case);
            assert!((place(out) - place(case)).abs() < 1e-4, "{case:?}");
        }
    }

    #[test]
    fn aces_gives_the_values_of_its_fit() {
        // Rows of both matrices sum to 1 within 1e-5, so that grey 1 is the fit at 1: 1.0244881 / 1.654761 = 0.61911.
        let grey = ToneMap::Aces.apply([1.0; 3]);
        assert!(close(grey, [0.619_11; 3], 5e-5), "{grey:?}");
        assert_eq!(ToneMap::Aces.apply([0.0; 3]), [0.0; 3]);
        // An asymmetric colour, worked in double precision outside this crate.
        let out = ToneMap::Aces.apply([0.8, 0.4, 0.1]);
        assert!(
            close(out, [0.552_976, 0.306_561, 0.070_601], 2e-6),
            "{out:?}"
        );
    }

    #[test]
    fn reinhard_and_clip_are_what_they_say() {
        let reinhard = ToneMap::Reinhard.apply([1.0, 3.0, 0.25]);
        assert!(close(reinhard, [0.5, 0.75, 0.2], 1e-7));
        assert_eq!(ToneMap::Clip.apply([0.25, 1.0, 1.5]), [0.25, 1.0, 1.0]);
    }

    #[test]
    fn greys_never_get_darker() {
        for map in ToneMap::ALL {
            let mut last = 0.0;
            for step in -400..1200 {
                let grey = exposure_factor(step as f32 / 40.0);
                let out = map.apply([grey; 3]);
                assert!(out.iter().all(|v| (0.0..=1.0).contains(v)));
                // Grey stays grey; the fit's matrices are rounded to five decimals.
                assert!(close(out, [out[0]; 3], 1e-4), "{map} {grey}");
                assert!(out[1] >= last - 1e-6, "{map} {grey}");
                last = out[1];
            }
            assert!(last > 0.99, "{map} ends at {last}");
        }
    }

    #[test]
    fn nothing_escapes_the_unit_cube() {
        let values = [
            f32::NAN,
            f32::NEG_INFINITY,
            -1.0,
            -0.0,
            1e-40,
            0.04,
            0.08,
            0.76,
            1.0,
            1e6,
            f32::MAX,
            f32::INFINITY,
        ];
        for map in ToneMap::ALL {
            for r in values {
                for g in values {
                    for b in values {
                        let out = map.apply([r, g, b]);
                        assert!(
                            out.iter().all(|v| (0.0..=1.0).contains(v)),
                            "{map} {r} {g} {b}: {out:?}"
                        );
                    }
                }
            }
            assert_eq!(map.apply([f32::NAN; 3]), map.apply([0.0; 3]));
            assert!(close(map.apply([f32::INFINITY; 3]), [1.0; 3], 1e-6));
        }
    }

    #[test]
    fn names_go_there_and_back() {
        for map in ToneMap::ALL {
            assert_eq!(map.to_string().parse(), Ok(map));
        }
        assert_eq!("none".parse(), Ok(ToneMap::Clip));
        let error = "filmic".parse::<ToneMap>().unwrap_err();
        assert!(
            ToneMap::ALL
                .iter()
                .all(|m| error.to_string().contains(m.name()))
        );
    }

    #[test]
    fn whole_stops_are_exact_powers_of_two() {
        assert_eq!(
            [-3.0, 0.0, 1.0, 10.0].map(exposure_factor),
            [0.125, 1.0, 2.0, 1024.0]
        );
        assert_eq!(exposure_factor(f32::NEG_INFINITY), 0.0);
    }
}
