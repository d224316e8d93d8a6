//! `bspray stress`: where methods fail.

use std::ffi::OsString;
use std::path::PathBuf;

use anyhow::{Context, bail};
use bspray::analysis::stability::{
    CellTask, Isolation, Method, StressOptions, StressResults, Sweep, answer,
};
use bspray::picture::ldr;
use clap::Args;

use super::embree_args::EmbreeArgs;
use super::work_bar::WorkBar;
use super::{Done, UsageError, files, output, stress_page, stress_report, values};

/// How much is done: rays a step, rays from inside a closed mesh, seconds for what may run away.
struct Profile(u32, u64, u32);

const QUICK: Profile = Profile(128, 4_000_000, 3);
const USUAL: Profile = Profile(1024, 100_000_000, 20);
const THOROUGH: Profile = Profile(8192, 1_000_000_000, 120);

/// Threads with which Embree builds: steps run beside one another as it is, and equal scenes get equal trees.
const BUILD_THREADS: usize = 1;

/// Pixels for each float of the sign map.
const SIGN_SCALE: u32 = 8;

/// Arguments of `bspray stress`.
#[derive(Args, Debug)]
#[command(
    after_help = "Exit code 5 says that the default structure gave a wrong answer inside its domain, leaked, or did not end; \
    the report is printed all the same."
)]
pub(super) struct StressArgs {
    /// Few rays: less than two minutes on two cores
    #[arg(long, conflicts_with = "thorough")]
    quick: bool,
    /// Very many rays, 1,000,000,000 of them from inside a closed mesh, and 120 s for what may run away; takes an hour or more
    #[arg(long)]
    thorough: bool,
    /// Only these sweeps, with commas between [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = Sweep::named,
        long_help = sweep_help())]
    sweep: Vec<Sweep>,
    /// Only these methods and the default structure, with commas between [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', long_help = method_help())]
    method: Vec<Method>,
    #[command(flatten)]
    embree: EmbreeArgs,
    /// Rays a step, in place of those of --quick and --thorough
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=values::MOST_RAYS))]
    rays: Option<u32>,
    /// Seconds of processor time for one step of what may run away (a child process), in place of those of --quick and --thorough
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    time_limit: Option<u32>,
    /// Changes every random number
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Threads; 0 for one a core. Results do not depend on them
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads)]
    threads: usize,
    /// Write the signs of a predicate over neighbouring floats, in f32 at the left of exact ones, as a picture (PNG)
    #[arg(long, value_name = "FILE", help_heading = "Reports")]
    sign_map: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long, help_heading = "Reports")]
    json: bool,
    /// Also write a page with tables and charts, report.html, and all numbers as CSV and JSON, into this folder
    #[arg(long, value_name = "FOLDER", help_heading = "Reports")]
    report: Option<PathBuf>,
    /// No progress
    #[arg(short, long, help_heading = "Reports")]
    quiet: bool,
}

/// Arguments of the hidden `bspray stress-cell`.
#[derive(Args, Debug)]
pub(super) struct StressCellArgs {
    #[command(flatten)]
    embree: EmbreeArgs,
    sweep: String,
    step: usize,
    method: String,
    rays: usize,
    seed: u64,
    seconds: u32,
}

/// Lists the sweeps.
fn sweep_help() -> String {
    let lines = Sweep::all()
        .iter()
        .map(|s| format!("- {}: {}", s.name, s.description))
        .collect::<Vec<_>>();
    format!(
        "Only these sweeps, with commas between [default: all]\n\n{}",
        lines.join("\n")
    )
}

/// Lists the methods.
fn method_help() -> String {
    let lines = Method::all()
        .iter()
        .map(|m| format!("- {}: {}", m.name(), m.description()))
        .collect::<Vec<_>>();
    let head = "Only these methods and the default structure, with commas between [default: all]";
    format!("{head}\n\n{}", lines.join("\n"))
}

/// Runs and tells.
pub(super) fn run(args: &StressArgs) -> anyhow::Result<Done> {
    let options = options(args)?;
    if let Some(folder) = &args.report {
        files::check_folder(folder)?;
    }
    if let Some(path) = &args.sign_map {
        ldr::LdrFormat::of_path(path).map_err(|e| UsageError(e.to_string()))?;
        files::check_writable(path, std::iter::empty())?;
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build()
        .context("cannot start threads")?;
    let quiet = args.quiet;
    // A foreign tree that panics is a result. The report has it, and no backtrace is wanted.
    std::panic::set_hook(Box::new(move |panic| {
        if !quiet {
            let place = panic.location().map(ToString::to_string);
            output::message(&format!("panic at {}", place.unwrap_or_default()));
        }
    }));
    let progress = WorkBar::begin("stress", args.quiet);
    let results = pool.install(|| StressResults::of(&options, &|share| progress.add(share)));
    progress.end();
    if let Some(path) = &args.sign_map {
        ldr::write(path, &results.sign_map.picture(SIGN_SCALE))?;
    }
    if let Some(folder) = &args.report {
        stress_page::page(&results).write(folder)?;
        if !args.quiet {
            output::message(&format!("{}", folder.join("report.html").display()));
        }
    }
    output::result(&if args.json {
        serde_json::to_string_pretty(&results)?
    } else {
        stress_report::table(&results)
    })?;
    Ok(verdict(&results))
}

fn options(args: &StressArgs) -> anyhow::Result<StressOptions> {
    let profile = match (args.quick, args.thorough) {
        (true, _) => QUICK,
        (_, true) => THOROUGH,
        _ => USUAL,
    };
    let names: Vec<_> = args.sweep.iter().map(|s| s.name).collect();
    let methods: Vec<_> = args.method.iter().map(|m| m.name()).collect();
    for (what, names) in [("--sweep", &names), ("--method", &methods)] {
        for (i, name) in names.iter().enumerate() {
            if names[..i].contains(name) {
                bail!(UsageError(format!("{what} names {name} twice")));
            }
        }
    }
    let modes: Vec<_> = args.method.iter().filter_map(|m| m.embree_mode()).collect();
    let named = (!args.method.is_empty()).then_some(&*modes);
    let embree = args.embree.load(BUILD_THREADS, "--method", named)?;
    let is_wanted = |m: &Method| {
        let is_there = embree.is_some() || !m.needs_embree();
        let is_named = args.method.is_empty() || args.method.contains(m);
        is_there && (is_named || *m == Method::DEFAULT)
    };
    let mut arguments: Vec<OsString> = vec!["stress-cell".into()];
    if let Some(path) = &args.embree.embree {
        arguments.extend(["--embree".into(), path.into()]);
    }
    let program =
        std::env::current_exe().context("cannot find this program, to start it as a child")?;
    Ok(StressOptions {
        sweeps: if args.sweep.is_empty() {
            Sweep::all()
        } else {
            args.sweep.clone()
        },
        methods: Method::all().into_iter().filter(is_wanted).collect(),
        rays: args.rays.unwrap_or(profile.0) as usize,
        leak_rays: profile.1,
        seed: args.seed,
        isolation: Some(Isolation {
            program,
            arguments,
            seconds: args.time_limit.unwrap_or(profile.2),
        }),
        embree,
    })
}

/// Does one piece of work for a parent.
pub(super) fn cell(args: &StressCellArgs) -> anyhow::Result<Done> {
    let task = CellTask {
        sweep: args.sweep.clone(),
        step: args.step,
        method: args.method.clone(),
        rays: args.rays,
        seed: args.seed,
    };
    let embree = args.embree.load(BUILD_THREADS, "--method", None)?;
    output::result(&answer(&task, args.seconds, embree.as_ref()).map_err(UsageError)?)?;
    Ok(Done::Completely)
}

fn verdict(results: &StressResults) -> Done {
    if results.default_failures() == 0 {
        Done::Completely
    } else {
        Done::FirstIsWrong
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_answer_of_the_default_structure_ends_with_5() {
        let options = StressOptions {
            sweeps: vec![Sweep::named("layers").unwrap()],
            methods: vec![Method::DEFAULT, Method::MollerTrumbore],
            rays: 8,
            leak_rays: 100,
            ..StressOptions::default()
        };
        let mut results = StressResults::of(&options, &|_| ());
        assert_eq!(verdict(&results).code(), 0);
        results.sweeps[0].methods[1].cells[3].faults[2] += 1;
        assert_eq!(verdict(&results).code(), 0);
        results.sweeps[0].methods[0].cells[3].faults[2] += 1;
        assert_eq!(verdict(&results).code(), 5);
    }
}
