//! What can be chosen when a BSP is built.

use std::fmt;

use super::wide::Instructions;
use crate::accel::extents::{ExtentChoice, ExtentSphere, MeshAccelerator, View};
use crate::geometry::TriangleTest;

/// How an accelerator is built, for those that leave a choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// For the wide tree: time spent on the build against speed of the answers.
    pub quality: BspQuality,
    /// For the wide tree: along which axes its planes and extents lie.
    pub axes: BspAxes,
    /// For the wide tree: with which instructions it is walked.
    pub instructions: BspInstructions,
    /// For the wide tree and obvhs's: what is built before the first ray.
    pub time: BuildTime,
    /// For the wide tree: whether of triangles with the same corners only the first is there, which is what is hit. For those whose rays never continue behind a hit
    /// ([`Ray::behind`](crate::geometry::Ray)): others would miss what they look for.
    pub drops_copies: bool,
    /// For the polygon tree: which polygon is inserted next.
    pub order: BspOrder,
    /// For the polygon tree: whether neighbours that lie exactly in one plane enter as one polygon.
    pub merges_coplanar: bool,
    /// Seed of the polygon tree's random choices.
    pub seed: u64,
    /// How it is decided what a ray hits. All but the exact test break the accelerators' contract.
    pub test: TriangleTest,
    /// For the loop over objects: which extents are tested.
    pub extents: ExtentChoice,
    /// For the loop over objects: which sphere an object gets.
    pub sphere: ExtentSphere,
    /// For the loop over objects: what finds the hits within one.
    pub mesh: MeshAccelerator,
    /// For the loop over objects: where eye rays come from. Rays that know a pixel must be of this camera. Without it there are no screen extents.
    pub view: Option<View>,
}

/// Time spent on the wide tree's build against speed of the answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspQuality {
    /// For pictures of few rays.
    Fast,
    /// For most pictures.
    #[default]
    Default,
    /// For many rays.
    Best,
}

/// Rays a triangle from which on a careful build pays: between scenes that gain soon and such that gain late. Path-traced on one core, build included, Sponza
/// took 11 % less in the default tree with 215 rays a triangle, the bunny 7 % more with 114.
const MANY_RAYS: u64 = 200;

/// When what rays reach is built: cells of the wide tree, and, under it and under obvhs's trees, meshes that are placed several times. The answers are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BuildTime {
    /// All before the first ray.
    #[default]
    Ahead,
    /// Each when the first ray reaches it.
    Reached,
}

/// Rays a triangle below which it pays to build only what they reach, where many triangles are hidden, or beside or behind the picture. Where they reach everything after all, the ways between parts cost about 55 ns a ray (a
/// landscape of 1,000,000 triangles, 12 rays each: 14 to 16 % of all the time), as much as a sixteenth of a triangle's build.
const FEW_RAYS: f64 = 3.0;

/// The same where the whole scene is seen from outside: all but the smallest parts are reached then (the landscape seen whole: with 1.4 rays a triangle 12 % of the time is lost, of one of 10,000,000 with 0.55 a
/// fifth is saved).
const VERY_FEW_RAYS: f64 = 0.75;

impl BuildTime {
    /// The one that is likely to have the answers of so many rays the earliest: few rays leave much unbuilt, many reach everything, and then lose a little on their way
    /// from one part to the next. `shows_all`: whether the scene is seen from outside, most of it in the picture.
    pub fn for_rays(rays: u64, triangles: u64, shows_all: bool) -> Self {
        let few = if shows_all { VERY_FEW_RAYS } else { FEW_RAYS };
        if (rays as f64) < few * triangles as f64 {
            Self::Reached
        } else {
            Self::Ahead
        }
    }

    /// Both.
    pub const ALL: [Self; 2] = [Self::Ahead, Self::Reached];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ahead => "ahead",
            Self::Reached => "reached",
        }
    }
}

impl fmt::Display for BuildTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl BspQuality {
    /// The one that is likely to have the answers of so many rays the earliest, build included. The answers are the same.
    pub fn for_rays(rays: u64, triangles: u64) -> Self {
        if rays / MANY_RAYS < triangles {
            Self::Fast
        } else {
            Self::Default
        }
    }

    /// All of them, the fastest build first.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Default, Self::Best];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Default => "default",
            Self::Best => "best",
        }
    }
}

/// Along which axes the wide tree's planes and extents lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspAxes {
    /// Along the dominant normals of the polygons, where that makes the extents a tenth smaller; else along the space's axes.
    #[default]
    Auto,
    /// Along the axes of the space that the polygons are in.
    Space,
}

impl BspAxes {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Auto, Self::Space];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Space => "space",
        }
    }
}

/// With which instructions the wide tree is walked. The answers are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspInstructions {
    /// The best that the machine has; also instead of others that it has not.
    #[default]
    Auto,
    /// AVX-512 with vectors of 256 bits.
    Avx512,
    /// AVX2 and FMA.
    Avx2,
    /// Those of every machine of the kind.
    Portable,
}

impl BspInstructions {
    /// All of them, the fastest first.
    pub const ALL: [Self; 4] = [Self::Auto, Self::Avx512, Self::Avx2, Self::Portable];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Avx512 => "avx512",
            Self::Avx2 => "avx2",
            Self::Portable => "portable",
        }
    }

    /// The name of those that are used where these are asked for: of [`Self::Auto`], what this machine has.
    pub fn name_in_use(self) -> &'static str {
        let found = Self::ALL.into_iter().skip(1).find(|i| match self {
            Self::Auto => i.is_available(),
            wanted => wanted == *i && i.is_available(),
        });
        found.unwrap_or(Self::Portable).name()
    }

    /// Whether this machine has them.
    pub fn is_available(self) -> bool {
        Instructions::chosen(self).is_some()
    }
}

/// Which polygon the polygon tree inserts next: the lecture's order, which has a "profound effect on the shape of the final tree".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspOrder {
    /// As the file has them.
    File,
    /// Shuffled.
    Random,
    /// By area, the largest first.
    Largest,
    /// Of a sample of candidates, the one whose plane splits the fewest.
    FewestSplits,
    /// Of a sample of candidates, the one with the most even halves.
    Balanced,
    /// Of a sample of candidates, the one with the least expected cost of a ray.
    #[default]
    Sah,
}

impl BspOrder {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::File,
        Self::Random,
        Self::Largest,
        Self::FewestSplits,
        Self::Balanced,
        Self::Sah,
    ];

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::File => "file",
            Self::Random => "random",
            Self::Largest => "largest",
            Self::FewestSplits => "fewest-splits",
            Self::Balanced => "balanced",
            Self::Sah => "sah",
        }
    }
}

impl fmt::Display for BspQuality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for BspAxes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for BspInstructions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for BspOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_rays_get_a_fast_build() {
        assert_eq!(BspQuality::for_rays(999_999, 10_000), BspQuality::Fast);
        assert_eq!(BspQuality::for_rays(2_000_000, 10_000), BspQuality::Default);
        assert_eq!(BspQuality::for_rays(0, 0), BspQuality::Default);
        assert_eq!(BspQuality::for_rays(u64::MAX, u64::MAX), BspQuality::Fast);
    }

    #[test]
    fn few_rays_have_built_what_they_reach() {
        let of = BuildTime::for_rays;
        assert_eq!(of(1_000_000, 1_000_000, false), BuildTime::Reached);
        assert_eq!(of(1_000_000, 1_000_000, true), BuildTime::Ahead);
        assert_eq!(of(100_000, 1_000_000, true), BuildTime::Reached);
        assert_eq!(of(1_000_000_000, 1_000_000, false), BuildTime::Ahead);
        assert_eq!(of(0, 0, false), BuildTime::Ahead);
    }
}
