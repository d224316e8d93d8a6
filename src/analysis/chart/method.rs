//! The ways of tracing rays that are points of a chart, each with a name that `chart` reads again.

use crate::accel::extents::{ExtentChoice, ExtentSet, ExtentTest};
use crate::accel::{
    Accelerator, AcceleratorKind, BspQuality, BuildOptions, Embree, EmbreeError, EmbreeMode,
};
use crate::analysis::work::Work;
use crate::geometry::TriangleTest;
use crate::scene::Scene;

/// A structure as it usually is, or with one thing chosen otherwise: the triangle test, for `bsp` the quality of its build, for `extents` the extents. Or Embree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartMethod(Way);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Ours(AcceleratorKind, Choice),
    Embree(EmbreeMode),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Choice {
    Usual,
    Quality(BspQuality),
    Extents(ExtentChoice),
    Test(TriangleTest),
}

/// The tests beside the exact one.
const OTHER_TESTS: [Choice; 3] = [
    Choice::Test(TriangleTest::Double),
    Choice::Test(TriangleTest::Watertight),
    Choice::Test(TriangleTest::Fast),
];

impl ChartMethod {
    /// Structures that are built for each kind of ours, on rays: its triangle tests.
    pub const BUILDS: usize = 1 + OTHER_TESTS.len();

    const fn new(kind: AcceleratorKind, choice: Choice) -> Self {
        Self(Way::Ours(kind, choice))
    }

    /// All methods of a kind, the usual one first.
    fn of_kind(kind: AcceleratorKind) -> Vec<Self> {
        let own = match kind {
            AcceleratorKind::Bsp => [BspQuality::Fast, BspQuality::Best]
                .map(Choice::Quality)
                .to_vec(),
            AcceleratorKind::Extents => {
                let only = |test| ExtentSet::NONE.with(test);
                let sets = [
                    only(ExtentTest::SphereWorld),
                    only(ExtentTest::BoxWorld),
                    ExtentSet::NONE,
                ];
                sets.map(|set| Choice::Extents(ExtentChoice::Fixed(set)))
                    .to_vec()
            }
            _ => Vec::new(),
        };
        let choices = [Choice::Usual].into_iter().chain(own).chain(OTHER_TESTS);
        choices.map(|choice| Self::new(kind, choice)).collect()
    }

    /// All of them, the default structure first. Those that [need Embree](Self::needs_embree) can be had only where it is loaded.
    pub fn all() -> Vec<Self> {
        let kinds = AcceleratorKind::ALL.into_iter().flat_map(Self::of_kind);
        kinds
            .chain(EmbreeMode::ALL.map(|mode| Self(Way::Embree(mode))))
            .collect()
    }

    /// Those that end soon for so much work and differ (with one object, extents have nothing to choose), and for each structure of the others why not.
    pub fn suited(work: &Work, has_embree: bool) -> (Vec<Self>, Vec<String>) {
        let too_much = AcceleratorKind::ALL.map(|kind| (kind, work.too_much_for(kind)));
        let left_out = too_much.iter().filter_map(|(kind, reason)| {
            let reason = reason.as_ref()?;
            Some(format!(
                "{kind} is left out: {reason}; --method can name it"
            ))
        });
        let is_suited = |method: &Self| match method.0 {
            Way::Embree(_) => has_embree,
            Way::Ours(_, Choice::Extents(_)) if work.objects() <= 1 => false,
            Way::Ours(kind, _) => too_much.iter().any(|(k, why)| *k == kind && why.is_none()),
        };
        let suited = Self::all().into_iter().filter(is_suited).collect();
        (suited, left_out.collect())
    }

    /// Those of some methods that pictures are made with: the usual choices, all builds of `bsp`, and its fast test, which shows another picture.
    pub fn for_pictures(methods: &[Self]) -> Vec<Self> {
        let is_for_pictures = |method: &&Self| match method.0 {
            Way::Embree(_) => true,
            Way::Ours(AcceleratorKind::Linear, _) => false,
            Way::Ours(_, choice) => {
                matches!(choice, Choice::Usual | Choice::Quality(_))
                    || *method == &Self::new(AcceleratorKind::Bsp, Choice::Test(TriangleTest::Fast))
            }
        };
        methods.iter().filter(is_for_pictures).copied().collect()
    }

    /// The name: the structure alone for its usual choice, else both with a colon between.
    pub fn name(&self) -> String {
        let structure = self.structure();
        match self.0 {
            Way::Embree(_) | Way::Ours(_, Choice::Usual) => structure.to_owned(),
            Way::Ours(_, Choice::Quality(quality)) => format!("{structure}:{quality}-build"),
            Way::Ours(_, Choice::Extents(extents)) => format!("{structure}:{extents}"),
            Way::Ours(_, Choice::Test(test)) => format!("{structure}:{test}"),
        }
    }

    /// The name of the structure.
    pub const fn structure(&self) -> &'static str {
        match self.0 {
            Way::Ours(kind, _) => kind.name(),
            Way::Embree(mode) => mode.name(),
        }
    }

    /// Embree's mode, of a method that can be had only where it is loaded.
    pub const fn needs_embree(&self) -> Option<EmbreeMode> {
        match self.0 {
            Way::Ours(..) => None,
            Way::Embree(mode) => Some(mode),
        }
    }

    /// What it is built with, if it is one of ours.
    fn options(choice: Choice, base: &BuildOptions) -> BuildOptions {
        let mut options = *base;
        match choice {
            Choice::Usual => {}
            Choice::Quality(quality) => options.quality = quality,
            Choice::Extents(extents) => options.extents = extents,
            Choice::Test(test) => options.test = test,
        }
        options
    }

    /// Builds it over all instances of the scene.
    ///
    /// # Errors
    /// What a foreign library reports.
    ///
    /// # Panics
    /// If it needs Embree and that is not loaded.
    pub fn build(
        &self,
        scene: &Scene,
        base: &BuildOptions,
        embree: Option<&Embree>,
    ) -> Result<Box<dyn Accelerator>, EmbreeError> {
        match self.0 {
            Way::Ours(kind, choice) => Ok(kind.build_with(scene, &Self::options(choice, base))),
            Way::Embree(mode) => {
                let embree = embree.expect("what needs Embree is not asked without it");
                Ok(Box::new(embree.build(scene, mode)?))
            }
        }
    }

    /// The arguments of `render` that choose it; `None` of what `render` has not.
    pub fn arguments(&self, base: &BuildOptions) -> Option<String> {
        let Way::Ours(kind, choice) = self.0 else {
            return None;
        };
        let quality = Self::options(choice, base).quality;
        let mut words = format!("--accel {kind}");
        if kind == AcceleratorKind::Bsp {
            words += &format!(" --bsp-quality {quality}");
        }
        match choice {
            Choice::Usual | Choice::Quality(_) => {}
            Choice::Extents(extents) => words += &format!(" --extents {extents}"),
            Choice::Test(test) => words += &format!(" --intersect {test}"),
        }
        Some(words)
    }

    /// Whether it owes the exact answer, bit for bit.
    pub const fn is_exact(&self) -> bool {
        !matches!(self.0, Way::Embree(_) | Way::Ours(_, Choice::Test(_)))
    }
}

impl std::fmt::Display for ChartMethod {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

impl std::str::FromStr for ChartMethod {
    type Err = String;

    /// Reads a [name](ChartMethod::name); `:exact` may stand behind those of usual choices.
    fn from_str(text: &str) -> Result<Self, String> {
        let all = Self::all();
        let usual = text.strip_suffix(":exact");
        let is_named = |m: &&Self| {
            let name = m.name();
            name == text || (Some(&*name) == usual && m.is_exact() && m.structure() == name)
        };
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
        }
        assert_eq!(all[0].name(), "bsp");
        for (long, short) in [("bsp:exact", "bsp"), ("bvh2:exact", "bvh2")] {
            assert_eq!(long.parse::<ChartMethod>().unwrap().name(), short);
        }
        let base = BuildOptions::default();
        let arguments = |name: &str| name.parse::<ChartMethod>().unwrap().arguments(&base);
        let words = |words: &str| Some(words.to_owned());
        assert_eq!(
            arguments("bvh2:fast"),
            words("--accel bvh2 --intersect fast")
        );
        assert_eq!(
            arguments("bsp:best-build"),
            words("--accel bsp --bsp-quality best")
        );
        assert_eq!(
            arguments("bsp:fast"),
            words("--accel bsp --bsp-quality default --intersect fast")
        );
        assert_eq!(arguments("embree-robust"), None);
        for wrong in [
            "embryo",
            "embree:exact",
            "bvh2:best-build",
            "bsp:",
            ":",
            "bsp:fast:exact",
        ] {
            assert!(wrong.parse::<ChartMethod>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn small_scenes_have_all_methods_and_large_ones_those_that_end() {
        let scene = crate::import::load(&["models/lecture-objects.gltf".into()]).unwrap();
        let (all, left_out) = ChartMethod::suited(&Work::of(&scene, 10, 4), true);
        assert_eq!((all.len(), left_out.len()), (ChartMethod::all().len(), 0));
        let (few, left_out) = ChartMethod::suited(&Work::of(&scene, 1_000_000_000, 4000), false);
        assert_eq!(left_out.len(), 3, "{left_out:?}");
        let names: Vec<_> = few.iter().map(ChartMethod::name).collect();
        assert!(names.contains(&"cwbvh:fast".to_owned()));
        for left_out in ["linear", "bsp-polygon", "extents", "embree"] {
            assert!(!names.iter().any(|n| n.starts_with(left_out)), "{names:?}");
        }
    }
}
