//! Everything that sends light: punctual lights, emissive triangles, a sky and its sun.

use glam::{Vec2, Vec3};

use super::stage::StagedInstance;
use super::texture::{ColorSpace, lookup};
use crate::geometry::Triangle;
use crate::scene::{Light, LightKind, Scene, Sky};

/// Light that arrives at a point from one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Incident {
    /// Unit vector to the light.
    pub(super) direction: Vec3,
    /// Where the light is; `None` for light from infinitely far.
    pub(super) target: Option<Vec3>,
    /// Irradiance on a surface across the direction, divided by the probability with which it was chosen.
    pub(super) irradiance: Vec3,
}

impl Incident {
    /// `None` for no light, and for light from the point itself, which has no direction.
    fn if_lit(self) -> Option<Self> {
        (self.irradiance.is_finite() && self.irradiance != Vec3::ZERO).then_some(self)
    }
}

/// The sun that comes with the sky: a disc, so that its shadows have soft edges.
#[derive(Clone, Copy, Debug)]
struct Sun {
    /// Unit vector to the sun's middle.
    direction: Vec3,
    /// Cosine of the disc's angular radius.
    cos_radius: f32,
    /// Irradiance on a surface across its direction.
    irradiance: Vec3,
}

/// Angular radius of our sun, in degrees: larger than the real one (0.27), so that shadows soften within the size of a model.
const SUN_RADIUS: f64 = 1.5;

/// A triangle that emits light.
#[derive(Clone, Debug)]
struct Emitter {
    triangle: Triangle,
    uvs: [Vec2; 3],
    material: u32,
    area: f32,
    /// How far before the triangle a ray must end so as not to meet it, in model units.
    offset: f32,
}

/// The lights of a scene.
#[derive(Debug)]
pub struct Lights {
    punctual: Vec<Light>,
    emitters: Vec<Emitter>,
    /// For each emitter, the power of it and all before it, as a share of the whole.
    emitter_cdf: Vec<f64>,
    sky: Option<Sky>,
    sun: Option<Sun>,
}

impl Lights {
    /// The scene's own lights, and a sky if given, with its sun unless the scene brings one.
    pub(super) fn new(scene: &Scene, instances: &[StagedInstance], sky: Option<Sky>) -> Self {
        let emitters = emitters(scene, instances);
        let power = |e: &Emitter| {
            let emissive = scene.materials[e.material as usize].emissive;
            f64::from(e.area) * f64::from(emissive.element_sum())
        };
        let total: f64 = emitters.iter().map(power).sum();
        let mut sum = 0.0;
        let mut share = |e: &Emitter| {
            sum += power(e);
            sum / total
        };
        let emitter_cdf = emitters.iter().map(&mut share).collect();
        Self {
            punctual: scene.lights.clone(),
            emitter_cdf,
            emitters,
            sun: sky
                .filter(|_| !has_directional(scene))
                .map(|sky| Sun::of(&sky)),
            sky,
        }
    }

    /// Our own sun, if it shines: the direction to it, its radius in degrees, and its irradiance on a surface across.
    pub(super) fn sun_disc(&self) -> Option<(Vec3, f64, Vec3)> {
        let sun = self.sun?;
        Some((sun.direction, SUN_RADIUS, sun.irradiance))
    }

    /// Takes our own sky and its sun away.
    pub(super) fn remove_sky(&mut self) {
        self.sky = None;
        self.sun = None;
    }

    /// The sky, if there is one.
    pub fn sky(&self) -> Option<&Sky> {
        self.sky.as_ref()
    }

    /// How many triangles emit light.
    pub fn emitter_count(&self) -> usize {
        self.emitters.len()
    }

    /// Whether anything is sampled with [`Lights::emitter`].
    pub(super) fn has_emitters(&self) -> bool {
        !self.emitters.is_empty()
    }

    /// Light from each punctual light at a point.
    pub(super) fn punctual(&self, point: Vec3) -> impl Iterator<Item = Incident> + '_ {
        self.punctual
            .iter()
            .filter_map(move |light| from_punctual(light, point))
    }

    /// Light from a point of an emissive triangle, chosen by power with the numbers given.
    pub(super) fn emitter(
        &self,
        scene: &Scene,
        point: Vec3,
        choice: f32,
        [u, v]: [f32; 2],
    ) -> Option<Incident> {
        let choice = f64::from(choice);
        let index = self
            .emitter_cdf
            .partition_point(|&c| c <= choice)
            .min(self.emitters.len() - 1);
        let emitter = &self.emitters[index];
        let before = if index == 0 {
            0.0
        } else {
            self.emitter_cdf[index - 1]
        };
        let probability = (self.emitter_cdf[index] - before) as f32;
        // Uniform over the triangle: Turk's square root (Graphics Gems, 1990).
        let root = u.sqrt();
        let weights = [1.0 - root, root * (1.0 - v), root * v];
        let [a, b, c] = *emitter.triangle.corners();
        let place = a * weights[0] + b * weights[1] + c * weights[2];
        let normal = emitter.triangle.normal()?;
        let to_light = place - point;
        let squared = to_light.length_squared();
        let direction = to_light / squared.sqrt();
        let facing = direction.dot(normal);
        let cosine = facing.abs();
        let target = place - normal * emitter.offset.copysign(facing);
        let material = &scene.materials[emitter.material as usize];
        let texel = material.emissive_texture.map_or(Vec3::ONE, |texture| {
            let [a, b, c] = emitter.uvs;
            let uv = a * weights[0] + b * weights[1] + c * weights[2];
            lookup(scene, &texture, uv, ColorSpace::Srgb).truncate()
        });
        let irradiance =
            material.emissive * texel * (cosine * emitter.area / (squared * probability));
        Incident {
            direction,
            target: Some(target),
            irradiance,
        }
        .if_lit()
    }

    /// Light from a point of the sun's disc.
    pub(super) fn sun(&self, [u, v]: [f32; 2]) -> Option<Incident> {
        let sun = self.sun?;
        let cosine = 1.0 - u * (1.0 - sun.cos_radius);
        let direction = around(sun.direction, cosine, v);
        Some(Incident {
            direction,
            target: None,
            irradiance: sun.irradiance,
        })
    }
}

impl Sun {
    /// The sun of a sky: high, before the scene, to the left of the usual camera.
    fn of(sky: &Sky) -> Self {
        let up = sky.up;
        let front = if up.z.abs() > 0.9 {
            Vec3::NEG_Y
        } else {
            Vec3::Z
        };
        let front = (front - up * front.dot(up)).normalize_or(Vec3::X);
        let right = up.cross(front);
        Self {
            direction: (front * 0.55 - right * 0.45 + up).normalize(),
            cos_radius: libm::cos(SUN_RADIUS.to_radians()) as f32,
            irradiance: Vec3::new(2.10, 1.98, 1.80),
        }
    }
}

/// Whether the scene has a light from infinitely far: a sun of its own.
pub(super) fn has_directional(scene: &Scene) -> bool {
    let mut lights = scene.lights.iter();
    lights.any(|light| light.kind == LightKind::Directional)
}

fn emitters(scene: &Scene, staged: &[StagedInstance]) -> Vec<Emitter> {
    let mut emitters = Vec::new();
    for (instance, staged) in scene.instances.iter().zip(staged) {
        let mesh = &scene.meshes[instance.mesh as usize];
        for part in &mesh.parts {
            let material = &scene.materials[part.material as usize];
            if material.emissive == Vec3::ZERO || material.unlit {
                continue;
            }
            let uv_set = material
                .emissive_texture
                .and_then(|t| mesh.uv_sets.get(t.uv_set as usize));
            for corners in
                &mesh.triangles[part.first_triangle as usize..][..part.triangle_count as usize]
            {
                let [a, b, c] = corners.map(|v| instance.world_point(mesh.positions[v as usize]));
                let triangle = Triangle::new(a, b, c);
                let uvs = corners.map(|v| {
                    uv_set
                        .and_then(|s| s.get(v as usize))
                        .copied()
                        .unwrap_or(Vec2::ZERO)
                });
                let area = triangle.area();
                if area > 0.0 {
                    let offset = staged.offset(&triangle);
                    emitters.push(Emitter {
                        triangle,
                        uvs,
                        material: part.material,
                        area,
                        offset,
                    });
                }
            }
        }
    }
    emitters
}

/// KHR_lights_punctual: intensity over the square of the distance, a window that fades to nothing at the range, and a smooth
/// edge between a spot's two cones.
fn from_punctual(light: &Light, point: Vec3) -> Option<Incident> {
    if light.kind == LightKind::Directional {
        return Some(Incident {
            direction: -light.direction,
            target: None,
            irradiance: light.intensity,
        });
    }
    let to_light = light.position - point;
    let squared = to_light.length_squared();
    let distance = squared.sqrt();
    let direction = to_light / distance;
    let window = light.range.map_or(1.0, |range| {
        let ratio = distance / range;
        (1.0 - ratio * ratio * ratio * ratio).clamp(0.0, 1.0)
    });
    let cone = match light.kind {
        LightKind::Spot {
            inner_angle,
            outer_angle,
        } => {
            let [inner, outer] = [inner_angle, outer_angle].map(libm::cosf);
            let within = ((-direction.dot(light.direction) - outer) / (inner - outer).max(1e-3))
                .clamp(0.0, 1.0);
            within * within
        }
        _ => 1.0,
    };
    let irradiance = light.intensity * (window * cone / squared);
    Incident {
        direction,
        target: Some(light.position),
        irradiance,
    }
    .if_lit()
}

/// A unit vector at an angle with the given cosine from `axis`, turned around it by a share `turn` of the full circle.
pub(super) fn around(axis: Vec3, cosine: f32, turn: f32) -> Vec3 {
    let (tangent, bitangent) = axis.any_orthonormal_pair();
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (s, c) = libm::sincosf(turn * std::f32::consts::TAU);
    (tangent * (sine * c) + bitangent * (sine * s) + axis * cosine).normalize()
}

/// A unit vector of the hemisphere around `normal`, chosen with a density of its cosine over pi.
pub(super) fn cosine_hemisphere(normal: Vec3, [u, v]: [f32; 2]) -> Vec3 {
    around(normal, (1.0 - u).sqrt(), v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(kind: LightKind) -> Light {
        Light {
            name: String::new(),
            kind,
            intensity: Vec3::new(12.0, 8.0, 4.0),
            position: Vec3::new(0.0, 2.0, 0.0),
            direction: Vec3::NEG_Y,
            range: None,
        }
    }

    #[test]
    fn point_lights_follow_the_inverse_square() {
        let i = from_punctual(&light(LightKind::Point), Vec3::ZERO).expect("lit");
        assert_eq!(
            (i.direction, i.irradiance),
            (Vec3::Y, Vec3::new(3.0, 2.0, 1.0))
        );
        assert_eq!(i.target, Some(Vec3::new(0.0, 2.0, 0.0)));
        let faded = Light {
            range: Some(2.0),
            ..light(LightKind::Point)
        };
        assert!(from_punctual(&faded, Vec3::ZERO).is_none());
    }

    #[test]
    fn spots_light_their_cone_only() {
        let spot = light(LightKind::Spot {
            inner_angle: 0.3,
            outer_angle: 0.5,
        });
        let full = from_punctual(&spot, Vec3::ZERO).expect("on the axis");
        assert_eq!(full.irradiance, Vec3::new(3.0, 2.0, 1.0));
        let edge =
            from_punctual(&spot, Vec3::new(2.0 * 0.42, 0.0, 0.0)).expect("between the cones");
        assert!(edge.irradiance.x > 0.0 && edge.irradiance.x < 2.0);
        assert!(from_punctual(&spot, Vec3::new(2.0, 0.0, 0.0)).is_none());
    }

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
}
