//! Who is compared: a name, a way to build, and what its answers owe. The one place to add another kind of method.

use super::defaults::Work;
use crate::accel::{Accelerator, AcceleratorKind, BuildOptions};
use crate::scene::Scene;

/// Where a method comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// One of the crate's own structures.
    Structure(AcceleratorKind),
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

impl Contestant {
    /// One of the crate's own structures.
    pub fn structure(kind: AcceleratorKind) -> Self {
        Self {
            name: kind.name().to_owned(),
            source: Source::Structure(kind),
            owes_exact: true,
        }
    }

    /// All that there are, the default first.
    pub fn all() -> Vec<Self> {
        AcceleratorKind::ALL.map(Self::structure).to_vec()
    }

    /// Those that a comparison of so much work has if none is named, and for each of the others why not.
    pub fn defaults(work: &Work) -> (Vec<Self>, Vec<String>) {
        let (mut taken, mut left_out) = (Vec::new(), Vec::new());
        for contestant in Self::all() {
            let Source::Structure(kind) = contestant.source;
            match work.too_much_for(kind) {
                None => taken.push(contestant),
                Some(reason) => left_out.push(format!(
                    "{} is left out: {reason}; --accel can name it",
                    contestant.name
                )),
            }
        }
        (taken, left_out)
    }

    /// The structure, if it is one.
    pub fn kind(&self) -> Option<AcceleratorKind> {
        let Source::Structure(kind) = self.source;
        Some(kind)
    }

    /// Builds it over all instances of the scene.
    pub fn build(&self, scene: &Scene, options: &BuildOptions) -> Box<dyn Accelerator> {
        match self.source {
            Source::Structure(kind) => kind.build_with(scene, options),
        }
    }

    /// The method that has the same triangle test and no structure, to tell whose error an error is.
    pub fn brute_force(&self) -> Self {
        match self.source {
            Source::Structure(_) => Self::structure(AcceleratorKind::Linear),
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
