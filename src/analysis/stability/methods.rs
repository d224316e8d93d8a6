//! The methods whose answers are looked at: all accelerators, and what they are better than. The one registry of `stress`.

use super::naive::{EpsilonBsp, Every};
use crate::accel::{
    Accelerator, AcceleratorKind, AsShipped, BuildOptions, Embree, EmbreeMode, Hit, ShippedTree,
    world_triangles,
};
use crate::analysis::accuracy::alone::Alone;
use crate::geometry::{Ray, TriangleTest};
use crate::render::Answer;
use crate::scene::Scene;

/// A structure with a triangle test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// One of the crate's own; owes the exact answer.
    Structure(AcceleratorKind),
    /// Brute force with the test in double precision: `--intersect double`.
    Double,
    /// Brute force with the test of Woop, Benthin and Wald as published: `--intersect watertight`.
    Woop,
    /// Brute force with the test of Moller and Trumbore without an epsilon: `--intersect fast`.
    Fast,
    /// Brute force with the test of Moller and Trumbore in `f32`.
    MollerTrumbore,
    /// A BSP of cut triangles with a fixed epsilon, in `f32`.
    EpsilonBsp,
    /// Brute force with obvhs's own triangle test.
    ObvhsTriangle,
    /// obvhs's binary tree as it comes.
    ObvhsBvh2,
    /// obvhs's wide tree as it comes.
    ObvhsCwbvh,
    /// obvhs's binary tree with its own boxes, and our triangle test.
    ObvhsBvh2Boxes,
    /// obvhs's wide tree with its own boxes, and our triangle test.
    ObvhsCwbvhBoxes,
    /// Embree, where it is loaded.
    Embree(EmbreeMode),
}

/// A method, ready to answer.
pub(super) enum Built {
    Structure(Box<dyn Accelerator>),
    /// With a test that is not exact.
    Tested(Box<dyn Accelerator>),
    Every(Every),
    EpsilonBsp(EpsilonBsp),
    Shipped(AsShipped),
    Alone(Alone),
}

impl Method {
    /// The method that must be right: [`AcceleratorKind::default`].
    pub const DEFAULT: Self = Self::Structure(AcceleratorKind::Bsp);

    /// All of them, the default first. Those that [need Embree](Self::needs_embree) are not asked without it.
    pub fn all() -> Vec<Self> {
        let structures = AcceleratorKind::ALL.into_iter().map(Self::Structure);
        structures
            .chain([
                Self::Double,
                Self::Woop,
                Self::Fast,
                Self::MollerTrumbore,
                Self::EpsilonBsp,
                Self::ObvhsTriangle,
                Self::ObvhsBvh2,
                Self::ObvhsCwbvh,
                Self::ObvhsBvh2Boxes,
                Self::ObvhsCwbvhBoxes,
            ])
            .chain(EmbreeMode::ALL.map(Self::Embree))
            .collect()
    }

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Structure(kind) => kind.name(),
            Self::Double => "double",
            Self::Woop => "woop",
            Self::Fast => "fast",
            Self::MollerTrumbore => "moller-trumbore",
            Self::EpsilonBsp => "epsilon-bsp",
            Self::ObvhsTriangle => "obvhs-triangle",
            Self::ObvhsBvh2 => "obvhs-bvh2",
            Self::ObvhsCwbvh => "obvhs-cwbvh",
            Self::ObvhsBvh2Boxes => "obvhs-bvh2-boxes",
            Self::ObvhsCwbvhBoxes => "obvhs-cwbvh-boxes",
            Self::Embree(mode) => mode.name(),
        }
    }

    /// One line about it.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Structure(kind) => kind.description(),
            Self::Double => "brute force, edge functions in f64: --intersect double",
            Self::Woop => {
                "brute force, Woop's watertight test as published: --intersect watertight"
            }
            Self::Fast => {
                "brute force, Moller and Trumbore's test in f32 without an epsilon: --intersect fast"
            }
            Self::MollerTrumbore => "brute force, Moller and Trumbore's test in f32, epsilon 1e-6",
            Self::EpsilonBsp => "BSP of cut triangles in f32, epsilon 1e-5",
            Self::ObvhsTriangle => "brute force, obvhs's own triangle test",
            Self::ObvhsBvh2 => "obvhs's binary tree as it comes: its boxes, its triangle test",
            Self::ObvhsCwbvh => "obvhs's wide tree as it comes: its boxes, its triangle test",
            Self::ObvhsBvh2Boxes => "obvhs's binary tree, its boxes, the exact triangle test",
            Self::ObvhsCwbvhBoxes => "obvhs's wide tree, its boxes, the exact triangle test",
            Self::Embree(mode) => mode.description(),
        }
    }

    /// Whether it owes the exact answer, bit for bit. Others owe a plausible depth of the nearest triangle.
    pub const fn is_exact(self) -> bool {
        matches!(self, Self::Structure(_))
    }

    /// Embree's mode, of a method that is Embree's.
    pub const fn embree_mode(self) -> Option<EmbreeMode> {
        match self {
            Self::Embree(mode) => Some(mode),
            _ => None,
        }
    }

    /// Whether it is asked only where Embree is loaded.
    pub const fn needs_embree(self) -> bool {
        self.embree_mode().is_some()
    }

    /// Whether it may not end, or end the process.
    pub const fn may_run_away(self) -> bool {
        match self {
            Self::Structure(kind) => matches!(kind, AcceleratorKind::BspPolygon),
            Self::Double | Self::Woop | Self::Fast | Self::MollerTrumbore | Self::ObvhsTriangle => {
                false
            }
            _ => true,
        }
    }

    /// The method that has the same triangle test and no structure, to tell whose error an error is. Embree has none: its test is only had through its
    /// scenes, and is asked of each triangle in a scene of its own.
    pub const fn brute_force(self) -> Option<Self> {
        let method = match self {
            Self::Structure(_) | Self::ObvhsBvh2Boxes | Self::ObvhsCwbvhBoxes => {
                Self::Structure(AcceleratorKind::Linear)
            }
            Self::Double | Self::Woop | Self::Fast => self,
            Self::MollerTrumbore | Self::EpsilonBsp => Self::MollerTrumbore,
            Self::ObvhsTriangle | Self::ObvhsBvh2 | Self::ObvhsCwbvh => Self::ObvhsTriangle,
            Self::Embree(_) => return None,
        };
        Some(method)
    }

    /// Whether it has no structure itself.
    pub(super) fn is_brute_force(self) -> bool {
        self.brute_force() == Some(self)
    }

    /// What answers with its triangle test and no structure.
    pub(super) fn build_brute_force(self, scene: &Scene, embree: Option<&Embree>) -> Built {
        match (self, self.brute_force()) {
            (Self::Embree(mode), _) => {
                Built::Alone(Alone::of(world_triangles(scene), loaded(embree), mode))
            }
            (_, brute) => brute.unwrap_or(self).build(scene, embree),
        }
    }

    /// Builds it. Methods that need Embree are asked only where it is there.
    pub(super) fn build(self, scene: &Scene, embree: Option<&Embree>) -> Built {
        let shipped =
            |tree, has_exact_test| Built::Shipped(AsShipped::build(scene, tree, has_exact_test));
        let tested = |test| {
            let options = BuildOptions {
                test,
                ..BuildOptions::default()
            };
            Built::Tested(AcceleratorKind::Linear.build_with(scene, &options))
        };
        match self {
            Self::Structure(kind) => Built::Structure(kind.build(scene)),
            Self::Double => tested(TriangleTest::Double),
            Self::Woop => tested(TriangleTest::Watertight),
            Self::Fast => tested(TriangleTest::Fast),
            Self::MollerTrumbore => Built::Every(Every::build(scene)),
            Self::EpsilonBsp => Built::EpsilonBsp(EpsilonBsp::build(scene)),
            Self::ObvhsTriangle => shipped(ShippedTree::Every, false),
            Self::ObvhsBvh2 => shipped(ShippedTree::Binary, false),
            Self::ObvhsCwbvh => shipped(ShippedTree::Wide, false),
            Self::ObvhsBvh2Boxes => shipped(ShippedTree::Binary, true),
            Self::ObvhsCwbvhBoxes => shipped(ShippedTree::Wide, true),
            Self::Embree(mode) => {
                let built = loaded(embree).build(scene, mode);
                // The end of a method that cannot be built is its result, as a panic of obvhs is.
                Built::Structure(Box::new(built.unwrap_or_else(|error| panic!("{error}"))))
            }
        }
    }
}

fn loaded(embree: Option<&Embree>) -> &Embree {
    embree.expect("what needs Embree is not asked without it")
}

impl std::str::FromStr for Method {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let all = Self::all();
        all.iter()
            .copied()
            .find(|m| m.name() == name)
            .ok_or_else(|| {
                let names: Vec<_> = all.iter().map(|m| m.name()).collect();
                format!("no method {name:?}; there are {}", names.join(", "))
            })
    }
}

impl Built {
    /// The nearest hit.
    pub(super) fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        match self {
            Self::Structure(structure) | Self::Tested(structure) => structure.closest_hit(ray),
            Self::Every(every) => every.closest_hit(ray),
            Self::EpsilonBsp(tree) => tree.closest_hit(ray),
            Self::Shipped(tree) => tree.closest_hit(ray),
            Self::Alone(triangles) => triangles.closest_hit(ray),
        }
    }

    /// The answers to all rays, once for each way of asking: accelerators are asked for closest and any hits, alone and together.
    pub(super) fn answers(&self, rays: &[Ray]) -> Vec<Vec<Answer>> {
        let alone = |ray| Answer::Closest(self.closest_hit(ray));
        let mut answers = vec![rays.iter().map(alone).collect()];
        if let Self::Structure(structure) = self {
            let mut hits = vec![None; rays.len()];
            structure.closest_hits(rays, &mut hits);
            answers.push(hits.into_iter().map(Answer::Closest).collect());
            let any = |ray| Answer::Any(structure.any_hit(ray));
            answers.push(rays.iter().map(any).collect());
            let mut flags = vec![false; rays.len()];
            structure.any_hits(rays, &mut flags);
            answers.push(flags.into_iter().map(Answer::Any).collect());
        }
        answers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn names_are_unique_and_read_back() {
        for method in Method::all() {
            assert_eq!(method.name().parse(), Ok(method));
            let brute = method.brute_force();
            assert_eq!(brute.is_none(), method.needs_embree());
            assert!(brute.is_none_or(Method::is_brute_force));
        }
        assert_eq!(Method::all()[0], Method::DEFAULT);
        assert!(
            "embryo"
                .parse::<Method>()
                .unwrap_err()
                .contains("obvhs-cwbvh-boxes, embree, embree-robust")
        );
    }

    #[test]
    fn all_answer_easy_rays_alike() {
        let scene = crate::import::load(&["models/lecture-objects.gltf".into()]).unwrap();
        let truth = AcceleratorKind::Linear.build(&scene);
        let center = scene.bounds().center();
        let ray = |i: u8| {
            let place = f32::from(i);
            let origin = center + Vec3::new(7.0 - place * 0.071, 6.0, 5.3 - place * 0.043);
            Ray::new(origin, Vec3::new(0.11, -1.0, -0.23))
        };
        let rays: Vec<Ray> = (0..200).map(ray).collect();
        let want: Vec<_> = rays.iter().map(|r| truth.closest_hit(r)).collect();
        assert!(want.iter().flatten().count() > 50);
        let without = Method::all().into_iter().filter(|m| !m.needs_embree());
        for method in without {
            let built = method.build(&scene, None);
            let name = |hit: Option<Hit>| hit.map(|h| (h.instance, h.triangle));
            let others = rays
                .iter()
                .zip(&want)
                .filter(|(r, w)| name(built.closest_hit(r)) != name(**w));
            // A ray may pass an edge by chance.
            let others = others.count();
            assert!(
                others <= 2 * usize::from(!method.is_exact()),
                "{}: {others}",
                method.name()
            );
        }
    }
}
