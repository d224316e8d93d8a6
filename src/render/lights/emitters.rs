//! Triangles that emit light.

use glam::Vec3;

use super::tree::{Source, Tree};
use super::{Incident, Receiver, power};
use crate::accel::Hit;
use crate::geometry::{Ray, Triangle};
use crate::render::stage::{Stage, StagedInstance};
use crate::render::surface::Surface;
use crate::render::texture::Textures;
use crate::scene::Scene;

/// One of them, in world space.
#[derive(Clone, Debug)]
struct Emitter {
    triangle: Triangle,
    /// Unit normal; `None` for a triangle that its placement squashed to a line.
    normal: Option<Vec3>,
    /// The instance, and the triangle's number in its mesh.
    name: (u32, u32),
    material: u32,
    area: f32,
    /// How far before the triangle a ray must end so as not to meet it, in model units.
    offset: f32,
}

impl Emitter {
    /// Radiance back along a ray that reaches a point of the triangle at its end, where the triangle covers all of it or a share.
    fn radiance(&self, stage: &Stage, ray: &Ray) -> Vec3 {
        let material = &stage.scene.materials[self.material as usize];
        if !stage.materials[self.material as usize].is_textured && !material.has_alpha() {
            return material.emissive;
        }
        let (instance, triangle) = self.name;
        let hit = Hit {
            t: 1.0,
            instance,
            triangle,
        };
        let point = Surface::at(stage, ray, hit).material_point(stage);
        point.emission * point.alpha
    }
}

/// A run of triangles of an instance that emit.
#[derive(Clone, Copy, Debug)]
struct Run {
    instance: u32,
    first_triangle: u32,
    triangle_count: u32,
    first_emitter: u32,
}

/// All of a scene.
#[derive(Debug, Default)]
pub(super) struct Emitters {
    emitters: Vec<Emitter>,
    /// The power of each, up to a factor that all have in common.
    powers: Vec<f64>,
    /// Which is asked for light.
    tree: Tree,
    /// By instance, then by triangle.
    runs: Vec<Run>,
}

impl Emitters {
    pub(super) fn new(scene: &Scene, staged: &[StagedInstance], textures: &Textures) -> Self {
        let (emitters, runs) = find(scene, staged);
        let powers: Vec<f64> = runs
            .iter()
            .flat_map(|run| {
                let first = run.first_emitter as usize;
                let of_run = &emitters[first..first + run.triangle_count as usize];
                let triangles: Vec<_> = of_run.iter().map(|e| (e.name.1, e.area)).collect();
                power::of_triangles(scene, textures, run.instance, &triangles)
            })
            .collect();
        if powers.iter().sum::<f64>() <= 0.0 {
            return Self::default();
        }
        Self {
            tree: Tree::new(&sources(&emitters, &powers)),
            emitters,
            powers,
            runs,
        }
    }

    /// With emitters chosen by their power alone.
    pub(super) fn by_power(mut self) -> Self {
        self.tree = Tree::by_power(&sources(&self.emitters, &self.powers));
        self
    }

    pub(super) fn count(&self) -> usize {
        self.emitters.len()
    }

    /// Light from a point of an emitter, chosen with the numbers given. There must be emitters.
    pub(super) fn sample(
        &self,
        stage: &Stage,
        receiver: &Receiver,
        choice: f32,
        [u, v]: [f32; 2],
    ) -> Option<Incident> {
        let (index, chance) = self.tree.choose(receiver, choice);
        let emitter = &self.emitters[index];
        // Uniform over the triangle: Turk's square root (Graphics Gems, 1990).
        let root = u.sqrt();
        let weights = [1.0 - root, root * (1.0 - v), root * v];
        let [a, b, c] = *emitter.triangle.corners();
        let place = a * weights[0] + b * weights[1] + c * weights[2];
        let normal = emitter.normal?;
        let to_light = place - receiver.position;
        let squared = to_light.length_squared();
        let direction = to_light / squared.sqrt();
        let facing = direction.dot(normal);
        let target = place - normal * emitter.offset.copysign(facing);
        let density = squared * chance / (facing.abs() * emitter.area);
        Incident {
            direction,
            target: Some(target),
            irradiance: emitter.radiance(stage, &Ray::new(receiver.position, to_light)) / density,
            density,
        }
        .if_lit()
    }

    /// The density, per steradian, with which [`Emitters::sample`] chooses the direction from a receiver to a hit at `place`. 0 where the
    /// hit is on no emitter.
    pub(super) fn density(&self, hit: Hit, receiver: &Receiver, place: Vec3) -> f32 {
        let after = self
            .runs
            .partition_point(|r| (r.instance, r.first_triangle) <= (hit.instance, hit.triangle));
        let Some(run) = after.checked_sub(1).map(|i| &self.runs[i]) else {
            return 0.0;
        };
        let place_in_run = hit.triangle - run.first_triangle;
        if run.instance != hit.instance || place_in_run >= run.triangle_count {
            return 0.0;
        }
        let index = (run.first_emitter + place_in_run) as usize;
        let emitter = &self.emitters[index];
        let Some(normal) = emitter.normal else {
            return 0.0;
        };
        let to_light = place - receiver.position;
        let squared = to_light.length_squared();
        let facing = (to_light / squared.sqrt()).dot(normal).abs();
        squared * self.tree.chance(index, receiver) / (facing * emitter.area)
    }
}

fn sources(emitters: &[Emitter], powers: &[f64]) -> Vec<Source> {
    let sources = emitters.iter().zip(powers);
    let source = |(emitter, &power): (&Emitter, &f64)| Source {
        bounds: emitter.triangle.bounds(),
        normal: emitter.normal.unwrap_or_default(),
        power,
    };
    sources.map(source).collect()
}

fn find(scene: &Scene, staged: &[StagedInstance]) -> (Vec<Emitter>, Vec<Run>) {
    let (mut emitters, mut runs) = (Vec::new(), Vec::new());
    for (index, (instance, staged)) in scene.instances.iter().zip(staged).enumerate() {
        let mesh = &scene.meshes[instance.mesh as usize];
        for part in scene.parts_of(instance) {
            let material = &scene.materials[part.material as usize];
            if material.emissive == Vec3::ZERO || material.unlit {
                continue;
            }
            runs.push(Run {
                instance: index as u32,
                first_triangle: part.first_triangle,
                triangle_count: part.triangle_count,
                first_emitter: emitters.len() as u32,
            });
            for number in part.first_triangle..part.first_triangle + part.triangle_count {
                let corners = mesh.triangles[number as usize];
                let [a, b, c] = corners.map(|v| instance.world_point(mesh.positions[v as usize]));
                let triangle = Triangle::new(a, b, c);
                emitters.push(Emitter {
                    area: triangle.area(),
                    offset: staged.offset(&triangle),
                    normal: triangle.normal(),
                    triangle,
                    name: (index as u32, number),
                    material: part.material,
                });
            }
        }
    }
    (emitters, runs)
}
