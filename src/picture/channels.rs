//! A picture as a list of named channels: what an EXR file holds.

use std::collections::BTreeMap;

/// Names of attributes that OpenEXR gives a meaning.
pub mod attribute {
    /// Text: the program that made the picture.
    pub const SOFTWARE: &str = "software";
    /// Text: anything a person should know.
    pub const COMMENTS: &str = "comments";
    /// Text: who owns the picture.
    pub const OWNER: &str = "owner";
    /// Matrix: world space to camera space. OpenEXR's camera space is left-handed, y up, z forward.
    pub const WORLD_TO_CAMERA: &str = "worldToCamera";
    /// Matrix: world space to normalised device coordinates, x and y in [-1, 1] over the display window.
    pub const WORLD_TO_NDC: &str = "worldToNDC";
}

/// A rectangle of pixels.
///
/// Coordinates start at the display window's top left corner, x to the right and y down. A crop has an offset, an overscan a
/// negative one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Window {
    /// Leftmost column.
    pub x: i32,
    /// Topmost row.
    pub y: i32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Window {
    /// Number of pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// The values of a channel, row by row from the top of the data window, in the type in which a file stores them.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Stored as 16-bit floats: 11 significant bits, rounded to nearest even.
    ///
    /// Finite values beyond 65,504 are stored as 65,504, since one infinite pixel would spoil every filter downstream;
    /// infinities and NaN stay what they are.
    F16(Vec<f32>),
    /// Stored as they are, bit for bit.
    F32(Vec<f32>),
    /// Stored as they are.
    U32(Vec<u32>),
}

impl Samples {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::F16(values) | Self::F32(values) => values.len(),
            Self::U32(values) => values.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A named channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// `R`, `Z`, `layer.channel`: a dot separates a layer from its channel.
    pub name: String,
    /// The values.
    pub samples: Samples,
}

impl Channel {
    /// A channel of that name.
    pub fn new(name: impl Into<String>, samples: Samples) -> Self {
        Self {
            name: name.into(),
            samples,
        }
    }
}

/// A value beside the pixels.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// Text. Characters beyond ASCII are written as JSON escapes (`\u00e9`), so that a JSON text stays one.
    Text(String),
    /// A 32-bit integer.
    Int(i32),
    /// A 32-bit float.
    Float(f32),
    /// A 4 by 4 matrix.
    ///
    /// OpenEXR multiplies row vectors and stores rows, glam multiplies column vectors and stores columns: the sixteen numbers
    /// are the same, `Mat4::to_cols_array`.
    M44([f32; 16]),
}

/// A picture of any number of channels, which share one data window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Width and height of the whole picture in pixels (OpenEXR's display window, its origin at 0, 0).
    pub display: (u32, u32),
    /// The part of it that the channels cover.
    pub window: Window,
    /// The channels. Files keep them sorted by name; two of one name are an error on writing.
    pub channels: Vec<Channel>,
    /// Values beside the pixels; [`attribute`] has the names that other programs know.
    pub attributes: BTreeMap<String, Attribute>,
}

impl Picture {
    /// A picture without channels whose data window is the whole of it.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            display: (width, height),
            window: Window {
                x: 0,
                y: 0,
                width,
                height,
            },
            ..Self::default()
        }
    }

    /// With another data window.
    #[must_use]
    pub fn with_window(mut self, window: Window) -> Self {
        self.window = window;
        self
    }

    /// With one more channel.
    #[must_use]
    pub fn with_channel(mut self, channel: Channel) -> Self {
        self.channels.push(channel);
        self
    }

    /// With an attribute, instead of the one of that name if there is one.
    #[must_use]
    pub fn with_attribute(mut self, name: impl Into<String>, value: Attribute) -> Self {
        self.attributes.insert(name.into(), value);
        self
    }

    /// The values of the channel of that name.
    pub fn channel(&self, name: &str) -> Option<&Samples> {
        self.channels
            .iter()
            .find(|channel| channel.name == name)
            .map(|channel| &channel.samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_found_by_name() {
        let picture = Picture::new(1, 2)
            .with_channel(Channel::new("a", Samples::U32(vec![1, 2])))
            .with_channel(Channel::new("a.b", Samples::F32(vec![3.0, 4.0])));
        assert_eq!(picture.channel("a.b").map(Samples::len), Some(2));
        assert_eq!(picture.channel("b"), None);
        assert_eq!(picture.window.pixels(), 2);
    }

    #[test]
    fn glam_stores_a_matrix_as_openexr_does() {
        // Imath's translation is in the last row: elements 12 to 14.
        let matrix = glam::Mat4::from_translation(glam::Vec3::new(1.0, 2.0, 3.0)).to_cols_array();
        assert_eq!(matrix[12..15], [1.0, 2.0, 3.0]);
    }
}
