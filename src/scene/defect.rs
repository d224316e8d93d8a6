//! What was wrong with a file, and what was done about it.

use std::fmt;
use std::path::PathBuf;

/// A message of an importer about something it read differently, or left out, on purpose.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The file.
    pub file: PathBuf,
    /// The element, with its line or index, such as `line 12` or `material 3 "glass"`.
    pub element: String,
    /// What about it, and what was done.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {}: {}",
            self.file.display(),
            self.element,
            self.text
        )
    }
}

/// Why elements of a file were dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DefectCause {
    /// A position that is NaN or infinite.
    NotFinite,
    /// A coordinate beyond [`crate::geometry::tolerance::COORDINATE_LIMIT`].
    TooLarge,
    /// A triangle without area: two corners at one place, or all three on a line.
    Degenerate,
    /// A face with fewer than three different corners.
    TooFewCorners,
}

impl fmt::Display for DefectCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "position is not a finite number",
            Self::TooLarge => "coordinate beyond 1e18",
            Self::Degenerate => "triangle without area",
            Self::TooFewCorners => "fewer than three different corners",
        })
    }
}

/// Elements that were broken and dropped: all those of one mesh with one cause.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Defect {
    /// The file.
    pub file: PathBuf,
    /// The mesh or object that they belonged to.
    pub element: String,
    /// What was wrong.
    pub cause: DefectCause,
    /// How many triangles (or faces) were dropped.
    pub count: u64,
    /// The first of them: its index in the mesh, as the file counts, from 0.
    pub first: u64,
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            element,
            cause,
            count,
            first,
        } = self;
        let plural = if *count == 1 { "" } else { "s" };
        write!(
            f,
            "{}: {element}: dropped {count} face{plural} (first: {first}): {cause}",
            file.display()
        )
    }
}
