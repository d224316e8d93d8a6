//! The fountain in the middle: an octagonal basin of stone, a baluster, a bronze bowl, and an orb of glass.

use super::super::gltf::Document;
use super::super::shapes::{Shape, turn};
use super::group::{Group, Pose};
use super::materials::Materials;
use super::solids::{ball, lathe};

/// Radius of the basin's corners.
const BASIN: f64 = 1.12;

pub(super) fn fountain(document: &mut Document, materials: &Materials) {
    let mut group = Group::new();
    let mut put = |name, shape: &Shape, material, pose| {
        let geometry = document.geometry(shape);
        let mesh = document.mesh_of(name, geometry, material);
        group.put(document, name, mesh, pose);
    };
    // Two steps and the basin, as lathes of eight sides; normals across corners are flattened after.
    let step = [
        [0.0, -0.03],
        [1.55, -0.03],
        [1.55, 0.115],
        [1.535, 0.13],
        [0.0, 0.13],
    ];
    // A corner of the octagon looks along z: turned by a sixteenth, a side does.
    let straight = Pose::at([0.0; 3]).facing(22.5);
    put(
        "fountain step",
        &faceted(lathe(&step, 8)),
        materials.stone,
        straight,
    );
    let basin = [
        [0.0, 0.10],
        [BASIN + 0.06, 0.10],
        [BASIN + 0.06, 0.20],
        [BASIN + 0.02, 0.235],
        [BASIN - 0.05, 0.25],
        [BASIN - 0.06, 0.27],
        [BASIN - 0.06, 0.56],
        [BASIN - 0.03, 0.585],
        [BASIN + 0.05, 0.60],
        [BASIN + 0.07, 0.62],
        [BASIN + 0.07, 0.68],
        [BASIN + 0.055, 0.70],
        [BASIN - 0.15, 0.70],
        [BASIN - 0.17, 0.685],
        [BASIN - 0.17, 0.30],
        [0.0, 0.30],
    ];
    put(
        "fountain basin",
        &faceted(lathe(&basin, 8)),
        materials.stone,
        straight,
    );
    let panel = lathe(
        &[
            [0.0, 0.0],
            [0.16, 0.0],
            [0.15, 0.02],
            [0.12, 0.02],
            [0.11, 0.008],
            [0.0, 0.008],
        ],
        24,
    )
    .laid();
    // Roundels on the eight sides, at the distance of the sides from the axis.
    let (_, apothem) = turn(1.0 / 16.0);
    for side in 0..8 {
        let (sin, cos) = turn(f64::from(side) / 8.0);
        let distance = (BASIN - 0.06) * apothem - 0.002;
        let pose = Pose::at([distance * sin, 0.415, distance * cos]).facing(45.0 * f64::from(side));
        put("roundel", &panel, materials.stone, pose);
    }
    let water = [[BASIN - 0.165, 0.58], [0.0, 0.58]];
    put(
        "water",
        &faceted(lathe(&water, 8)),
        materials.water,
        straight,
    );
    let baluster = [
        [0.0, 0.28],
        [0.30, 0.28],
        [0.30, 0.64],
        [0.27, 0.66],
        [0.25, 0.67],
        [0.17, 0.70],
        [0.135, 0.74],
        [0.13, 0.78],
        [0.15, 0.83],
        [0.185, 0.89],
        [0.20, 0.95],
        [0.19, 1.01],
        [0.155, 1.07],
        [0.115, 1.12],
        [0.095, 1.17],
        [0.10, 1.19],
        [0.13, 1.20],
        [0.14, 1.22],
        [0.13, 1.24],
        [0.10, 1.25],
        [0.0, 1.25],
    ];
    put(
        "fountain baluster",
        &lathe(&baluster, 32),
        materials.stone,
        Pose::at([0.0; 3]),
    );
    let bowl = [
        [0.0, 1.24],
        [0.10, 1.24],
        [0.14, 1.26],
        [0.26, 1.285],
        [0.40, 1.33],
        [0.51, 1.39],
        [0.575, 1.455],
        [0.59, 1.475],
        [0.615, 1.48],
        [0.62, 1.495],
        [0.61, 1.51],
        [0.57, 1.505],
        [0.49, 1.42],
        [0.38, 1.36],
        [0.24, 1.32],
        [0.0, 1.30],
    ];
    put(
        "bronze bowl",
        &lathe(&bowl, 36),
        materials.bronze,
        Pose::at([0.0; 3]),
    );
    put(
        "bowl water",
        &lathe(&[[0.52, 1.455], [0.0, 1.455]], 32),
        materials.water,
        Pose::at([0.0; 3]),
    );
    let stem = [
        [0.0, 1.30],
        [0.13, 1.30],
        [0.12, 1.34],
        [0.07, 1.40],
        [0.055, 1.48],
        [0.06, 1.54],
        [0.085, 1.575],
        [0.11, 1.59],
        [0.115, 1.61],
        [0.105, 1.625],
        [0.0, 1.60],
    ];
    put(
        "bronze stem",
        &lathe(&stem, 28),
        materials.bronze,
        Pose::at([0.0; 3]),
    );
    put(
        "glass orb",
        &ball(0.235, 32),
        materials.glass,
        Pose::at([0.0, 1.846, 0.0]),
    );
    let post = [
        [0.0, 0.69],
        [0.075, 0.69],
        [0.075, 0.72],
        [0.05, 0.735],
        [0.035, 0.76],
        [0.045, 0.775],
        [0.0, 0.775],
    ];
    let (post, sphere) = (lathe(&post, 20), ball(0.095, 20));
    for corner in 0..4 {
        let (sin, cos) = turn(f64::from(corner) / 4.0 + 1.0 / 16.0);
        let r = BASIN - 0.05;
        put(
            "sphere foot",
            &post,
            materials.bronze,
            Pose::at([r * sin, 0.0, r * cos]),
        );
        put(
            "steel sphere",
            &sphere,
            materials.steel,
            Pose::at([r * sin, 0.862, r * cos]),
        );
    }
    group.finish(document, "fountain", Pose::at([0.0; 3]));
}

/// The shape with flat triangles: every triangle gets vertices of its own.
fn faceted(smooth: Shape) -> Shape {
    let mut shape = Shape::default();
    for triangle in &smooth.triangles {
        let corners = triangle.map(|v| smooth.positions[usize::from(v)].map(f64::from));
        shape.face(&corners);
    }
    shape
}
