//! How a render is watched: a bar on a terminal, a line every tenth when piped, nothing when quiet; and how it is ended by
//! a signal.

use std::io::IsTerminal;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::time::Instant;

use anyhow::Context;
use bspray::render::{Film, Observer};
use indicatif::{ProgressBar, ProgressStyle};

use super::display::light;
use super::output;
use super::tev::Server;

/// What the program is doing, which decides what a signal does.
static PHASE: AtomicU8 = AtomicU8::new(BEFORE_PICTURE);
/// There is nothing yet that could be kept.
const BEFORE_PICTURE: u8 = 0;
/// The picture so far can be kept.
const RENDERING: u8 = 1;
/// The picture is being written, which must not be left half done.
const WRITING: u8 = 2;

static STOP: AtomicBool = AtomicBool::new(false);

/// Lets Ctrl-C, SIGTERM and SIGHUP end the render with the picture so far, and the program at once before there is one. A
/// second signal ends it at once in any case; a file that is being written is then left under its temporary name.
pub(super) fn handle_signals() -> anyhow::Result<()> {
    let handler = || {
        let asked_before = STOP.swap(true, Ordering::Relaxed);
        match PHASE.load(Ordering::Relaxed) {
            BEFORE_PICTURE => {
                output::message("interrupted before there was a picture");
                std::process::exit(4);
            }
            _ if asked_before => std::process::exit(4),
            _ => {}
        }
    };
    ctrlc::set_handler(handler).context("cannot handle signals")
}

/// Says that the render begins, and watches it.
pub(super) fn begin<'a>(
    total: u64,
    time_limit: Option<f32>,
    display: Option<(&'a Server, &'a str)>,
    quiet: bool,
) -> RenderProgress<'a> {
    PHASE.store(RENDERING, Ordering::Relaxed);
    let style = if quiet {
        Style::Quiet
    } else if time_limit.is_some() {
        // Shares of a number of samples that will not be reached say nothing.
        Style::Passes
    } else if std::io::stderr().is_terminal() {
        let bar = ProgressBar::new(total);
        let template = "rendering {bar:40} {percent:>3} %  {elapsed} so far, {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Style::Bar(bar)
    } else {
        Style::Lines
    };
    RenderProgress {
        style,
        done: AtomicU64::new(0),
        first: OnceLock::new(),
        total,
        begun: Instant::now(),
        time_limit: time_limit.map(f64::from),
        display,
    }
}

enum Style {
    Quiet,
    Bar(ProgressBar),
    Lines,
    Passes,
}

/// A render being watched.
pub(super) struct RenderProgress<'a> {
    style: Style,
    done: AtomicU64,
    /// When the first samples were done.
    first: OnceLock<Instant>,
    total: u64,
    begun: Instant,
    /// In seconds.
    time_limit: Option<f64>,
    /// What shows it, and the image's name there.
    display: Option<(&'a Server, &'a str)>,
}

impl Observer for RenderProgress<'_> {
    fn samples_done(&self, samples: u64) {
        self.first.get_or_init(Instant::now);
        let before = self.done.fetch_add(samples, Ordering::Relaxed);
        match &self.style {
            Style::Quiet | Style::Passes => {}
            Style::Bar(bar) => bar.inc(samples),
            Style::Lines => {
                let tenths = |n: u64| n * 10 / self.total.max(1);
                if tenths(before + samples) > tenths(before) {
                    output::message(&format!("rendering: {} %", tenths(before + samples) * 10));
                }
            }
        }
    }

    fn should_stop(&self) -> bool {
        STOP.load(Ordering::Relaxed)
    }

    fn pass_done(&self, film: &Film) {
        if let Some((server, name)) = self.display {
            server.offer(name, film.window, light(film, None));
        }
    }

    fn next_pass(&self, done: u32, planned: u32) -> u32 {
        // What is looked at, or may have to end soon, comes in doublings from the start.
        let is_watched = self.time_limit.is_some() || self.display.is_some();
        let planned = if is_watched {
            planned.min(done.max(1))
        } else {
            planned
        };
        let Some(limit) = self.time_limit else {
            return planned;
        };
        let elapsed = self.begun.elapsed().as_secs_f64();
        if done > 0 && matches!(self.style, Style::Passes) {
            output::message(&format!(
                "rendering: {done} samples a pixel, {elapsed:.1} s"
            ));
        }
        within_limit(done, planned, elapsed, limit)
    }
}

impl RenderProgress<'_> {
    /// Seconds from `begun` to the first samples of the first pixels; so far, if there are none.
    pub(super) fn first_pixel(&self, begun: Instant) -> f64 {
        let first = self.first.get().copied().unwrap_or_else(Instant::now);
        first.duration_since(begun).as_secs_f64()
    }

    /// Says that the render has ended and writing begins.
    pub(super) fn end(self) {
        PHASE.store(WRITING, Ordering::Relaxed);
        if let Style::Bar(bar) = self.style {
            bar.finish_and_clear();
        }
    }
}

/// As many of the planned samples as the time left is enough for, if they take as long as those before; 0 if it is not enough for one.
fn within_limit(done: u32, planned: u32, elapsed: f64, limit: f64) -> u32 {
    if done == 0 {
        return planned;
    }
    let affordable = (limit - elapsed) * f64::from(done) / elapsed.max(1e-9);
    // The cast saturates.
    planned.min(affordable as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_is_as_long_as_the_time_that_is_left() {
        assert_eq!(within_limit(0, 1, 0.0, 1e-9), 1);
        // A quarter of a second each.
        assert_eq!(within_limit(8, 8, 2.0, 10.0), 8);
        assert_eq!(within_limit(32, 32, 8.0, 10.1), 8);
        assert_eq!(within_limit(32, 32, 9.9, 10.0), 0);
        assert_eq!(within_limit(32, 32, 11.0, 10.0), 0);
    }
}
