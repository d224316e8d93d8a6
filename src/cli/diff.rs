//! `bspray diff`: how two pictures differ, and whether they differ too much.

use std::path::{Path, PathBuf};

use anyhow::bail;
use bspray::analysis::images::{
    DEFAULT_THRESHOLD, Diff, DiffOptions, DifferenceScale, Exposures, Limits, PIXELS_PER_DEGREE,
    Selection, Side, Verdict, difference_layers, difference_raster, heat_map,
};
use bspray::picture::exr::write as write_exr;
use bspray::picture::{PictureError, ldr, read_picture};
use clap::{Args, ValueEnum};

use super::diff_report::DiffReport;
use super::{Done, UsageError, diff_values, files, output, values};

/// Arguments of `bspray diff`.
#[derive(Args, Debug)]
#[command(
    after_help = "Exit codes: 0 the same within the thresholds, also with a warning; 5 different, also in size, data window or channels; \
    1 a file cannot be read or written; 2 wrong usage."
)]
pub(super) struct DiffArgs {
    /// A picture: EXR with all its channels, HDR, PNG, JPEG, TGA, BMP, WebP
    a: PathBuf,
    /// The picture it is compared with, of the same size: the reference
    b: PathBuf,
    /// A pixel fails if a channel differs by more
    #[arg(long, value_name = "X", default_value_t = DEFAULT_THRESHOLD, value_parser = diff_values::limit, help_heading = "Thresholds, as idiff has them")]
    fail: f64,
    /// Percentage of pixels that may fail
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = diff_values::limit, help_heading = "Thresholds, as idiff has them")]
    fail_percent: f64,
    /// No pixel may differ by more, whatever the percentage [default: inf]
    #[arg(long, value_name = "X", default_value_t = f64::INFINITY, hide_default_value = true, value_parser = diff_values::limit, help_heading = "Thresholds, as idiff has them")]
    hard_fail: f64,
    /// A pixel warns if a channel differs by more
    #[arg(long, value_name = "X", default_value_t = DEFAULT_THRESHOLD, value_parser = diff_values::limit, help_heading = "Thresholds, as idiff has them")]
    warn: f64,
    /// Percentage of pixels that may warn
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = diff_values::limit, help_heading = "Thresholds, as idiff has them")]
    warn_percent: f64,
    /// Warn if a pixel differs by more [default: inf]
    #[arg(long, value_name = "X", default_value_t = f64::INFINITY, hide_default_value = true, value_parser = diff_values::limit, help_heading = "Thresholds, as idiff has them")]
    hard_warn: f64,
    /// Only these channels or layers, with commas between
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    only: Vec<String>,
    /// Not these channels or layers, with commas between, such as cost
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    ignore: Vec<String>,
    /// Of crops with different data windows, compare the pixels of both; without it such crops are different
    #[arg(long)]
    overlap: bool,
    /// The layer whose R, G and B get SSIM, FLIP and relMSE [default: the file's own, or else the first that has them]
    #[arg(long, value_name = "NAME", help_heading = "Colours")]
    layer: Option<String>,
    /// FLIP: pixels in a degree of vision [default: 67.02, which is 3840 pixels over 0.7 m seen from 0.7 m]
    #[arg(long, value_name = "N", default_value_t = PIXELS_PER_DEGREE, hide_default_value = true, value_parser = diff_values::pixels_per_degree, help_heading = "Colours")]
    ppd: f64,
    /// FLIP of EXR and HDR: exposures in stops, from the first to the last, and how many [default: from the reference]
    #[arg(long, value_name = "START,STOP,COUNT", value_parser = diff_values::exposures, allow_hyphen_values = true, help_heading = "Colours")]
    exposures: Option<Exposures>,
    /// Write a picture of the differences: .png or .jpg as --map says, .exr with A - B of every channel and the map of FLIP
    #[arg(short, long, value_name = "FILE", help_heading = "Difference picture")]
    output: Option<PathBuf>,
    /// What a .png or .jpg shows [default: flip, or abs without colours]
    #[arg(
        long,
        value_enum,
        value_name = "MAP",
        help_heading = "Difference picture"
    )]
    map: Option<Map>,
    /// Multiply differences by this
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = values::finite, allow_hyphen_values = true, help_heading = "Difference picture")]
    scale: f32,
    /// In an .exr, differences without their sign
    #[arg(long, help_heading = "Difference picture")]
    abs: bool,
    /// Print one JSON object
    #[arg(long, help_heading = "Reports")]
    json: bool,
    /// Print nothing: the exit code tells
    #[arg(short, long, conflicts_with = "json", help_heading = "Reports")]
    quiet: bool,
}

/// Which differences a display picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Map {
    /// FLIP in the colours of magma, from black for the same to pale yellow
    Flip,
    /// |A - B| of red, green and blue, or of the channel that differs most, as grey
    Abs,
}

/// Compares and tells.
pub(super) fn run(args: &DiffArgs) -> anyhow::Result<Done> {
    if let Some(path) = &args.output {
        check_output(path, args)?;
    }
    let sides = [&args.a, &args.b].map(|path| {
        let (picture, encoding) = read_picture(path)?;
        Ok::<_, PictureError>(Side { picture, encoding })
    });
    let [a, b] = sides;
    let (a, b) = (a?, b?);
    let options = options(args);
    let report = DiffReport {
        paths: [&args.a, &args.b],
        options: &options,
    };
    let diff = match Diff::of(&a, &b, &options) {
        Ok(diff) => diff,
        Err(cause) if cause.is_difference() => {
            if args.json {
                output::result(&report.json_without_measures(&cause))?;
            }
            if !args.quiet {
                let [a, b] = report.paths.map(|p| p.display());
                output::message(&format!("different: {a}, {b}: {cause}"));
            }
            return Ok(Done::Different);
        }
        Err(cause) => bail!(UsageError(cause.to_string())),
    };
    if let Some(path) = &args.output {
        write(path, args, [&a, &b], &options, &diff)?;
    }
    if !args.quiet {
        output::result(&if args.json {
            report.json(&diff)
        } else {
            report.text(&diff)
        })?;
    }
    Ok(match diff.verdict {
        Verdict::Same | Verdict::Warning => Done::Completely,
        Verdict::Different => Done::Different,
    })
}

fn options(args: &DiffArgs) -> DiffOptions {
    DiffOptions {
        fail: Limits {
            threshold: args.fail,
            percent: args.fail_percent,
            hard: args.hard_fail,
        },
        warn: Limits {
            threshold: args.warn,
            percent: args.warn_percent,
            hard: args.hard_warn,
        },
        selection: Selection {
            only: args.only.clone(),
            ignored: args.ignore.clone(),
        },
        layer: args.layer.clone(),
        takes_overlap: args.overlap,
        pixels_per_degree: args.ppd,
        exposures: args.exposures,
    }
}

/// Refuses, before anything is compared, a difference picture that cannot be.
fn check_output(path: &Path, args: &DiffArgs) -> anyhow::Result<()> {
    if !is_exr(path) {
        ldr::LdrFormat::of_path(path).map_err(|e| UsageError(e.to_string()))?;
    }
    files::check_writable(path, std::iter::empty())?;
    files::spare(path, [&*args.a, &*args.b].into_iter())
}

fn is_exr(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("exr"))
}

fn write(
    path: &Path,
    args: &DiffArgs,
    [a, b]: [&Side; 2],
    options: &DiffOptions,
    diff: &Diff,
) -> anyhow::Result<()> {
    if is_exr(path) {
        let scale = DifferenceScale {
            factor: args.scale,
            is_absolute: args.abs,
        };
        let layers = difference_layers(a, b, &options.selection, diff, scale)?;
        return Ok(write_exr(path, &layers)?);
    }
    let raster = match (args.map, &diff.color) {
        (Some(Map::Flip), None) => {
            bail!(UsageError(
                "--map flip needs the channels R, G and B".to_owned()
            ))
        }
        (Some(Map::Flip) | None, Some(color)) => {
            heat_map(color.flip_map.iter().copied(), diff.window)
        }
        _ => difference_raster(diff, args.scale),
    };
    Ok(ldr::write(path, &raster)?)
}
