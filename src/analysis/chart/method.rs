//! The ways of tracing rays that are points of a chart, each with a name that `chart` reads again.

use crate::accel::extents::{ExtentChoice, ExtentSet, ExtentTest};
use crate::accel::{AcceleratorKind, BspQuality, BuildOptions};
use crate::geometry::TriangleTest;

/// A structure and what it leaves to choose: for `bsp` the quality of its build, for `extents` the extents, for all others the triangle test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartMethod {
    /// The structure.
    pub kind: AcceleratorKind,
    choice: Choice,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Choice {
    Quality(BspQuality),
    Extents(ExtentChoice),
    Test(TriangleTest),
}

/// Most triangles of a scene that `linear` is asked about unbidden.
const MOST_FOR_LINEAR: u64 = 3_000;

/// Most triangles of a scene that `bsp-polygon` is built for unbidden.
const MOST_FOR_POLYGONS: u64 = 20_000;

impl ChartMethod {
    fn new(kind: AcceleratorKind, choice: Choice) -> Self {
        Self { kind, choice }
    }

    /// All methods of a kind, the usual one first.
    fn of_kind(kind: AcceleratorKind) -> Vec<Self> {
        let choices: Vec<Choice> = match kind {
            AcceleratorKind::Bsp => {
                let all = [BspQuality::Default, BspQuality::Fast, BspQuality::Best];
                all.map(Choice::Quality).to_vec()
            }
            AcceleratorKind::Extents => {
                let only = |test| ExtentChoice::Fixed(ExtentSet::NONE.with(test));
                [
                    ExtentChoice::Auto,
                    only(ExtentTest::SphereWorld),
                    only(ExtentTest::BoxWorld),
                    ExtentChoice::Fixed(ExtentSet::NONE),
                ]
                .map(Choice::Extents)
                .to_vec()
            }
            _ => TriangleTest::ALL.map(Choice::Test).to_vec(),
        };
        choices.into_iter().map(|c| Self::new(kind, c)).collect()
    }

    /// All of them, the default structure first.
    pub fn all() -> Vec<Self> {
        let kinds = AcceleratorKind::ALL.into_iter();
        kinds.flat_map(Self::of_kind).collect()
    }

    /// Those that end soon for a scene of so many triangles and instances, and differ: with one object, extents have nothing to choose.
    pub fn suited(triangles: u64, instances: usize) -> Vec<Self> {
        let is_suited = |m: &Self| match m.kind {
            AcceleratorKind::Linear => triangles <= MOST_FOR_LINEAR,
            AcceleratorKind::BspPolygon => triangles <= MOST_FOR_POLYGONS,
            AcceleratorKind::Extents => {
                instances > 1 || m.choice == Choice::Extents(ExtentChoice::Auto)
            }
            _ => true,
        };
        Self::all().into_iter().filter(is_suited).collect()
    }

    /// Those of some methods that pictures are made with: the usual choices, all of `bsp`, and the fast test of `bvh2`, which shows another picture.
    pub fn for_pictures(methods: &[Self]) -> Vec<Self> {
        let is_for_pictures = |m: &&Self| match m.kind {
            AcceleratorKind::Linear => false,
            AcceleratorKind::Bsp => true,
            AcceleratorKind::Bvh2 => m.is_exact() || m.choice == Choice::Test(TriangleTest::Fast),
            _ => m.is_usual(),
        };
        methods.iter().filter(is_for_pictures).copied().collect()
    }

    fn is_usual(&self) -> bool {
        *self == Self::of_kind(self.kind)[0]
    }

    /// The name: the kind alone for its usual choice, else both with a colon between.
    pub fn name(&self) -> String {
        if self.is_usual() {
            return self.kind.name().to_owned();
        }
        format!("{}:{}", self.kind, self.choice())
    }

    fn choice(&self) -> String {
        match self.choice {
            Choice::Quality(quality) => quality.name().to_owned(),
            Choice::Extents(extents) => extents.to_string(),
            Choice::Test(test) => test.name().to_owned(),
        }
    }

    /// What it is built with.
    pub fn options(&self, base: &BuildOptions) -> BuildOptions {
        let mut options = *base;
        match self.choice {
            Choice::Quality(quality) => options.quality = quality,
            Choice::Extents(extents) => options.extents = extents,
            Choice::Test(test) => options.test = test,
        }
        options
    }

    /// The arguments of `render` that choose it.
    pub fn arguments(&self) -> String {
        let kind = self.kind;
        match self.choice {
            Choice::Quality(quality) => format!("--accel {kind} --bsp-quality {quality}"),
            Choice::Extents(extents) => format!("--accel {kind} --extents {extents}"),
            Choice::Test(test) => format!("--accel {kind} --intersect {test}"),
        }
    }

    /// Whether it owes the exact answer, bit for bit.
    pub fn is_exact(&self) -> bool {
        !matches!(self.choice, Choice::Test(test) if test != TriangleTest::Exact)
    }
}

impl std::fmt::Display for ChartMethod {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

impl std::str::FromStr for ChartMethod {
    type Err = String;

    /// Reads a [name](ChartMethod::name); the usual choice may be named too.
    fn from_str(text: &str) -> Result<Self, String> {
        let all = Self::all();
        let is_named = |m: &&Self| m.name() == text || format!("{}:{}", m.kind, m.choice()) == text;
        let found = all.iter().find(is_named);
        found.copied().ok_or_else(|| {
            let names: Vec<_> = all.iter().map(Self::name).collect();
            format!("no method {text:?}; there are {}", names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_read_back() {
        let all = ChartMethod::all();
        for (index, method) in all.iter().enumerate() {
            assert_eq!(method.name().parse(), Ok(*method));
            assert!(all[..index].iter().all(|m| m.name() != method.name()));
            assert!(
                method
                    .kind
                    .takes(method.options(&BuildOptions::default()).test)
            );
        }
        assert_eq!(all[0].name(), "bsp");
        for (long, short) in [("bsp:default", "bsp"), ("bvh2:exact", "bvh2")] {
            assert_eq!(long.parse::<ChartMethod>().unwrap().name(), short);
        }
        let fast: ChartMethod = "bvh2:fast".parse().unwrap();
        assert!(!fast.is_exact());
        assert_eq!(fast.arguments(), "--accel bvh2 --intersect fast");
        for wrong in ["embree", "bsp:exact", "bvh2:best", "bsp:", ":"] {
            assert!(wrong.parse::<ChartMethod>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn small_scenes_have_all_methods_and_large_ones_those_that_end() {
        assert_eq!(ChartMethod::suited(20, 2).len(), ChartMethod::all().len());
        let names: Vec<_> = ChartMethod::suited(1_000_000, 1)
            .iter()
            .map(ChartMethod::name)
            .collect();
        assert!(names.contains(&"cwbvh:fast".to_owned()));
        assert!(names.contains(&"extents".to_owned()));
        assert!(!names.iter().any(|n| n.starts_with("linear")
            || n.starts_with("bsp-polygon")
            || n.starts_with("extents:")));
    }
}
