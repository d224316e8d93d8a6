//! Parsing of the values that arguments take.

use std::str::FromStr;

use bspray::accel::AcceleratorKind;
use bspray::render::PixelRect;
use glam::Vec3;

/// Largest width and height of a picture, in pixels.
const LARGEST: u32 = 1 << 16;

/// Most frames of a turntable: an hour of film. The list of them is checked before any work.
pub(super) const MOST_FRAMES: i64 = 100_000;

/// Most pixels that are rendered at once: with all layers they take some 200 bytes each. Larger pictures come in crops.
pub(super) const MOST_PIXELS: u64 = 1 << 26;

/// Most bounces that can be asked for: the recursion of `whitted` stays within a thread's stack.
pub(super) const MOST_DEPTH: i64 = 256;

/// Most samples a pixel: beyond them sums in single precision no longer grow.
pub(super) const MOST_SAMPLES: i64 = 1 << 20;

/// Most threads that can be asked for: more than any machine of today has.
const MOST_THREADS: usize = 4096;

/// Most rays of one kind that are compared: some gigabytes of rays and answers.
pub(super) const MOST_RAYS: i64 = 1 << 24;

/// `WxH` or `W,H`: width and height in pixels.
pub(super) fn resolution(text: &str) -> Result<(u32, u32), String> {
    let parts: Vec<_> = text.split([',', 'x', 'X']).collect();
    let side = |t: &str| {
        let value = t
            .trim()
            .parse::<u32>()
            .map_err(|_| format!("{t:?} is not a number of pixels"))?;
        if (1..=LARGEST).contains(&value) {
            Ok(value)
        } else {
            Err(format!("{value} is not in 1 to {LARGEST}"))
        }
    };
    match parts[..] {
        [width, height] => Ok((side(width)?, side(height)?)),
        _ => Err("want WIDTHxHEIGHT, such as 1280x720".to_owned()),
    }
}

/// `N` values with commas between.
pub(super) fn numbers<T: FromStr, const N: usize>(
    text: &str,
    form: &str,
) -> Result<[T; N], String> {
    let parts: Vec<_> = text.split(',').collect();
    if parts.len() != N {
        return Err(format!("want {form}"));
    }
    let parsed: Result<Vec<T>, String> = parts
        .iter()
        .map(|t| {
            t.trim()
                .parse()
                .map_err(|_| format!("{t:?} is not a number; want {form}"))
        })
        .collect();
    let Ok(array) = parsed?.try_into() else {
        return Err(format!("want {form}"));
    };
    Ok(array)
}

/// `X,Y,Z`.
pub(super) fn vector(text: &str) -> Result<Vec3, String> {
    let v = Vec3::from_array(numbers(text, "X,Y,Z")?);
    if v.is_finite() {
        Ok(v)
    } else {
        Err("want finite numbers".to_owned())
    }
}

/// `X,Y,Z`, not all zero.
pub(super) fn direction(text: &str) -> Result<Vec3, String> {
    let v = vector(text)?;
    if v == Vec3::ZERO {
        Err("want a direction, not 0,0,0".to_owned())
    } else {
        Ok(v)
    }
}

/// `X,Y`: column and row of a pixel.
pub(super) fn pixel(text: &str) -> Result<(u32, u32), String> {
    numbers::<u32, 2>(text, "X,Y").map(|[x, y]| (x, y))
}

/// An axis: `+Y`, `-Z`, `X`.
pub(super) fn axis(text: &str) -> Result<Vec3, String> {
    let (sign, name) = match text.strip_prefix('-') {
        Some(name) => (-1.0, name),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    let axis = match name {
        "x" | "X" => Vec3::X,
        "y" | "Y" => Vec3::Y,
        "z" | "Z" => Vec3::Z,
        _ => return Err("want one of +X -X +Y -Y +Z -Z".to_owned()),
    };
    Ok(axis * sign + Vec3::ZERO)
}

/// `HOST:PORT`.
pub(super) fn address(text: &str) -> Result<String, String> {
    let port = text.rsplit_once(':').filter(|(host, _)| !host.is_empty());
    match port.map(|(_, port)| port.parse::<u16>()) {
        Some(Ok(_)) => Ok(text.to_owned()),
        _ => Err("want HOST:PORT, such as localhost:14158".to_owned()),
    }
}

/// A positive, finite number.
pub(super) fn positive(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(v) if v > 0.0 && v.is_finite() => Ok(v),
        _ => Err("want a positive number".to_owned()),
    }
}

/// A number that is neither infinite nor NaN.
pub(super) fn finite(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(v) if v.is_finite() => Ok(v),
        _ => Err("want a finite number".to_owned()),
    }
}

/// A number of threads. A pool of many thousands takes minutes to start and gains nothing.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if n <= MOST_THREADS => Ok(n),
        _ => Err(format!("want a whole number from 0 to {MOST_THREADS}")),
    }
}

/// An angle between 0 and 180 degrees.
pub(super) fn view_angle(text: &str) -> Result<f32, String> {
    positive(text)
        .ok()
        .filter(|a| *a < 180.0)
        .ok_or_else(|| "want an angle between 0 and 180 degrees".to_owned())
}

/// An angle between normals, from 0 to 180 degrees.
pub(super) fn crease_angle(text: &str) -> Result<f32, String> {
    finite(text)
        .ok()
        .filter(|a| (0.0..=180.0).contains(a))
        .ok_or_else(|| "want an angle from 0 to 180 degrees".to_owned())
}

/// An amount of memory in bytes: `8GiB`, `1.5GB`, `4096`.
pub(super) fn memory(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 10] = [
        ("", 1.0),
        ("b", 1.0),
        ("kb", 1e3),
        ("mb", 1e6),
        ("gb", 1e9),
        ("tb", 1e12),
        ("kib", 1024.0),
        ("mib", 1_048_576.0),
        ("gib", 1_073_741_824.0),
        ("tib", 1_099_511_627_776.0),
    ];
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = text[number.len()..].to_ascii_lowercase();
    let factor = UNITS.iter().find(|(name, _)| *name == unit);
    let bytes = number.trim().parse::<f64>().ok().zip(factor);
    match bytes.map(|(number, (_, factor))| number * factor) {
        // Beyond 2^64 it is all that there is.
        Some(bytes) if bytes >= 1.0 => Ok(bytes as u64),
        _ => Err("want a size such as 8GiB, 512MiB or 2000000000 (bytes)".to_owned()),
    }
}

/// A part of a picture: `x0,x1,y0,y1` as shares of its width and height, as pbrt has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CropWindow([f64; 4]);

impl FromStr for CropWindow {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [x0, x1, y0, y1] = numbers::<f64, 4>(text, "X0,X1,Y0,Y1, each from 0 to 1")?;
        let is_range = |a: f64, b: f64| 0.0 <= a && a < b && b <= 1.0;
        if is_range(x0, x1) && is_range(y0, y1) {
            Ok(Self([x0, x1, y0, y1]))
        } else {
            Err("want 0 <= X0 < X1 <= 1 and 0 <= Y0 < Y1 <= 1".to_owned())
        }
    }
}

impl CropWindow {
    /// The pixels of a picture of `size` whose left and top edges fall into the window, and at least one.
    pub(super) fn pixels(self, size: (u32, u32)) -> PixelRect {
        let [x0, x1, y0, y1] = self.0;
        let range = |from: f64, to: f64, size: u32| {
            let first = (from * f64::from(size)).ceil().min(f64::from(size - 1));
            let end = (to * f64::from(size)).ceil().max(first + 1.0);
            (first as u32, (end - first) as u32)
        };
        let ((x, width), (y, height)) = (range(x0, x1, size.0), range(y0, y1, size.1));
        PixelRect {
            x,
            y,
            width,
            height,
        }
    }
}

/// A part of a picture: `x0,x1,y0,y1` in pixels; the second of each pair is not part of it, as pbrt has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelBounds([u32; 4]);

impl FromStr for PixelBounds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [x0, x1, y0, y1] = numbers::<u32, 4>(text, "X0,X1,Y0,Y1 in pixels")?;
        if x0 < x1 && y0 < y1 {
            Ok(Self([x0, x1, y0, y1]))
        } else {
            Err("want X0 < X1 and Y0 < Y1".to_owned())
        }
    }
}

impl PixelBounds {
    /// The same as a rectangle, if it lies within a picture of `size`.
    pub(super) fn pixels(self, size: (u32, u32)) -> Result<PixelRect, String> {
        let [x0, x1, y0, y1] = self.0;
        if x1 > size.0 || y1 > size.1 {
            return Err(format!(
                "--pixelbounds reaches beyond the picture of {}x{} pixels",
                size.0, size.1
            ));
        }
        Ok(PixelRect {
            x: x0,
            y: y0,
            width: x1 - x0,
            height: y1 - y0,
        })
    }
}

/// The name of an accelerator.
pub(super) fn accelerator(text: &str) -> Result<AcceleratorKind, String> {
    let names = || AcceleratorKind::ALL.map(AcceleratorKind::name).join(", ");
    AcceleratorKind::ALL
        .into_iter()
        .find(|k| k.name() == text)
        .ok_or_else(|| format!("want one of {}", names()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolutions_come_in_two_spellings() {
        assert_eq!(resolution("1280x720"), Ok((1280, 720)));
        assert_eq!(resolution("1000,600"), Ok((1000, 600)));
        for wrong in ["", "12", "0x5", "5x0", "1x2x3", "-4x4", "99999x1", "axb"] {
            assert!(resolution(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn amounts_of_memory_have_units() {
        let sizes = [
            "8GiB",
            "1.5 kb",
            "512MiB",
            "4096",
            "7B",
            "1e3",
            "99999999TiB",
        ];
        let bytes = [8 << 30, 1500, 512 << 20, 4096, 7, 1000, u64::MAX];
        assert_eq!(sizes.map(memory), bytes.map(Ok));
        for wrong in [
            "", "GiB", "0", "-1GiB", "1 bit", "nan", "inf", "8G", "1GiB2",
        ] {
            assert!(memory(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn axes_have_signs() {
        assert_eq!(axis("+Z"), Ok(Vec3::Z));
        assert_eq!(axis("-x"), Ok(Vec3::NEG_X));
        assert!(axis("+-Z").is_err() && axis("W").is_err() && axis("").is_err());
    }

    #[test]
    fn crops_tile_a_picture_without_gap_or_overlap() {
        let crop = |t: &str, size| t.parse::<CropWindow>().expect("valid").pixels(size);
        let (left, right) = (crop("0,0.35,0,1", (10, 7)), crop("0.35,1,0,1", (10, 7)));
        assert_eq!((left.x, left.width, left.height), (0, 4, 7));
        assert_eq!((right.x, right.width), (4, 6));
        assert_eq!(
            crop("0.999,1,0,0.001", (10, 7)),
            PixelRect {
                x: 9,
                y: 0,
                width: 1,
                height: 1
            }
        );
        for wrong in ["0,1,0", "0.5,0.5,0,1", "0,1.5,0,1", "-1,1,0,1", "0,nan,0,1"] {
            assert!(wrong.parse::<CropWindow>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn vectors_and_bounds_are_checked() {
        assert_eq!(vector("-1, 2.5,3e2"), Ok(Vec3::new(-1.0, 2.5, 300.0)));
        assert!(
            vector("1,2").is_err() && vector("1,2,inf").is_err() && direction("0,0,-0").is_err()
        );
        let bounds = "2,4,1,3".parse::<PixelBounds>().expect("valid");
        assert_eq!(
            bounds.pixels((4, 3)),
            Ok(PixelRect {
                x: 2,
                y: 1,
                width: 2,
                height: 2
            })
        );
        assert!(bounds.pixels((3, 3)).is_err());
        assert!("4,2,1,3".parse::<PixelBounds>().is_err());
    }
}
