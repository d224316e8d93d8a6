//! The scene made ready for shading: what instances, lights and materials need worked out once before the first ray.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DMat3, Vec3};

use super::bsdf::GlassEnergy;
use super::environment::Environment;
use super::lights::{Lights, has_directional};
use super::surface::MaterialPoint;
use super::tangents::Tangents;
use super::texture::Textures;
use super::thrift::Thrift;
use crate::accel::bsp::polygon::SceneTrees;
use crate::accel::{Accelerator, TestSpaces};
use crate::geometry::Triangle;
use crate::geometry::tolerance::surface_offset_factors;
use crate::scene::{Instance, Material, Scene, Sky, TriangleMesh};

/// When the sky and sun of our own light a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SkyMode {
    /// In scenes that have no light of their own: no punctual light, and no material of a constant emission. (Emission
    /// through a texture is mostly a detail, such as a display, that is meant to be seen in other light.) Also in scenes with a
    /// directional light, which is a sun: files have no word for the sky that goes with it.
    #[default]
    Auto,
    /// Always. A directional light of the scene takes the place of our own sun.
    On,
    /// Never.
    Off,
}

/// A scene, its accelerator, and what shading needs to know of both.
pub struct Stage<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Answers what rays hit.
    pub accelerator: &'a dyn Accelerator,
    /// Everything that sends light.
    pub lights: Lights,
    /// Light from infinitely far: our own sky and its sun, unless another one was given.
    pub environment: Option<Arc<Environment>>,
    /// Whether the environment is only seen where it lights: the picture is transparent behind all surfaces.
    pub hides_environment: bool,
    /// Levels of detail of the scene's images.
    pub textures: Textures,
    /// Length of the diagonal of the scene's box, in model units.
    pub diagonal: f32,
    /// Whether any material has alpha, so that hits must be looked at before they block light.
    pub has_alpha: bool,
    /// Whether light passes any material.
    pub(super) has_transmission: bool,
    /// Whether rays that can bring little are saved.
    pub(super) thrift: Thrift,
    /// The polygon BSPs of the scene, for pictures that show them.
    pub trees: Option<&'a SceneTrees>,
    /// Greatest depth of their nodes: 0 for a root alone.
    pub(super) deepest_node: u32,
    pub(super) instances: Vec<StagedInstance>,
    pub(super) materials: Vec<StagedMaterial>,
    /// For each material into which light enters, what its interface loses.
    pub(super) glass: Vec<Option<Arc<GlassEnergy>>>,
    /// Tangents for normal maps, where the file has none.
    pub(super) tangents: Tangents,
}

/// What is worked out for each instance.
pub(super) struct StagedInstance {
    /// Takes object-space normals to world space, up to length.
    pub(super) normal_matrix: DMat3,
    pub(super) is_mirrored: bool,
    /// Whether its mesh has vertex colours.
    pub(super) is_colored: bool,
    offset_factors: (f32, f32),
}

/// What is worked out for each material.
pub(super) struct StagedMaterial {
    pub(super) is_textured: bool,
    pub(super) is_matt: bool,
    /// Its values, if they are the same everywhere on meshes without vertex colours.
    pub(super) point: Option<MaterialPoint>,
}

impl StagedMaterial {
    fn new(material: &Material) -> Self {
        let is_textured = material.texture_refs().next().is_some();
        Self {
            is_textured,
            is_matt: material.is_matt(),
            point: (!is_textured).then(|| MaterialPoint::plain(material)),
        }
    }
}

impl StagedInstance {
    /// How far a ray must start or end from a world-space triangle of the instance so as not to meet it, in model units.
    pub(super) fn offset(&self, triangle: &Triangle) -> f32 {
        let reach = triangle
            .corners()
            .iter()
            .fold(0.0_f32, |r, p| r.max(p.abs().max_element()));
        self.offset_factors.0 * reach + self.offset_factors.1
    }
}

impl<'a> Stage<'a> {
    /// Prepares the scene. `up` is its upward axis, of which the sky needs to know.
    pub fn new(scene: &'a Scene, accelerator: &'a dyn Accelerator, up: Vec3, sky: SkyMode) -> Self {
        let spaces = TestSpaces::of(scene);
        let radius = |mesh: &TriangleMesh| {
            mesh.positions
                .iter()
                .fold(0.0_f32, |r, p| r.max(p.abs().max_element()))
        };
        let radii: Vec<f32> = scene.meshes.iter().map(radius).collect();
        let staged = |(index, instance): (usize, &Instance)| {
            let is_mirrored = instance.is_mirrored();
            let cofactors = instance.cofactors();
            // What is tested in world space has no second rounding.
            let radius = if spaces.is_object_space(index as u32) {
                radii[instance.mesh as usize]
            } else {
                0.0
            };
            StagedInstance {
                normal_matrix: if is_mirrored { -cofactors } else { cofactors },
                is_mirrored,
                is_colored: !scene.meshes[instance.mesh as usize].colors.is_empty(),
                offset_factors: surface_offset_factors(instance.world_from_object.matrix3, radius),
            }
        };
        let instances: Vec<_> = scene.instances.iter().enumerate().map(staged).collect();
        let textures = Textures::new(scene);
        let is_lit = !scene.lights.is_empty() || scene.has_constant_emission();
        let wants_sky = match sky {
            SkyMode::Auto => !is_lit || has_directional(scene),
            SkyMode::On => true,
            SkyMode::Off => false,
        };
        let sky = wants_sky.then(|| Sky::daylight(up.normalize_or(Vec3::Y)));
        let has_sun = !has_directional(scene);
        let environment = sky.map(|sky| Arc::new(Environment::studio(sky, has_sun)));
        Self {
            scene,
            accelerator,
            environment,
            hides_environment: false,
            lights: Lights::new(scene, &instances, &textures),
            textures,
            diagonal: scene.bounds().diagonal(),
            has_alpha: scene.materials.iter().any(|m| m.has_alpha()),
            has_transmission: scene.materials.iter().any(|m| m.transmission.is_some()),
            thrift: Thrift::On,
            trees: None,
            deepest_node: 0,
            instances,
            materials: scene.materials.iter().map(StagedMaterial::new).collect(),
            glass: glass(scene),
            tangents: Tangents::new(scene),
        }
    }

    /// With another environment in place of our own sky and its sun.
    #[must_use]
    pub fn with_environment(mut self, environment: Arc<Environment>) -> Self {
        self.environment = Some(environment);
        self
    }

    /// With a transparent backdrop: the environment lights, but the eye does not see it.
    #[must_use]
    pub fn without_backdrop(mut self) -> Self {
        self.hides_environment = true;
        self
    }

    /// With all rays sent, also those that can bring little. Otherwise these are sent with a chance, which leaves the mean of every pixel as it is.
    #[must_use]
    pub fn exhaustively(mut self) -> Self {
        self.thrift = Thrift::Off;
        self
    }

    /// With emissive triangles chosen by their power alone, whether they reach a place or not: noisier where there are many, and the same in the mean.
    #[must_use]
    pub fn with_emitters_by_power(mut self) -> Self {
        self.lights = self.lights.by_power();
        self
    }

    /// What the eye sees in a direction (unit) in which there is nothing.
    pub(super) fn backdrop(&self, direction: Vec3) -> Vec3 {
        match &self.environment {
            Some(environment) if !self.hides_environment => environment.backdrop(direction),
            _ => Vec3::ZERO,
        }
    }

    /// With the scene's polygon BSPs, which the integrators `fragment` and `bsp-depth` and the layers of these names show.
    #[must_use]
    pub fn with_trees(self, trees: Option<&'a SceneTrees>) -> Self {
        Self {
            trees,
            deepest_node: trees.map_or(0, |t| t.depth().saturating_sub(1)),
            ..self
        }
    }
}

/// For each material into which light enters, the tables of its index of refraction.
fn glass(scene: &Scene) -> Vec<Option<Arc<GlassEnergy>>> {
    let mut tables = BTreeMap::new();
    let mut table = |ior: f32| {
        let table = tables.entry(ior.to_bits());
        Arc::clone(table.or_insert_with(|| Arc::new(GlassEnergy::new(ior))))
    };
    let materials = scene.materials.iter();
    materials
        .map(|m| m.is_solid().then(|| table(m.ior)))
        .collect()
}
