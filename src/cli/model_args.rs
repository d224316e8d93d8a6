//! Which models, and what to show of those that offer a choice.

use std::path::PathBuf;

use anyhow::bail;
use bspray::import::{
    ImportOptions, Moment, ShownImages, TextureNeeds, load_shown, load_with, load_with_neighbors,
};
use bspray::scene::Scene;
use clap::Args;

use super::{UsageError, values};

/// Arguments of every command that loads models.
#[derive(Args, Debug)]
pub(super) struct ModelArgs {
    /// Model files (.obj, .gltf, .glb); several make one scene
    #[arg(required = true, value_name = "MODEL")]
    pub(super) models: Vec<PathBuf>,
    /// Pose glTF models as in their animation N, counted from 0 [default: at rest]
    #[arg(long, value_name = "N", help_heading = "Models")]
    animation_index: Option<usize>,
    /// The moment of that animation, beyond its ends the nearest [default: 0]
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = values::finite,
        allow_hyphen_values = true,
        help_heading = "Models"
    )]
    animation_time: Option<f32>,
    /// Show glTF models with the materials of their variant NAME [default: their default materials]
    #[arg(long, value_name = "NAME", help_heading = "Models")]
    variant: Option<String>,
    /// Shade faces that meet at this angle or less as one smooth surface, where a file gives no normals. Smoothing groups of OBJ files are smooth at any angle
    #[arg(long, value_name = "DEGREES", value_parser = values::crease_angle, help_heading = "Models")]
    crease_angle: Option<f32>,
    /// Refuse models that would take more memory than SIZE while they are read, such as 8GiB or 512MiB, estimated from what they claim [default: three quarters of the machine's memory]
    #[arg(long, value_name = "SIZE", value_parser = values::memory, help_heading = "Models")]
    memory_limit: Option<u64>,
}

/// What of the models is read.
#[derive(Clone, Copy, Default)]
pub(super) struct Wants<'a> {
    /// All meshes as they are in the files, copies too.
    pub(super) keeps_copies: bool,
    /// Textures that are read.
    pub(super) textures: TextureNeeds,
    /// How finely each image is shown; all are whole without it.
    pub(super) shown: Option<&'a ShownImages<'a>>,
}

impl ModelArgs {
    /// Loads the models as one scene.
    pub(super) fn load(&self) -> anyhow::Result<Scene> {
        Ok(load_with(&self.models, &self.options(Wants::default())?)?)
    }

    /// Loads of the models what a picture wants.
    pub(super) fn load_wanted(&self, wants: Wants) -> anyhow::Result<Scene> {
        let options = self.options(wants)?;
        Ok(match wants.shown {
            Some(shown) => load_shown(&self.models, &options, shown)?,
            None => load_with(&self.models, &options)?,
        })
    }

    /// Loads the models as one scene, and where everything is `step` seconds before and after, if a moment of an animation is shown.
    pub(super) fn load_with_neighbors(
        &self,
        step: f64,
        wants: Wants,
    ) -> anyhow::Result<(Scene, Option<[Scene; 2]>)> {
        let options = self.options(wants)?;
        let Some(moment) = options.moment else {
            return Ok((load_with(&self.models, &options)?, None));
        };
        let (scene, neighbors) = load_with_neighbors(&self.models, &options, moment, step)?;
        Ok((scene, Some(neighbors)))
    }

    fn options(&self, wants: Wants) -> anyhow::Result<ImportOptions> {
        let moment = match (self.animation_index, self.animation_time) {
            (Some(animation), seconds) => Some(Moment {
                animation,
                seconds: f64::from(seconds.unwrap_or(0.0)),
            }),
            (None, Some(_)) => {
                let words = "--animation-time: of which animation? Add --animation-index N";
                bail!(UsageError(words.to_owned()));
            }
            (None, None) => None,
        };
        Ok(ImportOptions {
            variant: self.variant.clone(),
            moment,
            crease_angle: self.crease_angle,
            memory_limit: self.memory_limit,
            geometry_only: false,
            keeps_copies: wants.keeps_copies,
            textures: wants.textures,
        })
    }
}
