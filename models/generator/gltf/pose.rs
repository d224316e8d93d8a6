//! Rotations of nodes, as unit quaternions x y z w.

use std::f64::consts::PI;

use super::Node;

/// A node at `eye` whose -z axis points at `target`, y up. The right vector stays horizontal.
pub(in super::super) fn looking(name: &'static str, eye: [f64; 3], target: [f64; 3]) -> Node {
    let [x, y, z]: [f64; 3] = std::array::from_fn(|i| target[i] - eye[i]);
    let yaw = libm::atan2(-x, -z) / 2.0;
    let pitch = libm::atan2(y, (x * x + z * z).sqrt()) / 2.0;
    // The quaternion of a turn by yaw around y after one by pitch around x.
    let (sy, cy) = (libm::sin(yaw), libm::cos(yaw));
    let (sp, cp) = (libm::sin(pitch), libm::cos(pitch));
    Node {
        name,
        translation: Some(eye.map(|v| v as f32)),
        rotation: Some([cy * sp, sy * cp, -sy * sp, cy * cp].map(|v| v as f32)),
        ..Node::default()
    }
}

/// A turn around a unit axis, counter-clockwise seen from its tip.
pub(in super::super) fn rotation(axis: [f64; 3], degrees: f64) -> [f32; 4] {
    let (sin, cos) = sin_cos(degrees / 2.0);
    let [x, y, z] = axis.map(|v| v * sin);
    [x, y, z, cos].map(|v| v as f32)
}

/// The turn `first`, then the turn `second`.
pub(in super::super) fn turns(first: [f32; 4], second: [f32; 4]) -> [f32; 4] {
    let [ax, ay, az, aw] = second.map(f64::from);
    let [bx, by, bz, bw] = first.map(f64::from);
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
    .map(|v| v as f32)
}

/// Sine and cosine of an angle in degrees.
pub(in super::super) fn sin_cos(degrees: f64) -> (f64, f64) {
    let angle = degrees * PI / 180.0;
    (libm::sin(angle), libm::cos(angle))
}
