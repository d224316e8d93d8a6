//! How images are sampled.

/// What lies beyond an image's edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image again, every other copy mirrored.
    MirroredRepeat,
    /// The edge's pixel.
    ClampToEdge,
}

/// How values between pixel centres are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Bilinear.
    #[default]
    Linear,
    /// The nearest pixel.
    Nearest,
}

/// An image with a sampler.
#[derive(Clone, Copy, Debug, Default)]
pub struct Texture {
    /// Index of the scene's image.
    pub image: u32,
    /// Beyond the left and right edge.
    pub wrap_u: Wrap,
    /// Beyond the top and bottom edge.
    pub wrap_v: Wrap,
    /// Between pixel centres.
    pub filter: Filter,
}
