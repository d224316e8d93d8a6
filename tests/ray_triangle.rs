//! What a hit is, by example: shared edges, both sides, closed intervals, signed zeros, broken input.

#![allow(
    clippy::float_cmp,
    reason = "the results are exact, and compared as such"
)]

use bspray::geometry::{Interval, Ray, RayFrame, Triangle};
use glam::Vec3;

/// Two triangles of one quadrilateral in the plane `z = 1`, sharing the edge from `(0, 0)` to `(3, 1)`.
fn neighbours() -> [Triangle; 2] {
    let [p, q] = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(3.0, 1.0, 1.0)];
    [
        Triangle::new(p, q, Vec3::new(0.0, 2.0, 1.0)),
        Triangle::new(q, p, Vec3::new(2.0, -1.0, 1.0)),
    ]
}

#[test]
fn neighbours_agree_about_their_shared_edge() {
    for (x, y, hits) in [
        (1.5, 0.5, [true, true]),
        (1.5, 0.5_f32.next_up(), [true, false]),
        (1.5, 0.5_f32.next_down(), [false, true]),
        (0.0, 0.0, [true, true]),
        (3.0, 1.0, [true, true]),
        (3.0, 1.0_f32.next_up(), [false, false]),
    ] {
        for direction in [Vec3::Z, Vec3::NEG_Z] {
            let ray = Ray::new(Vec3::new(x, y, 1.0 - 4.0 * direction.z), direction);
            let frame = RayFrame::new(&ray);
            let found = neighbours().map(|t| frame.intersect(&t));
            assert_eq!(found.map(|t| t.is_some()), hits, "at {x} {y} {direction}");
            assert!(found.into_iter().flatten().all(|t| t == 4.0));
        }
    }
}

#[test]
fn a_zero_component_of_the_direction_has_no_sign() {
    for [x, y] in [[0.0, 0.0], [-0.0, 0.0], [0.0, -0.0], [-0.0, -0.0]] {
        for axis in 0..3 {
            // The same picture along each axis.
            let turn = |v: Vec3| Vec3::from_array(std::array::from_fn(|i| v[(i + axis) % 3]));
            let [a, b, c] = neighbours()[0].corners().map(turn);
            let origin = turn(Vec3::new(1.5, 0.5, 0.0));
            let ray = Ray::new(origin, turn(Vec3::new(x, y, 0.5)));
            let frame = RayFrame::new(&ray);
            assert_eq!(frame.intersect(&Triangle::new(a, b, c)), Some(2.0));
        }
    }
}

#[test]
fn a_ray_that_starts_on_a_triangle_hits_it_at_plus_zero() {
    for direction in [Vec3::Z, Vec3::NEG_Z, Vec3::new(-0.3, 0.7, 0.1)] {
        let frame = RayFrame::new(&Ray::new(Vec3::new(1.0, 1.0, 1.0), direction));
        let t = frame.intersect(&neighbours()[0]);
        assert_eq!(t.map(f32::to_bits), Some(0));
    }
}

#[test]
fn the_ends_of_the_interval_are_compared_with_the_rounded_depth() {
    let ray = Ray::new(Vec3::new(1.5, 1.0, 0.0), Vec3::new(0.0, 0.0, 3.0));
    let third = 1.0 / 3.0;
    let within = |min, max| {
        let mut frame = RayFrame::new(&ray.within(Interval::new(min, f32::MAX)));
        frame.set_max(max);
        frame.intersect(&neighbours()[0])
    };
    assert_eq!(within(third, third), Some(third));
    assert_eq!(within(third.next_up(), 1.0), None);
    assert_eq!(within(0.0, third.next_down()), None);
}

#[test]
fn what_cannot_be_traced_hits_nothing() {
    let good = Ray::new(Vec3::new(1.5, 1.0, 0.0), Vec3::Z);
    assert!(RayFrame::new(&good).intersect(&neighbours()[0]).is_some());
    let bad = [
        Ray::new(Vec3::NAN, Vec3::Z),
        Ray::new(good.origin, Vec3::new(f32::INFINITY, 0.0, 1.0)),
        Ray::new(good.origin, Vec3::ZERO),
        good.within(Interval::new(5.0, 0.0)),
        good.within(Interval::new(f32::NAN, 1.0)),
    ];
    for ray in bad {
        assert_eq!(RayFrame::new(&ray).intersect(&neighbours()[0]), None);
    }
    let [a, b, _] = *neighbours()[0].corners();
    for corner in [Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f32::NAN, 1.0)] {
        let frame = RayFrame::new(&good);
        assert_eq!(frame.intersect(&Triangle::new(a, b, corner)), None);
    }
}
