//! The program as its users run it: exit codes, words on both streams, files, pipes and signals.

mod camera;
mod chart;
mod compare;
mod denoise;
mod detail;
mod diff;
mod environments;
mod errors;
mod extents;
mod frames;
mod lens;
mod mattes;
mod models;
mod motion;
mod needs;
mod outputs;
mod overlay;
mod pipes;
mod reports;
mod run;
mod shell;
#[cfg(unix)]
mod signals;
mod stress;
mod tev;
mod views;
