//! Colours that tell things apart, and colours that show an amount. Linear RGB of Rec. 709 primaries, in [0, 1].
//!
//! Lightness, chroma and hue are those of Oklab (Ottosson 2020), so that equal steps look equal.

use super::srgb;

/// Share of the circle between the hues of neighbouring numbers: the golden section, under which any run of numbers is spread evenly.
const HUE_STEP: f64 = 0.618_033_988_749_894_9;

/// Lightnesses, of which each number has one by chance: numbers whose hues are close by differ in it, mostly.
const LIGHTNESSES: [f64; 3] = [0.62, 0.72, 0.82];

/// As colourful as most hues are at these lightnesses on a display.
const CHROMA: f64 = 0.13;

/// Viridis (Smith, van der Walt, Firing 2015, CC0) at nine places: perceptually even, also in grey and for most colour-blind eyes. sRGB codes.
const RAMP: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// Magma (Smith, van der Walt 2015, CC0) at seventeen places: as viridis, but from black to almost white; maps of FLIP have it. sRGB codes.
const MAGMA: [[u8; 3]; 17] = [
    [0, 0, 4],
    [10, 8, 34],
    [29, 17, 71],
    [54, 16, 107],
    [81, 18, 124],
    [106, 28, 129],
    [131, 38, 129],
    [156, 46, 127],
    [183, 55, 121],
    [208, 65, 111],
    [231, 82, 99],
    [245, 107, 92],
    [252, 137, 97],
    [254, 167, 114],
    [254, 196, 136],
    [253, 226, 163],
    [252, 253, 191],
];

/// The colour of a number, always the same; that of its neighbours is clearly another.
///
/// ```
/// use bspray::picture::palette;
/// let [a, b] = [7, 8].map(palette::distinct);
/// assert!(a.iter().zip(b).any(|(a, b)| (a - b).abs() > 0.1));
/// ```
pub fn distinct(number: u32) -> [f32; 3] {
    let turn = (f64::from(number) * HUE_STEP).fract();
    // Multiplicative hash (Knuth): the upper bits are mixed best.
    let level = number.wrapping_mul(0x9e37_79b1).wrapping_add(0x7f4a_7c15) >> 16;
    let lightness = LIGHTNESSES[level as usize % LIGHTNESSES.len()];
    let angle = turn * std::f64::consts::TAU;
    linear_of_oklab(
        lightness,
        CHROMA * libm::cos(angle),
        CHROMA * libm::sin(angle),
    )
}

/// From dark violet at 0 over green to bright yellow at 1, evenly. Values outside are taken to the ends, NaN to 0.
pub fn ramp(value: f32) -> [f32; 3] {
    between(&RAMP, value)
}

/// From black at 0 over violet and orange to pale yellow at 1, evenly. Values outside are taken to the ends, NaN to 0.
pub fn magma(value: f32) -> [f32; 3] {
    between(&MAGMA, value)
}

/// The colour at a share of the way along a list.
fn between(colors: &[[u8; 3]], value: f32) -> [f32; 3] {
    let last = colors.len() - 1;
    let place = if value > 0.0 { value.min(1.0) } else { 0.0 } * last as f32;
    let below = (place as usize).min(last - 1);
    let part = place - below as f32;
    std::array::from_fn(|i| {
        let [a, b] = [below, below + 1].map(|at| f32::from(colors[at][i]) / 255.0);
        srgb::decode(a + (b - a) * part)
    })
}

/// Out-of-range values are cut off.
fn linear_of_oklab(lightness: f64, a: f64, b: f64) -> [f32; 3] {
    let cube = |x: f64| x * x * x;
    let l = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
    .map(|c| c.clamp(0.0, 1.0) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of encoded values: the greatest difference.
    fn difference(a: [f32; 3], b: [f32; 3]) -> f32 {
        a.iter()
            .zip(b)
            .map(|(&a, b)| (srgb::encode(a) - srgb::encode(b)).abs())
            .fold(0.0, f32::max)
    }

    #[test]
    fn neighbours_up_to_three_apart_differ_clearly() {
        for number in 0..100_000 {
            for step in 1..=3 {
                let apart = difference(distinct(number), distinct(number + step));
                assert!(apart > 0.12, "{number} and {step} on: {apart}");
            }
        }
    }

    #[test]
    fn oklab_of_white_and_of_red_is_as_published() {
        let white = linear_of_oklab(1.0, 0.0, 0.0);
        assert!(white.iter().all(|c| (c - 1.0).abs() < 1e-6), "{white:?}");
        let red = linear_of_oklab(0.627_955, 0.224_863, 0.125_846);
        assert!(difference(red, [1.0, 0.0, 0.0]) < 0.02, "{red:?}");
    }

    #[test]
    fn the_ramps_become_lighter_all_the_way() {
        for (colors, of) in [(&RAMP[..], ramp as fn(f32) -> [f32; 3]), (&MAGMA, magma)] {
            let luminance = |x: f32| {
                let [r, g, b] = of(x);
                0.2126 * r + 0.7152 * g + 0.0722 * b
            };
            for i in 0..100 {
                let x = i as f32 / 100.0;
                assert!(luminance(x) < luminance(x + 0.01), "{x}");
            }
            let middle = colors[colors.len() / 2];
            assert_eq!(of(0.5).map(srgb::u8_of_linear), middle);
            assert_eq!([of(-1.0), of(7.0)], [of(f32::NAN), of(1.0)]);
        }
    }
}
