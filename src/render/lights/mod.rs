//! The lights that stand in the scene: punctual lights and emissive triangles.

mod emitters;
mod power;
mod punctual;
mod tree;

use glam::Vec3;

use self::emitters::Emitters;
use super::environment::EnvironmentSample;
use super::stage::{Stage, StagedInstance};
use super::texture::Textures;
use crate::accel::Hit;
use crate::scene::{Light, LightKind, Scene};

/// Light that arrives at a point from one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Incident {
    /// Unit vector to the light.
    pub(super) direction: Vec3,
    /// Where the light is; `None` for light from infinitely far.
    pub(super) target: Option<Vec3>,
    /// Irradiance on a surface across the direction, divided by the probability with which it was chosen.
    pub(super) irradiance: Vec3,
    /// Density with which the direction was chosen, per steradian; infinite for lights of no size.
    pub(super) density: f32,
}

impl Incident {
    /// Light from a direction of the environment.
    pub(super) fn far(found: &EnvironmentSample) -> Self {
        Self {
            direction: found.direction,
            target: None,
            irradiance: found.radiance / found.density,
            density: found.density,
        }
    }

    /// `None` for no light, and for light from the point itself, which has no direction.
    fn if_lit(self) -> Option<Self> {
        (self.irradiance.is_finite() && self.irradiance != Vec3::ZERO).then_some(self)
    }
}

/// Where light is needed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Receiver {
    pub(super) position: Vec3,
    /// Unit normal of the side that light counts on; zero where it counts on both.
    pub(super) normal: Vec3,
}

/// The lights of a scene.
#[derive(Debug)]
pub struct Lights {
    punctual: Vec<Light>,
    emitters: Emitters,
}

impl Lights {
    /// All of the scene.
    pub(super) fn new(scene: &Scene, instances: &[StagedInstance], textures: &Textures) -> Self {
        Self {
            punctual: scene.lights.clone(),
            emitters: Emitters::new(scene, instances, textures),
        }
    }

    /// With emitters chosen by their power alone, wherever light is needed.
    pub(super) fn by_power(self) -> Self {
        Self {
            emitters: self.emitters.by_power(),
            ..self
        }
    }

    /// How many triangles emit light.
    pub fn emitter_count(&self) -> usize {
        self.emitters.count()
    }

    /// Whether anything is sampled with [`Lights::emitter`].
    pub(super) fn has_emitters(&self) -> bool {
        self.emitters.count() > 0
    }

    /// Whether there are lights of no size.
    pub(super) fn has_punctual(&self) -> bool {
        !self.punctual.is_empty()
    }

    /// Whether [`Lights::one_punctual`] has a choice.
    pub(super) fn has_many_punctual(&self) -> bool {
        self.punctual.len() > 1
    }

    /// Light from each punctual light at a point.
    pub(super) fn punctual(&self, point: Vec3) -> impl Iterator<Item = Incident> + '_ {
        self.punctual
            .iter()
            .filter_map(move |light| punctual::incident(light, point))
    }

    /// Light from one punctual light at a point, chosen with `choice` by how much of it counts: `worth` has the share for each
    /// direction.
    pub(super) fn one_punctual(
        &self,
        point: Vec3,
        mut choice: f32,
        worth: impl Fn(Vec3) -> f32,
    ) -> Option<Incident> {
        if !self.has_many_punctual() {
            // There is no choice, whatever it is worth.
            return self.punctual(point).next();
        }
        // One pass: each light takes the place of the one kept so far with the chance that makes all of them right.
        let mut kept: Option<(Incident, f32)> = None;
        let mut total = 0.0;
        for incident in self.punctual(point) {
            let weight = incident.irradiance.element_sum() * worth(incident.direction);
            let counts = weight > 0.0 && weight.is_finite();
            if !counts {
                continue;
            }
            total += weight;
            let chance = weight / total;
            if choice < chance {
                kept = Some((incident, weight));
                choice /= chance;
            } else {
                choice = (choice - chance) / (1.0 - chance);
            }
        }
        let (mut incident, weight) = kept?;
        incident.irradiance *= total / weight;
        Some(incident)
    }

    /// Light from a point of an emissive triangle, chosen with the numbers given by how much light each may send to the receiver. There must be emitters.
    pub(super) fn emitter(
        &self,
        stage: &Stage,
        receiver: &Receiver,
        choice: f32,
        place: [f32; 2],
    ) -> Option<Incident> {
        self.emitters.sample(stage, receiver, choice, place)
    }

    /// The density with which [`Lights::emitter`] chooses the direction from a receiver to a hit at `place` on an emitter.
    pub(super) fn emitter_density(&self, hit: Hit, receiver: &Receiver, place: Vec3) -> f32 {
        self.emitters.density(hit, receiver, place)
    }
}

/// Whether the scene has a light from infinitely far: a sun of its own.
pub(super) fn has_directional(scene: &Scene) -> bool {
    let mut lights = scene.lights.iter();
    lights.any(|light| light.kind == LightKind::Directional)
}

/// A unit vector at an angle with the given cosine from `axis`, turned around it by a share `turn` of the full circle.
pub(super) fn around(axis: Vec3, cosine: f32, turn: f32) -> Vec3 {
    let (tangent, bitangent) = axis.any_orthonormal_pair();
    let (x, y) = ring(cosine, turn);
    (tangent * x + bitangent * y + axis * cosine).normalize()
}

/// As [`around`] the axis z.
pub(super) fn around_z(cosine: f32, turn: f32) -> Vec3 {
    let (x, y) = ring(cosine, turn);
    Vec3::new(x, y, cosine).normalize()
}

fn ring(cosine: f32, turn: f32) -> (f32, f32) {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (s, c) = libm::sincosf(turn * std::f32::consts::TAU);
    (sine * c, sine * s)
}

/// A unit vector of the hemisphere around `normal`, chosen with a density of its cosine over pi.
pub(super) fn cosine_hemisphere(normal: Vec3, [u, v]: [f32; 2]) -> Vec3 {
    around(normal, (1.0 - u).sqrt(), v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hemisphere_samples_follow_the_cosine() {
        let normal = Vec3::new(1.0, -2.0, 0.5).normalize();
        let n = 64;
        let mut mean = Vec3::ZERO;
        for i in 0..n * n {
            let u = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
            let d = cosine_hemisphere(normal, u);
            assert!(d.dot(normal) >= 0.0 && (d.length() - 1.0).abs() < 1e-5);
            mean += d / (n * n) as f32;
        }
        // The mean of the cosine under a density of cosine over pi is 2/3.
        assert!((mean - normal * (2.0 / 3.0)).length() < 1e-3, "{mean}");
    }

    #[test]
    fn any_orthonormal_pair_has_no_bad_axis() {
        for axis in [
            Vec3::X,
            Vec3::NEG_X,
            Vec3::Y,
            Vec3::Z,
            Vec3::NEG_Z,
            Vec3::new(0.0, 1e-20, -1.0),
        ] {
            assert!((around(axis, 0.5, 0.3).dot(axis) - 0.5).abs() < 1e-6);
        }
    }

    #[test]
    fn one_light_stands_for_all_on_average() {
        let light = |intensity: f32, x: f32| Light {
            name: String::new(),
            kind: LightKind::Point,
            intensity: Vec3::splat(intensity),
            position: Vec3::new(x, 1.5, 0.0),
            direction: Vec3::NEG_Y,
            range: None,
        };
        let scene = Scene {
            lights: vec![light(3.0, -1.0), light(0.0, 0.0), light(5.0, 2.0)],
            ..Scene::default()
        };
        let lights = Lights::new(&scene, &[], &Textures::default());
        let all: f32 = lights.punctual(Vec3::ZERO).map(|i| i.irradiance.x).sum();
        let n = 1000;
        let worth = |d: Vec3| if d.x < 0.0 { 0.25 } else { 1.0 };
        let picks = (0..n).filter_map(|i| {
            let choice = (i as f32 + 0.5) / n as f32;
            lights.one_punctual(Vec3::ZERO, choice, worth)
        });
        let mean = picks.map(|i| i.irradiance.x).sum::<f32>() / n as f32;
        assert!((mean - all).abs() < 1e-3 * all, "{mean} for {all}");
    }
}
