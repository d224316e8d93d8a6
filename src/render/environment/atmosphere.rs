//! The sky of a clear day, by what air and haze scatter: no measured data, a handful of constants.
//!
//! S. Hillaire, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", EGSR 2020: single scattering along the view
//! ray, and all further orders by a small table in which light is taken to come evenly from all sides. Lengths are in kilometres,
//! coefficients per kilometre, for three wavelengths (680, 550 and 440 nm) that stand for linear Rec. 709; radiance is
//! in units of [`Daylight::SOLAR`]. The eye is at sea level, the axes are those of the picture: y is up.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Axes;
use super::air::{self, Air, GROUND_ALBEDO, GROUND_RADIUS, distance_to_ground, distance_to_top};
use crate::scene::Pixels;

/// A clear day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Daylight {
    /// Height of the sun over the horizon, in degrees: -18 to 90.
    pub elevation: f64,
    /// Where the sun stands, in degrees counter-clockwise as seen from above, from the right axis (+X if +Y or +Z is up).
    pub azimuth: f64,
    /// How hazy the air is: the optical thickness of haze and air together by that of air alone. 1 is the purest air, 2 a very clear day, 10 haze.
    pub turbidity: f64,
}

impl Default for Daylight {
    /// A clear morning, with the sun before the scene to the left of the usual camera.
    fn default() -> Self {
        Self {
            elevation: 40.0,
            azimuth: 230.0,
            turbidity: 2.5,
        }
    }
}

/// Pixels of the sky's picture: its sharpest feature, the haze around the sun, is some ten degrees wide.
const SIZE: (u32, u32) = (256, 128);

/// Steps of a view ray; they grow with the distance.
const STEPS: u32 = 40;

/// What became of the sky: an equirectangular picture of radiance.
pub(super) struct SkyPicture {
    pub(super) pixels: Pixels,
    pub(super) size: (u32, u32),
}

impl Daylight {
    /// Irradiance of the sun above the air, on a surface across: such that white surfaces in the sun come near to 1.
    pub const SOLAR: f32 = 4.0;

    /// Angular radius of the sun, in degrees.
    pub const SUN_RADIUS: f64 = 0.2665;

    /// With the sun in a direction of world space (of any length but 0), under the upward axis `up`.
    #[must_use]
    pub fn with_sun(self, direction: Vec3, up: Vec3) -> Self {
        let place = Axes::new(up, 0.0).place(direction.normalize_or(Vec3::Y));
        let azimuth = 180.0 - 360.0 * place.turn;
        Self {
            elevation: libm::asin(place.cosine).to_degrees(),
            azimuth: if azimuth < 0.0 {
                azimuth + 360.0
            } else {
                azimuth
            },
            ..self
        }
    }

    /// Unit vector to the sun, along right, up and front.
    pub(super) fn sun(&self) -> DVec3 {
        let (elevation, azimuth) = (self.elevation.to_radians(), self.azimuth.to_radians());
        let level = libm::cos(elevation);
        DVec3::new(
            level * libm::cos(azimuth),
            libm::sin(elevation),
            -level * libm::sin(azimuth),
        )
    }

    /// Irradiance of the sun on a surface across, below the air.
    pub(super) fn sun_irradiance(&self) -> Vec3 {
        let air = Air::new(self.turbidity);
        let left = air.transmittance(GROUND_RADIUS, self.sun().y);
        (left * f64::from(Self::SOLAR)).as_vec3()
    }
}

/// The picture of the sky without the sun's disc; below the horizon lies a ground in its light.
pub(super) fn sky(daylight: &Daylight) -> SkyPicture {
    let air = Air::new(daylight.turbidity);
    let tables = air.tables();
    let sun = daylight.sun();
    let (width, height) = SIZE;
    let radiance = |x: u32, y: u32| {
        let turn = (f64::from(x) + 0.5) / f64::from(width) - 0.5;
        let polar = (f64::from(y) + 0.5) / f64::from(height) * PI;
        let (s, c) = (libm::sin(turn * 2.0 * PI), libm::cos(turn * 2.0 * PI));
        let view = DVec3::new(c * libm::sin(polar), libm::cos(polar), s * libm::sin(polar));
        seen(&air, &tables, view, sun)
    };
    let half = height / 2;
    let upper: Vec<DVec3> = (0..half * width)
        .into_par_iter()
        .map(|i| radiance(i % width, i / width))
        .collect();
    let mut floor = air.transmittance(GROUND_RADIUS, sun.y) * sun.y.max(0.0);
    for (i, radiance) in (0..).zip(&upper) {
        let edge = |y: u32| libm::cos(f64::from(y) / f64::from(height) * PI);
        let (top, bottom) = (edge(i / width), edge(i / width + 1));
        // The cosine integrated over the pixel's solid angle.
        floor += radiance * (PI / f64::from(width) * (top * top - bottom * bottom));
    }
    let ground = floor * (GROUND_ALBEDO / PI);
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let value = if y < half {
            upper[i as usize]
        } else {
            // Far ground is seen through air, which has the colour of the horizon above it.
            let sine = -libm::cos((f64::from(y) + 0.5) / f64::from(height) * PI);
            let horizon = upper[((half - 1) * width + x) as usize];
            horizon.lerp(ground, (sine * 6.0).min(1.0))
        };
        let [r, g, b] = (value * f64::from(Daylight::SOLAR)).as_vec3().to_array();
        [r, g, b, 1.0]
    };
    SkyPicture {
        pixels: Pixels::RgbaF32((0..height * width).map(pixel).collect()),
        size: SIZE,
    }
}

/// Radiance that comes from `view` at sea level, for a sun of irradiance 1.
fn seen(air: &Air, tables: &air::Tables, view: DVec3, sun: DVec3) -> DVec3 {
    let start = GROUND_RADIUS + air::EYE_HEIGHT;
    let length = distance_to_top(start, view.y);
    let cosine = view.dot(sun);
    let (rayleigh, mie) = (air::rayleigh_phase(cosine), air::mie_phase(cosine));
    let mut left = DVec3::ONE;
    let mut radiance = DVec3::ZERO;
    for step in 0..STEPS {
        let place = |i: f64| length * air::square(i / f64::from(STEPS));
        let (from, to) = (place(f64::from(step)), place(f64::from(step + 1)));
        let point = DVec3::Y * start + view * ((from + to) / 2.0);
        let radius = point.length();
        let (by_air, by_haze, extinction) = air.at(radius);
        let sun_cosine = point.dot(sun) / radius;
        let sunlight = match distance_to_ground(radius, sun_cosine) {
            Some(_) => DVec3::ZERO,
            None => tables.transmittance(radius, sun_cosine),
        };
        let direct = sunlight * (by_air * rayleigh + by_haze * mie);
        let further = tables.further(radius, sun_cosine) * (by_air + by_haze);
        let through = air::exp(-extinction * (to - from));
        // What is scattered along the step, dimmed by the part of the step before it.
        radiance += left * (direct + further) * (DVec3::ONE - through) / extinction;
        left *= through;
    }
    radiance
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(sky: &SkyPicture, x: u32, y: u32) -> Vec3 {
        let Pixels::RgbaF32(pixels) = &sky.pixels else {
            panic!()
        };
        let [r, g, b, _] = pixels[(y * sky.size.0 + x) as usize];
        Vec3::new(r, g, b)
    }

    /// Irradiance of a level floor by the sky, without the sun.
    fn floor(sky: &SkyPicture) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for y in 0..SIZE.1 / 2 {
            let polar = (f64::from(y) + 0.5) / f64::from(SIZE.1) * PI;
            let pixel = (libm::sin(polar) * libm::cos(polar) * 2.0 * PI * PI) as f32
                / (SIZE.0 * SIZE.1) as f32;
            for x in 0..SIZE.0 {
                sum += at(sky, x, y) * pixel;
            }
        }
        sum
    }

    #[test]
    fn a_clear_sky_is_blue_overhead_and_pale_at_the_horizon() {
        let sky = sky(&Daylight::default());
        let (zenith, horizon) = (at(&sky, 0, 0), at(&sky, 128, 63));
        assert!(zenith.z > 2.0 * zenith.x, "{zenith}");
        assert!(horizon.z < 1.6 * horizon.x, "{horizon}");
        assert!(horizon.y > zenith.y);
    }

    #[test]
    fn the_share_of_the_skys_light_is_as_measured() {
        // Of the light on a level floor under a clear sky and a sun at 60 degrees, 10 to 25 % come from the sky (Iqbal, An
        // Introduction to Solar Radiation, 1983, figure 7.5).
        let daylight = Daylight {
            elevation: 60.0,
            ..Daylight::default()
        };
        let sky = floor(&sky(&daylight)).y;
        let sun = daylight.sun_irradiance().y * daylight.sun().y as f32;
        let share = sky / (sky + sun);
        assert!((0.1..0.25).contains(&share), "{share}");
    }

    #[test]
    fn no_more_light_comes_down_than_in() {
        for (elevation, turbidity) in [(90.0, 1.0), (45.0, 2.0), (10.0, 4.0), (1.0, 10.0)] {
            let daylight = Daylight {
                elevation,
                turbidity,
                ..Daylight::default()
            };
            let down = floor(&sky(&daylight))
                + daylight.sun_irradiance() * daylight.sun().y.max(0.0) as f32;
            let above = Daylight::SOLAR * daylight.sun().y as f32;
            // The ground's light that comes back is in it.
            assert!(
                down.max_element() < 1.15 * above,
                "{elevation}: {down} of {above}"
            );
            assert!(down.min_element() > 0.0);
        }
    }

    #[test]
    fn a_low_sun_is_red_and_a_sunken_one_sends_nothing_but_dusk() {
        let day = |elevation| Daylight {
            elevation,
            ..Daylight::default()
        };
        let low = day(2.0).sun_irradiance();
        assert!(low.x > 3.0 * low.z, "{low}");
        let night = day(-4.0);
        assert!(night.sun_irradiance().max_element() < 1e-6);
        let dusk = floor(&sky(&night)).y;
        assert!(
            dusk > 0.0 && dusk < 0.05 * floor(&sky(&day(30.0))).y,
            "{dusk}"
        );
    }

    #[test]
    fn the_sun_stands_where_it_is_wished() {
        for (up, x, y, z) in [(Vec3::Y, 1.0, 2.0, -3.0), (Vec3::Z, -1.0, 0.5, 0.1)] {
            let direction = Vec3::new(x, y, z).normalize();
            let daylight = Daylight::default().with_sun(direction * 7.0, up);
            let found = Axes::new(up, 0.0).world(daylight.sun());
            assert!((found - direction).length() < 1e-6, "{found}");
        }
    }

    #[test]
    fn the_sky_is_brightest_about_the_sun() {
        let daylight = Daylight {
            azimuth: 0.0,
            ..Daylight::default()
        };
        let sky = sky(&daylight);
        // 40 degrees up are 50 from the zenith; the middle column is the right axis.
        let near = at(&sky, 127, 35);
        for (x, y) in [(0, 35), (64, 35), (191, 35), (128, 5)] {
            assert!(near.y > 1.5 * at(&sky, x, y).y);
        }
    }
}
