//! `bspray completions` and `bspray man`.

use clap::{Args, CommandFactory};

use super::{Cli, Done, output};

/// Arguments of `bspray completions`.
#[derive(Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    shell: clap_complete::Shell,
}

/// Prints the shell's script.
pub(super) fn completions(args: &CompletionsArgs) -> anyhow::Result<Done> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "bspray", &mut script);
    output::result(&String::from_utf8(script)?)?;
    Ok(Done::Completely)
}

/// Prints the manual page: that of the program, and those of its commands behind it.
pub(super) fn man() -> anyhow::Result<Done> {
    let mut page = Vec::new();
    let mut command = Cli::command();
    command.build();
    clap_mangen::Man::new(command.clone()).render(&mut page)?;
    for sub in command.get_subcommands().filter(|c| c.get_name() != "help") {
        clap_mangen::Man::new(sub.clone()).render(&mut page)?;
    }
    output::result(&String::from_utf8(page)?)?;
    Ok(Done::Completely)
}
