//! Everything that is told of the differences between two pictures.

use rayon::prelude::*;

use super::colors::Colors;
use super::errors::{ChannelErrors, ColorErrors, difference};
use super::flip::{Exposures, PIXELS_PER_DEGREE, flip_hdr, flip_ldr};
use super::pair::{Incomparable, Pair, Selection, Side};
use super::ssim::ssim;
use super::thresholds::{Limits, Verdict};
use crate::picture::{Encoding, Window};

/// What is compared, and how.
#[derive(Clone, Debug)]
pub struct DiffOptions {
    /// Beyond these, pictures are different.
    pub fail: Limits,
    /// Beyond these, a warning is given.
    pub warn: Limits,
    /// The channels.
    pub selection: Selection,
    /// The layer whose colours are measured; by default the file's own R, G and B, or those of the first layer that has them.
    pub layer: Option<String>,
    /// Whether data windows may differ, and only the pixels of both count.
    pub takes_overlap: bool,
    /// Of FLIP: pixels in a degree of vision.
    pub pixels_per_degree: f64,
    /// Of FLIP between pictures of linear light; by default from the reference.
    pub exposures: Option<Exposures>,
}

impl Default for DiffOptions {
    /// idiff's limits, all channels, and FLIP as its authors have it.
    fn default() -> Self {
        Self {
            fail: Limits::default(),
            warn: Limits::default(),
            selection: Selection::default(),
            layer: None,
            takes_overlap: false,
            pixels_per_degree: PIXELS_PER_DEGREE,
            exposures: None,
        }
    }
}

/// How two pictures look beside one another. The second is the reference.
#[derive(Clone, Debug)]
pub struct ColorDiff {
    /// The layer; empty for the file's own colours.
    pub layer: String,
    /// Of the numbers.
    pub errors: ColorErrors,
    /// Of display codes (linear light is cut off at 1); `None` for pictures of less than 11 pixels on a side.
    pub ssim: Option<f64>,
    /// Mean of the map of FLIP.
    pub flip: f64,
    /// The map of FLIP, row by row.
    pub flip_map: Vec<f32>,
    /// The exposures of FLIP between pictures of linear light.
    pub exposures: Option<Exposures>,
    /// The colours, as they are in the files.
    pub colors: [Colors; 2],
}

/// All differences.
#[derive(Clone, Debug)]
pub struct Diff {
    /// The pixels of both, which all measures are of.
    pub window: Window,
    /// Whether one picture covers pixels that the other does not.
    pub has_other_windows: bool,
    /// Channels that only the first, and only the second, has.
    pub alone: [Vec<String>; 2],
    /// Differences of the channels of both, in the order of the first.
    pub channels: Vec<ChannelErrors>,
    /// Pixels with a channel beyond the threshold of failure.
    pub failing: usize,
    /// Pixels with a channel beyond the threshold of warning.
    pub warning: usize,
    /// The greatest difference of any channel, for each pixel.
    pub greatest: Vec<f64>,
    /// Of colours, where both have them.
    pub color: Option<ColorDiff>,
    /// What is said of it all.
    pub verdict: Verdict,
}

impl Diff {
    /// Compares `a` with the reference `b`.
    ///
    /// # Errors
    /// If there is nothing to measure.
    ///
    /// ```
    /// use bspray::analysis::images::{Diff, DiffOptions, Side, Verdict};
    /// use bspray::picture::{Channel, Encoding, Picture, Samples};
    ///
    /// let side = |depth: f32| Side {
    ///     picture: Picture::new(2, 1).with_channel(Channel::new("Z", Samples::F32(vec![depth, f32::INFINITY]))),
    ///     encoding: Encoding::Linear,
    /// };
    /// let diff = Diff::of(&side(3.0), &side(3.5), &DiffOptions::default())?;
    /// assert_eq!(diff.verdict, Verdict::Different);
    /// assert_eq!((diff.channels[0].greatest, diff.failing), (0.5, 1));
    /// # Ok::<(), bspray::analysis::images::Incomparable>(())
    /// ```
    pub fn of(a: &Side, b: &Side, options: &DiffOptions) -> Result<Self, Incomparable> {
        let pair = Pair::of(a, b, &options.selection)?;
        let channels: Vec<ChannelErrors> = pair
            .channels
            .par_iter()
            .map(|channel| ChannelErrors::of(&pair, channel, options.fail.threshold))
            .collect();
        let greatest_at = |pixel: usize| {
            let values = pair.channels.iter().map(|c| pair.values(c, pixel));
            values.map(difference).fold(0.0, f64::max)
        };
        let greatest: Vec<f64> = (0..pair.pixels())
            .into_par_iter()
            .map(greatest_at)
            .collect();
        let beyond = |limit: &Limits| greatest.iter().filter(|d| **d > limit.threshold).count();
        let (failing, warning) = (beyond(&options.fail), beyond(&options.warn));
        let color = color_names(&pair, options)?
            .map(|(layer, names)| color_diff(&pair, layer, names, a.encoding, options));
        let mut diff = Self {
            window: pair.window,
            has_other_windows: pair.has_other_windows(),
            alone: pair.alone,
            channels,
            failing,
            warning,
            greatest,
            color,
            verdict: Verdict::Same,
        };
        diff.verdict = diff.judge(options);
        Ok(diff)
    }

    /// The greatest difference of any channel and pixel.
    pub fn largest(&self) -> f64 {
        self.channels.iter().map(|c| c.greatest).fold(0.0, f64::max)
    }

    /// Whether the shapes differ: what no threshold forgives.
    pub fn has_other_shape(&self, takes_overlap: bool) -> bool {
        (self.has_other_windows && !takes_overlap) || self.alone.iter().any(|a| !a.is_empty())
    }

    fn judge(&self, options: &DiffOptions) -> Verdict {
        let (pixels, largest) = (self.greatest.len(), self.largest());
        let fails = options.fail.are_exceeded(self.failing, pixels, largest);
        if fails || self.has_other_shape(options.takes_overlap) {
            Verdict::Different
        } else if options.warn.are_exceeded(self.warning, pixels, largest) {
            Verdict::Warning
        } else {
            Verdict::Same
        }
    }
}

/// The layer whose colours are measured, and the places of its red, green and blue among the pair's channels.
fn color_names(
    pair: &Pair,
    options: &DiffOptions,
) -> Result<Option<(String, [usize; 3])>, Incomparable> {
    let find = |layer: &str| {
        let name = |c: &str| match layer {
            "" => c.to_owned(),
            layer => format!("{layer}.{c}"),
        };
        let place = |c: &str| pair.channels.iter().position(|b| b.name == name(c));
        Some([place("R")?, place("G")?, place("B")?])
    };
    if let Some(layer) = &options.layer {
        let found = find(layer).ok_or_else(|| Incomparable::NoLayer(layer.clone()))?;
        return Ok(Some((layer.clone(), found)));
    }
    let layers = pair.channels.iter();
    let layers = layers.filter_map(|c| c.name.rsplit_once('.').map(|(layer, _)| layer));
    let mut candidates = std::iter::once("").chain(layers);
    Ok(candidates.find_map(|layer| Some((layer.to_owned(), find(layer)?))))
}

fn color_diff(
    pair: &Pair,
    layer: String,
    places: [usize; 3],
    encoding: Encoding,
    options: &DiffOptions,
) -> ColorDiff {
    let colors = [0, 1].map(|side| Colors {
        width: pair.window.width as usize,
        pixels: (0..pair.pixels())
            .into_par_iter()
            .map(|pixel| places.map(|c| pair.values(&pair.channels[c], pixel)[side] as f32))
            .collect(),
    });
    let [test, reference] = [0, 1].map(|side| colors[side].finite());
    let (flip_map, exposures) = match encoding {
        Encoding::Display => {
            let [test, reference] = [&test, &reference].map(|c| c.linear(encoding));
            let map = flip_ldr(&test, &reference, options.pixels_per_degree);
            (map, None)
        }
        Encoding::Linear => {
            let ppd = options.pixels_per_degree;
            let (map, exposures) = flip_hdr(&test, &reference, ppd, options.exposures);
            (map, Some(exposures))
        }
    };
    let sum: f64 = flip_map.iter().copied().map(f64::from).sum();
    ColorDiff {
        layer,
        errors: ColorErrors::of(&colors[0], &colors[1], encoding),
        ssim: ssim(&test.display(encoding), &reference.display(encoding)),
        flip: sum / flip_map.len() as f64,
        flip_map,
        exposures,
        colors,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Channel, Picture, Samples};

    fn side(channels: &[(&str, [f32; 4])]) -> Side {
        let mut picture = Picture::new(4, 1);
        for (name, values) in channels {
            picture = picture.with_channel(Channel::new(*name, Samples::F32(values.to_vec())));
        }
        Side {
            picture,
            encoding: Encoding::Linear,
        }
    }

    fn limits(threshold: f64, percent: f64) -> Limits {
        Limits {
            threshold,
            percent,
            ..Limits::default()
        }
    }

    #[test]
    fn a_pixel_counts_once_whatever_channels_of_it_differ() {
        let a = side(&[("x", [0.0, 1.0, 2.0, 3.0]), ("y", [0.0; 4])]);
        let b = side(&[("x", [0.0, 1.5, 2.0, 3.5]), ("y", [0.0, 1.0, 0.0, 0.0])]);
        let verdict = |fail, warn| {
            let options = DiffOptions {
                fail,
                warn,
                ..DiffOptions::default()
            };
            Diff::of(&a, &b, &options).unwrap().verdict
        };
        let usual = Limits::default();
        assert_eq!(verdict(usual, usual), Verdict::Different);
        assert_eq!(verdict(limits(1e-6, 50.0), usual), Verdict::Warning);
        assert_eq!(verdict(limits(1e-6, 49.0), usual), Verdict::Different);
        assert_eq!(verdict(limits(1.0, 0.0), limits(1.0, 0.0)), Verdict::Same);
        let hard = Limits {
            hard: 0.9,
            ..limits(1e-6, 50.0)
        };
        assert_eq!(verdict(hard, usual), Verdict::Different);
    }

    #[test]
    fn a_channel_of_one_side_is_a_difference_that_no_threshold_forgives() {
        let (a, b) = (
            side(&[("x", [1.0; 4])]),
            side(&[("x", [1.0; 4]), ("y", [0.0; 4])]),
        );
        let options = DiffOptions {
            fail: limits(1e9, 100.0),
            ..DiffOptions::default()
        };
        let diff = Diff::of(&a, &b, &options).unwrap();
        assert_eq!((diff.verdict, diff.failing), (Verdict::Different, 0));
        assert_eq!(diff.alone, [vec![], vec!["y".to_owned()]]);
    }

    #[test]
    fn colours_are_the_files_own_or_those_of_a_layer() {
        let values = [0.1, 0.2, 0.3, 0.4];
        let layer = |name: &str| {
            let names = ["R", "G", "B"].map(|c| format!("{name}{c}"));
            side(&[
                ("Z", values),
                (&names[0], values),
                (&names[1], values),
                (&names[2], [0.9; 4]),
            ])
        };
        let found = |side: &Side, layer: Option<&str>| {
            let options = DiffOptions {
                layer: layer.map(str::to_owned),
                ..DiffOptions::default()
            };
            Diff::of(side, side, &options).map(|d| d.color.map(|c| (c.layer, c.flip, c.ssim)))
        };
        let same = |layer: &str| Ok(Some((layer.to_owned(), 0.0, None)));
        assert_eq!(found(&layer(""), None), same(""));
        assert_eq!(found(&layer("direct."), None), same("direct"));
        assert_eq!(found(&layer("a.b."), Some("a.b")), same("a.b"));
        assert_eq!(
            found(&layer(""), Some("direct")),
            Err(Incomparable::NoLayer("direct".to_owned()))
        );
        assert_eq!(found(&side(&[("Z", values)]), None), Ok(None));
    }

    #[test]
    fn colours_that_are_no_numbers_spoil_neither_ssim_nor_flip() {
        let plane = |bad: f32| {
            let mut values = vec![0.5; 169];
            values[84] = bad;
            let channel = |name: &str| Channel::new(name, Samples::F32(values.clone()));
            let picture = Picture::new(13, 13);
            Side {
                picture: ["R", "G", "B"]
                    .into_iter()
                    .fold(picture, |p, c| p.with_channel(channel(c))),
                encoding: Encoding::Linear,
            }
        };
        let diff = Diff::of(&plane(f32::NAN), &plane(0.5), &DiffOptions::default()).unwrap();
        let color = diff.color.unwrap();
        assert_eq!((color.errors.left_out, color.errors.mse), (1, 0.0));
        assert!(color.ssim.unwrap() < 0.99 && color.flip > 0.0 && color.flip < 0.5);
        assert!(color.flip_map.iter().all(|v| v.is_finite()));
    }
}
