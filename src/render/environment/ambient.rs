//! The light of an environment on a matt surface by its normal alone, nothing in its way: nine spherical harmonics (Ramamoorthi and Hanrahan
//! 2001, "An Efficient Representation for Irradiance Environment Maps"), which err by less than 3 % on the mean.

use std::f32::consts::PI;

use glam::Vec3;

/// The coefficients, already times what the cosine lobe leaves of each, over pi.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ambient([Vec3; 9]);

/// Directions that are summed, by rows of equal area and by turns.
const SUMMED: (usize, usize) = (64, 128);

/// What a cosine lobe keeps of the harmonics of each band, over pi: 1, 2/3 and 1/4 (equation 8 of the paper).
const KEPT: [f32; 9] = [
    1.0,
    2.0 / 3.0,
    2.0 / 3.0,
    2.0 / 3.0,
    0.25,
    0.25,
    0.25,
    0.25,
    0.25,
];

impl Ambient {
    /// Of a radiance by direction.
    pub(super) fn new(radiance: impl Fn(Vec3) -> Vec3) -> Self {
        let mut sums = [Vec3::ZERO; 9];
        let (rows, turns) = SUMMED;
        for i in 0..rows * turns {
            let z = 1.0 - 2.0 * ((i / turns) as f32 + 0.5) / rows as f32;
            let turn = ((i % turns) as f32 + 0.5) / turns as f32;
            let (s, c) = libm::sincosf(turn * 2.0 * PI);
            let sine = (1.0 - z * z).sqrt();
            let direction = Vec3::new(sine * c, sine * s, z);
            let light = radiance(direction);
            for (sum, harmonic) in sums.iter_mut().zip(harmonics(direction)) {
                *sum += light * harmonic;
            }
        }
        let share = 4.0 * PI / (rows * turns) as f32;
        for (sum, kept) in sums.iter_mut().zip(KEPT) {
            *sum *= share * kept;
        }
        Self(sums)
    }

    /// The radiance that a white matt surface with this normal sends back.
    pub(super) fn at(&self, normal: Vec3) -> Vec3 {
        let terms = self.0.iter().zip(harmonics(normal));
        // The cut series may dip below nothing opposite of a small bright light.
        terms
            .map(|(sum, harmonic)| *sum * harmonic)
            .sum::<Vec3>()
            .max(Vec3::ZERO)
    }
}

/// The real spherical harmonics of bands 0 to 2.
fn harmonics(d: Vec3) -> [f32; 9] {
    [
        0.282_095,
        0.488_603 * d.y,
        0.488_603 * d.z,
        0.488_603 * d.x,
        1.092_548 * d.x * d.y,
        1.092_548 * d.y * d.z,
        0.315_392 * (3.0 * d.z * d.z - 1.0),
        1.092_548 * d.x * d.z,
        0.546_274 * (d.x * d.x - d.y * d.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_from_one_half_is_the_cosine_lobes_share_of_it() {
        let even = Ambient::new(|_| Vec3::new(1.0, 2.0, 3.0));
        let off = even.at(Vec3::Y) - Vec3::new(1.0, 2.0, 3.0);
        assert!(off.abs().max_element() < 1e-3);
        // A normal turned by an angle from a bright half space sees (1 + cos) / 2 of it.
        let half = Ambient::new(|d| Vec3::splat(f32::from(u8::from(d.y > 0.0))));
        for (cosine, sine) in [(1.0, 0.0), (0.6, 0.8), (0.0, 1.0), (-0.8, 0.6)] {
            let found = half.at(Vec3::new(sine, cosine, 0.0)).x;
            assert!(
                (found - 0.5 * (1.0 + cosine)).abs() < 0.03,
                "{cosine}: {found}"
            );
        }
    }
}
