//! The stair along the east wall: steps on a solid flank, a landing, an iron railing.

use super::super::gltf::Document;
use super::super::shapes::Shape;
use super::group::{Group, Pose};
use super::materials::Materials;
use super::solids::{ball, block, lathe};

/// Height of a step.
pub(super) const RISE: f64 = 0.175;

/// Depth of a step.
pub(super) const TREAD: f64 = 0.3;

/// Steps up to the landing.
pub(super) const STEPS: u32 = 15;

/// How wide the stair is.
pub(super) const WIDTH: f64 = 1.15;

/// How long the landing is.
const LANDING: f64 = 1.7;

/// A stair that rises towards -z from the origin, its flank at x = 0 and the wall at x = [`WIDTH`].
pub(super) fn stair(document: &mut Document, materials: &Materials) -> Group {
    let mut group = Group::new();
    let mut mesh = |name, shape: &Shape, material| {
        let geometry = document.geometry(shape);
        document.mesh_of(name, geometry, material)
    };
    // A slab with a nosing over the riser.
    let slab = block(
        [-0.03, RISE - 0.05, -TREAD - 0.02],
        [WIDTH, RISE, 0.03],
        0.012,
    );
    let slab = mesh("step", &slab, materials.stone);
    let mut flank = Shape::default();
    for step in 0..STEPS {
        let (z, top) = (-TREAD * f64::from(step), RISE * f64::from(step + 1) - 0.05);
        let body = block([0.0, 0.0, z - TREAD], [WIDTH, top, z], 0.0);
        flank.join(&body, [0.0; 3]);
    }
    let (end, top) = (-TREAD * f64::from(STEPS), RISE * f64::from(STEPS + 1));
    let body = block([0.0, 0.0, end - LANDING], [WIDTH, top - 0.08, end], 0.0);
    flank.join(&body, [0.0; 3]);
    let flank = mesh("stair flank", &flank, materials.plaster);
    let landing = block(
        [-0.04, top - 0.08, end - LANDING - 0.04],
        [WIDTH, top, end + 0.03],
        0.014,
    );
    let landing = mesh("landing", &landing, materials.stone);
    let baluster = lathe(&[[0.0, 0.0], [0.011, 0.0], [0.011, 0.9], [0.0, 0.9]], 6);
    let baluster = mesh("baluster", &baluster, materials.iron);
    let knob = mesh("railing knob", &ball(0.05, 14), materials.bronze);
    let rail = block([-0.022, 0.0, -0.5], [0.022, 0.035, 0.5], 0.008);
    let rail = mesh("handrail", &rail, materials.iron);

    group.put(document, "stair flank", flank, Pose::at([0.0; 3]));
    group.put(document, "landing", landing, Pose::at([0.0; 3]));
    let beside = 0.05;
    for step in 0..STEPS {
        let (y, z) = (RISE * f64::from(step), -TREAD * f64::from(step));
        group.put(document, "step", slab, Pose::at([0.0, y, z]));
        for part in [0.25, 0.75] {
            // Balusters reach the rail, which rises through the step.
            let lift = RISE * (part - 0.5);
            let at = [beside, y + RISE, z - TREAD * part];
            let pose = Pose::at(at).stretched([1.0, 1.0 + lift / 0.9, 1.0]);
            group.put(document, "baluster", baluster, pose);
        }
    }
    let (run, climb) = (TREAD * f64::from(STEPS), RISE * f64::from(STEPS));
    let slope = libm::atan2(climb, run) * 180.0 / std::f64::consts::PI;
    let length = (run * run + climb * climb).sqrt();
    let middle = [beside, RISE * 0.5 + climb / 2.0 + 0.9, -run / 2.0];
    let pose = Pose::at(middle)
        .stretched([1.0, 1.0, length])
        .turned([1.0, 0.0, 0.0], slope);
    group.put(document, "handrail", rail, pose);
    let count = 11;
    for i in 0..=count {
        let z = end - (LANDING - 0.05) * f64::from(i) / f64::from(count);
        group.put(document, "baluster", baluster, Pose::at([beside, top, z]));
    }
    let pose = Pose::at([beside, top + 0.9, end - LANDING / 2.0]).stretched([1.0, 1.0, LANDING]);
    group.put(document, "landing handrail", rail, pose);
    for at in [
        [beside, RISE * 0.5 + 0.96, 0.02],
        [beside, top + 0.98, end - LANDING],
    ] {
        group.put(document, "railing knob", knob, Pose::at(at));
    }
    group
}
