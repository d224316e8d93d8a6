//! The argument that names Embree's library, for all commands that measure methods.

use std::path::PathBuf;

use anyhow::{Context, bail};
use bspray::accel::{Embree, EmbreeMode};
use clap::Args;

use super::UsageError;

/// Where Embree is.
#[derive(Args, Clone, Debug)]
pub(super) struct EmbreeArgs {
    /// Embree 4's library, such as /usr/lib/libembree4.so.4, for the methods embree and embree-robust
    #[arg(long, value_name = "FILE")]
    pub(super) embree: Option<PathBuf>,
}

impl EmbreeArgs {
    /// Loads the library if a file is named, with so many threads for its builds; 0 for one a core.
    ///
    /// `named` are those of Embree's modes that `option` names, if it names any methods at all: they need the library, and without them nobody needs it.
    pub(super) fn load(
        &self,
        threads: usize,
        option: &str,
        named: Option<&[EmbreeMode]>,
    ) -> anyhow::Result<Option<Embree>> {
        match (&self.embree, named) {
            (None, Some([mode, ..])) => bail!(UsageError(format!(
                "{option} {} needs --embree FILE, Embree 4's library",
                mode.name()
            ))),
            (Some(_), Some([])) => bail!(UsageError(format!(
                "--embree: {option} names neither {}",
                EmbreeMode::ALL.map(EmbreeMode::name).join(" nor ")
            ))),
            (None, _) => Ok(None),
            (Some(path), _) => Embree::load(path, threads)
                .map(Some)
                .context("cannot load --embree"),
        }
    }
}
