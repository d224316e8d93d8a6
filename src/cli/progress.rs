//! How a render is watched: a bar on a terminal, a line every tenth when piped, nothing when quiet; and how it is ended by
//! a signal.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};

use anyhow::Context;
use bspray::render::Observer;
use indicatif::{ProgressBar, ProgressStyle};

use super::output;

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
pub(super) fn begin(total: u64, quiet: bool) -> RenderProgress {
    PHASE.store(RENDERING, Ordering::Relaxed);
    let style = if quiet {
        Style::Quiet
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
        total,
    }
}

enum Style {
    Quiet,
    Bar(ProgressBar),
    Lines,
}

/// A render being watched.
pub(super) struct RenderProgress {
    style: Style,
    done: AtomicU64,
    total: u64,
}

impl Observer for RenderProgress {
    fn samples_done(&self, samples: u64) {
        let before = self.done.fetch_add(samples, Ordering::Relaxed);
        match &self.style {
            Style::Quiet => {}
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
}

impl RenderProgress {
    /// Says that the render has ended and writing begins.
    pub(super) fn end(self) {
        PHASE.store(WRITING, Ordering::Relaxed);
        if let Style::Bar(bar) = self.style {
            bar.finish_and_clear();
        }
    }
}
