//! The program `bspray`: see `bspray --help`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
