//! Images and the way they are sampled.

/// The pixels of an image, row by row from the top, as RGBA.
///
/// They are the file's numbers: whether they are sRGB-encoded or linear is the affair of the slot that uses them.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// 8 bits a channel, 255 is 1.
    Rgba8(Vec<[u8; 4]>),
    /// 16 bits a channel, 65,535 is 1.
    Rgba16(Vec<[u16; 4]>),
    /// Floating point, always linear.
    RgbaF32(Vec<[f32; 4]>),
}

/// What an image's numbers mean: the affair of the slot of a material that uses it. Floating-point images are linear in any slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// sRGB-encoded colours; alpha is linear.
    Srgb,
    /// Plain numbers.
    Linear,
}

/// An image of the scene.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Name or path in the file.
    pub name: String,
    /// Width in pixels; 0 when the image could not be read.
    pub width: u32,
    /// Height in pixels; 0 when the image could not be read.
    pub height: u32,
    /// Pixels, or `None` when nothing that is rendered uses them or they could not be read; a note says which.
    pub pixels: Option<Pixels>,
}

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
