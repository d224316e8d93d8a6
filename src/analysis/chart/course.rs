//! How far a chart is, for those who watch.

use std::cell::Cell;

use super::ChartOptions;
use super::method::ChartMethod;
use super::pictures::REFERENCE_SAMPLES;

/// Work on the rays of a method, in samples a pixel of a picture: what rays and pictures take beside one another.
const RAY_WORK: f64 = 4.0;

/// What a chart is at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doing {
    /// Asks the reference, and judges it.
    Reference,
    /// Builds a method's structure.
    Build(ChartMethod),
    /// Times rays.
    Trace,
    /// Judges answers.
    Judge,
    /// Renders the reference with so many samples a pixel.
    Converge(u32),
    /// Renders a picture of so many samples a pixel.
    Picture(ChartMethod, u32),
}

impl std::fmt::Display for Doing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Reference => write!(f, "asking the reference, and judging it"),
            Self::Build(method) => write!(f, "building {method}"),
            Self::Trace => write!(f, "timing rays"),
            Self::Judge => write!(f, "judging answers"),
            Self::Converge(samples) => {
                write!(f, "rendering the reference, {samples} samples a pixel")
            }
            Self::Picture(method, samples) => {
                write!(f, "rendering with {method}, {samples} samples a pixel")
            }
        }
    }
}

/// The share of the work that is done, told with what comes next.
pub(super) struct Course<'a> {
    watch: &'a dyn Fn(Doing, f64),
    now: Cell<Doing>,
    done: Cell<f64>,
    /// One method's part of each of its three steps: build, timing, judging.
    method: f64,
    /// A sample of each pixel.
    sample: f64,
}

impl<'a> Course<'a> {
    pub(super) fn new(options: &ChartOptions, watch: &'a dyn Fn(Doing, f64)) -> Self {
        let methods = options.methods.len() as f64;
        let most = options.samples.iter().max().map_or(0, |&most| most);
        let of_pictures = options.samples.iter().sum::<u32>() as f64
            * (options.picture_methods.len() + options.budgets.len()) as f64
            * options.repetitions.max(1) as f64;
        // The reference counts as one more method.
        let samples = f64::from(most * REFERENCE_SAMPLES) + of_pictures;
        let whole = (RAY_WORK * (methods + 1.0) + samples).max(1.0);
        Self {
            watch,
            now: Cell::new(Doing::Reference),
            done: Cell::new(0.0),
            method: RAY_WORK / 3.0 / whole,
            sample: 1.0 / whole,
        }
    }

    /// Says what comes now.
    pub(super) fn begin(&self, doing: Doing) {
        self.now.set(doing);
        (self.watch)(doing, self.done.get());
    }

    /// So many thirds of a method's work on rays are done.
    pub(super) fn methods(&self, thirds: f64) {
        self.add(self.method * thirds);
    }

    /// So many samples of each pixel are done.
    pub(super) fn samples(&self, count: u32) {
        self.add(self.sample * f64::from(count));
    }

    fn add(&self, share: f64) {
        self.done.set(self.done.get() + share);
        (self.watch)(self.now.get(), self.done.get());
    }
}
