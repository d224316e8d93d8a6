//! An arcade: piers, columns, arches with their mouldings, a cornice.

use super::super::gltf::Document;
use super::super::shapes::Shape;
use super::arch::{arch_wall, archivolt};
use super::column::{column, pier};
use super::group::{Group, Pose};
use super::materials::Materials;
use super::plan::{
    ARCADE_DEPTH, ARCADE_TOP, ARCH_RADIUS, BAY, HALF, SPRING, bay_axes, column_axes,
};
use super::solids::block;

/// The meshes that all arcades share.
pub(super) struct ArcadeParts {
    column: usize,
    pier: usize,
    bay: usize,
    archivolt: usize,
    cornice: usize,
}

impl ArcadeParts {
    pub(super) fn new(document: &mut Document, materials: &Materials) -> Self {
        let mut mesh = |name, shape: &Shape, material| {
            let geometry = document.geometry(shape);
            document.mesh_of(name, geometry, material)
        };
        let bay = arch_wall(BAY / 2.0, ARCADE_TOP - SPRING, ARCH_RADIUS, ARCADE_DEPTH);
        let half = ARCADE_DEPTH / 2.0;
        let mut cornice = Shape::default();
        for (low, high, out) in [
            (0.16, 0.10, 0.035),
            (0.10, 0.055, 0.065),
            (0.055, 0.0, 0.10),
        ] {
            let course = block(
                [-HALF, ARCADE_TOP - low, -half - out],
                [HALF, ARCADE_TOP - high, half + out],
                0.008,
            );
            cornice.join(&course, [0.0; 3]);
        }
        Self {
            column: mesh("column", &column(), materials.stone),
            pier: mesh("pier", &pier(), materials.stone),
            bay: mesh("arcade wall", &bay, materials.plaster),
            archivolt: mesh(
                "archivolt",
                &archivolt(ARCH_RADIUS, ARCADE_DEPTH),
                materials.stone,
            ),
            cornice: mesh("cornice", &cornice, materials.stone),
        }
    }

    /// An arcade along x, its middle at the origin, without the piers at its ends.
    pub(super) fn arcade(&self, document: &mut Document) -> Group {
        let mut group = Group::new();
        for x in column_axes() {
            group.put(document, "column", self.column, Pose::at([x, 0.0, 0.0]));
        }
        for x in bay_axes() {
            let pose = Pose::at([x, SPRING, 0.0]);
            group.put(document, "arcade wall", self.bay, pose);
            group.put(document, "archivolt", self.archivolt, pose);
        }
        group.put(document, "cornice", self.cornice, Pose::at([0.0; 3]));
        group
    }

    /// The pier of a corner.
    pub(super) fn put_pier(&self, document: &mut Document, group: &mut Group, [x, z]: [f64; 2]) {
        group.put(document, "pier", self.pier, Pose::at([x, 0.0, z]));
    }
}
