//! Two pictures laid over one another: which channels and which pixels both have.

use crate::picture::{Encoding, Picture, Samples, Window};

/// A picture to be compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// Its channels.
    pub picture: Picture,
    /// What its colours' numbers are.
    pub encoding: Encoding,
}

/// Why two pictures have nothing that could be measured.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Incomparable {
    /// Of other sizes.
    #[error("the pictures' sizes differ: {}x{} and {}x{} pixels", .0.0, .0.1, .1.0, .1.1)]
    Sizes((u32, u32), (u32, u32)),
    /// Crops that have no pixel in common.
    #[error("the pictures have no pixel in common: their data windows are apart")]
    Apart,
    /// No channel is in both, or none that was asked for.
    #[error("the pictures have no channel in common")]
    NoChannel,
    /// One of linear light and one of display codes.
    #[error("one picture holds linear light and the other display colours: compare two of a kind")]
    Encodings,
    /// There are no such colours.
    #[error("{0:?} is no layer with R, G and B of both pictures")]
    NoLayer(String),
}

impl Incomparable {
    /// Whether the pictures are different by that, rather than the question wrong.
    pub fn is_difference(&self) -> bool {
        matches!(self, Self::Sizes(..) | Self::Apart | Self::NoChannel)
    }
}

/// Which channels count: of a list, a name is that of a channel or of the layer it is in.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// If not empty, only these.
    pub only: Vec<String>,
    /// Not these.
    pub ignored: Vec<String>,
}

impl Selection {
    fn has(&self, channel: &str) -> bool {
        let names = |name: &String| match channel.strip_prefix(name.as_str()) {
            Some(rest) => rest.is_empty() || rest.starts_with('.'),
            None => false,
        };
        (self.only.is_empty() || self.only.iter().any(names)) && !self.ignored.iter().any(names)
    }
}

/// A channel of both pictures.
pub(super) struct Both<'a> {
    pub(super) name: &'a str,
    pub(super) samples: [&'a Samples; 2],
}

/// Two pictures over one another.
pub(super) struct Pair<'a> {
    /// The pixels of both.
    pub(super) window: Window,
    windows: [Window; 2],
    pub(super) channels: Vec<Both<'a>>,
    /// Names of channels that only one has, for each.
    pub(super) alone: [Vec<String>; 2],
}

impl<'a> Pair<'a> {
    pub(super) fn of(
        a: &'a Side,
        b: &'a Side,
        selection: &Selection,
    ) -> Result<Self, Incomparable> {
        let sides = [&a.picture, &b.picture];
        if sides[0].display != sides[1].display {
            return Err(Incomparable::Sizes(sides[0].display, sides[1].display));
        }
        if a.encoding != b.encoding {
            return Err(Incomparable::Encodings);
        }
        let windows = sides.map(|s| s.window);
        let window = common(windows).ok_or(Incomparable::Apart)?;
        let wanted = |of: &'a Picture| of.channels.iter().filter(|c| selection.has(&c.name));
        let both = wanted(sides[0]).filter_map(|channel| {
            let other = sides[1].channel(&channel.name)?;
            Some(Both {
                name: channel.name.as_str(),
                samples: [&channel.samples, other],
            })
        });
        let channels: Vec<_> = both.collect();
        if channels.is_empty() {
            return Err(Incomparable::NoChannel);
        }
        let alone = |own: usize| {
            let lonely = wanted(sides[own]).filter(|c| sides[1 - own].channel(&c.name).is_none());
            lonely.map(|c| c.name.clone()).collect()
        };
        Ok(Self {
            window,
            windows,
            channels,
            alone: [alone(0), alone(1)],
        })
    }

    /// Whether one covers pixels that the other does not.
    pub(super) fn has_other_windows(&self) -> bool {
        self.windows[0] != self.windows[1]
    }

    /// Number of common pixels.
    pub(super) fn pixels(&self) -> usize {
        self.window.pixels() as usize
    }

    /// Column and row of a common pixel by its number, from the top left corner of the display window.
    pub(super) fn place(&self, pixel: usize) -> (i32, i32) {
        let width = self.window.width as usize;
        let at = |start: i32, offset: usize| start.saturating_add(offset as i32);
        (
            at(self.window.x, pixel % width),
            at(self.window.y, pixel / width),
        )
    }

    /// The values of both at a common pixel by its number.
    pub(super) fn values(&self, channel: &Both, pixel: usize) -> [f64; 2] {
        let width = self.window.width as usize;
        let (x, y) = (pixel % width, pixel / width);
        [0, 1].map(|side| {
            let own = self.windows[side];
            let (left, top) = (self.window.x.abs_diff(own.x), self.window.y.abs_diff(own.y));
            let at = (y + top as usize) * own.width as usize + x + left as usize;
            match channel.samples[side] {
                Samples::F16(values) | Samples::F32(values) => f64::from(values[at]),
                Samples::U32(values) => f64::from(values[at]),
            }
        })
    }
}

/// The pixels of both windows; `None` without any.
fn common([a, b]: [Window; 2]) -> Option<Window> {
    let range = |a: (i32, u32), b: (i32, u32)| {
        let end = |(start, length): (i32, u32)| i64::from(start) + i64::from(length);
        let start = a.0.max(b.0);
        let length = end(a).min(end(b)) - i64::from(start);
        u32::try_from(length)
            .ok()
            .filter(|&length| length > 0)
            .map(|length| (start, length))
    };
    let (x, width) = range((a.x, a.width), (b.x, b.width))?;
    let (y, height) = range((a.y, a.height), (b.y, b.height))?;
    Some(Window {
        x,
        y,
        width,
        height,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Channel;

    fn side(window: Window, channels: &[&str]) -> Side {
        let mut picture = Picture::new(9, 7).with_window(window);
        for name in channels {
            let values = (0..window.pixels()).map(|i| {
                let (x, y) = (
                    i as i32 % window.width as i32,
                    i as i32 / window.width as i32,
                );
                ((x + window.x) * 10 + y + window.y) as f32
            });
            picture = picture.with_channel(Channel::new(*name, Samples::F32(values.collect())));
        }
        Side {
            picture,
            encoding: Encoding::Linear,
        }
    }

    fn window(x: i32, y: i32, width: u32, height: u32) -> Window {
        Window {
            x,
            y,
            width,
            height,
        }
    }

    #[test]
    fn crops_are_laid_over_one_another_by_place() {
        let a = side(window(-1, 2, 5, 4), &["Z"]);
        let b = side(window(2, 1, 6, 3), &["Z"]);
        let pair = Pair::of(&a, &b, &Selection::default()).unwrap();
        assert_eq!(pair.window, window(2, 2, 2, 2));
        assert!(pair.has_other_windows());
        for pixel in 0..4 {
            let (x, y) = pair.place(pixel);
            let expected = f64::from(x * 10 + y);
            assert_eq!(pair.values(&pair.channels[0], pixel), [expected; 2]);
        }
        let far = side(window(4, 1, 2, 2), &["Z"]);
        let apart = Pair::of(&a, &far, &Selection::default()).err();
        assert_eq!(apart, Some(Incomparable::Apart));
    }

    #[test]
    fn channels_are_chosen_by_their_own_name_or_their_layers() {
        let whole = window(0, 0, 9, 7);
        let a = side(whole, &["R", "cost.nodes", "costly", "id"]);
        let b = side(whole, &["R", "Z", "cost.nodes", "costly"]);
        let chosen = |only: &[&str], ignored: &[&str]| {
            let list = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect();
            let selection = Selection {
                only: list(only),
                ignored: list(ignored),
            };
            let pair = Pair::of(&a, &b, &selection).ok()?;
            let names = pair.channels.iter().map(|c| c.name).collect::<Vec<_>>();
            Some((names.join(" "), pair.alone.concat().join(" ")))
        };
        let expect = |both: &str, alone: &str| Some((both.to_owned(), alone.to_owned()));
        assert_eq!(chosen(&[], &[]), expect("R cost.nodes costly", "id Z"));
        assert_eq!(chosen(&[], &["cost", "id"]), expect("R costly", "Z"));
        assert_eq!(chosen(&["cost", "Z"], &[]), expect("cost.nodes", "Z"));
        assert_eq!(chosen(&["none"], &[]), None);
    }
}
