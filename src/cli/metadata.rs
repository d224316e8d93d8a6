//! What an EXR file tells of its own making.

use bspray::analysis::machine;
use bspray::picture::{Attribute, Picture, attribute};
use serde_json::json;

use super::summary::RenderSummary;

/// Adds attributes: the standard `software`, and `bspray/...` for everything needed to make the picture again.
pub(super) fn add(picture: Picture, summary: &RenderSummary) -> Picture {
    let text = |t: &str| Attribute::Text(t.to_owned());
    let int = |n: u64| Attribute::Int(i32::try_from(n).unwrap_or(i32::MAX));
    let version = env!("CARGO_PKG_VERSION");
    let seconds = summary.seconds;
    let timings = json!({ "load": seconds.load, "build": seconds.build, "render": seconds.render });
    let picture = match summary.quality() {
        Some(quality) => picture.with_attribute("bspray/bspQuality", text(quality)),
        None => picture,
    };
    picture
        .with_attribute(attribute::SOFTWARE, text(&format!("bspray {version}")))
        .with_attribute("bspray/version", text(version))
        .with_attribute("bspray/commandLine", text(&command_line()))
        .with_attribute("bspray/accelerator", text(summary.accelerator.name()))
        .with_attribute("bspray/triangleTest", text(summary.triangle_test.name()))
        .with_attribute("bspray/integrator", text(summary.options.integrator.name()))
        .with_attribute("bspray/camera", text(summary.camera_flags))
        .with_attribute("bspray/seed", text(&summary.options.seed.to_string()))
        .with_attribute("bspray/samples", int(summary.samples_per_pixel()))
        .with_attribute("bspray/threads", int(summary.threads as u64))
        .with_attribute("bspray/machine", text(&machine()))
        .with_attribute("bspray/seconds", text(&timings.to_string()))
        .with_attribute("bspray/partial", int(u64::from(!summary.film.is_complete)))
}

/// The command line, each argument quoted where a shell would need it.
pub(super) fn command_line() -> String {
    let args = std::env::args_os().skip(1);
    let args = args.map(|a| quoted(&a.to_string_lossy()));
    std::iter::once("bspray".to_owned())
        .chain(args)
        .collect::<Vec<_>>()
        .join(" ")
}

/// An argument, quoted where a shell would need it.
pub(super) fn quoted(arg: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=+:@%".contains(c);
    if !arg.is_empty() && arg.chars().all(is_plain) {
        arg.to_owned()
    } else {
        format!("'{}'", arg.replace('\'', r"'\''"))
    }
}
