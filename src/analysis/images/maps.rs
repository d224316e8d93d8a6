//! Pictures of differences.

use super::diff::Diff;
use super::errors::is_alike;
use super::pair::{Incomparable, Pair, Selection, Side};
use crate::picture::{Channel, Picture, Raster, Samples, Window, palette};

/// Name of the channel that holds the map of FLIP.
const FLIP: &str = "flip";

/// How plain differences are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DifferenceScale {
    /// What they are multiplied by.
    pub factor: f32,
    /// Whether their signs are dropped.
    pub is_absolute: bool,
}

/// The differences `a - b` of each channel of both, as floats, and the map of FLIP as the channel `flip` where there are colours. Where both are the same
/// infinity, or NaN, it is 0.
///
/// # Errors
/// As [`Diff::of`].
pub fn difference_layers(
    a: &Side,
    b: &Side,
    selection: &Selection,
    diff: &Diff,
    scale: DifferenceScale,
) -> Result<Picture, Incomparable> {
    let pair = Pair::of(a, b, selection)?;
    let value = |values: [f64; 2]| {
        let difference = if is_alike(values) {
            0.0
        } else {
            (values[0] - values[1]) as f32
        };
        let signed = difference * scale.factor;
        if scale.is_absolute {
            signed.abs()
        } else {
            signed
        }
    };
    let (width, height) = a.picture.display;
    let mut picture = Picture::new(width, height).with_window(pair.window);
    for channel in &pair.channels {
        let values = (0..pair.pixels()).map(|pixel| value(pair.values(channel, pixel)));
        let samples = Samples::F32(values.collect());
        picture = picture.with_channel(Channel::new(channel.name, samples));
    }
    if let Some(color) = diff
        .color
        .as_ref()
        .filter(|_| picture.channel(FLIP).is_none())
    {
        let samples = Samples::F32(color.flip_map.clone());
        picture = picture.with_channel(Channel::new(FLIP, samples));
    }
    Ok(picture)
}

/// A map of values in [0, 1] in the colours of magma, as FLIP's authors show theirs; greater values are as 1.
///
/// # Panics
/// If the number of values is not that of the window's pixels.
pub fn heat_map(values: impl IntoIterator<Item = f32>, window: Window) -> Raster {
    let pixels: Vec<[f32; 3]> = values.into_iter().map(palette::magma).collect();
    assert_eq!(pixels.len() as u64, window.pixels(), "a value a pixel");
    Raster::from_rgb(window.width, window.height, &pixels)
}

/// The absolute differences times `factor`, as codes: of red, green and blue where there are colours, else the greatest of any channel as grey.
pub fn difference_raster(diff: &Diff, factor: f32) -> Raster {
    let code = |difference: f32| {
        let scaled = (difference * factor).abs();
        // Codes, as idiff writes them: what would be decoded by the encoding that follows.
        crate::picture::srgb::decode(if scaled.is_nan() { 1.0 } else { scaled })
    };
    let pixels: Vec<[f32; 3]> = match &diff.color {
        Some(color) => {
            let [a, b] = &color.colors;
            let both = a.pixels.iter().zip(&b.pixels);
            both.map(|(a, b)| {
                std::array::from_fn(|i| {
                    let is_alike = is_alike([a[i], b[i]].map(f64::from));
                    code(if is_alike { 0.0 } else { a[i] - b[i] })
                })
            })
            .collect()
        }
        None => diff.greatest.iter().map(|&d| [code(d as f32); 3]).collect(),
    };
    Raster::from_rgb(diff.window.width, diff.window.height, &pixels)
}

#[cfg(test)]
mod tests {
    use super::super::diff::DiffOptions;
    use super::*;
    use crate::picture::{Encoding, RasterPixels};

    fn side(names: &[&str], values: [f32; 3]) -> Side {
        let mut picture = Picture::new(3, 1);
        for name in names {
            picture = picture.with_channel(Channel::new(*name, Samples::F32(values.to_vec())));
        }
        Side {
            picture,
            encoding: Encoding::Linear,
        }
    }

    fn codes(raster: Raster) -> Vec<[u8; 3]> {
        match raster.pixels {
            RasterPixels::Rgb(pixels) => pixels,
            RasterPixels::Rgba(_) => panic!("no alpha"),
        }
    }

    #[test]
    fn layers_hold_signed_or_absolute_scaled_differences_and_flip() {
        let names = ["R", "G", "B", "Z"];
        let a = side(&names, [1.0, f32::INFINITY, 0.25]);
        let b = side(&names, [1.5, f32::INFINITY, 0.0]);
        let diff = Diff::of(&a, &b, &DiffOptions::default()).unwrap();
        let layers = |factor, is_absolute| {
            let scale = DifferenceScale {
                factor,
                is_absolute,
            };
            difference_layers(&a, &b, &Selection::default(), &diff, scale).unwrap()
        };
        let values = |picture: &Picture, name: &str| picture.channel(name).cloned();
        let signed = layers(1.0, false);
        assert_eq!(
            values(&signed, "Z"),
            Some(Samples::F32(vec![-0.5, 0.0, 0.25]))
        );
        assert!(values(&signed, "flip").is_some());
        let absolute = layers(4.0, true);
        assert_eq!(
            values(&absolute, "R"),
            Some(Samples::F32(vec![2.0, 0.0, 1.0]))
        );
    }

    #[test]
    fn rasters_show_scaled_codes_and_heat() {
        let options = DiffOptions::default();
        let (names, values) = (["R", "G", "B"], [0.0, 0.1, f32::NAN]);
        for names in [&names[..], &["Z"]] {
            let (a, b) = (side(names, [0.0, 0.2, 0.5]), side(names, values));
            let raster = difference_raster(&Diff::of(&a, &b, &options).unwrap(), 5.0);
            assert_eq!(codes(raster), [[0; 3], [128; 3], [255; 3]]);
        }
        let window = Picture::new(2, 1).window;
        let heat = codes(heat_map([0.0, 7.0], window));
        assert_eq!(heat, [[0, 0, 4], [252, 253, 191]]);
    }
}
