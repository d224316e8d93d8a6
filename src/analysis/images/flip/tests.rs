//! FLIP against version 1.7 of its authors' evaluator, on pictures that are made by formula.

use super::*;
use crate::picture::srgb;

/// The evaluator computes in single precision, with filters of its own rounding.
const TOLERANCE: f64 = 1e-4;

const SIZE: (usize, usize) = (40, 24);

fn picture(size: (usize, usize), color: impl Fn(i32, i32) -> [f32; 3]) -> Colors {
    let (width, height) = size;
    let places = (0..height as i32).flat_map(|y| (0..width as i32).map(move |x| (x, y)));
    Colors {
        width,
        pixels: places.map(|(x, y)| color(x, y)).collect(),
    }
}

/// 8-bit codes of a display picture.
fn codes(x: i32, y: i32) -> [i32; 3] {
    [
        (x * 7 + y * 3) % 64 * 4,
        (x * x + 5 * y) % 32 * 8,
        (x + y) % 16 * 16,
    ]
}

/// The same with tinted blocks and a white line.
fn changed_codes(x: i32, y: i32) -> [i32; 3] {
    let [r, g, b] = codes(x, y);
    if x == 17 && (4..20).contains(&y) {
        [255; 3]
    } else if (x / 6 + y / 5) % 3 == 0 {
        [(r + 20).min(255), g, (b - 30).max(0)]
    } else {
        [r, g, b]
    }
}

fn display(size: (usize, usize), color: impl Fn(i32, i32) -> [i32; 3]) -> Colors {
    picture(size, |x, y| {
        color(x, y).map(|code| srgb::decode(code as f32 / 255.0))
    })
}

fn light(x: i32, y: i32) -> [f32; 3] {
    let doubled = libm::exp2(f64::from(x % 13)) * 0.01;
    [
        doubled as f32,
        0.5 + 0.25 * (x * y % 7) as f32,
        0.02 * (y * y % 40) as f32,
    ]
}

fn changed_light(x: i32, y: i32) -> [f32; 3] {
    let [r, g, b] = light(x, y);
    if (x, y) == (9, 9) {
        [200.0, 180.0, 90.0]
    } else if (x / 4 + y / 4) % 2 == 0 {
        [r * 1.5, g, b * 0.5]
    } else {
        [r, g, b]
    }
}

/// The mean, the largest, and the values at (0, 0), (17, 10), (39, 23) and (20, 3).
fn figures(map: &[f32]) -> [f64; 6] {
    let mean = map.iter().copied().map(f64::from).sum::<f64>() / map.len() as f64;
    let largest = f64::from(map.iter().copied().fold(0.0, f32::max));
    let at = |x: usize, y: usize| f64::from(map[y * SIZE.0 + x]);
    [mean, largest, at(0, 0), at(17, 10), at(39, 23), at(20, 3)]
}

fn assert_near(found: [f64; 6], expected: [f64; 6]) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < TOLERANCE, "{found} {expected}");
    }
}

#[test]
fn display_pictures_have_the_evaluators_map() {
    let (reference, test) = (display(SIZE, codes), display(SIZE, changed_codes));
    assert_near(
        figures(&flip_ldr(&test, &reference, PIXELS_PER_DEGREE)),
        [
            0.172_681_6,
            0.777_799,
            0.156_48,
            0.643_083,
            0.078_002,
            0.196_422,
        ],
    );
    assert_near(
        figures(&flip_ldr(&test, &reference, 20.0)),
        [0.145_620_9, 0.989_309, 0.099_934, 0.971_791, 0.0, 0.228_381],
    );
}

#[test]
fn flat_pictures_have_the_evaluators_figure() {
    for (reference, test, expected) in [
        ([0.0; 3], [1.0; 3], 0.967_388),
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.986_665),
        ([0.5; 3], [0.5, 0.5, 0.52], 0.084_234),
        ([0.3; 3], [0.3; 3], 0.0),
    ] {
        let flat = |codes: [f32; 3]| picture((12, 9), |_, _| codes.map(srgb::decode));
        for value in flip_ldr(&flat(test), &flat(reference), PIXELS_PER_DEGREE) {
            assert!((f64::from(value) - expected).abs() < TOLERANCE, "{value}");
        }
    }
}

#[test]
fn linear_pictures_have_the_evaluators_map_and_exposures() {
    let (reference, test) = (picture(SIZE, light), picture(SIZE, changed_light));
    let (map, exposures) = flip_hdr(&test, &reference, PIXELS_PER_DEGREE, None);
    assert_near(
        figures(&map),
        [
            0.257_221_8,
            0.388_478,
            0.166_91,
            0.284_838,
            0.384_981,
            0.258_372,
        ],
    );
    assert!(
        (exposures.start + 2.263_602_5).abs() < 1e-5,
        "{exposures:?}"
    );
    assert!((exposures.stop - 0.833_267_2).abs() < 1e-5, "{exposures:?}");
    assert_eq!(exposures.count, 4);
    let three = Exposures {
        start: -2.0,
        stop: 2.0,
        count: 3,
    };
    let (map, taken) = flip_hdr(&test, &reference, PIXELS_PER_DEGREE, Some(three));
    assert_eq!(taken, three);
    assert_near(
        figures(&map),
        [
            0.259_986_5,
            0.425_165,
            0.216_995,
            0.270_77,
            0.425_165,
            0.244_437,
        ],
    );
}

#[test]
fn a_picture_that_is_black_except_for_a_light_has_the_evaluators_map() {
    let lit = |edge: i32| {
        picture(
            SIZE,
            move |x, _| {
                if x > edge { [0.0; 3] } else { [3.0, 2.0, 1.0] }
            },
        )
    };
    let (map, exposures) = flip_hdr(&lit(4), &lit(5), PIXELS_PER_DEGREE, None);
    assert_eq!(exposures.count, 25);
    assert_near(
        figures(&map),
        [0.097_023_6, 0.773_664, 0.075_529, 0.0, 0.0, 0.0],
    );
}

#[test]
fn one_pixel_is_enough() {
    let [a, b] = [0.2, 0.9].map(|v| picture((1, 1), |_, _| [v; 3]));
    assert!(flip_ldr(&a, &b, PIXELS_PER_DEGREE)[0] > 0.1);
    assert_eq!(flip_hdr(&a, &a, PIXELS_PER_DEGREE, None).0, [0.0]);
}
