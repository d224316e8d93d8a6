//! The columns and piers of the arcades: a base of mouldings, a shaft with entasis, a plain bell for a capital.

use super::super::shapes::Shape;
use super::plan::{ARCADE_DEPTH, ARCADE_TOP, SPRING};
use super::solids::{block, lathe};

/// Meridians of round parts.
const SEGMENTS: u16 = 16;

/// Side of the plinth and of the abacus.
const SIDE: f64 = 0.46;

/// Points on a quarter or half of a round moulding, from angle `from` to `to` (parts of a turn, 0 outwards, 0.25 up).
fn round(profile: &mut Vec<[f64; 2]>, centre: [f64; 2], radius: f64, from: f64, to: f64) {
    const POINTS: u32 = 2;
    for i in 0..=POINTS {
        let part = from + (to - from) * f64::from(i) / f64::from(POINTS);
        let angle = part * std::f64::consts::TAU;
        profile.push([
            centre[0] + radius * libm::cos(angle),
            centre[1] + radius * libm::sin(angle),
        ]);
    }
}

/// A column from the floor to the springing of the arches.
pub(super) fn column() -> Shape {
    let half = SIDE / 2.0;
    let abacus = SPRING - 0.12;
    let mut profile = Vec::new();
    // An Attic base: torus, scotia, smaller torus.
    round(&mut profile, [0.175, 0.155], 0.045, -0.25, 0.25);
    profile.push([0.178, 0.21]);
    round(&mut profile, [0.196, 0.24], 0.03, 0.5 + 0.17, 0.5 - 0.17);
    profile.push([0.172, 0.266]);
    round(&mut profile, [0.155, 0.294], 0.026, -0.25, 0.25);
    profile.push([0.150, 0.335]);
    // The shaft: a quarter of a cosine makes it swell a little, as Vignola has it.
    let (foot, neck) = (0.345, abacus - 0.30);
    const DRUMS: u32 = 5;
    for i in 0..=DRUMS {
        let share = f64::from(i) / f64::from(DRUMS);
        let radius = 0.112 + 0.030 * libm::cos(share * std::f64::consts::FRAC_PI_2);
        profile.push([radius, foot + (neck - foot) * share]);
    }
    // Astragal, bell, and the ring below the abacus.
    round(&mut profile, [0.118, neck + 0.018], 0.018, -0.25, 0.25);
    let bell = neck + 0.045;
    for (out, up) in [
        (0.114, 0.0),
        (0.120, 0.06),
        (0.134, 0.12),
        (0.158, 0.17),
        (0.190, 0.205),
    ] {
        profile.push([out, bell + up]);
    }
    round(&mut profile, [0.190, abacus - 0.025], 0.025, -0.2, 0.25);
    let mut shape = lathe(&profile, SEGMENTS);
    let plinth = block([-half, 0.0, -half], [half, 0.11, half], 0.012);
    shape.join(&plinth, [0.0; 3]);
    let upper = block(
        [-half - 0.02, abacus, -half - 0.02],
        [half + 0.02, SPRING, half + 0.02],
        0.02,
    );
    shape.join(&upper, [0.0; 3]);
    shape
}

/// A square pier of courses of stone for the corners, as high as the arcades' walls.
pub(super) fn pier() -> Shape {
    const COURSES: u32 = 8;
    let half = ARCADE_DEPTH / 2.0 + 0.08;
    let mut shape = block(
        [-half - 0.06, 0.0, -half - 0.06],
        [half + 0.06, 0.26, half + 0.06],
        0.03,
    );
    let height = (ARCADE_TOP - 0.26) / f64::from(COURSES);
    for course in 0..COURSES {
        let y = 0.26 + height * f64::from(course);
        // Each second course stands back by a little: joints catch the light.
        let inset = if course % 2 == 0 { 0.0 } else { 0.008 };
        let stone = block(
            [-half + inset, y, -half + inset],
            [half - inset, y + height, half - inset],
            0.014,
        );
        shape.join(&stone, [0.0; 3]);
    }
    shape
}
