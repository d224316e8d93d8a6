//! Several pictures of one scene: a turntable, which of its frames, and their files.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::bail;
use clap::Args;

use super::UsageError;
use super::files::{self, OutputKind};
use super::values;

/// Frames a second of film, if nothing else is said.
const DEFAULT_RATE: f32 = 24.0;

/// Looking around.
#[derive(Args, Debug)]
#[command(next_help_heading = "Looking around")]
pub(super) struct FrameArgs {
    /// Render N frames, for which the camera goes once around the middle of the scene; frame 1 is where it stands. Names of outputs need {frame} or, with zeros
    /// in front, {frame:4}
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=values::MOST_FRAMES))]
    turntable: Option<u32>,
    /// Which of the turntable's frames, such as 1-3,5,7-20:2 (from 7 to 20 every second) [default: all]
    #[arg(long, value_name = "LIST", requires = "turntable")]
    frames: Option<FrameList>,
    /// Frames a second of the film to which the picture at --animation-time belongs: for the motion vectors of .exr files [default: 24]
    #[arg(long, value_name = "RATE", value_parser = values::positive, requires = "animation_index", conflicts_with = "turntable")]
    fps: Option<f32>,
}

/// A picture to be made.
#[derive(Clone, Debug)]
pub(super) struct Shot {
    /// Its place on the turntable; `None` without one.
    pub(super) turn: Option<Turn>,
    /// Its files, and what they hold.
    pub(super) outputs: Vec<(PathBuf, OutputKind)>,
}

/// A place on a turntable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    /// From 1.
    frame: u32,
    /// Frames of the full circle.
    count: u32,
}

impl Turn {
    /// How far the camera has gone around, in radians, `later` frames after this one.
    pub(super) fn angle(self, later: f64) -> f64 {
        let gone = f64::from(self.frame - 1) + later;
        std::f64::consts::TAU * gone / f64::from(self.count)
    }

    /// Whether the camera moves at all.
    pub(super) fn moves(self) -> bool {
        self.count > 1
    }
}

/// As arguments.
impl fmt::Display for Turn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "--turntable {} --frames {}", self.count, self.frame)
    }
}

impl FrameArgs {
    /// Whether the camera goes around. The models keep their pose then.
    pub(super) fn is_turntable(&self) -> bool {
        self.turntable.is_some()
    }

    /// Seconds from one frame of an animation to the next.
    ///
    /// # Errors
    /// The frame rate is given, but no picture has layers.
    pub(super) fn step(&self, has_layers: bool) -> anyhow::Result<f64> {
        if self.fps.is_some() && !has_layers {
            let words = "--fps: only .exr files have motion vectors: add one with --output";
            bail!(UsageError(words.to_owned()));
        }
        Ok(1.0 / f64::from(self.fps.unwrap_or(DEFAULT_RATE)))
    }

    /// All pictures that are asked for, with their files, which can be written.
    pub(super) fn shots(
        &self,
        wanted: &[PathBuf],
        models: &[PathBuf],
        is_report: bool,
    ) -> anyhow::Result<Vec<Shot>> {
        let Some(count) = self.turntable else {
            if let Some(path) = wanted.iter().find(|p| has_frame(p)) {
                let words = "only the frames of a --turntable have numbers";
                bail!(UsageError(format!("{}: {words}", path.display())));
            }
            let outputs = files::outputs(wanted, models, is_report)?;
            return Ok(vec![Shot {
                turn: None,
                outputs,
            }]);
        };
        let all = FrameList((1..=count).collect());
        let numbers = &self.frames.as_ref().unwrap_or(&all).0;
        if let Some(beyond) = numbers.iter().find(|&&n| n > count) {
            let words = format!("--frames: there is no frame {beyond} of {count}");
            bail!(UsageError(words));
        }
        if is_report && numbers.len() > 1 {
            let words = "--pixel reports on one picture: choose one frame with --frames";
            bail!(UsageError(words.to_owned()));
        }
        let default = [files::default_output(models, ".{frame:4}.png")];
        let templates = if wanted.is_empty() && !is_report {
            &default
        } else {
            wanted
        };
        if let Some(path) = templates.iter().find(|p| !has_frame(p)) {
            let words = "one file for all frames: put {frame:4} into its name";
            bail!(UsageError(format!("{}: {words}", path.display())));
        }
        let shot = |&frame: &u32| {
            let paths: Vec<PathBuf> = templates.iter().map(|p| with_frame(p, frame)).collect();
            Ok(Shot {
                turn: Some(Turn { frame, count }),
                outputs: files::outputs(&paths, models, is_report)?,
            })
        };
        numbers.iter().map(shot).collect()
    }
}

/// Numbers of frames, in the order in which they were given, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
struct FrameList(Vec<u32>);

impl FromStr for FrameList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut found = Vec::new();
        let mut is_listed = vec![false; values::MOST_FRAMES as usize + 1];
        for part in text.split(',') {
            let wrong = || format!("{part:?}: want frames such as 3, 1-9 or 7-20:2, from 1");
            let (range, step) = part.split_once(':').unwrap_or((part, "1"));
            let (first, last) = range.split_once('-').unwrap_or((range, range));
            let number = |text: &str| {
                let number = text.parse::<u32>().ok();
                let number = number.filter(|n| (1..=values::MOST_FRAMES as u32).contains(n));
                number.ok_or_else(wrong)
            };
            let (first, last, step) = (number(first)?, number(last)?, number(step)?);
            if first > last || (part.contains(':') && !range.contains('-')) {
                return Err(wrong());
            }
            for frame in (first..=last).step_by(step as usize) {
                if !std::mem::replace(&mut is_listed[frame as usize], true) {
                    found.push(frame);
                }
            }
        }
        Ok(Self(found))
    }
}

/// The first `{frame}` or `{frame:DIGITS}` of a text: what is before it, its digits, what is behind it.
fn split_at_frame(text: &str) -> Option<(&str, usize, &str)> {
    text.match_indices("{frame").find_map(|(start, word)| {
        let (inside, behind) = text[start + word.len()..].split_once('}')?;
        let digits = match inside.strip_prefix(':') {
            Some(digits) => digits.parse().ok().filter(|d| (1..=9).contains(d))?,
            None if inside.is_empty() => 1,
            None => return None,
        };
        Some((&text[..start], digits, behind))
    })
}

fn has_frame(path: &Path) -> bool {
    path.to_str().is_some_and(|t| split_at_frame(t).is_some())
}

/// The path with the frame's number in all places for it.
fn with_frame(path: &Path, frame: u32) -> PathBuf {
    let Some(mut rest) = path.to_str() else {
        return path.to_owned();
    };
    let mut name = String::new();
    while let Some((before, digits, behind)) = split_at_frame(rest) {
        name += &format!("{before}{frame:0digits$}");
        rest = behind;
    }
    PathBuf::from(name + rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_have_ranges_and_steps_and_each_frame_once() {
        let list = |text: &str| text.parse::<FrameList>().map(|l| l.0);
        assert_eq!(list("1-3,5,7-12:2"), Ok(vec![1, 2, 3, 5, 7, 9, 11]));
        assert_eq!(list("5,4-6,5"), Ok(vec![5, 4, 6]));
        for wrong in [
            "",
            "0",
            "3-1",
            "1-",
            "-2",
            "a",
            "1-5:0",
            "5:2",
            "1,,2",
            "1-99999999999",
        ] {
            assert!(list(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn names_get_the_number_in_every_place_for_it() {
        let name = |template: &str| with_frame(Path::new(template), 7).display().to_string();
        assert_eq!(name("a{frame:4}.png"), "a0007.png");
        assert_eq!(name("{frame}/x-{frame:2}.exr"), "7/x-07.exr");
        for plain in [
            "a.png",
            "{frame:}.png",
            "{frame:x}.png",
            "{frames}.png",
            "{frame",
        ] {
            assert!(!has_frame(Path::new(plain)), "{plain}");
            assert_eq!(name(plain), plain);
        }
        assert_eq!(name("{frame:0}{frame}.png"), "{frame:0}7.png");
    }

    #[test]
    fn a_circle_begins_at_nothing_and_does_not_close() {
        let angle = |frame| Turn { frame, count: 8 }.angle(0.0);
        assert!(angle(1) == 0.0 && (angle(3) - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!(angle(8) < std::f64::consts::TAU);
        let before = Turn { frame: 1, count: 8 }.angle(-1.0);
        assert!((before + std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    }
}
