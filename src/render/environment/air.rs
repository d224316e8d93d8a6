//! Air and haze: what they scatter and absorb by height, and tables of what is left of the light on its way.
//!
//! Coefficients and tables follow Hillaire (EGSR 2020, tables 1 and section 5), whose constants are those of Bruneton's
//! "Precomputed Atmospheric Scattering: a New Implementation" (2017). Kilometres, and 1 / kilometre at 680, 550 and 440 nm.

use std::f64::consts::PI;

use glam::DVec3;

/// Radius of the ground.
pub(super) const GROUND_RADIUS: f64 = 6360.0;
/// Radius at which the air ends.
const TOP_RADIUS: f64 = 6460.0;
/// Height of the eye, above the roughness of rounding.
pub(super) const EYE_HEIGHT: f64 = 0.01;

/// Share of the light that the ground sends back.
pub(super) const GROUND_ALBEDO: f64 = 0.3;

/// Scattering of air at sea level.
const RAYLEIGH: DVec3 = DVec3::new(5.802e-3, 13.558e-3, 33.1e-3);
/// Heights over which air and haze fall to 1 / e.
const RAYLEIGH_HEIGHT: f64 = 8.0;
const MIE_HEIGHT: f64 = 1.2;
/// Absorption of ozone where it is thickest: at 25 km, falling to nothing within 15.
const OZONE: DVec3 = DVec3::new(0.650e-3, 1.881e-3, 0.085e-3);
/// How much of what haze takes from the light it scatters.
const MIE_ALBEDO: f64 = 0.9;
/// How far haze scatters forward.
const MIE_ASYMMETRY: f64 = 0.8;

/// Sizes of the tables: by height, and by the cosine of the angle to the zenith.
const TRANSMITTANCE_SIZE: (usize, usize) = (48, 192);
const FURTHER_SIZE: (usize, usize) = (24, 32);

/// Directions, along either angle, over which light from all sides is summed.
const ALL_SIDES: u32 = 8;

/// The coefficients of an atmosphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Air {
    /// Extinction of haze at sea level.
    haze: f64,
}

/// What is looked up along view rays, for a sun of irradiance 1.
#[derive(Debug)]
pub(super) struct Tables {
    transmittance: Table,
    further: Table,
}

#[derive(Debug)]
struct Table {
    size: (usize, usize),
    values: Vec<DVec3>,
}

impl Air {
    /// Air with as much haze as its turbidity (at 550 nm) says.
    pub(super) fn new(turbidity: f64) -> Self {
        let of_air = RAYLEIGH.y * RAYLEIGH_HEIGHT;
        Self {
            haze: (turbidity - 1.0).max(0.0) * of_air / MIE_HEIGHT,
        }
    }

    /// Scattering by air and by haze, and the extinction by all, at a distance from the planet's middle.
    pub(super) fn at(&self, radius: f64) -> (DVec3, DVec3, DVec3) {
        let height = (radius - GROUND_RADIUS).max(0.0);
        let by_air = RAYLEIGH * libm::exp(-height / RAYLEIGH_HEIGHT);
        let haze = DVec3::splat(self.haze * libm::exp(-height / MIE_HEIGHT));
        let ozone = OZONE * (1.0 - (height - 25.0).abs() / 15.0).max(0.0);
        (by_air, haze * MIE_ALBEDO, by_air + haze + ozone)
    }

    /// The share of light that gets from `radius` to the end of the air, in a direction of a `cosine` to the zenith: nothing
    /// through the ground.
    pub(super) fn transmittance(&self, radius: f64, cosine: f64) -> DVec3 {
        match distance_to_ground(radius, cosine) {
            Some(_) => DVec3::ZERO,
            None => self.transmittance_past_ground(radius, cosine),
        }
    }

    fn transmittance_past_ground(&self, radius: f64, cosine: f64) -> DVec3 {
        let length = distance_to_top(radius, cosine);
        let n = 64;
        let place = |i: f64| length * square(i / f64::from(n));
        let depth = (0..n).fold(DVec3::ZERO, |sum, i| {
            let (from, to) = (place(f64::from(i)), place(f64::from(i + 1)));
            let t = (from + to) / 2.0;
            let there = (radius * radius + t * t + 2.0 * radius * cosine * t).sqrt();
            sum + self.at(there).2 * (to - from)
        });
        exp(-depth)
    }

    pub(super) fn tables(&self) -> Tables {
        let transmittance = Table::new(TRANSMITTANCE_SIZE, |radius, cosine| {
            // Where the ground is in the way, the value at the horizon goes on, so that no mix of entries has a step.
            let horizon = -(1.0 - square(GROUND_RADIUS / radius)).max(0.0).sqrt();
            self.transmittance_past_ground(radius, cosine.max(horizon))
        });
        let further = Table::new(FURTHER_SIZE, |radius, cosine| {
            self.further(&transmittance, radius, cosine)
        });
        Tables {
            transmittance,
            further,
        }
    }

    /// Radiance that arrives at a point after two and more times of scattering, the mean of all sides (section 5.5, equations 5 to 10).
    fn further(&self, transmittance: &Table, radius: f64, sun_cosine: f64) -> DVec3 {
        const STEPS: u32 = 20;
        let sun = DVec3::new(
            (1.0 - sun_cosine * sun_cosine).max(0.0).sqrt(),
            sun_cosine,
            0.0,
        );
        let even = 1.0 / (4.0 * PI);
        let (mut second, mut again) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..ALL_SIDES * ALL_SIDES {
            let cosine = 1.0 - 2.0 * (f64::from(i / ALL_SIDES) + 0.5) / f64::from(ALL_SIDES);
            let turn = 2.0 * PI * (f64::from(i % ALL_SIDES) + 0.5) / f64::from(ALL_SIDES);
            let sine = (1.0 - cosine * cosine).sqrt();
            let view = DVec3::new(sine * libm::cos(turn), cosine, sine * libm::sin(turn));
            let ground = distance_to_ground(radius, cosine);
            let length = ground.unwrap_or_else(|| distance_to_top(radius, cosine));
            let mut left = DVec3::ONE;
            let sunlight = |point: DVec3| {
                let radius = point.length();
                let cosine = point.dot(sun) / radius;
                match distance_to_ground(radius, cosine) {
                    Some(_) => DVec3::ZERO,
                    None => transmittance.at(radius, cosine),
                }
            };
            for step in 0..STEPS {
                let place = |i: u32| length * square(f64::from(i) / f64::from(STEPS));
                let (from, to) = (place(step), place(step + 1));
                let point = DVec3::Y * radius + view * ((from + to) / 2.0);
                let (by_air, by_haze, extinction) = self.at(point.length());
                let through = exp(-extinction * (to - from));
                let share = left * (by_air + by_haze) * (DVec3::ONE - through) / extinction;
                second += share * sunlight(point) * even;
                again += share;
                left *= through;
            }
            if let Some(length) = ground {
                let normal = (DVec3::Y * radius + view * length).normalize();
                let lit = normal.dot(sun).max(0.0);
                let light = sunlight(normal * (GROUND_RADIUS + EYE_HEIGHT));
                second += left * light * (lit * GROUND_ALBEDO / PI);
            }
        }
        let sides = f64::from(ALL_SIDES * ALL_SIDES);
        // A geometric series: each time, the same share is scattered again.
        second / sides / (DVec3::ONE - again / sides)
    }
}

impl Tables {
    /// As [`Air::transmittance`], but where the ground is in the way.
    pub(super) fn transmittance(&self, radius: f64, cosine: f64) -> DVec3 {
        self.transmittance.at(radius, cosine)
    }

    /// Radiance of light that was scattered before, from all sides: what is scattered of it is this times the coefficient.
    pub(super) fn further(&self, radius: f64, sun_cosine: f64) -> DVec3 {
        self.further.at(radius, sun_cosine)
    }
}

impl Table {
    fn new(size: (usize, usize), value: impl Fn(f64, f64) -> DVec3) -> Self {
        let (rows, columns) = size;
        let share = |i: usize, n: usize| i as f64 / (n - 1) as f64;
        let entry = |i: usize| {
            // Dense at the ground, and at the horizon.
            let height = square(share(i / columns, rows));
            let side = 2.0 * share(i % columns, columns) - 1.0;
            let radius = GROUND_RADIUS + EYE_HEIGHT + height * (TOP_RADIUS - GROUND_RADIUS - 0.02);
            value(radius, side * side.abs())
        };
        Self {
            size,
            values: (0..rows * columns).map(entry).collect(),
        }
    }

    fn at(&self, radius: f64, cosine: f64) -> DVec3 {
        let (rows, columns) = self.size;
        let height = (radius - GROUND_RADIUS - EYE_HEIGHT) / (TOP_RADIUS - GROUND_RADIUS - 0.02);
        let side = cosine.abs().sqrt().copysign(cosine);
        let cell = |place: f64, n: usize| {
            let place = place.clamp(0.0, 1.0) * (n - 1) as f64;
            let index = (place as usize).min(n - 2);
            (index, place - index as f64)
        };
        let (row, down) = cell(height.max(0.0).sqrt(), rows);
        let (column, right) = cell((side + 1.0) / 2.0, columns);
        let value = |r: usize, c: usize| self.values[(row + r) * columns + column + c];
        let mix = |r| value(r, 0).lerp(value(r, 1), right);
        mix(0).lerp(mix(1), down)
    }
}

/// How far the end of the air is.
pub(super) fn distance_to_top(radius: f64, cosine: f64) -> f64 {
    let half = radius * cosine;
    let inside = half * half - radius * radius + TOP_RADIUS * TOP_RADIUS;
    (inside.max(0.0).sqrt() - half).max(0.0)
}

/// How far the ground is, if the direction meets it.
pub(super) fn distance_to_ground(radius: f64, cosine: f64) -> Option<f64> {
    let half = radius * cosine;
    let inside = half * half - radius * radius + GROUND_RADIUS * GROUND_RADIUS;
    (half < 0.0 && inside > 0.0).then(|| (-half - inside.sqrt()).max(0.0))
}

/// Rayleigh's phase function, per steradian.
pub(super) fn rayleigh_phase(cosine: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cosine * cosine)
}

/// The phase function of haze, per steradian (Cornette and Shanks 1992).
pub(super) fn mie_phase(cosine: f64) -> f64 {
    let g = MIE_ASYMMETRY;
    let scale = 3.0 / (8.0 * PI) * (1.0 - g * g) / (2.0 + g * g);
    let base = 1.0 + g * g - 2.0 * g * cosine;
    scale * (1.0 + cosine * cosine) / (base * base.sqrt())
}

/// The square of a number.
pub(super) fn square(x: f64) -> f64 {
    x * x
}

/// Of each part.
pub(super) fn exp(v: DVec3) -> DVec3 {
    DVec3::new(libm::exp(v.x), libm::exp(v.y), libm::exp(v.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phase_functions_scatter_all_there_is() {
        for phase in [rayleigh_phase, mie_phase] {
            let n = 20_000;
            let cosine = |i: i32| 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
            let sum: f64 = (0..n).map(|i| phase(cosine(i))).sum();
            assert!((sum * 4.0 * PI / f64::from(n) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn straight_up_the_thickness_is_that_of_the_layers() {
        // The integrals of the exponentials and of the tent.
        let haze = 13.558e-3 * 8.0;
        let expected = 13.558e-3 * 8.0 + haze + 1.881e-3 * 15.0;
        let found = -libm::log(Air::new(2.0).transmittance(GROUND_RADIUS, 1.0).y);
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }

    #[test]
    fn tables_agree_with_what_they_hold() {
        let air = Air::new(2.5);
        let tables = air.tables();
        for (height, cosine) in [
            (0.02, 0.9),
            (0.5, 0.1),
            (3.0, 0.01),
            (12.0, -0.02),
            (60.0, 0.3),
        ] {
            let radius = GROUND_RADIUS + height;
            let exact = air.transmittance(radius, cosine);
            let found = tables.transmittance(radius, cosine);
            assert!(
                (found - exact).abs().max_element() < 0.01,
                "{height} {cosine}"
            );
        }
        let further = tables.further(GROUND_RADIUS + 0.1, 0.8);
        assert!(
            further.min_element() > 0.0 && further.max_element() < 0.1,
            "{further}"
        );
    }
}
