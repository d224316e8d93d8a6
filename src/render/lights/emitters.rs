//! Triangles that emit light.

use glam::{Vec2, Vec3};

use super::Incident;
use crate::accel::Hit;
use crate::geometry::Triangle;
use crate::render::stage::StagedInstance;
use crate::render::texture::{ColorSpace, lookup};
use crate::scene::Scene;

/// One of them, in world space.
#[derive(Clone, Debug)]
struct Emitter {
    triangle: Triangle,
    /// Unit normal; `None` for a triangle that its placement squashed to a line.
    normal: Option<Vec3>,
    uvs: [Vec2; 3],
    material: u32,
    area: f32,
    /// How far before the triangle a ray must end so as not to meet it, in model units.
    offset: f32,
}

/// A run of triangles of an instance that emit.
#[derive(Clone, Copy, Debug)]
struct Run {
    instance: u32,
    first_triangle: u32,
    first_emitter: u32,
}

/// All of a scene, chosen by their power.
#[derive(Debug, Default)]
pub(super) struct Emitters {
    emitters: Vec<Emitter>,
    /// For each emitter, the power of it and all before it, as a share of the whole.
    cumulative: Vec<f64>,
    /// By instance, then by triangle.
    runs: Vec<Run>,
}

impl Emitters {
    pub(super) fn new(scene: &Scene, staged: &[StagedInstance]) -> Self {
        let (emitters, runs) = find(scene, staged);
        let power = |e: &Emitter| {
            let emissive = scene.materials[e.material as usize].emissive;
            f64::from(e.area) * f64::from(emissive.element_sum())
        };
        let total: f64 = emitters.iter().map(power).sum();
        if total <= 0.0 {
            return Self::default();
        }
        let mut sum = 0.0;
        let mut share = |e: &Emitter| {
            sum += power(e);
            sum / total
        };
        Self {
            cumulative: emitters.iter().map(&mut share).collect(),
            emitters,
            runs,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.emitters.len()
    }

    /// The chance with which an emitter is chosen.
    fn chance(&self, index: usize) -> f32 {
        let before = match index {
            0 => 0.0,
            index => self.cumulative[index - 1],
        };
        (self.cumulative[index] - before) as f32
    }

    /// Light from a point of an emitter, chosen with the numbers given. There must be emitters.
    pub(super) fn sample(
        &self,
        scene: &Scene,
        point: Vec3,
        choice: f32,
        [u, v]: [f32; 2],
    ) -> Option<Incident> {
        let choice = f64::from(choice);
        let index = self.cumulative.partition_point(|&c| c <= choice);
        let index = index.min(self.emitters.len() - 1);
        let emitter = &self.emitters[index];
        // Uniform over the triangle: Turk's square root (Graphics Gems, 1990).
        let root = u.sqrt();
        let weights = [1.0 - root, root * (1.0 - v), root * v];
        let [a, b, c] = *emitter.triangle.corners();
        let place = a * weights[0] + b * weights[1] + c * weights[2];
        let normal = emitter.normal?;
        let to_light = place - point;
        let squared = to_light.length_squared();
        let direction = to_light / squared.sqrt();
        let facing = direction.dot(normal);
        let target = place - normal * emitter.offset.copysign(facing);
        let material = &scene.materials[emitter.material as usize];
        let texel = material.emissive_texture.map_or(Vec3::ONE, |texture| {
            let [a, b, c] = emitter.uvs;
            let uv = a * weights[0] + b * weights[1] + c * weights[2];
            lookup(scene, &texture, uv, ColorSpace::Srgb).truncate()
        });
        let density = squared * self.chance(index) / (facing.abs() * emitter.area);
        Incident {
            direction,
            target: Some(target),
            irradiance: material.emissive * texel / density,
            density,
        }
        .if_lit()
    }

    /// The density, per steradian, with which [`Emitters::sample`] chooses the direction from `point` to a hit at `place`. 0 where the
    /// hit is on no emitter.
    pub(super) fn density(&self, hit: Hit, point: Vec3, place: Vec3) -> f32 {
        let after = self
            .runs
            .partition_point(|r| (r.instance, r.first_triangle) <= (hit.instance, hit.triangle));
        let Some(run) = after.checked_sub(1).map(|i| &self.runs[i]) else {
            return 0.0;
        };
        if run.instance != hit.instance {
            return 0.0;
        }
        // The triangles between two runs of an instance emit nothing: they are not asked about.
        let index = (run.first_emitter + hit.triangle - run.first_triangle) as usize;
        let Some(emitter) = self.emitters.get(index) else {
            return 0.0;
        };
        let Some(normal) = emitter.normal else {
            return 0.0;
        };
        let to_light = place - point;
        let squared = to_light.length_squared();
        let facing = (to_light / squared.sqrt()).dot(normal).abs();
        squared * self.chance(index) / (facing * emitter.area)
    }
}

fn find(scene: &Scene, staged: &[StagedInstance]) -> (Vec<Emitter>, Vec<Run>) {
    let (mut emitters, mut runs) = (Vec::new(), Vec::new());
    for (index, (instance, staged)) in scene.instances.iter().zip(staged).enumerate() {
        let mesh = &scene.meshes[instance.mesh as usize];
        for part in &mesh.parts {
            let material = &scene.materials[part.material as usize];
            if material.emissive == Vec3::ZERO || material.unlit {
                continue;
            }
            runs.push(Run {
                instance: index as u32,
                first_triangle: part.first_triangle,
                first_emitter: emitters.len() as u32,
            });
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
                emitters.push(Emitter {
                    area: triangle.area(),
                    offset: staged.offset(&triangle),
                    normal: triangle.normal(),
                    triangle,
                    uvs,
                    material: part.material,
                });
            }
        }
    }
    (emitters, runs)
}
