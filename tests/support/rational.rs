//! Vectors of rational numbers, plainly: the slow and sure way to an answer.

use bspray::geometry::Triangle;
use dashu_ratio::Relaxed;
use glam::Vec3;

pub(crate) type Rationals = [Relaxed; 3];

pub(crate) fn number(x: f32) -> Relaxed {
    Relaxed::try_from(x).expect("finite")
}

pub(crate) fn rational(v: Vec3) -> Rationals {
    v.to_array().map(number)
}

pub(crate) fn minus(a: &Rationals, b: &Rationals) -> Rationals {
    std::array::from_fn(|i| &a[i] - &b[i])
}

pub(crate) fn dot(a: &Rationals, b: &Rationals) -> Relaxed {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Towards the side from which the corners run counter-clockwise; of any length.
pub(crate) fn plane_normal(triangle: &Triangle) -> Rationals {
    let [a, b, c] = triangle.corners().map(rational);
    let [p, q] = [minus(&b, &a), minus(&c, &a)];
    std::array::from_fn(|i| {
        let [j, k] = [(i + 1) % 3, (i + 2) % 3];
        &p[j] * &q[k] - &p[k] * &q[j]
    })
}
