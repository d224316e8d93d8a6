//! Scenes made in code, and the shortest way from one to its pixels.

use bspray::accel::bsp::polygon::SceneTrees;
use bspray::accel::{AcceleratorKind, BuildOptions};
use bspray::render::{
    Film, Integrator, PixelFilter, PixelRect, RenderOptions, SkyMode, Stage, render,
};
use bspray::scene::{Instance, Light, LightKind, Material, Part, Scene, TriangleMesh};
use glam::{DAffine3, Vec2, Vec3};

/// A quad of two triangles, its corners counter-clockwise seen from its front; texture coordinates run from 0 to 1 from the
/// first corner to the second (u) and to the fourth (v).
pub(crate) fn quad(corners: [Vec3; 4]) -> TriangleMesh {
    TriangleMesh {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uv_sets: vec![vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]],
        parts: vec![Part {
            first_triangle: 0,
            triangle_count: 2,
            material: 0,
        }],
        ..TriangleMesh::default()
    }
}

/// A rectangle at height `y` over `x` and `z`, its front upwards.
pub(crate) fn level(y: f32, x: [f32; 2], z: [f32; 2]) -> TriangleMesh {
    let at = |i: usize, k: usize| Vec3::new(x[i], y, z[k]);
    quad([at(0, 1), at(1, 1), at(1, 0), at(0, 0)])
}

/// Meshes where they are, each with its material; instance, mesh and material have the same index.
pub(crate) fn scene(things: impl IntoIterator<Item = (TriangleMesh, Material)>) -> Scene {
    let mut scene = Scene::default();
    for (index, (mut mesh, material)) in (0..).zip(things) {
        mesh.parts.iter_mut().for_each(|p| p.material = index);
        scene.meshes.push(mesh);
        scene.materials.push(material);
        scene
            .instances
            .push(Instance::new("", index, DAffine3::IDENTITY));
    }
    scene
}

/// A light of no size, in candela.
pub(crate) fn point_light(position: Vec3, intensity: Vec3) -> Light {
    Light {
        name: String::new(),
        kind: LightKind::Point,
        intensity,
        position,
        direction: Vec3::NEG_Y,
        range: None,
    }
}

/// Options for a whole picture through the box filter, with counts and first hits.
pub(crate) fn options(size: (u32, u32), samples: u32, integrator: Integrator) -> RenderOptions {
    RenderOptions {
        size,
        window: PixelRect {
            x: 0,
            y: 0,
            width: size.0,
            height: size.1,
        },
        samples,
        noise: None,
        seed: 0,
        integrator,
        filter: PixelFilter::Box,
        counts_cost: true,
        wants_layers: true,
    }
}

/// The polygon BSPs of a scene, if the picture shows them.
pub(crate) fn trees(scene: &Scene, options: &RenderOptions) -> Option<SceneTrees> {
    let build = || SceneTrees::build(scene, &BuildOptions::default());
    options.integrator.shows_trees().then(build)
}

/// Renders a scene from its first camera, with `kind` and the rayon pool in which it is called.
pub(crate) fn film(
    scene: &Scene,
    kind: AcceleratorKind,
    sky: SkyMode,
    options: &RenderOptions,
) -> Film {
    let accelerator = kind.build(scene);
    let trees = trees(scene, options);
    let stage = Stage::new(scene, &*accelerator, Vec3::Y, sky).with_trees(trees.as_ref());
    let frame = scene.cameras[0]
        .frame(options.size.0, options.size.1)
        .expect("a camera that sees something");
    let never = std::sync::atomic::AtomicBool::new(false);
    render(&stage, &frame, options, &never)
}
