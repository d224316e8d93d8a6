//! What a comparison of pictures found, in words of at most 100 columns, and as JSON.

use std::fmt::Write;
use std::path::PathBuf;

use bspray::analysis::images::{ChannelErrors, ColorDiff, Diff, DiffOptions, Incomparable, Limits};
use serde_json::{Value, json};

use super::numbers::double;

/// Columns that lists of names keep to.
const COLUMNS: usize = 100;

/// Everything that is told.
pub(super) struct DiffReport<'a> {
    pub(super) paths: [&'a PathBuf; 2],
    pub(super) options: &'a DiffOptions,
}

impl DiffReport<'_> {
    /// A table of the channels that differ, the measures of colours, and the verdict.
    pub(super) fn text(&self, diff: &Diff) -> String {
        let window = diff.window;
        let mut out = format!(
            "{} against {}: {}x{} pixels, {} channel{}\n",
            self.paths[0].display(),
            self.paths[1].display(),
            window.width,
            window.height,
            diff.channels.len(),
            if diff.channels.len() == 1 { "" } else { "s" },
        );
        if diff.has_other_windows {
            let _ = writeln!(
                out,
                "data windows differ: measured are the pixels of both, from {},{} on",
                window.x, window.y
            );
        }
        for (path, names) in self.paths.iter().zip(&diff.alone) {
            list(&format!("only in {}", path.display()), names, &mut out);
        }
        let differs = |c: &&ChannelErrors| c.worst.is_some();
        if diff.channels.iter().any(|c| differs(&c)) {
            let _ = writeln!(
                out,
                "\n{:<20}{:>11}{:>11}{:>9}{:>11}  {:<13}{:>10}{:>10}",
                "channel", "mean error", "RMS error", "PSNR dB", "max error", "at x,y", "A", "B"
            );
        }
        for channel in diff.channels.iter().filter(differs) {
            row(channel, &mut out);
        }
        let same = diff.channels.iter().filter(|c| !differs(c));
        let same: Vec<String> = same.map(|c| c.name.clone()).collect();
        list("without a difference", &same, &mut out);
        for channel in &diff.channels {
            not_numbers(channel, &mut out);
        }
        if let Some(color) = &diff.color {
            colors(color, self.options.pixels_per_degree, &mut out);
        }
        let total = diff.greatest.len();
        let mut count = |words: &str, count: usize, threshold: f64| {
            let share = 100.0 * count as f64 / total as f64;
            let _ = writeln!(
                out,
                "{count} of {total} pixels ({share:.3} %) over {threshold:e}{words}"
            );
        };
        count("", diff.failing, self.options.fail.threshold);
        if self.options.warn != self.options.fail {
            count(" (warning)", diff.warning, self.options.warn.threshold);
        }
        out += &diff.verdict.name().to_uppercase();
        out.push('\n');
        out
    }

    /// One JSON object.
    pub(super) fn json(&self, diff: &Diff) -> String {
        let window = diff.window;
        let report = json!({
            "a": self.paths[0].to_string_lossy(),
            "b": self.paths[1].to_string_lossy(),
            "verdict": diff.verdict.name(),
            "window_pixels": { "x": window.x, "y": window.y, "width": window.width, "height": window.height },
            "data_windows_differ": diff.has_other_windows,
            "channels_only_in_a": diff.alone[0],
            "channels_only_in_b": diff.alone[1],
            "pixels": diff.greatest.len(),
            "pixels_failing": diff.failing,
            "pixels_warning": diff.warning,
            "max_error": double(diff.largest()),
            "fail": limits(&self.options.fail),
            "warn": limits(&self.options.warn),
            "channels": diff.channels.iter().map(channel).collect::<Vec<_>>(),
            "color": diff.color.as_ref().map(|c| color(c, self.options.pixels_per_degree)),
        });
        format!("{report:#}")
    }

    /// One JSON object for pictures of which nothing can be measured.
    pub(super) fn json_without_measures(&self, cause: &Incomparable) -> String {
        let report = json!({
            "a": self.paths[0].to_string_lossy(),
            "b": self.paths[1].to_string_lossy(),
            "verdict": "different",
            "cause": cause.to_string(),
        });
        format!("{report:#}")
    }
}

/// Names after a heading, in lines of [`COLUMNS`]; nothing without names.
fn list(heading: &str, names: &[String], out: &mut String) {
    if names.is_empty() {
        return;
    }
    let mut line = format!("{heading}:");
    for name in names {
        if line.len() + 1 + name.len() > COLUMNS {
            let _ = writeln!(out, "{line}");
            line = "   ".to_owned();
        }
        let _ = write!(line, " {name}");
    }
    let _ = writeln!(out, "{line}");
}

fn row(channel: &ChannelErrors, out: &mut String) {
    let (place, [a, b]) = channel.worst.map_or((String::new(), [0.0; 2]), |w| {
        (format!("{},{}", w.at.0, w.at.1), w.values)
    });
    let _ = writeln!(
        out,
        "{:<20}{:>11}{:>11}{:>9.2}{:>11}  {place:<13}{:>10}{:>10}",
        channel.name,
        short(channel.mean),
        short(channel.rms),
        channel.psnr,
        short(channel.greatest),
        short(a),
        short(b)
    );
}

/// A number in at most ten characters.
fn short(x: f64) -> String {
    let whole = x.fract() == 0.0 && x.abs() < 1e9;
    if whole || !x.is_finite() {
        x.to_string()
    } else if (1e-3..1e6).contains(&x.abs()) {
        let text = format!("{x:.6}");
        let limit = if x < 0.0 { 9 } else { 8 };
        text.chars().take(limit).collect()
    } else {
        format!("{x:.3e}")
    }
}

fn not_numbers(channel: &ChannelErrors, out: &mut String) {
    let n = channel.non_finite;
    let words = [(n.nan, "NaN"), (n.infinite, "infinite values")];
    let words = words.into_iter().filter(|(count, _)| *count != [0, 0]);
    let words: Vec<String> = words
        .map(|([a, b], what)| format!("{a} and {b} {what}"))
        .collect();
    if !words.is_empty() {
        let alike = match n.unlike {
            0 => "at the same pixels".to_owned(),
            unlike => format!("pixels left out of its means: {unlike}"),
        };
        let _ = writeln!(out, "{}: {}; {alike}", channel.name, words.join(", "));
    }
}

fn colors(color: &ColorDiff, pixels_per_degree: f64, out: &mut String) {
    let name = match color.layer.as_str() {
        "" => "R G B".to_owned(),
        layer => format!("{layer}.R {layer}.G {layer}.B"),
    };
    let errors = color.errors;
    let ssim = color.ssim.map_or("-".to_owned(), |s| format!("{s:.6}"));
    let _ = writeln!(
        out,
        "\n{name}: MSE {}, relMSE {}, PSNR {:.2} dB, SSIM {ssim}, FLIP {:.6}",
        short(errors.mse),
        short(errors.rel_mse),
        errors.psnr,
        color.flip
    );
    let _ = write!(out, "(FLIP at {pixels_per_degree:.2} pixels a degree");
    if let Some(exposures) = color.exposures {
        let _ = write!(
            out,
            ", {} exposures from {:.2} to {:.2} stops",
            exposures.count, exposures.start, exposures.stop
        );
    }
    if errors.left_out > 0 {
        let _ = write!(
            out,
            "; {} pixels that are no colours are left out of MSE, relMSE and PSNR",
            errors.left_out
        );
    }
    let _ = writeln!(out, ")");
}

fn limits(limits: &Limits) -> Value {
    json!({ "threshold": double(limits.threshold), "percent": double(limits.percent), "hard": double(limits.hard) })
}

fn channel(channel: &ChannelErrors) -> Value {
    let worst = channel.worst.map(
        |w| json!({ "x": w.at.0, "y": w.at.1, "a": double(w.values[0]), "b": double(w.values[1]) }),
    );
    let n = channel.non_finite;
    json!({
        "name": channel.name,
        "mean_error": double(channel.mean),
        "rms_error": double(channel.rms),
        "psnr_db": double(channel.psnr),
        "max_error": double(channel.greatest),
        "max_error_at": worst,
        "pixels_over_fail_threshold": channel.beyond,
        "nan": { "a": n.nan[0], "b": n.nan[1] },
        "infinite": { "a": n.infinite[0], "b": n.infinite[1] },
        "unlike_non_finite": n.unlike,
    })
}

fn color(color: &ColorDiff, pixels_per_degree: f64) -> Value {
    let errors = color.errors;
    let exposures = color
        .exposures
        .map(|e| json!({ "start_stops": e.start, "stop_stops": e.stop, "count": e.count }));
    json!({
        "layer": color.layer,
        "mse": double(errors.mse),
        "rel_mse": double(errors.rel_mse),
        "psnr_db": double(errors.psnr),
        "ssim": color.ssim,
        "flip": double(color.flip),
        "flip_pixels_per_degree": double(pixels_per_degree),
        "flip_exposures": exposures,
        "pixels_left_out": errors.left_out,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_to_ten_characters() {
        for (x, expected) in [
            (0.0, "0"),
            (255.0, "255"),
            (-0.125, "-0.125000"),
            (12_345.678_901, "12345.67"),
            (1.234_56e-7, "1.235e-7"),
            (4_294_967_295.0, "4.295e9"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(x), expected);
        }
    }

    #[test]
    fn lists_of_names_are_wrapped() {
        let names: Vec<String> = (0..40).map(|i| format!("layer{i}.R")).collect();
        let mut out = String::new();
        list("only in a.exr", &names, &mut out);
        assert!(out.lines().count() > 3 && out.lines().all(|l| l.len() <= COLUMNS));
        assert_eq!(out.split_whitespace().count(), 43);
    }
}
