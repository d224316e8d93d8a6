//! Light from infinitely far, from all sides: an even colour, a picture, a gradient, or the sky with its sun.
//!
//! Radiance is linear, Rec. 709. Directions are unit vectors in world space that point to the light. A picture is equirectangular: its top
//! row is overhead, its middle column lies in the direction of the right axis (+X if +Y or +Z is up), and columns to the right
//! of it turn towards the front axis (+Z if +Y is up, -Y if +Z is): as in Blender and three.js, seen from inside it is not mirrored.

mod air;
mod ambient;
mod atmosphere;
mod distribution;
mod sun;

use std::sync::OnceLock;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use ambient::Ambient;
pub use atmosphere::Daylight;
use distribution::{Distribution, Place};
use sun::SunDisc;

use super::texture::{ColorSpace, bilinear};
use crate::scene::fetch;
use crate::scene::{Filter, Image, Pixels, Sky, Texture, Wrap};

/// Light that arrives from one direction, chosen at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSample {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Radiance from there.
    pub radiance: Vec3,
    /// The density with which the direction was chosen, per steradian; above 0.
    pub density: f32,
}

/// Light from infinitely far, from all sides.
#[derive(Debug)]
pub struct Environment {
    light: Light,
    axes: Axes,
    /// What directions are chosen by, beside the sun; `None` for evenly.
    grid: Option<Distribution>,
    sun: Option<SunDisc>,
    /// How often the sun is chosen.
    sun_share: f32,
    /// Whether the eye sees the sun's disc.
    shows_sun: bool,
    /// Worked out when it is first asked for.
    ambient: OnceLock<Ambient>,
}

#[derive(Debug)]
enum Light {
    Constant(Vec3),
    Gradient(Sky),
    Image {
        pixels: Pixels,
        size: (u32, u32),
        strength: f32,
    },
}

/// How a picture is sampled: around it goes on, and ends above and below.
const SAMPLED: Texture = Texture {
    image: 0,
    wrap_u: Wrap::Repeat,
    wrap_v: Wrap::ClampToEdge,
    filter: Filter::Linear,
};

/// Cells by which the gradient sky is chosen; it changes slowly.
const GRADIENT_CELLS: (u32, u32) = (16, 32);

/// Bounds of how often a sun is chosen: neither it nor the sky may be starved.
const SUN_SHARES: (f32, f32) = (0.1, 0.9);

impl Environment {
    /// The same radiance from everywhere.
    pub fn constant(radiance: Vec3) -> Self {
        Self::new(Light::Constant(radiance), Axes::new(Vec3::Y, 0.0), None)
    }

    /// An equirectangular picture times `strength`, under the upward axis `up`, turned about it by `rotation` degrees,
    /// counter-clockwise as seen from above. Pictures of 8 and 16 bits are taken as sRGB. `None` if the image has no pixels.
    ///
    /// Its choice takes 4 bytes a pixel beside the pixels.
    pub fn image(image: Image, up: Vec3, rotation: f64, strength: f32) -> Option<Self> {
        let pixels = image
            .pixels
            .filter(|_| image.width > 0 && image.height > 0)?;
        let size = (image.width, image.height);
        let grid = grid_of(&pixels, size);
        let light = if grid.is_some() && strength > 0.0 {
            Light::Image {
                pixels,
                size,
                strength,
            }
        } else {
            Light::Constant(Vec3::ZERO)
        };
        Some(Self {
            grid,
            ..Self::new(light, Axes::new(up, rotation), None)
        })
    }

    /// The sky and sun of a clear day.
    pub fn daylight(daylight: &Daylight, up: Vec3) -> Self {
        let axes = Axes::new(up, 0.0);
        let sky = atmosphere::sky(daylight);
        let sun = daylight.sun_irradiance();
        let disc = SunDisc::new(axes.world(daylight.sun()), Daylight::SUN_RADIUS, sun);
        let grid = grid_of(&sky.pixels, sky.size);
        let light = Light::Image {
            pixels: sky.pixels,
            size: sky.size,
            strength: 1.0,
        };
        let disc = Some(disc).filter(|_| sun.max_element() > 0.0);
        Self {
            grid,
            shows_sun: true,
            ..Self::new(light, axes, disc)
        }
        .with_sun_share()
    }

    /// A gradient sky, and light from a sun high before the scene, to the left of the usual camera. The eye does not see its disc.
    pub(super) fn studio(sky: Sky, has_sun: bool) -> Self {
        let axes = Axes::new(sky.up, 0.0);
        let (width, height) = GRADIENT_CELLS;
        let weight = |_, y: u32| {
            let polar = (f64::from(y) + 0.5) / f64::from(height) * std::f64::consts::PI;
            luminance(sky.radiance(axes.direction(Place {
                turn: 0.0,
                cosine: libm::cos(polar),
            })))
        };
        let grid = Distribution::new(width, height, weight);
        let sun = has_sun.then(|| SunDisc::of_studio(axes.world(sun::STUDIO_DIRECTION)));
        Self {
            grid,
            ..Self::new(Light::Gradient(sky), axes, sun)
        }
        .with_sun_share()
    }

    fn new(light: Light, axes: Axes, sun: Option<SunDisc>) -> Self {
        Self {
            light,
            axes,
            grid: None,
            sun,
            sun_share: 0.0,
            shows_sun: false,
            ambient: OnceLock::new(),
        }
    }

    /// Chooses the sun as often as its light is of that which falls on a floor.
    fn with_sun_share(mut self) -> Self {
        let Some(sun) = self.sun else { return self };
        let n = 16;
        let mut sky = 0.0;
        for i in 0..n * n {
            // Evenly by the cosine, of the upper half.
            let place = Place {
                turn: (f64::from(i % n) + 0.5) / f64::from(n),
                cosine: ((f64::from(i / n) + 0.5) / f64::from(n)).sqrt(),
            };
            sky += luminance(self.far(self.axes.direction(place))) / (n * n) as f32;
        }
        let sun = luminance(sun.irradiance());
        let share = sun / (sun + sky * std::f32::consts::PI);
        self.sun_share = share.clamp(SUN_SHARES.0, SUN_SHARES.1);
        self
    }

    /// Radiance from a direction, the sun included.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let sun = self.sun.map_or(Vec3::ZERO, |sun| sun.radiance(direction));
        self.far(direction) + sun
    }

    /// Whether its light, but for the sun's, changes so slowly that a surface finds it best by its own ways of scattering.
    pub(super) fn is_even(&self) -> bool {
        !matches!(self.light, Light::Image { .. })
    }

    /// A direction that is worth a ray to look for light: of the sun alone where the rest is even.
    pub(super) fn search(&self, numbers: [f32; 2]) -> Option<EnvironmentSample> {
        if self.is_even() {
            self.sample_sun(numbers)
        } else {
            self.sample(numbers)
        }
    }

    /// Radiance from a direction in two parts: what [`Self::search`] never finds, and what it finds, with the density of that.
    pub(super) fn parts(&self, direction: Vec3) -> (Vec3, Vec3, f32) {
        if !self.is_even() {
            let (radiance, density) = (self.radiance(direction), self.density(direction));
            return (Vec3::ZERO, radiance, density);
        }
        let far = self.far(direction);
        self.sun.map_or((far, Vec3::ZERO, 0.0), |sun| {
            (far, sun.radiance(direction), sun.density(direction))
        })
    }

    /// What the eye sees in a direction: [`Self::radiance`], but without the disc of a sun that is only meant to light.
    pub fn backdrop(&self, direction: Vec3) -> Vec3 {
        if self.shows_sun {
            self.radiance(direction)
        } else {
            self.far(direction)
        }
    }

    /// A direction chosen about as its radiance, with the numbers given, from 0 below 1. `None` if all is black.
    pub fn sample(&self, [u, v]: [f32; 2]) -> Option<EnvironmentSample> {
        let direction = match self.sun {
            Some(sun) if u < self.sun_share => sun.sample([u / self.sun_share, v]),
            _ => self.sample_far([(u - self.sun_share) / (1.0 - self.sun_share), v]),
        };
        let sample = EnvironmentSample {
            direction,
            radiance: self.radiance(direction),
            density: self.density(direction),
        };
        (sample.density > 0.0 && sample.radiance != Vec3::ZERO).then_some(sample)
    }

    /// A direction to the sun alone, with its light alone, for those who ask for one of either. `None` if there is no sun.
    pub fn sample_sun(&self, numbers: [f32; 2]) -> Option<EnvironmentSample> {
        let sun = self.sun?;
        let direction = sun.sample(numbers);
        let sample = EnvironmentSample {
            direction,
            radiance: sun.radiance(direction),
            density: sun.density(direction),
        };
        // Rounding may take it beside the disc.
        (sample.density > 0.0).then_some(sample)
    }

    /// A direction chosen by all light but the sun's, with that light alone. `None` if it is black.
    pub fn sample_sky(&self, numbers: [f32; 2]) -> Option<EnvironmentSample> {
        let direction = self.sample_far(numbers);
        let sample = EnvironmentSample {
            direction,
            radiance: self.far(direction),
            density: self.far_density(direction),
        };
        (sample.density > 0.0 && sample.radiance != Vec3::ZERO).then_some(sample)
    }

    /// The density with which [`Self::sample`] chooses a direction, per steradian. Above 0 where there is light.
    pub fn density(&self, direction: Vec3) -> f32 {
        let sun = self.sun.map_or(0.0, |sun| sun.density(direction));
        self.far_density(direction) * (1.0 - self.sun_share) + sun * self.sun_share
    }

    fn far_density(&self, direction: Vec3) -> f32 {
        match &self.grid {
            Some(grid) => grid.density(self.axes.place(direction)),
            None => 0.25 * std::f32::consts::FRAC_1_PI,
        }
    }

    /// The radiance that a white matt surface with this normal (unit) sends back, if nothing but the sun is hidden from it.
    pub(super) fn ambient(&self, normal: Vec3) -> Vec3 {
        let ambient = || Ambient::new(|direction| self.far(direction));
        self.ambient.get_or_init(ambient).at(normal)
    }

    /// Radiance of all but the sun.
    pub(super) fn far(&self, direction: Vec3) -> Vec3 {
        match &self.light {
            Light::Constant(radiance) => *radiance,
            Light::Gradient(sky) => sky.radiance(direction),
            Light::Image {
                pixels,
                size,
                strength,
            } => {
                let at = self.axes.place(direction).uv();
                let texel = bilinear(pixels, *size, &SAMPLED, at, ColorSpace::Srgb);
                texel.truncate() * *strength
            }
        }
    }

    fn sample_far(&self, numbers: [f32; 2]) -> Vec3 {
        let place = match &self.grid {
            Some(grid) => grid.sample(numbers),
            None => Place {
                turn: f64::from(numbers[0]),
                cosine: 1.0 - 2.0 * f64::from(numbers[1]),
            },
        };
        self.axes.direction(place)
    }
}

impl Place {
    /// The coordinates of the place in a picture.
    fn uv(self) -> Vec2 {
        let polar = libm::acos(self.cosine.clamp(-1.0, 1.0));
        Vec2::new(self.turn as f32, (polar / std::f64::consts::PI) as f32)
    }
}

/// The axes that a picture is laid around: each of unit length, at right angles.
#[derive(Clone, Copy, Debug)]
struct Axes {
    /// The direction of the middle column, at the horizon.
    right: DVec3,
    up: DVec3,
    /// The direction of three quarters of the picture's width.
    front: DVec3,
}

impl Axes {
    /// The axes under the upward axis `up`, turned about it by `rotation` degrees, counter-clockwise as seen from above.
    fn new(up: Vec3, rotation: f64) -> Self {
        let up = up.as_dvec3().normalize_or(DVec3::Y);
        let front = if up.z.abs() > 0.9 {
            DVec3::NEG_Y
        } else {
            DVec3::Z
        };
        let front = (front - up * front.dot(up)).normalize_or(DVec3::X);
        let right = up.cross(front);
        let (s, c) = (
            libm::sin(rotation.to_radians()),
            libm::cos(rotation.to_radians()),
        );
        Self {
            right: right * c - front * s,
            up,
            front: front * c + right * s,
        }
    }

    fn place(&self, direction: Vec3) -> Place {
        let direction = direction.as_dvec3();
        let [x, y, z] = [self.right, self.up, self.front].map(|axis| axis.dot(direction));
        let turn = libm::atan2(z, x) / std::f64::consts::TAU + 0.5;
        Place {
            turn: if turn.is_nan() { 0.0 } else { turn },
            cosine: y.clamp(-1.0, 1.0),
        }
    }

    fn direction(&self, place: Place) -> Vec3 {
        let angle = (place.turn - 0.5) * std::f64::consts::TAU;
        let sine = (1.0 - place.cosine * place.cosine).max(0.0).sqrt();
        self.world(DVec3::new(
            libm::cos(angle) * sine,
            place.cosine,
            libm::sin(angle) * sine,
        ))
    }

    /// World space from coordinates along these axes.
    fn world(&self, along: DVec3) -> Vec3 {
        let world = self.right * along.x + self.up * along.y + self.front * along.z;
        world.normalize_or(self.up).as_vec3()
    }
}

/// The choice by a picture's luminance: a cell a pixel, weighted by the mean of the bilinear lookup in it, so that no cell is left out into
/// which a neighbour shines.
fn grid_of(pixels: &Pixels, size: (u32, u32)) -> Option<Distribution> {
    let (w, h) = (size.0 as usize, size.1 as usize);
    let of = |i: usize| luminance(fetch(pixels, i, ColorSpace::Srgb).truncate());
    let luminances: Vec<f32> = (0..w * h).into_par_iter().map(of).collect();
    let weight = |x: u32, y: u32| {
        let (x, y) = (x as usize, y as usize);
        let columns = [(x + w - 1) % w, x, (x + 1) % w];
        let row = |y: usize| {
            let [a, b, c] = columns.map(|x| luminances[y * w + x]);
            a + 6.0 * b + c
        };
        row(y.saturating_sub(1)) + 6.0 * row(y) + row((y + 1).min(h - 1))
    };
    Distribution::new(size.0, size.1, weight)
}

/// Luminance of linear Rec. 709, by which sampling weighs colours.
fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests;
