//! The command line: arguments in, words and exit codes out. One file a sub-command.
//!
//! Results go to standard output, everything else to standard error. Exit codes: 0 done, 1 failure, 2 wrong usage, 4 ended
//! early with a partial picture, 5 the first structure of a comparison, or the default structure under stress, is wrong, or two pictures are different.

mod bsp_args;
mod camera_args;
mod chart;
mod compare;
mod diff;
mod diff_report;
mod diff_values;
mod display;
mod embree_args;
mod environment_args;
mod extent_args;
mod files;
mod frames;
mod inspect;
mod inspect_bsp;
mod inspect_extents;
mod ladder;
mod lens_args;
mod memory;
mod metadata;
mod model_args;
mod motion;
mod numbers;
mod output;
mod overlay_args;
mod pixel;
mod progress;
mod render;
mod savings_args;
mod shell;
mod shot;
mod stress;
mod stress_page;
mod stress_report;
mod summary;
mod tev;
mod values;
mod work_bar;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Renders OBJ and glTF models, and measures what it does.
#[derive(Parser)]
#[command(name = "bspray", version, about, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render models to pictures (PNG, JPEG) and measurements (EXR)
    Render(Box<render::RenderArgs>),
    /// Tell what model files hold
    Inspect(Box<inspect::InspectArgs>),
    /// Compare structures on the rays of one view: builds, speed, steps, and who is right
    Compare(Box<compare::CompareArgs>),
    /// Chart speed against accuracy: methods on rays and on pictures, each error measured, in a report
    Chart(Box<chart::ChartArgs>),
    /// Tell how two pictures differ: each channel, and to the eye (SSIM, FLIP)
    Diff(Box<diff::DiffArgs>),
    /// Measure what each step from no extents to trees gives, for eye, shadow and mirror rays
    Ladder(Box<ladder::LadderArgs>),
    /// Look for where methods fail: sweeps over hard cases, each answer judged by exact arithmetic
    Stress(Box<stress::StressArgs>),
    /// Work of `stress` that may run away, in a process of its own
    #[command(hide = true)]
    StressCell(stress::StressCellArgs),
    /// Print a script that completes bspray's arguments in a shell
    Completions(shell::CompletionsArgs),
    /// Print bspray's manual page, in roff
    Man,
}

/// How a command ended, when it did not fail.
enum Done {
    /// Everything was done.
    Completely,
    /// The picture is partial.
    Partially,
    /// The first structure of a comparison, or the default one under stress, gave wrong answers.
    FirstIsWrong,
    /// Two pictures are different.
    Different,
}

impl Done {
    /// The exit code.
    fn code(&self) -> u8 {
        match self {
            Self::Completely => 0,
            Self::Partially => 4,
            Self::FirstIsWrong | Self::Different => 5,
        }
    }
}

/// Arguments that are well formed, but make no sense together or for these files.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct UsageError(String);

/// Parses the arguments and runs the command.
pub(crate) fn run() -> ExitCode {
    let cli = Cli::parse();
    let done = match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Chart(args) => chart::run(&args),
        Command::Diff(args) => diff::run(&args),
        Command::Ladder(args) => ladder::run(&args),
        Command::Stress(args) => stress::run(&args),
        Command::StressCell(args) => stress::cell(&args),
        Command::Completions(args) => shell::completions(&args),
        Command::Man => shell::man(),
    };
    match done {
        Ok(done) => ExitCode::from(done.code()),
        Err(error) if output::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            output::error(&error);
            if error.is::<UsageError>() {
                ExitCode::from(2)
            } else {
                ExitCode::FAILURE
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_well_formed() {
        super::Cli::command().debug_assert();
    }
}
