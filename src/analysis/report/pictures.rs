//! Pictures of a report.

use crate::picture::{Picture, Raster};

/// A picture.
#[derive(Clone, Debug)]
pub struct ShownPicture {
    /// Lower-case letters, digits and hyphens: the stem of its PNG file.
    pub name: String,
    /// What it shows, in a line.
    pub title: String,
    /// Its pixels.
    pub raster: Raster,
}

/// Two pictures of one size, one behind the other.
#[derive(Clone, Debug)]
pub struct PicturePair {
    /// Lower-case letters, digits and hyphens: the stem of its PNG files, `NAME-left.png` and `NAME-right.png`.
    pub name: String,
    /// What is compared, in a line.
    pub title: String,
    /// The picture left of the slider, and what it is.
    pub left: (String, Raster),
    /// The picture right of the slider, and what it is.
    pub right: (String, Raster),
}

/// Layers of measurements.
#[derive(Clone, Debug)]
pub struct Layers {
    /// Lower-case letters, digits and hyphens: the stem of its EXR file.
    pub name: String,
    /// What they hold, in a line.
    pub title: String,
    /// The layers.
    pub picture: Picture,
}
