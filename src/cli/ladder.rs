//! `bspray ladder`: what each step from no extents to trees gives.

use std::fmt::Write;

use bspray::accel::extents::{ExtentTest, MeshAccelerator, ObjectTally};
use bspray::analysis::{Ladder, LadderOptions, StepOnRays};
use clap::Args;
use serde_json::{Value, json};

use super::bsp_args::BspArgs;
use super::camera_args::{self, CameraArgs};
use super::model_args::ModelArgs;
use super::numbers::{estimate, ratio};
use super::{Done, extent_args, output, values};

/// Arguments of `bspray ladder`.
#[derive(Args, Debug)]
pub(super) struct LadderArgs {
    #[command(flatten)]
    input: ModelArgs,
    /// What finds the hits within an object in the lower steps: linear (the lecture's), bsp, bvh2 or cwbvh
    #[arg(long, value_name = "KIND", default_value_t = MeshAccelerator::Linear, value_parser = extent_args::mesh)]
    mesh_accel: MeshAccelerator,
    #[command(flatten)]
    bsp: BspArgs,
    /// Width and height of the view, in pixels
    #[arg(long, value_name = "WxH", value_parser = values::resolution, default_value = "1280x720")]
    resolution: (u32, u32),
    /// Most rays of each kind; of a view with more pixels, tiles are chosen by chance
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=values::MOST_RAYS))]
    rays: u32,
    /// How often each step is timed on the same rays
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repetitions: u32,
    /// Changes every random number
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    #[command(flatten)]
    camera: CameraArgs,
    /// Print one JSON object
    #[arg(long, help_heading = "Reports")]
    json: bool,
    /// No notes
    #[arg(short, long, help_heading = "Reports")]
    quiet: bool,
}

/// Climbs and tells.
pub(super) fn run(args: &LadderArgs) -> anyhow::Result<Done> {
    let scene = args.input.load()?;
    if !args.quiet {
        output::tell_of(&scene);
    }
    let camera = args.camera.choose(&scene, args.resolution)?;
    let view = camera_args::view(&camera, args.resolution, 0.0)?;
    let mut build = args.bsp.options(args.seed);
    build.mesh = args.mesh_accel;
    let ladder = Ladder::of(
        &scene,
        &LadderOptions {
            build,
            view,
            most_rays: args.rays as usize,
            repetitions: args.repetitions as usize,
            seed: args.seed,
            up: args.camera.up(),
        },
    );
    output::result(&if args.json {
        let report = json!({
            "models": args.input.models.iter().map(|m| m.to_string_lossy()).collect::<Vec<_>>(),
            "camera": camera_args::as_flags(&camera, &scene, args.camera.up()),
            "mesh_accel": args.mesh_accel.name(),
            "rays": ladder.kinds.iter().map(|(name, count)| json!({ "kind": name, "count": count })).collect::<Vec<_>>(),
            "steps": ladder.steps.iter().map(|step| json!({
                "name": step.name,
                "rays": step.rays.iter().zip(&ladder.kinds).map(|(rays, (kind, _))| on_rays(kind, rays)).collect::<Vec<_>>(),
            })).collect::<Vec<_>>(),
        });
        format!("{report:#}")
    } else {
        table(&ladder)
    })?;
    Ok(Done::Completely)
}

fn on_rays(kind: &str, rays: &StepOnRays) -> Value {
    json!({
        "kind": kind,
        "rays_per_second": rays.speed.map(|s| estimate(s.rays_per_second)),
        "speed_ratio_to_first": rays.speed.map(|s| ratio(s.ratio_to_first)),
        "counted_cost": rays.cost,
        "outcomes": rays.tally.as_ref().map(tally),
    })
}

/// The outcomes at all objects, or at one.
pub(super) fn tally(tally: &ObjectTally) -> Value {
    let tests = ExtentTest::ALL.into_iter().zip(&tally.tests);
    let tests = tests.filter(|(_, t)| t.tested > 0).map(|(test, t)| {
        json!({ "test": test.name(), "tested": t.tested, "rejected": t.rejected, "false_alarms": t.false_alarms,
            "hits": t.hits, "planes": t.planes })
    });
    let steps = &tally.steps;
    json!({ "tests": tests.collect::<Vec<_>>(), "transforms": tally.transforms, "full_tests": tally.full_tests, "hits": tally.hits,
        "nodes": steps.nodes, "leaves": steps.leaves, "primitives": steps.primitives })
}

/// Columns of each kind of rays: nanoseconds a ray, how many times faster than the first step (median and half of its 95 % interval), and the same by counted cost.
fn table(ladder: &Ladder) -> String {
    let mut out = format!("{:<38}", "");
    for (kind, count) in &ladder.kinds {
        let _ = write!(out, "{:>38}", format!("{count} {kind} rays"));
    }
    let _ = write!(out, "\n{:<38}", "step");
    for _ in &ladder.kinds {
        let _ = write!(out, "{:>10}{:>18}{:>10}", "ns/ray", "faster", "counted");
    }
    for step in &ladder.steps {
        let _ = write!(out, "\n{:<38}", step.name);
        for (kind, rays) in step.rays.iter().enumerate() {
            let (time, ratio) = rays.speed.map_or(("-".into(), "-".into()), |s| {
                let (speed, ratio) = (s.rays_per_second.median, s.ratio_to_first);
                let ratio = format!("{:.2} ± {:.2}", ratio.median, ratio.half_width());
                (format!("{:.0}", 1e9 / speed), ratio)
            });
            let first = ladder.steps[0].rays[kind].cost;
            let counted = if rays.cost > 0.0 {
                format!("{:.2}", first / rays.cost)
            } else {
                "-".into()
            };
            let _ = write!(out, "{time:>10}{ratio:>18}{counted:>10}");
        }
    }
    out + "\n"
}
