//! Arguments that say what may be left out because the picture cannot show it.

use clap::Args;

/// What a render may save. Every saving that is on by default changes a picture by less than its noise.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Savings")]
pub(super) struct SavingsArgs {
    /// Save nothing: all that is on by default is off
    #[arg(long)]
    pub(super) exhaustive: bool,
}
