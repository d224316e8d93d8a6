//! Compares a picture with its reference: numbers of things exactly, places within rounding, colours within a tolerance. All
//! files that a person needs to judge a difference are written out.

use std::fmt::Write;
use std::path::Path;

use bspray::picture::{Channel, Picture, PictureError, Raster, Samples, ToneMap, exr, ldr};

/// How far a value of a channel may be from its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Tolerance {
    /// Not at all.
    Exact,
    /// So many ulps of the greatest finite magnitude in the reference's layer: what rounding in another order may change.
    Ulps(f32),
    /// So much, and such a share of the reference.
    Color { absolute: f32, relative: f32 },
}

/// The tolerance of a channel.
///
/// A colour is a mean of few samples, so that one shadow ray that meets something else moves it by percents: the tolerance is
/// for rounding alone.
pub(crate) fn tolerance(channel: &str) -> Tolerance {
    match channel.split('.').next().unwrap_or(channel) {
        // Ids, of which all bits count.
        "CryptoObject00" | "CryptoMaterial00" if channel.ends_with(['R', 'B']) => Tolerance::Exact,
        "id" | "material" | "prim" | "samples" | "fragment" | "bsp-depth" => Tolerance::Exact,
        "Z" | "distance" | "P" | "N" | "Ng" | "uv" => Tolerance::Ulps(4.0),
        _ => Tolerance::Color {
            absolute: 1e-5,
            relative: 1e-4,
        },
    }
}

fn floats(samples: &Samples) -> Vec<f32> {
    match samples {
        Samples::F16(values) | Samples::F32(values) => values.clone(),
        Samples::U32(values) => values.iter().map(|&v| v as f32).collect(),
    }
}

/// Values of a channel that are out of tolerance: index, found and wanted.
fn out_of_tolerance(name: &str, found: &Samples, want: &Samples) -> Vec<(usize, f64, f64)> {
    let pairs: Vec<(f64, f64)> = match (found, want) {
        (Samples::U32(found), Samples::U32(want)) => {
            let pair = |(a, b): (&u32, &u32)| (f64::from(*a), f64::from(*b));
            found.iter().zip(want).map(pair).collect()
        }
        _ => {
            let pair = |(a, b): (f32, f32)| (f64::from(a), f64::from(b));
            floats(found)
                .into_iter()
                .zip(floats(want))
                .map(pair)
                .collect()
        }
    };
    let finite = pairs.iter().map(|p| p.1.abs()).filter(|v| v.is_finite());
    let greatest = finite.fold(0.0, f64::max);
    let allowed = |want: f64| match tolerance(name) {
        Tolerance::Exact => 0.0,
        Tolerance::Ulps(count) => f64::from(count * f32::EPSILON) * greatest,
        Tolerance::Color { absolute, relative } => {
            f64::from(absolute) + f64::from(relative) * want.abs()
        }
    };
    let is_out = |(found, want): (f64, f64)| {
        // Infinite depths are equal; a NaN is out of any tolerance.
        let is_within = found.to_bits() == want.to_bits() || (found - want).abs() <= allowed(want);
        !is_within || found.is_nan()
    };
    let indexed = pairs.into_iter().enumerate();
    indexed
        .filter(|(_, pair)| is_out(*pair))
        .map(|(index, (found, want))| (index, found, want))
        .collect()
}

/// Every channel of `want` that is missing in `found` or differs, a line each; empty if the pictures agree.
pub(crate) fn differences(found: &Picture, want: &Picture) -> String {
    let mut lines = String::new();
    if (found.display, found.window) != (want.display, want.window) {
        let _ = writeln!(lines, "{:?} instead of {:?}", found.window, want.window);
        return lines;
    }
    for Channel { name, samples } in &want.channels {
        let Some(other) = found.channel(name) else {
            let _ = writeln!(lines, "{name} is missing");
            continue;
        };
        if std::mem::discriminant(other) != std::mem::discriminant(samples) {
            let _ = writeln!(lines, "{name} is of another type");
            continue;
        }
        let out = out_of_tolerance(name, other, samples);
        if let Some((index, value, reference)) = out.first() {
            let width = want.window.width as usize;
            let (x, y) = (index % width, index / width);
            let _ = writeln!(
                lines,
                "{name}: {} of {} pixels, the first at {x},{y}: {value} instead of {reference}",
                out.len(),
                samples.len()
            );
        }
    }
    lines
}

/// Found less wanted, channel by channel, as floats; equal infinities give 0.
fn difference(found: &Picture, want: &Picture) -> Picture {
    let mut picture = Picture::new(want.display.0, want.display.1).with_window(want.window);
    for Channel { name, samples } in &want.channels {
        let want = floats(samples);
        let found = found.channel(name).map_or(vec![0.0; want.len()], floats);
        let minus = |(a, b): (&f32, &f32)| {
            if a.to_bits() == b.to_bits() {
                0.0
            } else {
                a - b
            }
        };
        let values = found.iter().zip(&want).map(minus).collect();
        picture = picture.with_channel(Channel::new(name.as_str(), Samples::F32(values)));
    }
    picture
}

/// The difference for eyes: ten times that of the colours, and red wherever any channel is out of tolerance.
fn difference_for_eyes(found: &Picture, want: &Picture) -> Raster {
    let colors = difference(found, want);
    let channel = |name| colors.channel(name).map_or_else(Vec::new, floats);
    let [red, green, blue] = ["R", "G", "B"].map(channel);
    let mut pixels: Vec<[f32; 3]> = (0..red.len())
        .map(|i| ToneMap::Clip.apply([red[i], green[i], blue[i]].map(|v| 10.0 * v.abs())))
        .collect();
    for Channel { name, samples } in &want.channels {
        let other = found.channel(name);
        for (index, ..) in other.map_or_else(Vec::new, |o| out_of_tolerance(name, o, samples)) {
            pixels[index][0] = 1.0;
        }
    }
    Raster::from_rgb(want.window.width, want.window.height, &pixels)
}

/// Writes `NAME-render.exr`, `NAME-reference.exr`, `NAME-difference.exr` and `NAME-difference.png` into `folder`, and returns
/// their names.
///
/// # Errors
/// What the system says.
pub(crate) fn write_all(
    folder: &Path,
    name: &str,
    found: &Picture,
    want: &Picture,
) -> Result<[String; 4], PictureError> {
    std::fs::create_dir_all(folder).map_err(|e| PictureError::io(folder, e))?;
    let names = [
        "render.exr",
        "reference.exr",
        "difference.exr",
        "difference.png",
    ];
    let paths = names.map(|end| folder.join(format!("{name}-{end}")));
    exr::write(&paths[0], found)?;
    exr::write(&paths[1], want)?;
    if (found.window, found.display) == (want.window, want.display) {
        exr::write(&paths[2], &difference(found, want))?;
        ldr::write(&paths[3], &difference_for_eyes(found, want))?;
    }
    Ok(paths.map(|p| p.display().to_string()))
}
