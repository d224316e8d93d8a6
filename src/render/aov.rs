//! The layers of a picture, the one registry that EXR output and its documentation go through.
//!
//! Ids, depths and places are those of the ray through the pixel's centre and are never filtered; colours, coverage and what denoisers
//! ask for are the mean of the pixel's samples.

use glam::Vec3;

use super::film::{Film, Pixel};
use crate::picture::Samples;

/// The id of nothing: in `id`, `material` and `prim` where the pixel's centre meets no surface.
pub const NOTHING: u32 = u32::MAX;

/// A channel's value in one pixel.
#[derive(Clone, Copy)]
pub(super) enum Value {
    /// Stored as half floats: colours that come from 8 or 16 bits.
    Half(fn(&Pixel) -> f32),
    /// Stored in full.
    Float(fn(&Pixel) -> f32),
    /// Stored in full.
    Id(fn(&Pixel) -> u32),
}

impl Value {
    /// The values of a film's pixels.
    pub(super) fn of(self, film: &Film) -> Samples {
        match self {
            Self::Half(value) => Samples::F16(film.map(value)),
            Self::Float(value) => Samples::F32(film.map(value)),
            Self::Id(value) => Samples::U32(film.map(value)),
        }
    }
}

/// A layer: channels that belong together.
pub struct Layer {
    /// What it is called in lists.
    pub name: &'static str,
    /// What it holds, with unit and space.
    pub description: &'static str,
    /// Whether it tells what rays meet, or how they find it, so that it is not true of meshes that were simplified.
    pub is_of_triangles: bool,
    pub(super) channels: &'static [(&'static str, Value)],
}

impl Layer {
    /// Names of its channels.
    pub fn channels(&self) -> impl Iterator<Item = &'static str> {
        self.channels.iter().map(|(name, _)| *name)
    }
}

macro_rules! first {
    ($nothing:expr, $hit:ident => $value:expr) => {
        |pixel| pixel.first.map_or($nothing, |$hit| $value)
    };
}

macro_rules! rgb {
    ($name:literal, $kind:ident, $pixel:ident => $value:expr) => {
        &[
            (concat!($name, ".R"), Value::$kind(|$pixel| $value.x)),
            (concat!($name, ".G"), Value::$kind(|$pixel| $value.y)),
            (concat!($name, ".B"), Value::$kind(|$pixel| $value.z)),
        ]
    };
}

/// The layers that every EXR file gets.
pub const LAYERS: &[Layer] = &[
    Layer {
        name: "beauty",
        description: "linear radiance of surfaces, multiplied by coverage; A is the coverage, 0 to 1",
        is_of_triangles: false,
        channels: &[
            ("R", Value::Float(|pixel| pixel.mean().color.x)),
            ("G", Value::Float(|pixel| pixel.mean().color.y)),
            ("B", Value::Float(|pixel| pixel.mean().color.z)),
            ("A", Value::Float(|pixel| pixel.mean().alpha)),
        ],
    },
    Layer {
        name: "direct",
        description: "the part of the beauty that came from a light, or from the surface's own, without meeting another surface",
        is_of_triangles: false,
        channels: rgb!("direct", Float, pixel => pixel.mean().direct),
    },
    Layer {
        name: "indirect",
        description: "the part of the beauty that met further surfaces on its way",
        is_of_triangles: false,
        channels: rgb!("indirect", Float, pixel => pixel.mean().indirect),
    },
    Layer {
        name: "diffuse_albedo",
        description: "share of white light that the surface throws back in all directions, 0 to 1, multiplied by coverage",
        is_of_triangles: false,
        channels: rgb!("diffuse_albedo", Half, pixel => pixel.mean().diffuse_albedo),
    },
    Layer {
        name: "specular_albedo",
        description: "share of white light that the surface mirrors, sharply or not, or lets through, 0 to 1, multiplied by coverage",
        is_of_triangles: false,
        channels: rgb!("specular_albedo", Half, pixel => pixel.mean().specular_albedo),
    },
    Layer {
        name: "denoise_albedo",
        description: "sum of both albedos, 0 to 1: what denoisers ask for",
        is_of_triangles: false,
        channels: rgb!("denoise_albedo", Half, pixel => {
            let mean = pixel.mean();
            (mean.diffuse_albedo + mean.specular_albedo).clamp(Vec3::ZERO, Vec3::ONE)
        }),
    },
    Layer {
        name: "denoise_normal",
        description: "mean of the samples' shading normals in world space, multiplied by coverage: what denoisers ask for",
        is_of_triangles: false,
        channels: &[
            (
                "denoise_normal.X",
                Value::Float(|pixel| pixel.mean().normal.x),
            ),
            (
                "denoise_normal.Y",
                Value::Float(|pixel| pixel.mean().normal.y),
            ),
            (
                "denoise_normal.Z",
                Value::Float(|pixel| pixel.mean().normal.z),
            ),
        ],
    },
    Layer {
        name: "variance",
        description: "variance of the pixel's mean of beauty and background, as independent samples would have it: an upper bound",
        is_of_triangles: false,
        channels: rgb!("variance", Float, pixel => pixel.variance()),
    },
    Layer {
        name: "Z",
        description: "depth along the view axis (in a panorama the distance), in model units; infinite where nothing is met",
        is_of_triangles: true,
        channels: &[("Z", Value::Float(first!(f32::INFINITY, hit => hit.depth)))],
    },
    Layer {
        name: "distance",
        description: "distance from the eye, in model units; infinite where nothing is met",
        is_of_triangles: true,
        channels: &[(
            "distance",
            Value::Float(first!(f32::INFINITY, hit => hit.distance)),
        )],
    },
    Layer {
        name: "N",
        description: "shading normal in world space, towards the eye, of unit length; zero where nothing is met",
        is_of_triangles: true,
        channels: &[
            (
                "N.X",
                Value::Float(first!(0.0, hit => hit.shading_normal.x)),
            ),
            (
                "N.Y",
                Value::Float(first!(0.0, hit => hit.shading_normal.y)),
            ),
            (
                "N.Z",
                Value::Float(first!(0.0, hit => hit.shading_normal.z)),
            ),
        ],
    },
    Layer {
        name: "Ng",
        description: "geometric normal in world space, towards the eye, of unit length; zero where nothing is met",
        is_of_triangles: true,
        channels: &[
            (
                "Ng.X",
                Value::Float(first!(0.0, hit => hit.geometric_normal.x)),
            ),
            (
                "Ng.Y",
                Value::Float(first!(0.0, hit => hit.geometric_normal.y)),
            ),
            (
                "Ng.Z",
                Value::Float(first!(0.0, hit => hit.geometric_normal.z)),
            ),
        ],
    },
    Layer {
        name: "P",
        description: "place in world space, in model units; zero where nothing is met",
        is_of_triangles: true,
        channels: &[
            ("P.X", Value::Float(first!(0.0, hit => hit.position.x))),
            ("P.Y", Value::Float(first!(0.0, hit => hit.position.y))),
            ("P.Z", Value::Float(first!(0.0, hit => hit.position.z))),
        ],
    },
    Layer {
        name: "albedo",
        description: "linear base colour; zero where nothing is met",
        is_of_triangles: true,
        channels: &[
            ("albedo.R", Value::Half(first!(0.0, hit => hit.albedo.x))),
            ("albedo.G", Value::Half(first!(0.0, hit => hit.albedo.y))),
            ("albedo.B", Value::Half(first!(0.0, hit => hit.albedo.z))),
        ],
    },
    Layer {
        name: "uv",
        description: "first texture coordinates, origin at the image's top left; zero where there are none",
        is_of_triangles: true,
        channels: &[
            ("uv.U", Value::Float(first!(0.0, hit => hit.uv.x))),
            ("uv.V", Value::Float(first!(0.0, hit => hit.uv.y))),
        ],
    },
    Layer {
        name: "id",
        description: "index of the instance; 4294967295 where nothing is met",
        is_of_triangles: true,
        channels: &[("id", Value::Id(first!(NOTHING, hit => hit.hit.instance)))],
    },
    Layer {
        name: "material",
        description: "index of the material; 4294967295 where nothing is met",
        is_of_triangles: true,
        channels: &[("material", Value::Id(first!(NOTHING, hit => hit.material)))],
    },
    Layer {
        name: "prim",
        description: "index of the triangle in its mesh; 4294967295 where nothing is met",
        is_of_triangles: true,
        channels: &[("prim", Value::Id(first!(NOTHING, hit => hit.hit.triangle)))],
    },
    Layer {
        name: "cost",
        description: "inner nodes, leaves and triangles that all rays of the pixel's samples tested",
        is_of_triangles: true,
        channels: &[
            (
                "cost.nodes",
                Value::Id(|pixel| saturated(pixel.sum.cost.nodes)),
            ),
            (
                "cost.leaves",
                Value::Id(|pixel| saturated(pixel.sum.cost.leaves)),
            ),
            (
                "cost.prims",
                Value::Id(|pixel| saturated(pixel.sum.cost.primitives)),
            ),
        ],
    },
    Layer {
        name: "samples",
        description: "samples that the pixel got",
        is_of_triangles: false,
        channels: &[("samples", Value::Id(|pixel| pixel.sum.samples))],
    },
];

/// Further layers of films whose stage had the scene's polygon BSPs.
pub const PARTITION_LAYERS: &[Layer] = &[
    Layer {
        name: "fragment",
        description: "number of the polygon BSP's fragment, and the colour that stands for it; 4294967295 and black where nothing is met",
        is_of_triangles: true,
        channels: &[
            (
                "fragment.id",
                Value::Id(first!(NOTHING, hit => hit.fragment.map_or(NOTHING, |f| f.number))),
            ),
            (
                "fragment.R",
                Value::Half(first!(0.0, hit => hit.fragment.map_or(0.0, |f| f.color().x))),
            ),
            (
                "fragment.G",
                Value::Half(first!(0.0, hit => hit.fragment.map_or(0.0, |f| f.color().y))),
            ),
            (
                "fragment.B",
                Value::Half(first!(0.0, hit => hit.fragment.map_or(0.0, |f| f.color().z))),
            ),
        ],
    },
    Layer {
        name: "bsp-depth",
        description: "nodes of the polygon BSP above the fragment's node, 0 for the root; infinite where nothing is met",
        is_of_triangles: true,
        channels: &[(
            "bsp-depth",
            Value::Float(
                first!(f32::INFINITY, hit => hit.fragment.map_or(f32::INFINITY, |f| f.depth as f32)),
            ),
        )],
    },
];

fn saturated(count: u64) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
