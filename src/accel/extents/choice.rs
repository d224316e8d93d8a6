//! Which extents an object is tested with.

use std::fmt;
use std::str::FromStr;

/// A test of an object's extent, in the order in which the lecture applies them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ExtentTest {
    /// The pixel of an eye ray against the object's screen extent.
    Screen,
    /// The ray against a sphere in world space.
    SphereWorld,
    /// The ray against an axis-aligned box in world space.
    BoxWorld,
    /// The inverse-transformed ray against a sphere in object space (the lecture's generic coordinates).
    SphereObject,
    /// The inverse-transformed ray against an axis-aligned box in object space.
    BoxObject,
}

impl ExtentTest {
    /// How many there are.
    pub const COUNT: usize = 5;

    /// All of them, in the order in which they are applied.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Screen,
        Self::SphereWorld,
        Self::BoxWorld,
        Self::SphereObject,
        Self::BoxObject,
    ];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Screen => "screen",
            Self::SphereWorld => "sphere-world",
            Self::BoxWorld => "box-world",
            Self::SphereObject => "sphere-object",
            Self::BoxObject => "box-object",
        }
    }

    /// Its place in the order.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Whether it tests the inverse-transformed ray.
    pub const fn is_in_object_space(self) -> bool {
        matches!(self, Self::SphereObject | Self::BoxObject)
    }
}

/// A set of tests.
///
/// ```
/// use bspray::accel::extents::{ExtentSet, ExtentTest};
/// let set: ExtentSet = "box-world,screen".parse()?;
/// assert!(set.has(ExtentTest::Screen) && !set.has(ExtentTest::SphereWorld));
/// assert_eq!(set.to_string(), "screen,box-world");
/// assert_eq!(ExtentSet::NONE.to_string(), "none");
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ExtentSet(u8);

impl ExtentSet {
    /// No test: every ray gets the full test.
    pub const NONE: Self = Self(0);

    /// All sets, the empty one first.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..1 << ExtentTest::COUNT).map(Self)
    }

    /// The set with one more test.
    #[must_use]
    pub const fn with(self, test: ExtentTest) -> Self {
        Self(self.0 | 1 << test.index())
    }

    /// The set less a test.
    #[must_use]
    #[inline]
    pub const fn without(self, test: ExtentTest) -> Self {
        Self(self.0 & !(1 << test.index()))
    }

    /// Whether the test is in the set.
    #[inline]
    pub const fn has(self, test: ExtentTest) -> bool {
        self.0 >> test.index() & 1 == 1
    }

    /// Whether there is no test.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The tests, in the order in which they are applied.
    pub fn tests(self) -> impl Iterator<Item = ExtentTest> {
        ExtentTest::ALL.into_iter().filter(move |&t| self.has(t))
    }

    /// How many tests.
    pub const fn len(self) -> u32 {
        self.0.count_ones()
    }

    /// The number of the set among [`ExtentSet::all`].
    pub(super) const fn number(self) -> usize {
        self.0 as usize
    }
}

impl FromIterator<ExtentTest> for ExtentSet {
    fn from_iter<I: IntoIterator<Item = ExtentTest>>(tests: I) -> Self {
        tests.into_iter().fold(Self::NONE, Self::with)
    }
}

impl fmt::Display for ExtentSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("none");
        }
        let names: Vec<_> = self.tests().map(ExtentTest::name).collect();
        f.write_str(&names.join(","))
    }
}

impl FromStr for ExtentSet {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut set = Self::NONE;
        for name in text.split(',') {
            let test = ExtentTest::ALL.into_iter().find(|t| t.name() == name);
            let test = test.ok_or_else(|| {
                let names = ExtentTest::ALL.map(ExtentTest::name).join(", ");
                format!(
                    "{name:?} is no extent: want none, auto, or some of {names} with commas between"
                )
            })?;
            if set.has(test) {
                return Err(format!("names {name} twice"));
            }
            set = set.with(test);
        }
        Ok(set)
    }
}

/// How the tests of each object are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ExtentChoice {
    /// For each object those that cost least, by counted probe rays and a table of costs.
    #[default]
    Auto,
    /// The same for all objects.
    Fixed(ExtentSet),
}

impl fmt::Display for ExtentChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Fixed(set) => set.fmt(f),
        }
    }
}

impl FromStr for ExtentChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            "none" => Ok(Self::Fixed(ExtentSet::NONE)),
            list => list.parse().map(Self::Fixed),
        }
    }
}

/// Which sphere an object gets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ExtentSphere {
    /// The smallest one.
    #[default]
    Smallest,
    /// The lecture's, about the centroid of all vertices.
    Centroid,
}

impl ExtentSphere {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Smallest, Self::Centroid];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Smallest => "smallest",
            Self::Centroid => "centroid",
        }
    }
}

impl fmt::Display for ExtentSphere {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What finds the hits within an object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MeshAccelerator {
    /// Every triangle, one after the other: the lecture's expensive full test.
    Linear,
    /// The wide BSP.
    #[default]
    Bsp,
    /// obvhs's binary BVH.
    Bvh2,
    /// obvhs's compressed BVH.
    Cwbvh,
}

impl MeshAccelerator {
    /// All of them, the default first.
    pub const ALL: [Self; 4] = [Self::Bsp, Self::Bvh2, Self::Cwbvh, Self::Linear];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Bsp => "bsp",
            Self::Bvh2 => "bvh2",
            Self::Cwbvh => "cwbvh",
        }
    }
}

impl fmt::Display for MeshAccelerator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_reads_back_what_it_writes() {
        for set in ExtentSet::all() {
            let choice = ExtentChoice::Fixed(set);
            assert_eq!(choice.to_string().parse(), Ok(choice));
            assert_eq!(set.tests().collect::<ExtentSet>(), set);
            assert_eq!(set.tests().count() as u32, set.len());
        }
        assert_eq!("auto".parse(), Ok(ExtentChoice::Auto));
        assert_eq!(ExtentSet::all().count(), 32);
    }

    #[test]
    fn unknown_and_repeated_names_are_refused_with_the_cause() {
        let error = |text: &str| text.parse::<ExtentChoice>().unwrap_err();
        assert!(error("box").contains("\"box\" is no extent"));
        assert!(error("screen,").contains("\"\" is no extent"));
        assert!(error("screen,screen").contains("twice"));
        assert!(error("screen,auto").contains("\"auto\" is no extent"));
    }
}
