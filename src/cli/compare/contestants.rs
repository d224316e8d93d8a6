//! Who is compared: the structures that `--accel` names, or all whose work ends soon; and Embree.

use anyhow::bail;
use bspray::accel::{AcceleratorKind, Embree, EmbreeMode};
use bspray::analysis::{Contestant, Work};
use clap::Args;

use crate::cli::embree_args::EmbreeArgs;
use crate::cli::{UsageError, render, values};

const ACCEL_HELP: &str = "The structures, with commas between; the others are measured by the first [default: all whose work ends soon]";

/// Arguments for who is compared.
#[derive(Args, Clone, Debug)]
pub(super) struct ContestantArgs {
    #[arg(long, value_name = "KIND,...", value_delimiter = ',', value_parser = wanted,
        help = ACCEL_HELP, long_help = accel_help())]
    accel: Vec<Wanted>,
    #[command(flatten)]
    embree: EmbreeArgs,
}

/// A structure, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    Ours(AcceleratorKind),
    Embree(EmbreeMode),
}

impl Wanted {
    const fn name(self) -> &'static str {
        match self {
            Self::Ours(kind) => kind.name(),
            Self::Embree(mode) => mode.name(),
        }
    }
}

fn wanted(name: &str) -> Result<Wanted, String> {
    let mode = EmbreeMode::ALL.into_iter().find(|m| m.name() == name);
    match (mode, values::accelerator(name)) {
        (Some(mode), _) => Ok(Wanted::Embree(mode)),
        (None, Ok(kind)) => Ok(Wanted::Ours(kind)),
        (None, Err(all)) => {
            let modes = EmbreeMode::ALL.map(EmbreeMode::name).join(", ");
            Err(format!("{all}, {modes}"))
        }
    }
}

fn accel_help() -> String {
    let modes = EmbreeMode::ALL.map(|m| format!("\n- {}: {}", m.name(), m.description()));
    render::accelerator_help(ACCEL_HELP) + &modes.concat()
}

impl ContestantArgs {
    /// Refuses a structure that is named twice.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        for (index, wanted) in self.accel.iter().enumerate() {
            if self.accel[..index].contains(wanted) {
                let words = format!("--accel names {} twice", wanted.name());
                bail!(UsageError(words));
            }
        }
        Ok(())
    }

    /// Embree, if its library is named, with so many threads for its builds.
    pub(super) fn embree(&self, threads: usize) -> anyhow::Result<Option<Embree>> {
        let mode = |wanted: &Wanted| match wanted {
            Wanted::Embree(mode) => Some(*mode),
            Wanted::Ours(_) => None,
        };
        let modes: Vec<_> = self.accel.iter().filter_map(mode).collect();
        let named = (!self.accel.is_empty()).then_some(&*modes);
        self.embree.load(threads, "--accel", named)
    }

    /// The methods, and notes about those that are left out for so much work.
    pub(super) fn choose(
        &self,
        embree: Option<&Embree>,
        work: &Work,
    ) -> (Vec<Contestant>, Vec<String>) {
        let of_embree = |mode| embree.map(|library| Contestant::embree(library, mode));
        if self.accel.is_empty() {
            let (mut taken, left_out) = Contestant::defaults(work);
            taken.extend(EmbreeMode::ALL.into_iter().filter_map(of_embree));
            return (taken, left_out);
        }
        let named = self.accel.iter().filter_map(|wanted| match wanted {
            Wanted::Ours(kind) => Some(Contestant::structure(*kind)),
            Wanted::Embree(mode) => of_embree(*mode),
        });
        (named.collect(), Vec::new())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_all_methods() {
        assert_eq!(wanted("bvh2"), Ok(Wanted::Ours(AcceleratorKind::Bvh2)));
        let robust = Wanted::Embree(EmbreeMode::Robust);
        assert_eq!(wanted("embree-robust"), Ok(robust));
        assert_eq!(robust.name(), "embree-robust");
        let all = wanted("embryo").unwrap_err();
        assert!(all.starts_with("want one of bsp, ") && all.ends_with("embree, embree-robust"));
    }
}
