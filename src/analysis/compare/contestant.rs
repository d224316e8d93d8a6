//! Who is compared: a name, a way to build, and what its answers owe. The one place to add another kind of method.

use crate::accel::{Accelerator, AcceleratorKind, BuildOptions, Embree, EmbreeError, EmbreeMode};
use crate::analysis::work::Work;
use crate::scene::Scene;

/// Where a method comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// One of the crate's own structures.
    Structure(AcceleratorKind),
    /// Embree, loaded from a file; asked for one ray at a time, as all others are (`rtcIntersect1`, `rtcOccluded1`).
    Embree(Embree, EmbreeMode),
}

/// A method of a comparison.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contestant {
    /// The name in reports, on the command line and in names of files: lower-case letters, digits and hyphens.
    pub name: String,
    /// Where it comes from.
    pub source: Source,
    /// Whether it owes the exact answer, bit for bit. Others owe a plausible depth of the nearest triangle, as `stress` has it.
    pub owes_exact: bool,
}

/// A method, built.
pub struct Built {
    /// What answers.
    pub accelerator: Box<dyn Accelerator>,
    /// Most bytes that a foreign library had at once for the build; nothing of ours counts them.
    pub foreign_peak_bytes: u64,
}

impl Contestant {
    /// One of the crate's own structures.
    pub fn structure(kind: AcceleratorKind) -> Self {
        Self {
            name: kind.name().to_owned(),
            source: Source::Structure(kind),
            owes_exact: true,
        }
    }

    /// Embree as the library that was loaded has it.
    pub fn embree(library: &Embree, mode: EmbreeMode) -> Self {
        Self {
            name: mode.name().to_owned(),
            source: Source::Embree(library.clone(), mode),
            owes_exact: false,
        }
    }

    /// Our structures that a comparison of so much work has if none is named, the default first, and for each of the others why not.
    pub fn defaults(work: &Work) -> (Vec<Self>, Vec<String>) {
        let (mut taken, mut left_out) = (Vec::new(), Vec::new());
        for kind in AcceleratorKind::ALL {
            match work.too_much_for(kind) {
                None => taken.push(Self::structure(kind)),
                Some(reason) => {
                    left_out.push(format!("{kind} is left out: {reason}; --accel can name it"));
                }
            }
        }
        (taken, left_out)
    }

    /// The structure, if it is one of ours.
    pub fn kind(&self) -> Option<AcceleratorKind> {
        match self.source {
            Source::Structure(kind) => Some(kind),
            Source::Embree(..) => None,
        }
    }

    /// Whether it tells its steps of traversal. A foreign library does not.
    pub fn counts_steps(&self) -> bool {
        self.kind().is_some()
    }

    /// Builds it over all instances of the scene.
    ///
    /// # Errors
    /// What a foreign library reports, such as that it has not enough memory.
    pub fn build(&self, scene: &Scene, options: &BuildOptions) -> Result<Built, EmbreeError> {
        match &self.source {
            Source::Structure(kind) => Ok(Built {
                accelerator: kind.build_with(scene, options),
                foreign_peak_bytes: 0,
            }),
            Source::Embree(embree, mode) => {
                let scene = embree.build(scene, *mode)?;
                Ok(Built {
                    foreign_peak_bytes: scene.peak_bytes(),
                    accelerator: Box::new(scene),
                })
            }
        }
    }
}

impl std::fmt::Display for Contestant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)
    }
}

/// A method, built.
#[derive(Clone, Copy)]
pub struct Entrant<'a> {
    /// Which.
    pub contestant: &'a Contestant,
    /// What answers.
    pub accelerator: &'a dyn Accelerator,
}
