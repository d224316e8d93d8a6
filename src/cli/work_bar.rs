//! How long work is watched: a bar with the time left on a terminal, lines with the time left when piped, nothing when quiet.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::output;

/// Steps of the bar.
const BAR: f64 = 10_000.0;

/// Work being watched.
pub(super) struct WorkBar {
    label: &'static str,
    style: Style,
    begun: Instant,
    state: Mutex<State>,
}

enum Style {
    Quiet,
    Bar(ProgressBar),
    Lines,
}

#[derive(Default)]
struct State {
    /// The share that is done.
    done: f64,
    /// What is done now.
    words: String,
}

impl WorkBar {
    /// Begins to watch.
    pub(super) fn begin(label: &'static str, quiet: bool) -> Self {
        let style = if quiet {
            Style::Quiet
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(BAR as u64).with_prefix(label);
            let template = "{prefix} {bar:30} {percent:>3} %  {elapsed} so far, {eta} left  {msg}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            Style::Bar(bar)
        } else {
            Style::Lines
        };
        Self {
            label,
            style,
            begun: Instant::now(),
            state: Mutex::new(State::default()),
        }
    }

    /// So much more of the work is done; lines come every tenth.
    pub(super) fn add(&self, share: f64) {
        let Ok(mut state) = self.state.lock() else {
            return;
        };
        let before = state.done;
        state.done += share;
        let tenth = |x: f64| (x * 10.0 + 1e-9).floor();
        let is_tenth = tenth(state.done) > tenth(before);
        self.show(state.done, "", is_tenth);
    }

    /// So much of the work is done, and this comes now; a line comes when that changes.
    pub(super) fn reach(&self, done: f64, words: String) {
        let Ok(mut state) = self.state.lock() else {
            return;
        };
        state.done = done;
        let is_new = state.words != words;
        self.show(done, &words, is_new);
        state.words = words;
    }

    fn show(&self, done: f64, words: &str, is_line: bool) {
        match &self.style {
            Style::Quiet => {}
            Style::Bar(bar) => {
                bar.set_position((done * BAR) as u64);
                bar.set_message(words.to_owned());
            }
            Style::Lines if is_line => {
                let left = self.begun.elapsed().as_secs_f64() * (1.0 / done - 1.0);
                let mut line = format!("{}:", self.label);
                if done > 0.0 {
                    let percent = (done * 100.0 + 1e-7).floor();
                    line += &format!(" {percent} %, about {:.0} s left", left.max(0.0));
                }
                if !words.is_empty() {
                    line += if done > 0.0 { ", " } else { " " };
                    line += words;
                }
                output::message(&line);
            }
            Style::Lines => {}
        }
    }

    /// The work is done.
    pub(super) fn end(self) {
        if let Style::Bar(bar) = self.style {
            bar.finish_and_clear();
        }
    }
}
